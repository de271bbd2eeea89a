//! What stops a run: each guard says what went wrong, where and when.

use serde::{Deserialize, Serialize};

use super::body::Grains;
use super::contacts::{Contacts, Laws};
use super::step::Stepper;
use crate::contact::{NormalLaw as _, OVERLAP_LIMIT};
use crate::real::Lanes;

/// Overlap over the sum of radii from which on contacts 60 degrees apart on one sphere (a = R/2) grow into each other, and
/// the law, made for lone contacts, is stretched. The published lens problem reaches 0.11
/// at its steel-brass interface, brass alone under the same impact 0.16.
pub const OVERLAP_WARNING: f64 = 0.125;

/// Energy residual above which a run is marked failed.
pub const RESIDUAL_LIMIT: f64 = 1e-3;

/// Two spheres in words, or one and its image in a plane of symmetry or a wall.
fn both(&[a, b]: &[usize; 2]) -> String {
    if a == b { format!("sphere {a} and its own image") } else { format!("spheres {a} and {b}") }
}

/// Why a run ended before its window did, or cannot be trusted.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize, thiserror::Error)]
#[serde(tag = "guard", rename_all = "kebab-case")]
pub enum Stop {
    /// The caller asked for it.
    #[error("interrupted at {time_s:.3e} s")]
    Interrupted {
        /// Time of the last accepted step (s).
        time_s: f64,
    },
    /// A velocity is not a number any more.
    #[error("the velocity of sphere {sphere} is not finite at {time_s:.3e} s; try a smaller step")]
    NotFinite {
        /// Sphere, from 1 in the sample's order.
        sphere: usize,
        /// Time (s).
        time_s: f64,
    },
    /// An overlap beyond the law's range.
    #[error(
        "{} overlap by {:.1} % of their radii at {time_s:.3e} s, beyond the contact law's range of {:.0} %; \
         the impact is too strong for these spheres",
        both(spheres), 100.0 * overlap_ratio, 100.0 * limit
    )]
    Overlap {
        /// Spheres, from 1; the same twice for a sphere and its mirror image.
        spheres: [usize; 2],
        /// Overlap over the sum of radii.
        overlap_ratio: f64,
        /// What it may be, by the law of the two.
        #[serde(default = "usual_limit")]
        limit: f64,
        /// Time (s).
        time_s: f64,
    },
    /// The step is too large for a contact that has arisen.
    #[error(
        "a step of {step_s:.3e} s is unstable with the contact of {} ({stiffness:.3e} N/m) at {time_s:.3e} s; \
         it must stay below {limit_s:.3e} s",
        both(spheres)
    )]
    Step {
        /// The step (s).
        step_s: f64,
        /// What it may be (s).
        limit_s: f64,
        /// Stiffness of the contact (N/m).
        stiffness: f64,
        /// Spheres, from 1.
        spheres: [usize; 2],
        /// Time (s).
        time_s: f64,
    },
    /// Spheres that are no neighbours in a crystal whose contacts are fixed have come near each other.
    #[error(
        "{} are no neighbours and have come near each other at {time_s:.3e} s; this is no crystal any more, and is \
         to be followed as one whose contacts are looked for",
        both(spheres)
    )]
    Met {
        /// Spheres, from 1; the same twice for a sphere and its mirror image.
        spheres: [usize; 2],
        /// Time (s).
        time_s: f64,
    },
    /// Spheres so fast that they might pass through each other between two steps.
    #[error("a sphere moves by more than its diameter in a step of {step_s:.3e} s; try a smaller step")]
    Leap {
        /// The step (s).
        step_s: f64,
    },
    /// What a search asked for cannot be reached any more; see [`Limit`](super::Limit).
    #[error("ended at {time_s:.3e} s: what was asked for cannot be reached any more")]
    Beyond {
        /// Time of the last accepted step (s).
        time_s: f64,
    },
    /// Energy appeared or vanished.
    #[error(
        "the energy ledger does not close: residual {residual:.2e} of the work put in, above {RESIDUAL_LIMIT:.0e}; \
         try half the step"
    )]
    Residual {
        /// (work in − kinetic − stored − dissipated)/work in
        residual: f64,
    },
}

impl Stop {
    /// With the numbers that spheres have in a greater sample, of which what was simulated is a part; indices from 0.
    #[must_use]
    pub fn renumbered(self, of: impl Fn(usize) -> usize) -> Self {
        let new = |sphere: usize| of(sphere - 1) + 1;
        match self {
            Self::NotFinite { sphere, time_s } => Self::NotFinite { sphere: new(sphere), time_s },
            Self::Overlap { spheres, overlap_ratio, limit, time_s } => {
                Self::Overlap { spheres: spheres.map(new), overlap_ratio, limit, time_s }
            }
            Self::Step { step_s, limit_s, stiffness, spheres, time_s } => {
                Self::Step { step_s, limit_s, stiffness, spheres: spheres.map(new), time_s }
            }
            Self::Met { spheres, time_s } => Self::Met { spheres: spheres.map(new), time_s },
            other @ (Self::Interrupted { .. } | Self::Leap { .. } | Self::Beyond { .. } | Self::Residual { .. }) => {
                other
            }
        }
    }
}

/// What records did not say before laws had limits of their own.
fn usual_limit() -> f64 {
    OVERLAP_LIMIT
}

/// Largest stable step (s) for contacts of stiffness `stiffness` (N/m) between spheres of mass `mass` (kg) in `D`
/// dimensions: 2/ω with ω² = 2 (D + 1) K/m, the highest frequency of a chain (4 K/m), a hexagonal sheet (6 K/m) or a
/// close-packed crystal (8 K/m) all of whose contacts are as stiff.
pub fn stable_step<const D: usize>(stiffness: f64, mass: f64) -> f64 {
    stable(D, stiffness, mass)
}

fn stable(dimension: usize, stiffness: f64, mass: f64) -> f64 {
    2.0 / (2.0 * (dimension as f64 + 1.0) * stiffness / mass).sqrt()
}

/// The stable step of spheres that turn over that of spheres that do not. In a sheet of contacts K and k_t, each sphere turning as its six
/// neighbours do, I ω² = 12 k_t r², so ω² = 30 k_t/m against 6 K/m; and Mindlin's k_t is at most K (for ν = 0).
const TURNING: f64 = 0.447;

/// Looks at a run in progress, again and again.
pub(super) struct Watch<V> {
    /// The greatest overlap and force of each contact when last looked at: what has not grown since need not be judged again.
    judged: Vec<(V, V)>,
    /// Contacts to be judged at this look.
    grown: Vec<usize>,
    /// Dimensions for which the step's stability is judged.
    dimension: usize,
}

impl<V: Lanes> Watch<V> {
    pub fn new(dimension: usize) -> Self {
        Self { judged: Vec::new(), grown: Vec::new(), dimension }
    }

    /// Finds which contacts are to be judged, and whether all spheres of all designs have speeds.
    #[inline(always)]
    pub fn look<const D: usize>(&mut self, grains: &Grains<V, D>, contacts: &Contacts<'_, V, D>) -> AllFinite {
        let mut nothing = V::splat(0.0);
        for i in 0..grains.reached {
            nothing = nothing + (grains.speed_squared(i) - grains.speed_squared(i));
        }
        let zero = V::splat(0.0);
        let history = &contacts.history;
        // Contacts are renumbered when some are taken up.
        if self.judged.len() != history.len() {
            self.judged = vec![(zero, zero); history.len()];
        }
        self.grown.clear();
        for c in 0..history.len() {
            let (overlap, force) = (history[c].overlap_max, history[c].force_max);
            let (overlap_judged, force_judged) = self.judged[c];
            if V::any(V::or(overlap_judged.lt(overlap), force_judged.lt(force))) {
                self.judged[c] = (overlap, force);
                self.grown.push(c);
            }
        }
        AllFinite((0..V::LANES).all(|lane| nothing.lane(lane) == 0.0))
    }

    /// Judges one design.
    pub fn judge<const D: usize>(
        &self,
        stepper: &Stepper<V, D>,
        grains: &Grains<V, D>,
        contacts: &Contacts<'_, V, D>,
        laws: &dyn Laws<V, D>,
        AllFinite(all_finite): AllFinite,
        lane: usize,
    ) -> Result<(), Stop> {
        let (time_s, step_s) = (stepper.time(), stepper.step);
        let is_finite = |i: &usize| grains.speed_squared(*i).lane(lane).is_finite();
        if let Some(i) = (0..if all_finite { 0 } else { grains.reached }).find(|i| !is_finite(i)) {
            return Err(Stop::NotFinite { sphere: i + 1, time_s });
        }
        for &c in &self.grown {
            let (overlap_max, force_max) = contacts.greatest(c, lane);
            if force_max <= 0.0 {
                continue;
            }
            let [a, b] = contacts.list.spheres(c);
            let spheres = [a + 1, b + 1];
            let overlap_ratio = overlap_max / contacts.radii_sum(c, lane);
            // No law has a lower limit; few contacts are asked for theirs.
            if overlap_ratio > OVERLAP_LIMIT {
                let limit = laws.one(c, lane).overlap_limit();
                if overlap_ratio > limit {
                    return Err(Stop::Overlap { spheres, overlap_ratio, limit, time_s });
                }
            }
            let stiffness = contacts.stiffness(laws, c, lane);
            let mut inverse = grains.inverse_mass[a].lane(lane).max(grains.inverse_mass[b].lane(lane));
            if let Some(plate) =
                contacts.plate.as_ref().filter(|plate| contacts.list.is_image_in(c, &plate.mirror.into()))
            {
                inverse = inverse.max(plate.inverse_share.lane(lane));
            }
            let lighter = 1.0 / inverse;
            let mut limit_s = stepper.integrator.stability() * stable(self.dimension, stiffness, lighter);
            if contacts.friction.is_some() {
                limit_s *= TURNING;
            }
            if step_s > limit_s {
                return Err(Stop::Step { step_s, limit_s, stiffness, spheres, time_s });
            }
        }
        Ok(())
    }
}

/// Whether no speed of any design is infinite or no number.
#[derive(Clone, Copy)]
pub(super) struct AllFinite(bool);
