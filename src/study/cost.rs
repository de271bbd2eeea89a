//! What a study will cost, from one batch at each of its steps.

use std::time::Instant;

use super::{Study, StudyError};
use crate::Context;
use crate::evaluate::Evaluator;
use crate::real::Width;

/// What a stage will cost.
#[derive(Clone, Debug, PartialEq)]
pub struct StageCost {
    /// Name of its method.
    pub method: &'static str,
    /// Evaluations at most.
    pub evaluations: u64,
    /// Step (s).
    pub step: f64,
    /// Time of one core for all of them (s).
    pub core_seconds: f64,
}

/// Simulates one batch of the layout that the study starts from, at each of its steps and under all its impacts.
///
/// # Errors
/// As [`run`](super::run), but for the journal, which is not looked at.
pub fn costs(study: &Study, context: &Context) -> Result<Vec<StageCost>, StudyError> {
    let lanes = Width::widest().lanes();
    let batch = vec![study.bases[0].clone(); lanes];
    let one = rayon::ThreadPoolBuilder::new().num_threads(1).build();
    let rungs = (0..study.rungs.len())
        .map(|rung| {
            let overrides = study.overrides(rung);
            let cases = study.at(rung).cases();
            let evaluator = Evaluator::new(study.design(), &cases, study.palette.clone(), overrides, context)?
                .recording(study.detail());
            let begun = Instant::now();
            match &one {
                Ok(pool) => pool.install(|| evaluator.scores(&batch, context))?,
                Err(_) => evaluator.scores(&batch, context)?,
            };
            Ok((evaluator.plan().step, begun.elapsed().as_secs_f64() / lanes as f64))
        })
        .collect::<Result<Vec<_>, StudyError>>()?;
    Ok(study
        .stages
        .iter()
        .map(|stage| {
            let (step, seconds) = rungs[stage.rung];
            let evaluations = stage.evaluations;
            let judged = stage.most_evaluations() - evaluations;
            let core_seconds = rungs[stage.screen].1 * evaluations as f64 + seconds * judged as f64;
            StageCost { method: stage.work.name(), evaluations, step, core_seconds }
        })
        .collect())
}
