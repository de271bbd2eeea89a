//! Linear springs, stiffer on the way back.

use super::parameters::law;
use super::{ForceLaw, History, NormalLaw, Pair};
use crate::real::Number;

law! {
    /// Bilinear contact: loading along one straight line, unloading and reloading along a steeper one.
    ///
    ///   F = max(0, min(k₁ δ, F_max + k₂ (δ − δ_max))),   k₂ = κ k₁ + S F_max
    ///
    /// with k₁ = 2 π r* σ_y c₁ at rest, the slope of the fully plastic contact (Burgoyne 2016, eq. 5.2), κ = `spring_back` and S =
    /// `spring_back_growth` of [`Constants`](super::Constants). Two bodies of reduced mass m̄ that meet at speed v come to rest at
    /// F_max = v √(m̄ k₁) and return (1/2) F_max²/k₂, so
    ///
    ///   e = √(k₁/k₂) = (κ + S v √(m̄/k₁))^{−1/2}
    ///
    /// exactly: constant for S = 0, falling with speed for κ = 1. Says nothing of where yield begins, and is as stiff at the first touch
    /// as later. Without cohesion it is Luding's law too. Sources: Walton and Braun, J. Rheol. 30, 949 (1986), eqs 1 to 5; Luding, Granular
    /// Matter 10, 235 (2008), eq. 3.
    pub struct WaltonBraun {
        /// k₁ (N/m)
        pub stiffness: V,
        /// κ k₁ (N/m)
        pub returning: V,
        /// S (1/m)
        pub growth: V,
    }
}

impl WaltonBraun {
    /// The law for a pair of spheres.
    pub fn new(pair: &Pair) -> Self {
        let stiffness = pair.plastic_stiffness();
        let tuning = pair.constants.tuning;
        Self { stiffness, returning: tuning.spring_back * stiffness, growth: tuning.spring_back_growth }
    }

    /// Coefficient of restitution of a head-on collision of bodies with this reduced mass (kg) at this speed (m/s).
    pub fn restitution(&self, reduced_mass: f64, speed: f64) -> f64 {
        let force = speed * (reduced_mass * self.stiffness).sqrt();
        (self.stiffness / self.returning_stiffness(force)).sqrt()
    }
}

impl<V: Number> WaltonBraun<V> {
    /// k₂ (N/m)
    #[inline(always)]
    fn returning_stiffness(&self, force_max: V) -> V {
        self.returning + self.growth * force_max
    }
}

impl<V: Number> ForceLaw<V> for WaltonBraun<V> {
    #[inline(always)]
    fn force(&self, overlap: V, _: V, history: &History<V>) -> V {
        let zero = V::splat(0.0);
        let back = self.returning_stiffness(history.force_max);
        let elastic = history.force_max + back * (overlap - history.overlap_max);
        (self.stiffness * overlap).min(elastic).max(zero)
    }
}

impl NormalLaw for WaltonBraun {
    /// (1/2) k₂ (δ − δ_r)²
    fn stored(&self, overlap: f64, history: &History) -> f64 {
        let back = self.returning_stiffness(history.force_max);
        let force = (history.force_max + back * (overlap - history.overlap_max)).max(0.0);
        if overlap > 0.0 { 0.5 * force * force / back } else { 0.0 }
    }

    fn stiffness_max(&self, force_max: f64) -> f64 {
        self.returning_stiffness(force_max)
    }

    /// It yields from the start.
    fn yield_onset(&self, _: f64) -> f64 {
        0.0
    }
}
