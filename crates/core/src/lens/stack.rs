//! What the search for a lens knows of a crystal: its layers, and how far it reaches from the axis.

use crate::lattice::{Block, HexagonalSheet, Layered};

/// Layers across the wave.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stack {
    /// Sphere diameter (m).
    pub diameter: f64,
    /// Number of layers, or rows of a sheet.
    pub rows: u32,
    /// Distance between them (m).
    pub spacing: f64,
    /// From the axis to where the crystal ends, or to its far plane of symmetry (m).
    pub half_width: f64,
}

impl Stack {
    /// Of a block for a body of revolution: it ends at the circle of the area of its cross-section.
    pub fn round(block: &Block) -> Self {
        Self { half_width: block.disk(), ..Self::across(block) }
    }

    /// Of a block for a lens that is the same all along y.
    pub fn across(block: &Block) -> Self {
        Self {
            diameter: block.diameter(),
            rows: block.layers(),
            spacing: block.layer_spacing(),
            half_width: block.half_widths()[0],
        }
    }

    /// Depth of a layer's centres (m); `row` may be fractional.
    pub fn depth(&self, row: f64) -> f64 {
        (row - 1.0) * self.spacing
    }
}

impl From<&HexagonalSheet> for Stack {
    fn from(sheet: &HexagonalSheet) -> Self {
        Self {
            diameter: sheet.diameter(),
            rows: sheet.rows(),
            spacing: sheet.row_spacing(),
            half_width: sheet.half_width(),
        }
    }
}
