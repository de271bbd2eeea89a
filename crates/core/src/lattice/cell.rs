//! The unit cells of chains, sheets and crystals, one for each structure and orientation of its layers.

use std::f64::consts::{PI, SQRT_2};

/// A rectangular cell that repeats to fill the line, the plane or space with sites whose nearest neighbours lie one
/// diameter apart. The last axis is depth, along which the wave runs.
///
/// ```
/// use granulens_core::lattice::Cell;
/// assert_eq!(Cell::<3>::named("fcc-001").unwrap().layers(), 2);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell<const D: usize> {
    name: &'static str,
    /// Edges, in diameters.
    edges: [f64; D],
    /// Sites in twelfths of the edges, in order of depth.
    basis: &'static [[u8; D]],
}

/// √3, which is not among the constants of stable Rust.
const SQRT_3: f64 = 1.732_050_807_568_877_2;
/// √6
const SQRT_6: f64 = SQRT_2 * SQRT_3;
/// Edge of the body-centred cube, 2/√3: its spheres touch along the diagonal.
const BODY: f64 = 2.0 / SQRT_3;

const CHAINS: &[Cell<1>] = &[Cell { name: "chain", edges: [1.0], basis: &[[0]] }];

const SHEETS: &[Cell<2>] = &[
    Cell { name: "square", edges: [1.0, 1.0], basis: &[[0, 0]] },
    // The square sheet turned by 45 degrees.
    Cell { name: "square-diagonal", edges: [SQRT_2, SQRT_2], basis: &[[0, 0], [6, 6]] },
    // Close-packed rows across the wave ...
    Cell { name: "hexagonal", edges: [1.0, SQRT_3], basis: &[[0, 0], [6, 6]] },
    // ... and along it.
    Cell { name: "hexagonal-along", edges: [SQRT_3, 1.0], basis: &[[0, 0], [6, 6]] },
];

const SOLIDS: &[Cell<3>] = &[
    // Close-packed layers across the wave, stacked ABAB ...
    Cell {
        name: "hcp",
        edges: [1.0, SQRT_3, 2.0 * SQRT_6 / 3.0],
        basis: &[[0, 0, 0], [6, 6, 0], [6, 2, 6], [0, 8, 6]],
    },
    // ... and ABCABC, which is face-centred cubic along (111).
    Cell {
        name: "fcc-111",
        edges: [1.0, SQRT_3, SQRT_6],
        basis: &[[0, 0, 0], [6, 6, 0], [6, 2, 4], [0, 8, 4], [0, 4, 8], [6, 10, 8]],
    },
    // Square layers: each sphere rests on four.
    Cell { name: "fcc-001", edges: [1.0, 1.0, SQRT_2], basis: &[[0, 0, 0], [6, 6, 6]] },
    // Layers of close-packed rows along x that do not touch each other.
    Cell { name: "fcc-110", edges: [1.0, SQRT_2, 1.0], basis: &[[0, 0, 0], [6, 6, 6]] },
    Cell { name: "bcc-001", edges: [BODY, BODY, BODY], basis: &[[0, 0, 0], [6, 6, 6]] },
    // x along [1-10], y along [001].
    Cell {
        name: "bcc-110",
        edges: [SQRT_2 * BODY, BODY, SQRT_2 * BODY],
        basis: &[[0, 0, 0], [6, 6, 0], [0, 6, 6], [6, 0, 6]],
    },
];

impl Cell<1> {
    /// The cells of chains.
    pub const ALL: &'static [Self] = CHAINS;
}

impl Cell<2> {
    /// The cells of sheets.
    pub const ALL: &'static [Self] = SHEETS;
}

impl Cell<3> {
    /// The cells of crystals in space.
    pub const ALL: &'static [Self] = SOLIDS;
}

macro_rules! by_name {
    ($($dimension:literal),*) => { $(
        impl Cell<$dimension> {
            /// The cell of a structure by its name in files, such as `hexagonal` or `fcc-001`.
            pub fn named(name: &str) -> Option<Self> {
                Self::ALL.iter().copied().find(|cell| cell.name == name)
            }
        }
    )* };
}
by_name!(1, 2, 3);

impl<const D: usize> Cell<D> {
    /// Name of structure and orientation, as in files.
    pub fn name(&self) -> &'static str {
        self.name
    }

    /// Edges, in diameters.
    pub fn edges(&self) -> [f64; D] {
        self.edges
    }

    /// Layers across the wave in one cell.
    pub fn layers(&self) -> u32 {
        self.basis.chunk_by(|a, b| a[D - 1] == b[D - 1]).count() as u32
    }

    /// Distance between layers, in diameters.
    pub fn layer_spacing(&self) -> f64 {
        self.edges[D - 1] / f64::from(self.layers())
    }

    /// The sites of a layer, from 0 on, within one cell, in twelfths of its edges.
    pub(super) fn layer(&self, layer: u32) -> impl Iterator<Item = [u8; D]> + use<D> {
        let depth = (layer % self.layers()) * 12 / self.layers();
        self.basis.iter().copied().filter(move |site| u32::from(site[D - 1]) == depth)
    }

    /// The part of the line, plane or space that touching spheres (in the plane: their circles) fill.
    pub fn packing_fraction(&self) -> f64 {
        let sphere = [1.0, PI / 4.0, PI / 6.0][D - 1];
        self.basis.len() as f64 * sphere / self.edges.iter().product::<f64>()
    }
}
