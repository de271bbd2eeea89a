//! The stiffest contact that may arise, how far below its stability limit a step must lie to be accurate, and that it divides the
//! pulses: one rule for lenses and rigs.

use crate::contact::LawKind;
use crate::dem::{Integrator, stable_step};
use crate::design::Accuracy;
use crate::material::Material;
use crate::units::Dimension::{Force, Time};

/// The stability limit over the step at which F and P of the lens problem are within 0.1 % of the converged ones: 1e-7 s
/// of the 1.38e-6 s that its steel on brass allows, with Verlet as with Runge-Kutta. The multistep scheme is as accurate at
/// 1.67e-7 s.
const TENTH_PERCENT: f64 = 13.7;
const MULTISTEP_TENTH_PERCENT: f64 = 8.22;

/// The same for 1 %: 4e-7 s with Verlet, 5e-7 s with the two others.
fn one_percent(integrator: Integrator) -> f64 {
    match integrator {
        Integrator::Verlet => 3.44,
        Integrator::Adams | Integrator::Rk4 => 2.75,
    }
}

/// Verlet's stability limit over the step of an accuracy class.
pub(crate) fn divisor(accuracy: Accuracy, integrator: Integrator) -> f64 {
    match accuracy {
        Accuracy::TenthPercent if integrator == Integrator::Adams => MULTISTEP_TENTH_PERCENT,
        Accuracy::TenthPercent => TENTH_PERCENT,
        Accuracy::OnePercent => one_percent(integrator),
    }
}

/// An automatic step cuts the shortest pulse into at least so many.
pub(crate) const IN_PULSE: f64 = 20.0;

/// The greatest step up to `most` of which every square pulse (s) is a whole number; none without pulses, and where they have none in
/// common down to a thousandth of the shortest over that.
pub(crate) fn dividing(most: f64, pulses: &[f64]) -> Option<f64> {
    let shortest = pulses.iter().copied().reduce(f64::min)?;
    let is_whole = |pulse: f64, step: f64| (pulse / step - (pulse / step).round()).abs() <= 1e-9;
    let fewest = (shortest / most * (1.0 - 1e-12)).ceil().max(1.0);
    let steps = (0..1000_u32).map(|more| shortest / (fewest + f64::from(more)));
    steps.into_iter().find(|&step| pulses.iter().all(|&pulse| is_whole(pulse, step)))
}

/// Greatest contact force in the sheet over the force that a struck sphere hands to each of its two contacts, as
/// measured on lens, host and lens material under 10.5 and 26 kN: 1.11 to 1.26 for plastic laws; up to 3.7 for elastic ones,
/// whose stiffness grows with the cube root of the force only.
pub(crate) fn overshoot(law: LawKind) -> f64 {
    if law.is_plastic() { 1.2 } else { 3.75 }
}

/// The contact that limits the step.
pub(crate) struct Stiffest {
    /// Its materials.
    pub names: String,
    /// dF/dδ (N/m)
    pub stiffness: f64,
    /// The force from which it unloads (N).
    pub force: f64,
    /// Greatest stable step (s).
    pub limit: f64,
}

impl Stiffest {
    /// Looks at all pairs of spheres that occur, in `D` dimensions: `materials` with a diameter (m) each, and the greatest
    /// stiffness of two of them, by their indices, that have carried `force` (N).
    pub fn find<const D: usize>(
        materials: &[Material],
        diameter: impl Fn(usize) -> f64,
        force: f64,
        stiffness_max: impl Fn(usize, usize) -> f64,
    ) -> Self {
        let mut found = Self { names: String::new(), stiffness: 0.0, force, limit: f64::INFINITY };
        for (a, first) in materials.iter().enumerate() {
            for (b, second) in materials.iter().enumerate().skip(a) {
                let stiffness = stiffness_max(a, b);
                let lighter = first.sphere_mass(diameter(a)).min(second.sphere_mass(diameter(b)));
                let limit = stable_step::<D>(stiffness, lighter);
                if limit < found.limit {
                    found = Self { names: format!("{} on {}", first.name, second.name), stiffness, force, limit };
                }
            }
        }
        found
    }

    /// In words.
    pub fn words(&self) -> String {
        format!(
            "stability limit {} (stiffest contact {}: {:.2e} N/m when unloading from {})",
            Time.show(self.limit),
            self.names,
            self.stiffness,
            Force.show(self.force)
        )
    }
}
