//! `granulens evaluate`: one shard of what a study asks for.

use std::path::PathBuf;
use std::time::Instant;

use granulens::outcome::FORMAT;
use granulens::study::{Shard, evaluate_shard};
use serde_json::json;

use super::console::{Count, context, emit, emit_json, note};
use super::failure::Failure;
use super::study::{folder, read};
use super::{Band, Common};

/// Evaluate one shard of the layouts that a study asks for
///
/// Reads asked.jsonl of the study's folder, as study ask writes it, and writes the shard's own journal, shards/K-of-N.jsonl. Shards may run
/// at the same time on machines that share the folder, in any order, and again: what is evaluated already is left out. study merge
/// folds them.
#[derive(clap::Args)]
pub struct Evaluate {
    /// Study file
    study: PathBuf,
    /// Which part of the work: the K-th of N, such as 3/8
    #[arg(long, value_name = "K/N")]
    shard: Shard,
    #[command(flatten)]
    forces: Band,
}

impl Evaluate {
    pub fn run(self, common: &Common) -> Result<(), Failure> {
        if common.dry_run {
            return Err(Failure::input_with_help(
                "--dry-run: what a study costs is said by granulens study run STUDY --dry-run",
                "Its core seconds are those of all shards together.",
            ));
        }
        let study = read(&self.study, &self.forces, common)?;
        let folder = folder(common, &study);
        let begun = Instant::now();
        let mut bar: Option<(Count, usize)> = None;
        let done = evaluate_shard(&study, &folder, self.shard, context(), |done| {
            let (bar, shown) = bar.get_or_insert_with(|| (Count::new(common, done.part - done.known, "layouts"), 0));
            bar.advance((done.evaluated - *shown) as u64);
            *shown = done.evaluated;
        })?;
        if let Some((bar, _)) = bar {
            bar.done();
        }
        let seconds = begun.elapsed().as_secs_f64();
        done.warnings.iter().for_each(|warning| note(common, &format!("note: {warning}")));
        if common.json {
            emit_json(&json!({
                "format": FORMAT, "shard": self.shard.to_string(), "journal": self.shard.journal(&folder), "part": done.part,
                "known": done.known, "evaluated": done.evaluated, "stopped": done.stopped, "of_other_settings": done.others,
                "warnings": done.warnings, "seconds": seconds, "threads": rayon::current_num_threads(),
            }));
        } else {
            let others = match done.others {
                0 => String::new(),
                others => format!(", {others} asked for under other settings left alone"),
            };
            emit(&format!(
                "shard {}: {} layouts, {} known, {} evaluated in {seconds:.1} s, {} of them stopped by a guard{others}",
                self.shard, done.part, done.known, done.evaluated, done.stopped
            ));
        }
        if done.is_whole() {
            return Ok(());
        }
        let left = done.part - done.known - done.evaluated;
        Err(Failure::Interrupted(format!(
            "{left} of {} layouts are left; what is evaluated is kept, and the same command goes on",
            done.part
        )))
    }
}
