//! What each sphere of a rig felt at most, and when it was first reached.

use super::bodies::{Bodies, dot};
use super::checkpoint::PeaksSoFar;
use super::contacts::Sums;
use crate::dem::record::ArrivalTracker;

/// When a sphere counts as reached.
#[derive(Clone, Copy, Debug, PartialEq)]
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

/// Greatest speeds and forces over accepted steps, and first arrivals.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Peaks {
    pub arrivals: Vec<Arrival>,
    /// (m²/s²)
    pub speed_squared: Vec<f64>,
    /// Square of the net force of contacts (N²).
    pub force_squared: Vec<f64>,
    pub trackers: Vec<ArrivalTracker>,
    /// Per displacement threshold and sphere the first time it was passed (s), NaN before.
    pub moved: Vec<Vec<f64>>,
    /// Squared displacement one accepted step before (m²).
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
        let thresholds = arrivals.iter().filter(|arrival| matches!(arrival, Arrival::Displacement(_))).count();
        Self {
            arrivals,
            speed_squared: vec![0.0; spheres],
            force_squared: vec![0.0; spheres],
            trackers: vec![ArrivalTracker::default(); spheres],
            moved: vec![vec![f64::NAN; spheres]; thresholds],
            moved_before: vec![0.0; if thresholds > 0 { spheres } else { 0 }],
        }
    }

    /// Looks at the spheres after an accepted step; those with a speed at time zero are seen from then on.
    pub fn accepted<const D: usize>(&mut self, time: f64, step: f64, bodies: &Bodies<D>, sums: &Sums<D>) {
        let first = self.speed_squared.first().copied().unwrap_or(0.0).sqrt();
        // The least speed that any threshold can still ask for, as a part of the own and of the first sphere's maximum.
        let (mut own, mut of_first, mut fixed) = (1.0_f64, f64::INFINITY, f64::INFINITY);
        for arrival in &self.arrivals {
            match *arrival {
                Arrival::OwnMaximum(part) => own = own.min(part),
                Arrival::FirstSphere(part) => of_first = of_first.min(part),
                Arrival::Speed(speed) => fixed = fixed.min(speed),
                Arrival::Displacement(_) => {}
            }
        }
        for i in 0..self.trackers.len() {
            let speed_squared = bodies.speed_squared(i);
            let is_maximum = speed_squared > self.speed_squared[i];
            if is_maximum {
                self.speed_squared[i] = speed_squared;
            }
            let speed = speed_squared.sqrt();
            let floor = (own * speed).min(of_first * first).min(fixed);
            self.trackers[i].push(time, speed, is_maximum, floor);
            self.force_squared[i] = net_force_squared(i, bodies, sums).max(self.force_squared[i]);
        }
        if self.moved_before.is_empty() {
            return;
        }
        let thresholds = self.arrivals.iter().filter_map(|arrival| match arrival {
            Arrival::Displacement(moved) => Some(*moved),
            _ => None,
        });
        for (threshold, times) in thresholds.zip(&mut self.moved) {
            for i in 0..times.len() {
                let moved = dot(&bodies.displacement[i], &bodies.displacement[i]).sqrt();
                if times[i].is_nan() && moved >= threshold {
                    let before = self.moved_before[i].sqrt();
                    times[i] = time - step * (moved - threshold) / (moved - before);
                }
            }
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
            Arrival::Speed(speed) => tracker.arrival(step, speed),
            Arrival::Displacement(_) => None,
        };
        if matches!(self.arrivals[k], Arrival::Displacement(_)) {
            let place = self.arrivals[..k].iter().filter(|a| matches!(a, Arrival::Displacement(_))).count();
            return self.moved[place].iter().map(|&time| (!time.is_nan()).then_some(time)).collect();
        }
        self.trackers.iter().map(of).collect()
    }

    /// For a checkpoint.
    pub fn so_far(&self) -> PeaksSoFar {
        PeaksSoFar {
            speed_squared: self.speed_squared.clone(),
            force_squared: self.force_squared.clone(),
            moved: self.moved.clone(),
            moved_before: self.moved_before.clone(),
            trackers: self.trackers.clone(),
        }
    }

    /// Takes them up from a checkpoint; false if they are not of these spheres and arrivals.
    pub fn restore(&mut self, from: PeaksSoFar) -> bool {
        let fits = self.speed_squared.len() == from.speed_squared.len()
            && self.force_squared.len() == from.force_squared.len()
            && self.moved_before.len() == from.moved_before.len()
            && self.trackers.len() == from.trackers.len()
            && self.moved.len() == from.moved.len()
            && self.moved.iter().zip(&from.moved).all(|(a, b)| a.len() == b.len());
        if fits {
            let PeaksSoFar { speed_squared, force_squared, moved, moved_before, trackers } = from;
            *self = Self {
                arrivals: std::mem::take(&mut self.arrivals),
                speed_squared,
                force_squared,
                trackers,
                moved,
                moved_before,
            };
        }
        fits
    }
}
