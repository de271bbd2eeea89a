//! The stress in the cells of a grid.
//!
//! Coarse-graining (Goldhirsch 2010, *Stress, stress asymmetry and couple stress*) spreads each contact's f ⊗ l along the line
//! between the centres, seen through a window function. Here the window is a cell of the grid, so that a contact gives to
//! each cell the part of its line that lies in it: the parts add up to one, and the sum over all cells of stress times area is
//! the virial Σ f ⊗ l exactly, at any size of cells.

use std::collections::BTreeMap;

use super::fabric::{StressTensor, add, virial};
use super::{Branch, Network};

/// Stress in one cell, compression positive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell {
    /// Middle of the cell, (x, z).
    pub centre: [f64; 2],
    /// Force over length (in the plane).
    pub stress: StressTensor,
}

/// Stress in the cells that a contact passes, in order of x, then z.
#[derive(Clone, Debug, PartialEq)]
pub struct StressMap {
    /// Sides of a cell, (x, z).
    pub cell: [f64; 2],
    /// The cells.
    pub cells: Vec<Cell>,
}

impl StressMap {
    /// In square cells of side `size` from the origin on; with a period along x, the width is the nearest that divides it. None
    /// where places are not known.
    pub fn new(network: &Network, size: f64, period: Option<f64>) -> Option<Self> {
        let columns = period.map(|period| (period / size).round().max(1.0));
        let width = period.zip(columns).map_or(size, |(period, columns)| period / columns);
        let cell = [width, size];
        let mut sums: BTreeMap<[i64; 2], StressTensor> = BTreeMap::new();
        for (contact, branch) in network.contacts().iter().zip(network.branches()?) {
            let whole = virial(contact, branch);
            for (place, part) in parts(branch, cell) {
                let x = columns.map_or(place[0], |columns| place[0].rem_euclid(columns as i64));
                let sum = sums.entry([x, place[1]]).or_default();
                *sum = add(*sum, whole.map(|row| row.map(|value| value * part)));
            }
        }
        let area = cell[0] * cell[1];
        let cells = sums
            .into_iter()
            .map(|(place, sum)| Cell {
                centre: std::array::from_fn(|k| (place[k] as f64 + 0.5) * cell[k]),
                stress: sum.map(|row| row.map(|value| value / area)),
            })
            .collect();
        Some(Self { cell, cells })
    }

    /// Stress times area over all cells.
    pub fn integral(&self) -> StressTensor {
        let sum = self.cells.iter().map(|cell| cell.stress).fold([[0.0; 2]; 2], add);
        sum.map(|row| row.map(|value| value * self.cell[0] * self.cell[1]))
    }
}

/// The cells that a line passes, each with the part of the line in it; the parts add up to one.
fn parts(branch: &Branch, cell: [f64; 2]) -> Vec<([i64; 2], f64)> {
    let Branch { from, vector } = branch;
    // Where along the line, from 0 to 1, it passes from one cell into the next.
    let mut cuts = vec![0.0, 1.0];
    for k in 0..2 {
        let (a, b) = (from[k] / cell[k], (from[k] + vector[k]) / cell[k]);
        let (low, high) = (a.min(b), a.max(b));
        let mut edge = low.floor() + 1.0;
        while edge < high {
            cuts.push(((edge - a) / (b - a)).clamp(0.0, 1.0));
            edge += 1.0;
        }
    }
    cuts.sort_unstable_by(f64::total_cmp);
    cuts.windows(2)
        .filter(|two| two[1] > two[0])
        .map(|two| {
            let middle = 0.5 * (two[0] + two[1]);
            (std::array::from_fn(|k| ((from[k] + middle * vector[k]) / cell[k]).floor() as i64), two[1] - two[0])
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::super::{Contact, Fabric};
    use super::*;

    /// The integral is the virial to rounding, for cells of any size and over a periodic side, and a line that lies in two cells
    /// gives each its part.
    #[test]
    fn the_integral_is_the_virial() {
        let place = |i: u32| [f64::from(i * 37 % 101) * 0.17, f64::from(i * 53 % 97) * 0.13 - 4.0];
        let period = Some(17.17);
        let contacts: Vec<Contact> = (0..200)
            .map(|i| Contact { grains: [i, i + 1], normal: f64::from(i % 7) - 1.0, tangential: f64::from(i % 5) - 2.0 })
            .collect();
        let branches = (0..200).map(|i| Branch::between(place(i), place(i + 1), period)).collect();
        let network = Network::new(201, contacts, Some(branches)).unwrap();
        let virial = Fabric::new(&network).virial.unwrap();
        for size in [0.1, 0.7, 3.0, 50.0] {
            let map = StressMap::new(&network, size, period).unwrap();
            for (a, b) in map.integral().iter().flatten().zip(virial.iter().flatten()) {
                assert!((a - b).abs() < 1e-11, "{size}: {a} {b}");
            }
            assert!(map.cells.iter().all(|cell| (0.0..17.17).contains(&cell.centre[0])));
        }
        let line = Branch { from: [0.25, 0.5], vector: [1.0, 0.0] };
        assert_eq!(parts(&line, [1.0, 1.0]), [([0, 0], 0.75), ([1, 0], 0.25)]);
    }
}
