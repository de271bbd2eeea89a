//! How two spheres push each other apart: pair constants, normal laws, and what a contact remembers.
//!
//! A law is pure: overlap (m), closing speed (m/s) and [`History`] in, force (N) out. The history is kept by the caller and
//! advanced once per accepted step with the force evaluated on the old history, so reading a force never changes a
//! trajectory (Burgoyne 2016, appendix A.2.3).
//!
//! - `pair`: E*, r*, the yielding partner, and the fitted constants of the pair
//! - `constants`: the sets of fitted constants, and the numbers that laws leave to their user
//! - `elastic`: Hertz, with and without the published clipping by history
//! - `elastoplastic`: the published elastic-plastic law and its linear simplification, with and without rate
//! - `consistent`: our variant of it, which creates no energy on any path
//! - `mdr`: Zunker and Kamrin's law for large overlaps; `thornton`: Hertz with a limit to the pressure; `storakers`: hardening metals
//! - `walton_braun`: straight lines; `tsuji`: Hertz with a coefficient of restitution
//! - `tabulated`: a measured force-displacement curve; `dashpot`: spring and dashpot of granular beds
//! - `collision`: what a head-on collision comes to; `fit`: a law's constants from a measured curve
//! - `parameters`: a law's numbers by name, for one pair, in lanes, with derivatives
//! - `law`: the laws by name, one type that holds any of them, and the choice. **A new law is its file, and its line there**
//!
//! # Choosing a law
//!
//! `thesis` is the published law to the letter, defects included. In region II its curve lies up to 8 % above Hertz, so a
//! cycle with a peak force between F_y and 3.1 F_y returns up to 6 % more energy than it took; below F_y it is not elastic;
//! its force jumps where the rate factor switches. In the lens problem all of this together is 2.4·10⁻⁴ of the 674 J
//! dissipated; in gentle collisions it is not small.
//!
//! `consistent` keeps the published curve where it was fitted (region III) and mends the rest. Take `thesis` to repeat
//! published figures, `consistent` to design: `docs/consistent-law.md` derives it and says how far the two lie apart.

mod collision;
mod consistent;
mod constants;
mod dashpot;
mod elastic;
mod elastoplastic;
mod fit;
mod law;
mod mdr;
mod pair;
mod parameters;
mod storakers;
mod tabulated;
mod thornton;
mod tsuji;
mod walton_braun;

pub use collision::{Collision, collide};
pub use consistent::Consistent;
pub use constants::{ConstantSet, Constants, Tuning, TuningError};
pub use dashpot::Dashpot;
pub(crate) use elastic::hertz_over_distance;
pub use elastic::{Hertz, HertzThesis};
pub use elastoplastic::{ElastoPlastic, LinearPlastic};
pub use fit::{Constant, Estimate, Fit, FitError, Measured, fit};
pub use law::{AnyLaw, LawKind, UnknownName, WithLaw};
pub use mdr::Mdr;
pub use pair::{Pair, Regions};
pub use parameters::{Asked, Listed, Parameters, Source};
pub use storakers::Storakers;
pub use tabulated::{TableError, Tabulated};
pub use thornton::Thornton;
pub use tsuji::Tsuji;
pub use walton_braun::WaltonBraun;

use crate::real::{Lanes, Number};

/// What a contact remembers of its past.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct History<V = f64> {
    /// δ_max, the greatest overlap so far (m)
    pub overlap_max: V,
    /// F_max, the greatest force so far (N)
    pub force_max: V,
    /// What the law remembers besides (m); zero in a contact that has never been closed. [`Consistent`]: ω, by how much the contact springs back
    /// further from (δ_max, F_max) than one that yielded at that point. [`Mdr`]: the overlap at which it begins to yield.
    pub own: V,
}

impl<V: Number> History<V> {
    /// A contact that has never been closed.
    pub fn new() -> Self {
        Self::yielded_at(V::splat(0.0), V::splat(0.0))
    }

    /// A contact whose greatest overlap (m) and force (N) are these, both of the same moment in which it yielded.
    #[inline(always)]
    pub fn yielded_at(overlap_max: V, force_max: V) -> Self {
        Self { overlap_max, force_max, own: V::splat(0.0) }
    }

    /// The history after an accepted step with this overlap and the force evaluated on the old history.
    #[inline(always)]
    #[must_use]
    pub fn advanced(self, overlap: V, force: V) -> Self {
        Self { overlap_max: overlap.max(self.overlap_max), force_max: force.max(self.force_max), ..self }
    }
}

impl<V: Number> Default for History<V> {
    fn default() -> Self {
        Self::new()
    }
}

/// The force of a normal contact law between two given spheres, for one design or several side by side.
pub trait ForceLaw<V: Number> {
    /// Repulsive force (N) at an overlap (m) and closing speed (m/s) (positive while the spheres approach). Zero where the
    /// overlap is not positive.
    fn force(&self, overlap: V, closing_speed: V, history: &History<V>) -> V;

    /// The force, and the history after an accepted step in this state. A published law remembers its greatest overlap and
    /// force.
    #[inline(always)]
    fn respond(&self, overlap: V, closing_speed: V, history: &History<V>) -> (V, History<V>) {
        let force = self.force(overlap, closing_speed, history);
        (force, history.advanced(overlap, force))
    }
}

/// Overlap over the sum of radii up to which most laws may be followed. About a contact that yields all that is pressed aside piles up
/// under them, a² = 2 r* δ: between equal spheres the contact's radius a is then R/√2, and nothing is left of small contacts on spheres.
pub const OVERLAP_LIMIT: f64 = 0.25;

/// A normal contact law between two given spheres.
pub trait NormalLaw: ForceLaw<f64> {
    /// Whether contacts yield under it.
    fn is_plastic() -> bool
    where
        Self: Sized,
    {
        true
    }

    /// What [`History::own`] is, by name and unit, where the law uses it.
    fn own_memory() -> Option<&'static str>
    where
        Self: Sized,
    {
        None
    }

    /// Energy (J) that the contact gives back when it opens quasistatically from this overlap.
    fn stored(&self, overlap: f64, history: &History) -> f64;

    /// The greatest stiffness dF/dδ (N/m) that the contact can show after having carried `force_max` (N); it limits the
    /// step.
    fn stiffness_max(&self, force_max: f64) -> f64;

    /// Overlap over the sum of radii up to which the law may be followed; a run that goes beyond it is stopped.
    fn overlap_limit(&self) -> f64 {
        OVERLAP_LIMIT
    }

    /// The overlap (m) up to which a fresh contact does not yield at this closing speed (m/s); infinite for what never yields.
    fn yield_onset(&self, _closing_speed: f64) -> f64 {
        f64::INFINITY
    }

    /// What a contact remembers of which only its greatest overlap (m), and the force (N) it carried there, are known.
    fn recalled(&self, overlap_max: f64, force_max: f64) -> History {
        History::yielded_at(overlap_max, force_max)
    }
}

/// A law whose parameters can be looked up for several designs side by side.
pub trait LaneLaw: NormalLaw + Copy + Send + Sync + 'static {
    /// How many parameters there are.
    const PARAMETERS: usize;
    /// Whether loops are compiled for it alone; for all laws together, out of line, only where they have to be.
    const HAS_OWN_LOOPS: bool = true;
    /// The parameters of a law of this type in the order of the tables from which lanes look them up.
    fn parameters(law: &AnyLaw) -> Vec<f64>;
    /// The force in the state asked for, with each lane's own parameters.
    fn force_at<V: Lanes>(asked: &Asked<'_, V>) -> V;
    /// The force, and the history after an accepted step.
    fn respond_at<V: Lanes>(asked: &Asked<'_, V>) -> (V, History<V>);
}
