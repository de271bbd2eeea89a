//! Contacts that do not yield.

use super::{ForceLaw, History, LaneLaw, NormalLaw, Pair};
use crate::real::Real;

/// Frictionless elastic contact of two spheres.
///
///   F(δ) = k δ^{3/2},   k = (4/3) E* √r*
///
/// Holds while δ ≪ r* and the contact pressure stays below yield; past that use [`ElastoPlastic`](super::ElastoPlastic).
/// Source: Johnson, Contact Mechanics (1985), eq. 4.23; Burgoyne 2016, eq. 3.1 (eq. 4.1 there lacks √r*).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hertz<V = f64> {
    /// k (N/m^{3/2})
    pub coefficient: V,
}

impl Hertz {
    /// Hertz's law for a pair of spheres.
    pub fn new(pair: &Pair) -> Self {
        Self { coefficient: pair.hertz_coefficient() }
    }
}

impl LaneLaw for Hertz {
    type Lanes<V: Real> = Hertz<V>;
    const PARAMETERS: usize = 1;

    fn parameters(&self) -> Vec<f64> {
        vec![self.coefficient]
    }

    #[inline(always)]
    fn look_up<V: Real>(tables: &[[f64; 16]], place: V::Index) -> Hertz<V> {
        Hertz { coefficient: V::lookup(&tables[0], place) }
    }
}

impl<V: Real> ForceLaw<V> for Hertz<V> {
    #[inline(always)]
    fn force(&self, overlap: V, _: V, _: &History<V>) -> V {
        let overlap = overlap.max(V::splat(0.0));
        self.coefficient * overlap * overlap.sqrt()
    }
}

impl NormalLaw for Hertz {
    /// ∫F dδ = (2/5) k δ^{5/2}
    fn stored(&self, overlap: f64, _: &History) -> f64 {
        let overlap = overlap.max(0.0);
        0.4 * self.coefficient * overlap * overlap * overlap.sqrt()
    }

    /// dF/dδ = (3/2) k δ^{1/2} = (3/2) k^{2/3} F^{1/3}
    fn stiffness_max(&self, force_max: f64) -> f64 {
        1.5 * self.coefficient.powf(2.0 / 3.0) * force_max.cbrt()
    }
}

/// Hertz as the published code has it with plasticity switched off: wherever the spheres part, or force or overlap lie
/// below their greatest values so far, the force is clipped at F_max. A contact that has never carried force and parts
/// carries none (Burgoyne 2016, appendix A.2.1, lines 51 to 65).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HertzThesis<V = f64>(pub Hertz<V>);

impl LaneLaw for HertzThesis {
    type Lanes<V: Real> = HertzThesis<V>;
    const PARAMETERS: usize = 1;

    fn parameters(&self) -> Vec<f64> {
        self.0.parameters()
    }

    #[inline(always)]
    fn look_up<V: Real>(tables: &[[f64; 16]], place: V::Index) -> HertzThesis<V> {
        HertzThesis(Hertz::look_up(tables, place))
    }
}

impl<V: Real> ForceLaw<V> for HertzThesis<V> {
    #[inline(always)]
    fn force(&self, overlap: V, closing_speed: V, history: &History<V>) -> V {
        let force = self.0.force(overlap, closing_speed, history);
        let clipped =
            V::or(closing_speed.lt(V::splat(0.0)), V::or(force.lt(history.force_max), overlap.lt(history.overlap_max)));
        V::select(clipped, force.min(history.force_max), force)
    }
}

impl NormalLaw for HertzThesis {
    /// Hertz's energy, less what the clipping cuts off above F_max.
    fn stored(&self, overlap: f64, history: &History) -> f64 {
        let clipped_from = (history.force_max / self.0.coefficient).powf(2.0 / 3.0);
        if overlap <= clipped_from {
            self.0.stored(overlap, history)
        } else {
            self.0.stored(clipped_from, history) + history.force_max * (overlap - clipped_from)
        }
    }

    fn stiffness_max(&self, force_max: f64) -> f64 {
        self.0.stiffness_max(force_max)
    }
}
