//! What Adams's scheme adds to Verlet's, from the accelerations of the two states before: of all that moves, by the table of
//! coefficients that crystals use (`dem/step/multistep.rs`).
//!
//! Verlet's predictor and corrector have been applied when these are asked; with the table's zeros they would add nothing. Where bars
//! or drag answer the new velocity at a rate λ, so that the acceleration is b − λ v, the corrector stands in that implicit equation: what it adds is divided
//! by 1 + (1/2 − m₂ − m₃) h λ.

use std::ops::Range;

use super::motion::strayed;
use super::{Machine, flat_weight};
use crate::dem::Integrator;
use crate::dem::rig::Rig;
use crate::dem::rig::checkpoint::Accelerations;
use crate::dem::rig::cluster::Ahead;
use crate::dem::rig::contacts::Swept;
use crate::dem::rig::law::LawMaker;
use crate::dem::rig::spins::Spins;
use crate::dem::share::{cut, pieces};
use crate::dem::step::Coefficients;

/// Accelerations of the last three states, all numbers of all bodies of a kind in a row.
#[derive(Clone, Debug, Default)]
struct Track {
    now: Vec<f64>,
    one: Vec<f64>,
    two: Vec<f64>,
}

impl Track {
    /// Before the start they were what they are at it: those of a crystal at rest are zero, those of a fall the fall's.
    fn new(now: &[f64]) -> Self {
        Self { now: now.to_vec(), one: now.to_vec(), two: now.to_vec() }
    }

    /// What is added to a displacement over h, and to a predicted velocity, of the n-th number.
    #[inline(always)]
    fn ahead(&self, table: &Coefficients, n: usize, now: f64) -> [f64; 2] {
        let first = now - self.one[n];
        let second = first - (self.one[n] - self.two[n]);
        let of = |[a, b]: [f64; 2]| a * first + b * second;
        [of(table.displacement), of(table.velocity)]
    }

    /// What is added to a new velocity under a new acceleration, without damping.
    #[inline(always)]
    fn behind(&self, table: &Coefficients, n: usize, new: f64) -> f64 {
        let (now, one, two) = (self.now[n], self.one[n], self.two[n]);
        let (first, before, earlier) = (new - now, now - one, one - two);
        let second = first - before;
        let third = second - (before - earlier);
        let [m2, m3] = table.corrector;
        -(m2 * second + m3 * third)
    }

    /// The step is over.
    fn accept(&mut self) {
        std::mem::swap(&mut self.two, &mut self.one);
        std::mem::swap(&mut self.one, &mut self.now);
    }
}

/// The accelerations of a rig's last states, and the scheme that asks for them.
#[derive(Clone, Debug)]
pub(in crate::dem::rig) struct Past {
    table: Coefficients,
    spheres: Track,
    spins: Track,
    flats: Track,
    clusters: Track,
}

impl Past {
    /// What a run that is taken up needs besides its bodies' state.
    pub fn accelerations(&self) -> Accelerations {
        let of = |track: &Track| [track.one.clone(), track.two.clone()];
        Accelerations {
            spheres: of(&self.spheres),
            spins: of(&self.spins),
            flats: of(&self.flats),
            clusters: of(&self.clusters),
        }
    }

    /// Takes these up again; whether they fit.
    pub fn restore(&mut self, from: &Accelerations) -> bool {
        let tracks = [
            (&mut self.spheres, &from.spheres),
            (&mut self.spins, &from.spins),
            (&mut self.flats, &from.flats),
            (&mut self.clusters, &from.clusters),
        ];
        let fits = |(track, [one, two]): &(&mut Track, &[Vec<f64>; 2])| {
            track.one.len() == one.len() && track.two.len() == two.len()
        };
        let all = tracks.iter().all(fits);
        if all {
            for (track, [one, two]) in tracks {
                track.one.copy_from_slice(one);
                track.two.copy_from_slice(two);
            }
        }
        all
    }

    /// What is added to a cluster's drift.
    pub fn cluster_ahead<const D: usize>(&mut self, c: usize, acceleration: &[f64; D], spin_rate: f64) -> Ahead<D> {
        let mut ahead = Ahead::default();
        for (k, &now) in acceleration.iter().enumerate() {
            let n = c * (D + 1) + k;
            [ahead.moved[k], ahead.velocity[k]] = self.clusters.ahead(&self.table, n, now);
            self.clusters.now[n] = now;
        }
        let n = c * (D + 1) + D;
        [ahead.angle, ahead.spin] = self.clusters.ahead(&self.table, n, spin_rate);
        self.clusters.now[n] = spin_rate;
        ahead
    }

    /// What is added to the k-th component of a cluster's new velocity, the last of which is its spin.
    pub fn cluster_behind<const D: usize>(&self, c: usize, k: usize, new: f64) -> f64 {
        self.clusters.behind(&self.table, c * (D + 1) + k, new)
    }

    /// All bodies have their new velocities.
    pub fn accept(&mut self) {
        [&mut self.spheres, &mut self.spins, &mut self.flats, &mut self.clusters].into_iter().for_each(Track::accept);
    }
}

impl<const D: usize, L: Swept<D>, B: LawMaker<L>> Machine<D, L, B> {
    /// Goes on by a scheme from here. Verlet remembers nothing; Runge-Kutta's, which a rig does not know, is refused before.
    pub fn go_by(&mut self, integrator: Integrator) {
        self.past = (integrator == Integrator::Adams).then(|| Past {
            table: Coefficients::of(integrator, self.step),
            spheres: Track::new(self.bodies.acceleration.as_flattened()),
            spins: Track::new(if self.turning { self.bodies.spin_rate.numbers() } else { &[] }),
            flats: Track::new(self.bodies.flat_acceleration.as_flattened()),
            clusters: Track::new(
                &(self.bodies.clusters.iter())
                    .flat_map(|state| state.acceleration.into_iter().chain([state.spin_rate]))
                    .collect::<Vec<f64>>(),
            ),
        });
        if self.past.is_some() {
            // What Verlet holds back Adams does not.
            self.held_back = 0.0;
        }
    }

    /// After Verlet's drift; whether a sphere has moved farther than its skin now.
    pub(super) fn drift_by_past(&mut self, h: f64) -> bool {
        let Some(past) = &mut self.past else { return false };
        let bodies = &mut self.bodies;
        let Past { table, spheres, spins, flats, .. } = past;
        {
            let (track, now) = (&*spheres, bodies.acceleration.as_flattened());
            let count = bodies.displacement.len();
            let (mut displacements, mut predicted) =
                (bodies.displacement.as_flattened_mut(), self.predicted.as_flattened_mut());
            let take = |range: Range<usize>| {
                let numbers = D * range.len();
                (cut(&mut displacements, numbers), cut(&mut predicted, numbers), D * range.start)
            };
            pieces(count, take, |(displacement, predicted, from)| {
                for (m, (displacement, predicted)) in displacement.iter_mut().zip(predicted).enumerate() {
                    let [moved, velocity] = track.ahead(table, from + m, now[from + m]);
                    *displacement += h * moved;
                    *predicted += velocity;
                }
            });
            spheres.now.copy_from_slice(bodies.acceleration.as_flattened());
        }
        if !spins.now.is_empty() {
            let row = Spins::<D>::ROW;
            let (rates, lever) = (bodies.spin_rate.numbers(), &self.contacts.lever);
            for (n, turn) in self.predicted_turn.numbers_mut().iter_mut().enumerate() {
                *turn += lever[n / row] * spins.ahead(table, n, rates[n])[1];
            }
            spins.now.copy_from_slice(rates);
        }
        let now = bodies.flat_acceleration.as_flattened();
        let moved = bodies.flat_moved.as_flattened_mut();
        for (n, (moved, predicted)) in moved.iter_mut().zip(self.predicted_flat.as_flattened_mut()).enumerate() {
            let [way, velocity] = flats.ahead(table, n, now[n]);
            *moved += h * way;
            *predicted += velocity;
        }
        flats.now.copy_from_slice(now);
        let rows = bodies.displacement.iter().zip(&self.seen).zip(&self.finder.skin);
        rows.into_iter().any(|((now, seen), skin)| strayed(now, seen, *skin))
    }

    /// After Verlet's kick.
    pub(super) fn kick_by_past(&mut self, rig: &Rig<D>, h: f64) {
        let Some(past) = &mut self.past else { return };
        let bodies = &mut self.bodies;
        let Past { table, spheres, spins, flats, .. } = past;
        let implicit = 0.5 * h - table.corrector.iter().sum::<f64>();
        // New velocity and acceleration of one number, damped at a rate; Δ(v²).
        let correct = |velocity: &mut f64, acceleration: &mut f64, added: f64, rate: f64| {
            let added = added / (1.0 + implicit * rate);
            let old = *velocity;
            *velocity += added;
            *acceleration -= rate * added;
            *velocity * *velocity - old * old
        };
        let (track, damping, weight) = (&*spheres, &bodies.damping, &bodies.weight);
        let count = bodies.velocity.len();
        let (mut velocities, mut accelerations) = (&mut bodies.velocity[..], &mut bodies.acceleration[..]);
        let take = |range: Range<usize>| {
            (cut(&mut velocities, range.len()), cut(&mut accelerations, range.len()), range.start)
        };
        let absorbed = pieces(count, take, |(velocity, acceleration, from)| {
            let mut absorbed = 0.0;
            for (m, (velocity, acceleration)) in velocity.iter_mut().zip(acceleration).enumerate() {
                let i = from + m;
                let rates = damping.get(i).copied().unwrap_or([0.0; D]);
                for k in 0..D {
                    let added = track.behind(table, D * i + k, acceleration[k]);
                    let more = correct(&mut velocity[k], &mut acceleration[k], added, rates[k]);
                    absorbed += 0.5 * h * rig.mass[i] * weight[i] * rates[k] * more;
                }
            }
            absorbed
        });
        self.absorbed += absorbed.iter().sum::<f64>();
        if !spins.now.is_empty() {
            let rates = bodies.spin_rate.numbers();
            for (n, spin) in bodies.spin.numbers_mut().iter_mut().enumerate() {
                *spin += spins.behind(table, n, rates[n]);
            }
        }
        let whole = flat_weight(rig);
        for f in 0..bodies.flat_velocity.len() {
            for k in 0..D {
                let rate = bodies.flat_damping[f][k];
                let (velocity, acceleration) = (&mut bodies.flat_velocity[f][k], &mut bodies.flat_acceleration[f][k]);
                let added = flats.behind(table, D * f + k, *acceleration);
                let more = correct(velocity, acceleration, added, rate);
                if rate > 0.0 {
                    self.absorbed += 0.5 * h * rig.flats[f].mass * whole * rate * more;
                }
            }
        }
    }
}
