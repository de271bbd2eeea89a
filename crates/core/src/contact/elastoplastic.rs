//! The published elastic-plastic contact of two metal spheres, and its linear simplification.

use std::f64::consts::PI;

use super::parameters::{law, parameters};
use super::{ForceLaw, History, NormalLaw, Pair};
use crate::real::Number;

parameters! {
    /// Rate hardening of the yield stress: σ = s σ_y with
    ///
    ///   s = max(1, 1 + C ln(ε̇/ε̇₀)),   ε̇ = max(0, v)/(r₁ + r₂),   ε̇₀ = 0.001 /s
    ///
    /// Source: Burgoyne 2016, eqs 3.7 (whose minus sign is a slip) and 3.8.
    pub(super) struct RateFactor {
        constant: V,
        /// 1/((r₁ + r₂) ε̇₀) (s/m)
        per_speed: V,
    }
}

impl RateFactor {
    /// That of a pair of spheres; `rate` false switches it off.
    pub(super) fn new(pair: &Pair, rate: bool) -> Self {
        Self { constant: if rate { pair.rate_constant } else { 0.0 }, per_speed: 1.0 / (pair.radii_sum * 0.001) }
    }
}

impl<V: Number> RateFactor<V> {
    #[inline(always)]
    pub(super) fn at(&self, closing_speed: V) -> V {
        // Strain rates below ε̇₀ do not harden, so the logarithm is only ever taken of numbers from 1 up.
        let one = V::splat(1.0);
        let relative = (closing_speed * self.per_speed).max(one);
        let hardens = V::splat(0.0).lt(self.constant * (relative - one));
        if !V::any(hardens) {
            return one;
        }
        one + self.constant * relative.ln()
    }
}

parameters! {
    /// Unloading, and reloading below the greatest force: elastic, from a flattened contact of radius a,
    ///
    ///   F = F_max ((δ − δ_r)/(δ_max − δ_r))^{3/2},   δ_max − δ_r = 3 F_max/(4 E* a),
    ///   a² = (2 F_max + F_y)/(2 π 1.6 σ_y)
    ///
    /// with the quasistatic σ_y in a and the rate-dependent F_y. This is Burgoyne 2016, section 3.1 and appendix A.2.1 with
    /// R_p = 4 E* a³/(3 F_max) put in, by which its two powers of 2/3 cancel.
    pub(super) struct Unloading {
        /// 1/(2 π 1.6 σ_y) (m²/N)
        area_per_force: V,
        /// 4 E*/3 (Pa)
        modulus: V,
    }
}

impl<V: Number> Unloading<V> {
    /// a (m)
    #[inline(always)]
    fn contact_radius(&self, force_max: V, yield_force: V) -> V {
        ((force_max + force_max + yield_force) * self.area_per_force).sqrt()
    }

    /// δ_max − δ_r (m)
    #[inline(always)]
    pub(super) fn recovered(&self, force_max: V, yield_force: V) -> V {
        force_max / (self.modulus * self.contact_radius(force_max, yield_force))
    }

    #[inline(always)]
    fn force(&self, overlap: V, yield_force: V, history: &History<V>) -> V {
        let zero = V::splat(0.0);
        // (δ − δ_r)/(δ_max − δ_r) = 1 − (δ_max − δ)/(δ_max − δ_r); F_max = 0 gives −∞ or NaN, and so no force.
        // The quotient and the root do not wait for each other.
        let per_recovered = self.modulus / history.force_max * self.contact_radius(history.force_max, yield_force);
        let fraction = V::splat(1.0) - (history.overlap_max - overlap) * per_recovered;
        let fraction = fraction.max(zero);
        let force = (history.force_max * (fraction * fraction.sqrt())).min(history.force_max);
        // At low forces the law puts the residual overlap below zero; an open contact carries no force all the same.
        V::select(zero.lt(history.force_max.min(overlap)), force, zero)
    }
}

impl Unloading<f64> {
    /// With p_y (Pa) in place of 1.6 σ_y.
    pub(super) fn new(pair: &Pair, pressure: f64) -> Self {
        Self { area_per_force: 1.0 / (2.0 * PI * pressure), modulus: 4.0 / 3.0 * pair.modulus }
    }

    /// ∫F dδ from the residual overlap (or from zero, where the law puts it below) to `overlap`.
    fn stored(&self, overlap: f64, yield_force: f64, history: &History) -> f64 {
        if history.force_max <= 0.0 || overlap <= 0.0 {
            return 0.0;
        }
        let recovered = self.recovered(history.force_max, yield_force);
        let energy = |overlap: f64| {
            let fraction = (1.0 - (history.overlap_max - overlap) / recovered).max(0.0);
            let clipped = fraction.min(1.0);
            history.force_max * recovered * (0.4 * clipped * clipped * clipped.sqrt() + (fraction - clipped))
        };
        energy(overlap) - energy(0.0)
    }

    /// dF/dδ at F_max, (3/2) F_max/(δ_max − δ_r) = 2 E* a.
    pub(super) fn stiffness_max(&self, force_max: f64, yield_force: f64) -> f64 {
        1.5 * self.modulus * self.contact_radius(force_max, yield_force)
    }
}

law! {
    /// The published elastic-plastic law (Burgoyne 2016, chapter 3 and appendix A.2.1), to the letter.
    ///
    /// Loading, with the dynamic yield stress σ = s σ_y and q = E*/σ:
    ///
    /// - I, δ ≤ δ_y: Hertz, up to δ_y = (r*/4)(1.6 π/q)², F_y = (4/3) E* √r* δ_y^{3/2};
    /// - II, δ_y < δ ≤ δ_p = (0.00428/q + 1.47·10⁻⁵) L: δ (α + β ln δ), continuous at both ends;
    /// - III, δ > δ_p: p₀ π (2 r* δ + c₂), p₀ = c₁ σ, c₁ = 6.304 − 6.76 q^−0.137, c₂ = (1.01·10⁻⁹ − 3.99·10⁻⁶/q) L²
    ///
    /// with L = r*/1.6129 mm and c₂ in m². Wherever the spheres part, or force or overlap lie below their greatest values so
    /// far, the unloading branch holds. Fitted for E*/σ between 20 and 1000 and up to about 2 δ_p; see the module's page for what
    /// the law gets wrong.
    pub struct ElastoPlastic {
        pub(super) rate: RateFactor<V>,
        pub(super) unloading: Unloading<V>,
        /// (4/3) E* √r*
        pub(super) hertz: V,
        /// δ_y and F_y at rest; they grow as s² and s³.
        pub(super) yield_overlap: V,
        pub(super) yield_force: V,
        /// ln δ_y and F_y/δ_y at rest
        yield_logarithm: V,
        yield_secant: V,
        /// δ_p = constant + s · slope
        plastic_overlap: [V; 2],
        /// c₁ = constant − slope · s^exponent
        pressure_ratio: [V; 3],
        /// π σ_y
        pressure: V,
        /// 2 r*
        pub(super) area_slope: V,
        /// c₂ = constant + s · slope
        area_offset: [V; 2],
    }
}

impl ElastoPlastic {
    /// The law for a pair of spheres; `rate` false switches the hardening off.
    pub fn new(pair: &Pair, rate: bool) -> Self {
        let ratio = pair.modulus / pair.yield_stress;
        let rest = pair.regions(1.0);
        let scale = pair.constants.scale(pair.radius);
        let (offset, exponent) = pair.constants.pressure_fit();
        Self {
            rate: RateFactor::new(pair, rate),
            unloading: Unloading {
                area_per_force: 1.0 / (2.0 * PI * 1.6 * pair.yield_stress),
                modulus: 4.0 / 3.0 * pair.modulus,
            },
            hertz: pair.hertz_coefficient(),
            yield_overlap: rest.yield_overlap,
            yield_force: rest.yield_force,
            yield_logarithm: rest.yield_overlap.ln(),
            yield_secant: rest.yield_force / rest.yield_overlap,
            plastic_overlap: [1.47e-5 * scale, 0.00428 / ratio * scale],
            pressure_ratio: [offset, 6.76 * ratio.powf(-exponent), exponent],
            pressure: PI * pair.yield_stress,
            area_slope: 2.0 * pair.radius,
            area_offset: [1.01e-9 * scale * scale, -3.99e-6 / ratio * scale * scale],
        }
    }
}

/// Region III for one s: F = p₀ π (2 r* δ + c₂) from δ_p on.
pub(super) struct PlasticLine<V> {
    /// δ_p (m)
    pub overlap: V,
    /// p₀ π (Pa)
    pub pressure: V,
    /// c₂ (m²)
    pub area_offset: V,
    /// ln s
    pub ln_s: V,
}

impl<V: Number> ElastoPlastic<V> {
    #[inline(always)]
    pub(super) fn plastic_line(&self, s: V) -> PlasticLine<V> {
        let [offset, slope, exponent] = self.pressure_ratio;
        // ln s, and s to the power of the fit; where nothing hardens they are exactly 0 and 1.
        let (mut ln_s, mut power) = (V::splat(0.0), V::splat(1.0));
        if V::any(V::splat(1.0).lt(s)) {
            ln_s = s.ln();
            power = (exponent * ln_s).exp_small();
        }
        PlasticLine {
            ln_s,
            overlap: self.plastic_overlap[0] + s * self.plastic_overlap[1],
            pressure: (offset - slope * power) * self.pressure * s,
            area_offset: self.area_offset[0] + s * self.area_offset[1],
        }
    }

    /// Force on first loading at hardening factor s.
    #[inline(always)]
    fn loading(&self, overlap: V, s: V) -> V {
        let yield_overlap = self.yield_overlap * s * s;
        let elastic = self.hertz * overlap * overlap.sqrt();
        let yielded = yield_overlap.lt(overlap);
        if !V::any(yielded) {
            return elastic;
        }
        let PlasticLine { overlap: plastic_overlap, pressure, area_offset, ln_s } = self.plastic_line(s);
        let plastic = pressure * (self.area_slope * overlap + area_offset);
        let mixed = overlap.lt(plastic_overlap);
        let mut force = plastic;
        if V::any(mixed) {
            // δ (α + β ln δ) = δ (F_y/δ_y + (F_p/δ_p − F_y/δ_y) ln(δ/δ_y)/ln(δ_p/δ_y)), with one quotient.
            let secant = self.yield_secant * s;
            let plastic_force = pressure * (self.area_slope * plastic_overlap + area_offset);
            let ln_yield = self.yield_logarithm + ln_s + ln_s;
            let rise = (plastic_force - secant * plastic_overlap) * (overlap.max(yield_overlap).ln() - ln_yield);
            let run = plastic_overlap * (plastic_overlap.ln() - ln_yield);
            force = V::select(mixed, overlap * (secant + rise / run), plastic);
        }
        V::select(yielded, force, elastic)
    }
}

impl<V: Number> ForceLaw<V> for ElastoPlastic<V> {
    #[inline(always)]
    fn force(&self, overlap: V, closing_speed: V, history: &History<V>) -> V {
        let overlap = overlap.max(V::splat(0.0));
        let s = self.rate.at(closing_speed);
        let parting = V::or(closing_speed.lt(V::splat(0.0)), overlap.lt(history.overlap_max));
        let loading = if V::all(parting) { V::splat(0.0) } else { self.loading(overlap, s) };
        let below = V::or(parting, loading.lt(history.force_max));
        if !V::any(below) {
            return loading;
        }
        let unloading = self.unloading.force(overlap, self.yield_force * s * s * s, history);
        V::select(below, unloading, loading)
    }
}

impl NormalLaw for ElastoPlastic {
    fn stored(&self, overlap: f64, history: &History) -> f64 {
        self.unloading.stored(overlap, self.yield_force, history)
    }

    fn stiffness_max(&self, force_max: f64) -> f64 {
        self.unloading.stiffness_max(force_max, self.yield_force)
    }

    /// δ_y at the present rate: s² times that at rest.
    fn yield_onset(&self, closing_speed: f64) -> f64 {
        let s = self.rate.at(closing_speed);
        self.yield_overlap * s * s
    }
}

law! {
    /// Loading at the fully plastic stiffness from the start, F = K_L δ with K_L = 2 π r* c₁ σ; unloading as
    /// [`ElastoPlastic`].
    ///
    /// Source: Burgoyne 2016, eq. 4.2 (which lacks π) and fig. 5.19d, e. Below 561 N (440c) or 98 N (brass) the unloading
    /// branch lies above the loading line: a gentle cycle creates energy.
    pub struct LinearPlastic {
        rate: RateFactor<V>,
        unloading: Unloading<V>,
        yield_force: V,
        /// c₁ = constant − slope · s^exponent
        pressure_ratio: [V; 3],
        /// 2 π r* σ_y
        stiffness: V,
    }
}

impl LinearPlastic {
    /// The law for a pair of spheres; `rate` false switches the hardening off.
    pub fn new(pair: &Pair, rate: bool) -> Self {
        let full = ElastoPlastic::new(pair, rate);
        Self {
            rate: full.rate,
            unloading: full.unloading,
            yield_force: full.yield_force,
            pressure_ratio: full.pressure_ratio,
            stiffness: full.pressure * full.area_slope,
        }
    }
}

impl<V: Number> ForceLaw<V> for LinearPlastic<V> {
    #[inline(always)]
    fn force(&self, overlap: V, closing_speed: V, history: &History<V>) -> V {
        let overlap = overlap.max(V::splat(0.0));
        let s = self.rate.at(closing_speed);
        let [offset, slope, exponent] = self.pressure_ratio;
        let loading = (offset - slope * (exponent * s.ln()).exp_small()) * self.stiffness * s * overlap;
        let below = V::or(
            closing_speed.lt(V::splat(0.0)),
            V::or(overlap.lt(history.overlap_max), loading.lt(history.force_max)),
        );
        let unloading = self.unloading.force(overlap, self.yield_force * s * s * s, history);
        V::select(below, unloading, loading)
    }
}

impl NormalLaw for LinearPlastic {
    fn stored(&self, overlap: f64, history: &History) -> f64 {
        self.unloading.stored(overlap, self.yield_force, history)
    }

    fn stiffness_max(&self, force_max: f64) -> f64 {
        let [offset, slope, _] = self.pressure_ratio;
        let loading = (offset - slope) * self.stiffness;
        self.unloading.stiffness_max(force_max, self.yield_force).max(loading)
    }

    /// It yields from the start.
    fn yield_onset(&self, _: f64) -> f64 {
        0.0
    }
}
