//! Contacts that do not yield.

use super::parameters::law;
use super::{ForceLaw, History, NormalLaw, Pair};
use crate::real::Number;

law! {
    /// Frictionless elastic contact of two spheres.
    ///
    ///   F(δ) = k δ^{3/2},   k = (4/3) E* √r*
    ///
    /// Holds while δ ≪ r* and the contact pressure stays below yield; past that use [`ElastoPlastic`](super::ElastoPlastic).
    /// Source: Johnson, Contact Mechanics (1985), eq. 4.23; Burgoyne 2016, eq. 3.1 (eq. 4.1 there lacks √r*).
    pub struct Hertz {
        /// k (N/m^{3/2})
        pub coefficient: V,
    }
}

impl Hertz {
    /// Hertz's law for a pair of spheres.
    pub fn new(pair: &Pair) -> Self {
        Self { coefficient: pair.hertz_coefficient() }
    }
}

impl<V: Number> ForceLaw<V> for Hertz<V> {
    #[inline(always)]
    fn force(&self, overlap: V, _: V, _: &History<V>) -> V {
        let overlap = overlap.max(V::splat(0.0));
        self.of_root(overlap, overlap.sqrt())
    }
}

impl<V: Number> Hertz<V> {
    /// The force at an overlap that is not negative, whose root is known.
    #[inline(always)]
    pub(crate) fn of_root(&self, overlap: V, root: V) -> V {
        self.coefficient * overlap * root
    }
}

impl NormalLaw for Hertz {
    fn is_plastic() -> bool {
        false
    }

    fn stored(&self, overlap: f64, _: &History) -> f64 {
        stored(self.coefficient, overlap)
    }

    fn stiffness_max(&self, force_max: f64) -> f64 {
        stiffness(self.coefficient, force_max)
    }
}

/// Energy of F = k δ^{3/2}: ∫F dδ = (2/5) k δ^{5/2}.
pub(super) fn stored(coefficient: f64, overlap: f64) -> f64 {
    let overlap = overlap.max(0.0);
    0.4 * coefficient * overlap * overlap * overlap.sqrt()
}

/// Slope of F = k δ^{3/2} at a force: dF/dδ = (3/2) k δ^{1/2} = (3/2) k^{2/3} F^{1/3}.
pub(super) fn stiffness(coefficient: f64, force: f64) -> f64 {
    1.5 * coefficient.powf(2.0 / 3.0) * force.cbrt()
}

/// The way back of a flattened contact, F = F_max ((δ − δ_r)/(δ_max − δ_r))^{3/2}, with `recovered` δ_max − δ_r.
#[inline(always)]
pub(super) fn springs_back<V: Number>(overlap: V, recovered: V, history: &History<V>) -> V {
    let zero = V::splat(0.0);
    let fraction = (V::splat(1.0) - (history.overlap_max - overlap) / recovered).max(zero);
    V::select(zero.lt(overlap), history.force_max * (fraction * fraction.sqrt()), zero)
}

/// Its energy, (2/5) F (δ − δ_r).
pub(super) fn sprung_energy(overlap: f64, recovered: f64, history: &History) -> f64 {
    if overlap <= 0.0 {
        return 0.0;
    }
    let fraction = (1.0 - (history.overlap_max - overlap) / recovered).max(0.0);
    0.4 * history.force_max * recovered * fraction * fraction * fraction.sqrt()
}

/// Hertz's force over the distance of two centres, from how much their squared distance falls short:
///
///   F/|Δ| = k S^{1/2} q(w),   w = 1 − |Δ|²/S²,   q(w) = (1 − √(1 − w))^{3/2}/√(1 − w) = w^{3/2} P(w)
///
/// with S = r₁ + r₂. One root in place of two and a quotient, and nothing cancels: P(w) = (1 + √(1 − w))^{−3/2} (1 − w)^{−1/2} is
/// smooth, and on 0 ≤ w ≤ 1/16 (overlaps to 3 % of S) the polynomial through it at nine Chebyshev points is off by less than
/// 2⁻⁵³. Beyond that P is computed as written. Not positive w gives 0.
#[inline(always)]
pub(crate) fn hertz_over_distance<V: Number>(w: V) -> V {
    let c = V::splat;
    let w = w.max(c(0.0));
    let square = w * w;
    let low = (c(P[0]) + w * c(P[1])) + square * (c(P[2]) + w * c(P[3]));
    let high = (c(P[4]) + w * c(P[5])) + square * (c(P[6]) + w * c(P[7]));
    let fourth = square * square;
    let mut series = low + fourth * (high + fourth * c(P[8]));
    let beyond = c(SERIES_END).lt(w);
    if V::any(beyond) {
        let ratio = (c(1.0) - w).sqrt();
        let sum = c(1.0) + ratio;
        series = V::select(beyond, c(1.0) / (sum * sum.sqrt() * ratio), series);
    }
    w * w.sqrt() * series
}

/// Up to which w the polynomial holds.
const SERIES_END: f64 = 1.0 / 16.0;

/// Its coefficients, found in sixty decimal digits.
const P: [f64; 9] = [
    0.353_553_390_593_273_8,
    0.309_359_216_769_050_54,
    0.273_451_450_564_243_47,
    0.246_865_888_384_321_6,
    0.226_527_874_624_105_34,
    0.210_392_487_408_627_68,
    0.197_706_038_493_147_6,
    0.179_372_262_779_480_57,
    0.232_891_644_795_265_3,
];

law! {
    /// Hertz as the published code has it with plasticity switched off: wherever the spheres part, or force or overlap lie
    /// below their greatest values so far, the force is clipped at F_max. A contact that has never carried force and parts
    /// carries none (Burgoyne 2016, appendix A.2.1, lines 51 to 65).
    pub struct HertzThesis {
        /// Unclipped
        pub hertz: Hertz<V>,
    }
}

impl HertzThesis {
    /// The clipped law for a pair of spheres.
    pub fn new(pair: &Pair) -> Self {
        Self { hertz: Hertz::new(pair) }
    }
}

impl<V: Number> ForceLaw<V> for HertzThesis<V> {
    #[inline(always)]
    fn force(&self, overlap: V, closing_speed: V, history: &History<V>) -> V {
        let force = self.hertz.force(overlap, closing_speed, history);
        let clipped =
            V::or(closing_speed.lt(V::splat(0.0)), V::or(force.lt(history.force_max), overlap.lt(history.overlap_max)));
        V::select(clipped, force.min(history.force_max), force)
    }
}

impl NormalLaw for HertzThesis {
    fn is_plastic() -> bool {
        false
    }

    /// Hertz's energy, less what the clipping cuts off above F_max.
    fn stored(&self, overlap: f64, history: &History) -> f64 {
        let clipped_from = (history.force_max / self.hertz.coefficient).powf(2.0 / 3.0);
        if overlap <= clipped_from {
            self.hertz.stored(overlap, history)
        } else {
            self.hertz.stored(clipped_from, history) + history.force_max * (overlap - clipped_from)
        }
    }

    fn stiffness_max(&self, force_max: f64) -> f64 {
        self.hertz.stiffness_max(force_max)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against the law as it stands, at overlaps from 10⁻¹² to 0.3 of the distance: a few roundings, and that of 1 − δ/S.
    #[test]
    fn the_force_over_the_distance_is_hertzs() {
        for k in 0..4000 {
            let overlap = 1e-12 * 1.006_626_f64.powi(k);
            // With S = 1, w = 1 − (1 − δ)² = δ (2 − δ).
            let w = overlap * (2.0 - overlap);
            let exact = overlap.powf(1.5) / (1.0 - overlap);
            let ours = hertz_over_distance(w);
            assert!((ours / exact - 1.0).abs() < 8.0 * f64::EPSILON, "{overlap}: {ours} {exact}");
        }
        assert_eq!(hertz_over_distance(-0.1), 0.0);
    }
}
