//! How bodies move during a step: the drift before forces are known, and the kick after.

use std::ops::Range;

use super::{Machine, flat_weight};
use crate::dem::rig::bodies::Bodies;
use crate::dem::rig::contacts::Swept;
use crate::dem::rig::law::LawMaker;
use crate::dem::rig::spins::Spins;
use crate::dem::rig::{Body, Rig};
use crate::dem::share::{cut, pieces};

/// Moves a body on by a step, and predicts its velocity.
#[inline(always)]
fn drift<const D: usize>(
    h: f64,
    displacement: &mut [f64; D],
    velocity: &[f64; D],
    acceleration: &[f64; D],
    predicted: &mut [f64; D],
) {
    for k in 0..D {
        displacement[k] += h * (velocity[k] + 0.5 * h * acceleration[k]);
        predicted[k] = velocity[k] + h * acceleration[k];
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

/// Whether a body has moved farther than its skin since near pairs were last looked for.
#[inline(always)]
pub(super) fn strayed<const D: usize>(now: &[f64; D], seen: &[f64; D], skin: f64) -> bool {
    let mut squared = 0.0;
    for k in 0..D {
        squared += (now[k] - seen[k]) * (now[k] - seen[k]);
    }
    squared > skin * skin
}

impl<const D: usize, L: Swept<D>, B: LawMaker<L>> Machine<D, L, B> {
    /// Moves all bodies on and predicts their velocities; whether a sphere has moved so far that pairs may be near that were not when
    /// last looked for.
    pub(super) fn drift(&mut self, h: f64) -> bool {
        let Bodies { displacement, velocity, acceleration, spin, spin_rate, .. } = &mut self.bodies;
        let (seen, skin, lever) = (&self.seen, &self.finder.skin, &self.contacts.lever);
        let axes = if self.turning { Spins::<D>::AXES } else { 0 };
        let count = displacement.len();
        let (mut displacements, mut predicted) = (&mut displacement[..], &mut self.predicted[..]);
        let mut turns = self.predicted_turn.numbers_mut();
        let take = |range: Range<usize>| {
            let turn = cut(&mut turns, axes * range.len());
            (cut(&mut displacements, range.len()), cut(&mut predicted, range.len()), turn, range)
        };
        let any = pieces(count, take, |(displacement, predicted, turn, range)| {
            let rows =
                displacement.iter_mut().zip(&velocity[range.clone()]).zip(&acceleration[range.clone()]).zip(predicted);
            for (((displacement, velocity), acceleration), predicted) in rows {
                drift(h, displacement, velocity, acceleration, predicted);
            }
            if axes > 0 {
                let row = Spins::<D>::ROW;
                let numbers = axes * range.start..axes * range.end;
                let rows = turn.chunks_exact_mut(row).zip(spin.numbers()[numbers.clone()].chunks_exact(row));
                let rows = rows.zip(spin_rate.numbers()[numbers].chunks_exact(row)).zip(&lever[range.clone()]);
                for (((turn, spin), rate), lever) in rows {
                    for k in 0..row {
                        turn[k] = lever * (spin[k] + h * rate[k]);
                    }
                }
            }
            // Mostly none has: without an early end the loop runs in vector registers.
            let mut any = false;
            for ((now, seen), skin) in displacement.iter().zip(&seen[range.clone()]).zip(&skin[range]) {
                any |= strayed(now, seen, *skin);
            }
            any
        });
        let Bodies { flat_moved, flat_velocity, flat_acceleration, .. } = &mut self.bodies;
        for f in 0..flat_moved.len() {
            drift(h, &mut flat_moved[f], &flat_velocity[f], &flat_acceleration[f], &mut self.predicted_flat[f]);
        }
        any.contains(&true)
    }

    /// As what [`drift`](Self::drift) gives, of what else has moved since: loaded bodies, clusters, flats.
    pub(super) fn driven_strayed(&self, rig: &Rig<D>) -> bool {
        let members = rig.clusters.iter().flat_map(|cluster| cluster.members.iter().copied());
        let loaded = self.acts.iter().filter_map(|act| match act.body {
            Body::Sphere(i) => Some(i),
            Body::Flat(_) => None,
        });
        let (bodies, skin) = (&self.bodies, &self.finder.skin);
        members.chain(loaded).any(|i| strayed(&bodies.displacement[i], &self.seen[i], skin[i]))
            || bodies.flat_moved.iter().zip(&self.flat_seen).any(|(now, seen)| strayed(now, seen, self.finder.common))
    }

    /// Gives all bodies their new velocities under the present forces.
    pub(super) fn kick(&mut self, rig: &Rig<D>, h: f64) {
        let gravity = &rig.gravity;
        let Bodies { velocity, acceleration, inverse_mass, damping, spin, spin_rate, inverse_inertia, weight, .. } =
            &mut self.bodies;
        let (force, torque) = (&self.sums.force, self.sums.torque.numbers());
        let axes = if self.turning { Spins::<D>::AXES } else { 0 };
        let count = velocity.len();
        let (mut velocities, mut accelerations) = (&mut velocity[..], &mut acceleration[..]);
        let (mut spins, mut rates) = (spin.numbers_mut(), spin_rate.numbers_mut());
        let take = |range: Range<usize>| {
            let spin = (cut(&mut spins, axes * range.len()), cut(&mut rates, axes * range.len()));
            (cut(&mut velocities, range.len()), cut(&mut accelerations, range.len()), spin, range)
        };
        let absorbed = pieces(count, take, |(velocity, acceleration, (spin, rate), range)| {
            let rows = velocity.iter_mut().zip(acceleration);
            let rows = rows.zip(&force[range.clone()]).zip(&inverse_mass[range.clone()]);
            let mut absorbed = 0.0;
            if damping.is_empty() {
                for ((row, force), inverse) in rows {
                    kick::<D, false>(h, row, force, inverse, gravity, &[0.0; D]);
                }
            } else {
                for (((row, force), inverse), i) in rows.zip(range.clone()) {
                    let lost = kick::<D, true>(h, row, force, inverse, gravity, &damping[i]);
                    absorbed += 0.5 * h * rig.mass[i] * weight[i] * lost;
                }
            }
            if axes > 0 {
                let row = Spins::<D>::ROW;
                let rows = spin.chunks_exact_mut(row).zip(rate.chunks_exact_mut(row));
                let rows = rows.zip(torque[axes * range.start..axes * range.end].chunks_exact(row));
                for (((spin, rate), torque), inverse) in rows.zip(&inverse_inertia[range]) {
                    for k in 0..row {
                        let new = torque[k] * inverse;
                        spin[k] += 0.5 * h * (rate[k] + new);
                        rate[k] = new;
                    }
                }
            }
            absorbed
        });
        for part in absorbed {
            self.absorbed += part;
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
