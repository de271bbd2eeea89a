//! A score of several forces: the motion behind a lens is chaotic, and under forces within a percent of each other scores scatter by
//! about as much.

use super::{Evaluated, Evaluator, EvaluatorError, ImpactLoad, LoadCase, Overrides, Plan, Subject};
use crate::Context;
use crate::dem::Stop;
use crate::design::Design;

/// How many forces, evenly spaced, and how far the outermost lie from the design's own, as a part of it. Of a projectile they are speeds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Forces {
    count: usize,
    band: f64,
}

/// Forces that cannot be.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum ForcesError {
    /// None, or too many.
    #[error("{0} forces: 1 to {MOST} can be asked for")]
    Count(usize),
    /// A band that holds nothing, or forces that pull.
    #[error("a band of {0}: must be more than 0 % and at most 50 % of the force")]
    Band(f64),
}

/// More tell no more.
const MOST: usize = 64;

impl Default for Forces {
    /// The design's own.
    fn default() -> Self {
        Self::ONE
    }
}

impl Forces {
    /// The design's own.
    pub const ONE: Self = Self { count: 1, band: 0.01 };

    /// What verdicts are judged over: 8 within 1 %.
    pub const USUAL: Self = Self { count: 8, band: 0.01 };

    /// So many, to both sides of the design's own within a part of it.
    ///
    /// # Errors
    /// See [`ForcesError`].
    pub fn new(count: usize, band: f64) -> Result<Self, ForcesError> {
        if !(1..=MOST).contains(&count) {
            return Err(ForcesError::Count(count));
        }
        if !(band > 0.0 && band <= 0.5) {
            return Err(ForcesError::Band(band));
        }
        Ok(Self { count, band })
    }

    /// How many.
    pub fn count(self) -> usize {
        self.count
    }

    /// The part of the force by which the outermost differ from it.
    pub fn band(self) -> f64 {
        self.band
    }

    /// Whether there is but the design's own.
    pub fn is_one(self) -> bool {
        self.count == 1
    }

    /// The forces about one (N), from the least to the greatest.
    pub fn about(self, force: f64) -> Vec<f64> {
        if self.is_one() {
            return vec![force];
        }
        let last = (self.count - 1) as f64;
        (0..self.count).map(|k| force * (1.0 + self.band * (2.0 * k as f64 / last - 1.0))).collect()
    }
}

impl Forces {
    /// A load as it is, then with each of the strengths about its own.
    pub fn with_own(self, load: ImpactLoad) -> Vec<ImpactLoad> {
        let own = load.strike.strength();
        let with = |strength| ImpactLoad { strike: load.strike.with_strength(strength), ..load };
        std::iter::once(own).chain(self.about(own)).map(with).collect()
    }
}

/// Pieces of one design, of one palette, under several forces: for each its scores under each, not yet related to uniform crystals.
pub(super) fn under_forces(
    design: &Design,
    plan: &Plan,
    pieces: &[Subject<'_>],
    forces: &[f64],
    context: &Context,
) -> Result<Vec<Vec<Evaluated>>, EvaluatorError> {
    let Some(first) = pieces.first() else { return Ok(Vec::new()) };
    let given = Overrides {
        integrator: Some(plan.integrator),
        step: Some(plan.step),
        window: Some(plan.window),
        first_seed: None,
    };
    // Of symmetric pieces the half is simulated, of others the whole.
    let mut found: Vec<Vec<Evaluated>> = vec![Vec::new(); pieces.len()];
    for halves_differ in [false, true] {
        let alike: Vec<usize> = (0..pieces.len()).filter(|&k| pieces[k].left.is_some() == halves_differ).collect();
        if alike.is_empty() {
            continue;
        }
        let case = |&force: &f64| {
            let load = ImpactLoad::from(design.impact.with_strength(force));
            LoadCase { halves_differ, ..LoadCase::from(load) }
        };
        let cases: Vec<LoadCase> = forces.iter().map(case).collect();
        let evaluator = Evaluator::alone(design, &cases, first.layout.palette.clone(), given)?;
        let drawn: Vec<Vec<u8>> = alike.iter().map(|&k| pieces[k].drawn()).collect();
        for (k, runs) in alike.into_iter().zip(evaluator.scores(&drawn, context)?) {
            found[k] = runs;
        }
    }
    if found.iter().flatten().any(|run| matches!(run.stop, Some(Stop::Interrupted { .. }))) {
        return Err(EvaluatorError::Interrupted);
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn forces_are_evenly_spaced_about_the_design_s_own() {
        assert_eq!(Forces::ONE.about(26e3), [26e3]);
        let eight = Forces::USUAL.about(100.0);
        assert_eq!(eight.len(), 8);
        assert!((eight[0] - 99.0).abs() < 1e-12 && (eight[7] - 101.0).abs() < 1e-12);
        assert!(eight.windows(2).all(|two| (two[1] - two[0] - 2.0 / 7.0).abs() < 1e-12));
        assert_eq!(Forces::new(0, 0.01), Err(ForcesError::Count(0)));
        assert_eq!(Forces::new(8, 0.0), Err(ForcesError::Band(0.0)));
        assert!(Forces::new(8, f64::NAN).is_err());
    }
}
