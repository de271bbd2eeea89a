//! The section [thresholds]: what `check --strict` asks of the scores.

use super::DesignError;
use super::file::{BoundsFile, EXAMPLES, ThresholdsFile};
use crate::document::{Entry, Scope, Section, example};
use crate::score::Scores;
use crate::units::Dimension;

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

/// A score that can be bounded, by its name in files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Measure {
    /// C = F/P
    Contrast,
    /// G
    FocalGain,
    /// Q
    Protection,
    /// F (J)
    FocalMean,
    /// P (J)
    ProtectedMean,
    /// Loss in the contacts (J)
    Dissipated,
    /// Energy residual as a fraction of the work, signed
    Residual,
}

impl Measure {
    /// The name used in files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Contrast => "contrast",
            Self::FocalGain => "focal_gain",
            Self::Protection => "protection",
            Self::FocalMean => "focal_mean",
            Self::ProtectedMean => "protected_mean",
            Self::Dissipated => "dissipated",
            Self::Residual => "residual",
        }
    }

    /// What the score measures; none for ratios, which are plain numbers.
    pub const fn dimension(self) -> Option<Dimension> {
        match self {
            Self::FocalMean | Self::ProtectedMean | Self::Dissipated => Some(Dimension::Energy),
            Self::Contrast | Self::FocalGain | Self::Protection | Self::Residual => None,
        }
    }

    /// Its value among the scores of an arrangement; none where a ratio has no denominator.
    pub fn of(self, scores: &Scores) -> Option<f64> {
        match self {
            Self::Contrast => scores.contrast,
            Self::FocalGain => scores.focal_gain,
            Self::Protection => scores.protection,
            Self::FocalMean => Some(scores.focal_mean),
            Self::ProtectedMean => Some(scores.protected_mean),
            Self::Dissipated => Some(scores.dissipated),
            Self::Residual => Some(scores.residual),
        }
    }
}

impl Threshold {
    /// Whether a value of the score lies within the bounds; NaN does not.
    pub fn admits(&self, value: f64) -> bool {
        !value.is_nan() && self.min.is_none_or(|min| value >= min) && self.max.is_none_or(|max| value <= max)
    }
}

pub(super) fn read((scope, file): &(Scope, &ThresholdsFile)) -> Result<Vec<Threshold>, DesignError> {
    let written: [(Measure, &Section<BoundsFile>); 7] = [
        (Measure::Contrast, &file.contrast),
        (Measure::FocalGain, &file.focal_gain),
        (Measure::Protection, &file.protection),
        (Measure::FocalMean, &file.focal_mean),
        (Measure::ProtectedMean, &file.protected_mean),
        (Measure::Dissipated, &file.dissipated),
        (Measure::Residual, &file.residual),
    ];
    let bounds =
        written.into_iter().filter_map(|(measure, section)| Some((measure, scope.section(measure.name(), section)?)));
    bounds.map(|(measure, section)| threshold(measure, &section)).collect()
}

fn threshold(measure: Measure, (scope, file): &(Scope, &BoundsFile)) -> Result<Threshold, DesignError> {
    let value = |entry: &Entry| match measure.dimension() {
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
            let example = example(EXAMPLES, &format!("thresholds.{}", measure.name())).unwrap_or_default();
            Err(scope.fail("has neither min nor max", &format!("Write it like {example}.")))
        }
        _ => Ok(threshold),
    }
}
