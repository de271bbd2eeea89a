//! The section [thresholds]: what `check --strict` asks of the scores.

use super::DesignError;
use super::file::{BoundsFile, ThresholdsFile};
use crate::document::{Entry, Scope, did_you_mean, example, nearest};
use crate::score::Measure;

/// How thresholds are written, for messages: of designs and of tolerances.
pub(crate) const THRESHOLDS: &[&str] = &[
    "thresholds.contrast = { min = 2.0 }",
    "thresholds.focal_gain = { min = 1.5 }",
    "thresholds.protection = { max = 0.8 }",
    "thresholds.focal_mean = { min = \"0.3 J\" }",
    "thresholds.protected_mean = { max = \"0.1 J\" }",
    "thresholds.dissipated = { max = \"40 J\" }",
    "thresholds.residual = { min = -0.01, max = 0.01 }",
];

/// Bounds on one score, both included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Threshold {
    /// Which score.
    pub measure: Measure,
    /// Least value that passes, where given; energies in joules.
    pub min: Option<f64>,
    /// Greatest value that passes, where given; energies in joules.
    pub max: Option<f64>,
}

impl Threshold {
    /// Whether a value of the score lies within the bounds; NaN does not.
    pub fn admits(&self, value: f64) -> bool {
        !value.is_nan() && self.min.is_none_or(|min| value >= min) && self.max.is_none_or(|max| value <= max)
    }
}

pub(crate) fn read((scope, file): &(Scope, &ThresholdsFile)) -> Result<Vec<Threshold>, DesignError> {
    let mut thresholds: Vec<Threshold> = Vec::new();
    for (name, section) in *file {
        let Some((place, bounds)) = scope.section(name.get_ref(), section) else { continue };
        let Some(measure) = Measure::find(name.get_ref()) else {
            let known: Vec<&str> = Measure::ALL.iter().map(|measure| measure.name()).collect();
            let near = did_you_mean(nearest(name.get_ref(), known.iter().copied()));
            let help = format!("{near}Known in {} are {}.", scope.name(), known.join(", "));
            return Err(place.fail("is no known key", &help));
        };
        if thresholds.iter().any(|known| known.measure == measure) {
            return Err(place.fail("bounds the same measure as another", "Name each measure once."));
        }
        thresholds.push(threshold(measure, &(place, bounds))?);
    }
    thresholds.sort_by_key(|threshold| threshold.measure as usize);
    Ok(thresholds)
}

fn threshold(measure: Measure, (scope, file): &(Scope, &BoundsFile)) -> Result<Threshold, DesignError> {
    let value = |entry: &Entry| match measure.unit().dimension() {
        Some(dimension) => entry.quantity(dimension),
        None => entry.number(),
    };
    let [min, max] = [scope.optional("min", &file.min), scope.optional("max", &file.max)];
    let threshold =
        Threshold { measure, min: min.as_ref().map(value).transpose()?, max: max.as_ref().map(value).transpose()? };
    match (threshold.min, threshold.max) {
        (Some(least), Some(greatest)) if least > greatest => {
            Err(scope.fail("can never be met: min is greater than max", "Exchange them, or leave one out."))
        }
        (None, None) => {
            let example = example(THRESHOLDS, &format!("thresholds.{}", measure.name()))
                .unwrap_or_else(|| format!("{} = {{ min = 1 }}", measure.name()));
            Err(scope.fail("has neither min nor max", &format!("Write it like {example}.")))
        }
        _ => Ok(threshold),
    }
}
