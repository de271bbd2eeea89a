//! Many designs on one lattice at once, each in a lane of the vector registers.
//!
//! All layouts on one lattice share their contact graph, so lane k is design k, nothing is gathered, and a contact's branch
//! is taken if any design takes it. Recorded is what an optimiser asks for: each sphere's greatest kinetic energy. The
//! bits are those of [`simulate`](super::simulate), whatever the width and whichever designs stand together.

use std::any::Any;
use std::sync::atomic::{AtomicBool, Ordering};

use super::Integrator;
use super::body::Grains;
use super::clock::{Clock, Phase, Phases};
use super::contacts::{Contacts, Sweep};
use super::guard::{self, Stop};
use super::impact::{Impact, WATCH, steps_in};
use super::neighbour::{OverlapAtRest, Touching};
use super::record::{Fastest, Observer};
use super::step::{Drive, Stepper};
use super::table::LaneTable;
use crate::contact::{LaneLaw, Pair, WithLaw};
use crate::real::{Kernel, Lanes, Width};
use crate::sample::Sample;

/// What is kept of one design of a batch.
#[derive(Clone, Debug, PartialEq)]
pub struct Brief {
    /// Greatest kinetic energy of each sphere (J), over accepted steps.
    pub max_kinetic: Vec<f64>,
    /// Why the run ended early or is not to be trusted, if so. No energy ledger is kept in a batch.
    pub stop: Option<Stop>,
}

/// Samples that cannot be simulated side by side.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BatchError {
    /// Centres or radii differ from those of the first sample.
    #[error("sample {0} of the batch has other centres or radii than the first")]
    Geometry(usize),
    /// Spheres overlap before the impact.
    #[error(transparent)]
    Overlap(#[from] OverlapAtRest),
    /// A pair of materials for each of more than 16 kinds.
    #[error("the designs have more than 16 kinds of pairs of materials and radii; simulate them one by one")]
    Kinds,
}

/// Follows the same impact on samples that differ in materials only. `interrupt` is looked at now and then; when it is set
/// the runs end with what they have.
///
/// # Errors
/// See [`BatchError`]. A run that a guard stops is no error: its brief says why.
pub fn simulate_batch<const D: usize>(
    samples: &[Sample<D>],
    impact: &Impact,
    width: Width,
    interrupt: &AtomicBool,
) -> Result<Vec<Brief>, BatchError> {
    Ok(dispatch(samples, &Terms { impact, width, interrupt, timed: false })?.0)
}

/// As [`simulate_batch`], and what its parts took. Runge-Kutta's sweeps count as motion.
///
/// # Errors
/// As there.
pub fn simulate_batch_timed<const D: usize>(
    samples: &[Sample<D>],
    impact: &Impact,
    width: Width,
    interrupt: &AtomicBool,
) -> Result<(Vec<Brief>, Phases), BatchError> {
    dispatch(samples, &Terms { impact, width, interrupt, timed: true })
}

/// What all designs of a batch share.
struct Terms<'a> {
    impact: &'a Impact,
    width: Width,
    interrupt: &'a AtomicBool,
    timed: bool,
}

/// Compiled here for each dimension; see `dem::same`.
fn dispatch<const D: usize>(samples: &[Sample<D>], terms: &Terms) -> Result<(Vec<Brief>, Phases), BatchError> {
    fn in_line(samples: &[Sample<1>], terms: &Terms) -> Result<(Vec<Brief>, Phases), BatchError> {
        side_by_side(samples, terms)
    }
    fn in_plane(samples: &[Sample<2>], terms: &Terms) -> Result<(Vec<Brief>, Phases), BatchError> {
        side_by_side(samples, terms)
    }
    fn in_space(samples: &[Sample<3>], terms: &Terms) -> Result<(Vec<Brief>, Phases), BatchError> {
        side_by_side(samples, terms)
    }
    // Only what has a size can be told apart by its type: a vector of samples, copied in a millionth of the run's time.
    let samples = samples.to_vec();
    let dimension: &dyn Any = &samples;
    if let Some(samples) = dimension.downcast_ref::<Vec<Sample<1>>>() {
        in_line(samples, terms)
    } else if let Some(samples) = dimension.downcast_ref::<Vec<Sample<2>>>() {
        in_plane(samples, terms)
    } else if let Some(samples) = dimension.downcast_ref::<Vec<Sample<3>>>() {
        in_space(samples, terms)
    } else {
        const { assert!(D >= 1 && D <= 3, "there are one to three dimensions") };
        unreachable!("one of the three")
    }
}

fn side_by_side<const D: usize>(samples: &[Sample<D>], terms: &Terms) -> Result<(Vec<Brief>, Phases), BatchError> {
    let &Terms { impact, width, interrupt, timed } = terms;
    let width = if impact.integrator == Integrator::Rk4 { Width::Scalar } else { width };
    let Some(first) = samples.first() else { return Ok((Vec::new(), Phases::default())) };
    let mut clock = Clock::new(timed);
    let alike = |sample: &Sample<D>| {
        sample.spheres.len() == first.spheres.len()
            && sample.spheres.iter().zip(&first.spheres).all(|(a, b)| a.centre == b.centre && a.radius == b.radius)
    };
    if let Some(other) = samples.iter().position(|sample| !alike(sample)) {
        return Err(BatchError::Geometry(other));
    }
    let touching = Touching::find(first, &impact.mirrors)?;
    clock.lap(Phase::Preparing);
    let mut phases = clock.phases();
    let mut briefs = Vec::with_capacity(samples.len());
    for group in samples.chunks(width.lanes()) {
        let group: Vec<&Sample<D>> = group.iter().collect();
        let (of_group, spent) =
            follow(&Group { samples: &group, touching: &touching, impact, interrupt, timed }, width)?;
        briefs.extend(of_group);
        phases += spent;
    }
    Ok((briefs, phases))
}

/// As many designs as lanes, or fewer.
#[derive(Clone, Copy)]
struct Group<'a, const D: usize> {
    samples: &'a [&'a Sample<D>],
    touching: &'a Touching<D>,
    impact: &'a Impact,
    interrupt: &'a AtomicBool,
    timed: bool,
}

/// Chooses the law once for the group.
fn follow<const D: usize>(group: &Group<'_, D>, width: Width) -> Result<(Vec<Brief>, Phases), BatchError> {
    group.impact.law.choose(AtWidth { group, width })
}

/// A group whose law is still to be chosen.
struct AtWidth<'a, 'b, const D: usize> {
    group: &'a Group<'b, D>,
    width: Width,
}

impl<const D: usize> WithLaw for AtWidth<'_, '_, D> {
    type Output = Result<(Vec<Brief>, Phases), BatchError>;

    fn with<L: LaneLaw>(self, make: impl Fn(&Pair) -> L) -> Self::Output {
        self.width.run(Under { group: self.group, law: make })
    }
}

/// A group under one law.
struct Under<'a, 'b, const D: usize, F> {
    group: &'a Group<'b, D>,
    law: F,
}

impl<const D: usize, L: LaneLaw, F: Fn(&Pair) -> L> Kernel for Under<'_, '_, D, F> {
    type Output = Result<(Vec<Brief>, Phases), BatchError>;

    #[inline(always)]
    fn run<V: Lanes>(self) -> Self::Output {
        let Group { samples, touching, impact, interrupt, timed } = *self.group;
        let clock = Clock::new(timed);
        let laws = LaneTable::<L, V>::new(samples, touching, impact.constants, self.law).ok_or(BatchError::Kinds)?;
        let spheres = samples[0].spheres.len();
        let mut grains = Grains::<V, D>::at_rest(samples, &impact.mirrors);
        let mut contacts = Contacts::new(touching.clone(), &grains, laws, false);
        let mut drive = Drive::new(impact.pulse, impact.slope, &impact.struck);
        let mut stepper = Stepper::new(impact.integrator, Sweep::Accept, impact.step, spheres);
        stepper.clock = clock;
        stepper.clock.lap(Phase::Preparing);
        grains.set_moving(&impact.moving);
        let mut fastest = Fastest(vec![V::splat(0.0); spheres]);
        let mut stops: Vec<Option<Stop>> = vec![None; samples.len()];
        let steps = steps_in(impact.window, impact.step);
        while stepper.count < steps && stops.iter().any(Option::is_none) {
            for _ in 0..WATCH.min(steps - stepper.count) {
                stepper.advance(&mut grains, &mut contacts, &mut drive);
                fastest.accepted(stepper.time(), &grains);
                stepper.clock.lap(Phase::Watching);
            }
            let interrupted = interrupt.load(Ordering::Relaxed);
            for (lane, stop) in stops.iter_mut().enumerate().filter(|(_, stop)| stop.is_none()) {
                *stop = guard::check(&stepper, &grains, &contacts, lane).err();
                if stop.is_none() && interrupted {
                    *stop = Some(Stop::Interrupted { time_s: stepper.time() });
                }
            }
            stepper.clock.lap(Phase::Watching);
        }
        let brief = |(lane, stop): (usize, Option<Stop>)| {
            let energy = |i: usize| 0.5 * samples[lane].mass(i) * fastest.0[i].lane(lane);
            Brief { max_kinetic: (0..spheres).map(energy).collect(), stop }
        };
        Ok((stops.into_iter().enumerate().map(brief).collect(), stepper.clock.phases()))
    }
}
