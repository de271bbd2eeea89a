//! The present state of a rig, to be looked at.

use super::cluster::ClusterState;
use super::engine::Engine;
use super::peaks::net_force_squared;
use super::{Body, Rig};

/// State of a flat.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FlatState<const D: usize> {
    /// From where it was at the start (m).
    pub moved: [f64; D],
    /// Velocity (m/s).
    pub velocity: [f64; D],
    /// Force of the spheres on it (N), on the simulated part of a symmetric rig.
    pub force: [f64; D],
}

/// A closed contact.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touching<const D: usize> {
    /// Its bodies; a sphere twice where it meets its own image in a mirror.
    pub bodies: [Body; 2],
    /// From the first to the second, of unit length.
    pub normal: [f64; D],
    /// Overlap (m); of a sphere and a flat its depth in it.
    pub overlap: f64,
    /// Normal force (N).
    pub force: f64,
    /// How fast the overlap grows (m/s).
    pub closing_speed: f64,
    /// dF/dx (N/m) as the bodies begin to part, by the way x they go; at a flat that stands for an equal sphere the overlap falls twice
    /// as fast.
    pub stiffness: f64,
    /// Whether it is yielding: loaded as never before, beyond the onset of yield of its law.
    pub yields: bool,
    /// Force of the tangential spring (N).
    pub tangential: f64,
    /// Whole force of friction on the second body (N): of spring and damping, at most μ times the normal force.
    pub friction: [f64; D],
    /// Greatest overlap (m) and force (N) so far, where the law remembers them; else the present ones.
    pub overlap_max: f64,
    /// See `overlap_max`.
    pub force_max: f64,
    /// Energy it would give back (J), of the simulated part.
    pub stored: f64,
    /// Energy it has taken (J), of the simulated part.
    pub dissipated: f64,
}

/// The present state of a rig.
pub struct View<'a, const D: usize> {
    pub(super) rig: &'a Rig<D>,
    pub(super) engine: &'a dyn Engine<D>,
    pub(super) step: f64,
}

impl<const D: usize> View<'_, D> {
    /// Time (s).
    pub fn time(&self) -> f64 {
        self.engine.count() as f64 * self.step
    }
    /// Where a sphere's centre is (m); over periodic sides it is not taken back.
    pub fn position(&self, sphere: usize) -> [f64; D] {
        let (centre, moved) = (self.rig.sample.spheres[sphere].centre, self.displacement(sphere));
        std::array::from_fn(|k| centre[k] + moved[k])
    }
    /// How far a sphere has moved (m).
    pub fn displacement(&self, sphere: usize) -> [f64; D] {
        self.engine.bodies().displacement[sphere]
    }
    /// The part of a sphere that belongs to the simulated part of a symmetric rig: 1/2 on a mirror.
    pub fn simulated_fraction(&self, sphere: usize) -> f64 {
        self.engine.bodies().weight[sphere]
    }
    /// Velocity of a sphere (m/s).
    pub fn velocity(&self, sphere: usize) -> [f64; D] {
        self.engine.bodies().velocity[sphere]
    }
    /// Spin of a sphere (rad/s), as [`Rig::spin`](super::Rig).
    pub fn spin(&self, sphere: usize) -> [f64; 3] {
        self.engine.bodies().spin.get(sphere)
    }
    /// Net force of contacts on the simulated part of a sphere (N).
    pub fn net_force(&self, sphere: usize) -> [f64; D] {
        self.engine.sums().force[sphere]
    }
    /// Size of the net contact force (N) on the whole of a sphere, also where only a part of it is simulated; across a mirror that it
    /// lies on its other half pushes back.
    pub fn net_force_size(&self, sphere: usize) -> f64 {
        net_force_squared(sphere, self.engine.bodies(), self.engine.sums()).sqrt()
    }
    /// Net force of contacts on the whole of a sphere (N), also where only a part of it is simulated.
    pub fn whole_force(&self, sphere: usize) -> [f64; D] {
        let (bodies, force) = (self.engine.bodies(), self.net_force(sphere));
        let weight = bodies.weight[sphere];
        let balanced = |k: usize| weight < 1.0 && bodies.inverse_mass[sphere][k] == 0.0;
        std::array::from_fn(|k| if balanced(k) { 0.0 } else { force[k] / weight })
    }
    /// State of a flat.
    pub fn flat(&self, flat: usize) -> FlatState<D> {
        let bodies = self.engine.bodies();
        FlatState {
            moved: bodies.flat_moved[flat],
            velocity: bodies.flat_velocity[flat],
            force: self.engine.sums().flat[flat],
        }
    }
    /// State of a cluster.
    pub fn cluster(&self, cluster: usize) -> ClusterState<D> {
        self.engine.bodies().clusters[cluster]
    }
    /// Sum of the sizes of the normal forces (N) on each sphere.
    pub fn normal_force_sum(&self) -> Vec<f64> {
        self.engine.normal_force_sum()
    }
    /// The closed contacts, in a fixed order.
    pub fn contacts(&self) -> impl Iterator<Item = Touching<D>> + '_ {
        (0..self.engine.contacts()).filter_map(|c| self.engine.touching(self.rig, c))
    }
}
