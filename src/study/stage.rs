//! What a study does one after the other: each stage a method, its evaluations, and the step at which it simulates.

use serde::Deserialize;

use super::StudyError;
use super::source::Source;
use crate::search::{BATCH, Method, MethodError, ORDER};
use crate::units::Dimension::Time;

/// More is taken for a slip: all evaluations are held in memory.
pub(super) const MOST_EVALUATIONS: u64 = 10_000_000;

/// Finer fields than sites.
const MOST_ORDER: usize = 12;

/// As many beside each other as eight registers hold; beliefs about beliefs are worth little long before.
const MOST_BATCH: usize = 64;

/// What a stage does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Work {
    /// Searches, from the best layouts so far.
    Search(Method),
    /// Evaluates anew, at its own step, the best layouts so far and a sample of the others.
    Rescore,
}

impl Work {
    /// The name as it is written in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Search(method) => method.name(),
            Self::Rescore => "rescore",
        }
    }
}

/// One stage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stage {
    /// What it does.
    pub work: Work,
    /// Evaluations of layouts that are new at its step.
    pub evaluations: u64,
    /// Place of its step among the study's rungs.
    pub rung: usize,
    /// How many of the best layouts of the stages before it is given.
    pub promote: usize,
    /// How many layouts, evenly over the ranks of what the stages before evaluated, are evaluated with them, so that the rank
    /// correlation of the two steps is that of all and not of the best alone.
    pub sample: usize,
    /// Half waves each way of the fields of a level set, and one more; knots of a curve.
    pub order: usize,
    /// How many lenses a Bayesian search asks for at a time.
    pub batch: usize,
}

#[derive(Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct StageFile {
    method: String,
    evaluations: Option<u64>,
    step: Option<String>,
    promote: Option<usize>,
    sample: Option<usize>,
    order: Option<usize>,
    batch: Option<usize>,
}

/// Stages, and the different steps at which they simulate (s), none being the design's own; in order of first use.
pub(super) fn read(source: &Source<'_>, files: &[StageFile]) -> Result<(Vec<Stage>, Vec<Option<f64>>), StudyError> {
    let mut rungs: Vec<Option<f64>> = Vec::new();
    let mut stages: Vec<Stage> = Vec::new();
    for (k, file) in files.iter().enumerate() {
        let fail = |key: &str, message: String| source.fail_in("stage", k, key, message);
        let step = match &file.step {
            Some(text) => Some(source.quantity(Time, "step", text, |message| fail("step", message))?),
            None => None,
        };
        let rung = rungs.iter().position(|&known| known == step).unwrap_or_else(|| {
            rungs.push(step);
            rungs.len() - 1
        });
        let work = match file.method.as_str() {
            "rescore" => Work::Rescore,
            name => match name.parse() {
                Ok(method) => Work::Search(method),
                Err(error @ MethodError::Unknown(_)) => return Err(fail("method", format!("{error}, rescore."))),
                Err(error) => return Err(fail("method", format!("{error}."))),
            },
        };
        let several =
            matches!(work, Work::Search(Method::Genetic | Method::GeneticLocal | Method::Nsga) | Work::Rescore);
        let promote = file.promote.unwrap_or(if several { 16 } else { 1 });
        let sample = file.sample.unwrap_or(0);
        if work == Work::Rescore && k == 0 {
            return Err(fail(
                "method",
                "method = \"rescore\" has nothing to evaluate anew in the first stage.".to_owned(),
            ));
        }
        if work != Work::Rescore && sample > 0 {
            return Err(fail("sample", "sample belongs to stages with method = \"rescore\".".to_owned()));
        }
        let order = file.order.unwrap_or(ORDER);
        if file.order.is_some() && !matches!(work, Work::Search(Method::LevelSet | Method::Curves)) {
            let message = "order belongs to stages with method = \"level-set\" or \"curves\".";
            return Err(fail("order", message.to_owned()));
        }
        if !(2..=MOST_ORDER).contains(&order) {
            let message = format!("order = {order} must be 2 to {MOST_ORDER}: cosines each way, or knots of a curve.");
            return Err(fail("order", message));
        }
        if file.batch.is_some() && !matches!(work, Work::Search(method) if method.takes_batch()) {
            return Err(fail("batch", "batch belongs to stages with method = \"lens-family-bayes\".".to_owned()));
        }
        let batch = file.batch.unwrap_or(BATCH);
        if !(1..=MOST_BATCH).contains(&batch) {
            return Err(fail("batch", format!("batch = {batch} must be 1 to {MOST_BATCH} lenses at a time.")));
        }
        let evaluations = match (work, file.evaluations) {
            (Work::Rescore, None) => promote as u64 + sample as u64,
            (Work::Rescore, Some(_)) => {
                return Err(fail(
                    "evaluations",
                    "a rescore evaluates promote and sample; leave evaluations out.".to_owned(),
                ));
            }
            (_, Some(evaluations)) => evaluations,
            (_, None) => {
                return Err(fail("evaluations", "evaluations is missing: how many this stage may do.".to_owned()));
            }
        };
        if !(1..=MOST_EVALUATIONS).contains(&evaluations) {
            return Err(fail("evaluations", format!("evaluations = {evaluations} must be 1 to {MOST_EVALUATIONS}.")));
        }
        stages.push(Stage { work, evaluations, rung, promote: promote.max(1), sample, order, batch });
    }
    Ok((stages, rungs))
}

/// The one stage of a study that names its method at the top.
pub(super) fn single(method: Method, evaluations: u64) -> Stage {
    Stage { work: Work::Search(method), evaluations, rung: 0, promote: 1, sample: 0, order: ORDER, batch: BATCH }
}
