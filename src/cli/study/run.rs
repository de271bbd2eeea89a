//! `granulens study run`.

use std::path::{Path, PathBuf};
use std::time::Instant;

use granulens::Context;
use granulens::outcome::FORMAT;
use granulens::study::{Ended, Report, State, Study, Watch, asked_in, claim, costs, run};
use granulens::units::Dimension::Time;
use serde_json::json;

use super::events::Meter;
use super::words::words;
use super::{folder, read};
use crate::cli::console::{context, emit, emit_json, note};
use crate::cli::cost::{Part, tell};
use crate::cli::failure::Failure;
use crate::cli::folder::{probe, write_file};
use crate::cli::{Band, Common};

#[derive(clap::Args)]
pub struct Run {
    /// Study file
    study: PathBuf,
    /// Print every step of the search as a line of JSON on stdout: begin, warning, batch, end
    #[arg(long)]
    events: bool,
    #[command(flatten)]
    forces: Band,
}

impl Run {
    pub fn run(self, common: &Common) -> Result<(), Failure> {
        let (path, events) = (self.study.as_path(), self.events);
        let study = read(path, &self.forces, common)?;
        if common.dry_run {
            return cost(&study, common);
        }
        let folder = begin(common, &study)?;
        let begun = Instant::now();
        let mut meter = Meter::new(common, study.budget(), events);
        let state = run(&study, &folder.join("journal.jsonl"), context(), &mut meter)?;
        finish(Ran { study: &study, folder: &folder, state, meter, seconds: begun.elapsed().as_secs_f64() }, common)
    }
}

/// What the study will cost.
fn cost(study: &Study, common: &Common) -> Result<(), Failure> {
    {
        let parts: Vec<Part> = costs(study, context())?
            .iter()
            .map(|stage| {
                let what = format!("evaluations of {}, step {}", stage.method, Time.show(stage.step));
                Part::new(what, stage.evaluations, Some(stage.core_seconds))
            })
            .collect();
        tell(common, &parts)
    }
}

/// Takes a folder for the study, and finds out whether what a run writes can be written there.
pub fn begin(common: &Common, study: &Study) -> Result<PathBuf, Failure> {
    let folder = folder(common, study);
    take(common, study, &folder)?;
    Ok(folder)
}

fn take(common: &Common, study: &Study, folder: &Path) -> Result<(), Failure> {
    claim(folder, study, common.force)?;
    let written = ["study.json", "best.csv", "nearest.csv", "report.html"];
    written.iter().try_for_each(|name| probe(common, Some(&folder.join(name))))
}

/// Runs a study in a folder, or goes on with it, and writes down what it came to.
pub fn search(
    study: &Study,
    folder: &Path,
    common: &Common,
    context: &Context,
    watch: &mut impl Watch,
) -> Result<State, Failure> {
    take(common, study, folder)?;
    let state = run(study, &folder.join("journal.jsonl"), context, watch)?;
    write_down(study, folder, state, common)
}

fn write_down(study: &Study, folder: &Path, state: State, common: &Common) -> Result<State, Failure> {
    let report = Report::of(study, state)?;
    report.write(study, folder, common.force)?;
    write_file(common, &folder.join("report.html"), &super::draw::page(study, &report))?;
    Ok(report.state)
}

/// A run that has come to an end of some kind.
pub struct Ran<'a> {
    pub study: &'a Study,
    pub folder: &'a Path,
    pub state: State,
    pub meter: Meter,
    pub seconds: f64,
}

/// Writes down what a run came to, and tells it.
pub fn finish(ran: Ran<'_>, common: &Common) -> Result<(), Failure> {
    let Ran { study, folder, state, meter, seconds } = ran;
    meter.finish();
    let (simulated, events) = (meter.simulated, meter.events);
    let state = write_down(study, folder, state, common)?;
    let known = simulated == 0 && matches!(state.ended, Ended::Budget | Ended::NothingNew);
    let speed = json!({ "simulated": simulated, "nothing_to_do": known, "seconds": seconds, "threads": rayon::current_num_threads() });
    if events {
        emit(&json!({ "event": "end", "study": state, "run": speed }).to_string());
    } else if common.json {
        emit_json(&json!({ "format": FORMAT, "study": state, "run": speed, "warnings": meter.warnings }));
    } else {
        emit(&words(&state));
        let done = match known {
            true => "nothing was to be done: the journal holds every evaluation".to_owned(),
            false => format!("{simulated} simulated in {seconds:.1} s"),
        };
        note(common, &format!("{done}; written to {}", folder.display()));
    }
    match (state.ended, state.found()) {
        (Ended::Asked, _) => Err(Failure::Asked(format!(
            "{} of {} evaluations are done; what is asked for next stands in {}, for granulens evaluate",
            state.evaluations,
            study.budget(),
            asked_in(folder).display()
        ))),
        (Ended::Interrupted, _) => Err(Failure::Interrupted(format!(
            "{} of {} evaluations are done and kept; the same command goes on",
            state.evaluations,
            study.budget()
        ))),
        (_, None) => Err(Failure::Guard(vec!["no evaluation has come to its end".to_owned()])),
        (_, Some(found)) if !found.within_limits => {
            Err(Failure::Threshold(vec!["no layout keeps the study's limits; nearest.csv comes nearest".to_owned()]))
        }
        _ => Ok(()),
    }
}
