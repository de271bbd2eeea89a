//! `granulens study`: search for the best layout, evaluation by evaluation, and look at what was found.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::time::Instant;

use granulens::evaluate::Plan;
use granulens::layout;
use granulens::study::{Best, Ended, Entry, Journal, Key, State, Study as Studied, Watch, run};
use indicatif::{ProgressBar, ProgressStyle};
use serde_json::{Value, json};

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
    let mut meter = Meter::new(common, study.budget);
    let state = run(&study, &folder.join("journal.jsonl"), interrupt(), &mut meter)?;
    meter.bar.finish_and_clear();
    let seconds = begun.elapsed().as_secs_f64();
    let simulated = meter.simulated;
    write_file(&folder.join("study.json"), &pretty(&state))?;
    if let Some(best) = &state.best {
        write_file(&folder.join("best.csv"), &best_layout(&study, &best.entry)?)?;
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
    match (state.ended, &state.best) {
        (Ended::Interrupted, _) => Err(Failure::Interrupted(format!(
            "{} of {} evaluations are done and kept; the same command goes on",
            state.evaluations, study.budget
        ))),
        (_, None) => Err(Failure::Guard(vec!["no evaluation has come to its end".to_owned()])),
        _ => Ok(()),
    }
}

/// What a study has come to.
fn words(state: &State) -> String {
    let mut text = format!("{} evaluations, {} stopped by a guard, ", state.evaluations, state.stopped);
    text.push_str(match state.ended {
        Ended::Budget => "the budget is used up\n",
        Ended::NothingNew => "nothing new within reach\n",
        Ended::Interrupted => "interrupted\n",
    });
    if let Some(start) = &state.start {
        let _ = writeln!(text, "start  {}", scores(start));
    }
    if let Some(best) = &state.best {
        let _ = writeln!(text, "best   {}", scores(&best.entry));
        let _ = writeln!(text, "       {}", remarks(best));
    }
    text
}

fn remarks(best: &Best) -> String {
    let limits = if best.within_limits { "within the limits" } else { "MISSES A LIMIT" };
    let one_opt = if best.one_opt { "; no flip of one sphere improves it (1-opt)" } else { "" };
    format!("evaluation {}, {limits}{one_opt}", best.evaluation)
}

fn scores(entry: &Entry) -> String {
    let show = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), |value| format!("{value:.4}"));
    format!("C {}  G {}  Q {}", show(entry.contrast), show(entry.focal_gain), show(entry.protection))
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
        if let Some(best) = &state.best {
            let limits = if best.within_limits { "" } else { " (misses a limit)" };
            self.bar.set_message(format!("best {}{limits}", scores(&best.entry)));
        }
    }
}

/// The study's entries in a journal, in order, and the place of the best.
struct Found {
    study: Studied,
    entries: Vec<Entry>,
    best: Option<usize>,
    others: usize,
    warnings: Vec<String>,
}

fn find(path: &Path, common: &Common) -> Result<Found, Failure> {
    let study = Studied::read(path, common.seed)?;
    let plan = Plan::new(&study.design, study.overrides, &study.palette).map_err(granulens::study::StudyError::from)?;
    let loaded = Journal::read(&folder(common, path).join("journal.jsonl"))?;
    let own = Key::new(&study, &plan).own(&study, &loaded.entries);
    let entries: Vec<Entry> = own.into_iter().map(|(_, entry)| entry.clone()).collect();
    let rank = |entry: &Entry| (!study.objective.is_met(entry), study.objective.loss(entry));
    let mut best: Option<usize> = None;
    for (k, entry) in entries.iter().enumerate() {
        let rank_k = rank(entry);
        if rank_k.1.is_finite() && best.is_none_or(|b| rank_k < rank(&entries[b])) {
            best = Some(k);
        }
    }
    let others = loaded.entries.len() - entries.len();
    for warning in &loaded.warnings {
        note(common, &format!("note: {warning}"));
    }
    Ok(Found { study, entries, best, others, warnings: loaded.warnings })
}

fn show(path: &Path, common: &Common) -> Result<(), Failure> {
    let Found { study, entries, best, others, warnings } = find(path, common)?;
    let best = best.map(|k| (k + 1, &entries[k]));
    if common.json {
        let best = best.map(|(evaluation, entry)| {
            json!({ "evaluation": evaluation, "within_limits": study.objective.is_met(entry), "scores": entry })
        });
        emit_json(&json!({
            "format": granulens::outcome::FORMAT, "evaluations": entries.len(), "budget": study.budget,
            "of_other_settings": others, "warnings": warnings, "best": best.unwrap_or(Value::Null),
        }));
        return Ok(());
    }
    let mut text = format!("{} evaluations in the journal, budget {}\n", entries.len(), study.budget);
    if others > 0 {
        let _ = writeln!(text, "{others} more belong to other settings");
    }
    if let Some((evaluation, entry)) = best {
        let limits = if study.objective.is_met(entry) { "within the limits" } else { "MISSES A LIMIT" };
        let _ = writeln!(text, "best   {}  evaluation {evaluation}, {limits}", scores(entry));
    }
    emit(&text);
    Ok(())
}

impl Export {
    fn run(self, common: &Common) -> Result<(), Failure> {
        let Found { study, entries, best, .. } = find(&self.study, common)?;
        if let Some(path) = &self.layout {
            let best = best.ok_or_else(|| Failure::input("the journal holds no evaluation that came to its end"))?;
            write_file(path, &best_layout(&study, &entries[best])?)?;
            note(common, &format!("{}: {}", path.display(), scores(&entries[best])));
        }
        if let Some(path) = &self.journal {
            write_file(path, &table(&entries))?;
            note(common, &format!("{}: {} evaluations", path.display(), entries.len()));
        }
        if common.json {
            emit_json(&json!({
                "format": granulens::outcome::FORMAT, "layout": self.layout, "journal": self.journal,
                "evaluations": entries.len(),
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

/// A journal as CSV: no score where there is none.
fn table(entries: &[Entry]) -> String {
    let mut text = "evaluation,F_J,P_J,C,G,Q,stop,layout\n".to_owned();
    let show = |value: Option<f64>| value.map_or_else(String::new, |value| value.to_string());
    for (k, entry) in entries.iter().enumerate() {
        let Entry { focal_mean, protected_mean, contrast, focal_gain, protection, .. } = entry;
        let ratios = [contrast, focal_gain, protection].map(|&value| show(value)).join(",");
        let stop = entry.stop.as_ref().map_or_else(String::new, |stop| format!("\"{}\"", stop.replace('"', "\"\"")));
        let _ = writeln!(text, "{},{focal_mean},{protected_mean},{ratios},{stop},{}", k + 1, entry.layout);
    }
    text
}
