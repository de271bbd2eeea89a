//! Progress of a study: a bar on stderr, or lines of JSON on stdout.

use std::time::Instant;

use granulens::study::{State, Watch};
use indicatif::{ProgressBar, ProgressStyle};
use serde_json::json;

use super::words::of;
use crate::cli::Common;
use crate::cli::console::{emit, say};

/// Best so far, evaluations per second and time left, on stderr; or every batch as a line of JSON on stdout.
pub struct Meter {
    bar: ProgressBar,
    silent: bool,
    /// Whether every batch is told as a line of JSON.
    pub events: bool,
    budget: u64,
    begun: Instant,
    /// Evaluations that came from the journal.
    replayed: u64,
    /// Evaluations that were simulated.
    pub simulated: usize,
    /// What was said about the journal.
    pub warnings: Vec<String>,
}

impl Meter {
    pub fn new(common: &Common, budget: u64, events: bool) -> Self {
        let bar = if common.quiet || events { ProgressBar::hidden() } else { ProgressBar::new(budget) };
        if let Ok(style) = ProgressStyle::with_template("{bar:20} {pos}/{len}, {per_sec}, {eta} left; {msg}") {
            bar.set_style(style);
        }
        if events {
            emit(&json!({ "event": "begin", "format": granulens::outcome::FORMAT, "budget": budget }).to_string());
        }
        let silent = common.quiet || common.json || events;
        let (begun, warnings) = (Instant::now(), Vec::new());
        Self { bar, silent, events, budget, begun, replayed: 0, simulated: 0, warnings }
    }

    pub fn finish(&self) {
        self.bar.finish_and_clear();
    }

    fn event(&self, state: &State, simulated: usize) {
        let seconds = self.begun.elapsed().as_secs_f64();
        let rate = self.simulated as f64 / seconds.max(1e-9);
        let left = (rate > 0.0).then(|| self.budget.saturating_sub(state.evaluations) as f64 / rate);
        let best = state.found().map(|found| {
            json!({
                "contrast": found.scores.contrast, "focal_gain": found.scores.focal_gain,
                "protection": found.scores.protection,
                "loss": found.loss, "within_limits": found.within_limits,
            })
        });
        let stage = state.stages.last().map(|stage| json!({ "method": stage.method, "step_s": stage.step }));
        let line = json!({
            "event": "batch", "evaluations": state.evaluations, "simulated": simulated, "from_journal": self.replayed,
            "stage": stage, "best": best, "seconds": seconds, "evaluations_per_s": rate, "seconds_left": left,
        });
        emit(&line.to_string());
    }
}

impl Watch for Meter {
    fn warning(&mut self, text: &str) {
        if self.events {
            emit(&json!({ "event": "warning", "text": text }).to_string());
        } else if !self.silent {
            self.bar.suspend(|| say(&format!("note: {text}")));
        }
        self.warnings.push(text.to_owned());
    }

    fn batch(&mut self, state: &State, simulated: usize) {
        self.simulated += simulated;
        self.replayed = state.evaluations.saturating_sub(self.simulated as u64);
        if self.events {
            self.event(state, simulated);
            return;
        }
        self.bar.set_position(state.evaluations);
        if simulated == 0 {
            // What comes from the journal says nothing about the speed.
            self.bar.reset_eta();
            return;
        }
        if let Some(best) = state.found() {
            let limits = if best.within_limits { "" } else { " (misses a limit)" };
            self.bar.set_message(format!("best {}{limits}", of(best)));
        }
    }
}
