use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

type Hear = dyn Fn(&Progress<'_>) + Send + Sync;

/// What a long computation asks its caller, whether it is still wanted, and tells him, how far it is. `Context::default()` never
/// stops and tells nobody. Clones share the request to stop, so that one is kept to set it and another is passed on.
#[derive(Clone, Default)]
pub struct Context {
    stop: Arc<AtomicBool>,
    hear: Option<Arc<Hear>>,
}

/// How far a computation is.
#[derive(Debug, Clone, Copy, PartialEq)]
#[non_exhaustive]
pub enum Progress<'a> {
    /// So many more parts of the work are finished; `name` says which, and is empty where they have no names.
    Finished {
        /// Since the last word.
        count: u64,
        /// Of an arrangement, a row, ...
        name: &'a str,
    },
    /// So many steps of one run are done.
    Steps {
        /// Since the run's beginning.
        done: u64,
        /// At its end.
        of: u64,
    },
    /// A pile settles, and nobody knows for how long yet.
    Settling {
        /// Since its beginning (τ_c).
        time: f64,
        /// What is left to come to rest (m g d).
        kinetic: f64,
    },
}

impl Context {
    /// The same request to stop, and somebody who hears of the progress, from whichever thread.
    pub fn telling(&self, hear: impl Fn(&Progress<'_>) + Send + Sync + 'static) -> Self {
        Self { stop: Arc::clone(&self.stop), hear: Some(Arc::new(hear)) }
    }

    /// The same request to stop, for a part of the work whose own progress nobody asked for.
    pub fn silent(&self) -> Self {
        Self { stop: Arc::clone(&self.stop), hear: None }
    }

    /// Asks all that were given this context, or a clone, to stop: they end soon, with what they have.
    pub fn stop(&self) {
        self.stop.store(true, Ordering::Relaxed);
    }

    /// Asked to stop?
    pub fn stopped(&self) -> bool {
        self.stop.load(Ordering::Relaxed)
    }

    /// Clones of one another, so that to stop one is to stop the other?
    pub fn same(&self, other: &Self) -> bool {
        Arc::ptr_eq(&self.stop, &other.stop)
    }

    /// Tells how far the computation is.
    pub fn tell(&self, progress: Progress<'_>) {
        if let Some(hear) = &self.hear {
            hear(&progress);
        }
    }

    /// Tells that a part of the work with a name is finished.
    pub fn finished(&self, name: &str) {
        self.tell(Progress::Finished { count: 1, name });
    }
}

impl std::fmt::Debug for Context {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Context").field("stopped", &self.stopped()).field("told", &self.hear.is_some()).finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::Mutex;

    #[test]
    fn a_stop_reaches_clones_and_progress_whom_it_was_promised() {
        let heard = Arc::new(Mutex::new(Vec::new()));
        let (context, ears) = (Context::default(), Arc::clone(&heard));
        let telling = context.telling(move |progress| match progress {
            Progress::Finished { count, name } => ears.lock().unwrap().push(format!("{count} {name}")),
            other => panic!("{other:?}"),
        });
        telling.finished("lens");
        telling.silent().finished("nobody");
        context.finished("nobody");
        telling.clone().tell(Progress::Finished { count: 3, name: "" });
        assert_eq!(*heard.lock().unwrap(), ["1 lens", "3 "]);
        assert!(!context.stopped() && context.same(&telling) && !context.same(&Context::default()));
        telling.silent().stop();
        assert!(context.stopped() && telling.stopped());
    }
}
