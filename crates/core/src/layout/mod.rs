//! Which material sits on which site, and what lenses are compared with.
//!
//! - `baseline`: flat strips, uniform crystals and random mixtures
//! - `count`: spheres, mass and price of the piece to be built and of the simulated half

mod baseline;
mod count;

pub use baseline::{Baseline, random_choice};
pub use count::{Amount, Bill, LayoutCounter, LayoutStats};

use crate::lattice::{HexagonalSheet, Site};
use crate::material::Material;
use crate::sample::{Sample, Sphere};

/// A material for every site of a lattice.
#[derive(Clone, Debug, PartialEq)]
pub struct Layout {
    /// The sites.
    pub lattice: HexagonalSheet,
    /// The materials that occur; by convention the host first, then the lens material.
    pub palette: Vec<Material>,
    /// For each site, in the lattice's order, an index into `palette`.
    pub materials: Vec<u8>,
}

impl Layout {
    /// Chooses a material for every site: `pick` returns an index into `palette`.
    pub fn new(lattice: HexagonalSheet, palette: Vec<Material>, pick: impl Fn(&Site) -> u8) -> Self {
        let materials = lattice.sites().iter().map(pick).collect();
        Self { lattice, palette, materials }
    }

    /// Number of sites that hold the material with this index.
    pub fn count(&self, material: u8) -> usize {
        self.materials.iter().filter(|&&m| m == material).count()
    }

    /// The spheres to simulate, in the lattice's order.
    pub fn sample(&self) -> Sample<2> {
        let radius = 0.5 * self.lattice.diameter();
        let sites = self.lattice.sites();
        let spheres = sites
            .iter()
            .zip(&self.materials)
            .map(|(site, &material)| Sphere { centre: [site.x, site.z], radius, material: usize::from(material) })
            .collect();
        Sample { materials: self.palette.clone(), spheres }
    }
}
