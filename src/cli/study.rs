//! `granulens study`: search for the best layout, evaluation by evaluation, and look at what was found.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::time::Instant;

use granulens::layout;
use granulens::search::Proof;
use granulens::study::{
    Ended, Entry, Fabric, Found, Journal, Key, Rung, Scored, StageState, State, Study as Studied, Summary, Watch, run,
};
use granulens::units::Dimension::Time;
use indicatif::{ProgressBar, ProgressStyle};
use serde_json::json;

use super::Common;
use super::console::{emit, emit_json, interrupt, note, pretty, say};
use super::failure::Failure;
use super::folder::write_file;

/// Search for the layout that a study file asks for
///
/// Every evaluation is a line of journal.jsonl in the study's folder, reports/NAME of NAME.toml unless --out names another.
/// Whatever ends a run, the same command goes on where it was and comes to the same end, bit for bit.
#[derive(clap::Args)]
pub struct Study {
    #[command(subcommand)]
    job: Job,
}

#[derive(clap::Subcommand)]
enum Job {
    /// Run a study, or go on with it; writes study.json and best.csv beside the journal
    Run(Named),
    /// Show how many evaluations a study's journal holds, and the best of them
    Show(Named),
    /// Write a study's best layout, or its journal as a table
    Export(Export),
}

/// Which study.
#[derive(clap::Args)]
struct Named {
    /// Study file
    study: PathBuf,
}

#[derive(clap::Args)]
struct Export {
    /// Study file
    study: PathBuf,
    /// Where to write the best layout, as CSV
    #[arg(long, value_name = "FILE", required_unless_present = "journal")]
    layout: Option<PathBuf>,
    /// Where to write the journal, as CSV
    #[arg(long, value_name = "FILE")]
    journal: Option<PathBuf>,
}

impl Study {
    pub fn run(self, common: &Common) -> Result<(), Failure> {
        match self.job {
            Job::Run(named) => go(&named.study, common),
            Job::Show(named) => show(&named.study, common),
            Job::Export(export) => export.run(common),
        }
    }
}

fn folder(common: &Common, study: &Path) -> PathBuf {
    let stem = study.file_stem().unwrap_or(study.as_os_str());
    common.out.clone().unwrap_or_else(|| Path::new("reports").join(stem))
}

fn go(path: &Path, common: &Common) -> Result<(), Failure> {
    let study = Studied::read(path, common.seed)?;
    let folder = folder(common, path);
    let begun = Instant::now();
    let mut meter = Meter::new(common, study.budget());
    let state = run(&study, &folder.join("journal.jsonl"), interrupt(), &mut meter)?;
    meter.bar.finish_and_clear();
    let seconds = begun.elapsed().as_secs_f64();
    let simulated = meter.simulated;
    write_file(&folder.join("study.json"), &pretty(&state))?;
    // What misses a limit never goes by the name of best.
    for (name, found) in [("best.csv", &state.best), ("nearest.csv", &state.nearest)] {
        if let Some(found) = found {
            write_file(&folder.join(name), &best_layout(&study, &found.entry)?)?;
        }
    }
    if common.json {
        let speed = json!({ "simulated": simulated, "seconds": seconds, "threads": rayon::current_num_threads() });
        emit_json(
            &json!({ "format": granulens::outcome::FORMAT, "study": state, "run": speed, "warnings": meter.warnings }),
        );
    } else {
        emit(&words(&state));
        note(common, &format!("{simulated} simulated in {seconds:.1} s; written to {}", folder.display()));
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

/// What a study has come to.
fn words(state: &State) -> String {
    let mut text = format!("{} evaluations, {} stopped by a guard, ", state.evaluations, state.stopped);
    text.push_str(match state.ended {
        Ended::Budget => "the budget is used up\n",
        Ended::NothingNew => "nothing new within reach\n",
        Ended::Time => "the time is over\n",
        Ended::Interrupted => "interrupted\n",
    });
    if state.stages.len() > 1 {
        for stage in &state.stages {
            let best = stage.best.as_ref().map_or_else(|| "-".to_owned(), scores);
            let missed = if stage.within_limits { "" } else { "  (misses a limit)" };
            let StageState { method, evaluations, .. } = stage;
            let _ = writeln!(text, "  {method:13} {:>8} {evaluations:>7}  {best}{missed}", Time.show(stage.step));
        }
    }
    if let Some(start) = &state.start {
        let _ = writeln!(text, "start  {}", scores(&start.summary));
    }
    if let Some(best) = state.found() {
        let name = if best.within_limits { "best  " } else { "none within the limits; the nearest to them" };
        let _ = writeln!(text, "{name} {}", scores(&best.summary));
        let _ = writeln!(text, "       {}", remarks(best));
    }
    if state.rungs.len() > 1 {
        for rung in &state.rungs {
            if let Some(correlation) = rung.rank_correlation {
                let step = Time.show(rung.step);
                let _ = writeln!(
                    text,
                    "step {step}: rank correlation with the finest {correlation:.3}, over {} layouts",
                    rung.shared
                );
            }
        }
    }
    if let Some(front) = &state.front {
        let volume = front.hypervolume.map_or_else(|| "-".to_owned(), |volume| format!("{volume:.4}"));
        let _ = writeln!(
            text,
            "front of {} with {} layouts, hypervolume against the start {volume}",
            front.measures.join(" and "),
            front.layouts.len()
        );
        if let Some(knee) = front.knee.and_then(|knee| front.layouts.get(knee)) {
            let _ = writeln!(text, "  knee {}", scores(&knee.summary));
        }
    }
    text
}

fn remarks(best: &Found) -> String {
    let limits = if best.within_limits { "within the limits" } else { "MISSES A LIMIT" };
    let proof = match (best.one_opt, best.two_opt) {
        (_, true) => "; no change of one or two spheres improves it (2-opt)",
        (true, _) => "; no flip of one sphere improves it (1-opt)",
        _ => "",
    };
    let Fabric { spheres, lone, .. } = best.summary.fabric;
    format!("evaluation {}, {limits}{proof}; {spheres} spheres not of the host, {lone} alone", best.evaluation)
}

fn scores(summary: &Summary) -> String {
    let show = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), |value| format!("{value:.4}"));
    format!("C {}  G {}  Q {}", show(summary.contrast), show(summary.focal_gain), show(summary.protection))
}

/// Best so far, evaluations per second and time left, on stderr.
struct Meter {
    bar: ProgressBar,
    silent: bool,
    simulated: usize,
    warnings: Vec<String>,
}

impl Meter {
    fn new(common: &Common, budget: u64) -> Self {
        let bar = if common.quiet { ProgressBar::hidden() } else { ProgressBar::new(budget) };
        if let Ok(style) = ProgressStyle::with_template("{bar:20} {pos}/{len}, {per_sec}, {eta} left; {msg}") {
            bar.set_style(style);
        }
        Self { bar, silent: common.quiet || common.json, simulated: 0, warnings: Vec::new() }
    }
}

impl Watch for Meter {
    fn warning(&mut self, text: &str) {
        if !self.silent {
            self.bar.suspend(|| say(&format!("note: {text}")));
        }
        self.warnings.push(text.to_owned());
    }

    fn batch(&mut self, state: &State, simulated: usize) {
        self.simulated += simulated;
        if simulated == 0 {
            // What comes from the journal says nothing about the speed.
            self.bar.set_position(state.evaluations);
            self.bar.reset_eta();
            return;
        }
        self.bar.set_position(state.evaluations);
        if let Some(best) = state.found() {
            let limits = if best.within_limits { "" } else { " (misses a limit)" };
            self.bar.set_message(format!("best {}{limits}", scores(&best.summary)));
        }
    }
}

/// What a study's journal holds: its entries at each step, and the best at the finest.
struct Known {
    study: Studied,
    rungs: Vec<(f64, Rung)>,
    best: Option<Found>,
    others: usize,
    warnings: Vec<String>,
}

fn find(path: &Path, common: &Common) -> Result<Known, Failure> {
    let study = Studied::read(path, common.seed)?;
    let loaded = Journal::read(&folder(common, path).join("journal.jsonl"))?;
    let mut rungs = Vec::new();
    let mut own = 0;
    for place in 0..study.rungs.len() {
        let plan = study.plan(place).map_err(granulens::study::StudyError::from)?;
        let mut rung = Rung::default();
        for (choice, entry) in Key::new(&study, &plan).own(&study, &loaded.entries) {
            if rung.get(&choice).is_none() {
                rung.add(&study, &choice, entry.clone());
            }
        }
        own += rung.all().len();
        rungs.push((plan.step, rung));
    }
    let known = rungs.iter().filter(|(_, rung)| !rung.ranked().is_empty());
    let finest = known.min_by(|a, b| a.0.total_cmp(&b.0));
    let best = finest.and_then(|(_, rung)| {
        let best = *rung.ranked().first()?;
        Some(Found::new(&study, rung, best, Proof::None))
    });
    for warning in &loaded.warnings {
        note(common, &format!("note: {warning}"));
    }
    let others = loaded.entries.len() - own;
    Ok(Known { study, rungs, best, others, warnings: loaded.warnings })
}

fn show(path: &Path, common: &Common) -> Result<(), Failure> {
    let Known { study, rungs, best, others, warnings } = find(path, common)?;
    let evaluations: usize = rungs.iter().map(|(_, rung)| rung.all().len()).sum();
    if common.json {
        emit_json(&json!({
            "format": granulens::outcome::FORMAT, "evaluations": evaluations, "budget": study.budget(),
            "of_other_settings": others, "warnings": warnings, "best": best,
        }));
        return Ok(());
    }
    let mut text = format!("{evaluations} evaluations in the journal, budget {}\n", study.budget());
    if others > 0 {
        let _ = writeln!(text, "{others} more belong to other settings");
    }
    if rungs.len() > 1 {
        for (step, rung) in &rungs {
            let _ = writeln!(text, "  {} at a step of {}", rung.all().len(), Time.show(*step));
        }
    }
    if let Some(best) = best {
        let limits = if best.within_limits { "within the limits" } else { "MISSES A LIMIT" };
        let _ = writeln!(text, "best   {}  evaluation {}, {limits}", scores(&best.summary), best.evaluation);
    }
    emit(&text);
    Ok(())
}

impl Export {
    fn run(self, common: &Common) -> Result<(), Failure> {
        let Known { study, rungs, best, .. } = find(&self.study, common)?;
        if let Some(path) = &self.layout {
            let best = best.ok_or_else(|| Failure::input("the journal holds no evaluation that came to its end"))?;
            write_file(path, &best_layout(&study, &best.entry)?)?;
            note(common, &format!("{}: {}", path.display(), scores(&best.summary)));
        }
        let evaluations: usize = rungs.iter().map(|(_, rung)| rung.all().len()).sum();
        if let Some(path) = &self.journal {
            write_file(path, &table(&study, &rungs))?;
            note(common, &format!("{}: {evaluations} evaluations", path.display()));
        }
        if common.json {
            emit_json(&json!({
                "format": granulens::outcome::FORMAT, "layout": self.layout, "journal": self.journal,
                "evaluations": evaluations,
            }));
        }
        Ok(())
    }
}

/// A layout file's text.
fn best_layout(study: &Studied, entry: &Entry) -> Result<String, Failure> {
    let choice = entry
        .choice(study.free.len(), study.letters.len() as u8)
        .ok_or_else(|| Failure::input("the best layout belongs to another study"))?;
    Ok(layout::write(&study.layout(&choice)))
}

/// A journal as CSV, a line for each evaluation and impact: no score where there is none.
fn table(study: &Studied, rungs: &[(f64, Rung)]) -> String {
    let mut text = "step_s,evaluation,force_N,duration_s,F_J,P_J,C,G,Q,loss,miss,mass_kg,spheres,lone,islands,stop,layout\n".to_owned();
    let show = |value: Option<f64>| value.map_or_else(String::new, |value| value.to_string());
    let finite = |value: f64| if value.is_finite() { value.to_string() } else { String::new() };
    for (step, rung) in rungs {
        for (k, judged) in rung.all().iter().enumerate() {
            let Entry { impacts, stop, layout, .. } = &judged.entry;
            let stop = stop.as_ref().map_or_else(String::new, |stop| format!("\"{}\"", stop.replace('"', "\"\"")));
            let Fabric { mass, spheres, lone, islands } = judged.fabric;
            let [loss, miss] = [judged.loss.total, judged.loss.miss].map(finite);
            for (impact, scored) in study.impacts.iter().zip(impacts) {
                let Scored { focal_mean, protected_mean, .. } = scored;
                let ratios = [scored.contrast, scored.focal_gain, scored.protection].map(show).join(",");
                let _ = writeln!(
                    text,
                    "{step},{},{},{},{focal_mean},{protected_mean},{ratios},{loss},{miss},{mass},{spheres},{lone},\
                     {islands},{stop},{layout}",
                    k + 1,
                    impact.force,
                    impact.duration
                );
            }
        }
    }
    text
}
