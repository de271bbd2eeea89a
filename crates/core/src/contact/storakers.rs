//! Plastic contact of metals that harden with strain.

use std::f64::consts::PI;

use super::elastic::{springs_back, sprung_energy};
use super::parameters::law;
use super::{ForceLaw, History, NormalLaw, Pair, elastic};
use crate::real::Number;

law! {
    /// Contact of spheres whose stress grows as a power of the strain, σ = σ₀ ε^m.
    ///
    ///   F = 2^{1−m/2} 3^{1−m} π c^{2+m} σ₁ r*^{1−m/2} δ^{1+m/2},   c² = 1.43 exp(−0.97 m),   a² = 2 c² r* δ
    ///
    /// where that is less than Hertz, so from some δ_c on; below, Hertz. m = `hardening` of [`Constants`](super::Constants); σ₀ = σ_y (E/σ_y)^m, so
    /// that the power begins at the elastic limit; σ₁ = σ₀/2^m for two spheres, of which each takes half of the strain. For
    /// m = 0 the pressure is 3 σ_y on an area that piles up; for m = 1 this is Hertz's law of an incompressible sphere, to 0.3 %. Back elastically as from a
    /// flattened contact, δ_max − δ_r = 3 F_max/(4 E* a); there a² = r* δ_c + 2 c² r* (δ_max − δ_c), which is Hertz's at δ_c, so that the
    /// energy returned has no jump (ours, since the source is rigid-plastic). No rate. The strain is small while a < 0.6 r.
    /// Source: Storåkers, Biwa and Larsson, Int. J. Solids Struct. 34, 3061 (1997); c of Storåkers, Fleck and McMeeking, J. Mech. Phys.
    /// Solids 47, 785 (1999).
    pub struct Storakers {
        /// (4/3) E* √r*
        hertz: V,
        /// δ_c and the force there.
        yield_overlap: V,
        yield_force: V,
        /// 1 + m/2
        power: V,
        /// 2 c² r* (m)
        area_slope: V,
        /// r* δ_c − 2 c² r* δ_c (m²)
        area_offset: V,
        /// 4 E*/3 (Pa)
        modulus: V,
    }
}

impl Storakers {
    /// The law for a pair of spheres.
    pub fn new(pair: &Pair) -> Self {
        let m = pair.constants.tuning.hardening;
        let youngs = 2.0 * pair.modulus * (1.0 - pair.poisson_ratio * pair.poisson_ratio);
        let stress = pair.yield_stress * (0.5 * youngs / pair.yield_stress).powf(m);
        let square = 1.43 * (-0.97 * m).exp();
        let coefficient = 2.0_f64.powf(1.0 - 0.5 * m)
            * 3.0_f64.powf(1.0 - m)
            * PI
            * square.powf(1.0 + 0.5 * m)
            * stress
            * pair.radius.powf(1.0 - 0.5 * m);
        let hertz = pair.hertz_coefficient();
        let yield_overlap = (coefficient / hertz).powf(2.0 / (1.0 - m));
        let area_slope = 2.0 * square * pair.radius;
        Self {
            hertz,
            yield_overlap,
            yield_force: hertz * yield_overlap.powf(1.5),
            power: 1.0 + 0.5 * m,
            area_slope,
            area_offset: (pair.radius - area_slope) * yield_overlap,
            modulus: 4.0 / 3.0 * pair.modulus,
        }
    }
}

impl<V: Number> Storakers<V> {
    /// δ_max − δ_r (m)
    #[inline(always)]
    fn recovered(&self, history: &History<V>) -> V {
        let area = self.area_slope * history.overlap_max + self.area_offset;
        history.force_max / (self.modulus * area.max(V::splat(0.0)).sqrt())
    }
}

impl<V: Number> ForceLaw<V> for Storakers<V> {
    #[inline(always)]
    fn force(&self, overlap: V, _: V, history: &History<V>) -> V {
        let closed = overlap.max(V::splat(0.0));
        let yielded = self.yield_overlap.lt(history.overlap_max);
        let below = closed.lt(V::select(yielded, history.overlap_max, -history.overlap_max));
        let mut force = self.hertz * closed * closed.sqrt();
        let plastic = self.yield_overlap.lt(closed);
        if V::any(plastic) {
            let strain = (closed.max(self.yield_overlap) / self.yield_overlap).ln();
            force = V::select(plastic, self.yield_force * (self.power * strain).exp(), force);
        }
        if V::any(below) {
            force = V::select(below, springs_back(closed, self.recovered(history), history), force);
        }
        force
    }
}

impl NormalLaw for Storakers {
    fn stored(&self, overlap: f64, history: &History) -> f64 {
        if history.overlap_max > self.yield_overlap {
            return sprung_energy(overlap, self.recovered(history), history);
        }
        elastic::stored(self.hertz, overlap)
    }

    /// (3/2) F_max/(δ_max − δ_r) = 2 E* a
    fn stiffness_max(&self, force_max: f64) -> f64 {
        if force_max <= self.yield_force {
            return 1.5 * self.hertz.powf(2.0 / 3.0) * force_max.cbrt();
        }
        let overlap = self.yield_overlap * (force_max / self.yield_force).powf(1.0 / self.power);
        1.5 * self.modulus * (self.area_slope * overlap + self.area_offset).sqrt()
    }

    fn yield_onset(&self, _: f64) -> f64 {
        self.yield_overlap
    }
}
