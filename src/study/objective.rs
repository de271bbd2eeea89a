//! What is wanted: scores to one number, of which less is better.

use serde::Deserialize;

use super::Entry;
use crate::real::Real;

/// What is to be as great, or as small, as can be.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Goal {
    /// C = F/P, great
    Contrast,
    /// G = F/F(all host), great
    FocalGain,
    /// Q = P/P(all lens material), small
    Protection,
}

/// A goal within limits.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Objective {
    /// What is wanted.
    pub goal: Goal,
    /// C at least
    pub min_contrast: Option<f64>,
    /// G at least
    pub min_focal_gain: Option<f64>,
    /// Q at most
    pub max_protection: Option<f64>,
}

impl Objective {
    /// By how much, as parts of them, limits are missed; none for scores that are not there.
    fn misses(&self, entry: &Entry) -> Option<Vec<f64>> {
        let mut misses = Vec::new();
        for (limit, score) in [(self.min_contrast, entry.contrast), (self.min_focal_gain, entry.focal_gain)] {
            if let Some(limit) = limit {
                misses.push((1.0 - score? / limit).max(0.0));
            }
        }
        if let Some(limit) = self.max_protection {
            misses.push((entry.protection? / limit - 1.0).max(0.0));
        }
        Some(misses)
    }

    /// Whether all limits are kept.
    pub fn is_met(&self, entry: &Entry) -> bool {
        entry.stop.is_none() && self.misses(entry).is_some_and(|misses| misses.iter().all(|&miss| miss == 0.0))
    }

    /// The number to make small: -ln C, -ln G or ln Q, and for each limit missed by the part v of it
    ///
    ///   4 v + 20 v²
    ///
    /// which is continuous, so that a search may pass through what is not allowed, and rises from its first moment by more
    /// than the goal commonly gains there, so that it does not stay. Infinite for what a guard stopped.
    pub fn loss(&self, entry: &Entry) -> f64 {
        let score = match self.goal {
            Goal::Contrast => entry.contrast,
            Goal::FocalGain => entry.focal_gain,
            Goal::Protection => entry.protection,
        };
        let (Some(score), Some(misses), None) = (score, self.misses(entry), &entry.stop) else { return f64::INFINITY };
        if !score.is_normal() || score < 0.0 {
            return f64::INFINITY;
        }
        let ln = Real::ln(score);
        let goal = if self.goal == Goal::Protection { ln } else { -ln };
        goal + misses.iter().map(|v| 4.0 * v + 20.0 * v * v).sum::<f64>()
    }
}
