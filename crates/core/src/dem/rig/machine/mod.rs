//! One step of a rig, by velocity Verlet or by Adams's scheme, which adds to it.
//!
//! The predicted velocity v + h a stands in the force, as everywhere in [`dem`](crate::dem), so that the step is of second
//! order although forces depend on velocities. Bars and drag answer the new velocity implicitly (Crank and Nicolson), so that
//! a stiff bar limits no step.
//!
//! - `motion`: drift and kick of all bodies; `past`: what Adams's scheme adds to both
//! - `acts`: what loads do to bodies during a step

mod acts;
mod motion;
mod past;

use std::ops::Range;

use acts::{Act, Loaded};
pub(super) use past::Past;

use super::bodies::{Bodies, dot};
use super::cluster::Ahead;
use super::contacts::{Contacts, Excess, Predicted, Sums, Swept};
use super::law::LawMaker;
use super::ledger::EnergyLedger;
use super::pairs::Finder;
use super::spins::Spins;
use super::{Body, LoadKind, Rig};
use crate::dem::share::parts;

/// A rig in motion under laws of one type.
pub(super) struct Machine<const D: usize, L: Swept<D>, B> {
    pub bodies: Bodies<D>,
    pub contacts: Contacts<D, L>,
    pub maker: B,
    pub finder: Finder<D>,
    pub step: f64,
    pub count: u64,
    /// Displacements when near pairs were last looked for, of spheres and of flats.
    pub seen: Vec<[f64; D]>,
    pub flat_seen: Vec<[f64; D]>,
    pub sums: Sums<D>,
    predicted: Vec<[f64; D]>,
    /// r ω predicted, or ω where arms end in the contact; empty without friction.
    predicted_turn: Spins<D>,
    predicted_flat: Vec<[f64; D]>,
    /// Work of loads and prescribed motion, and what bars and drag took (J).
    pub work_in: f64,
    pub absorbed: f64,
    /// The most energy that was at hand so far (J), as of the last look.
    pub at_hand: f64,
    /// What the scheme held back at the start (J).
    pub held_back: f64,
    turning: bool,
    /// Accelerations before, with Adams's scheme.
    pub past: Option<Past>,
    /// Bodies under loads or incoming pulses.
    loaded: Vec<Loaded>,
    acts: Vec<Act<D>>,
}

impl<const D: usize, L: Swept<D>, B: LawMaker<L>> Machine<D, L, B> {
    pub fn new(rig: &Rig<D>, maker: B, face_factor: f64, step: f64) -> Self {
        let bodies = Bodies::new(rig);
        let finder = Finder::new(rig);
        let contacts = Contacts::new(rig, face_factor);
        let (spheres, flats) = (rig.sample.spheres.len(), rig.flats.len());
        let turning = rig.has_friction();
        Self {
            seen: bodies.displacement.clone(),
            flat_seen: bodies.flat_moved.clone(),
            predicted: vec![[0.0; D]; spheres],
            predicted_turn: Spins::still(if turning { spheres } else { 0 }),
            predicted_flat: vec![[0.0; D]; flats],
            sums: Sums::new(spheres, flats),
            work_in: 0.0,
            absorbed: 0.0,
            at_hand: 0.0,
            held_back: 0.0,
            turning,
            past: None,
            count: 0,
            loaded: acts::loaded(rig),
            acts: Vec::new(),
            bodies,
            contacts,
            maker,
            finder,
            step,
        }
    }

    /// Time (s) at the last accepted step.
    pub fn time(&self) -> f64 {
        self.count as f64 * self.step
    }

    /// Contacts and forces at the start, and the energy that is there already.
    pub fn begin(&mut self, rig: &Rig<D>) {
        self.finder.allow(&self.bodies.velocity, self.step);
        self.contacts.renew(rig, &self.finder, &self.bodies, &self.maker);
        // Velocities prescribed at time zero hold from the start on.
        for load in rig.loads.iter().filter(|load| load.kind == LoadKind::Velocity && load.curve.end() > 0.0) {
            let velocity = load.direction.map(|n| n * load.curve.value(0.0));
            for &body in &load.bodies {
                match body {
                    Body::Sphere(i) => self.bodies.velocity[i] = velocity,
                    Body::Flat(f) => self.bodies.flat_velocity[f] = velocity,
                }
            }
        }
        self.move_clusters(rig, 0.0);
        let Self { bodies, contacts, sums, .. } = self;
        let (velocity, flat_velocity) = (&bodies.velocity, &bodies.flat_velocity);
        let turn = &bodies.spin.times(&contacts.lever);
        contacts.sweep(rig, bodies, Predicted { velocity, turn, flat_velocity, step: 0.0 }, sums);
        for c in 0..contacts.len() {
            // What a squeezed contact stores at the start is no work of the motion.
            contacts.account.work[c] = contacts.normal_law(c).stored(contacts.account.overlap[c], &contacts.memory[c]);
        }
        // A kick of no length sets the accelerations alone.
        self.kick(rig, 0.0);
        self.move_clusters(rig, 0.0);
        let ledger = self.ledger(rig);
        self.work_in = ledger.kinetic + ledger.stored;
        self.held_back = ledger.held_back;
    }

    /// One accepted step.
    pub fn advance(&mut self, rig: &Rig<D>) {
        let h = self.step;
        self.plan_acts(rig);
        let mut strayed = self.drift(h);
        strayed |= self.drift_by_past(h);
        self.apply_acts(rig, h);
        for (c, cluster) in rig.clusters.iter().enumerate() {
            let mut state = self.bodies.clusters[c];
            let ahead = self
                .past
                .as_mut()
                .map_or_else(Ahead::default, |past| past.cluster_ahead(c, &state.acceleration, state.spin_rate));
            let predicted = (&mut self.predicted[..], &mut self.predicted_turn);
            state.drift(rig, cluster, (h, &ahead), &mut self.bodies, predicted, &self.contacts.lever);
            self.bodies.clusters[c] = state;
        }
        strayed |= self.driven_strayed(rig);
        if strayed {
            self.finder.allow(&self.predicted, h);
            self.contacts.renew(rig, &self.finder, &self.bodies, &self.maker);
            self.seen.copy_from_slice(&self.bodies.displacement);
            self.flat_seen.copy_from_slice(&self.bodies.flat_moved);
        }
        let Self { bodies, contacts, sums, predicted, predicted_turn, predicted_flat, .. } = self;
        contacts.sweep(
            rig,
            bodies,
            Predicted { velocity: predicted, turn: predicted_turn, flat_velocity: predicted_flat, step: h },
            sums,
        );
        let impulses = self.part_impulses();
        self.kick(rig, h);
        self.kick_by_past(rig, h);
        self.give_impulses(rig, h, &impulses);
        self.finish_acts(rig, h);
        self.move_clusters(rig, h);
        if let Some(past) = &mut self.past {
            past.accept();
        }
        // Its room is used again.
        self.sums.excess = impulses;
        self.count += 1;
    }

    /// Takes out of the sums what is no force of this state but an impulse. Members of clusters keep it among their forces.
    fn part_impulses(&mut self) -> Vec<Excess<D>> {
        let Self { sums, bodies, .. } = self;
        let mut impulses = std::mem::take(&mut sums.excess);
        impulses.retain(|Excess { body, force }| {
            let sum = match *body {
                Body::Sphere(i) if bodies.clustered[i].is_some() => return false,
                Body::Sphere(i) => &mut sums.force[i],
                Body::Flat(f) => &mut sums.flat[f],
            };
            (0..D).for_each(|k| sum[k] -= force[k]);
            true
        });
        impulses
    }

    /// Clusters take up the forces on their members, and the members their motion.
    fn move_clusters(&mut self, rig: &Rig<D>, h: f64) {
        for (c, cluster) in rig.clusters.iter().enumerate() {
            let mut state = self.bodies.clusters[c];
            let past = self.past.as_ref();
            let added = |k: usize, new: f64| past.map_or(0.0, |past| past.cluster_behind::<D>(c, k, new));
            state.kick(rig, cluster, (h, added), &self.sums, &mut self.bodies);
            self.bodies.clusters[c] = state;
        }
    }
}

impl<const D: usize, L: Swept<D>, B: LawMaker<L>> Machine<D, L, B> {
    /// Draws the balance.
    pub fn ledger(&self, rig: &Rig<D>) -> EnergyLedger {
        let mut ledger = EnergyLedger {
            work_in: self.work_in,
            absorbed: self.absorbed,
            at_hand: self.at_hand,
            held_back: -self.held_back,
            ..EnergyLedger::default()
        };
        // What Verlet holds back while forces act, and Adams does not.
        let eighth = if self.past.is_some() { 0.0 } else { 0.125 * self.step * self.step };
        let bodies = &self.bodies;
        for (state, cluster) in bodies.clusters.iter().zip(&rig.clusters) {
            ledger.kinetic += state.kinetic(cluster);
            ledger.held_back += eighth * cluster.mass * dot(&state.acceleration, &state.acceleration);
            ledger.potential -= cluster.mass * dot(&rig.gravity, &state.moved);
        }
        for [kinetic, potential, pushed] in parts(bodies.velocity.len(), |spheres| self.motion(rig, spheres)) {
            ledger.kinetic += kinetic;
            ledger.potential += potential;
            ledger.held_back += eighth * pushed;
        }
        let whole = flat_weight(rig);
        for (f, flat) in rig.flats.iter().enumerate().filter(|(_, flat)| flat.mass.is_finite()) {
            let velocity = &bodies.flat_velocity[f];
            ledger.kinetic += 0.5 * flat.mass * whole * dot(velocity, velocity);
            let driven = driven_squared(&bodies.flat_acceleration[f], velocity, &bodies.flat_damping[f]);
            ledger.held_back += eighth * flat.mass * whole * driven;
            for k in 0..D {
                if bodies.flat_inverse_mass[f][k] > 0.0 {
                    ledger.potential -= flat.mass * whole * rig.gravity[k] * bodies.flat_moved[f][k];
                }
            }
        }
        let contacts = &self.contacts;
        let springs = contacts.has_tangential_springs();
        for part in parts(contacts.len(), |some| self.held(some, springs)) {
            ledger.stored += part.stored;
            ledger.dissipated += part.dissipated;
            ledger.tangential_stored += part.tangential_stored;
            ledger.friction += part.friction;
        }
        for kept in contacts.kept_pairs.values().chain(contacts.kept_faces.values()) {
            ledger.dissipated += kept.weight * kept.work;
            ledger.friction += kept.weight * kept.friction_work;
        }
        ledger.dissipated += contacts.lost[0];
        ledger.friction += contacts.lost[1];
        ledger.at_hand = ledger.at_hand.max(ledger.work_in - ledger.potential.min(0.0));
        ledger
    }

    /// Kinetic and potential energy of some spheres, those of clusters apart, and Σ m (b² − λ² v²), see [`driven_squared`].
    fn motion(&self, rig: &Rig<D>, spheres: Range<usize>) -> [f64; 3] {
        let bodies = &self.bodies;
        let (mut kinetic, mut potential, mut pushed) = (0.0, 0.0, 0.0);
        for i in spheres.filter(|&i| bodies.clustered[i].is_none()) {
            let mass = rig.mass[i] * bodies.weight[i];
            kinetic += 0.5 * mass * bodies.speed_squared(i);
            let rates = bodies.damping.get(i).copied().unwrap_or([0.0; D]);
            pushed += mass * driven_squared(&bodies.acceleration[i], &bodies.velocity[i], &rates);
            if self.turning {
                let spin = &bodies.spin.get(i);
                kinetic += 0.5 * rig.inertia[i] * bodies.weight[i] * dot(spin, spin);
            }
            for k in 0..D {
                if bodies.inverse_mass[i][k] > 0.0 {
                    potential -= mass * rig.gravity[k] * bodies.displacement[i][k];
                }
            }
        }
        [kinetic, potential, pushed]
    }

    /// What some contacts hold and have taken, tangential springs only where there are any.
    fn held(&self, some: Range<usize>, springs: bool) -> EnergyLedger {
        let (contacts, mut held) = (&self.contacts, EnergyLedger::default());
        for c in some {
            let account = &contacts.account;
            let (work, friction_work, overlap) = (account.work[c], account.friction_work[c], account.overlap[c]);
            if work == 0.0 && friction_work == 0.0 && overlap == 0.0 {
                continue;
            }
            let stored = contacts.normal_law(c).stored(overlap, &contacts.memory[c]);
            let weight = contacts.weight(c);
            held.stored += weight * stored;
            held.dissipated += weight * (work - stored);
            let sheared = if springs { contacts.tangential_stored(c) } else { 0.0 };
            held.tangential_stored += weight * sheared;
            held.friction += weight * (friction_work - sheared);
        }
        held
    }

    /// Draws the balance, and remembers how much energy was at hand.
    pub fn look(&mut self, rig: &Rig<D>) -> EnergyLedger {
        let ledger = self.ledger(rig);
        self.at_hand = ledger.at_hand;
        ledger
    }
}

/// b² − λ² v² (m²/s⁴) of a body that is driven with b and damped at rates λ, so that its acceleration is a = b − λ v: with bars and drag
/// answered by Crank and Nicolson's rule, it is this whose change a step's balance is out by, times h² m/8. Without them it is a².
fn driven_squared<const D: usize>(acceleration: &[f64; D], velocity: &[f64; D], rates: &[f64; D]) -> f64 {
    (0..D).map(|k| acceleration[k] * (acceleration[k] + 2.0 * rates[k] * velocity[k])).sum()
}

/// The part of each flat that is simulated: every mirror of a rig halves its flats.
fn flat_weight<const D: usize>(rig: &Rig<D>) -> f64 {
    0.5_f64.powi(rig.mirrors.len() as i32)
}
