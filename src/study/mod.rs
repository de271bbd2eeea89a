//! A study: many evaluations of one design's layouts, journalled as they finish, and resumable.
//!
//! In: a study file, which names a design, what may be changed, what is wanted, and how long to search. Out: the best layout,
//! and a journal with a line for every evaluation. A study follows from its file alone, whatever the number of threads;
//! so to resume is to run it again with the journal in place of simulations, and the final state has the same bits.
//!
//! - `file`: the study file, as written, then as checked; `source`: its text, and complaints about it; `stage`: what is done
//!   one after the other; `free`: which sites may change; `start`: where that begins; `family`: the
//!   design's lens as real parameters
//! - `aggregate`: scores under several impacts to one; `objective`: measures to one number, or to several that are traded
//! - `set`: impacts, and crystals that are not built as drawn; `tolerance`: what a layout loses then; `prices`: what spheres cost
//! - `entry`: one evaluation; `key`: what it depends on; `journal`: the append-only, checksummed record of all
//! - `rung`: all that is known at one step; `state`: how far a study is; `baselines`: what its layouts are compared with;
//!   `finals`: the figures that the best is known by
//! - `engine`: who evaluates; `asked`: what is asked of others, and how shards share it; `shard`: one shard, and how they are folded
//! - `settings`: which study a folder holds; `report`: what it came to, as files; `bundle`: a study with all its files
//! - `why`: which settings the evaluations of a journal belong to
//! - `run`: ask, evaluate, write down, tell; `climb`: the same where a cheap score screens for a costly one; `cost`: how long that will take

mod asked;
mod baselines;
mod bundle;
mod climb;
mod cost;
mod engine;
mod entry;
mod family;
mod file;
mod finals;
mod free;
mod journal;
mod key;
mod objective;
mod aggregate;
mod prices;
mod report;
mod run;
mod rung;
mod set;
mod settings;
mod shard;
mod source;
mod stage;
mod start;
mod state;
mod tolerance;
mod why;

pub use aggregate::{Aggregate, summary};
pub use asked::{Asking, Question, Shard, ShardError, asked_in};
pub use baselines::{BaselineScores, Spread};
pub use bundle::bundle;
pub use cost::{StageCost, costs};
pub use engine::{Engine, Local};
pub use entry::{Entry, pack, unpack};
pub use file::Study;
pub use finals::Final;
pub use journal::{Journal, Ledger, Line, Loaded};
pub use key::Key;
pub use objective::{Goal, Objective, Term};
pub use report::Report;
pub use run::{Watch, run, run_with};
pub use rung::{Judged, Rung};
pub use set::Tolerance;
pub use settings::{ClaimError, claim, differs};
pub use shard::{FoundShard, Merged, ShardDone, evaluate_shard, merge};
pub(crate) use stage::OTHERS as STAGES;
pub use stage::{Scoring, Stage, Work};
pub use start::Start;
pub use state::{Ended, Found, Front, Improvement, RungState, StageState, State, SurrogateState, front_of};
pub use tolerance::{Quantiles, Robustness};
pub use why::{Circumstances, Difference, Why, why};

use std::path::PathBuf;

use crate::dem::BatchError;
use crate::document::DocumentError;
use crate::evaluate::{EvaluatorError, PlanError};
use crate::layout::LayoutFileError;

/// Why a study cannot be run or read.
#[derive(Debug, thiserror::Error)]
pub enum StudyError {
    /// Something is wrong with the study file, or with the design file that it names.
    #[error(transparent)]
    File(Box<DocumentError>),
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
    /// Those who evaluate for it cannot.
    #[error("{0}")]
    Engine(String),
    /// The design cannot be evaluated.
    #[error(transparent)]
    Evaluator(#[from] EvaluatorError),
}

impl From<DocumentError> for StudyError {
    fn from(error: DocumentError) -> Self {
        Self::File(Box::new(error))
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
