//! What each sphere felt, and when.

use super::arrival::{ArrivalTracker, Grain};
use super::body::{Grains, square};
use crate::real::Lanes;

/// Looks at the spheres after every accepted step.
pub(super) trait Observer<V, const D: usize> {
    /// Called after so many accepted steps.
    fn accepted(&mut self, steps: u64, grains: &Grains<V, D>);
}

/// Maxima over accepted steps, first arrivals, and what leaves the crystal.
#[derive(Clone, Debug)]
pub(super) struct Peaks<const D: usize> {
    /// v² (m²/s²)
    pub speed_squared: Vec<f64>,
    /// |contact acceleration|² (m²/s⁴)
    pub acceleration_squared: Vec<f64>,
    arrivals: Vec<ArrivalTracker>,
    grain: Grain,
    exit: Vec<usize>,
    /// Greatest momentum of the exit spheres along the last axis (kg m/s)
    pub exit_momentum: f64,
    /// Greatest total contact force on them along the last axis (N)
    pub exit_force: f64,
}

/// A sphere has been reached when its speed is this part of its own maximum.
pub(super) const ARRIVAL: f64 = 0.01;

impl<const D: usize> Peaks<D> {
    pub fn new(spheres: usize, exit: Vec<usize>) -> Self {
        Self {
            speed_squared: vec![0.0; spheres],
            acceleration_squared: vec![0.0; spheres],
            arrivals: vec![ArrivalTracker::default(); spheres],
            grain: Grain::of(spheres, ARRIVAL),
            exit,
            exit_momentum: 0.0,
            exit_force: 0.0,
        }
    }

    /// First arrivals (s), with the step by which the run advanced.
    pub fn arrivals(&self, step: f64) -> Vec<Option<f64>> {
        self.arrivals.iter().map(|tracker| tracker.arrival(step, ARRIVAL * tracker.maximum()?)).collect()
    }
}

/// Nothing is felt where nothing is recorded.
impl<V, const D: usize> Observer<V, D> for () {
    #[inline(always)]
    fn accepted(&mut self, _: u64, _: &Grains<V, D>) {}
}

impl<const D: usize> Observer<f64, D> for Option<Peaks<D>> {
    #[inline(always)]
    fn accepted(&mut self, steps: u64, grains: &Grains<f64, D>) {
        if let Some(peaks) = self {
            peaks.accepted(steps, grains);
        }
    }
}

impl<const D: usize> Observer<f64, D> for Peaks<D> {
    fn accepted(&mut self, steps: u64, grains: &Grains<f64, D>) {
        for i in 0..grains.reached {
            let speed_squared = grains.speed_squared(i);
            let is_maximum = speed_squared > self.speed_squared[i];
            if is_maximum {
                self.speed_squared[i] = speed_squared;
            }
            // Speeds below 1 % of the present maximum are below 1 % of the final one.
            let speed = speed_squared.sqrt();
            self.arrivals[i].push(steps, speed, is_maximum, ARRIVAL * speed, self.grain);
            self.acceleration_squared[i] = square(&grains.acceleration[i]).max(self.acceleration_squared[i]);
        }
        let (mut momentum, mut force) = (0.0, 0.0);
        for &i in self.exit.iter().filter(|&&i| i < grains.reached) {
            let mass = grains.mass(i);
            momentum += mass * grains.velocity[i][D - 1];
            force += mass * grains.acceleration[i][D - 1];
        }
        self.exit_momentum = self.exit_momentum.max(momentum);
        self.exit_force = self.exit_force.max(force);
    }
}

/// Maxima of v² only, of every design side by side; and those since they were last asked for, of each block of spheres.
pub(super) struct Fastest<V> {
    pub of_sphere: Vec<V>,
    pub of_block: Vec<V>,
    /// Spheres of a block.
    size: usize,
}

impl<V: Lanes> Fastest<V> {
    pub fn new(spheres: usize, size: usize) -> Self {
        let zeros = |count| vec![V::splat(0.0); count];
        Self { of_sphere: zeros(spheres), of_block: zeros(spheres.div_ceil(size)), size }
    }
}

impl<V: Lanes, const D: usize> Observer<V, D> for Fastest<V> {
    #[inline(always)]
    fn accepted(&mut self, _: u64, grains: &Grains<V, D>) {
        let mut i = 0;
        for top in &mut self.of_block {
            let end = (i + self.size).min(grains.reached);
            let mut greatest = *top;
            while i < end {
                let speed = grains.speed_squared(i);
                self.of_sphere[i] = speed.max(self.of_sphere[i]);
                greatest = speed.max(greatest);
                i += 1;
            }
            *top = greatest;
            if i == grains.reached {
                break;
            }
        }
    }
}
