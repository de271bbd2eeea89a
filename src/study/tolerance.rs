//! What a layout loses where it is not built as drawn.

use serde::{Deserialize, Serialize};

use super::aggregate::of_runs;
use super::{Study, StudyError};
use crate::Context;
use crate::evaluate::{Evaluator, Imperfection};
use crate::score::{Measure, Scores};

/// Losses over crystals that are built with imperfections, each a part of what the crystal as drawn has; negative where something is
/// gained.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Robustness {
    /// How many crystals were built.
    pub crystals: u64,
    /// How many of them a guard stopped; these count as having lost all.
    pub stopped: u64,
    /// Of C
    #[serde(alias = "C")]
    pub contrast: Option<Quantiles>,
    /// Of G
    #[serde(alias = "G")]
    pub focal_gain: Option<Quantiles>,
    /// Of Q: by how much it rises
    #[serde(alias = "Q")]
    pub protection: Option<Quantiles>,
}

/// Losses that a half and nine tenths of the crystals do not exceed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Quantiles {
    /// Half of them lose no more.
    pub median: f64,
    /// Nine tenths of them lose no more.
    #[serde(rename = "90_percent")]
    pub ninety: f64,
}

impl Quantiles {
    /// The least values that are not below a half and nine tenths of all; none of no value.
    pub fn of(mut values: Vec<f64>) -> Option<Self> {
        values.sort_by(f64::total_cmp);
        let at = |part: f64| values.get((part * values.len() as f64).ceil() as usize - 1).copied();
        if values.is_empty() { None } else { Some(Self { median: at(0.5)?, ninety: at(0.9)? }) }
    }
}

/// Builds a layout with the tolerance's reported crystals and judges each under all impacts; none without a tolerance.
pub(super) fn evaluate(
    study: &Study,
    assignment: &[u8],
    rung: usize,
    context: &Context,
) -> Result<Option<Robustness>, StudyError> {
    let Some(tolerance) = study.tolerance.filter(|tolerance| tolerance.reported > 0) else { return Ok(None) };
    let mut imperfections = vec![Imperfection::default()];
    imperfections.extend(study.imperfections(1, tolerance.reported));
    let cases = study.under_each_impact(&imperfections);
    let overrides = study.overrides(rung);
    let evaluator = Evaluator::new(study.design(), &cases, study.palette.clone(), overrides, context)?;
    let layout = study.materials(assignment);
    let runs = evaluator.scores(std::slice::from_ref(&layout), context)?.concat();
    let stats = study.counter.stats(&layout);
    let of_crystals = runs.chunks(study.impacts.len() * study.forces.count());
    let mut built = of_crystals.map(|runs| of_runs(study, runs, &stats));
    let Some(drawn) = built.next().flatten() else { return Ok(None) };
    let built: Vec<Option<Scores>> = built.collect();
    let losses = |measure: Measure, lost: fn(f64) -> f64| {
        let drawn = drawn.get(measure)?;
        // What a guard stopped has lost all.
        let of = |built: &Option<Scores>| {
            built.as_ref().and_then(|scores| scores.get(measure)).map_or(1.0, |value| lost(value / drawn))
        };
        Quantiles::of(built.iter().map(of).collect())
    };
    Ok(Some(Robustness {
        crystals: built.len() as u64,
        stopped: built.iter().filter(|built| built.is_none()).count() as u64,
        contrast: losses(Measure::Contrast, |kept| 1.0 - kept),
        focal_gain: losses(Measure::FocalGain, |kept| 1.0 - kept),
        protection: losses(Measure::Protection, |kept| kept - 1.0),
    }))
}

#[cfg(test)]
mod tests {
    use super::Quantiles;

    /// Of ten values the fifth and the ninth; of one that one.
    #[test]
    fn quantiles_are_values() {
        let of = |values: &[f64]| Quantiles::of(values.to_vec()).map(|q| (q.median, q.ninety));
        assert_eq!(of(&[9.0, 1.0, 8.0, 2.0, 7.0, 3.0, 6.0, 4.0, 5.0, 10.0]), Some((5.0, 9.0)));
        assert_eq!(of(&[3.0]), Some((3.0, 3.0)));
        assert_eq!(of(&[]), None);
    }
}
