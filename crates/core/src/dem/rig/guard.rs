//! What stops a run of a rig.

use std::fmt;

use super::contacts::Strain;
use super::engine::Engine;
use super::ledger::EnergyLedger;
use super::{Body, Rig};
use crate::dem::share::parts;
use crate::dem::stable_step;

/// Why a run ended before it was asked to. What was computed so far is kept.
#[derive(Clone, Debug, PartialEq)]
pub enum RigStop {
    /// The caller asked for it.
    Interrupted {
        /// Time (s).
        time: f64,
    },
    /// A velocity is not a number any more.
    NotFinite {
        /// Whose.
        body: Body,
        /// Time (s).
        time: f64,
    },
    /// An overlap beyond the law's range.
    Overlap {
        /// The two.
        bodies: [Body; 2],
        /// Overlap over the sum of radii (the diameter at a flat).
        ratio: f64,
        /// What it may be.
        limit: f64,
        /// Time (s).
        time: f64,
    },
    /// The step is too large for a contact that has arisen.
    Step {
        /// The step (s).
        step: f64,
        /// What it may be (s).
        limit: f64,
        /// Stiffness of the contact (N/m).
        stiffness: f64,
        /// The two.
        bodies: [Body; 2],
        /// Time (s).
        time: f64,
    },
    /// The step is stable, but larger than the accuracy that was asked for allows, with a contact that has arisen; see
    /// [`Rig::resolution`].
    Coarse {
        /// The step (s).
        step: f64,
        /// What it may be (s).
        limit: f64,
        /// Stiffness of the contact (N/m).
        stiffness: f64,
        /// The two.
        bodies: [Body; 2],
        /// Time (s).
        time: f64,
    },
    /// Energy appeared or vanished.
    Residual {
        /// What is left over, relative.
        residual: f64,
        /// What it may be.
        limit: f64,
        /// Time (s).
        time: f64,
    },
    /// A sphere has left the domain.
    Escaped {
        /// Which.
        body: Body,
        /// Time (s).
        time: f64,
    },
}

impl std::error::Error for RigStop {}

impl fmt::Display for RigStop {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.words("s", &|body| body.to_string()))
    }
}

impl RigStop {
    /// In words, with times in a unit of this name and bodies as `name` calls them.
    pub fn words(&self, unit: &str, name: &dyn Fn(Body) -> String) -> String {
        let both = |[a, b]: &[Body; 2]| format!("{} and {}", name(*a), name(*b));
        match self {
            Self::Interrupted { time } => format!("interrupted at {time:.4e} {unit}"),
            Self::NotFinite { body, time } => {
                let body = name(*body);
                format!("the velocity of {body} is not finite at {time:.4e} {unit}; try a smaller step")
            }
            Self::Overlap { bodies, ratio, limit, time } => format!(
                "{} overlap by {:.1} % of their radii at {time:.4e} {unit}, beyond the contact law's range of {:.1} %; \
                 the impact is too strong for these spheres",
                both(bodies),
                100.0 * ratio,
                100.0 * limit
            ),
            Self::Step { step, limit, stiffness, bodies, time } => format!(
                "a step of {step:.3e} {unit} is unstable with the contact of {} ({stiffness:.3e} N/m) at {time:.4e} {unit}; it \
                 must stay below {limit:.3e} {unit}",
                both(bodies)
            ),
            Self::Coarse { step, limit, stiffness, bodies, time } => format!(
                "a step of {step:.3e} {unit} is too large for the accuracy asked for, with the contact of {} ({stiffness:.3e} N/m) at \
                 {time:.4e} {unit}; it must stay below {limit:.3e} {unit}",
                both(bodies)
            ),
            Self::Residual { residual, limit, time } => format!(
                "the energy ledger does not close at {time:.4e} {unit}: residual {residual:.2e} of what was put in, above \
                 {limit:.0e}; try half the step"
            ),
            Self::Escaped { body, time } => {
                let body = name(*body);
                format!("{body} leaves the domain at {time:.4e} {unit}; widen the domain or hold it")
            }
        }
    }
}

/// What stops a run, whose balance is drawn in `ledger`.
pub(super) fn guard<const D: usize>(
    rig: &Rig<D>,
    engine: &dyn Engine<D>,
    step: f64,
    ledger: &EnergyLedger,
) -> Result<(), RigStop> {
    let (time, bodies) = (engine.count() as f64 * step, engine.bodies());
    let lost = |i: usize| {
        let body = Body::Sphere(i);
        if !bodies.speed_squared(i).is_finite() {
            return Some(RigStop::NotFinite { body, time });
        }
        let [low, high] = rig.domain?;
        let centre = rig.sample.spheres[i].centre;
        let outside = |k: usize| {
            rig.periods[k].is_none() && !(low[k]..=high[k]).contains(&(centre[k] + bodies.displacement[i][k]))
        };
        (0..D).any(outside).then_some(RigStop::Escaped { body, time })
    };
    let first_lost = parts(bodies.velocity.len(), |mut some| some.find_map(lost));
    if let Some(stop) = first_lost.into_iter().flatten().next() {
        return Err(stop);
    }
    for f in 0..bodies.flat_velocity.len() {
        if bodies.flat_velocity[f].iter().any(|v| !v.is_finite()) {
            return Err(RigStop::NotFinite { body: Body::Flat(f), time });
        }
    }
    let stability = engine.integrator().stability();
    let fine = rig.resolution.map_or(f64::INFINITY, |most| most / step * (most / step));
    for Strain { bodies, ratio, limit, stiffness } in engine.strains(bearable::<D>(step / stability).min(fine)) {
        if ratio > limit {
            return Err(RigStop::Overlap { bodies, ratio, limit, time });
        }
        let limit = stability * stable_step::<D>(stiffness, lighter(rig, bodies));
        if step > limit {
            return Err(RigStop::Step { step, limit, stiffness, bodies, time });
        }
        let mass = reduced(rig, bodies);
        if stiffness > fine * mass {
            let limit = step * (fine * mass / stiffness).sqrt();
            return Err(RigStop::Coarse { step, limit, stiffness, bodies, time });
        }
    }
    let limit = rig.residual_limit;
    match ledger.residual() {
        // Not a number is no small residual either.
        Some(residual) if residual.is_nan() || residual.abs() > limit => {
            Err(RigStop::Residual { residual, limit, time })
        }
        _ => Ok(()),
    }
}

/// The stiffness over reduced mass (1/s²) up to which a step is stable whatever else touches the two: the lighter body weighs at least as
/// much as both reduced.
pub(super) fn bearable<const D: usize>(step: f64) -> f64 {
    let limit = stable_step::<D>(1.0, 1.0) / step;
    // A hair less, so that rounding hides none.
    limit * limit * (1.0 - 1e-9)
}

/// Masses (kg) of two bodies, infinite of what cannot move.
fn masses<const D: usize>(rig: &Rig<D>, bodies: [Body; 2]) -> [f64; 2] {
    bodies.map(|body| match body {
        Body::Sphere(i) if rig.held[i].iter().all(|&held| held) => f64::INFINITY,
        Body::Sphere(i) => rig.mass[i],
        Body::Flat(f) => rig.flats[f].mass,
    })
}

/// Mass (kg) of the lighter of two bodies that can move.
pub(super) fn lighter<const D: usize>(rig: &Rig<D>, bodies: [Body; 2]) -> f64 {
    let [a, b] = masses(rig, bodies);
    a.min(b)
}

/// Reduced mass (kg) of two bodies; half of that at a flat that stands for an equal sphere.
fn reduced<const D: usize>(rig: &Rig<D>, bodies: [Body; 2]) -> f64 {
    let [a, b] = masses(rig, bodies);
    let mean = 1.0 / (1.0 / a + 1.0 / b);
    let stands_for_a_sphere = |body: &Body| matches!(body, Body::Flat(f) if !rig.flats[*f].contact.is_own());
    if bodies.iter().any(stands_for_a_sphere) { 0.5 * mean } else { mean }
}
