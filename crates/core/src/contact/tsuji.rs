//! Hertz with a dashpot that grows with the contact.

use super::parameters::law;
use super::{ForceLaw, History, NormalLaw, Pair, elastic};
use crate::real::Number;

law! {
    /// Hertz and a dashpot, with one coefficient of restitution at all speeds.
    ///
    ///   F = k δ^{3/2} + √5 β √(m̄ k) δ^{1/4} v,   β = −ln e/√(π² + ln² e)
    ///
    /// with k = (4/3) E* √r*, m̄ the reduced mass of two solid spheres of the pair's materials and e = `restitution` of
    /// [`Constants`](super::Constants). In u = δ^{5/4} the motion is that of a linear spring and dashpot, which makes e exact (Antypov and
    /// Elliott, EPL 94, 50004 (2011)) where the contact lasts until δ = 0: it pulls a little as it ends. No plasticity and no rate; for bodies of which
    /// only the restitution is known. Source: Tsuji, Tanaka and Ishida, Powder Technol. 71, 239 (1992), eq. 17.
    pub struct Tsuji {
        /// k (N/m^{3/2})
        pub coefficient: V,
        /// √5 β √(m̄ k) (kg/(s m^{1/4}))
        pub damping: V,
    }
}

impl Tsuji {
    /// The law for a pair of spheres.
    pub fn new(pair: &Pair) -> Self {
        let coefficient = pair.hertz_coefficient();
        let lost = -pair.constants.tuning.restitution.ln();
        let ratio = lost / (std::f64::consts::PI.powi(2) + lost * lost).sqrt();
        Self { coefficient, damping: (5.0 * pair.reduced_mass * coefficient).sqrt() * ratio }
    }
}

impl<V: Number> ForceLaw<V> for Tsuji<V> {
    #[inline(always)]
    fn force(&self, overlap: V, closing_speed: V, _: &History<V>) -> V {
        let root = overlap.max(V::splat(0.0)).sqrt();
        self.coefficient * root * root * root + self.damping * root.sqrt() * closing_speed
    }
}

impl NormalLaw for Tsuji {
    fn is_plastic() -> bool {
        false
    }

    /// That of its spring; what its dashpot takes is lost.
    fn stored(&self, overlap: f64, _: &History) -> f64 {
        elastic::stored(self.coefficient, overlap)
    }

    fn stiffness_max(&self, force_max: f64) -> f64 {
        elastic::stiffness(self.coefficient, force_max)
    }
}
