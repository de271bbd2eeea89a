//! The figures that a study's layout is known by: at the design's force and smoothed over forces, at two steps.

use serde::{Deserialize, Serialize};

use super::aggregate::summary;
use super::{Entry, Study, StudyError};
use crate::Context;
use crate::evaluate::{Evaluated, Evaluator, Forces, ImpactLoad, Overrides};
use crate::score::{Measure, Scores};

/// One layout at one step: single numbers, and what they are worth.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Final {
    /// The step (s).
    #[serde(rename = "step_s")]
    pub step: f64,
    /// The window (s).
    #[serde(rename = "window_s")]
    pub window: f64,
    /// At the force of each impact itself, as `check` has them: worst or mean over impacts, as the study counts.
    pub exact: Scores,
    /// Over [`Forces::USUAL`] about each.
    pub smoothed: Scores,
    /// Standard deviation of C, G and Q of a single force; of several impacts the greatest.
    pub scatter: [Option<f64>; 3],
}

/// A layout at a study's finest step and at half of it; none where it was interrupted, or a guard stopped it.
pub(super) fn evaluate(
    study: &Study,
    assignment: &[u8],
    step: f64,
    context: &Context,
) -> Result<Vec<Final>, StudyError> {
    let layout = study.materials(assignment);
    let stats = study.counter.stats(&layout);
    // Of each impact the exact force, then those about it.
    let loads: Vec<ImpactLoad> = study.impacts.iter().flat_map(|&load| Forces::USUAL.with_own(load)).collect();
    let mut finals = Vec::new();
    for step in [step, 0.5 * step] {
        let overrides = Overrides { step: Some(step), window: study.window, ..Overrides::default() };
        let evaluator = Evaluator::new(study.design(), &loads, study.palette.clone(), overrides, context)?;
        let runs = evaluator.scores(std::slice::from_ref(&layout), context)?.concat();
        if context.stopped() {
            return Ok(Vec::new());
        }
        let each: Vec<&[Evaluated]> = runs.chunks(1 + Forces::USUAL.count()).collect();
        let entry = |of: &dyn Fn(&'_ [Evaluated]) -> std::ops::Range<usize>| {
            let parts: Vec<&[Evaluated]> = each.iter().map(|runs| &runs[of(runs)]).collect();
            Entry::new(String::new(), String::new(), &parts)
        };
        let (exact, smoothed) = (entry(&|_| 0..1), entry(&|runs| 1..runs.len()));
        if exact.stop.is_some() || smoothed.stop.is_some() {
            return Ok(Vec::new());
        }
        let scatter = [Measure::Contrast, Measure::FocalGain, Measure::Protection].map(|measure| {
            smoothed.over_forces.iter().filter_map(|spreads| spreads.deviation(measure)).reduce(f64::max)
        });
        finals.push(Final {
            step,
            window: evaluator.plan().window,
            exact: summary(&exact, &stats, study.objective.aggregate),
            smoothed: summary(&smoothed, &stats, study.objective.aggregate),
            scatter,
        });
    }
    Ok(finals)
}
