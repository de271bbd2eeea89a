//! A rig from start to end: steps, guards, what can be looked at on the way.

use std::any::Any;
use std::sync::atomic::{AtomicBool, Ordering};

use super::checkpoint::{CheckpointError, State, digest};
use super::cluster::ClusterState;
use super::contacts::Strain;
use super::engine::Engine;
use super::felt::{Arrival, Felt};
use super::law::{ByDashpot, ByMaterial};
use super::ledger::EnergyLedger;
use super::machine::Machine;
use super::pairs::{Finder, TOUCHING};
use super::{Body, LawBook, LoadKind, Rig};
use crate::dem::{ContactRecord, same, stable_step};

/// A rig in motion.
pub struct Simulation<const D: usize> {
    rig: Rig<D>,
    step: f64,
    engine: Box<dyn Engine<D>>,
    felt: Option<Felt>,
}

/// A rig that cannot be set in motion.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RigError {
    /// Two bodies overlap before anything happens, and the rig is not said to be squeezed.
    #[error("{} and {} overlap by {overlap:.3e} m before the impact", .bodies[0], .bodies[1])]
    Overlap {
        /// The two.
        bodies: [Body; 2],
        /// By how much (m).
        overlap: f64,
    },
    /// A period within which a sphere would meet two images of another.
    #[error("a period of {period:.3e} m is too short; these spheres need {least:.3e} m")]
    Period {
        /// The period (m).
        period: f64,
        /// What it must be at least (m).
        least: f64,
    },
    /// An array of the rig has not one entry per sphere.
    #[error("{0} has not one entry per sphere")]
    Shape(&'static str),
    /// A number of the rig is not finite, or not positive where it must be.
    #[error("{what} of {body} is {value}, which cannot be simulated")]
    Value {
        /// What it is.
        what: &'static str,
        /// Whose.
        body: Body,
        /// Its value.
        value: f64,
    },
    /// A load or bar names a body that is not there.
    #[error("a load or bar acts on {body}, and there are only {count}")]
    Missing {
        /// The body.
        body: Body,
        /// How many of its kind there are.
        count: usize,
    },
    /// The step is not positive, or too large for the contacts present at the start.
    #[error("a step of {step:.3e} s cannot be used; it must be positive and below {limit:.3e} s")]
    Step {
        /// The step (s).
        step: f64,
        /// What it must stay below (s).
        limit: f64,
    },
    /// A member of a cluster that does not exist, belongs to two, is held, moved or loaded by itself; or a cluster that makes no sense.
    #[error("cluster {0} cannot be simulated: {1}")]
    Cluster(usize, &'static str),
    /// Friction in space between mirrors, on which spheres could spin about one axis only.
    #[error("friction in space does not go with mirrors; simulate the whole crystal")]
    MirroredFriction,
    /// A body is fixed to a bar and has its velocity prescribed.
    #[error("{0} is fixed to a bar, so that its velocity cannot be prescribed")]
    Bound(Body),
}

/// Why a run ended before it was asked to. What was computed so far is kept.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RigStop {
    /// The caller asked for it.
    #[error("interrupted at {time:.4e} s")]
    Interrupted {
        /// Time (s).
        time: f64,
    },
    /// A velocity is not a number any more.
    #[error("the velocity of {body} is not finite at {time:.4e} s; try a smaller step")]
    NotFinite {
        /// Whose.
        body: Body,
        /// Time (s).
        time: f64,
    },
    /// An overlap beyond the law's range.
    #[error(
        "{} and {} overlap by {:.1} % of their radii at {time:.4e} s, beyond the contact law's range of {:.1} %; the impact \
         is too strong for these spheres", .bodies[0], .bodies[1], 100.0 * ratio, 100.0 * limit
    )]
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
    #[error(
        "a step of {step:.3e} s is unstable with the contact of {} and {} ({stiffness:.3e} N/m) at {time:.4e} s; it must \
         stay below {limit:.3e} s", .bodies[0], .bodies[1]
    )]
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
    /// Energy appeared or vanished.
    #[error(
        "the energy ledger does not close at {time:.4e} s: residual {residual:.2e} of what was put in, above {limit:.0e}; try \
         half the step"
    )]
    Residual {
        /// What is left over, relative.
        residual: f64,
        /// What it may be.
        limit: f64,
        /// Time (s).
        time: f64,
    },
    /// A sphere has left the domain.
    #[error("{body} leaves the domain at {time:.4e} s; widen the domain or hold it")]
    Escaped {
        /// Which.
        body: Body,
        /// Time (s).
        time: f64,
    },
}

/// State of a flat.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlatState<const D: usize> {
    /// From where it was at the start (m).
    pub moved: [f64; D],
    /// Velocity (m/s).
    pub velocity: [f64; D],
    /// Force of the spheres on it (N), on the simulated part of a symmetric rig.
    pub force: [f64; D],
}

/// A closed contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touching<const D: usize> {
    /// Its bodies; a sphere twice where it meets its own image in a mirror.
    pub bodies: [Body; 2],
    /// From the first to the second, of unit length.
    pub normal: [f64; D],
    /// Overlap (m); twice that of a sphere and a flat where the flat stands for an equal sphere.
    pub overlap: f64,
    /// Normal force (N).
    pub force: f64,
    /// Force of the tangential spring (N).
    pub tangential: f64,
    /// Greatest overlap (m) and force (N) so far, where the law remembers them; else the present ones.
    pub overlap_max: f64,
    /// See `overlap_max`.
    pub force_max: f64,
    /// Energy it would give back (J), of the simulated part.
    pub stored: f64,
    /// Energy it has taken (J), of the simulated part.
    pub dissipated: f64,
}

/// The present state of a rig.
pub struct View<'a, const D: usize> {
    rig: &'a Rig<D>,
    engine: &'a dyn Engine<D>,
    step: f64,
}

impl<const D: usize> View<'_, D> {
    /// Time (s).
    pub fn time(&self) -> f64 {
        self.engine.count() as f64 * self.step
    }
    /// Where a sphere's centre is (m); over periodic sides it is not taken back.
    pub fn position(&self, sphere: usize) -> [f64; D] {
        let (centre, moved) = (self.rig.sample.spheres[sphere].centre, self.displacement(sphere));
        std::array::from_fn(|k| centre[k] + moved[k])
    }
    /// How far a sphere has moved (m).
    pub fn displacement(&self, sphere: usize) -> [f64; D] {
        self.engine.bodies().displacement[sphere]
    }
    /// Velocity of a sphere (m/s).
    pub fn velocity(&self, sphere: usize) -> [f64; D] {
        self.engine.bodies().velocity[sphere]
    }
    /// Spin of a sphere (rad/s), as [`Rig::spin`](super::Rig).
    pub fn spin(&self, sphere: usize) -> [f64; 3] {
        self.engine.bodies().spin[sphere]
    }
    /// Net force of contacts on the simulated part of a sphere (N).
    pub fn net_force(&self, sphere: usize) -> [f64; D] {
        self.engine.sums().force[sphere]
    }
    /// State of a flat.
    pub fn flat(&self, flat: usize) -> FlatState<D> {
        let bodies = self.engine.bodies();
        FlatState {
            moved: bodies.flat_moved[flat],
            velocity: bodies.flat_velocity[flat],
            force: self.engine.sums().flat[flat],
        }
    }
    /// State of a cluster.
    pub fn cluster(&self, cluster: usize) -> ClusterState<D> {
        self.engine.bodies().clusters[cluster]
    }
    /// The closed contacts, in a fixed order.
    pub fn contacts(&self) -> impl Iterator<Item = Touching<D>> + '_ {
        (0..self.engine.contacts()).filter_map(|c| self.engine.touching(self.rig, c))
    }
}

/// Steps between two looks at the guards.
const WATCH: u64 = 64;

impl<const D: usize> Simulation<D> {
    /// Sets a rig in motion, with steps of `step` (s).
    ///
    /// # Errors
    /// See [`RigError`].
    pub fn new(rig: Rig<D>, step: f64) -> Result<Self, RigError> {
        check(&rig, step)?;
        let mut engine = engine(&rig, step);
        engine.begin(&rig);
        let overlapping = (0..engine.contacts()).filter_map(|c| engine.touching(&rig, c));
        let reach = |bodies: [Body; 2]| {
            let radii = bodies.iter().filter_map(|body| match body {
                Body::Sphere(i) => Some(rig.sample.spheres[*i].radius),
                Body::Flat(_) => None,
            });
            radii.fold(0.0, f64::max)
        };
        for touching in overlapping {
            let (bodies, overlap) = (touching.bodies, touching.overlap);
            if !rig.squeezed && overlap > TOUCHING * reach(bodies) {
                return Err(RigError::Overlap { bodies, overlap });
            }
        }
        for strain in engine.strains() {
            let limit = stable_step::<D>(strain.stiffness, lighter(&rig, strain.bodies));
            if step > limit {
                return Err(RigError::Step { step, limit });
            }
        }
        Ok(Self { rig, step, engine, felt: None })
    }

    /// Keeps from here on each sphere's greatest speed and force and its first arrivals, by each of these thresholds.
    #[must_use]
    pub fn watching(mut self, arrivals: Vec<Arrival>) -> Self {
        self.felt = Some(Felt::new(self.rig.sample.spheres.len(), arrivals));
        self
    }

    /// Goes on by so many steps, or until a guard stops the run. `interrupt` is looked at now and then.
    ///
    /// # Errors
    /// See [`RigStop`]; the state is then that of the step at which the guard looked.
    pub fn advance(&mut self, steps: u64, interrupt: &AtomicBool) -> Result<(), RigStop> {
        self.follow(steps, interrupt, |_| ())
    }

    /// As [`advance`](Self::advance), showing the state after every step.
    ///
    /// # Errors
    /// See [`RigStop`].
    pub fn follow(
        &mut self,
        steps: u64,
        interrupt: &AtomicBool,
        mut each: impl FnMut(&View<'_, D>),
    ) -> Result<(), RigStop> {
        for _ in 0..steps {
            self.engine.advance(&self.rig);
            each(&View { rig: &self.rig, engine: &*self.engine, step: self.step });
            if let Some(felt) = &mut self.felt {
                let time = self.engine.count() as f64 * self.step;
                felt.accepted(time, self.step, self.engine.bodies(), self.engine.sums());
            }
            // Looked at by the count of steps, so that a run taken up again looks at the same ones.
            if self.engine.count().is_multiple_of(WATCH) {
                self.engine.look(&self.rig);
                self.guard()?;
                self.engine.forget_dropped();
                if interrupt.load(Ordering::Relaxed) {
                    return Err(RigStop::Interrupted { time: self.time() });
                }
            }
        }
        self.guard()
    }

    /// The rig.
    pub fn rig(&self) -> &Rig<D> {
        &self.rig
    }
    /// Time (s).
    pub fn time(&self) -> f64 {
        self.steps() as f64 * self.step
    }
    /// Steps so far.
    pub fn steps(&self) -> u64 {
        self.engine.count()
    }
    /// The step (s).
    pub fn step(&self) -> f64 {
        self.step
    }
    /// The present state.
    pub fn view(&self) -> View<'_, D> {
        View { rig: &self.rig, engine: &*self.engine, step: self.step }
    }
    /// Where the energy is and went.
    pub fn ledger(&self) -> EnergyLedger {
        self.engine.ledger(&self.rig)
    }
    /// Every contact of spheres and mirrors that ever closed; those with flats are left out.
    pub(super) fn contacts_ever(&self) -> Vec<ContactRecord> {
        self.engine.contacts_ever()
    }
    /// What contacts have taken from each sphere (J): half of each to both, all of it at flats; of whole spheres also where
    /// they lie on a mirror.
    pub fn dissipated(&self) -> Vec<f64> {
        self.engine.dissipated()
    }
    /// Greatest speed of each sphere (m/s); empty without [`watching`](Self::watching).
    pub fn greatest_speed(&self) -> Vec<f64> {
        self.felt.as_ref().map_or(Vec::new(), |felt| felt.speed_squared.iter().map(|v| v.sqrt()).collect())
    }
    /// Greatest net contact force on the simulated part of each sphere (N); empty without [`watching`](Self::watching).
    pub fn greatest_force(&self) -> Vec<f64> {
        self.felt.as_ref().map_or(Vec::new(), |felt| felt.force_squared.iter().map(|f| f.sqrt()).collect())
    }
    /// First arrivals (s) by the k-th threshold watched, one per sphere; none for spheres not reached.
    pub fn arrivals(&self, k: usize) -> Vec<Option<f64>> {
        self.felt.as_ref().map_or(Vec::new(), |felt| felt.arrivals(k, self.step))
    }

    /// The whole state as bytes.
    pub fn checkpoint(&self) -> Vec<u8> {
        let state =
            State { digest: digest(&self.rig), felt: self.felt.as_ref().map(Felt::numbers), ..self.engine.save() };
        state.to_bytes()
    }

    /// Takes up a run where [`checkpoint`](Self::checkpoint) left it: it goes on to the same bits. Rig, step and what is
    /// watched must be the same.
    ///
    /// # Errors
    /// See [`CheckpointError`].
    pub fn take_up(&mut self, bytes: &[u8]) -> Result<(), CheckpointError> {
        let mut state = State::from_bytes(bytes)?;
        if state.digest != digest(&self.rig) {
            return Err(CheckpointError::Other("rig"));
        }
        if state.step != self.step {
            return Err(CheckpointError::Other("step"));
        }
        let mut felt = self.felt.clone();
        let watched = match (&mut felt, state.felt.take()) {
            (None, None) => true,
            (Some(felt), Some(rows)) => felt.take_up(rows),
            _ => false,
        };
        if !watched {
            return Err(CheckpointError::Other("set of arrivals"));
        }
        let mut engine = engine(&self.rig, self.step);
        if !engine.load(&self.rig, state) {
            return Err(CheckpointError::Damaged);
        }
        (self.engine, self.felt) = (engine, felt);
        Ok(())
    }

    /// What stops a run.
    fn guard(&self) -> Result<(), RigStop> {
        let (time, bodies) = (self.time(), self.engine.bodies());
        for i in 0..bodies.velocity.len() {
            if !bodies.speed_squared(i).is_finite() {
                return Err(RigStop::NotFinite { body: Body::Sphere(i), time });
            }
            let Some([low, high]) = self.rig.domain else { continue };
            let centre = self.rig.sample.spheres[i].centre;
            for k in 0..D {
                let at = centre[k] + bodies.displacement[i][k];
                if self.rig.periods[k].is_none() && !(low[k]..=high[k]).contains(&at) {
                    return Err(RigStop::Escaped { body: Body::Sphere(i), time });
                }
            }
        }
        for f in 0..bodies.flat_velocity.len() {
            if bodies.flat_velocity[f].iter().any(|v| !v.is_finite()) {
                return Err(RigStop::NotFinite { body: Body::Flat(f), time });
            }
        }
        for Strain { bodies, ratio, range_used, stiffness } in self.engine.strains() {
            if ratio > self.rig.overlap_limit || range_used > 1.0 {
                let limit = self.rig.overlap_limit.min(ratio / range_used);
                return Err(RigStop::Overlap { bodies, ratio, limit, time });
            }
            let limit = stable_step::<D>(stiffness, lighter(&self.rig, bodies));
            if self.step > limit {
                return Err(RigStop::Step { step: self.step, limit, stiffness, bodies, time });
            }
        }
        let limit = self.rig.residual_limit;
        match self.ledger().residual() {
            // Not a number is no small residual either.
            Some(residual) if residual.is_nan() || residual.abs() > limit => {
                Err(RigStop::Residual { residual, limit, time })
            }
            _ => Ok(()),
        }
    }
}

/// Mass (kg) of the lighter of two bodies that can move.
fn lighter<const D: usize>(rig: &Rig<D>, bodies: [Body; 2]) -> f64 {
    let mass = |body: Body| match body {
        Body::Sphere(i) if rig.held[i].iter().all(|&held| held) => f64::INFINITY,
        Body::Sphere(i) => rig.mass[i],
        Body::Flat(f) => rig.flats[f].mass,
    };
    mass(bodies[0]).min(mass(bodies[1]))
}

/// The engine for a rig's dimension and laws, compiled here for each dimension; see `dem::same`.
fn engine<const D: usize>(rig: &Rig<D>, step: f64) -> Box<dyn Engine<D>> {
    fn in_line(rig: &Rig<1>, step: f64) -> Box<dyn Engine<1>> {
        choose(rig, step)
    }
    fn in_plane(rig: &Rig<2>, step: f64) -> Box<dyn Engine<2>> {
        choose(rig, step)
    }
    fn in_space(rig: &Rig<3>, step: f64) -> Box<dyn Engine<3>> {
        choose(rig, step)
    }
    let dimension: &dyn Any = rig;
    if let Some(rig) = dimension.downcast_ref() {
        same(in_line(rig, step))
    } else if let Some(rig) = dimension.downcast_ref() {
        same(in_plane(rig, step))
    } else if let Some(rig) = dimension.downcast_ref() {
        same(in_space(rig, step))
    } else {
        const { assert!(D >= 1 && D <= 3, "there are one to three dimensions") };
        unreachable!("one of the three")
    }
}

fn choose<const D: usize>(rig: &Rig<D>, step: f64) -> Box<dyn Engine<D>> {
    match &rig.laws {
        LawBook::Materials { law, constants, pairs, friction } => {
            let binder = ByMaterial {
                law: law.clone(),
                constants: *constants,
                pairs: pairs.clone(),
                friction: *friction,
                materials: rig.sample.materials.clone(),
            };
            Box::new(Machine::new(rig, binder, 2.0, step))
        }
        LawBook::Dashpot { stiffness, materials, cut } => {
            let binder = ByDashpot { stiffness: *stiffness, materials: materials.clone(), cut: *cut };
            Box::new(Machine::new(rig, binder, 1.0, step))
        }
    }
}

/// What can be wrong with a rig by itself.
fn check<const D: usize>(rig: &Rig<D>, step: f64) -> Result<(), RigError> {
    let count = rig.sample.spheres.len();
    let shapes = [
        ("mass", rig.mass.len()),
        ("inertia", rig.inertia.len()),
        ("velocity", rig.velocity.len()),
        ("spin", rig.spin.len()),
        ("held", rig.held.len()),
    ];
    if let Some((what, _)) = shapes.into_iter().find(|(_, len)| *len != count) {
        return Err(RigError::Shape(what));
    }
    if !(step > 0.0 && step.is_finite()) {
        return Err(RigError::Step { step, limit: f64::INFINITY });
    }
    let positive = |what, body, value: f64| match value > 0.0 && value.is_finite() {
        true => Ok(()),
        false => Err(RigError::Value { what, body, value }),
    };
    for (i, sphere) in rig.sample.spheres.iter().enumerate() {
        let body = Body::Sphere(i);
        positive("the radius", body, sphere.radius)?;
        positive("the mass", body, rig.mass[i])?;
        positive("the moment of inertia", body, rig.inertia[i])?;
        let numbers = sphere.centre.iter().chain(&rig.velocity[i]).chain(&rig.spin[i]);
        if let Some(&value) = numbers.into_iter().find(|x| !x.is_finite()) {
            return Err(RigError::Value { what: "a coordinate, velocity or spin", body, value });
        }
    }
    for (f, flat) in rig.flats.iter().enumerate() {
        let body = Body::Flat(f);
        if flat.mass.is_nan() || flat.mass <= 0.0 {
            return Err(RigError::Value { what: "the mass", body, value: flat.mass });
        }
        let length = flat.normal.iter().map(|n| n * n).sum::<f64>().sqrt();
        if length.is_nan() || (length - 1.0).abs() > 1e-9 {
            return Err(RigError::Value { what: "the length of the normal", body, value: length });
        }
    }
    let present = |body: Body| {
        let (place, count) = match body {
            Body::Sphere(i) => (i, count),
            Body::Flat(f) => (f, rig.flats.len()),
        };
        if place < count { Ok(()) } else { Err(RigError::Missing { body, count }) }
    };
    rig.loads.iter().flat_map(|load| &load.bodies).try_for_each(|&body| present(body))?;
    for bar in &rig.bars {
        present(bar.body)?;
        positive("the impedance of the bar", bar.body, bar.impedance)?;
        let prescribed = rig.loads.iter().filter(|load| load.kind == LoadKind::Velocity);
        if prescribed.flat_map(|load| &load.bodies).any(|&body| body == bar.body) {
            return Err(RigError::Bound(bar.body));
        }
    }
    let mut member = vec![false; count];
    for (c, cluster) in rig.clusters.iter().enumerate() {
        let wrong = |why| Err(RigError::Cluster(c + 1, why));
        for &i in &cluster.members {
            if i >= count || std::mem::replace(&mut member[i], true) {
                return wrong("a member does not exist or belongs to two clusters");
            }
            let loaded = rig.loads.iter().flat_map(|load| &load.bodies).chain(rig.bars.iter().map(|bar| &bar.body));
            if rig.held[i].contains(&true) || loaded.into_iter().any(|&body| body == Body::Sphere(i)) {
                return wrong("a member is held, loaded or fixed to a bar by itself");
            }
        }
        let numbers = cluster.centre.iter().chain(&cluster.velocity).chain([&cluster.spin]);
        if cluster.members.is_empty() || !numbers.into_iter().all(|x| x.is_finite()) {
            return wrong("it has no members, or a number that is not finite");
        }
        if !(cluster.mass > 0.0 && cluster.inertia > 0.0 && cluster.mass.is_finite() && cluster.inertia.is_finite()) {
            return wrong("mass and moment of inertia must be positive");
        }
        if cluster.turns && D != 2 {
            return wrong("only in the plane can a cluster turn");
        }
        if !rig.mirrors.is_empty() {
            return wrong("clusters do not go with mirrors");
        }
    }
    if D == 3 && rig.laws.has_friction() && !rig.mirrors.is_empty() {
        return Err(RigError::MirroredFriction);
    }
    let least = Finder::new(rig).shortest_period();
    for period in rig.periods.into_iter().flatten() {
        if period.is_nan() || period < least {
            return Err(RigError::Period { period, least });
        }
    }
    Ok(())
}
