//! The elastic-plastic contact of two metal spheres without the published law's defects.
//!
//! Derivation, proof that no path creates energy, and differences from the published law: `docs/consistent-law.md`.

use super::elastoplastic::PlasticLine;
use super::parameters::law;
use super::{ElastoPlastic, ForceLaw, History, NormalLaw, Pair, elastic};
use crate::real::Number;

law! {
    /// The energy-consistent elastic-plastic law. With U the elastic curve of the contact as it is now, and Y the force at which
    /// it yields,
    ///
    ///   F(δ, v) = U(δ) for δ ≤ δ_max, else min(U(δ), max(Y(δ, v), F_max))
    ///
    /// - U = F_max ((δ − δ_r)/(δ_max − δ_r))^{3/2}, also beyond δ_max; a contact without a past is Hertz. Where it yields the
    ///   contact gets δ_r = δ − 3F/(4 E* a), a² = (2F + F_y)/(2π 1.6 σ_y), as in [`ElastoPlastic`] but with F_y at rest: Hertz at
    ///   F = F_y. Elastic loading leaves δ_r as it is.
    /// - Y is Hertz up to δ_y at rest, [`ElastoPlastic`]'s region III from δ_p on at σ = s σ_y, and between them Hertz times e^−g,
    ///   g = t² (g_p + (1 − t)(2 g_p − h)), t = ln(δ/δ_y)/ln(δ_p/δ_y): on logarithmic scales the cubic that joins both with their
    ///   slopes, so g_p = ln(Hertz/F_p) at δ_p, h = (3/2 − m) ln(δ_p/δ_y), m = d ln F/d ln δ of region III there. s is 1
    ///   at v ≤ 0 and grows with ln v.
    /// - A contact yields only while Y and F_max lie below U, and then remembers the new (δ, F). What it has carried it keeps on
    ///   carrying when the closing speed falls.
    ///
    /// F is continuous and never falls with δ or v; unloading and reloading follow one curve; what is stored never exceeds the work
    /// put in. Range of validity as `ElastoPlastic`.
    pub struct Consistent {
        published: ElastoPlastic<V>,
    }
}

/// The state of a contact, and what became of it.
struct Response<V: Number> {
    force: V,
    /// δ_max − δ_r, before the step.
    recovered: V,
    /// Whether the contact yields.
    yields: V::Mask,
    /// Whether the overlap is beyond δ_max.
    beyond: V::Mask,
}

impl Consistent {
    /// The law for a pair of spheres; `rate` false switches the hardening off.
    pub fn new(pair: &Pair, rate: bool) -> Self {
        Self { published: ElastoPlastic::new(pair, rate) }
    }
}

impl<V: Number> Consistent<V> {
    /// Whether the contact has stayed below F_y at rest, and so is Hertz, δ_r = 0. Told apart because the first forces of a wave's
    /// foot are so small (10⁻³⁰⁰ N) that the curve through the last of them would be rounded beyond recognition.
    #[inline(always)]
    fn pristine(&self, history: &History<V>) -> V::Mask {
        history.force_max.lt(self.published.yield_force)
    }

    /// δ_max − δ_r (m)
    #[inline(always)]
    fn recovered(&self, history: &History<V>) -> V {
        let law = &self.published;
        let recovered = law.unloading.recovered(history.force_max, law.yield_force) + history.own;
        V::select(self.pristine(history), history.overlap_max, recovered)
    }

    /// The elastic force of a fresh contact.
    #[inline(always)]
    fn hertz(&self, overlap: V) -> V {
        self.published.hertz * overlap * overlap.sqrt()
    }

    /// Y(δ, v) for δ > δ_y.
    #[inline(always)]
    fn yield_limit(&self, overlap: V, closing_speed: V) -> V {
        let law = &self.published;
        let c = V::splat;
        let s = law.rate.at(closing_speed);
        let PlasticLine { overlap: plastic_overlap, pressure, area_offset, .. } = law.plastic_line(s);
        let plastic = pressure * (law.area_slope * overlap + area_offset);
        let mixed = overlap.lt(plastic_overlap);
        if !V::any(mixed) {
            return plastic;
        }
        let plastic_force = pressure * (law.area_slope * plastic_overlap + area_offset);
        let exponent = pressure * law.area_slope * plastic_overlap / plastic_force;
        let span = (plastic_overlap / law.yield_overlap).ln();
        let t = (overlap / law.yield_overlap).max(c(1.0)).ln() / span;
        let least = (self.hertz(plastic_overlap) / plastic_force).ln();
        let lost = t * t * (least + (c(1.0) - t) * (least + least - (c(1.5) - exponent) * span));
        // e^g by e^{g/8}, whose series is good to g = 4: F_p is never below a fiftieth of Hertz.
        let root = (lost * c(0.125)).max(c(0.0)).exp_small();
        let square = root * root;
        let fourth = square * square;
        V::select(mixed, self.hertz(overlap) / (fourth * fourth), plastic)
    }

    #[inline(always)]
    fn response(&self, overlap: V, closing_speed: V, history: &History<V>) -> Response<V> {
        let zero = V::splat(0.0);
        let law = &self.published;
        let recovered = self.recovered(history);
        let fraction = (V::splat(1.0) - (history.overlap_max - overlap) / recovered).max(zero);
        let remembered = history.force_max * (fraction * fraction.sqrt());
        let closed = overlap.max(zero);
        let elastic = V::select(self.pristine(history), self.hertz(closed), remembered);
        let elastic = V::select(zero.lt(overlap), elastic, zero);
        let beyond = history.overlap_max.lt(overlap);
        // Overlap beyond both δ_max and δ_y: there the contact may yield.
        let strained = history.overlap_max.max(law.yield_overlap).lt(overlap);
        if !V::any(strained) {
            return Response { force: elastic, recovered, yields: strained, beyond };
        }
        let limit = self.yield_limit(overlap, closing_speed).max(history.force_max);
        let limit = V::select(strained, limit, elastic);
        Response { force: elastic.min(limit), recovered, yields: limit.lt(elastic), beyond }
    }
}

impl<V: Number> ForceLaw<V> for Consistent<V> {
    #[inline(always)]
    fn force(&self, overlap: V, closing_speed: V, history: &History<V>) -> V {
        self.response(overlap, closing_speed, history).force
    }

    /// Beyond δ_max the new state is remembered, with a new residual overlap where the contact yields and the old one where it
    /// is loaded elastically.
    #[inline(always)]
    fn respond(&self, overlap: V, closing_speed: V, history: &History<V>) -> (V, History<V>) {
        let Response { force, recovered, yields, beyond } = self.response(overlap, closing_speed, history);
        if !V::any(beyond) {
            return (force, *history);
        }
        let zero = V::splat(0.0);
        let law = &self.published;
        // Elastic loading leaves δ_r, so that δ_max − δ_r grows as δ_max does.
        let reach = recovered + (overlap - history.overlap_max);
        let elastic_excess = reach - law.unloading.recovered(force, law.yield_force);
        let settled = V::or(yields, force.lt(law.yield_force));
        let elastic_excess = V::select(settled, zero, elastic_excess);
        let new = |new: V, old: V| V::select(beyond, new, old);
        let history = History {
            overlap_max: new(overlap, history.overlap_max),
            force_max: new(force, history.force_max),
            own: new(elastic_excess, history.own),
        };
        (force, history)
    }
}

impl NormalLaw for Consistent {
    /// ω, by how much the contact springs back further than one that yielded at (δ_max, F_max).
    fn own_memory() -> Option<&'static str> {
        Some("elastic_excess_m")
    }

    /// ∫U dδ = (2/5) F (δ − δ_r).
    fn stored(&self, overlap: f64, history: &History) -> f64 {
        if overlap <= 0.0 {
            return 0.0;
        }
        if self.pristine(history) {
            return elastic::stored(self.published.hertz, overlap);
        }
        let recovered = self.recovered(history);
        let fraction = (1.0 - (history.overlap_max - overlap) / recovered).max(0.0);
        0.4 * history.force_max * recovered * fraction * fraction * fraction.sqrt()
    }

    /// dU/dδ = (3/2) F/(δ − δ_r) ≤ 2 E* a(F): the contact springs back no less than one that yielded at F.
    fn stiffness_max(&self, force_max: f64) -> f64 {
        self.published.unloading.stiffness_max(force_max, self.published.yield_force)
    }

    /// δ_y at rest, before which it never yields.
    fn yield_onset(&self, _: f64) -> f64 {
        self.published.yield_overlap
    }
}
