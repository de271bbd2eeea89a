//! What strikes the crystal.

use std::fmt;

use serde::{Deserialize, Serialize};

use crate::units::Dimension;

/// A constant force along the last axis on every struck sphere.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ForcePulse {
    /// Force on each struck sphere (N).
    pub force: f64,
    /// How long it lasts (s).
    pub duration: f64,
}

impl ForcePulse {
    /// The mean force (N) during the step that begins at `step_index * step`. The pulse covers whole steps; a step that it
    /// ends within has its force scaled, so that the impulse is exact.
    pub fn during(&self, step_index: u64, step: f64) -> f64 {
        // In units of steps; a pulse that ends within a billionth of a step ends with it.
        let left = self.duration / step - step_index as f64;
        match left {
            left if left > 1.0 - 1e-9 => self.force,
            left if left > 1e-9 => self.force * left,
            _ => 0.0,
        }
    }
}

/// A rigid flat that strikes all of the first layer at once, along the last axis. It is smooth, moves along that axis alone, and each sphere meets it
/// as it would meet an equal sphere: at twice the overlap and twice the closing speed (Burgoyne 2016, appendix A.1, 2.c.ii).
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Projectile {
    /// Mass (kg) of what of it stands before what is simulated.
    pub mass: f64,
    /// Speed (m/s) with which it arrives.
    pub speed: f64,
    /// Where its face lies along the last axis as it arrives (m); if none, where it touches the first of the spheres that it strikes. Pieces of several sizes are judged
    /// before one face, so that none depends on those beside it.
    #[serde(skip)]
    pub front: Option<f64>,
}

/// What strikes the first layer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Strike {
    /// A force on every struck sphere.
    Pulse(ForcePulse),
    /// A flat.
    Projectile(Projectile),
}

impl From<ForcePulse> for Strike {
    fn from(pulse: ForcePulse) -> Self {
        Self::Pulse(pulse)
    }
}

impl From<Projectile> for Strike {
    fn from(projectile: Projectile) -> Self {
        Self::Projectile(projectile)
    }
}

/// `26 kN for 20 us`, or `a projectile of 500 g at 20 m/s`.
impl fmt::Display for Strike {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Pulse(ForcePulse { force, duration }) => {
                write!(f, "{} for {}", Dimension::Force.show(*force), Dimension::Time.show(*duration))
            }
            Self::Projectile(Projectile { mass, speed, .. }) => {
                write!(f, "a projectile of {} at {}", Dimension::Mass.show(*mass), Dimension::Speed.show(*speed))
            }
        }
    }
}

impl Strike {
    /// How hard it is: the force of a pulse (N), the speed of a projectile (m/s).
    pub fn strength(&self) -> f64 {
        match self {
            Self::Pulse(pulse) => pulse.force,
            Self::Projectile(projectile) => projectile.speed,
        }
    }

    /// The same, so hard.
    #[must_use]
    pub fn with_strength(self, strength: f64) -> Self {
        match self {
            Self::Pulse(pulse) => Self::Pulse(ForcePulse { force: strength, ..pulse }),
            Self::Projectile(projectile) => Self::Projectile(Projectile { speed: strength, ..projectile }),
        }
    }

    /// What strikes a part of a crystal, where it is this that strikes the whole: of a projectile as much of the mass.
    #[must_use]
    pub fn of_part(self, part: f64) -> Self {
        match self {
            Self::Pulse(_) => self,
            Self::Projectile(flat) => Self::Projectile(Projectile { mass: part * flat.mass, ..flat }),
        }
    }

    /// How long a pulse lasts (s); a projectile stays as long as it is not thrown back, and has none.
    pub fn duration(&self) -> Option<f64> {
        match self {
            Self::Pulse(pulse) => Some(pulse.duration),
            Self::Projectile(_) => None,
        }
    }

    /// The pulse, if it is one.
    pub fn pulse(&self) -> Option<ForcePulse> {
        match *self {
            Self::Pulse(pulse) => Some(pulse),
            Self::Projectile(_) => None,
        }
    }

    /// The projectile, if it is one.
    pub fn projectile(&self) -> Option<Projectile> {
        match *self {
            Self::Pulse(_) => None,
            Self::Projectile(projectile) => Some(projectile),
        }
    }

    /// Whether both are pulses, or both projectiles of one mass, so that they can strike side by side.
    pub fn is_like(&self, other: &Self) -> bool {
        self.projectile().map(|projectile| projectile.mass) == other.projectile().map(|projectile| projectile.mass)
    }
}

#[cfg(test)]
mod tests {
    use super::ForcePulse;

    #[test]
    fn the_impulse_is_exact_for_every_step() {
        let pulse = ForcePulse { force: 26e3, duration: 20e-6 };
        for step in [5e-8, 1e-7, 3e-7, 4e-7, 1.3e-6, 20e-6] {
            let impulse: f64 = (0..1000).map(|k| pulse.during(k, step) * step).sum();
            assert!((impulse / (26e3 * 20e-6) - 1.0).abs() < 1e-12, "step {step}: {impulse}");
        }
    }
}
