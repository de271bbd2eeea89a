//! What each sphere of a rig felt at most, and when it was first reached.

use serde::{Deserialize, Serialize};

use super::bodies::{Bodies, dot};
use super::checkpoint::PeaksSoFar;
use super::contacts::Sums;
use crate::dem::arrival::{ArrivalTracker, Grain};

/// When a sphere counts as reached.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Arrival {
    /// Its speed is this part of its own greatest.
    OwnMaximum(f64),
    /// Its speed is this part of the first sphere's greatest (Burgoyne 2016, section 2.1.2, with 0.01).
    FirstSphere(f64),
    /// Its speed (m/s).
    Speed(f64),
    /// How far it has moved (m).
    Displacement(f64),
}

impl Arrival {
    /// Whether it is known at once that a sphere is reached, without waiting for a greatest speed.
    pub fn is_absolute(self) -> bool {
        matches!(self, Self::Speed(_) | Self::Displacement(_))
    }
}

/// So many spheres ahead memory is asked for their earlier speeds, which lie anywhere.
const AHEAD: usize = 12;

/// Greatest speeds and forces over accepted steps, and first arrivals.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Peaks {
    pub arrivals: Vec<Arrival>,
    /// (m²/s²)
    pub speed_squared: Vec<f64>,
    /// Square of the net force of contacts (N²).
    pub force_squared: Vec<f64>,
    pub trackers: Vec<ArrivalTracker>,
    grain: Grain,
    /// The least parts of the own and of the first sphere's maximum that are asked for; infinite where none is.
    own: f64,
    of_first: f64,
    /// Per threshold that is known from the start and sphere the first time it was passed (s), NaN before.
    pub passed: Vec<Vec<f64>>,
    /// Squared displacement one accepted step before (m²), where any displacement is a threshold.
    pub moved_before: Vec<f64>,
}

/// Square of the net contact force (N²) on the whole of a sphere, also where only a part of it is simulated.
pub(super) fn net_force_squared<const D: usize>(i: usize, bodies: &Bodies<D>, sums: &Sums<D>) -> f64 {
    // Across a mirror that a sphere lies on its other half pushes back.
    let part = bodies.weight[i];
    let peaks = |k: usize| if part < 1.0 && bodies.inverse_mass[i][k] == 0.0 { 0.0 } else { sums.force[i][k] / part };
    let force: [f64; D] = std::array::from_fn(peaks);
    dot(&force, &force)
}

impl Peaks {
    pub fn new(spheres: usize, arrivals: Vec<Arrival>) -> Self {
        let (mut own, mut of_first, mut moves) = (f64::INFINITY, f64::INFINITY, false);
        for arrival in &arrivals {
            match *arrival {
                Arrival::OwnMaximum(part) => own = own.min(part),
                Arrival::FirstSphere(part) => of_first = of_first.min(part),
                Arrival::Speed(_) => {}
                Arrival::Displacement(_) => moves = true,
            }
        }
        let absolute = arrivals.iter().filter(|arrival| arrival.is_absolute()).count();
        Self {
            arrivals,
            speed_squared: vec![0.0; spheres],
            force_squared: vec![0.0; spheres],
            trackers: vec![ArrivalTracker::default(); spheres],
            grain: Grain::of(spheres, own.min(of_first)),
            own,
            of_first,
            passed: vec![vec![f64::NAN; spheres]; absolute],
            moved_before: vec![0.0; if moves { spheres } else { 0 }],
        }
    }

    /// Looks at the spheres after so many accepted steps; those with a speed at time zero are seen from then on.
    pub fn accepted<const D: usize>(&mut self, steps: u64, step: f64, bodies: &Bodies<D>, sums: &Sums<D>) {
        let first = self.speed_squared.first().copied().unwrap_or(0.0).sqrt();
        let time = steps as f64 * step;
        let absolute = self.arrivals.iter().filter(|arrival| arrival.is_absolute());
        for (arrival, times) in absolute.zip(&mut self.passed) {
            for (i, passed) in times.iter_mut().enumerate().filter(|(_, passed)| passed.is_nan()) {
                // Each as it was always rounded.
                match *arrival {
                    Arrival::Displacement(threshold) => {
                        let displacement = &bodies.displacement[i];
                        let (before, now) = (self.moved_before[i].sqrt(), dot(displacement, displacement).sqrt());
                        if now >= threshold {
                            *passed = time - step * (now - threshold) / (now - before);
                        }
                    }
                    Arrival::Speed(threshold) => {
                        let (before, now) = (self.trackers[i].previous, bodies.speed_squared(i).sqrt());
                        if now >= threshold {
                            *passed = time - step * (1.0 - (threshold - before) / (now - before));
                        }
                    }
                    Arrival::OwnMaximum(_) | Arrival::FirstSphere(_) => {}
                }
            }
        }
        let is_asked = self.own.min(self.of_first) < f64::INFINITY;
        for i in 0..self.trackers.len() {
            if let Some(tracker) = self.trackers.get(i + AHEAD) {
                tracker.fetch();
            }
            let speed_squared = bodies.speed_squared(i);
            let is_maximum = speed_squared > self.speed_squared[i];
            if is_maximum {
                self.speed_squared[i] = speed_squared;
            }
            let speed = speed_squared.sqrt();
            // The least speed that any threshold can still ask for.
            let floor = (self.own * speed).min(self.of_first * first);
            self.trackers[i].push(steps, speed, is_maximum && is_asked, floor, self.grain);
            self.force_squared[i] = net_force_squared(i, bodies, sums).max(self.force_squared[i]);
        }
        for (before, moved) in self.moved_before.iter_mut().zip(&bodies.displacement) {
            *before = dot(moved, moved);
        }
    }

    /// First arrivals (s) by the k-th threshold, with the step by which the run advanced.
    pub fn arrivals(&self, k: usize, step: f64) -> Vec<Option<f64>> {
        let first = self.trackers.first().and_then(ArrivalTracker::maximum);
        let of = |tracker: &ArrivalTracker| match self.arrivals[k] {
            Arrival::OwnMaximum(part) => tracker.arrival(step, part * tracker.maximum()?),
            Arrival::FirstSphere(part) => tracker.arrival(step, part * first?),
            Arrival::Speed(_) | Arrival::Displacement(_) => None,
        };
        if self.arrivals[k].is_absolute() {
            let place = self.arrivals[..k].iter().filter(|arrival| arrival.is_absolute()).count();
            return self.passed[place].iter().map(|&time| (!time.is_nan()).then_some(time)).collect();
        }
        self.trackers.iter().map(of).collect()
    }

    /// For a checkpoint.
    pub fn so_far(&self) -> PeaksSoFar {
        PeaksSoFar {
            arrivals: self.arrivals.clone(),
            speed_squared: self.speed_squared.clone(),
            force_squared: self.force_squared.clone(),
            passed: self.passed.clone(),
            moved_before: self.moved_before.clone(),
            trackers: self.trackers.clone(),
        }
    }

    /// Takes them up from a checkpoint; false if they are not of these spheres and arrivals.
    pub fn restore(&mut self, from: PeaksSoFar) -> bool {
        let fits = self.arrivals == from.arrivals
            && self.speed_squared.len() == from.speed_squared.len()
            && self.force_squared.len() == from.force_squared.len()
            && self.moved_before.len() == from.moved_before.len()
            && self.trackers.len() == from.trackers.len()
            && self.passed.len() == from.passed.len()
            && self.passed.iter().zip(&from.passed).all(|(a, b)| a.len() == b.len());
        if fits {
            let PeaksSoFar { arrivals, speed_squared, force_squared, passed, moved_before, trackers } = from;
            *self = Self { speed_squared, force_squared, passed, moved_before, trackers, arrivals, ..*self };
        }
        fits
    }
}
