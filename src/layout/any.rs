//! A layout of either kind: of a sheet, or of a crystal in space.

use super::{Layout, write, write_in_space};
use crate::lattice::Block;
use crate::material::Material;

/// A layout of either kind.
#[derive(Clone, Debug, PartialEq)]
pub enum AnyLayout {
    /// Of a sheet.
    Plane(Layout),
    /// Of a crystal in space.
    Space(Layout<Block>),
}

impl AnyLayout {
    /// The materials that occur.
    pub fn palette(&self) -> &[Material] {
        match self {
            Self::Plane(layout) => &layout.palette,
            Self::Space(layout) => &layout.palette,
        }
    }

    /// For each site its place in the palette.
    pub fn materials(&self) -> &[u8] {
        match self {
            Self::Plane(layout) => &layout.materials,
            Self::Space(layout) => &layout.materials,
        }
    }

    /// The simulated half as CSV text.
    pub fn csv(&self) -> String {
        match self {
            Self::Plane(layout) => write(layout),
            Self::Space(layout) => write_in_space(layout),
        }
    }
}
