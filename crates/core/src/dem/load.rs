//! What strikes the crystal.

use serde::{Deserialize, Serialize};

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
