//! Which material sits on which site, and what lenses are compared with.
//!
//! - `baseline`: flat strips, uniform crystals and random mixtures
//! - `count`: spheres, mass and price of the piece to be built and of the simulated half

mod baseline;
mod count;

pub use baseline::{Baseline, random_choice};
pub use count::{Amount, Bill, LayoutCounter, LayoutStats};

use crate::lattice::{Block, HexagonalSheet, Site};
use crate::material::Material;
use crate::sample::{Sample, Sphere};

/// A material for every site of a lattice.
#[derive(Clone, Debug, PartialEq)]
pub struct Layout<L = HexagonalSheet> {
    /// The sites.
    pub lattice: L,
    /// The materials that occur; by convention the host first, then the lens material.
    pub palette: Vec<Material>,
    /// For each site, in the lattice's order, an index into `palette`.
    pub materials: Vec<u8>,
}

impl<L> Layout<L> {
    /// Number of sites that hold the material with this index.
    pub fn count(&self, material: u8) -> usize {
        self.materials.iter().filter(|&&m| m == material).count()
    }
}

impl Layout<Block> {
    /// The spheres to simulate, those of the half x ≥ 0, in the block's order.
    pub fn sample_in_space(&self) -> Sample<3> {
        let radius = 0.5 * self.lattice.diameter();
        let sites = self.lattice.sites().iter().zip(&self.materials);
        let sphere = |(site, &material): (&crate::lattice::CrystalSite<3>, &u8)| Sphere {
            centre: site.centre,
            radius,
            material: usize::from(material),
        };
        Sample { materials: self.palette.clone(), spheres: sites.map(sphere).collect() }
    }
}

impl Layout {
    /// Chooses a material for every site: `pick` returns an index into `palette`.
    pub fn new(lattice: HexagonalSheet, palette: Vec<Material>, pick: impl Fn(&Site) -> u8) -> Self {
        let materials = lattice.sites().iter().map(pick).collect();
        Self { lattice, palette, materials }
    }

    /// The spheres to simulate, in the lattice's order.
    pub fn sample(&self) -> Sample<2> {
        let sites = self.lattice.sites();
        let sphere = |(site, &material): (&Site, &u8)| Sphere {
            centre: [site.x, site.z],
            radius: 0.5 * self.lattice.row_diameter(site.row),
            material: usize::from(material),
        };
        let spheres = sites.iter().zip(&self.materials).map(sphere).collect();
        Sample { materials: self.palette.clone(), spheres }
    }
}
