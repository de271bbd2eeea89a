//! Which study a folder holds: seeds, settings and problems are kept apart.

use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::Study;
use super::report::pretty;
use crate::outcome::FORMAT;
use crate::output::{self, OutputError};

/// The file beside the journal.
const FILE: &str = "settings.json";

/// What it says.
#[derive(Serialize, Deserialize, PartialEq)]
struct Settings {
    format: u32,
    /// Seed of everything random.
    seed: u64,
    /// See [`Study::problem`].
    problem: String,
    /// See [`Study::settings`].
    settings: String,
}

impl Settings {
    fn of(study: &Study) -> Self {
        Self { format: FORMAT, seed: study.seed, problem: study.problem(), settings: study.settings() }
    }
}

/// Of results of 0.1 only the seed is known.
#[derive(Deserialize)]
struct OnlySeed {
    seed: u64,
}

fn json<T: serde::de::DeserializeOwned>(path: &Path) -> Option<T> {
    serde_json::from_str(&std::fs::read_to_string(path).ok()?).ok()
}

/// In what the study that a folder holds differs from this one, if it does.
pub fn differs(folder: &Path, study: &Study) -> Option<String> {
    let ours = Settings::of(study);
    let seeds = |theirs: u64| format!("holds the study with seed {theirs}, and this is seed {}", ours.seed);
    let mut theirs = json::<Settings>(&folder.join(FILE));
    // Versions before this one hashed the ways to starts as they were given.
    let before = study.settings_of_before();
    if let Some(theirs) = theirs.as_mut().filter(|theirs| before.contains(&theirs.settings)) {
        theirs.settings.clone_from(&ours.settings);
    }
    match theirs {
        Some(theirs) if theirs == ours => None,
        Some(theirs) if theirs.problem != ours.problem => Some(
            "holds a study of another problem: design, materials, rows, impacts, tolerances or objective differ"
                .to_owned(),
        ),
        Some(theirs) if theirs.seed != ours.seed => Some(seeds(theirs.seed)),
        Some(_) => Some("holds a study with other settings: starts, methods, steps or stages differ".to_owned()),
        None => {
            let theirs: OnlySeed = json(&folder.join("study.json"))?;
            (theirs.seed != ours.seed).then(|| seeds(theirs.seed))
        }
    }
}

/// A folder that holds something else.
#[derive(Debug, thiserror::Error)]
pub enum ClaimError {
    /// Another study.
    #[error("{}: {difference}; it is left alone", folder.display())]
    Other {
        /// The folder.
        folder: PathBuf,
        /// In what the studies differ.
        difference: String,
    },
    /// No study, or it cannot be written to.
    #[error(transparent)]
    Output(#[from] OutputError),
}

impl ClaimError {
    /// What to try.
    pub fn help(&self) -> &str {
        match self {
            Self::Other { .. } => {
                "Name another folder with --out, or replace its results with --force; its journal stays."
            }
            Self::Output(error) => error.help(),
        }
    }
}

/// Takes a folder for a study: one that is new, or holds this study, or another one that is replaced by force. Its journal stays
/// in any case, and what it knows of this problem is not evaluated again.
///
/// # Errors
/// See [`ClaimError`].
pub fn claim(folder: &Path, study: &Study, force: bool) -> Result<(), ClaimError> {
    output::check_known(folder, &["journal.jsonl", "asked.jsonl", FILE])?;
    if let Some(difference) = differs(folder, study).filter(|_| !force) {
        return Err(ClaimError::Other { folder: folder.to_owned(), difference });
    }
    output::write(&folder.join(FILE), pretty(&Settings::of(study)).as_bytes(), force)?;
    Ok(())
}
