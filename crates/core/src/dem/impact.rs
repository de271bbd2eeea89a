//! One impact from start to end.

use std::any::Any;
use std::sync::atomic::{AtomicBool, Ordering};

use super::body::Grains;
use super::boundary::Mirror;
use super::contacts::{Contacts, Sweep};
use super::guard::{self, RESIDUAL_LIMIT, Stop};
use super::ledger::Ledger;
use super::load::ForcePulse;
use super::neighbour::{OverlapAtRest, Touching, nearing_strangers};
use super::record::{Felt, Observer};
use super::step::{Drive, Stepper};
use super::table::LawTable;
use super::{Integrator, same};
use crate::contact::{Constants, LaneLaw, LawKind, NormalLaw, Pair, WithLaw};
use crate::sample::Sample;

/// What hits the crystal, how it is held, and how the motion is followed.
#[derive(Clone, Debug)]
pub struct Impact {
    /// Planes of symmetry.
    pub mirrors: Vec<Mirror>,
    /// The contact law.
    pub law: LawKind,
    /// The law's set of fitted constants.
    pub constants: Constants,
    /// The load on each struck sphere.
    pub pulse: ForcePulse,
    /// The load's component along the first axis over that along the last, which is the pulse's: the tangent of the angle at
    /// which it strikes. Without effect in one dimension.
    pub slope: f64,
    /// Indices of the struck spheres.
    pub struck: Vec<usize>,
    /// Spheres that move at the start, with their speed along the last axis (m/s).
    pub moving: Vec<(usize, f64)>,
    /// Indices of the spheres whose momentum and force count as delivered.
    pub exit: Vec<usize>,
    /// The integrator.
    pub integrator: Integrator,
    /// Its step (s).
    pub step: f64,
    /// How long the motion is followed (s); maxima are taken and energies dated by it.
    pub window: f64,
}

/// What each sphere and contact felt, and where the energy went.
#[derive(Clone, Debug, PartialEq)]
pub struct Record<const D: usize> {
    /// Greatest kinetic energy of each sphere (J), over accepted steps.
    pub max_kinetic: Vec<f64>,
    /// Greatest net contact force on each sphere (N).
    pub max_net_force: Vec<f64>,
    /// Greatest force at one contact of each sphere (N).
    pub max_contact_force: Vec<f64>,
    /// When each sphere's speed first reached 1 % of its own maximum (s); none if it never moved.
    pub arrival: Vec<Option<f64>>,
    /// Half of each contact's loss to each of its spheres (J); of whole spheres also where they lie on a mirror.
    pub dissipated: Vec<f64>,
    /// Every contact that ever closed.
    pub contacts: Vec<ContactRecord>,
    /// Where the energy went.
    pub ledger: Ledger,
    /// Greatest momentum of the exit spheres along the last axis (kg m/s).
    pub exit_momentum: f64,
    /// Greatest total contact force on the exit spheres along the last axis (N).
    pub exit_force: f64,
    /// How far each sphere has moved at the end (m).
    pub displacement: Vec<[f64; D]>,
    /// Velocity of each sphere at the end (m/s).
    pub velocity: Vec<[f64; D]>,
    /// Accepted steps.
    pub steps: u64,
    /// Two spheres that do not touch at rest and may have met, and when: from there on a contact may be missing. None
    /// where it is proven that no such pair met.
    pub missed_contact: Option<([usize; 2], f64)>,
    /// Why the run ended early or is not to be trusted, if so.
    pub stop: Option<Stop>,
}

/// What a contact felt.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ContactRecord {
    /// Its spheres, indices; the same twice for a sphere and its mirror image.
    pub spheres: [usize; 2],
    /// The part of it that belongs to the simulated half.
    pub weight: f64,
    /// δ_max (m)
    pub overlap_max: f64,
    /// F_max (N)
    pub force_max: f64,
    /// ∫F dδ so far (J)
    pub work: f64,
    /// What of it the contact would give back (J).
    pub stored: f64,
}

/// Most steps between two looks at guards, strangers and the request to stop.
pub(super) const WATCH: u64 = 64;

/// Follows an impact on `sample`. `interrupt` is looked at now and then; when it is set the run ends with what it has.
///
/// # Errors
/// Spheres that overlap before the impact. A run that a guard stops is no error: its record says why and keeps what was
/// computed so far.
pub fn simulate<const D: usize>(
    sample: &Sample<D>,
    impact: &Impact,
    interrupt: &AtomicBool,
) -> Result<Record<D>, OverlapAtRest> {
    fn in_line(sample: &Sample<1>, impact: &Impact, interrupt: &AtomicBool) -> Result<Record<1>, OverlapAtRest> {
        choose(sample, impact, interrupt)
    }
    fn in_plane(sample: &Sample<2>, impact: &Impact, interrupt: &AtomicBool) -> Result<Record<2>, OverlapAtRest> {
        choose(sample, impact, interrupt)
    }
    fn in_space(sample: &Sample<3>, impact: &Impact, interrupt: &AtomicBool) -> Result<Record<3>, OverlapAtRest> {
        choose(sample, impact, interrupt)
    }
    let dimension: &dyn Any = sample;
    if let Some(sample) = dimension.downcast_ref() {
        same(in_line(sample, impact, interrupt))
    } else if let Some(sample) = dimension.downcast_ref() {
        same(in_plane(sample, impact, interrupt))
    } else if let Some(sample) = dimension.downcast_ref() {
        same(in_space(sample, impact, interrupt))
    } else {
        const { assert!(D >= 1 && D <= 3, "there are one to three dimensions") };
        unreachable!("one of the three")
    }
}

/// Chooses the law.
fn choose<const D: usize>(
    sample: &Sample<D>,
    impact: &Impact,
    interrupt: &AtomicBool,
) -> Result<Record<D>, OverlapAtRest> {
    impact.law.choose(Followed { sample, impact, interrupt })
}

/// An impact whose law is still to be chosen.
struct Followed<'a, const D: usize> {
    sample: &'a Sample<D>,
    impact: &'a Impact,
    interrupt: &'a AtomicBool,
}

impl<const D: usize> WithLaw for Followed<'_, D> {
    type Output = Result<Record<D>, OverlapAtRest>;

    fn with<L: LaneLaw>(self, make: impl Fn(&Pair) -> L) -> Self::Output {
        follow(self.sample, self.impact, self.interrupt, make)
    }
}

fn follow<const D: usize, L: NormalLaw + Copy + Sync>(
    sample: &Sample<D>,
    impact: &Impact,
    interrupt: &AtomicBool,
    law: impl Fn(&Pair) -> L,
) -> Result<Record<D>, OverlapAtRest> {
    let touching = Touching::find(sample, &impact.mirrors)?;
    let laws = LawTable::new(sample, &touching, impact.constants, law);
    let mut grains = Grains::<f64, D>::at_rest(&[sample], &impact.mirrors);
    let mut contacts = Contacts::new(touching, &grains, laws, true);
    let mut drive = Drive::new(impact.pulse, impact.slope, &impact.struck);
    grains.set_moving(&impact.moving);
    for &(i, speed) in &impact.moving {
        // What moves at the start has been put in before it.
        drive.work += 0.5 * grains.weight[i] / grains.inverse_mass[i] * speed * speed;
    }
    let mut stepper = Stepper::new(impact.integrator, Sweep::AcceptAndAccount, impact.step, sample.spheres.len());
    let mut felt = Felt::<D>::new(sample.spheres.len(), impact.exit.clone());

    let steps = steps_in(impact.window, impact.step);
    let mut stop = None;
    let mut missed_contact = None;
    let least_radius = sample.spheres.iter().map(|s| s.radius).fold(f64::INFINITY, f64::min);
    while stepper.count < steps && stop.is_none() {
        let pause = steps_until_next_look(&grains, impact.step, least_radius);
        for _ in 0..pause.min(steps - stepper.count) {
            stepper.advance(&mut grains, &mut contacts, &mut drive);
            felt.accepted(stepper.time(), &grains);
        }
        stop = guard::check(&stepper, &grains, &contacts, 0).err();
        if missed_contact.is_none() {
            let ahead = steps_until_next_look(&grains, impact.step, least_radius) as f64 * impact.step;
            let margin = 4.0 * fastest(&grains) * ahead;
            missed_contact = nearing(sample, impact, &grains, &contacts, margin).map(|pair| (pair, stepper.time()));
        }
        if stop.is_none() && interrupt.load(Ordering::Relaxed) {
            stop = Some(Stop::Interrupted { time_s: stepper.time() });
        }
    }
    let ledger = Ledger::close(&grains, &contacts, drive.work);
    if stop.is_none() && ledger.residual().is_some_and(|residual| residual.abs() > RESIDUAL_LIMIT) {
        stop = ledger.residual().map(|residual| Stop::Residual { residual });
    }
    let mut record = collect(sample, &grains, &contacts, &felt, &stepper);
    (record.ledger, record.missed_contact, record.stop) = (ledger, missed_contact, stop);
    Ok(record)
}

/// Number of steps that end within the window; one that ends within a billionth of a step of it counts.
pub fn steps_in(window: f64, step: f64) -> u64 {
    (window / step + 1e-9).floor() as u64
}

/// Greatest speed (m/s).
fn fastest<const D: usize>(grains: &Grains<f64, D>) -> f64 {
    (0..grains.reached).map(|i| grains.speed_squared(i)).fold(0.0, f64::max).sqrt()
}

/// Steps in which no two spheres come nearer by more than a small part of a radius: both may run towards each other, and
/// be pushed to twice today's greatest speed.
fn steps_until_next_look<const D: usize>(grains: &Grains<f64, D>, step: f64, least_radius: f64) -> u64 {
    let travel = 4.0 * fastest(grains) * step;
    if travel > 0.0 { ((0.6 * least_radius / travel) as u64).clamp(1, WATCH) } else { WATCH }
}

/// Two spheres, no contact of the packing at rest, whose surfaces are nearer than `margin` (m).
fn nearing<const D: usize, L: NormalLaw + Copy + Sync>(
    sample: &Sample<D>,
    impact: &Impact,
    grains: &Grains<f64, D>,
    contacts: &Contacts<f64, D, LawTable<L>>,
    margin: f64,
) -> Option<[usize; 2]> {
    let centres: Vec<[f64; D]> = sample
        .spheres
        .iter()
        .zip(&grains.displacement)
        .map(|(sphere, moved)| std::array::from_fn(|k| sphere.centre[k] + moved[k]))
        .collect();
    nearing_strangers(sample, &impact.mirrors, &centres, |i, j| contacts.holds(i, j), margin)
}

fn collect<const D: usize, L: NormalLaw + Copy + Sync>(
    sample: &Sample<D>,
    grains: &Grains<f64, D>,
    contacts: &Contacts<f64, D, LawTable<L>>,
    felt: &Felt<D>,
    stepper: &Stepper<f64, D>,
) -> Record<D> {
    let spheres = sample.spheres.len();
    let mut max_contact_force = vec![0.0_f64; spheres];
    let mut dissipated = vec![0.0; spheres];
    let mut records = Vec::new();
    let ever_closed = (0..contacts.history.len()).filter(|&c| contacts.history[c].overlap_max > 0.0);
    for c in ever_closed {
        let (ends, history, account) = (contacts.spheres(c), contacts.history[c], contacts.account[c]);
        let stored = contacts.laws.of(c).stored(account.overlap, &history);
        for i in ends {
            max_contact_force[i] = max_contact_force[i].max(history.force_max);
            dissipated[i] += 0.5 * (account.work - stored) * contacts.weight[c] / grains.weight[i];
        }
        records.push(ContactRecord {
            spheres: ends,
            weight: contacts.weight[c],
            overlap_max: history.overlap_max,
            force_max: history.force_max,
            work: account.work,
            stored,
        });
    }
    let mass = |i: usize| sample.mass(i);
    Record {
        max_kinetic: (0..spheres).map(|i| 0.5 * mass(i) * felt.speed_squared[i]).collect(),
        max_net_force: (0..spheres).map(|i| mass(i) * felt.acceleration_squared[i].sqrt()).collect(),
        max_contact_force,
        arrival: felt.arrivals(stepper.step),
        dissipated,
        contacts: records,
        ledger: Ledger::default(),
        exit_momentum: felt.exit_momentum,
        exit_force: felt.exit_force,
        displacement: grains.displacement.clone(),
        velocity: grains.velocity.clone(),
        steps: stepper.count,
        missed_contact: None,
        stop: None,
    }
}
