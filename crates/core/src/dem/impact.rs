//! One impact from start to end.

use std::any::Any;
use std::sync::atomic::{AtomicBool, Ordering};

use super::body::Grains;
use super::boundary::Mirror;
use super::contacts::{Contacts, Sweep};
use super::guard::{self, RESIDUAL_LIMIT, Stop};
use super::ledger::Ledger;
use super::load::ForcePulse;
use super::neighbour::{OverlapAtRest, Touching};
use super::record::{Fastest, Felt, Observer};
use super::step::{Drive, Stepper};
use super::strangers::{Lapse, Strangers, VIGILANCE};
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

/// Steps between two looks at guards and the request to stop.
pub(super) const WATCH: u64 = 64;

/// As [`simulate`], with Coulomb's friction `coefficient` at every contact, with Mindlin's tangential spring, and spheres that turn.
/// What friction takes counts as dissipated.
///
/// # Errors
/// As there.
pub fn simulate_with_friction(
    sample: &Sample<2>,
    impact: &Impact,
    coefficient: f64,
    interrupt: &AtomicBool,
) -> Result<Record<2>, OverlapAtRest> {
    choose(sample, impact, Some(coefficient), interrupt)
}

/// Follows an impact on `sample`. Contacts between spheres that do not touch at rest are found as these come near; that none is
/// missed is proven as the run goes. `interrupt` is looked at now and then; when it is set the run ends with what it has.
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
        choose(sample, impact, None, interrupt)
    }
    fn in_plane(sample: &Sample<2>, impact: &Impact, interrupt: &AtomicBool) -> Result<Record<2>, OverlapAtRest> {
        choose(sample, impact, None, interrupt)
    }
    fn in_space(sample: &Sample<3>, impact: &Impact, interrupt: &AtomicBool) -> Result<Record<3>, OverlapAtRest> {
        choose(sample, impact, None, interrupt)
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
pub(super) fn choose<const D: usize>(
    sample: &Sample<D>,
    impact: &Impact,
    friction: Option<f64>,
    interrupt: &AtomicBool,
) -> Result<Record<D>, OverlapAtRest> {
    impact.law.choose(Followed { sample, impact, friction, interrupt })
}

/// An impact whose law is still to be chosen.
struct Followed<'a, const D: usize> {
    sample: &'a Sample<D>,
    impact: &'a Impact,
    friction: Option<f64>,
    interrupt: &'a AtomicBool,
}

impl<const D: usize> WithLaw for Followed<'_, D> {
    type Output = Result<Record<D>, OverlapAtRest>;

    fn with<L: LaneLaw>(self, make: impl Fn(&Pair) -> L + Copy + Sync) -> Self::Output {
        follow(self.sample, self.impact, (self.friction, self.interrupt), make)
    }
}

fn follow<const D: usize, L: NormalLaw + Copy + Sync>(
    sample: &Sample<D>,
    impact: &Impact,
    (friction, interrupt): (Option<f64>, &AtomicBool),
    law: impl Fn(&Pair) -> L + Copy + Sync,
) -> Result<Record<D>, OverlapAtRest> {
    let samples = [sample];
    let mut strangers = Strangers::new(&samples, &impact.mirrors);
    let touching = Touching::find(&samples, &impact.mirrors, |i, j| strangers.tell(i, j))?;
    let steps = steps_in(impact.window, impact.step);
    let mut vigilances = VIGILANCE.into_iter().peekable();
    loop {
        let Some(vigilance) = vigilances.next() else { unreachable!("the last one ends the run") };
        let laws = LawTable::new(sample, &touching, impact.constants, law);
        let mut grains = Grains::<f64, D>::at_rest(&samples, &impact.mirrors);
        let mut contacts = Contacts::new(&samples, &impact.mirrors, touching.clone(), &grains, laws, true);
        if let Some(coefficient) = friction {
            contacts = contacts.with_friction(coefficient, &grains, impact.step);
        }
        let mut drive = Drive::new(impact.pulse, impact.slope, &impact.struck);
        grains.set_moving(&impact.moving);
        for &(i, speed) in &impact.moving {
            // What moves at the start has been put in before it.
            drive.work += 0.5 * grains.mass(i) * speed * speed;
        }
        let mut stepper = Stepper::new(impact.integrator, Sweep::AcceptAndAccount, impact.step, sample.spheres.len());
        let mut felt = Felt::<D>::new(sample.spheres.len(), impact.exit.clone());
        let mut strangers = strangers.clone();
        strangers.begin(&grains, vigilance);
        let mut fastest = Fastest::new(sample.spheres.len(), strangers.size);

        let mut stop = None;
        let mut too_fast = false;
        while stepper.count < steps && stop.is_none() && !too_fast {
            let look = steps.min(stepper.count + WATCH);
            while stepper.count < look && !too_fast {
                let pause = vigilance.pause.min(look - stepper.count);
                for _ in 0..pause {
                    stepper.advance(&mut grains, &mut contacts, &mut drive);
                    felt.accepted(stepper.time(), &grains);
                    fastest.accepted(stepper.time(), &grains);
                }
                let time = pause as f64 * impact.step;
                let seen = strangers.watch(&mut fastest.of_block, time, &[true], &mut contacts, &grains);
                too_fast = matches!(seen, Err(Lapse::TooFast));
            }
            stop = guard::check(&stepper, &grains, &contacts, 0).err();
            if stop.is_none() && interrupt.load(Ordering::Relaxed) {
                stop = Some(Stop::Interrupted { time_s: stepper.time() });
            }
        }
        if too_fast && vigilances.peek().is_some() {
            continue;
        }
        if too_fast {
            stop = stop.or(Some(Stop::Leap { step_s: impact.step }));
        }
        let ledger = Ledger::close(&grains, &contacts, drive.work);
        if stop.is_none() && ledger.residual().is_some_and(|residual| residual.abs() > RESIDUAL_LIMIT) {
            stop = ledger.residual().map(|residual| Stop::Residual { residual });
        }
        let mut record = collect(sample, &grains, &contacts, &felt, &stepper);
        (record.ledger, record.stop) = (ledger, stop);
        return Ok(record);
    }
}

/// Number of steps that end within the window; one that ends within a billionth of a step of it counts.
pub fn steps_in(window: f64, step: f64) -> u64 {
    (window / step + 1e-9).floor() as u64
}

fn collect<const D: usize, L: NormalLaw + Copy + Sync>(
    sample: &Sample<D>,
    grains: &Grains<f64, D>,
    contacts: &Contacts<'_, f64, D, LawTable<'_, L>>,
    felt: &Felt<D>,
    stepper: &Stepper<f64, D>,
) -> Record<D> {
    let spheres = sample.spheres.len();
    let mut max_contact_force = vec![0.0_f64; spheres];
    let mut dissipated = vec![0.0; spheres];
    let mut records = Vec::new();
    let ever_closed = (0..contacts.history.len()).filter(|&c| contacts.history[c].overlap_max > 0.0);
    for c in ever_closed {
        let (ends, account, stored) = (contacts.spheres(c), contacts.account[c], contacts.stored(c));
        let (overlap_max, force_max) = contacts.greatest(c, 0);
        let friction = contacts.friction.as_ref().filter(|friction| c < friction.work.len());
        let rubbed = friction.map_or(0.0, |friction| friction.work[c] - friction.stored(c));
        for i in ends {
            max_contact_force[i] = max_contact_force[i].max(force_max);
            dissipated[i] += 0.5 * (account.work - stored + rubbed) * contacts.weight[c] / grains.weight[i];
        }
        records.push(ContactRecord {
            spheres: ends,
            weight: contacts.weight[c],
            overlap_max,
            force_max,
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
        stop: None,
    }
}
