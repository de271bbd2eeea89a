//! What a benchmark reads from the system: time on processors, and memory.

use std::time::Instant;

/// Time (s) that this process has been on a processor, on Linux; elsewhere time that passes.
pub fn processor_time(begun: Instant) -> f64 {
    let ticks = |thread: std::fs::DirEntry| {
        let text = std::fs::read_to_string(thread.path().join("schedstat")).ok()?;
        text.split(' ').next()?.parse::<f64>().ok()
    };
    let threads = std::fs::read_dir("/proc/self/task").ok();
    let spent = threads.and_then(|list| list.flatten().map(ticks).sum::<Option<f64>>());
    spent.map_or_else(|| begun.elapsed().as_secs_f64(), |nanoseconds| 1e-9 * nanoseconds)
}

/// Greatest memory of the process so far (bytes), on Linux.
pub fn peak_memory() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|line| line.starts_with("VmHWM:"))?;
    Some(1024.0 * line.split_whitespace().nth(1)?.parse::<f64>().ok()?)
}
