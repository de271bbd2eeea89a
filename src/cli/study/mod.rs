//! `granulens study`: search for the best layout, evaluation by evaluation, and look at what was found.
//!
//! - `run`: run a study or go on with it; `events`: progress, as a bar or as lines of JSON
//! - `ask`: what others are to evaluate; `merge`: what they did; `slurm`: scripts that do both on a cluster
//! - `show`: what a journal holds; `export`: the best layout, and the journal as a table (`table`)
//! - `why`: which settings a journal's evaluations belong to
//! - `compare`: several studies side by side
//! - `draw`: a study as a page
//! - `words`: what a study has come to, in words

mod ask;
pub mod compare;
mod draw;
mod events;
mod export;
mod merge;
pub mod run;
pub mod show;
mod slurm;
mod table;
mod why;
mod words;

use std::path::{Path, PathBuf};

use granulens::study::{Entry, Study as Studied};

pub use draw::draw;

use super::failure::Failure;
use super::{Band, Common};

/// Search for the layout that a study file asks for
///
/// Every evaluation is a line of journal.jsonl in the study's folder, reports/NAME of NAME.toml unless --out names another
/// (reports/NAME-seed-N with a --seed N that is not the file's).
/// Whatever ends a run, the same command goes on where it was and comes to the same end, bit for bit.
#[derive(clap::Args)]
pub struct Study {
    #[command(subcommand)]
    job: Job,
}

#[derive(clap::Subcommand)]
enum Job {
    /// Run a study, or go on with it; writes study.json and best.csv beside the journal
    ///
    /// Where no layout keeps the study's limits, nearest.csv takes the place of best.csv, and the exit code is 3.
    Run(run::Run),
    /// Write down which layouts are to be evaluated next, for granulens evaluate in any number of processes
    ///
    /// Folds what the shards have done, goes on with the search as far as that carries, and lists in asked.jsonl what it asks for next; exit
    /// code 4. When nothing more is asked for the study is at its end, which is that of study run, bit for bit.
    Ask(ask::Ask),
    /// Fold the journals of shards into the study's journal, in any order and as often as wanted; say what is missing or damaged
    Merge(merge::Merge),
    /// Write scripts that run a study as SLURM job arrays
    Slurm(slurm::Slurm),
    /// Show how many evaluations a study's journal holds, and the best of them
    Show(show::Show),
    /// Write a study's best layout, or its journal as a table
    Export(export::Export),
    /// Compare studies that have been run: what each came to, how fast, and how much their best layouts differ
    ///
    /// With --out, a page with the same and how each converged.
    Compare(compare::Compare),
}

impl Study {
    /// Whether it can take long.
    pub fn simulates(&self) -> bool {
        matches!(self.job, Job::Run(_))
    }

    pub fn run(self, common: &Common) -> Result<(), Failure> {
        match self.job {
            Job::Run(run) => run.run(common),
            Job::Ask(ask) => ask.run(common),
            Job::Merge(merge) => merge.run(common),
            Job::Slurm(slurm) => slurm.run(common),
            Job::Show(show) => show.run(common),
            Job::Export(export) => export.run(common),
            Job::Compare(compare) => compare.run(common),
        }
    }
}

/// Reads a study; seed and forces of the command line take the place of the file's.
pub fn read(path: &Path, forces: &Band, common: &Common) -> Result<Studied, Failure> {
    let mut study = Studied::read(path, common.seed)?;
    study.forces = forces.or(study.forces)?;
    Ok(study)
}

/// Where a study is kept: studies of other seeds than the file's stand beside it.
pub fn folder(common: &Common, study: &Studied) -> PathBuf {
    let stem = study.path.file_stem().unwrap_or(study.path.as_os_str());
    common.out.clone().unwrap_or_else(|| {
        let mut name = stem.to_owned();
        if study.seed != study.file_seed {
            name.push(format!("-seed-{}", study.seed));
        }
        Path::new("reports").join(name)
    })
}

/// A layout file's text.
fn best_layout(study: &Studied, entry: &Entry) -> Result<String, Failure> {
    let assignment = entry
        .assignment(study.variables(), study.alphabet.len() as u8)
        .ok_or_else(|| Failure::input("the best layout belongs to another study"))?;
    Ok(study.layout(&assignment).csv())
}
