//! The spheres in motion: displacement from where they lay, velocity and force, as parallel arrays.

use super::boundary::{Carried, Surface};
use crate::real::Lanes;
use crate::sample::Sample;

/// State of all spheres. Row i of each array is sphere i, in the sample's order.
///
/// Positions are held as displacements from rest: the overlap of two touching spheres is then free of cancellation, and
/// spheres that the wave has not reached are exactly at rest.
#[derive(Clone, Debug)]
pub(super) struct Grains<V, const D: usize> {
    pub displacement: Vec<[V; D]>,
    pub velocity: Vec<[V; D]>,
    /// Acceleration by contacts, as of the last accepted step.
    pub acceleration: Vec<[V; D]>,
    /// 1/m of the whole sphere (1/kg)
    pub inverse_mass: Vec<V>,
    /// Per axis 1/weight, or 0 across a mirror that the sphere lies on.
    pub mobility: Vec<[f64; D]>,
    /// The part of the sphere that belongs to the simulated half.
    pub weight: Vec<f64>,
    /// On which surfaces each lies.
    pub carried: Carried<D>,
    /// Spheres on planes across no axis, and the directions in which they do not move.
    held: Vec<(usize, Vec<[f64; D]>)>,
    /// Spheres from here on are at rest and carry no force.
    pub reached: usize,
}

impl<V: Lanes, const D: usize> Grains<V, D> {
    /// Spheres at rest; the samples stand side by side and have the same centres. Where a site is empty nothing moves.
    pub fn at_rest(samples: &[&Sample<D>], surfaces: &[Surface]) -> Self {
        let sample = samples[0];
        let zero = [V::splat(0.0); D];
        let count = sample.spheres.len();
        let greatest = |i: usize| samples.iter().map(|sample| sample.spheres[i].radius).fold(0.0, f64::max);
        let spheres = sample.spheres.iter().enumerate().map(|(i, sphere)| (sphere.centre, greatest(i)));
        let carried = Carried::new(spheres.clone(), surfaces);
        let weight: Vec<f64> = (0..count).map(|i| carried.weight(i)).collect();
        let mut mobility = vec![[1.0; D]; count];
        for (i, (centre, radius)) in spheres.enumerate() {
            for surface in surfaces {
                if let Surface::Mirror(mirror) = surface
                    && mirror.carries(&centre, radius)
                {
                    mobility[i][mirror.axis] = 0.0;
                }
            }
            mobility[i].iter_mut().for_each(|m| *m /= weight[i]);
        }
        let held = carried.held(surfaces);
        let inverse_mass = (0..count)
            .map(|i| {
                let mut inverse = V::splat(0.0);
                for lane in 0..V::LANES {
                    let mass = samples[lane.min(samples.len() - 1)].mass(i);
                    inverse.set_lane(lane, if mass > 0.0 { 1.0 / mass } else { 0.0 });
                }
                inverse
            })
            .collect();
        Self {
            displacement: vec![zero; count],
            velocity: vec![zero; count],
            acceleration: vec![zero; count],
            inverse_mass,
            mobility,
            weight,
            carried,
            held,
            reached: 0,
        }
    }

    /// Sets spheres in motion along the last axis at the given speeds (m/s), in all designs alike.
    pub fn set_moving(&mut self, moving: &[(usize, f64)]) {
        for &(i, speed) in moving {
            self.velocity[i][D - 1] = V::splat(speed);
            self.reached = self.reached.max(i + 1);
        }
    }

    /// Takes from forces what spheres on planes across no axis are not moved by.
    #[inline(always)]
    pub fn hold(&self, force: &mut [[V; D]]) {
        for (sphere, axes) in self.held.iter().take_while(|(sphere, _)| *sphere < self.reached) {
            let force = &mut force[*sphere];
            for axis in axes {
                let mut along = V::splat(0.0);
                for k in 0..D {
                    along = along + force[k] * V::splat(axis[k]);
                }
                for k in 0..D {
                    force[k] = force[k] - along * V::splat(axis[k]);
                }
            }
        }
    }

    /// Contact acceleration of a sphere under the contact force on its simulated part.
    #[inline(always)]
    pub fn acceleration_of(&self, sphere: usize, force: &[V; D]) -> [V; D] {
        let inverse = self.inverse_mass[sphere];
        let mut acceleration = *force;
        for k in 0..D {
            acceleration[k] = acceleration[k] * (inverse * V::splat(self.mobility[sphere][k]));
        }
        acceleration
    }

    /// v² of a sphere.
    #[inline(always)]
    pub fn speed_squared(&self, sphere: usize) -> V {
        square(&self.velocity[sphere])
    }
}

impl<const D: usize> Grains<f64, D> {
    /// Mass of the part of a sphere that belongs to the simulated half (kg); zero where the site is empty.
    pub fn mass(&self, sphere: usize) -> f64 {
        let inverse = self.inverse_mass[sphere];
        if inverse > 0.0 { self.weight[sphere] / inverse } else { 0.0 }
    }
}

/// |a|²
#[inline(always)]
pub(super) fn square<V: Lanes, const D: usize>(a: &[V; D]) -> V {
    let mut sum = a[0] * a[0];
    for k in 1..D {
        sum = sum + a[k] * a[k];
    }
    sum
}
