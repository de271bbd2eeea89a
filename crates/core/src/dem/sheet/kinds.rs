//! Which materials stand and meet where.

use super::grid::{Grid, Store};

/// Which pair of materials each bond joins and what each sphere is made of, as places in tables; 0 is nothing. Numbers stand
/// as those of the state do.
#[derive(Clone, Debug)]
pub(super) struct Kinds {
    /// From a place to the next one of its row.
    pub beside: Vec<u8>,
    /// From a place to the place with the same number in the row below.
    pub straight: Vec<u8>,
    /// The other bond to the row below: in rows 2, 4, ... from a place to the next place there, in rows 1, 3, ... from the
    /// next place to the same place there.
    pub slanted: Vec<u8>,
    /// Of the sphere.
    pub sphere: Vec<u8>,
}

/// Place of the pair of two of five materials in the table of kinds; 0 is no bond.
pub(in crate::dem) fn kind(a: u8, b: u8) -> u8 {
    let (low, high) = (a.min(b), a.max(b));
    1 + high * (high + 1) / 2 + low
}

impl Kinds {
    /// The kinds of all bonds and spheres.
    pub fn new(grid: &Grid, store: &Store, designs: &[&[u8]]) -> Self {
        let length = grid.rows * store.stride;
        let zero = || vec![0; length];
        let mut kinds = Self { beside: zero(), straight: zero(), slanted: zero(), sphere: zero() };
        // What each place is made of, images with their spheres' materials; 0 is nothing.
        let mut made = zero();
        for (number, [row, column]) in grid.sites().enumerate() {
            let at = store.at(row, column);
            for lane in 0..store.site {
                let material = designs[lane.min(designs.len() - 1)][number] + 1;
                (made[at + lane], kinds.sphere[at + lane]) = (material, material);
            }
        }
        for row in 0..grid.rows {
            for &(to, from, _) in &store.ghosts[row % 2] {
                for lane in 0..store.site {
                    let start = row * store.stride + lane;
                    made[start + to * store.site] = made[start + from * store.site];
                }
            }
        }
        let bond = |a: usize, b: usize| match (made[a], made[b]) {
            (0, _) | (_, 0) => 0,
            (a, b) => kind(a - 1, b - 1),
        };
        for row in 0..grid.rows {
            let below = if row + 1 < grid.rows { Some(row + 1) } else { grid.joined.then_some(0) };
            for k in 0..store.stride - store.site {
                let here = row * store.stride + k;
                kinds.beside[here] = bond(here, here + store.site);
                if let Some(below) = below {
                    let under = below * store.stride + k;
                    kinds.straight[here] = bond(here, under);
                    kinds.slanted[here] =
                        if row % 2 == 1 { bond(here, under + store.site) } else { bond(here + store.site, under) };
                }
            }
        }
        kinds
    }
}
