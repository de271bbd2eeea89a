//! What can be seen of a sheet: places, velocities, energies.

use super::sweep::Part;
use super::{Numbers, Sheet};
use crate::contact::{Hertz, NormalLaw as _};

impl Sheet {
    /// How far each sphere of a crystal has moved (m), row by row.
    pub fn displacements(&self, design: usize) -> Vec<[f64; 2]> {
        let (x, z, size) = (self.state.x.get(), self.state.z.get(), self.grid.diameter);
        self.places(design).map(|at| [x[at] * size, z[at] * size]).collect()
    }

    /// Velocity of each sphere of a crystal at the last step (m/s).
    pub fn velocities(&self, design: usize) -> Vec<[f64; 2]> {
        // Half a kick brings velocities up to date.
        let mut now = self.clone();
        if self.begun {
            let load = if self.steps == 0 { 0.0 } else { self.pulse.during(self.steps - 1, self.step) };
            now.push(load, false);
            now.pass(Part { kick: 0.5, drift: 0.0 }, 1, false);
        }
        let (x, z, scale) = (now.state.step_x.get(), now.state.step_z.get(), self.grid.diameter / self.step);
        self.places(design).map(|at| [x[at] * scale, z[at] * scale]).collect()
    }

    /// Greatest kinetic energy of each sphere of a crystal (J) over the steps since [`watch_speeds`](Self::watch_speeds); none
    /// without it.
    pub fn greatest_kinetic(&self, design: usize) -> Option<Vec<f64>> {
        let fastest = self.fastest.as_ref().map(Numbers::get)?;
        let scale = (self.grid.diameter / self.step).powi(2);
        let now = self.velocities(design);
        let energy = |(at, velocity): (usize, [f64; 2])| {
            let square = velocity[0] * velocity[0] + velocity[1] * velocity[1];
            0.5 * self.mass_at(at) * (fastest[at] * scale).max(square)
        };
        Some(self.places(design).zip(now).map(energy).collect())
    }

    /// Kinetic energy of a crystal at the last step (J).
    pub fn kinetic_energy(&self, design: usize) -> f64 {
        let velocities = self.velocities(design);
        let energy = |(at, [x, z]): (usize, [f64; 2])| 0.5 * self.mass_at(at) * (x * x + z * z);
        self.places(design).zip(velocities).map(energy).sum()
    }

    /// Elastic energy of a crystal's contacts (J), those with images included.
    pub fn elastic_energy(&self, design: usize) -> f64 {
        let (store, kinds, a) = (&self.fixed.store, &self.fixed.kinds, self.fixed.spacing);
        let (x, z) = (self.state.x.get(), self.state.z.get());
        let stored = |kind: u8, offset: [f64; 2], from: usize, to: usize| {
            let between = [offset[0] + x[to] - x[from], offset[1] + z[to] - z[from]];
            let overlap = (1.0 - between[0].hypot(between[1])) * self.grid.diameter;
            let law = Hertz { coefficient: self.fixed.stiffness[usize::from(kind)] };
            law.stored(overlap, &Default::default())
        };
        let height = 0.75_f64.sqrt() * a;
        let mut energy = 0.0;
        for row in 0..self.grid.rows {
            let below = (row + 1) % self.grid.rows;
            for column in 0..self.grid.columns[row % 2] {
                let (at, under) = (store.at(row, column) + design, store.at(below, column) + design);
                energy += stored(kinds.beside[at], [a, 0.0], at, at + store.site);
                // Each sphere's two bonds to the row below.
                if row % 2 == 1 {
                    energy += stored(kinds.straight[at], [-0.5 * a, height], at, under);
                    energy += stored(kinds.slanted[at], [0.5 * a, height], at, under + store.site);
                } else {
                    energy += stored(kinds.straight[at], [0.5 * a, height], at, under);
                    let before = at - store.site;
                    energy += stored(kinds.slanted[before], [-0.5 * a, height], at, under - store.site);
                }
            }
        }
        energy
    }

    /// Greatest overlap in any crystal so far, over the diameter.
    pub fn deepest_overlap(&self) -> f64 {
        self.deepest
    }

    /// Bytes that a sheet occupies per sphere of a crystal.
    pub fn bytes_per_sphere(&self) -> f64 {
        let arrays = 4 + usize::from(self.fastest.is_some());
        let bytes = self.state.x.length * (8 * arrays + 4);
        bytes as f64 / (self.grid.len() * self.designs) as f64
    }

    fn mass_at(&self, at: usize) -> f64 {
        self.mass[usize::from(self.fixed.kinds.sphere[at])]
    }

    /// Where a crystal's numbers stand, sphere by sphere.
    fn places(&self, design: usize) -> impl Iterator<Item = usize> + '_ {
        assert!(design < self.designs, "crystal {design} of {}", self.designs);
        self.grid.sites().map(move |[row, column]| self.fixed.store.at(row, column) + design)
    }
}
