//! Long calls: without the interpreter's lock, on as many threads as wanted, and Ctrl-C.

use std::sync::{Arc, Mutex, PoisonError, mpsc};
use std::time::Duration;

use pyo3::prelude::*;
use rayon::{ThreadPool, ThreadPoolBuilder};

use crate::failure::Failure;
use granulens::Context;

/// Time between two looks at Ctrl-C.
const LOOK: Duration = Duration::from_millis(20);

/// Pools by the process that made them and their size: a process that was forked has none of its parent's threads.
static POOLS: Mutex<Vec<(u32, usize, Arc<ThreadPool>)>> = Mutex::new(Vec::new());

fn pool(threads: Option<usize>) -> Result<Arc<ThreadPool>, Failure> {
    let cores = || std::thread::available_parallelism().map_or(1, usize::from);
    let threads = threads.unwrap_or_else(cores);
    if !(1..=1024).contains(&threads) {
        return Err(Failure::input(format!("threads = {threads} must be 1 to 1024")));
    }
    let mut pools = POOLS.lock().unwrap_or_else(PoisonError::into_inner);
    let process = std::process::id();
    if let Some((.., pool)) = pools.iter().find(|(id, size, _)| (*id, *size) == (process, threads)) {
        return Ok(pool.clone());
    }
    let made = ThreadPoolBuilder::new().num_threads(threads).build();
    let pool = Arc::new(made.map_err(|error| Failure::input(format!("{threads} threads: {error}")))?);
    pools.push((process, threads, pool.clone()));
    Ok(pool)
}

/// Runs a job on a pool of threads while other threads of Python go on. Ctrl-C sets the job's flag, waits for it to end and is raised.
pub fn run<T: Send>(py: Python<'_>, threads: Option<usize>, job: impl FnOnce(&Context) -> T + Send) -> PyResult<T> {
    let pool = pool(threads)?;
    let context = Context::default();
    let (done, raised) = py.detach(|| {
        std::thread::scope(|scope| {
            let (end, ended) = mpsc::channel::<()>();
            let context = &context;
            let worker = scope.spawn(move || {
                // Dropped when the job is done, and when it panics too.
                let _end = end;
                pool.install(|| job(context))
            });
            let mut raised = None;
            while let Err(mpsc::RecvTimeoutError::Timeout) = ended.recv_timeout(LOOK) {
                if raised.is_none()
                    && let Err(error) = Python::attach(|py| py.check_signals())
                {
                    raised = Some(error);
                    context.stop();
                }
            }
            (worker.join(), raised)
        })
    });
    if let Some(error) = raised {
        return Err(error);
    }
    match done {
        Ok(done) => Ok(done),
        Err(panic) => std::panic::resume_unwind(panic),
    }
}
