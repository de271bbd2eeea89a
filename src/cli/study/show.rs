//! `granulens study show`: what a journal holds.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use granulens::search::LocalOptimality;
use granulens::study::{Found, Journal, Key, Rung, Study as Studied, StudyError, differs, why};
use granulens::units::Dimension::Time;
use serde_json::json;

use super::why::words;
use super::words::of;
use super::{folder, read};
use crate::cli::console::{emit, emit_json, note};
use crate::cli::failure::Failure;
use crate::cli::{Band, Common};

/// What a study's journal holds: its entries at each step, and the best at the finest.
pub struct Known {
    pub study: Studied,
    /// Step (s) and evaluations.
    pub rungs: Vec<(f64, Rung)>,
    pub best: Option<Found>,
    others: usize,
    warnings: Vec<String>,
}

#[derive(clap::Args)]
pub struct Show {
    /// Study file
    study: PathBuf,
    /// Say of every evaluation of the journal under which settings it was made, whether it is used, and which setting differs where not
    #[arg(long)]
    why: bool,
    #[command(flatten)]
    forces: Band,
}

pub fn find(path: &Path, forces: &Band, common: &Common) -> Result<Known, Failure> {
    let study = read(path, forces, common)?;
    let loaded = Journal::read(&folder(common, &study).join("journal.jsonl"))?;
    let mut rungs = Vec::new();
    let (mut own, mut cut) = (0, 0);
    for place in 0..study.rungs.len() {
        let plan = study.plan(place).map_err(StudyError::from)?;
        let mut rung = Rung::default();
        let at = study.at(place);
        for (assignment, entry) in Key::new(&at, &plan).own(&at, &loaded.entries) {
            cut += usize::from(entry.cut);
            if rung.get(&assignment).is_none() && !entry.cut {
                rung.add(&study, &assignment, entry.clone());
            }
        }
        own += rung.all().len();
        rungs.push((plan.step, rung));
    }
    let known = rungs.iter().filter(|(_, rung)| !rung.ranked().is_empty());
    let finest = known.min_by(|a, b| a.0.total_cmp(&b.0));
    let best = finest.and_then(|(_, rung)| {
        let best = *rung.ranked().first()?;
        Some(Found::new(&study, rung, best, LocalOptimality::None))
    });
    for warning in &loaded.warnings {
        note(common, &format!("note: {warning}"));
    }
    let mut warnings = loaded.warnings;
    if let Some(difference) = differs(&folder(common, &study), &study) {
        let warning = format!("{}: {difference}", folder(common, &study).display());
        note(common, &format!("note: {warning}"));
        warnings.push(warning);
    }
    let others = loaded.entries.len().saturating_sub(own + cut);
    Ok(Known { study, rungs, best, others, warnings })
}

impl Show {
    pub fn run(self, common: &Common) -> Result<(), Failure> {
        show(&self, common)
    }
}

fn show(asked: &Show, common: &Common) -> Result<(), Failure> {
    let Known { study, rungs, best, others, warnings } = find(&asked.study, &asked.forces, common)?;
    let evaluations: usize = rungs.iter().map(|(_, rung)| rung.all().len()).sum();
    let why = match asked.why {
        true => Some(why(&study, &folder(common, &study).join("journal.jsonl"))?),
        false => None,
    };
    if common.json {
        emit_json(&json!({
            "format": granulens::outcome::FORMAT, "evaluations": evaluations, "budget": study.budget(),
            "of_other_settings": others, "warnings": warnings, "best": best, "why": why,
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
        let _ = writeln!(text, "best   {}  evaluation {}, {limits}", of(&best), best.evaluation);
    }
    why.iter().flatten().for_each(|why| text.push_str(&words(why)));
    emit(&text);
    Ok(())
}
