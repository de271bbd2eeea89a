//! A study: many evaluations of one design's layouts, journalled as they finish, and resumable.
//!
//! In: a study file, which names a design, what may be changed, what is wanted, and how long to search. Out: the best layout,
//! and a journal with a line for every evaluation. A study follows from its file alone, whatever the number of threads;
//! so to resume is to run it again with the journal in place of simulations, and the final state has the same bits.
//!
//! - `file`: the study file, as written, then as checked
//! - `objective`: scores to one number
//! - `journal`: the append-only, checksummed record
//! - `run`: ask, evaluate, write down, tell

mod file;
mod journal;
mod objective;
mod run;

pub use file::{Start, Study};
pub use journal::{Entry, Journal, Loaded};
pub use objective::{Goal, Objective};
pub use run::{Best, Ended, Key, State, Watch, run};

use std::path::PathBuf;

use crate::dem::BatchError;
use crate::design::DesignError;
use crate::evaluate::{EvaluatorError, PlanError};
use crate::layout::LayoutFileError;

/// Why a study cannot be run or read.
#[derive(Debug, thiserror::Error)]
pub enum StudyError {
    /// Something is wrong with the study file.
    #[error("{}:{} {message}", path.display(), line.map_or(String::new(), |line| format!("{line}:")))]
    File {
        /// The file.
        path: PathBuf,
        /// The line, from 1.
        line: Option<u64>,
        /// What, and the way out.
        message: String,
    },
    /// Something is wrong with the design file that it names.
    #[error(transparent)]
    Design(Box<DesignError>),
    /// Something is wrong with the layout file that it starts from.
    #[error(transparent)]
    Layout(Box<LayoutFileError>),
    /// The journal cannot be used.
    #[error("{}: {message}", path.display())]
    Journal {
        /// The journal.
        path: PathBuf,
        /// Why, and the way out.
        message: String,
    },
    /// The design cannot be evaluated.
    #[error(transparent)]
    Evaluator(#[from] EvaluatorError),
}

impl From<DesignError> for StudyError {
    fn from(error: DesignError) -> Self {
        Self::Design(Box::new(error))
    }
}

impl From<LayoutFileError> for StudyError {
    fn from(error: LayoutFileError) -> Self {
        Self::Layout(Box::new(error))
    }
}

impl From<BatchError> for StudyError {
    fn from(error: BatchError) -> Self {
        Self::Evaluator(error.into())
    }
}

impl From<PlanError> for StudyError {
    fn from(error: PlanError) -> Self {
        Self::Evaluator(error.into())
    }
}
