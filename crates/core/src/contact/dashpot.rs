//! The linear spring and dashpot of granular beds.

use super::{ForceLaw, History, NormalLaw};
use crate::real::Number;

/// F = k δ + c v with overlap δ and closing speed v: a spring and a dashpot side by side (Kondic et al. 2012, eq. 2).
///
/// Not cut at zero, it pulls while a contact ends; restitution is then below the nominal exp(−c t_c/(2 m̄)), see [`restitution`].
///
/// [`restitution`]: Dashpot::restitution
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dashpot {
    /// k (N/m)
    pub stiffness: f64,
    /// c = γ m̄ (kg/s)
    pub damping: f64,
    /// Whether the force is cut at zero, so that the contact never pulls.
    pub cut: bool,
}

impl Dashpot {
    /// The dashpot whose head-on collisions with reduced mass m̄ (kg) have a coefficient of restitution from 0.02 to 1. That
    /// falls with c; it is found by halving, to rounding.
    pub fn with_restitution(stiffness: f64, reduced_mass: f64, restitution: f64, cut: bool) -> Self {
        // Four times the critical damping 2 √(k m̄), at which nothing to speak of comes back.
        let (mut low, mut high) = (0.0, 8.0 * (stiffness * reduced_mass).sqrt());
        for _ in 0..200 {
            let damping = 0.5 * (low + high);
            let more = Self { stiffness, damping, cut }.restitution(reduced_mass) > restitution;
            if more { low = damping } else { high = damping }
        }
        Self { stiffness, damping: 0.5 * (low + high), cut }
    }

    /// Force of closed contacts, one or several side by side, each with its own c in place of `damping`.
    #[inline(always)]
    pub fn push<V: Number>(&self, overlap: V, closing_speed: V, damping: V) -> V {
        let force = V::splat(self.stiffness) * overlap + damping * closing_speed;
        if self.cut { force.max(V::splat(0.0)) } else { force }
    }

    /// Coefficient of restitution of a head-on collision with reduced mass m̄ (kg): exact.
    ///
    /// With ω₀² = k/m̄ and β = c/(2 m̄): the uncut contact ends at δ = 0, after t = π/√(ω₀² − β²), with exp(−β t); the cut
    /// one where k δ + c v = 0, with exp(−(β/ω) arctan-type exponent) (Schwager and Pöschel 2007, eq. 18). Overdamped
    /// contacts (β ≥ ω₀) never end uncut: 0.
    pub fn restitution(&self, reduced_mass: f64) -> f64 {
        use std::f64::consts::PI;
        let natural = (self.stiffness / reduced_mass).sqrt();
        let beta = 0.5 * self.damping / reduced_mass;
        if beta < natural {
            let omega = (natural * natural - beta * beta).sqrt();
            let end = if self.cut {
                let angle = (2.0 * beta * omega).atan2(omega * omega - beta * beta);
                (PI - angle) / omega
            } else {
                PI / omega
            };
            return (-beta * end).exp();
        }
        if !self.cut {
            return 0.0;
        }
        if beta == natural {
            return (-2.0_f64).exp();
        }
        let omega = (beta * beta - natural * natural).sqrt();
        (-beta / omega * ((beta + omega) / (beta - omega)).ln()).exp()
    }
}

impl ForceLaw<f64> for Dashpot {
    #[inline(always)]
    fn force(&self, overlap: f64, closing_speed: f64, _: &History) -> f64 {
        if overlap <= 0.0 {
            return 0.0;
        }
        self.push(overlap, closing_speed, self.damping)
    }
}

impl NormalLaw for Dashpot {
    /// ½ k δ²
    fn stored(&self, overlap: f64, _: &History) -> f64 {
        let overlap = overlap.max(0.0);
        0.5 * self.stiffness * overlap * overlap
    }

    fn stiffness_max(&self, _: f64) -> f64 {
        self.stiffness
    }
}

#[cfg(test)]
mod tests {
    use super::Dashpot;

    /// Kondic's units: k = π²/2, γ = −2 ln e, reduced mass 1/2. The true restitution of the uncut and the cut contact, for the
    /// nominal ones.
    #[test]
    fn restitution_differs_from_the_nominal_one() {
        let e = |nominal: f64, cut| {
            let damping = -2.0 * nominal.ln() * 0.5;
            Dashpot { stiffness: std::f64::consts::PI.powi(2) / 2.0, damping, cut }.restitution(0.5)
        };
        // Known independently to five (uncut) and three (cut) digits.
        for (nominal, uncut) in [(0.9, 0.89995), (0.5, 0.49132), (0.1, 0.03389)] {
            assert!((e(nominal, false) - uncut).abs() < 5e-6, "{}", e(nominal, false));
        }
        assert!((e(0.5, true) - 0.543).abs() < 5e-4, "{}", e(0.5, true));
        assert!((e(0.1, true) - 0.20).abs() < 5e-3, "{}", e(0.1, true));
    }
}
