//! Many designs on one lattice at once, each in a lane of the vector registers.
//!
//! All layouts on one lattice share their contact graph, so lane k is design k, nothing is gathered, and a contact's branch
//! is taken if any design takes it; radii may differ from design to design, and sites be empty. Recorded is what an optimiser
//! asks for: each sphere's greatest kinetic energy. The bits are those of [`simulate`](super::simulate), whatever the width and
//! whichever designs stand together.

use std::any::Any;
use std::sync::atomic::{AtomicBool, Ordering};

use super::Integrator;
use super::body::Grains;
use super::clock::{Clock, Phase, Phases};
use super::contacts::{Contacts, Sweep};
use super::guard::{self, Stop};
use super::impact::{Impact, WATCH, choose, steps_in};
use super::neighbour::{OverlapAtRest, Touching};
use super::record::{Fastest, Observer};
use super::step::{Drive, Stepper};
use super::strangers::{Lapse, Strangers, VIGILANCE};
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

/// What ends the run of a design before its window does: that Σ w E over some spheres, E the greatest kinetic energy so far, has
/// come above a limit. Maxima only grow, so the whole run would have ended above it too: a bound, not a guess.
#[derive(Clone, Debug, PartialEq)]
pub struct Limit {
    /// Indices and w, which is not negative.
    pub spheres: Vec<(usize, f64)>,
    /// For each sample the greatest sum that is of interest (J).
    pub most: Vec<f64>,
}

impl Limit {
    /// The part for some of the samples.
    fn of(&self, samples: std::ops::Range<usize>) -> Self {
        Self { spheres: self.spheres.clone(), most: self.most[samples].to_vec() }
    }
}

/// Samples that cannot be simulated side by side.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum BatchError {
    /// Centres differ from those of the first sample.
    #[error("sample {0} of the batch has other centres than the first; simulate it alone")]
    Geometry(usize),
    /// Spheres overlap before the impact.
    #[error(transparent)]
    Overlap(#[from] OverlapAtRest),
}

/// Follows the same impact on samples with the same centres, which may differ in materials and radii; a radius of zero is an
/// empty site. `interrupt` is looked at now and then; when it is set the runs end with what they have. What cannot run side by
/// side (designs with more than 16 kinds of pairs of materials together) is simulated one by one.
///
/// # Errors
/// See [`BatchError`]. A run that a guard stops is no error: its brief says why.
pub fn simulate_batch<const D: usize>(
    samples: &[Sample<D>],
    impact: &Impact,
    width: Width,
    interrupt: &AtomicBool,
) -> Result<Vec<Brief>, BatchError> {
    Ok(dispatch(samples, &Terms { impact, width, interrupt, limit: None, friction: None, timed: false })?.0)
}

/// As [`simulate_batch`], where a run ends with [`Stop::Beyond`] once it is above its limit; what it says up to then are lower
/// bounds. The rest of the batch goes on, and its bits are those of runs without limits.
///
/// # Errors
/// As there.
///
/// # Panics
/// If there are fewer limits than samples.
pub fn simulate_batch_within<const D: usize>(
    samples: &[Sample<D>],
    impact: &Impact,
    limit: &Limit,
    width: Width,
    interrupt: &AtomicBool,
) -> Result<Vec<Brief>, BatchError> {
    assert!(limit.most.len() >= samples.len(), "a limit for each of {} samples", samples.len());
    Ok(dispatch(samples, &Terms { impact, width, interrupt, limit: Some(limit), friction: None, timed: false })?.0)
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
    dispatch(samples, &Terms { impact, width, interrupt, limit: None, friction: None, timed: true })
}

/// As [`simulate_batch`], with Coulomb's friction; see [`simulate_with_friction`](super::simulate_with_friction). A limit ends runs as in
/// [`simulate_batch_within`].
///
/// # Errors
/// As there.
///
/// # Panics
/// As there.
pub fn simulate_batch_with_friction(
    samples: &[Sample<2>],
    impact: &Impact,
    coefficient: f64,
    limit: Option<&Limit>,
    width: Width,
    interrupt: &AtomicBool,
) -> Result<Vec<Brief>, BatchError> {
    assert!(
        limit.is_none_or(|limit| limit.most.len() >= samples.len()),
        "a limit for each of {} samples",
        samples.len()
    );
    Ok(side_by_side(samples, &Terms { impact, width, interrupt, limit, friction: Some(coefficient), timed: false })?.0)
}

/// What all designs of a batch share.
struct Terms<'a> {
    impact: &'a Impact,
    width: Width,
    interrupt: &'a AtomicBool,
    limit: Option<&'a Limit>,
    friction: Option<f64>,
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
    let &Terms { impact, width, interrupt, limit, friction, timed } = terms;
    let width = if impact.integrator == Integrator::Rk4 { Width::Scalar } else { width };
    let Some(first) = samples.first() else { return Ok((Vec::new(), Phases::default())) };
    let mut clock = Clock::new(timed);
    let alike = |sample: &Sample<D>| {
        sample.spheres.len() == first.spheres.len()
            && sample.spheres.iter().zip(&first.spheres).all(|(a, b)| a.centre == b.centre)
    };
    if let Some(other) = samples.iter().position(|sample| !alike(sample)) {
        return Err(BatchError::Geometry(other));
    }
    clock.lap(Phase::Preparing);
    let mut phases = clock.phases();
    let mut together = |samples: &[Sample<D>], limit: Option<&Limit>, width: Width| {
        let mut clock = Clock::new(timed);
        let samples: Vec<&Sample<D>> = samples.iter().collect();
        let mut strangers = Strangers::new(&samples, &impact.mirrors);
        let touching = Touching::find(&samples, &impact.mirrors, |i, j| strangers.tell(i, j))?;
        clock.lap(Phase::Preparing);
        phases += clock.phases();
        let group = Group {
            samples: &samples,
            touching: &touching,
            strangers: &strangers,
            impact,
            interrupt,
            limit,
            friction,
            timed,
        };
        Ok::<_, BatchError>(follow(&group, width).map(|(briefs, spent)| {
            phases += spent;
            briefs
        }))
    };
    let mut briefs = Vec::with_capacity(samples.len());
    let lanes = width.lanes();
    for (group, start) in samples.chunks(lanes).zip((0..).step_by(lanes)) {
        let limit = limit.map(|limit| limit.of(start..start + group.len()));
        if let Some(of_group) = together(group, limit.as_ref(), width)? {
            briefs.extend(of_group);
            continue;
        }
        for (k, sample) in group.iter().enumerate() {
            let limit = limit.as_ref().map(|limit| limit.of(k..k + 1));
            let alone = together(std::slice::from_ref(sample), limit.as_ref(), Width::Scalar)?;
            briefs.push(match alone.and_then(|briefs| briefs.into_iter().next()) {
                Some(brief) => brief,
                None => {
                    let record = choose(sample, impact, friction, interrupt)?;
                    let stop = record.stop.filter(|stop| !matches!(stop, Stop::Residual { .. }));
                    Brief { max_kinetic: record.max_kinetic, stop }
                }
            });
        }
    }
    Ok((briefs, phases))
}

/// As many designs as lanes, or fewer.
#[derive(Clone, Copy)]
struct Group<'a, const D: usize> {
    samples: &'a [&'a Sample<D>],
    touching: &'a Touching<D>,
    strangers: &'a Strangers<D>,
    impact: &'a Impact,
    interrupt: &'a AtomicBool,
    limit: Option<&'a Limit>,
    friction: Option<f64>,
    timed: bool,
}

/// Chooses the law once for the group. None where its designs have to be simulated one by one.
fn follow<const D: usize>(group: &Group<'_, D>, width: Width) -> Option<(Vec<Brief>, Phases)> {
    group.impact.law.choose(AtWidth { group, width })
}

/// A group whose law is still to be chosen.
struct AtWidth<'a, 'b, const D: usize> {
    group: &'a Group<'b, D>,
    width: Width,
}

impl<const D: usize> WithLaw for AtWidth<'_, '_, D> {
    type Output = Option<(Vec<Brief>, Phases)>;

    fn with<L: LaneLaw>(self, make: impl Fn(&Pair) -> L + Copy + Sync) -> Self::Output {
        self.width.run(Under { group: self.group, law: make })
    }
}

/// A group under one law.
struct Under<'a, 'b, const D: usize, F> {
    group: &'a Group<'b, D>,
    law: F,
}

impl<const D: usize, L: LaneLaw, F: Fn(&Pair) -> L + Copy + Sync> Kernel for Under<'_, '_, D, F> {
    type Output = Option<(Vec<Brief>, Phases)>;

    #[inline(always)]
    fn run<V: Lanes>(self) -> Self::Output {
        let Group { samples, touching, strangers, impact, interrupt, limit, friction, timed } = *self.group;
        let spheres = samples[0].spheres.len();
        let steps = steps_in(impact.window, impact.step);
        let mut clock = Clock::new(timed);
        'attempts: for vigilance in VIGILANCE {
            let laws = LaneTable::<L, V>::new(samples, touching, impact.constants, self.law)?;
            let mut grains = Grains::<V, D>::at_rest(samples, &impact.mirrors);
            let mut contacts = Contacts::new(samples, &impact.mirrors, touching.clone(), &grains, laws, false);
            if let Some(coefficient) = friction {
                contacts = contacts.with_friction(coefficient, &grains, impact.step);
            }
            let mut drive = Drive::new(impact.pulse, impact.slope, &impact.struck);
            let mut stepper = Stepper::new(impact.integrator, Sweep::Accept, impact.step, spheres);
            stepper.clock = clock;
            stepper.clock.lap(Phase::Preparing);
            grains.set_moving(&impact.moving);
            let mut strangers = strangers.clone();
            strangers.begin(&grains, vigilance);
            let mut fastest = Fastest::new(spheres, strangers.size);
            let mut stops: Vec<Option<Stop>> = vec![None; samples.len()];
            let mut goes_on = vec![true; samples.len()];
            // A design that has been stopped is carried along; what it felt until then is kept.
            let mut ended: Vec<Option<Vec<f64>>> = vec![None; samples.len()];
            let energies = |fastest: &Fastest<V>, lane: usize| -> Vec<f64> {
                (0..spheres).map(|i| 0.5 * samples[lane].mass(i) * fastest.of_sphere[i].lane(lane)).collect()
            };
            while stepper.count < steps && goes_on.contains(&true) {
                let look = steps.min(stepper.count + WATCH);
                while stepper.count < look {
                    let pause = vigilance.pause.min(look - stepper.count);
                    for _ in 0..pause {
                        stepper.advance(&mut grains, &mut contacts, &mut drive);
                        fastest.accepted(stepper.time(), &grains);
                        stepper.clock.lap(Phase::Watching);
                    }
                    let time = pause as f64 * impact.step;
                    match strangers.watch(&mut fastest.of_block, time, &goes_on, &mut contacts, &grains) {
                        Ok(()) => {}
                        Err(Lapse::TooFast) => {
                            clock = stepper.clock;
                            continue 'attempts;
                        }
                        Err(Lapse::NoRoom) => return None,
                    }
                    stepper.clock.lap(Phase::Watching);
                }
                let interrupted = interrupt.load(Ordering::Relaxed);
                for (lane, stop) in stops.iter_mut().enumerate().filter(|(_, stop)| stop.is_none()) {
                    *stop = guard::check(&stepper, &grains, &contacts, lane).err();
                    if stop.is_none() && interrupted {
                        *stop = Some(Stop::Interrupted { time_s: stepper.time() });
                    }
                    if let Some(limit) = limit.filter(|_| stop.is_none() && stepper.count < steps) {
                        let energy = |i: usize| 0.5 * samples[lane].mass(i) * fastest.of_sphere[i].lane(lane);
                        if limit.spheres.iter().map(|&(i, weight)| weight * energy(i)).sum::<f64>() > limit.most[lane] {
                            *stop = Some(Stop::Beyond { time_s: stepper.time() });
                        }
                    }
                    goes_on[lane] = stop.is_none();
                    ended[lane] = stop.as_ref().map(|_| energies(&fastest, lane));
                }
                stepper.clock.lap(Phase::Watching);
            }
            let brief = |(lane, (stop, ended)): (usize, (Option<Stop>, Option<Vec<f64>>))| Brief {
                max_kinetic: ended.unwrap_or_else(|| energies(&fastest, lane)),
                stop,
            };
            let briefs = stops.into_iter().zip(ended).enumerate().map(brief).collect();
            return Some((briefs, stepper.clock.phases()));
        }
        None
    }
}
