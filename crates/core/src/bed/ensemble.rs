//! Many impacts: beds of several seeds, speeds and kinds of friction, and what they come to on average.

use serde::{Deserialize, Serialize};

use super::{BedImpact, Course, Fitted, Grains, Measures, exponent, stop_words};
use crate::stats::Mean;

/// Which impacts are made: every speed with every kind of friction on every sample.
#[derive(Clone, Debug, PartialEq)]
pub struct Ensemble {
    /// Beds, of successive seeds.
    pub samples: u32,
    /// Speeds of the intruder (d/τ_c).
    pub speeds: Vec<f64>,
    /// Kinds of friction.
    pub friction: Vec<Rubbing>,
}

/// A kind of friction.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Rubbing {
    /// As the bed file has it.
    AsGiven,
    /// None.
    None,
    /// Damping and a cap alone, k_t = 0.
    Kinetic,
    /// With Cundall and Strack's spring: the file's k_t or, where that is zero, 0.8 k.
    Static,
}

impl Rubbing {
    /// Its name, as in a bed file.
    pub fn name(self) -> &'static str {
        match self {
            Self::AsGiven => "as-given",
            Self::None => "none",
            Self::Kinetic => "kinetic",
            Self::Static => "static",
        }
    }

    /// Grains with this kind of friction.
    pub fn of(self, mut grains: Grains) -> Grains {
        for surface in [&mut grains.grains, &mut grains.walls] {
            match self {
                Self::AsGiven => {}
                Self::None => (surface.friction, surface.tangential_stiffness) = (0.0, 0.0),
                Self::Kinetic => surface.tangential_stiffness = 0.0,
                Self::Static if surface.tangential_stiffness == 0.0 => surface.tangential_stiffness = 0.8,
                Self::Static => {}
            }
        }
        grains
    }
}

/// One impact of an ensemble.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Case {
    /// Kind of friction.
    pub friction: Rubbing,
    /// Speed (d/τ_c).
    pub speed: f64,
    /// Place of the sample among all, from 0.
    pub sample: u32,
}

impl Case {
    /// The impact of a bed file as this case has it.
    pub fn of(&self, impact: &BedImpact) -> BedImpact {
        let mut impact = *impact;
        impact.grains = self.friction.of(impact.grains);
        impact.intruder.speed = self.speed;
        impact
    }
}

impl Ensemble {
    /// All cases: friction first, then speeds, then samples.
    pub fn cases(&self) -> Vec<Case> {
        let mut cases = Vec::new();
        for &friction in &self.friction {
            for &speed in &self.speeds {
                cases.extend((0..self.samples).map(|sample| Case { friction, speed, sample }));
            }
        }
        cases
    }
}

/// What came of one impact.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    /// Kind of friction.
    pub friction: Rubbing,
    /// Speed (d/τ_c).
    pub speed: f64,
    /// Seed of the bed; none for one from a file.
    pub seed: Option<u64>,
    /// Area of the grains over that of the bed at rest, of 0 to 1.
    pub volume_fraction: f64,
    /// Contacts of a grain of the bed at rest, on average.
    pub coordination: f64,
    /// Mean depth at the end (d).
    pub final_depth_d: f64,
    /// Greatest depth (d).
    pub max_depth_d: f64,
    /// By how much the intruder went deeper than it stayed (d).
    pub overshoot_d: f64,
    /// Greatest force on the intruder (m d/τ_c²).
    pub peak_force: f64,
    /// When it was felt (τ_c).
    pub peak_force_time_tau_c: f64,
    /// Why a guard stopped the run, if one did; then it does not count in the means.
    pub stop: Option<String>,
}

impl Outcome {
    /// From the course of a case on a bed.
    pub fn new(case: &Case, seed: Option<u64>, measures: &Measures, course: &Course) -> Self {
        Self {
            friction: case.friction,
            speed: case.speed,
            seed,
            volume_fraction: measures.volume_fraction,
            coordination: measures.coordination,
            final_depth_d: course.final_depth,
            max_depth_d: course.max_depth,
            overshoot_d: course.overshoot(),
            peak_force: course.peak_force[0],
            peak_force_time_tau_c: course.peak_force[1],
            stop: course.stop.as_ref().map(stop_words),
        }
    }
}

/// All samples of one kind of friction at one speed.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Cell {
    /// Kind of friction.
    pub friction: Rubbing,
    /// Speed (d/τ_c).
    pub speed: f64,
    /// Samples that count.
    pub samples: usize,
    /// Runs that a guard stopped.
    pub stopped: usize,
    /// Depth at the end (d).
    pub final_depth_d: Mean,
    /// Greatest depth (d).
    pub max_depth_d: Mean,
    /// Greatest depth less that at the end (d).
    pub overshoot_d: Mean,
    /// Greatest force on the intruder (m d/τ_c²).
    pub peak_force: Mean,
}

/// Means over the samples, a cell for each kind of friction and speed, in the order of the ensemble; cells in which no run came to
/// its end are left out.
pub fn summarise(ensemble: &Ensemble, outcomes: &[Outcome]) -> Vec<Cell> {
    let mut cells = Vec::new();
    for &friction in &ensemble.friction {
        for &speed in &ensemble.speeds {
            let here = outcomes.iter().filter(|outcome| outcome.friction == friction && outcome.speed == speed);
            let (whole, stopped): (Vec<&Outcome>, Vec<&Outcome>) = here.partition(|outcome| outcome.stop.is_none());
            if whole.is_empty() {
                continue;
            }
            let of = |number: fn(&Outcome) -> f64| {
                Mean::of(&whole.iter().map(|outcome| number(outcome)).collect::<Vec<f64>>())
            };
            cells.push(Cell {
                friction,
                speed,
                samples: whole.len(),
                stopped: stopped.len(),
                final_depth_d: of(|outcome| outcome.final_depth_d),
                max_depth_d: of(|outcome| outcome.max_depth_d),
                overshoot_d: of(|outcome| outcome.overshoot_d),
                peak_force: of(|outcome| outcome.peak_force),
            });
        }
    }
    cells
}

/// How the depth at the end grows with the impact, of one kind of friction: D ∝ vᵃ and D ∝ Hᵇ.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Scaling {
    /// Kind of friction.
    pub friction: Rubbing,
    /// a, by the speed v at the start.
    pub by_speed: Option<Fitted>,
    /// b, by the whole drop H from where the intruder would have been at rest to where it ends (Kondic et al. 2012, fig. 30).
    pub by_drop: Option<Fitted>,
}

/// Exponents over all impacts that came to their end, of five or more with depths and speeds above zero.
pub fn scaling(ensemble: &Ensemble, outcomes: &[Outcome], impact: &BedImpact) -> Vec<Scaling> {
    let fall = impact.grains.fall();
    let of = |&friction: &Rubbing| {
        let whole = outcomes.iter().filter(|outcome| outcome.friction == friction && outcome.stop.is_none());
        let (mut by_speed, mut by_drop) = (Vec::new(), Vec::new());
        for &Outcome { speed, final_depth_d, .. } in whole {
            by_speed.push([speed, final_depth_d]);
            by_drop.push([0.5 * speed * speed / fall + impact.intruder.height + final_depth_d, final_depth_d]);
        }
        Scaling { friction, by_speed: exponent(&by_speed), by_drop: exponent(&by_drop) }
    };
    ensemble.friction.iter().map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kinds_of_friction_are_what_they_are_called() {
        let kinetic = Grains::default();
        let fixed = Rubbing::Static.of(kinetic);
        assert_eq!((fixed.grains.tangential_stiffness, fixed.walls.tangential_stiffness), (0.8, 0.8));
        assert_eq!(Rubbing::Kinetic.of(fixed), kinetic);
        assert!(!Rubbing::None.of(fixed).laws(true).has_friction());
        assert!(Rubbing::AsGiven.of(kinetic).laws(true).has_friction());
    }
}
