//! `granulens study run`.

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;
use std::time::Instant;

use granulens::evaluate::method;
use granulens::outcome::{FORMAT, Method};
use granulens::study::{Ended, State, Study, StudyError, Watch, costs, run};
use granulens::units::Dimension::Time;
use serde::{Deserialize, Serialize};
use serde_json::json;

use super::events::Meter;
use super::words::words;
use super::{best_layout, folder, read, settings};
use crate::cli::console::{emit, emit_json, interrupt, note, pretty};
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

/// What `study.json` holds.
#[derive(Serialize, Deserialize)]
pub struct Report {
    /// Format number of every JSON file of results.
    pub format: u32,
    /// With what, and how: step and window are those of the last stage.
    #[serde(flatten)]
    pub method: Option<Method>,
    /// What Q and the baselines refer to.
    #[serde(default)]
    pub reference: Option<String>,
    /// Forces about that of each impact, and how far the outermost lie from it.
    #[serde(default)]
    pub forces: usize,
    /// As a part of it.
    #[serde(default)]
    pub band: f64,
    /// The study file, as it was named.
    pub study: String,
    /// Seed of everything random.
    pub seed: u64,
    /// How many sites could change.
    pub sites: usize,
    /// The materials that could be chosen.
    pub materials: Vec<String>,
    /// What was asked, hashed: studies that are alike in it can be compared.
    #[serde(default)]
    pub problem: Option<String>,
    /// What it came to.
    #[serde(flatten)]
    pub state: State,
}

impl Run {
    pub fn run(self, common: &Common) -> Result<(), Failure> {
        go(&self, common)
    }
}

fn go(asked: &Run, common: &Common) -> Result<(), Failure> {
    let (path, events) = (asked.study.as_path(), asked.events);
    let study = read(path, &asked.forces, common)?;
    if common.dry_run {
        let parts: Vec<Part> = costs(&study, interrupt())?
            .iter()
            .map(|stage| {
                let what = format!("evaluations of {}, step {}", stage.method, Time.show(stage.step));
                Part::new(what, stage.evaluations, Some(stage.core_seconds))
            })
            .collect();
        return tell(common, &parts);
    }
    let folder = folder(common, &study);
    let begun = Instant::now();
    let mut meter = Meter::new(common, study.budget(), events);
    let state = search(&study, path, &folder, common, interrupt(), &mut meter)?;
    meter.finish();
    let seconds = begun.elapsed().as_secs_f64();
    let simulated = meter.simulated;
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

/// Runs a study in its folder, or goes on with it, and writes down what it came to.
pub fn search(
    study: &Study,
    path: &Path,
    folder: &Path,
    common: &Common,
    interrupt: &AtomicBool,
    watch: &mut impl Watch,
) -> Result<State, Failure> {
    settings::claim(common, folder, study)?;
    for name in ["study.json", "best.csv", "nearest.csv", "report.html"] {
        probe(common, Some(&folder.join(name)))?;
    }
    let state = run(study, &folder.join("journal.jsonl"), interrupt, watch)?;
    let last = study.stages.last().map_or(0, |stage| stage.rung);
    let report = Report {
        format: FORMAT,
        method: Some(method(&study.design, &study.plan(last).map_err(StudyError::from)?)),
        reference: study.design.reference().map(|material| material.name.clone()),
        forces: study.forces.count(),
        band: study.forces.band(),
        study: path.display().to_string(),
        seed: study.seed,
        sites: study.free.len(),
        problem: Some(study.problem()),
        materials: study.letters.iter().map(|&place| study.palette[usize::from(place)].name.clone()).collect(),
        state,
    };
    write_file(common, &folder.join("study.json"), &pretty(&report))?;
    write_file(common, &folder.join("report.html"), &super::draw::page(study, &report))?;
    let state = report.state;
    // What misses a limit never goes by the name of best.
    for (name, found) in [("best.csv", &state.best), ("nearest.csv", &state.nearest)] {
        if let Some(found) = found {
            write_file(common, &folder.join(name), &best_layout(study, &found.entry)?)?;
        }
    }
    Ok(state)
}
