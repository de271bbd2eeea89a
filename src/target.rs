//! What is wanted, and where: the focal and the protected region, and the time window in which the impact is judged.

use serde::{Deserialize, Serialize};

use crate::lattice::{HexagonalSheet, Site};

/// A rectangle of the crystal: whole rows between two distances from the axis.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Region {
    /// First and last row, both included, from 1.
    pub rows: [u32; 2],
    /// Least and greatest distance from the axis (m), both included.
    pub x: [f64; 2],
}

impl Region {
    /// Whether a site lies in the region; its edges count as inside to one part in 10⁹ of the diameter.
    pub fn contains(&self, site: &Site, diameter: f64) -> bool {
        let slack = 1e-9 * diameter;
        (self.rows[0]..=self.rows[1]).contains(&site.row) && site.x >= self.x[0] - slack && site.x <= self.x[1] + slack
    }

    /// Indices of the sites inside, in the lattice's order.
    pub fn sites(&self, lattice: &HexagonalSheet) -> Vec<usize> {
        let sites = lattice.sites();
        (0..sites.len()).filter(|&i| self.contains(&sites[i], lattice.diameter())).collect()
    }

    /// The row midway between first and last; a half where their number is even.
    pub fn mid_row(&self) -> f64 {
        f64::from(self.rows[0] + self.rows[1]) / 2.0
    }
}

/// Where energy is wanted and where it is not.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Target {
    /// The focal region.
    pub focus: Region,
    /// The protected region.
    pub protect: Region,
}

impl Target {
    /// The initial-wave window in seconds, one for all arrangements of a design file:
    ///
    ///   T = (depth of the regions' far edge + 10 rows) / V + 120 µs
    ///
    /// with `slowest_speed` V (m/s), the wave-speed bound of the slowest material present. It ends the run; maxima are
    /// taken over 0..T and energies are those at T. The first term is the passage of the first front, the second leaves
    /// room for the bound not being reached and for the pulse's own length.
    pub fn window(&self, lattice: &HexagonalSheet, slowest_speed: f64) -> f64 {
        let far = self.focus.rows[1].max(self.protect.rows[1]);
        lattice.depth(f64::from(far + 10)) / slowest_speed + 120e-6
    }
}
