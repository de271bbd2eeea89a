//! `--dry-run`: what a command would cost, found without doing it.
//!
//! Files are read and checked and plans are made as always; then a little is simulated for the time it takes, and nothing is written.

use std::time::{Duration, Instant};

use granulens::Context;
use granulens::dem::rig::Simulation;
use granulens::dem::{Impact, MoveIn, Spheres, Stop, simulate};
use granulens::outcome::FORMAT;
use granulens::sample::Sample;
use serde::Serialize;
use serde_json::json;

use super::Common;
use super::console::{context, emit, emit_json};
use super::failure::Failure;

/// How long a trial may take (s).
pub const TASTE: f64 = 1.0;

/// Something that the command would do.
#[derive(Serialize)]
pub struct Part {
    /// In words.
    what: String,
    /// Simulations, or whatever is counted; they are shared out among threads.
    count: u64,
    /// Time of one core for all of them (s); none where it cannot be told beforehand.
    core_seconds: Option<f64>,
}

impl Part {
    pub fn new(what: impl Into<String>, count: u64, core_seconds: Option<f64>) -> Self {
        Self { what: what.into(), count, core_seconds }
    }

    /// Time on so many threads (s): one simulation of these runs on one.
    fn seconds(&self, threads: usize) -> Option<f64> {
        let rounds = self.count.div_ceil(threads as u64);
        Some(self.core_seconds? * rounds as f64 / self.count.max(1) as f64)
    }
}

/// Prints what a command would cost.
pub fn tell(common: &Common, parts: &[Part]) -> Result<(), Failure> {
    if context().stopped() {
        return Err(Failure::Interrupted("nothing is told".to_owned()));
    }
    let threads = rayon::current_num_threads();
    let seconds: Option<f64> = parts.iter().map(|part| part.seconds(threads)).sum();
    if common.json {
        emit_json(
            &json!({ "format": FORMAT, "dry_run": true, "threads": threads, "parts": parts, "seconds": seconds }),
        );
        return Ok(());
    }
    let shown = |seconds: Option<f64>| match seconds {
        Some(seconds) if seconds < 10.0 => format!("{seconds:.2} s"),
        Some(seconds) if seconds < 600.0 => format!("{seconds:.0} s"),
        Some(seconds) if seconds < 36_000.0 => format!("{:.0} min", seconds / 60.0),
        Some(seconds) => format!("{:.0} h", seconds / 3600.0),
        None => "not known beforehand".to_owned(),
    };
    let mut text = format!("| what would be done | how many | one core | {threads} threads |\n|---|---|---|---|\n");
    for part in parts {
        let (alone, all) = (shown(part.core_seconds), shown(part.seconds(threads)));
        text += &format!("| {} | {} | {alone} | {all} |\n", part.what, part.count);
    }
    text += "\nNothing was written. Times are estimates from a short trial on this machine as busy as it is.\n";
    emit(&text);
    Ok(())
}

/// Time of one core (s) for a lens or another arrangement with full records.
pub fn arrangement<const D: usize>(sample: &Sample<D>, impact: &Impact) -> Result<f64, Failure>
where
    Spheres: MoveIn<D>,
{
    let over = Context::default();
    let ends = over.clone();
    std::thread::spawn(move || {
        std::thread::sleep(Duration::from_secs_f64(TASTE));
        ends.stop();
    });
    let begun = Instant::now();
    let record = simulate(sample, impact, &over).map_err(|error| Failure::input(error.to_string()))?;
    let seconds = begun.elapsed().as_secs_f64();
    Ok(match record.stop {
        // The rows that the wave has reached, and with them the cost of a step, grow with time: so it is at most this.
        Some(Stop::Interrupted { time_s }) if time_s > 0.0 => seconds * (impact.window / time_s).powi(2),
        _ => seconds,
    })
}

/// Time of one core (s) for so many steps of a rig.
pub fn rig<const D: usize>(simulation: &mut Simulation<D>, steps: u64) -> f64 {
    const CHUNK: u64 = 32;
    let begun = Instant::now();
    let mut done = 0;
    while done < steps && begun.elapsed().as_secs_f64() < TASTE {
        let chunk = CHUNK.min(steps - done);
        // A guard that stops it here will stop the run too.
        if simulation.advance(chunk, context()).is_err() {
            break;
        }
        done += chunk;
    }
    begun.elapsed().as_secs_f64() * steps as f64 / done.max(1) as f64
}
