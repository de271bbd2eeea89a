//! A crystal squeezed to rest, before anything strikes it.
//!
//! Everything is brought closer along the axes that are asked for, alike everywhere; then the spheres move under heavy drag until the
//! forces on each balance. A force is had by the strain at which a section carries it. What is squeezed is new: its contacts have never
//! been opened, so that a plastic law stands on its loading curve.

use crate::Context;
use crate::dem::{MoveIn, Spheres};

use super::flat::Face;
use super::simulation::Simulation;
use super::{Body, Rig, RigError, RigStop};

/// How far a rig is squeezed along an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Squeeze {
    /// Shortened by this part of its length.
    Strain(f64),
    /// Until this force (N) is carried across the whole of a section.
    Force(f64),
}

/// A squeezed rig at rest.
#[derive(Clone, Debug)]
pub struct Precompressed<const D: usize> {
    /// The rig as it then is, fit to be struck: places are those at rest; loads and velocities are as they were.
    pub rig: Rig<D>,
    /// By which part it is shorter along each axis.
    pub strain: [f64; D],
    /// The force (N) across a section along each axis.
    pub force: [f64; D],
    /// The greatest force on a sphere that is not balanced, over the greatest contact force.
    pub unbalanced: f64,
}

/// A rig that cannot be squeezed to rest.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PreloadError {
    /// The squeezed rig is none.
    #[error(transparent)]
    Rig(#[from] RigError),
    /// A guard stopped it on its way to rest, or the caller.
    #[error(transparent)]
    Stop(#[from] RigStop),
    /// There is something in it that cannot be squeezed.
    #[error("{0} cannot be squeezed with the crystal")]
    Part(&'static str),
    /// Nothing holds it together.
    #[error("no contact carries a force: nothing holds the crystal along the axes that are squeezed")]
    Loose,
    /// It does not come to rest.
    #[error("forces are balanced to {unbalanced:.1e} of the greatest contact force only, not to {tolerance:.1e}")]
    Unrest {
        /// What is left.
        unbalanced: f64,
        /// What was asked for.
        tolerance: f64,
    },
    /// No strain gives the force.
    #[error("no strain up to {strain:.2} gives a force of {wanted:.4e} N along axis {}; {found:.4e} N were reached", axis + 1)]
    Force {
        /// Index of the axis.
        axis: usize,
        /// (N)
        wanted: f64,
        /// (N)
        found: f64,
        /// The greatest that was tried.
        strain: f64,
    },
}

/// The most a rig is shortened.
const MOST_STRAIN: f64 = 0.3;
/// Steps to rest, at most.
const PATIENCE: u64 = 400_000;
/// Steps between two looks.
const LOOK: u64 = 100;
/// Times the state at rest is begun anew and brought to rest again.
const ROUNDS: usize = 6;
/// A force is met to this part.
const MET: f64 = 1e-9;

/// Squeezes a rig along some axes and brings it to rest: no force on a sphere is left that is more than `tolerance` of the greatest contact
/// force. Friction rests meanwhile, and so do loads; gravity acts.
///
/// # Errors
/// See [`PreloadError`].
pub fn precompress<const D: usize>(
    rig: &Rig<D>,
    along: [Option<Squeeze>; D],
    tolerance: f64,
    context: &Context,
) -> Result<Precompressed<D>, PreloadError>
where
    Spheres: MoveIn<D>,
{
    if !rig.clusters.is_empty() {
        return Err(PreloadError::Part("a rigid body of several spheres"));
    }
    let mut strain = along.map(|precompress| match precompress {
        Some(Squeeze::Strain(strain)) => strain,
        Some(Squeeze::Force(_)) => 1e-5,
        None => 0.0,
    });
    // For each axis ln strain and ln force of the round before: the exponent of the force follows from two.
    let mut before: [Option<[f64; 2]>; D] = [None; D];
    for _ in 0..100 {
        let squeezed = at_rest(rig, strain, tolerance, context)?;
        let mut met = true;
        for k in 0..D {
            let Some(Squeeze::Force(wanted)) = along[k] else { continue };
            let found = squeezed.force[k];
            if (found / wanted - 1.0).abs() < MET {
                continue;
            }
            met = false;
            if found <= 0.0 {
                strain[k] *= 4.0;
            } else {
                let now = [strain[k].ln(), found.ln()];
                // Hertz to begin with, F ~ strain^(3/2).
                let exponent = before[k].map_or(1.5, |old| (now[1] - old[1]) / (now[0] - old[0]));
                let exponent = if exponent.is_finite() { exponent.clamp(0.7, 4.0) } else { 1.5 };
                strain[k] *= (wanted / found).powf(1.0 / exponent).clamp(0.1, 10.0);
                before[k] = Some(now);
            }
            if strain[k] > MOST_STRAIN {
                return Err(PreloadError::Force { axis: k, wanted, found, strain: MOST_STRAIN });
            }
        }
        if met {
            return Ok(squeezed);
        }
    }
    Err(PreloadError::Unrest { unbalanced: f64::NAN, tolerance })
}

/// The rig shortened by these strains, at rest.
fn at_rest<const D: usize>(
    rig: &Rig<D>,
    strain: [f64; D],
    tolerance: f64,
    context: &Context,
) -> Result<Precompressed<D>, PreloadError>
where
    Spheres: MoveIn<D>,
{
    let mut squeezed = shortened(rig, strain);
    let mut left = f64::INFINITY;
    for _ in 0..ROUNDS {
        let still = still(&squeezed);
        // So short a step that nothing refuses it; nothing moves yet.
        let fresh = Simulation::new(still.clone(), 1e-15)?;
        let Some(state) = State::of(&fresh) else { return Err(PreloadError::Loose) };
        left = state.unbalanced;
        if left <= tolerance {
            let force = section_forces(&fresh);
            return Ok(Precompressed { rig: squeezed, strain, force, unbalanced: left });
        }
        let relaxed = relaxed(still, &state, 0.3 * tolerance, context)?;
        let view = relaxed.view();
        for (i, sphere) in squeezed.sample.spheres.iter_mut().enumerate() {
            sphere.centre = view.position(i);
        }
    }
    Err(PreloadError::Unrest { unbalanced: left, tolerance })
}

/// Everything brought closer, alike along each axis.
fn shortened<const D: usize>(rig: &Rig<D>, strain: [f64; D]) -> Rig<D> {
    let mut rig = rig.clone();
    rig.precompressed = true;
    let shorten = |point: &mut [f64; D]| (0..D).for_each(|k| point[k] *= 1.0 - strain[k]);
    rig.sample.spheres.iter_mut().for_each(|sphere| shorten(&mut sphere.centre));
    for flat in &mut rig.flats {
        shorten(&mut flat.point);
        if let Face::Polygon(corners) = &mut flat.face {
            corners.iter_mut().for_each(shorten);
        }
    }
    for mirror in &mut rig.mirrors {
        mirror.position *= 1.0 - strain[mirror.axis];
    }
    for (period, strain) in rig.periods.iter_mut().zip(strain) {
        *period = period.map(|period| period * (1.0 - strain));
    }
    rig
}

/// The same with nothing that drives it.
fn still<const D: usize>(rig: &Rig<D>) -> Rig<D> {
    let mut rig = rig.clone();
    rig.velocity.fill([0.0; D]);
    rig.spin.fill([0.0; 3]);
    for flat in &mut rig.flats {
        (flat.velocity, flat.held) = ([0.0; D], [true; D]);
    }
    (rig.loads, rig.bars) = (Vec::new(), Vec::new());
    rig.laws.without_friction();
    rig.flats.iter_mut().for_each(|flat| flat.contact.friction = None);
    // On its way to rest energy is not looked after.
    (rig.domain, rig.residual_limit, rig.resolution) = (None, f64::INFINITY, None);
    rig
}

/// What a squeezed rig is judged by.
struct State {
    unbalanced: f64,
    /// Of the stiffest contact (N/m), and the lightest sphere (kg).
    stiffness: f64,
    mass: f64,
}

impl State {
    /// None where no contact carries a force.
    fn of<const D: usize>(simulation: &Simulation<D>) -> Option<Self> {
        let (view, rig) = (simulation.view(), simulation.rig());
        let (mut pressed, mut stiffness) = (0.0_f64, 0.0_f64);
        for contact in view.contacts() {
            pressed = pressed.max(contact.force);
            stiffness = stiffness.max(contact.stiffness);
        }
        let mut left = 0.0_f64;
        let mut lightest = f64::INFINITY;
        for (i, sphere) in rig.sample.spheres.iter().enumerate() {
            let force = view.net_force(i);
            for k in (0..D).filter(|&k| !rig.held[i][k]) {
                lightest = lightest.min(rig.mass[i]);
                let mirrored =
                    rig.mirrors.iter().any(|mirror| mirror.axis == k && mirror.carries(&sphere.centre, sphere.radius));
                if !mirrored {
                    left = left.max((force[k] + view.simulated_fraction(i) * rig.mass[i] * rig.gravity[k]).abs());
                }
            }
        }
        (pressed > 0.0).then_some(Self { unbalanced: left / pressed, stiffness, mass: lightest })
    }
}

/// Lets a rig move under drag until its forces balance, or as long as patience lasts.
fn relaxed<const D: usize>(
    mut rig: Rig<D>,
    state: &State,
    tolerance: f64,
    context: &Context,
) -> Result<Simulation<D>, PreloadError>
where
    Spheres: MoveIn<D>,
{
    let fastest = (state.stiffness / state.mass).sqrt();
    let longest = (0..D)
        .map(|k| {
            let ends = rig.sample.spheres.iter().fold([f64::INFINITY, f64::NEG_INFINITY], |[low, high], sphere| {
                [low.min(sphere.centre[k]), high.max(sphere.centre[k])]
            });
            ends[1] - ends[0]
        })
        .fold(0.0, f64::max);
    let radius = rig.sample.spheres.iter().map(|sphere| sphere.radius).fold(f64::INFINITY, f64::min);
    // The slowest wave stands once in twice the length: its critical damping.
    rig.drag = 2.0 * fastest * std::f64::consts::PI / (2.0 * (1.0 + 0.5 * longest / radius));
    let mut simulation = Simulation::new(rig, 0.15 / fastest)?;
    while simulation.steps() < PATIENCE {
        simulation.advance(LOOK, context)?;
        if State::of(&simulation).is_none_or(|state| state.unbalanced <= tolerance) {
            break;
        }
    }
    Ok(simulation)
}

/// The force (N) across a section along each axis: of all contacts the force along it times how far they reach along it, over the length.
fn section_forces<const D: usize>(simulation: &Simulation<D>) -> [f64; D] {
    let (view, rig) = (simulation.view(), simulation.rig());
    let mut carried = [0.0; D];
    let (mut low, mut high) = ([f64::INFINITY; D], [f64::NEG_INFINITY; D]);
    for contact in view.contacts() {
        let spheres = contact.bodies.map(|body| match body {
            Body::Sphere(i) => Some(i),
            Body::Flat(_) => None,
        });
        let (from, reach) = match (contact.bodies, spheres) {
            (_, [Some(a), Some(b)]) if a != b => {
                let radius = |i: usize| rig.sample.spheres[i].radius;
                (view.position(a), radius(a) + radius(b) - contact.overlap)
            }
            ([Body::Flat(f), _], [_, Some(i)]) => {
                let apart = rig.flats[f].distance(&[0.0; D], &view.position(i)).0;
                let at = view.position(i);
                (std::array::from_fn(|k| at[k] - apart * contact.normal[k]), apart)
            }
            // Its own image, in a mirror.
            (_, [Some(i), _]) => (view.position(i), 0.0),
            _ => continue,
        };
        for k in 0..D {
            let way = reach * contact.normal[k];
            carried[k] += contact.force * contact.normal[k] * way;
            low[k] = low[k].min(from[k]).min(from[k] + way);
            high[k] = high[k].max(from[k]).max(from[k] + way);
        }
    }
    std::array::from_fn(|k| {
        let length = rig.periods[k].unwrap_or(high[k] - low[k]);
        if length > 0.0 { carried[k] / length } else { 0.0 }
    })
}
