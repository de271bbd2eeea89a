//! Many designs on one lattice at once, each in a lane of the vector registers.
//!
//! All layouts on one lattice share their contact graph, so lane k is design k, nothing is gathered, and a contact's branch
//! is taken if any design takes it; radii may differ from design to design, and sites be empty. Recorded is what an optimiser
//! asks for: each sphere's greatest kinetic energy. The bits are those of [`simulate`](super::simulate), whatever the width and
//! whichever designs stand together.

use super::Integrator;
use super::clock::{Clock, Phase, Phases};
use super::contacts::{Laws, Sweep};
use super::dimension::{MoveIn, Spheres};
use super::follow::{Group, Terms, follow};
use super::guard::Stop;
use super::impact::{Alone, Impact, alone, laid_in_plane};
use super::load::Strike;
use super::neighbour::OverlapAtRest;
use super::size::are_alike;
use super::table::LaneTable;
use crate::Context;
use crate::contact::{Consistent, ElastoPlastic, LaneLaw, LawKind, WithLaw};
use crate::real::{Kernel, Lanes, Width};
use crate::sample::Sample;

/// What is kept of one design of a batch.
#[derive(Clone, Debug, PartialEq)]
pub struct PeakEnergies {
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
    /// That there is one for each of so many samples, where there are limits.
    fn assert_each(limit: Option<&Self>, samples: usize) {
        assert!(limit.is_none_or(|limit| limit.most.len() >= samples), "a limit for each of {samples} samples");
    }

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
/// empty site. `context` is looked at now and then; when it is stopped the runs end with what they have. What cannot run side by
/// side (designs with more than 16 kinds of pairs of materials together) is simulated one by one.
///
/// # Errors
/// See [`BatchError`]. A run that a guard stops is no error: its result says why.
///
/// # Panics
/// Where [`Impact::faces`] are none that there may be.
pub fn simulate_batch<const D: usize>(
    samples: &[Sample<D>],
    impact: &Impact,
    width: Width,
    context: &Context,
) -> Result<Vec<PeakEnergies>, BatchError>
where
    Spheres: MoveIn<D>,
{
    Ok(Spheres::follow(samples, width, &terms(impact, context))?.0)
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
    context: &Context,
) -> Result<Vec<PeakEnergies>, BatchError>
where
    Spheres: MoveIn<D>,
{
    Limit::assert_each(Some(limit), samples.len());
    Ok(Spheres::follow(samples, width, &Terms { limit: Some(limit), ..terms(impact, context) })?.0)
}

/// As [`simulate_batch`], and what its parts took. Runge-Kutta's sweeps count as motion.
///
/// # Errors
/// As there.
pub fn simulate_batch_timed<const D: usize>(
    samples: &[Sample<D>],
    impact: &Impact,
    width: Width,
    context: &Context,
) -> Result<(Vec<PeakEnergies>, Phases), BatchError>
where
    Spheres: MoveIn<D>,
{
    Spheres::follow(samples, width, &Terms { timed: true, ..terms(impact, context) })
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
    context: &Context,
) -> Result<Vec<PeakEnergies>, BatchError> {
    Limit::assert_each(limit, samples.len());
    Ok(side_by_side(samples, width, &Terms { limit, friction: Some(coefficient), ..terms(impact, context) })?.0)
}

/// As [`simulate_batch`], with a pulse for each sample in place of the impact's own, or a projectile of one mass, with limits where there are any and friction, which is written
/// for the plane.
///
/// # Errors
/// As there.
///
/// # Panics
/// If there are fewer strikes, or limits, than samples, or pulses and projectiles among each other; friction out of the plane.
pub fn simulate_batch_under<const D: usize, S: Copy + Into<Strike>>(
    samples: &[Sample<D>],
    impact: &Impact,
    strikes: &[S],
    friction: Option<f64>,
    limit: Option<&Limit>,
    width: Width,
    context: &Context,
) -> Result<Vec<PeakEnergies>, BatchError>
where
    Spheres: MoveIn<D>,
{
    assert!(strikes.len() >= samples.len(), "a strike for each of {} samples", samples.len());
    let strikes: Vec<Strike> = strikes.iter().map(|&strike| strike.into()).collect();
    Limit::assert_each(limit, samples.len());
    assert!(friction.is_none() || D == 2, "friction is written for the plane");
    Ok(Spheres::follow(samples, width, &Terms { strikes: &strikes, limit, friction, ..terms(impact, context) })?.0)
}

fn terms<'a>(impact: &'a Impact, context: &'a Context) -> Terms<'a> {
    Terms { impact, strikes: &[], limit: None, friction: None, context, timed: false, dimension: 2 }
}

/// Designs side by side, compiled here for each dimension.
pub trait SideBySide<const D: usize> {
    /// Each under its terms.
    fn follow(samples: &[Sample<D>], width: Width, terms: &Terms) -> Followed;
}

/// What is kept of each design, and what the parts of the run took.
type Followed = Result<(Vec<PeakEnergies>, Phases), BatchError>;

impl SideBySide<1> for Spheres {
    fn follow(samples: &[Sample<1>], width: Width, terms: &Terms) -> Followed {
        let samples: Vec<Sample<2>> = samples.iter().map(laid_in_plane).collect();
        side_by_side(&samples, width, &Terms { impact: &terms.impact.in_plane(), dimension: 1, ..*terms })
    }
}

impl SideBySide<2> for Spheres {
    fn follow(samples: &[Sample<2>], width: Width, terms: &Terms) -> Followed {
        side_by_side(samples, width, terms)
    }
}

impl SideBySide<3> for Spheres {
    fn follow(samples: &[Sample<3>], width: Width, terms: &Terms) -> Followed {
        side_by_side(samples, width, &Terms { dimension: 3, ..*terms })
    }
}

fn side_by_side<const D: usize>(samples: &[Sample<D>], width: Width, terms: &Terms) -> Followed {
    let width = if terms.impact.integrator == Integrator::Rk4 { Width::Scalar } else { width };
    let Some(first) = samples.first() else { return Ok((Vec::new(), Phases::default())) };
    if let Some(other) = samples.iter().position(|sample| !have_same_centres(sample, first)) {
        return Err(BatchError::Geometry(other));
    }
    let (mut peak_energies, mut phases) = (Vec::with_capacity(samples.len()), Phases::default());
    let lanes = width.lanes();
    for (samples, start) in samples.chunks(lanes).zip((0..).step_by(lanes)) {
        // What belongs to some of the samples.
        let limits = |range: std::ops::Range<usize>| terms.limit.map(|limit| limit.of(range));
        let strikes =
            |range: std::ops::Range<usize>| if terms.strikes.len() > 1 { &terms.strikes[range] } else { terms.strikes };
        let range = start..start + samples.len();
        let limit = limits(range.clone());
        let of_group = Terms { limit: limit.as_ref(), strikes: strikes(range), ..*terms };
        if let Some((of_group, spent)) = in_lanes(samples, width, &of_group)? {
            peak_energies.extend(of_group);
            phases += spent;
            continue;
        }
        for (k, sample) in (start..).zip(samples) {
            let limit = limits(k..k + 1);
            let of_sample = Terms { limit: limit.as_ref(), strikes: strikes(k..k + 1), ..*terms };
            let Alone { peaks, phases: spent, .. } = alone(sample, &of_sample, false)?;
            peak_energies.push(peaks);
            phases += spent;
        }
    }
    Ok((peak_energies, phases))
}

fn have_same_centres<const D: usize>(a: &Sample<D>, b: &Sample<D>) -> bool {
    a.spheres.len() == b.spheres.len() && a.spheres.iter().zip(&b.spheres).all(|(a, b)| a.centre == b.centre)
}

/// As many designs as lanes, or fewer, in one run. None where they have to be simulated one by one.
fn in_lanes<const D: usize>(
    samples: &[Sample<D>],
    width: Width,
    terms: &Terms,
) -> Result<Option<(Vec<PeakEnergies>, Phases)>, OverlapAtRest> {
    if width == Width::Scalar {
        return Ok(None);
    }
    let mut clock = Clock::new(terms.timed);
    let samples: Vec<&Sample<D>> = samples.iter().collect();
    let group = Group::new(&samples, terms)?;
    clock.lap(Phase::Preparing);
    let mut phases = clock.phases();
    Ok(width.run_side_by_side(&group).flatten().map(|(peak_energies, spent)| {
        phases += spent;
        (peak_energies, phases)
    }))
}

impl<const D: usize> Kernel for &Group<'_, D> {
    type Output = Option<(Vec<PeakEnergies>, Phases)>;

    #[inline(always)]
    fn run<V: Lanes>(self) -> Self::Output {
        let law = self.terms.impact.law;
        let run = follow::<V, D, ()>(self, || law.choose(Tabulated(self)), || (), Sweep::Accept)?;
        Some((run.peak_energies(self.samples), run.phases()))
    }
}

/// As [`simulate_batch_within`], or without a limit as [`simulate_batch`], in single precision: for screening, where scores are wanted to a
/// percent at half the cost. They scatter about those of double precision as those of forces within 10⁻⁵ do, and differ from processor to
/// processor; what a decision rests on is to be simulated again. Where the processor, the law or the samples do not allow it, in double precision.
///
/// # Errors
/// As there.
///
/// # Panics
/// As there.
pub fn screen_batch(
    samples: &[Sample<2>],
    impact: &Impact,
    limit: Option<&Limit>,
    context: &Context,
) -> Result<Vec<PeakEnergies>, BatchError> {
    Limit::assert_each(limit, samples.len());
    let whole = Terms { limit, ..terms(impact, context) };
    let mut peak_energies = Vec::with_capacity(samples.len());
    for (group, start) in samples.chunks(16).zip((0..).step_by(16)) {
        let limit = limit.map(|limit| limit.of(start..start + group.len()));
        let terms = Terms { limit: limit.as_ref(), ..whole };
        let screened = if impact.integrator == Integrator::Rk4
            || !group.iter().all(|sample| have_same_centres(sample, &group[0]))
        {
            None
        } else {
            let group: Vec<&Sample<2>> = group.iter().collect();
            match are_alike(&group) {
                true => Width::run_in_single(Screen(&Group::new(&group, &terms)?)).flatten(),
                false => None,
            }
        };
        match screened {
            Some(screened) => peak_energies.extend(screened),
            None => peak_energies.extend(side_by_side(group, Width::widest(), &terms)?.0),
        }
    }
    Ok(peak_energies)
}

/// A group in single precision.
struct Screen<'a, 'b>(&'b Group<'a, 2>);

impl Kernel for Screen<'_, '_> {
    type Output = Option<Vec<PeakEnergies>>;

    #[inline(always)]
    fn run<V: Lanes>(self) -> Self::Output {
        let group = self.0;
        let table = Tabulated(group);
        let laws = || match group.terms.impact.law {
            LawKind::Thesis | LawKind::ThesisStatic => {
                WithLaw::<Option<Box<dyn Laws<V, 2>>>>::with::<ElastoPlastic>(table)
            }
            LawKind::Consistent | LawKind::ConsistentStatic => WithLaw::with::<Consistent>(table),
            _ => None,
        };
        Some(follow::<V, 2, ()>(group, laws, || (), Sweep::Accept)?.peak_energies(group.samples))
    }
}

/// The laws of a group, of which the type is still to be chosen.
#[derive(Clone, Copy)]
struct Tabulated<'a, 'b, const D: usize>(&'b Group<'a, D>);

impl<'a, V: Lanes, const D: usize> WithLaw<Option<Box<dyn Laws<V, D> + 'a>>> for Tabulated<'a, '_, D> {
    fn with<L: LaneLaw>(self) -> Option<Box<dyn Laws<V, D> + 'a>> {
        let Group { samples, terms, touching, .. } = self.0;
        let table = LaneTable::<L, V>::new(samples, touching, terms.impact.law, terms.impact.constants)?;
        Some(Box::new(table))
    }
}
