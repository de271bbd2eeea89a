//! Spheres as they lie: centre, radius, material, wherever they come from.

use crate::material::Material;

/// One sphere. The last axis is the one along which the wave runs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere<const D: usize> {
    /// Centre (m).
    pub centre: [f64; D],
    /// Radius (m); zero where the site is empty.
    pub radius: f64,
    /// Index into [`Sample::materials`].
    pub material: usize,
}

/// A packing of spheres in `D` dimensions.
///
/// Spheres stand in order of depth, so that those the wave has not reached are the last ones.
#[derive(Clone, Debug, PartialEq)]
pub struct Sample<const D: usize> {
    /// The materials present.
    pub materials: Vec<Material>,
    /// The spheres, struck ones first.
    pub spheres: Vec<Sphere<D>>,
}

impl<const D: usize> Sample<D> {
    /// Mass of a sphere (kg).
    pub fn mass(&self, sphere: usize) -> f64 {
        let Sphere { radius, material, .. } = self.spheres[sphere];
        self.materials[material].sphere_mass(2.0 * radius)
    }
}
