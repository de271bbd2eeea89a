//! Where the sites of a crystal are: pure geometry, no matter.
//!
//! The wave runs along +z. Row 1 is struck and lies at z = 0; x = 0 is the lens axis. A design that is symmetric about the
//! axis is held as its half x ≥ 0, between mirror lines at x = 0 and x = half width.
//!
//! - here: the hexagonal sheet that lenses are designed on
//! - `cell`, `crystal`: chains, sheets and crystals of every structure, orientation and outline
//! - `block`: close-packed crystals in space about the axis of a lens

mod block;
mod cell;
mod crystal;
#[cfg(test)]
mod crystal_tests;

pub use block::{Block, BlockError, BlockSide};
pub use cell::Cell;
pub use crystal::{Crystal, CrystalError, CrystalSite, Outline, Width, hexagonal_distance};

use serde::{Deserialize, Serialize};

/// Sites in layers across the wave, numbered layer by layer.
pub trait Layered {
    /// Number of layers.
    fn layers(&self) -> u32;
    /// Indices of the sites of a layer, from 1 on.
    fn layer(&self, layer: u32) -> std::ops::Range<usize>;
}

/// One lattice site.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Site {
    /// Row, from 1 (struck) on.
    pub row: u32,
    /// Column within the row, from 1 on in order of x.
    pub column: u32,
    /// Distance from the lens axis (m).
    pub x: f64,
    /// Depth below row 1 (m).
    pub z: f64,
}

/// Why a lattice cannot be laid.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LatticeError {
    /// The sphere diameter is not a positive number.
    #[error("diameter {0} m must be positive")]
    Diameter(f64),
    /// Fewer than two rows, or more than the indices hold.
    #[error("{0} rows: a crystal has 2 to 100000 of them")]
    Rows(u32),
    /// Mirror lines pass through sphere centres or midway between them, so only multiples of 0.5 D fit.
    #[error(
        "half_width {0} must be a multiple of 0.5 diameters, from 1 to 50000: mirror lines pass through or between spheres"
    )]
    HalfWidth(f64),
}

/// A two-dimensional hexagonal sheet of touching equal spheres, rows across the wave: the half x ≥ 0 of a crystal that is
/// mirrored at x = 0 and at x = half width.
///
/// Odd rows have spheres at x/D = 0, 1, 2, ...; even rows at 0.5, 1.5, ...; rows are √3/2 D apart
/// (Burgoyne 2016, section 2.1.2).
///
/// ```
/// let sheet = granulens_core::lattice::HexagonalSheet::new(6.35e-3, 50, 16.5).unwrap();
/// assert_eq!(sheet.sites().len(), 850);
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HexagonalSheet {
    diameter: f64,
    rows: u32,
    half_diameters: u32,
}

impl HexagonalSheet {
    /// A sheet of spheres of `diameter` (m), `rows` deep, out to a mirror line `half_width` diameters from the axis.
    ///
    /// # Errors
    /// See [`LatticeError`].
    pub fn new(diameter: f64, rows: u32, half_width: f64) -> Result<Self, LatticeError> {
        if !(diameter.is_finite() && diameter > 0.0) {
            return Err(LatticeError::Diameter(diameter));
        }
        if !(2..=100_000).contains(&rows) {
            return Err(LatticeError::Rows(rows));
        }
        let doubled = half_width * 2.0;
        if !(doubled.is_finite() && doubled.fract() == 0.0 && (2.0..=100_000.0).contains(&doubled)) {
            return Err(LatticeError::HalfWidth(half_width));
        }
        Ok(Self { diameter, rows, half_diameters: doubled as u32 })
    }

    /// Sphere diameter D (m).
    pub fn diameter(&self) -> f64 {
        self.diameter
    }

    /// Number of rows.
    pub fn rows(&self) -> u32 {
        self.rows
    }

    /// Distance from the axis to the far mirror line (m).
    pub fn half_width(&self) -> f64 {
        f64::from(self.half_diameters) * 0.5 * self.diameter
    }

    /// Distance between rows, √3/2 D (m).
    pub fn row_spacing(&self) -> f64 {
        0.75_f64.sqrt() * self.diameter
    }

    /// Depth of a row's centres (m); `row` may be fractional, as in a lens face between two rows.
    pub fn depth(&self, row: f64) -> f64 {
        (row - 1.0) * self.row_spacing()
    }

    /// Number of sites in a row.
    pub fn columns(&self, row: u32) -> u32 {
        let first = Self::first_position(row);
        (self.half_diameters - first) / 2 + 1
    }

    /// Half-diameters from the axis to the first site of a row: 0 in odd rows, 1 in even ones.
    fn first_position(row: u32) -> u32 {
        (row + 1) % 2
    }

    /// The site at a row and column; both count from 1.
    pub fn site(&self, row: u32, column: u32) -> Option<Site> {
        if row < 1 || row > self.rows || column < 1 || column > self.columns(row) {
            return None;
        }
        let position = Self::first_position(row) + 2 * (column - 1);
        let x = f64::from(position) * 0.5 * self.diameter;
        Some(Site { row, column, x, z: self.depth(f64::from(row)) })
    }

    /// All sites, row by row, each row in order of x. Indices elsewhere count in this order.
    pub fn sites(&self) -> Vec<Site> {
        (1..=self.rows)
            .flat_map(|row| (1..=self.columns(row)).filter_map(move |column| self.site(row, column)))
            .collect()
    }

    /// Index of a site in [`sites`](Self::sites).
    pub fn index(&self, row: u32, column: u32) -> Option<usize> {
        self.site(row, column)?;
        let pair = (self.columns(1) + self.columns(2)) as usize;
        let before = (row as usize - 1) / 2 * pair + if row.is_multiple_of(2) { self.columns(1) as usize } else { 0 };
        Some(before + column as usize - 1)
    }

    /// Number of sites.
    pub fn len(&self) -> usize {
        (1..=self.rows).map(|row| self.columns(row) as usize).sum()
    }

    /// Never: a sheet has at least two rows. Here because `len` is.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

impl Layered for HexagonalSheet {
    fn layers(&self) -> u32 {
        self.rows
    }

    fn layer(&self, layer: u32) -> std::ops::Range<usize> {
        let start = self.index(layer, 1).unwrap_or_default();
        start..start + self.columns(layer) as usize
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn indices_follow_the_order_of_sites() {
        for half_width in [1.0, 2.5, 16.0, 16.5] {
            let sheet = HexagonalSheet::new(1.0, 7, half_width).unwrap();
            for (index, site) in sheet.sites().iter().enumerate() {
                assert_eq!(sheet.index(site.row, site.column), Some(index));
                assert!(sheet.layer(site.row).contains(&index));
            }
            assert_eq!(sheet.layer(7).end, sheet.len());
            assert_eq!(sheet.len(), sheet.sites().len());
        }
    }

    #[test]
    fn the_lens_crystal_has_seventeen_spheres_in_every_row() {
        let sheet = HexagonalSheet::new(6.35e-3, 50, 16.5).unwrap();
        let sites = sheet.sites();
        for row in 1..=50 {
            let xs: Vec<f64> = sites.iter().filter(|s| s.row == row).map(|s| s.x / 6.35e-3).collect();
            assert_eq!(xs.len(), 17);
            assert!((xs[0] - if row % 2 == 1 { 0.0 } else { 0.5 }).abs() < 1e-12);
        }
        assert_eq!(sheet.index(51, 1), None);
        assert_eq!(sheet.index(1, 18), None);
    }

    #[test]
    fn what_cannot_be_laid_is_refused() {
        assert_eq!(HexagonalSheet::new(-1.0, 5, 2.0), Err(LatticeError::Diameter(-1.0)));
        assert_eq!(HexagonalSheet::new(1.0, 1, 2.0), Err(LatticeError::Rows(1)));
        assert_eq!(HexagonalSheet::new(1.0, 5, 2.25), Err(LatticeError::HalfWidth(2.25)));
        assert!(HexagonalSheet::new(1.0, 5, f64::NAN).is_err());
    }
}
