//! Spheres bound to each other: rigid bodies of any outline, such as intruders.

use super::Rig;
use super::bodies::{Bodies, cross, dot, spin_cross};
use super::contacts::Sums;
use super::spins::Spins;

/// Spheres that move as one rigid body. In the plane it may turn; in space it cannot.
#[derive(Clone, Debug, PartialEq)]
pub struct Cluster<const D: usize> {
    /// Indices of its spheres, of which none is held or loaded.
    pub members: Vec<usize>,
    /// Centre of mass at the start (m).
    pub centre: [f64; D],
    /// Mass of the whole (kg); the members' own masses do not count.
    pub mass: f64,
    /// Moment of inertia about the centre (kg m²).
    pub inertia: f64,
    /// Whether it can turn.
    pub turns: bool,
    /// Velocity of the centre at the start (m/s).
    pub velocity: [f64; D],
    /// Spin at the start (rad/s).
    pub spin: f64,
}

/// State of a cluster.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClusterState<const D: usize> {
    /// From where the centre was at the start (m).
    pub moved: [f64; D],
    /// By how much it has turned (rad).
    pub angle: f64,
    /// Velocity of the centre (m/s).
    pub velocity: [f64; D],
    /// Spin (rad/s).
    pub spin: f64,
    /// Force of contacts on it (N).
    pub force: [f64; D],
    /// Torque of contacts about the centre (N m).
    pub torque: f64,
    pub(super) acceleration: [f64; D],
    pub(super) spin_rate: f64,
}

/// What a scheme adds to a cluster's drift: to its displacement over the step and its angle over it, to its predicted velocity and spin.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ahead<const D: usize> {
    pub moved: [f64; D],
    pub velocity: [f64; D],
    pub angle: f64,
    pub spin: f64,
}

impl<const D: usize> Default for Ahead<D> {
    fn default() -> Self {
        Self { moved: [0.0; D], velocity: [0.0; D], angle: 0.0, spin: 0.0 }
    }
}

impl<const D: usize> ClusterState<D> {
    pub(super) const NUMBERS: usize = 4 * D + 4;

    pub(super) fn new(cluster: &Cluster<D>) -> Self {
        Self {
            moved: [0.0; D],
            angle: 0.0,
            velocity: cluster.velocity,
            spin: if cluster.turns { cluster.spin } else { 0.0 },
            force: [0.0; D],
            torque: 0.0,
            acceleration: [0.0; D],
            spin_rate: 0.0,
        }
    }

    pub(super) fn numbers(&self) -> Vec<f64> {
        let mut numbers = vec![self.angle, self.spin, self.torque, self.spin_rate];
        for part in [self.moved, self.velocity, self.force, self.acceleration] {
            numbers.extend(part);
        }
        numbers
    }

    pub(super) fn from_numbers(numbers: &[f64]) -> Self {
        let part = |n: usize| std::array::from_fn(|k| numbers[4 + n * D + k]);
        Self {
            angle: numbers[0],
            spin: numbers[1],
            torque: numbers[2],
            spin_rate: numbers[3],
            moved: part(0),
            velocity: part(1),
            force: part(2),
            acceleration: part(3),
        }
    }

    /// From the centre to a member, with the present angle.
    fn arm(&self, rig: &Rig<D>, cluster: &Cluster<D>, member: usize) -> [f64; D] {
        let centre = rig.sample.spheres[member].centre;
        let mut arm: [f64; D] = std::array::from_fn(|k| centre[k] - cluster.centre[k]);
        if D == 2 {
            let (sin, cos) = self.angle.sin_cos();
            (arm[0], arm[1]) = (cos * arm[0] - sin * arm[1], sin * arm[0] + cos * arm[1]);
        }
        arm
    }

    /// Moves on by a step; members follow, with their predicted velocities in `predicted` and spins times `lever` in `predicted_turn`.
    pub(super) fn drift(
        &mut self,
        rig: &Rig<D>,
        cluster: &Cluster<D>,
        (h, ahead): (f64, &Ahead<D>),
        bodies: &mut Bodies<D>,
        (predicted, predicted_turn): (&mut [[f64; D]], &mut Spins<D>),
        lever: &[f64],
    ) {
        for k in 0..D {
            self.moved[k] += h * (self.velocity[k] + 0.5 * h * self.acceleration[k] + ahead.moved[k]);
        }
        self.angle += h * (self.spin + 0.5 * h * self.spin_rate + ahead.angle);
        let velocity = std::array::from_fn(|k| self.velocity[k] + h * self.acceleration[k] + ahead.velocity[k]);
        let spin = [0.0, 0.0, self.spin + h * self.spin_rate + ahead.spin];
        for &i in &cluster.members {
            let (arm, centre) = (self.arm(rig, cluster, i), rig.sample.spheres[i].centre);
            for k in 0..D {
                bodies.displacement[i][k] = cluster.centre[k] + self.moved[k] + arm[k] - centre[k];
            }
            predicted[i] = moving(&velocity, &spin, &arm);
            if !predicted_turn.numbers().is_empty() {
                predicted_turn.set(i, &spin.map(|w| lever[i] * w));
            }
        }
    }

    /// New velocities under the forces on the members, which follow. With `h` zero only forces and accelerations are set. `added` is what
    /// the scheme adds to the k-th velocity, the last of which is the spin, under a new acceleration.
    pub(super) fn kick(
        &mut self,
        rig: &Rig<D>,
        cluster: &Cluster<D>,
        (h, added): (f64, impl Fn(usize, f64) -> f64),
        sums: &Sums<D>,
        bodies: &mut Bodies<D>,
    ) {
        (self.force, self.torque) = ([0.0; D], 0.0);
        for &i in &cluster.members {
            let arm = self.arm(rig, cluster, i);
            self.torque += cross(&arm, &sums.force[i])[2] + sums.torque.get(i)[2];
            for k in 0..D {
                self.force[k] += sums.force[i][k];
            }
        }
        for k in 0..D {
            let new = self.force[k] / cluster.mass + rig.gravity[k];
            self.velocity[k] += 0.5 * h * (self.acceleration[k] + new) + added(k, new);
            self.acceleration[k] = new;
        }
        if cluster.turns {
            let new = self.torque / cluster.inertia;
            self.spin += 0.5 * h * (self.spin_rate + new) + added(D, new);
            self.spin_rate = new;
        }
        let spin = [0.0, 0.0, self.spin];
        for &i in &cluster.members {
            bodies.velocity[i] = moving(&self.velocity, &spin, &self.arm(rig, cluster, i));
            bodies.spin.set(i, &spin);
        }
    }

    /// ½ m v² + ½ I ω² (J)
    pub(super) fn kinetic(&self, cluster: &Cluster<D>) -> f64 {
        0.5 * cluster.mass * dot(&self.velocity, &self.velocity) + 0.5 * cluster.inertia * self.spin * self.spin
    }
}

/// Velocity of a point of a turning body.
fn moving<const D: usize>(velocity: &[f64; D], spin: &[f64; 3], arm: &[f64; D]) -> [f64; D] {
    // In space clusters do not turn.
    let turning = if D == 2 { spin_cross(spin, arm) } else { [0.0; D] };
    std::array::from_fn(|k| velocity[k] + turning[k])
}
