//! What loads do to bodies during a step: forces, prescribed velocities, pulses that come in along bars.

use std::collections::HashMap;

use super::{Machine, flat_weight};
use crate::dem::rig::contacts::{Excess, Swept};
use crate::dem::rig::law::LawMaker;
use crate::dem::rig::{Body, LoadKind, Rig};

/// What loads do to a body during a step.
pub struct Act<const D: usize> {
    pub body: Body,
    /// Mean force (N).
    force: [f64; D],
    /// Displacement during the step and velocity at its end, where they are prescribed.
    prescribed: Option<[[f64; D]; 2]>,
    /// Displacement, velocity and contact force before the step.
    from: [f64; D],
    velocity: [f64; D],
    resisting: [f64; D],
}

/// A body, and the loads and bars with incoming pulses that act on it, by their places in the rig.
pub struct Loaded {
    body: Body,
    loads: Vec<usize>,
    bars: Vec<usize>,
}

/// The bodies on which anything acts, in the order in which the rig names them.
pub fn loaded<const D: usize>(rig: &Rig<D>) -> Vec<Loaded> {
    let mut all: Vec<Loaded> = Vec::new();
    let mut place: HashMap<Body, usize> = HashMap::new();
    let mut of = |all: &mut Vec<Loaded>, body| {
        *place.entry(body).or_insert_with(|| {
            all.push(Loaded { body, loads: Vec::new(), bars: Vec::new() });
            all.len() - 1
        })
    };
    for (k, load) in rig.loads.iter().enumerate() {
        for &body in &load.bodies {
            let place = of(&mut all, body);
            let loads = &mut all[place].loads;
            // A body that a load names twice feels it once.
            if loads.last() != Some(&k) {
                loads.push(k);
            }
        }
    }
    for (k, bar) in rig.bars.iter().enumerate().filter(|(_, bar)| bar.incident.is_some()) {
        let place = of(&mut all, bar.body);
        all[place].bars.push(k);
    }
    all
}

impl<const D: usize, L: Swept<D>, B: LawMaker<L>> Machine<D, L, B> {
    /// What loads do during the step that begins now.
    pub fn plan_acts(&mut self, rig: &Rig<D>) {
        self.acts.clear();
        let (from, to) = (self.time(), (self.count + 1) as f64 * self.step);
        let nearly = 1e-9 * self.step;
        for Loaded { body, loads, bars } in &self.loaded {
            let body = *body;
            let bodies = &self.bodies;
            let (from_place, velocity, resisting) = match body {
                Body::Sphere(i) => (bodies.displacement[i], bodies.velocity[i], self.sums.force[i]),
                Body::Flat(f) => (bodies.flat_moved[f], bodies.flat_velocity[f], self.sums.flat[f]),
            };
            let mut act = Act { body, force: [0.0; D], prescribed: None, from: from_place, velocity, resisting };
            let mut acts = false;
            for load in loads.iter().map(|&k| &rig.loads[k]) {
                let curve = &load.curve;
                if load.kind == LoadKind::Force {
                    // A pulse that ends within a billionth of a step of its end has ended.
                    let mean = if from > curve.end() - nearly { 0.0 } else { curve.mean(from, to) };
                    acts |= mean != 0.0;
                    for k in 0..D {
                        act.force[k] += load.direction[k] * mean;
                    }
                } else if from < curve.end() - nearly {
                    acts = true;
                    let [moved, velocity] = act.prescribed.get_or_insert([[0.0; D]; 2]);
                    let last = to.min(curve.end());
                    // Where the curve ends within the step the velocity it ended with holds to the step's end.
                    let end_speed = curve.value(last - nearly);
                    let way = curve.integral(last) - curve.integral(from) + end_speed * (to - last);
                    for k in 0..D {
                        moved[k] += load.direction[k] * way;
                        velocity[k] += load.direction[k] * end_speed;
                    }
                }
            }
            for bar in bars.iter().map(|&k| &rig.bars[k]) {
                if let Some(curve) = &bar.incident {
                    let mean = 2.0 * curve.mean(from, to);
                    acts |= mean != 0.0;
                    act.force[bar.axis] += mean;
                }
            }
            if acts {
                self.acts.push(act);
            }
        }
    }

    /// Moves loaded bodies on.
    pub fn apply_acts(&mut self, rig: &Rig<D>, h: f64) {
        for act in &self.acts {
            let (displacement, predicted, inverse, weight) = match act.body {
                Body::Sphere(i) => (
                    &mut self.bodies.displacement[i],
                    &mut self.predicted[i],
                    // A load acts on the whole sphere, of which the rig may hold a part.
                    self.bodies.inverse_mass[i].map(|inverse| inverse * self.bodies.weight[i]),
                    self.bodies.weight[i],
                ),
                Body::Flat(f) => {
                    let weight = flat_weight(rig);
                    let inverse = self.bodies.flat_inverse_mass[f].map(|inverse| inverse * weight);
                    (&mut self.bodies.flat_moved[f], &mut self.predicted_flat[f], inverse, weight)
                }
            };
            if let Some([moved, velocity]) = act.prescribed {
                for k in 0..D {
                    displacement[k] = act.from[k] + moved[k];
                }
                *predicted = velocity;
                continue;
            }
            for k in 0..D {
                let push = act.force[k] * inverse[k];
                displacement[k] += 0.5 * h * h * push;
                predicted[k] += h * push;
                self.work_in += weight * act.force[k] * (displacement[k] - act.from[k]);
            }
        }
    }

    /// Impulses of contacts that began or ended within the step, as if they had stood in the implicit equation of the new velocity.
    pub fn give_impulses(&mut self, rig: &Rig<D>, h: f64, impulses: &[Excess<D>]) {
        for Excess { body, force } in impulses {
            if let Some(Act { prescribed: Some([moved, _]), .. }) = self.acts.iter().find(|act| act.body == *body) {
                self.work_in -= (0..D).map(|k| force[k] * moved[k]).sum::<f64>();
                continue;
            }
            let bodies = &mut self.bodies;
            let (velocity, acceleration, inverse, rates, mass) = match *body {
                Body::Sphere(i) => (
                    &mut bodies.velocity[i],
                    &mut bodies.acceleration[i],
                    &bodies.inverse_mass[i],
                    bodies.damping.get(i).copied().unwrap_or([0.0; D]),
                    rig.mass[i] * bodies.weight[i],
                ),
                Body::Flat(f) => (
                    &mut bodies.flat_velocity[f],
                    &mut bodies.flat_acceleration[f],
                    &bodies.flat_inverse_mass[f],
                    bodies.flat_damping[f],
                    rig.flats[f].mass * flat_weight(rig),
                ),
            };
            for k in 0..D {
                let gained = h * force[k] * inverse[k] / (1.0 + 0.5 * h * rates[k]);
                if rates[k] > 0.0 {
                    let (old, new) = (velocity[k], velocity[k] + gained);
                    self.absorbed += 0.5 * h * mass * rates[k] * (new * new - old * old);
                    acceleration[k] -= rates[k] * gained;
                }
                velocity[k] += gained;
            }
        }
    }

    /// The impulse of loads; and prescribed velocities, which hold whatever the forces: what they cost is work put in.
    pub fn finish_acts(&mut self, rig: &Rig<D>, h: f64) {
        for act in &self.acts {
            let Some([moved, velocity]) = act.prescribed else {
                let bodies = &mut self.bodies;
                let (velocity, acceleration, inverse, rates, weight, mass) = match act.body {
                    Body::Sphere(i) => (
                        &mut bodies.velocity[i],
                        &mut bodies.acceleration[i],
                        &bodies.inverse_mass[i],
                        bodies.damping.get(i).copied().unwrap_or([0.0; D]),
                        bodies.weight[i],
                        rig.mass[i],
                    ),
                    Body::Flat(f) => (
                        &mut bodies.flat_velocity[f],
                        &mut bodies.flat_acceleration[f],
                        &bodies.flat_inverse_mass[f],
                        bodies.flat_damping[f],
                        flat_weight(rig),
                        rig.flats[f].mass,
                    ),
                };
                for k in 0..D {
                    // As if it had stood in the implicit equation of the new velocity.
                    let gained = h * act.force[k] * inverse[k] * weight / (1.0 + 0.5 * h * rates[k]);
                    if rates[k] > 0.0 {
                        let (old, new) = (velocity[k], velocity[k] + gained);
                        self.absorbed += 0.5 * h * mass * weight * rates[k] * (new * new - old * old);
                        acceleration[k] -= rates[k] * gained;
                    }
                    velocity[k] += gained;
                }
                continue;
            };
            let (now, resisting, mass) = match act.body {
                Body::Sphere(i) => {
                    (&mut self.bodies.velocity[i], &self.sums.force[i], rig.mass[i] * self.bodies.weight[i])
                }
                Body::Flat(f) => {
                    (&mut self.bodies.flat_velocity[f], &self.sums.flat[f], rig.flats[f].mass * flat_weight(rig))
                }
            };
            for k in 0..D {
                self.work_in -= 0.5 * (act.resisting[k] + resisting[k]) * moved[k];
                if mass.is_finite() {
                    self.work_in += 0.5 * mass * (velocity[k] * velocity[k] - act.velocity[k] * act.velocity[k]);
                    self.work_in -= mass * rig.gravity[k] * moved[k];
                }
            }
            *now = velocity;
        }
    }
}
