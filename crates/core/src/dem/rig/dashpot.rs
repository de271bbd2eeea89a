//! Springs and dashpots between bodies of any mass, and how their contacts begin and end within a step.

use crate::contact::Dashpot;
use crate::real::Lanes;

/// F = k δ + c v of any two spheres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SpringDashpot {
    /// k (N/m)
    pub stiffness: f64,
    /// What the dashpot takes.
    pub loss: Loss,
    /// Whether the force is cut at zero, so that contacts never pull.
    pub cut: bool,
}

/// The dashpot c of two bodies of reduced mass m̄.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Loss {
    /// c = γ m̄ with γ (1/s) (Kondic et al. 2012): heavy bodies rebound with less than light ones.
    Rate(f64),
    /// c = η √(k m̄): with τ = t √(k/m̄) a head-on collision is δ″ + η δ′ + δ = 0 whatever mass and stiffness, so that its
    /// restitution depends on η alone.
    Ratio(f64),
}

impl Loss {
    /// The dashpots with which every head-on collision has this coefficient of restitution, from 0.02 to 1.
    pub fn with_restitution(restitution: f64, cut: bool) -> Self {
        if restitution >= 1.0 {
            return Self::Ratio(0.0);
        }
        Self::Ratio(Dashpot::with_restitution(1.0, 1.0, restitution, cut).damping)
    }

    /// Whether it is that of each pair.
    #[inline(always)]
    pub(super) fn is_exact(self) -> bool {
        matches!(self, Self::Ratio(_))
    }

    /// γ or η.
    #[inline(always)]
    pub(super) fn number(self) -> f64 {
        match self {
            Self::Rate(number) | Self::Ratio(number) => number,
        }
    }
}

/// What acts after a contact has opened within a step.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Ended<V = f64> {
    /// Force (N) over one step, which makes up for what the last closed state acted too long or too short.
    pub acts: V,
    /// The force with which the contact ended (N).
    pub last: V,
}

impl<V: Lanes> Ended<V> {
    /// Of a force that was linear from an overlap (m) and force (N) a step ago to this at no overlap, where it ended; now the surfaces are
    /// a gap (m) apart.
    #[inline(always)]
    pub fn within([overlap, force]: [V; 2], gap: V, last: V) -> Self {
        let part = overlap / (overlap + gap);
        Self { acts: V::splat(0.5) * (part * (force + last) - force), last }
    }
}

/// Contacts begin and end within a step, and the dashpot's force does so with a jump. Velocity Verlet lets the force F of a state
/// act over half the step before it and half the step after. That gives the impulse of a force that is linear between states; where
/// it begins or ends a part θ of a step away, the impulse is θ h (F₀ + F)/2 instead of h F/2. The difference is given at once, as an impulse
/// of its own, so that the restitution is of second order in the step, as all else is, and forces are those of the contact.
impl SpringDashpot {
    /// The law's name in files.
    pub const NAME: &'static str = "spring-dashpot";

    /// The same restitution for every pair, from 0.02 to 1.
    pub fn with_restitution(stiffness: f64, restitution: f64, cut: bool) -> Self {
        Self { stiffness, loss: Loss::with_restitution(restitution, cut), cut }
    }

    /// c (kg/s) between bodies of reduced mass m̄ (kg).
    #[inline(always)]
    pub fn damping(&self, reduced: f64) -> f64 {
        match self.loss {
            Loss::Rate(rate) => rate * reduced,
            Loss::Ratio(ratio) => ratio * (self.stiffness * reduced).sqrt(),
        }
    }

    /// Force (N) of closed contacts, one or several side by side, with dashpots c (kg/s).
    #[inline(always)]
    pub(super) fn push<V: Lanes>(&self, overlap: V, closing_speed: V, damping: V) -> V {
        self.of(0.0).push(overlap, closing_speed, damping)
    }

    #[inline(always)]
    pub(super) fn of(self, reduced: f64) -> Dashpot {
        Dashpot { stiffness: self.stiffness, damping: self.damping(reduced), cut: self.cut }
    }

    /// What acts (N) in the first state after the contact has closed, the force proper, and that with which it began.
    #[inline(always)]
    pub(super) fn begin(&self, overlap: f64, closing_speed: f64, reduced: f64, step: f64) -> (f64, f64, f64) {
        self.begin_all(overlap, closing_speed, (self.damping(reduced), reduced), step)
    }

    /// The same of contacts side by side, with dashpots c (kg/s) between bodies of reduced mass m̄ (kg).
    #[inline(always)]
    pub(super) fn begin_all<V: Lanes>(
        &self,
        overlap: V,
        closing_speed: V,
        (damping, reduced): (V, V),
        step: f64,
    ) -> (V, V, V) {
        let (zero, half, one) = (V::splat(0.0), V::splat(0.5), V::splat(1.0));
        let at_rest = self.push(overlap, closing_speed, damping);
        // Where nothing closes, at the start of a run, the force counts as it is.
        let way = closing_speed * V::splat(step);
        let closes = zero.lt(way);
        let part = V::select(overlap.lt(way), overlap / way, one);
        let onset = V::select(closes, damping * closing_speed, zero);
        // The predicted speed knows nothing of the contact yet: since it closed it has fallen by θ h (F₀ + F)/(2 m̄), F = k δ + c v.
        let slowed = half * part * V::splat(step) * damping / reduced;
        let mut force = (V::splat(self.stiffness) * overlap + onset - slowed * onset) / (one + slowed);
        if self.cut {
            force = force.max(zero);
        }
        let acts = half * (force + part * (onset + force));
        (V::select(closes, acts, at_rest), V::select(closes, force, at_rest), onset)
    }

    /// How a contact ends that had this overlap (m) and force (N) a step ago, and whose surfaces are now a gap (m) apart.
    #[inline(always)]
    pub(super) fn end(&self, [overlap, force]: [f64; 2], gap: f64, closing_speed: f64, reduced: f64) -> Ended {
        self.end_all(overlap, force, gap, closing_speed, self.damping(reduced))
    }

    /// The same of contacts side by side, with dashpots c (kg/s).
    #[inline(always)]
    pub(super) fn end_all<V: Lanes>(&self, overlap: V, force: V, gap: V, closing_speed: V, damping: V) -> Ended<V> {
        let (zero, half) = (V::splat(0.0), V::splat(0.5));
        let part = overlap / (overlap + gap);
        let last = damping * closing_speed;
        if self.cut {
            // It ends where the force, linear from the last state to δ = 0, is zero.
            let part = V::select(zero.lt(force - last), part * force / (force - last), part);
            return Ended { acts: half * force * (part - V::splat(1.0)), last: zero };
        }
        Ended::within([overlap, force], gap, last)
    }
}
