//! A rig from start to end.

use super::check::{RigError, check};
use super::checkpoint::{State, digest};
use super::contacts::Swept;
use super::dashpot::SpringDashpot;
use super::engine::Engine;
use super::guard::{RigStop, bearable, guard, lighter};
use super::law::{ByDashpot, ByMaterial};
use super::ledger::{EnergyLedger, Gain};
use super::machine::Machine;
use super::pairs::TOUCHING;
use super::peaks::{Arrival, Peaks};
use super::view::View;
use super::{Body, LawBook, Rig};
use crate::Context;
use crate::dem::share::MANY;
use crate::dem::{CheckpointError, ContactRecord, Integrator, MoveIn, Spheres, stable_step};

/// A rig in motion.
pub struct Simulation<const D: usize> {
    rig: Rig<D>,
    step: f64,
    engine: Box<dyn Engine<D>>,
    peaks: Option<Peaks>,
    /// The balance that was drawn last, and after how many steps.
    balance: Option<(u64, EnergyLedger)>,
}

/// Steps between two looks at the guards.
const WATCH: u64 = 64;

impl<const D: usize> Simulation<D>
where
    Spheres: MoveIn<D>,
{
    /// Sets a rig in motion, with steps of `step` (s) of velocity Verlet.
    ///
    /// # Errors
    /// See [`RigError`].
    pub fn new(rig: Rig<D>, step: f64) -> Result<Self, RigError> {
        Self::by(Integrator::Verlet, rig, step)
    }

    /// Sets a rig in motion by velocity Verlet or by Adams's scheme, with steps of `step` (s). Adams's is of fourth order while forces are
    /// smooth, and by it a fall under gravity is exact too; of second order in a step in which a contact begins or ends, yields, or begins to slide, and
    /// wherever springs of friction act, whose ways are found from the mean of two velocities. It is stable up to
    /// [`Integrator::stability`] of Verlet's step.
    ///
    /// # Errors
    /// See [`RigError`]; [`RigError::Scheme`] for Runge-Kutta's, which asks for forces several times a step.
    pub fn by(integrator: Integrator, rig: Rig<D>, step: f64) -> Result<Self, RigError> {
        if integrator == Integrator::Rk4 {
            return Err(RigError::Scheme(integrator));
        }
        check(&rig, step)?;
        let Still(mut engine) = Spheres::engine(&rig, step);
        engine.begin(&rig);
        engine.go_by(integrator);
        let slowed = step / integrator.stability();
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
            if !rig.precompressed && overlap > TOUCHING * reach(bodies) {
                return Err(RigError::Overlap { bodies, overlap });
            }
        }
        for strain in engine.strains(bearable::<D>(slowed)) {
            let stable = stable_step::<D>(strain.stiffness, lighter(&rig, strain.bodies));
            let limit = integrator.stability() * stable;
            if step > limit {
                return Err(RigError::Step { step, limit });
            }
        }
        Ok(Self { rig, step, engine, peaks: None, balance: None })
    }

    /// Takes up a run where [`checkpoint`](Self::checkpoint) left it: it goes on to the same bits. Rig, step, scheme and what is
    /// watched must be the same.
    ///
    /// # Errors
    /// See [`CheckpointError`].
    pub fn restore(&mut self, bytes: &[u8]) -> Result<(), CheckpointError> {
        let mut state = State::from_bytes(bytes)?;
        if state.digest != digest(&self.rig) {
            return Err(CheckpointError::Other("rig"));
        }
        if state.step != self.step {
            return Err(CheckpointError::Other("step"));
        }
        if state.integrator != self.engine.integrator() {
            return Err(CheckpointError::Other("scheme"));
        }
        let mut peaks = self.peaks.clone();
        let watched = match (&mut peaks, state.peaks.take()) {
            (None, None) => true,
            (Some(peaks), Some(rows)) => peaks.restore(rows),
            _ => false,
        };
        if !watched {
            return Err(CheckpointError::Other("set of arrivals"));
        }
        let Still(mut engine) = Spheres::engine(&self.rig, self.step);
        engine.go_by(state.integrator);
        if !engine.load(&self.rig, state) {
            return Err(CheckpointError::Damaged);
        }
        (self.engine, self.peaks, self.balance) = (engine, peaks, None);
        Ok(())
    }
}

impl<const D: usize> Simulation<D> {
    /// Keeps from here on each sphere's greatest speed and force and its first arrivals, by each of these thresholds.
    #[must_use]
    pub fn recording(mut self, arrivals: Vec<Arrival>) -> Self {
        self.peaks = Some(Peaks::new(self.rig.sample.spheres.len(), arrivals));
        self
    }

    /// Goes on by so many steps, or until a guard stops the run. `context` is looked at now and then.
    ///
    /// # Errors
    /// See [`RigStop`]; the state is then that of the step at which the guard looked.
    pub fn advance(&mut self, steps: u64, context: &Context) -> Result<(), RigStop> {
        self.follow(steps, context, |_| ())
    }

    /// As [`advance`](Self::advance), showing the state after every step; of large rigs on one of the threads that share their loops.
    ///
    /// # Errors
    /// See [`RigStop`].
    pub fn follow(
        &mut self,
        steps: u64,
        context: &Context,
        each: impl FnMut(&View<'_, D>) + Send,
    ) -> Result<(), RigStop> {
        if self.engine.bodies().velocity.len().max(self.engine.contacts()) < MANY {
            return self.steps_on(steps, context, each);
        }
        // Among the threads that share a step's loops, so that none has to be woken for each.
        rayon::scope(|_| self.steps_on(steps, context, each))
    }

    fn steps_on(&mut self, steps: u64, context: &Context, mut each: impl FnMut(&View<'_, D>)) -> Result<(), RigStop> {
        for _ in 0..steps {
            self.engine.advance(&self.rig);
            each(&View { rig: &self.rig, engine: &*self.engine, step: self.step });
            if let Some(peaks) = &mut self.peaks {
                peaks.accepted(self.engine.count(), self.step, self.engine.bodies(), self.engine.sums());
            }
            // Looked at by the count of steps, so that a run taken up again looks at the same ones.
            if self.engine.count().is_multiple_of(WATCH) {
                let ledger = self.engine.look(&self.rig);
                guard(&self.rig, &*self.engine, self.step, &ledger)?;
                self.engine.forget_dropped();
                if context.stopped() {
                    return Err(RigStop::Interrupted { time: self.time() });
                }
            }
        }
        if self.engine.count().is_multiple_of(WATCH) {
            return Ok(());
        }
        let ledger = self.ledger();
        self.balance = Some((self.steps(), ledger));
        guard(&self.rig, &*self.engine, self.step, &ledger)
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
    /// By which scheme.
    pub fn integrator(&self) -> Integrator {
        self.engine.integrator()
    }
    /// The present state.
    pub fn view(&self) -> View<'_, D> {
        View { rig: &self.rig, engine: &*self.engine, step: self.step }
    }
    /// Where the energy is and went.
    pub fn ledger(&self) -> EnergyLedger {
        match self.balance {
            Some((steps, ledger)) if steps == self.steps() => ledger,
            _ => self.engine.ledger(&self.rig),
        }
    }
    /// Every contact of two spheres, or of a sphere and its mirror image, that ever closed, in order of the spheres; laws without
    /// memory know only those closed now. Losses by friction are not in it.
    pub fn contacts_ever(&self) -> Vec<ContactRecord> {
        self.engine.contacts_ever()
    }
    /// What contacts have given back beyond what was put into them, by the name of their law, the most first: nothing but errors of
    /// the step under a law that makes no energy.
    pub fn gains(&self) -> Vec<Gain> {
        let mut by_law: Vec<Gain> = Vec::new();
        for (materials, energy) in self.engine.gains(&self.rig) {
            let law = self.rig.laws.name_of(materials);
            match by_law.iter_mut().find(|gain| gain.law == law) {
                Some(gain) => gain.energy += energy,
                None => by_law.push(Gain { law: law.to_owned(), energy }),
            }
        }
        by_law.sort_by(|a, b| b.energy.total_cmp(&a.energy));
        by_law
    }
    /// What contacts have taken from each sphere (J): half of each to both, all of it at flats; of whole spheres also where
    /// they lie on a mirror.
    pub fn dissipated(&self) -> Vec<f64> {
        self.engine.dissipated()
    }
    /// Greatest speed of each sphere (m/s); empty without [`recording`](Self::recording).
    pub fn greatest_speed(&self) -> Vec<f64> {
        self.peaks.as_ref().map_or(Vec::new(), |peaks| peaks.speed_squared.iter().map(|v| v.sqrt()).collect())
    }
    /// Greatest net contact force on the simulated part of each sphere (N); empty without [`recording`](Self::recording).
    pub fn greatest_force(&self) -> Vec<f64> {
        self.peaks.as_ref().map_or(Vec::new(), |peaks| peaks.force_squared.iter().map(|f| f.sqrt()).collect())
    }
    /// First arrivals (s) by the k-th threshold watched, one per sphere; none for spheres not reached.
    pub fn arrivals(&self, k: usize) -> Vec<Option<f64>> {
        self.peaks.as_ref().map_or(Vec::new(), |peaks| peaks.arrivals(k, self.step))
    }

    /// The whole state as bytes.
    pub fn checkpoint(&self) -> Vec<u8> {
        let state =
            State { digest: digest(&self.rig), peaks: self.peaks.as_ref().map(Peaks::so_far), ..self.engine.save() };
        state.to_bytes()
    }
}

/// An engine that has not begun.
pub struct Still<const D: usize>(Box<dyn Engine<D>>);

/// The engine of a rig, compiled here for each dimension.
pub trait Driven<const D: usize> {
    /// For its laws.
    fn engine(rig: &Rig<D>, step: f64) -> Still<D>;
}

impl Driven<1> for Spheres {
    fn engine(rig: &Rig<1>, step: f64) -> Still<1> {
        engine(rig, step)
    }
}

impl Driven<2> for Spheres {
    fn engine(rig: &Rig<2>, step: f64) -> Still<2> {
        engine(rig, step)
    }
}

impl Driven<3> for Spheres {
    fn engine(rig: &Rig<3>, step: f64) -> Still<3> {
        engine(rig, step)
    }
}

/// The machine for its laws.
fn engine<const D: usize>(rig: &Rig<D>, step: f64) -> Still<D>
where
    SpringDashpot: Swept<D>,
{
    match &rig.laws {
        LawBook::Materials { law, constants, pairs, friction } => {
            let maker = ByMaterial {
                law: law.clone(),
                constants: *constants,
                pairs: pairs.clone(),
                friction: *friction,
                materials: rig.sample.materials.clone(),
            };
            Still(Box::new(Machine::new(rig, maker, 2.0, step)))
        }
        LawBook::Dashpot { stiffness, materials, cut, .. } => {
            let maker = ByDashpot { stiffness: *stiffness, materials: materials.clone(), cut: *cut };
            Still(Box::new(Machine::new(rig, maker, 1.0, step)))
        }
    }
}
