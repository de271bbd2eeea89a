//! Elastic, perfectly plastic contact to large overlaps, by the method of dimensionality reduction.

use std::f64::consts::{FRAC_1_SQRT_2, FRAC_2_PI, PI};

use super::elastoplastic::RateFactor;
use super::parameters::law;
use super::{ForceLaw, History, NormalLaw, Pair};
use crate::real::Number;

law! {
    /// The pair law of Zunker and Kamrin's mechanically derived contact model, without adhesion, growth of radii and bulk response.
    ///
    /// Each sphere presses on a flat between the two, by the depth d = δ/2, with R = 2 r* and E_c = 2 E*. With Φ(u) = acos(1 − 2u) − 2 (1 − 2u)
    /// √(u (1 − u)), an ellipse of axes A and B pressed in by e gives the force E_c (A B/4) Φ(e/A). So
    ///
    /// - elastic: A = 4R, B = 2R, e = d, up to d_Y where Hertz's mean pressure 4 E_c √(d/R)/(3π) reaches p(d) = σ (1.75 exp(−4.4 d/R) + 1);
    /// - plastic: F = p(d) π a², a² = 2 R d − d² + d_Y² − R d_Y;
    /// - back from d_max, with a and F_max there: A = 4 F_max/(π a E_c), B = 2a, and e falls from A/2 to 0 while d falls from d_max by
    ///   A/2 + d_R, d_R = F_max ((1 − 2ν) z (h − z) − 2 (1 − ν) a²)/(π a² 2G h), z = R − (d_max − A/2), h² = a² + z²,
    ///   2G = (1 − ν) E_c: what the free surface beside the contact gives.
    ///
    /// Spheres of unlike materials take E* and the lower yield stress on both sides, since the area follows from the overlap as a whole. With
    /// rate, σ = s σ_y, s as in [`ElastoPlastic`](super::ElastoPlastic) at the closing speed at which the contact passes δ_Y of rest; it keeps this s, so that
    /// no energy comes from a changing one. At d_Y the force rises by 2·10⁻⁴ of itself, since the ellipse lies below Hertz by as much. Made for overlaps to some 10 %
    /// and more of the diameter. Source: Zunker and Kamrin, J. Mech. Phys. Solids 183, 105492 (2024), sections 3 and 4.
    pub struct Mdr {
        rate: RateFactor<V>,
        /// R (m)
        radius: V,
        /// E_c (Pa)
        modulus: V,
        /// σ_y (Pa)
        yield_stress: V,
        /// 4 E_c/(3 π σ_y)
        hertz_pressure: V,
        /// d_Y (m) at rest
        yield_depth: V,
        /// 1 − ν
        compressibility: V,
    }
}

/// A curve back, through (δ_max, F_max).
struct Back<V> {
    /// A/2 + d_R (m): the depth over which the contact opens.
    span: V,
    /// Where on it, from 0 (open) to 1/2 (at δ_max).
    place: V,
}

impl Mdr {
    /// The law for a pair of spheres; `rate` false switches the hardening off.
    pub fn new(pair: &Pair, rate: bool) -> Self {
        let (radius, modulus) = (2.0 * pair.radius, 2.0 * pair.modulus);
        let hertz_pressure = 4.0 * modulus / (3.0 * PI * pair.yield_stress);
        let mut law = Self {
            rate: RateFactor::new(pair, rate),
            radius,
            modulus,
            yield_stress: pair.yield_stress,
            hertz_pressure,
            // From here Newton's method for d_Y, which is nearer than this.
            yield_depth: radius * (2.75 / hertz_pressure).powi(2),
            compressibility: 1.0 - pair.poisson_ratio,
        };
        for _ in 0..8 {
            law.yield_depth = law.onset(1.0);
        }
        law
    }

    /// F_Y (N) at rest, and the overlap δ_Y (m) there.
    pub fn yield_point(&self) -> (f64, f64) {
        (self.elastic(self.yield_depth), 2.0 * self.yield_depth)
    }

    /// ∫Φ du
    fn ellipse_energy(u: f64) -> f64 {
        if u < SERIES_END {
            let terms = ROOT.iter().enumerate().rev();
            let sum = terms.fold(0.0, |sum, (k, b)| {
                let k = k as f64;
                sum * u + 8.0 * b / ((k + 1.5) * (k + 2.5))
            });
            return u * u * u.sqrt() * sum;
        }
        let product = u * (1.0 - u);
        (u - 0.5) * ellipse(u) + 8.0 / 3.0 * product * product.sqrt()
    }

    /// The depth at which a contact that yielded at rest carries a force (N) above F_Y: a² = F/(π p), where p changes little.
    fn depth_at(&self, force: f64) -> f64 {
        let offset = self.yield_depth * (self.radius - self.yield_depth);
        let mut depth = self.yield_depth;
        for _ in 0..12 {
            let square = force / (PI * self.yield_stress * self.softening(depth)) + offset;
            depth = self.radius - (self.radius * self.radius - square).max(0.0).sqrt();
        }
        depth
    }
}

impl<V: Number> Mdr<V> {
    /// p/σ
    #[inline(always)]
    fn softening(&self, depth: V) -> V {
        let c = V::splat;
        c(1.75) * (c(-4.4) * depth / self.radius).exp() + c(1.0)
    }

    /// Hertz's mean pressure over p at rest: the s at which yield begins here.
    #[inline(always)]
    fn strength(&self, depth: V) -> V {
        self.hertz_pressure * (depth / self.radius).sqrt() / self.softening(depth)
    }

    /// d_Y at hardening s, by steps of Newton's method from s² times that at rest: four leave rounding for metals.
    #[inline(always)]
    fn onset(&self, s: V) -> V {
        let c = V::splat;
        let part = s / self.hertz_pressure;
        let mut x = self.yield_depth / self.radius * s * s;
        for _ in 0..4 {
            let falling = c(1.75) * part * (c(-4.4) * x).exp();
            let root = x.sqrt();
            x = x - (root - falling - part) / (c(0.5) / root + c(4.4) * falling);
        }
        x * self.radius
    }

    /// a² (m²) of a contact that began to yield at d_Y.
    #[inline(always)]
    fn area(&self, depth: V, yield_depth: V) -> V {
        depth * (self.radius + self.radius - depth) - yield_depth * (self.radius - yield_depth)
    }

    #[inline(always)]
    fn elastic(&self, depth: V) -> V {
        let c = V::splat;
        c(2.0) * self.modulus * self.radius * self.radius * ellipse(c(0.25) * depth / self.radius)
    }

    #[inline(always)]
    fn plastic(&self, depth: V, yield_depth: V) -> V {
        let pressure = self.yield_stress * self.softening(depth);
        let hardened = self.yield_depth.lt(yield_depth);
        let mut force = pressure * V::splat(PI) * self.area(depth, yield_depth);
        if V::any(hardened) {
            force = V::select(hardened, force * self.strength(yield_depth), force);
        }
        force
    }

    #[inline(always)]
    fn back(&self, depth: V, yield_depth: V, history: &History<V>) -> Back<V> {
        let c = V::splat;
        let deepest = c(0.5) * history.overlap_max;
        let square = self.area(deepest, yield_depth);
        let per_area = history.force_max / (c(PI) * square * self.modulus);
        let pressed = (per_area + per_area) * square.sqrt();
        let z = self.radius - (deepest - pressed);
        let h = (square + z * z).sqrt();
        let nu = c(1.0) - self.compressibility;
        let beside = (c(1.0) - nu - nu) * z * (h - z) - (self.compressibility + self.compressibility) * square;
        let span = pressed + per_area * beside / (self.compressibility * h);
        let place = c(0.5) - (deepest - depth) / (span + span);
        Back { span, place: place.max(c(0.0)).min(c(0.5)) }
    }

    /// The force, and twice the depth at which the contact begins to yield, 0 where it has not been pressed to where it would at rest.
    #[inline(always)]
    fn response(&self, overlap: V, closing_speed: V, history: &History<V>) -> (V, V) {
        let c = V::splat;
        let zero = c(0.0);
        let depth = c(0.5) * overlap.max(zero);
        let beyond = history.overlap_max.lt(overlap);
        let mut onset = history.own;
        let passed = self.yield_depth.lt(V::select(zero.lt(onset), zero, V::select(beyond, depth, zero)));
        if V::any(passed) {
            let s = self.rate.at(closing_speed);
            let hardens = c(1.0).lt(s);
            let mut begun = self.yield_depth;
            if V::any(hardens) {
                begun = V::select(hardens, self.onset(s), begun);
            }
            onset = V::select(passed, begun + begun, onset);
        }
        let yielded = Self::has_yielded(history.overlap_max, onset);
        let plastic = V::and(beyond, Self::has_yielded(overlap, onset));
        let inelastic = V::or(yielded, plastic);
        let mut force = if V::all(inelastic) { zero } else { self.elastic(depth) };
        if V::any(inelastic) {
            let yield_depth = c(0.5) * onset;
            if !V::all(plastic) {
                let back = self.back(depth, yield_depth, history);
                let sprung = history.force_max * c(FRAC_2_PI) * ellipse(back.place);
                force = V::select(yielded, V::select(zero.lt(depth), sprung, zero), force);
            }
            if V::any(plastic) {
                force = V::select(plastic, self.plastic(depth, yield_depth), force);
            }
        }
        (force, onset)
    }

    #[inline(always)]
    fn has_yielded(overlap_max: V, onset: V) -> V::Mask {
        V::and(V::splat(0.0).lt(onset), onset.lt(overlap_max))
    }
}

impl<V: Number> ForceLaw<V> for Mdr<V> {
    #[inline(always)]
    fn force(&self, overlap: V, closing_speed: V, history: &History<V>) -> V {
        self.response(overlap, closing_speed, history).0
    }

    #[inline(always)]
    fn respond(&self, overlap: V, closing_speed: V, history: &History<V>) -> (V, History<V>) {
        let (force, onset) = self.response(overlap, closing_speed, history);
        let beyond = history.overlap_max.lt(overlap);
        let new = |new: V, old: V| V::select(beyond, new, old);
        let history = History {
            overlap_max: new(overlap, history.overlap_max),
            force_max: new(force, history.force_max),
            own: new(onset, history.own),
        };
        (force, history)
    }
}

impl NormalLaw for Mdr {
    /// δ_Y, where it begins to yield.
    fn own_memory() -> Option<&'static str> {
        Some("yield_overlap_m")
    }

    fn stored(&self, overlap: f64, history: &History) -> f64 {
        if overlap <= 0.0 {
            return 0.0;
        }
        let depth = 0.5 * overlap;
        // The work on both sides: the overlap grows twice as fast as the depth.
        if !Self::has_yielded(history.overlap_max, history.own) {
            let energy = Self::ellipse_energy(0.25 * depth / self.radius);
            return 16.0 * self.modulus * self.radius.powi(3) * energy;
        }
        let back = self.back(depth, 0.5 * history.own, history);
        4.0 * FRAC_2_PI * history.force_max * back.span * Self::ellipse_energy(back.place)
    }

    /// dF/dδ at the top of the curve back, 2 F_max/(π (A/2 + d_R)); Hertz's below F_Y.
    fn stiffness_max(&self, force_max: f64) -> f64 {
        if force_max <= self.yield_point().0 {
            let hertz = 4.0 / 3.0 * 0.5 * self.modulus * (0.5 * self.radius).sqrt();
            return 1.5 * hertz.powf(2.0 / 3.0) * force_max.cbrt();
        }
        let depth = self.depth_at(force_max);
        let history = History { overlap_max: 2.0 * depth, force_max, own: 2.0 * self.yield_depth };
        FRAC_2_PI * force_max / self.back(depth, self.yield_depth, &history).span
    }

    /// a² = 2 R d − d² but for where it begins to yield, with R that of equal spheres and d/R the overlap over the sum of radii: what is pressed aside does not all
    /// pile up. It is R²/2 at 1 − 1/√2.
    fn overlap_limit(&self) -> f64 {
        1.0 - FRAC_1_SQRT_2
    }

    /// At rest.
    fn yield_onset(&self, _: f64) -> f64 {
        2.0 * self.yield_depth
    }

    /// Where it began to yield follows from what it carried at δ_max.
    fn recalled(&self, overlap_max: f64, force_max: f64) -> History {
        let depth = 0.5 * overlap_max;
        if depth <= self.yield_depth {
            return History { overlap_max, force_max, own: 0.0 };
        }
        let (mut low, mut high) = (self.yield_depth, depth);
        for _ in 0..100 {
            let middle = 0.5 * (low + high);
            if self.plastic(depth, middle) < force_max { low = middle } else { high = middle }
        }
        History { overlap_max, force_max, own: 2.0 * low }
    }
}

/// Φ(u) = 8 ∫√(u (1 − u)) du for 0 ≤ u ≤ 1/2: by the binomial series where the difference would cancel.
#[inline(always)]
fn ellipse<V: Number>(u: V) -> V {
    let c = V::splat;
    let mut sum = c(8.0 * ROOT[11] / 12.5);
    for k in (0..11).rev() {
        sum = sum * u + c(8.0 * ROOT[k] / (k as f64 + 1.5));
    }
    let near = u * u.sqrt() * sum;
    let far = c(SERIES_END).lt(u);
    if !V::any(far) {
        return near;
    }
    let one = c(1.0);
    let rest = one - u - u;
    let root = (u * (one - u)).sqrt();
    V::select(far, rest.acos() - rest * (root + root), near)
}

/// Up to which u the series holds.
const SERIES_END: f64 = 1.0 / 16.0;

/// √(1 − u) = Σ ROOT[k] u^k
const ROOT: [f64; 12] = [
    1.0,
    -1.0 / 2.0,
    -1.0 / 8.0,
    -1.0 / 16.0,
    -5.0 / 128.0,
    -7.0 / 256.0,
    -21.0 / 1024.0,
    -33.0 / 2048.0,
    -429.0 / 32_768.0,
    -715.0 / 65_536.0,
    -2431.0 / 262_144.0,
    -4199.0 / 524_288.0,
];
