//! Hertz with its pressure cut off.

use std::f64::consts::PI;

use super::elastic::{springs_back, sprung_energy};
use super::elastoplastic::Unloading;
use super::parameters::law;
use super::{ForceLaw, History, NormalLaw, Pair, elastic};
use crate::real::Number;

law! {
    /// Elastic, perfectly plastic contact: Hertz until the pressure at its centre is p_y, a pressure that is nowhere exceeded then.
    ///
    ///   F = (4/3) E* √r* δ^{3/2} up to δ_y = (π p_y/(2 E*))² r*, then F = F_y + π p_y r* (δ − δ_y);
    ///   back F = F_max ((δ − δ_r)/(δ_max − δ_r))^{3/2},   δ_max − δ_r = 3 F_max/(4 E* a),   a² = (2 F_max + F_y)/(2 π p_y)
    ///
    /// with p_y = H σ_y, H = `hardness` of [`Constants`](super::Constants): 1.6 where yield begins under a sphere, 2.8 where a contact is
    /// fully plastic. No rate. With V_y the speed at which yield begins, w = V_y/V ≤ 1, spheres that meet at V part with
    ///
    ///   e² = (6 √3/5) (1 − w²/6) √(w/(w + 2 √(6/5 − w²/5)))
    ///
    /// Source: Thornton, J. Appl. Mech. 64, 383 (1997), eqs 15 to 36; Thornton and Ning, Powder Technol. 99, 154 (1998). Holds for small
    /// contacts; at large ones real metals are softer than its straight line.
    pub struct Thornton {
        unloading: Unloading<V>,
        /// (4/3) E* √r*
        hertz: V,
        yield_overlap: V,
        yield_force: V,
        /// π p_y r* (N/m)
        slope: V,
    }
}

impl Thornton {
    /// The law for a pair of spheres.
    pub fn new(pair: &Pair) -> Self {
        let pressure = pair.constants.tuning.hardness * pair.yield_stress;
        let yield_overlap = pair.radius * (PI * pressure / (2.0 * pair.modulus)).powi(2);
        Self {
            unloading: Unloading::new(pair, pressure),
            hertz: pair.hertz_coefficient(),
            yield_overlap,
            yield_force: pair.hertz_coefficient() * yield_overlap.powf(1.5),
            slope: PI * pressure * pair.radius,
        }
    }

    /// V_y (m/s): the speed at which bodies of this reduced mass (kg) begin to yield, (1/2) m̄ V_y² = (2/5) F_y δ_y.
    pub fn yield_speed(&self, reduced_mass: f64) -> f64 {
        (0.8 * self.yield_force * self.yield_overlap / reduced_mass).sqrt()
    }

    /// Coefficient of restitution of a head-on collision of bodies with this reduced mass (kg) at this speed (m/s).
    pub fn restitution(&self, reduced_mass: f64, speed: f64) -> f64 {
        let w = self.yield_speed(reduced_mass) / speed;
        if w >= 1.0 {
            return 1.0;
        }
        let shape = (w / (w + 2.0 * (1.2 - 0.2 * w * w).sqrt())).sqrt();
        (1.2 * 3.0_f64.sqrt() * (1.0 - w * w / 6.0) * shape).sqrt()
    }
}

impl<V: Number> ForceLaw<V> for Thornton<V> {
    #[inline(always)]
    fn force(&self, overlap: V, _: V, history: &History<V>) -> V {
        let closed = overlap.max(V::splat(0.0));
        let elastic = self.hertz * closed * closed.sqrt();
        let plastic = self.yield_force + self.slope * (closed - self.yield_overlap);
        let loading = V::select(self.yield_overlap.lt(closed), plastic, elastic);
        // A contact that has yielded springs back along its own curve.
        let yielded = self.yield_force.lt(history.force_max);
        let back = V::select(yielded, history.overlap_max, -history.overlap_max);
        let below = closed.lt(back);
        if !V::any(below) {
            return loading;
        }
        let recovered = self.unloading.recovered(history.force_max, self.yield_force);
        V::select(below, springs_back(closed, recovered, history), loading)
    }
}

impl NormalLaw for Thornton {
    fn stored(&self, overlap: f64, history: &History) -> f64 {
        if history.force_max > self.yield_force {
            let recovered = self.unloading.recovered(history.force_max, self.yield_force);
            return sprung_energy(overlap, recovered, history);
        }
        elastic::stored(self.hertz, overlap)
    }

    fn stiffness_max(&self, force_max: f64) -> f64 {
        if force_max <= self.yield_force {
            return 1.5 * self.hertz.powf(2.0 / 3.0) * force_max.cbrt();
        }
        self.unloading.stiffness_max(force_max, self.yield_force)
    }

    /// F = p_y π a² of a contact that has yielded, so that a² = r* δ but for where it begins to yield: nothing piles up, and a = R/√2 comes at
    /// twice the overlap at which it comes under laws with a² = 2 r* δ.
    fn overlap_limit(&self) -> f64 {
        0.5
    }

    fn yield_onset(&self, _: f64) -> f64 {
        self.yield_overlap
    }
}
