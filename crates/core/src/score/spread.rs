//! One score of several runs of a layout under forces close to each other.
//!
//! Under forces within a percent the contrast of one layout scatters by about as much: the motion behind a lens is chaotic. A score
//! over several of them is the exponential of the mean of the logarithms, so that it is the same whether C or 1/C is looked at, and
//! its spread is the standard deviation of one force's score.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

use super::{Measure, Scores, Unit};
use crate::real::Number;
use crate::stats::Mean;

/// Standard deviations of one force's scores, sample ones, below `contrast_sd` and so on; and the scores over the forces, below
/// `contrast_mean`.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Spreads(BTreeMap<String, f64>);

impl Spreads {
    /// The score over the forces.
    pub fn mean(&self, measure: Measure) -> Option<f64> {
        self.0.get(&key(measure, "mean")).copied()
    }

    /// The standard deviation of one force's score; none of a single force.
    pub fn deviation(&self, measure: Measure) -> Option<f64> {
        self.0.get(&key(measure, "sd")).copied()
    }
}

/// `focal_mean_mean_J`: what it is of stands before the unit.
fn key(measure: Measure, of: &str) -> String {
    match measure.column().strip_prefix(measure.name()) {
        Some(unit) => format!("{}_{of}{unit}", measure.name()),
        None => format!("{}_{of}", measure.name()),
    }
}

/// The score over runs of one layout under several forces, and how it scatters. What is not known of all of them is not known.
pub fn over_forces(runs: &[Scores]) -> (Scores, Spreads) {
    let [first, ..] = runs else { return (Scores::default(), Spreads::default()) };
    let mut score = first.clone();
    let mut spreads = BTreeMap::new();
    for &measure in Measure::ALL {
        let Some(values) = runs.iter().map(|run| run.get(measure)).collect::<Option<Vec<f64>>>() else {
            score.set(measure, None);
            continue;
        };
        // Counts and prices are the layout's, not a run's; residuals have a sign.
        if matches!(measure.unit(), Unit::Count | Unit::Money | Unit::Kilogram) {
            continue;
        }
        let Mean { mean, deviation, .. } = Mean::of(&values);
        let logarithmic = values.iter().all(|&value| value > 0.0);
        let mean = if logarithmic { geometric(&values) } else { mean };
        score.set(measure, Some(mean));
        if matches!(
            measure,
            Measure::FocalMean | Measure::ProtectedMean | Measure::Contrast | Measure::FocalGain | Measure::Protection
        ) {
            spreads.insert(key(measure, "mean"), mean);
            spreads.extend(deviation.map(|deviation| (key(measure, "sd"), deviation)));
        }
    }
    score.foci =
        (0..first.foci.len()).map(|k| geometric(&runs.iter().map(|run| run.foci[k]).collect::<Vec<_>>())).collect();
    (score, Spreads(spreads))
}

/// exp of the mean of ln of positive numbers, in our own logarithm, so that every platform has the same bits; 0 where one is 0.
pub fn geometric(values: &[f64]) -> f64 {
    let [first, rest @ ..] = values else { return 0.0 };
    if !values.iter().all(|&value| value.is_normal() && value > 0.0) {
        return 0.0;
    }
    // From the first, so that of one value nothing is rounded.
    let logarithms: f64 = rest.iter().map(|&value| Number::ln(value / first)).sum();
    first * Number::exp(logarithms / values.len() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// By hand: 2 and 8 have the geometric mean 4 and the sample deviation sqrt(18).
    #[test]
    fn scores_over_forces_are_geometric_means() {
        let run = |contrast| Scores { focal_mean: contrast, contrast: Some(contrast), ..Scores::default() };
        let (score, spreads) = over_forces(&[run(2.0), run(8.0)]);
        assert!((score.contrast.unwrap() - 4.0).abs() < 1e-14);
        assert!((score.focal_mean - 4.0).abs() < 1e-14);
        assert_eq!(spreads.mean(Measure::Contrast), score.contrast);
        assert!((spreads.deviation(Measure::Contrast).unwrap() - 18.0_f64.sqrt()).abs() < 1e-14);
        assert_eq!((score.protection, spreads.mean(Measure::Protection)), (None, None));
        let (one, alone) = over_forces(&[run(3.0)]);
        assert_eq!(one.contrast, Some(3.0));
        assert_eq!(alone.deviation(Measure::Contrast), None);
        let json = serde_json::to_value(&spreads).unwrap();
        assert!(json["contrast_mean"].is_f64() && json["contrast_sd"].is_f64() && json["focal_mean_sd_J"].is_f64());
        assert_eq!(over_forces(&[]).0, Scores::default());
    }
}
