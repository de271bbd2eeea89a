//! One impact from start to end.

use super::batch::PeakEnergies;
use super::body::Grains;
use super::boundary::{Face, Mirror, Period};
use super::clock::Phases;
use super::contacts::Sweep;
use super::dimension::{MoveIn, Spheres};
use super::follow::{Group, Run, Terms, follow};
use super::guard::{RESIDUAL_LIMIT, Stop};
use super::ledger::Ledger;
use super::list::List;
use super::load::{ForcePulse, Projectile, Strike};
use super::neighbour::OverlapAtRest;
use super::plate::Plate;
use super::record::Peaks;
use super::table::LawTable;
use super::{Integrator, bulk};
use crate::Context;
use crate::contact::{Constants, LawKind};
use crate::sample::{Sample, Sphere};

/// What hits the crystal, how it is held, and how the motion is followed.
#[derive(Clone, Debug)]
pub struct Impact {
    /// Planes of symmetry, and smooth walls, across an axis.
    pub mirrors: Vec<Mirror>,
    /// Such planes across none, and round walls: in space alone, 32 with the mirrors at most, and under what strikes along the last axis. What follows an impact
    /// panics where they are others, where two planes meet at an angle that is no whole part of 180 degrees, or a plane is aslant to two others on which a sphere lies too.
    pub faces: Vec<Face>,
    /// Along which axes the crystal repeats itself, where it has no end.
    pub periods: Vec<Period>,
    /// The contact law.
    pub law: LawKind,
    /// The law's set of fitted constants.
    pub constants: Constants,
    /// The load on each struck sphere.
    pub pulse: ForcePulse,
    /// What strikes the struck spheres, those of the first layer, in place of the pulse, where it is a flat.
    pub projectile: Option<Projectile>,
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
    /// How far the projectile has moved at the end (m), and its velocity (m/s).
    pub projectile: Option<[f64; 2]>,
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

/// As [`simulate`], with Coulomb's friction `coefficient` at every contact, with Mindlin's tangential spring, and spheres that turn.
/// What friction takes counts as dissipated.
///
/// # Errors
/// As there.
///
/// # Panics
/// As there.
pub fn simulate_with_friction(
    sample: &Sample<2>,
    impact: &Impact,
    coefficient: f64,
    context: &Context,
) -> Result<Record<2>, OverlapAtRest> {
    recorded(sample, &Terms { friction: Some(coefficient), ..terms(impact, context, 2) })
}

/// Follows an impact on `sample`; a large crystal in space (of [`MANY`](bulk::MANY) spheres) by its rows, on the threads of the current pool and
/// to the same bits for any number of them. Contacts between spheres that do not touch at rest are found as these come near; that none is
/// missed is proven as the run goes. `context` is looked at now and then; when it is stopped the run ends with what it has.
///
/// # Errors
/// Spheres that overlap before the impact. A run that a guard stops is no error: its record says why and keeps what was
/// computed so far.
///
/// # Panics
/// Where [`Impact::faces`] are none that there may be.
pub fn simulate<const D: usize>(
    sample: &Sample<D>,
    impact: &Impact,
    context: &Context,
) -> Result<Record<D>, OverlapAtRest>
where
    Spheres: MoveIn<D>,
{
    Spheres::simulate(sample, impact, context)
}

/// [`simulate`], compiled here for each dimension.
pub trait Struck<const D: usize> {
    /// As there.
    fn simulate(sample: &Sample<D>, impact: &Impact, context: &Context) -> Result<Record<D>, OverlapAtRest>;
}

impl Struck<1> for Spheres {
    fn simulate(sample: &Sample<1>, impact: &Impact, context: &Context) -> Result<Record<1>, OverlapAtRest> {
        recorded(&laid_in_plane(sample), &terms(&impact.in_plane(), context, 1)).map(Record::in_line)
    }
}

impl Struck<2> for Spheres {
    fn simulate(sample: &Sample<2>, impact: &Impact, context: &Context) -> Result<Record<2>, OverlapAtRest> {
        recorded(sample, &terms(impact, context, 2))
    }
}

impl Struck<3> for Spheres {
    fn simulate(sample: &Sample<3>, impact: &Impact, context: &Context) -> Result<Record<3>, OverlapAtRest> {
        let by_rows = if sample.spheres.len() < bulk::MANY || impact.projectile.is_some() || !impact.faces.is_empty() {
            None
        } else {
            bulk::recorded(sample, impact, context)
        };
        by_rows.map_or_else(|| recorded(sample, &terms(impact, context, 3)), Ok)
    }
}

fn terms<'a>(impact: &'a Impact, context: &'a Context, dimension: usize) -> Terms<'a> {
    Terms { impact, strikes: &[], limit: None, friction: None, context, timed: false, dimension }
}

/// A line of spheres along the second axis of the plane. Nothing ever acts across it, so that it moves as the line, to the bit, and need
/// not be compiled for itself.
pub(super) fn laid_in_plane(sample: &Sample<1>) -> Sample<2> {
    let of = |sphere: &Sphere<1>| Sphere {
        centre: [0.0, sphere.centre[0]],
        radius: sphere.radius,
        material: sphere.material,
    };
    Sample { materials: sample.materials.clone(), spheres: sample.spheres.iter().map(of).collect() }
}

impl Impact {
    /// What strikes.
    pub fn strike(&self) -> Strike {
        self.projectile.map_or(Strike::Pulse(self.pulse), Strike::Projectile)
    }

    /// With something else that strikes.
    #[must_use]
    pub fn struck_by(self, strike: Strike) -> Self {
        match strike {
            Strike::Pulse(pulse) => Self { pulse, projectile: None, ..self },
            Strike::Projectile(_) => Self { projectile: strike.projectile(), ..self },
        }
    }

    /// The impact on a line that lies along the second axis of the plane.
    pub(super) fn in_plane(&self) -> Self {
        let mirrors = self.mirrors.iter().map(|mirror| Mirror { axis: mirror.axis + 1, ..*mirror }).collect();
        let periods = self.periods.iter().map(|period| Period { axis: period.axis + 1, ..*period }).collect();
        Self { mirrors, periods, slope: 0.0, ..self.clone() }
    }
}

impl Record<2> {
    /// The record of a line that lay along the second axis.
    fn in_line(self) -> Record<1> {
        let along = |rows: Vec<[f64; 2]>| rows.into_iter().map(|[_, z]| [z]).collect();
        Record {
            max_kinetic: self.max_kinetic,
            max_net_force: self.max_net_force,
            max_contact_force: self.max_contact_force,
            arrival: self.arrival,
            dissipated: self.dissipated,
            contacts: self.contacts,
            ledger: self.ledger,
            exit_momentum: self.exit_momentum,
            exit_force: self.exit_force,
            projectile: self.projectile,
            displacement: along(self.displacement),
            velocity: along(self.velocity),
            steps: self.steps,
            stop: self.stop,
        }
    }
}

fn recorded<const D: usize>(sample: &Sample<D>, terms: &Terms) -> Result<Record<D>, OverlapAtRest> {
    let Alone { record, .. } = alone(sample, terms, true)?;
    Ok(record.expect("a record was asked for"))
}

/// What a run of one design comes to.
pub(super) struct Alone<const D: usize> {
    pub peaks: PeakEnergies,
    pub phases: Phases,
    record: Option<Record<D>>,
}

/// Follows one design, in scalars and under any law, with a record or without.
pub(super) fn alone<const D: usize>(
    sample: &Sample<D>,
    terms: &Terms,
    records: bool,
) -> Result<Alone<D>, OverlapAtRest> {
    let mut outcome = None;
    followed(sample, terms, records, &mut |run| {
        let peaks = run.peak_energies(&[sample]).remove(0);
        outcome = Some(Alone { peaks, phases: run.phases(), record: records.then(|| record(sample, run)) });
    })?;
    Ok(outcome.expect("a run that was followed has been looked at"))
}

/// A run of one design that has ended, with what was felt in it where that was asked for.
type Ended<'a, const D: usize> = Run<'a, f64, D, Option<Peaks<D>>>;

/// A run of one design, to be looked at once it has ended. All such runs are compiled here.
fn followed<const D: usize>(
    sample: &Sample<D>,
    terms: &Terms,
    records: bool,
    look: &mut dyn FnMut(&Ended<'_, D>),
) -> Result<(), OverlapAtRest> {
    let samples = [sample];
    let group = Group::new(&samples, terms)?;
    let impact = terms.impact;
    let run = follow(
        &group,
        || Some(Box::new(LawTable::new(sample, &group.touching, impact.law, impact.constants))),
        || records.then(|| Peaks::<D>::new(sample.spheres.len(), impact.exit.clone())),
        if records { Sweep::AcceptAndAccount } else { Sweep::Accept },
    )
    .expect("a table for one design has room for every law, and its last attempt ends");
    look(&run);
    Ok(())
}

/// Every contact that comes up in a run, with friction or without, in order, with the spheres that they are between, and why the run ended early.
pub(super) fn contacts_found(
    sample: &Sample<2>,
    impact: &Impact,
    friction: Option<f64>,
    context: &Context,
) -> Result<(List<2>, Grains<f64, 2>, Option<Stop>), OverlapAtRest> {
    let mut found = None;
    followed(sample, &Terms { friction, ..terms(impact, context, 2) }, false, &mut |run| {
        found = Some((run.contacts.list.clone(), run.grains.clone(), run.stops[0].clone()));
    })?;
    Ok(found.expect("a run that was followed has been looked at"))
}

fn record<const D: usize>(sample: &Sample<D>, run: &Ended<'_, D>) -> Record<D> {
    let ledger = Ledger::close(&run.grains, &run.contacts, &*run.laws, run.work);
    let mut stop = run.stops[0].clone();
    if stop.is_none() && ledger.residual().is_some_and(|residual| residual.abs() > RESIDUAL_LIMIT) {
        stop = ledger.residual().map(|residual| Stop::Residual { residual });
    }
    Record { ledger, stop, ..collect(sample, run) }
}

/// Number of steps that end within the window; one that ends within a billionth of a step of it counts.
pub fn steps_in(window: f64, step: f64) -> u64 {
    (window / step + 1e-9).floor() as u64
}

fn collect<const D: usize>(sample: &Sample<D>, run: &Ended<'_, D>) -> Record<D> {
    let Run { grains, contacts, laws, stepper, observer, .. } = run;
    let peaks = observer.as_ref().expect("what is recorded was felt");
    let spheres = sample.spheres.len();
    let mut max_contact_force = vec![0.0_f64; spheres];
    let mut dissipated = vec![0.0; spheres];
    let mut records = Vec::new();
    let ever_closed = (0..contacts.history.len()).filter(|&c| contacts.history[c].overlap_max > 0.0);
    for c in ever_closed {
        let (ends, account, stored) = (contacts.list.spheres(c), contacts.account[c], contacts.stored(&**laws, c));
        let (overlap_max, force_max) = contacts.greatest(c, 0);
        let friction = contacts.friction.as_ref().filter(|friction| c < friction.work.len());
        let rubbed = friction.map_or(0.0, |friction| friction.work[c] - friction.stored(c));
        for i in ends {
            max_contact_force[i] = max_contact_force[i].max(force_max);
            dissipated[i] += 0.5 * (account.work - stored + rubbed) * contacts.list.weight[c] / grains.weight[i];
        }
        records.push(ContactRecord {
            spheres: ends,
            weight: contacts.list.weight[c],
            overlap_max,
            force_max,
            work: account.work,
            stored,
        });
    }
    let mass = |i: usize| sample.mass(i);
    Record {
        max_kinetic: (0..spheres).map(|i| 0.5 * mass(i) * peaks.speed_squared[i]).collect(),
        max_net_force: (0..spheres).map(|i| mass(i) * peaks.acceleration_squared[i].sqrt()).collect(),
        max_contact_force,
        arrival: peaks.arrivals(stepper.step),
        dissipated,
        contacts: records,
        ledger: Ledger::default(),
        exit_momentum: peaks.exit_momentum,
        exit_force: peaks.exit_force,
        projectile: contacts.plate.as_ref().map(Plate::state),
        displacement: grains.displacement.clone(),
        velocity: grains.velocity.clone(),
        steps: stepper.count,
        stop: None,
    }
}
