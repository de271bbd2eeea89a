//! One velocity-Verlet step of a rig.
//!
//! The predicted velocity v + h a stands in the force, as everywhere in [`dem`](crate::dem), so that the step is of second
//! order although forces depend on velocities. Bars and drag answer the new velocity implicitly (Crank and Nicolson), so that
//! a stiff bar limits no step.
//!
//! - `acts`: what loads do to bodies during a step

mod acts;

use std::ops::Range;

use acts::{Act, Loaded};
use rayon::prelude::*;

use super::bodies::{Bodies, dot};
use super::contacts::{Contacts, Sums, Trial};
use super::law::{Binder, Bonding};
use super::ledger::EnergyLedger;
use super::pairs::Finder;
use super::turns::Turns;
use super::{Body, LoadKind, Rig};

/// A rig in motion under laws of one type.
pub(super) struct Machine<const D: usize, L: Bonding, B> {
    pub bodies: Bodies<D>,
    pub contacts: Contacts<D, L>,
    pub binder: B,
    pub finder: Finder<D>,
    pub step: f64,
    pub count: u64,
    /// Displacements when near pairs were last looked for, of spheres and of flats.
    pub seen: Vec<[f64; D]>,
    pub flat_seen: Vec<[f64; D]>,
    pub sums: Sums<D>,
    trial: Vec<[f64; D]>,
    trial_spin: Turns<D>,
    flat_trial: Vec<[f64; D]>,
    /// Work of loads and prescribed motion, and what bars and drag took (J).
    pub work_in: f64,
    pub absorbed: f64,
    /// The most energy that was at hand so far (J), as of the last look.
    pub at_hand: f64,
    turning: bool,
    /// Bodies under loads or incoming pulses.
    loaded: Vec<Loaded>,
    acts: Vec<Act<D>>,
}

/// From so many spheres on loops over them are shared among threads.
const MANY: usize = 20_000;

/// Moves a body on by a step, and predicts its velocity.
#[inline(always)]
fn drift<const D: usize>(
    h: f64,
    displacement: &mut [f64; D],
    velocity: &[f64; D],
    acceleration: &[f64; D],
    trial: &mut [f64; D],
) {
    for k in 0..D {
        displacement[k] += h * (velocity[k] + 0.5 * h * acceleration[k]);
        trial[k] = velocity[k] + h * acceleration[k];
    }
}

/// New velocity and acceleration of a body, a row of both, under the contact force; gives Σ λ (v² old + v² new).
#[inline(always)]
fn kick<const D: usize, const DAMPED: bool>(
    h: f64,
    (velocity, acceleration): (&mut [f64; D], &mut [f64; D]),
    force: &[f64; D],
    inverse: &[f64; D],
    gravity: &[f64; D],
    damping: &[f64; D],
) -> f64 {
    let mut damped = 0.0;
    for k in 0..D {
        let fall = if inverse[k] == 0.0 { 0.0 } else { gravity[k] };
        let driven = force[k] * inverse[k] + fall;
        let old = velocity[k];
        let new = old + 0.5 * h * (acceleration[k] + driven);
        (velocity[k], acceleration[k]) = (new, driven);
        if DAMPED {
            let new = new / (1.0 + 0.5 * h * damping[k]);
            (velocity[k], acceleration[k]) = (new, driven - damping[k] * new);
            damped += damping[k] * (old * old + new * new);
        }
    }
    damped
}

impl<const D: usize, L: Bonding, B: Binder<L>> Machine<D, L, B> {
    pub fn new(rig: &Rig<D>, binder: B, face_factor: f64, step: f64) -> Self {
        let bodies = Bodies::new(rig);
        let finder = Finder::new(rig);
        let contacts = Contacts::new(rig, face_factor);
        let (spheres, flats) = (rig.sample.spheres.len(), rig.flats.len());
        let turning = rig.laws.has_friction();
        Self {
            seen: bodies.displacement.clone(),
            flat_seen: bodies.flat_moved.clone(),
            trial: vec![[0.0; D]; spheres],
            trial_spin: Turns::still(if turning { spheres } else { 0 }),
            flat_trial: vec![[0.0; D]; flats],
            sums: Sums::new(spheres, flats),
            work_in: 0.0,
            absorbed: 0.0,
            at_hand: 0.0,
            turning,
            count: 0,
            loaded: acts::loaded(rig),
            acts: Vec::new(),
            bodies,
            contacts,
            binder,
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
        self.contacts.renew(rig, &self.finder, &self.bodies, &self.binder);
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
        let (velocity, spin, flat_velocity) = (&bodies.velocity, &bodies.spin, &bodies.flat_velocity);
        contacts.sweep(rig, bodies, Trial { velocity, spin, flat_velocity, step: 0.0 }, sums);
        for c in 0..contacts.len() {
            // What a squeezed contact stores at the start is no work of the motion.
            contacts.account.work[c] = contacts.normal_law(c).stored(contacts.account.overlap[c], &contacts.memory[c]);
        }
        // A kick of no length sets the accelerations alone.
        self.kick(rig, 0.0);
        self.move_clusters(rig, 0.0);
        let ledger = self.ledger(rig);
        self.work_in = ledger.kinetic + ledger.stored;
    }

    /// One accepted step.
    pub fn advance(&mut self, rig: &Rig<D>) {
        let h = self.step;
        self.plan_acts(rig);
        self.drift(h);
        self.apply_acts(rig, h);
        for (c, cluster) in rig.clusters.iter().enumerate() {
            let mut state = self.bodies.clusters[c];
            state.drift(rig, cluster, h, &mut self.bodies, &mut self.trial, &mut self.trial_spin);
            self.bodies.clusters[c] = state;
        }
        if self.has_strayed() {
            self.finder.allow(&self.trial, h);
            self.contacts.renew(rig, &self.finder, &self.bodies, &self.binder);
            self.seen.copy_from_slice(&self.bodies.displacement);
            self.flat_seen.copy_from_slice(&self.bodies.flat_moved);
        }
        let Self { bodies, contacts, sums, trial, trial_spin, flat_trial, .. } = self;
        contacts.sweep(
            rig,
            bodies,
            Trial { velocity: trial, spin: trial_spin, flat_velocity: flat_trial, step: h },
            sums,
        );
        self.kick(rig, h);
        self.finish_acts(rig, h);
        self.move_clusters(rig, h);
        self.count += 1;
    }

    /// Clusters take up the forces on their members, and the members their motion.
    fn move_clusters(&mut self, rig: &Rig<D>, h: f64) {
        for (c, cluster) in rig.clusters.iter().enumerate() {
            let mut state = self.bodies.clusters[c];
            state.kick(rig, cluster, h, &self.sums, &mut self.bodies);
            self.bodies.clusters[c] = state;
        }
    }

    fn drift(&mut self, h: f64) {
        let Bodies { displacement, velocity, acceleration, spin, spin_rate, .. } = &mut self.bodies;
        if displacement.len() < MANY {
            let rows = displacement.iter_mut().zip(&*velocity).zip(&*acceleration).zip(&mut self.trial);
            for (((displacement, velocity), acceleration), trial) in rows {
                drift(h, displacement, velocity, acceleration, trial);
            }
        } else {
            let rows = displacement.par_iter_mut().zip(velocity.par_iter()).zip(acceleration.par_iter());
            rows.zip(&mut self.trial).with_min_len(2048).for_each(
                |(((displacement, velocity), acceleration), trial)| {
                    drift(h, displacement, velocity, acceleration, trial);
                },
            );
        }
        if self.turning {
            let turn = |((trial, spin), rate): ((&mut f64, &f64), &f64)| *trial = spin + h * rate;
            let (trial, spin, rate) = (self.trial_spin.numbers_mut(), spin.numbers(), spin_rate.numbers());
            if spin.len() < MANY {
                trial.iter_mut().zip(spin).zip(rate).for_each(turn);
            } else {
                let rows = trial.par_iter_mut().zip(spin.par_iter()).zip(rate.par_iter());
                rows.with_min_len(2048).for_each(turn);
            }
        }
        let Bodies { flat_moved, flat_velocity, flat_acceleration, .. } = &mut self.bodies;
        for f in 0..flat_moved.len() {
            drift(h, &mut flat_moved[f], &flat_velocity[f], &flat_acceleration[f], &mut self.flat_trial[f]);
        }
    }

    /// Whether a body has moved so far that pairs may be near that were not when last looked for.
    fn has_strayed(&self) -> bool {
        let strayed = |now: &[f64; D], seen: &[f64; D], leeway: f64| {
            let mut squared = 0.0;
            for k in 0..D {
                squared += (now[k] - seen[k]) * (now[k] - seen[k]);
            }
            squared > leeway * leeway
        };
        let (bodies, seen, leeway) = (&self.bodies, &self.seen, &self.finder.leeway);
        let displacement = &bodies.displacement;
        // Mostly none has: without an early end the loop runs in vector registers.
        let spheres = |range: Range<usize>| {
            let (now, seen) = (&displacement[range.clone()], &seen[range.clone()]);
            let mut any = false;
            for ((now, seen), leeway) in now.iter().zip(seen).zip(&leeway[range]) {
                any |= strayed(now, seen, *leeway);
            }
            any
        };
        let count = leeway.len();
        let any = if count < MANY {
            spheres(0..count)
        } else {
            let parts = (0..count.div_ceil(8192)).into_par_iter();
            parts.any(|part| spheres(8192 * part..(8192 * (part + 1)).min(count)))
        };
        any || bodies.flat_moved.iter().zip(&self.flat_seen).any(|(now, seen)| strayed(now, seen, self.finder.common))
    }

    fn kick(&mut self, rig: &Rig<D>, h: f64) {
        let gravity = &rig.gravity;
        let Bodies { velocity, acceleration, inverse_mass, damping, spin, spin_rate, inverse_inertia, weight, .. } =
            &mut self.bodies;
        let force = &self.sums.force;
        let damped = !damping.is_empty();
        if velocity.len() < MANY || damped {
            let rows = velocity.iter_mut().zip(acceleration).zip(force).zip(&*inverse_mass);
            for (i, ((row, force), inverse)) in rows.enumerate() {
                if damped {
                    let lost = kick::<D, true>(h, row, force, inverse, gravity, &damping[i]);
                    self.absorbed += 0.5 * h * rig.mass[i] * weight[i] * lost;
                } else {
                    kick::<D, false>(h, row, force, inverse, gravity, &[0.0; D]);
                }
            }
        } else {
            let rows = velocity.par_iter_mut().zip(acceleration).zip(force).zip(inverse_mass.par_iter());
            rows.with_min_len(2048).for_each(|((row, force), inverse)| {
                kick::<D, false>(h, row, force, inverse, gravity, &[0.0; D]);
            });
        }
        if self.turning {
            type Row<'a> = (((&'a mut [f64], &'a mut [f64]), &'a [f64]), &'a f64);
            let turn = |(((spin, spin_rate), torque), inverse): Row| {
                for k in 0..Turns::<D>::AXES {
                    let rate = torque[k] * inverse;
                    spin[k] += 0.5 * h * (spin_rate[k] + rate);
                    spin_rate[k] = rate;
                }
            };
            // Chunks of none are no chunks.
            let axes = Turns::<D>::AXES.max(1);
            let (spin, spin_rate, torque) = (spin.numbers_mut(), spin_rate.numbers_mut(), self.sums.torque.numbers());
            if spin.len() < MANY {
                let rows = spin.chunks_exact_mut(axes).zip(spin_rate.chunks_exact_mut(axes));
                rows.zip(torque.chunks_exact(axes)).zip(&*inverse_inertia).for_each(turn);
            } else {
                let rows = spin.par_chunks_exact_mut(axes).zip(spin_rate.par_chunks_exact_mut(axes));
                let rows = rows.zip(torque.par_chunks_exact(axes)).zip(inverse_inertia.par_iter());
                rows.with_min_len(2048).for_each(turn);
            }
        }
        let whole = flat_weight(rig);
        let Bodies { flat_velocity, flat_acceleration, flat_inverse_mass, flat_damping, .. } = &mut self.bodies;
        for f in 0..flat_velocity.len() {
            let row = (&mut flat_velocity[f], &mut flat_acceleration[f]);
            let lost = kick::<D, true>(h, row, &self.sums.flat[f], &flat_inverse_mass[f], gravity, &flat_damping[f]);
            if lost > 0.0 {
                self.absorbed += 0.5 * h * rig.flats[f].mass * whole * lost;
            }
        }
    }
}

impl<const D: usize, L: Bonding, B: Binder<L>> Machine<D, L, B> {
    /// Draws the balance.
    pub fn ledger(&self, rig: &Rig<D>) -> EnergyLedger {
        let mut ledger = EnergyLedger {
            work_in: self.work_in,
            absorbed: self.absorbed,
            at_hand: self.at_hand,
            ..EnergyLedger::default()
        };
        let bodies = &self.bodies;
        for (state, cluster) in bodies.clusters.iter().zip(&rig.clusters) {
            ledger.kinetic += state.kinetic(cluster);
            ledger.potential -= cluster.mass * dot(&rig.gravity, &state.moved);
        }
        for i in (0..bodies.velocity.len()).filter(|&i| bodies.clustered[i].is_none()) {
            let mass = rig.mass[i] * bodies.weight[i];
            ledger.kinetic += 0.5 * mass * bodies.speed_squared(i);
            if self.turning {
                let spin = &bodies.spin.get(i);
                ledger.kinetic += 0.5 * rig.inertia[i] * bodies.weight[i] * dot(spin, spin);
            }
            for k in 0..D {
                if bodies.inverse_mass[i][k] > 0.0 {
                    ledger.potential -= mass * rig.gravity[k] * bodies.displacement[i][k];
                }
            }
        }
        let whole = flat_weight(rig);
        for (f, flat) in rig.flats.iter().enumerate().filter(|(_, flat)| flat.mass.is_finite()) {
            let velocity = &bodies.flat_velocity[f];
            ledger.kinetic += 0.5 * flat.mass * whole * dot(velocity, velocity);
            for k in 0..D {
                if bodies.flat_inverse_mass[f][k] > 0.0 {
                    ledger.potential -= flat.mass * whole * rig.gravity[k] * bodies.flat_moved[f][k];
                }
            }
        }
        let contacts = &self.contacts;
        let winds = contacts.winds();
        for c in 0..contacts.len() {
            let account = &contacts.account;
            let (work, slid, overlap) = (account.work[c], account.slid[c], account.overlap[c]);
            if work == 0.0 && slid == 0.0 && overlap == 0.0 {
                continue;
            }
            let stored = contacts.normal_law(c).stored(overlap, &contacts.memory[c]);
            let (weight, share) = (contacts.weight(c), contacts.share(c));
            ledger.stored += weight * stored;
            ledger.dissipated += weight * (work - stored);
            let wound = if winds { contacts.wound(c) } else { 0.0 };
            ledger.wound += share * wound;
            ledger.friction += share * (slid - wound);
        }
        for kept in contacts.kept_pairs.values().chain(contacts.kept_faces.values()) {
            ledger.dissipated += kept.weight * kept.work;
            ledger.friction += kept.share * kept.slid;
        }
        ledger.dissipated += contacts.lost[0];
        ledger.friction += contacts.lost[1];
        ledger.at_hand = ledger.at_hand.max(ledger.work_in - ledger.potential.min(0.0));
        ledger
    }

    /// Draws the balance, and remembers how much energy was at hand.
    pub fn look(&mut self, rig: &Rig<D>) -> EnergyLedger {
        let ledger = self.ledger(rig);
        self.at_hand = ledger.at_hand;
        ledger
    }
}

/// The part of each flat that is simulated: every mirror of a rig halves its flats.
fn flat_weight<const D: usize>(rig: &Rig<D>) -> f64 {
    0.5_f64.powi(rig.mirrors.len() as i32)
}
