//! When a command's work began, and the manifest of what came of it.

use std::path::Path;
use std::time::{Instant, SystemTime, UNIX_EPOCH};

use super::{FORMAT, Manifest, Method};

/// When work began.
pub struct Begun {
    clock: Instant,
    unix_s: u64,
}

impl Begun {
    /// Now.
    pub fn now() -> Self {
        let unix_s = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs());
        Self { clock: Instant::now(), unix_s }
    }

    /// Wall time since then (s).
    pub fn seconds(&self) -> f64 {
        self.clock.elapsed().as_secs_f64()
    }

    /// What is needed to repeat what was done since then: `file` is the name of what was described, where its file stands and its text, `impact`
    /// what struck it in words, `seeds` the first seed and their number. The command joins where one was given.
    pub fn manifest(
        &self,
        (name, path, text): (&str, &Path, &str),
        method: Method,
        impact: String,
        seeds: [u64; 2],
    ) -> Manifest {
        Manifest {
            format: FORMAT,
            name: name.to_owned(),
            method,
            design_file: path.display().to_string(),
            design: text.to_owned(),
            command: None,
            impact,
            seeds,
            threads: rayon::current_num_threads(),
            started_unix_s: self.unix_s,
            seconds: self.seconds(),
        }
    }
}
