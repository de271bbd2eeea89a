//! The state of spheres and flats, as parallel arrays.

use super::cluster::ClusterState;
use super::spins::Spins;
use super::{Body, Rig};
use crate::real::Lanes;

/// State of all spheres and flats. Row i of each array is sphere (or flat) i.
#[derive(Clone, Debug)]
pub(super) struct Bodies<const D: usize> {
    /// From where the spheres lay at the start (m).
    pub displacement: Vec<[f64; D]>,
    pub velocity: Vec<[f64; D]>,
    /// By contacts, gravity and damping, as of the last accepted step; loads not included.
    pub acceleration: Vec<[f64; D]>,
    pub spin: Spins<D>,
    pub spin_rate: Spins<D>,
    /// Per axis 1/(m · weight), or 0 where the sphere cannot move.
    pub inverse_mass: Vec<[f64; D]>,
    pub inverse_inertia: Vec<f64>,
    /// The part of the sphere that belongs to the simulated part of a symmetric rig.
    pub weight: Vec<f64>,
    /// Per axis the damping rate Z/m + drag (1/s); empty where nothing damps.
    pub damping: Vec<[f64; D]>,

    pub clusters: Vec<ClusterState<D>>,
    /// For each sphere the cluster that moves it.
    pub clustered: Vec<Option<u32>>,

    pub flat_moved: Vec<[f64; D]>,
    pub flat_velocity: Vec<[f64; D]>,
    pub flat_acceleration: Vec<[f64; D]>,
    pub flat_inverse_mass: Vec<[f64; D]>,
    pub flat_damping: Vec<[f64; D]>,
}

impl<const D: usize> Bodies<D> {
    pub fn new(rig: &Rig<D>) -> Self {
        let count = rig.sample.spheres.len();
        let mut inverse_mass = Vec::with_capacity(count);
        let mut weight = vec![1.0; count];
        let clustered = rig.clustered();
        for (i, sphere) in rig.sample.spheres.iter().enumerate() {
            // A member of a cluster is moved by it alone.
            let mut held = if clustered[i].is_some() { [true; D] } else { rig.held[i] };
            for mirror in rig.mirrors.iter().filter(|mirror| mirror.carries(&sphere.centre, sphere.radius)) {
                weight[i] *= 0.5;
                held[mirror.axis] = true;
            }
            inverse_mass.push(held.map(|held| if held { 0.0 } else { 1.0 / (rig.mass[i] * weight[i]) }));
        }
        let whole = 0.5_f64.powi(rig.mirrors.len() as i32);
        let flat_inverse =
            |flat: &super::Flat<D>| flat.held.map(|held| if held { 0.0 } else { 1.0 / (flat.mass * whole) });
        let damped = rig.drag > 0.0 || rig.bars.iter().any(|bar| matches!(bar.body, Body::Sphere(_)));
        let mut damping = if damped { vec![[rig.drag; D]; count] } else { Vec::new() };
        let mut flat_damping = vec![[0.0; D]; rig.flats.len()];
        for bar in &rig.bars {
            match bar.body {
                Body::Sphere(i) => damping[i][bar.axis] += bar.impedance / rig.mass[i],
                Body::Flat(f) => flat_damping[f][bar.axis] += bar.impedance / rig.flats[f].mass,
            }
        }
        Self {
            displacement: vec![[0.0; D]; count],
            velocity: (0..count).map(|i| free(&rig.velocity[i], &inverse_mass[i])).collect(),
            acceleration: vec![[0.0; D]; count],
            spin: Spins::of(&rig.spin),
            spin_rate: Spins::still(count),
            inverse_inertia: (0..count)
                .map(|i| {
                    // A mirror turns spins about axes in it around: in the plane a sphere on one does not spin.
                    if weight[i] < 1.0 || clustered[i].is_some() || rig.held[i].iter().all(|&held| held) {
                        0.0
                    } else {
                        1.0 / (rig.inertia[i] * weight[i])
                    }
                })
                .collect(),
            inverse_mass,
            weight,
            damping,
            clusters: rig.clusters.iter().map(ClusterState::new).collect(),
            clustered,
            flat_moved: vec![[0.0; D]; rig.flats.len()],
            flat_velocity: rig.flats.iter().map(|flat| flat.velocity).collect(),
            flat_acceleration: vec![[0.0; D]; rig.flats.len()],
            flat_inverse_mass: rig.flats.iter().map(flat_inverse).collect(),
            flat_damping,
        }
    }

    /// v² of a sphere.
    pub fn speed_squared(&self, sphere: usize) -> f64 {
        self.velocity[sphere].iter().map(|v| v * v).sum()
    }
}

/// The velocity along the axes on which a body can move.
fn free<const D: usize>(velocity: &[f64; D], inverse_mass: &[f64; D]) -> [f64; D] {
    std::array::from_fn(|k| if inverse_mass[k] == 0.0 { 0.0 } else { velocity[k] })
}

/// ω × n in `D` dimensions; in the plane ω points out of it.
#[inline(always)]
pub(super) fn spin_cross<V: Lanes, const D: usize>(spin: &[V; 3], n: &[V; D]) -> [V; D] {
    let mut out = [V::splat(0.0); D];
    if D == 2 {
        out[0] = -spin[2] * n[1];
        out[1] = spin[2] * n[0];
    } else if D == 3 {
        out[0] = spin[1] * n[2] - spin[2] * n[1];
        out[1] = spin[2] * n[0] - spin[0] * n[2];
        out[2] = spin[0] * n[1] - spin[1] * n[0];
    }
    out
}

/// n × f in `D` dimensions; in the plane it points out of it.
#[inline(always)]
pub(super) fn cross<V: Lanes, const D: usize>(n: &[V; D], f: &[V; D]) -> [V; 3] {
    let zero = V::splat(0.0);
    if D == 2 {
        [zero, zero, n[0] * f[1] - n[1] * f[0]]
    } else if D == 3 {
        [n[1] * f[2] - n[2] * f[1], n[2] * f[0] - n[0] * f[2], n[0] * f[1] - n[1] * f[0]]
    } else {
        [zero; 3]
    }
}

/// A vector times a number. In a loop: closures are not compiled for the caller's registers.
#[inline(always)]
pub(super) fn times<V: Lanes, const D: usize>(a: &[V; D], factor: V) -> [V; D] {
    let mut product = *a;
    for k in 0..D {
        product[k] = a[k] * factor;
    }
    product
}

/// A vector where the mask holds, elsewhere zero.
#[inline(always)]
pub(super) fn only<V: Lanes, const D: usize>(mask: V::Mask, a: &[V; D]) -> [V; D] {
    let mut only = *a;
    for k in 0..D {
        only[k] = V::select(mask, a[k], V::splat(0.0));
    }
    only
}

#[inline(always)]
pub(super) fn dot<V: Lanes, const D: usize>(a: &[V; D], b: &[V; D]) -> V {
    let mut sum = a[0] * b[0];
    for k in 1..D {
        sum = sum + a[k] * b[k];
    }
    sum
}
