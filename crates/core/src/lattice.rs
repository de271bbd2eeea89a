//! Where the sites of a crystal are: pure geometry, no matter.
//!
//! The wave runs along +z. Row 1 is struck and lies at z = 0; x = 0 is the lens axis. A design that is symmetric about the
//! axis is held as its half x ≥ 0, between mirror lines at x = 0 and x = half width.
//!
//! - here: the sheets that lenses are designed on, hexagonal or square, with rows of one size or of several
//! - `cell`, `crystal`: chains, sheets and crystals of every structure, orientation and outline
//! - `block`: close-packed crystals in space about the axis of a lens

mod block;
mod cell;
mod crystal;
#[cfg(test)]
mod crystal_tests;

pub use block::{Block, BlockError, BlockSide, Sixth};
pub use cell::Cell;
pub use crystal::{Crystal, CrystalError, CrystalSite, Outline, Width, hexagonal_distance};

use std::sync::Arc;

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
    /// No diameters of rows, or more of them than rows.
    #[error("{0} diameters for {1} rows")]
    Sizes(usize, u32),
    /// A row of spheres that are no spheres, or wider than the distance of columns.
    #[error("row {0} has spheres of {1} m, which must be positive and at most the distance of columns, {2} m")]
    Wide(u32, f64, f64),
    /// A row of spheres so small that those of the next row, or of the next but one, would fall through between them.
    #[error("the spheres of row {0} are too small to hold the rows before and behind them apart")]
    Small(u32),
}

/// How the rows of a sheet lie to each other.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SheetPacking {
    /// Each row in the hollows of the one before, half a diameter beside it.
    #[default]
    Hexagonal,
    /// Each sphere straight below one of the row before.
    Square,
}

impl SheetPacking {
    /// Both.
    pub const ALL: [Self; 2] = [Self::Hexagonal, Self::Square];

    /// Its name in files.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Hexagonal => "hexagonal-2d",
            Self::Square => "square-2d",
        }
    }
}

/// A two-dimensional sheet of spheres, rows across the wave: the half x ≥ 0 of a crystal that is mirrored at x = 0 and at x = half width.
///
/// In hexagonal packing odd rows have spheres at x/D = 0, 1, 2, ... and even rows at 0.5, 1.5, ...; rows of equal spheres are √3/2 D apart
/// (Burgoyne 2016, section 2.1.2). In square packing all rows have them at 0, 1, 2, ... and are D apart. Columns are D apart whatever the spheres: a row
/// may have smaller ones, which touch those of the rows beside it and not each other.
///
/// ```
/// let sheet = granulens_core::lattice::HexagonalSheet::new(6.35e-3, 50, 16.5).unwrap();
/// assert_eq!(sheet.sites().len(), 850);
/// ```
#[derive(Clone, Debug, PartialEq)]
pub struct HexagonalSheet {
    packing: SheetPacking,
    diameter: f64,
    rows: u32,
    half_diameters: u32,
    /// Where rows are not all of spheres of that diameter.
    sizes: Option<Arc<Sizes>>,
}

/// Of each row the diameter of its spheres and the depth of their centres (m).
#[derive(Clone, Debug, PartialEq)]
struct Sizes {
    diameters: Vec<f64>,
    depths: Vec<f64>,
}

impl HexagonalSheet {
    /// A hexagonal sheet of spheres of `diameter` (m), `rows` deep, out to a mirror line `half_width` diameters from the axis.
    ///
    /// # Errors
    /// See [`LatticeError`].
    pub fn new(diameter: f64, rows: u32, half_width: f64) -> Result<Self, LatticeError> {
        Self::packed(SheetPacking::Hexagonal, diameter, rows, half_width)
    }

    /// A sheet of either packing.
    ///
    /// # Errors
    /// See [`LatticeError`].
    pub fn packed(packing: SheetPacking, diameter: f64, rows: u32, half_width: f64) -> Result<Self, LatticeError> {
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
        Ok(Self { packing, diameter, rows, half_diameters: doubled as u32, sizes: None })
    }

    /// The same with spheres of these diameters (m) in rows 1, 2, ..., from the first again where there are more rows; each row touches the next.
    ///
    /// # Errors
    /// See [`LatticeError`].
    pub fn with_diameters(self, diameters: &[f64]) -> Result<Self, LatticeError> {
        if diameters.is_empty() || diameters.len() > self.rows as usize {
            return Err(LatticeError::Sizes(diameters.len(), self.rows));
        }
        let diameters: Vec<f64> = diameters.iter().copied().cycle().take(self.rows as usize).collect();
        for (&d, row) in diameters.iter().zip(1..) {
            if !(d.is_finite() && d > 0.0 && d <= self.diameter * (1.0 + 1e-9)) {
                return Err(LatticeError::Wide(row, d, self.diameter));
            }
        }
        if diameters.iter().all(|&d| d == self.diameter) {
            return Ok(Self { sizes: None, ..self });
        }
        // From one row to the next spheres lie so far beside each other.
        let aside = match self.packing {
            SheetPacking::Hexagonal => 0.5 * self.diameter,
            SheetPacking::Square => 0.0,
        };
        let mut depths = vec![0.0];
        for (row, two) in (1..).zip(diameters.windows(2)) {
            let reach = 0.5 * (two[0] + two[1]);
            let down = (reach * reach - aside * aside).sqrt();
            if down.is_nan() || down <= 0.0 {
                return Err(LatticeError::Small(row));
            }
            depths.push(depths[depths.len() - 1] + down);
        }
        for row in 0..diameters.len().saturating_sub(2) {
            let apart = depths[row + 2] - depths[row];
            if apart < 0.5 * (diameters[row] + diameters[row + 2]) * (1.0 - 1e-9) {
                return Err(LatticeError::Small(row as u32 + 2));
            }
        }
        Ok(Self { sizes: Some(Arc::new(Sizes { diameters, depths })), ..self })
    }

    /// The same, as wide as a mirror line `half_width` diameters from the axis leaves it.
    ///
    /// # Errors
    /// See [`LatticeError`].
    pub fn with_half_width(&self, half_width: f64) -> Result<Self, LatticeError> {
        let Self { half_diameters, .. } = Self::packed(self.packing, self.diameter, self.rows, half_width)?;
        Ok(Self { half_diameters, ..self.clone() })
    }

    /// How its rows lie to each other.
    pub fn packing(&self) -> SheetPacking {
        self.packing
    }

    /// Distance of columns D (m), and the diameter of the spheres where rows have none of their own.
    pub fn diameter(&self) -> f64 {
        self.diameter
    }

    /// Diameter of the spheres of a row (m).
    pub fn row_diameter(&self, row: u32) -> f64 {
        self.sizes.as_ref().map_or(self.diameter, |sizes| sizes.diameters[row as usize - 1])
    }

    /// Diameters that occur (m), each once, in order of the rows.
    pub fn diameters(&self) -> Vec<f64> {
        let Some(sizes) = &self.sizes else { return vec![self.diameter] };
        let mut all: Vec<f64> = Vec::new();
        for &d in &sizes.diameters {
            if !all.contains(&d) {
                all.push(d);
            }
        }
        all
    }

    /// Whether its spheres are equal.
    pub fn is_equal(&self) -> bool {
        self.sizes.is_none()
    }

    /// Whether it is a hexagonal sheet of equal spheres, in which waves run alike in all directions, as rays suppose.
    pub fn is_close_packed(&self) -> bool {
        self.packing == SheetPacking::Hexagonal && self.is_equal()
    }

    /// Number of rows.
    pub fn rows(&self) -> u32 {
        self.rows
    }

    /// Distance from the axis to the far mirror line (m).
    pub fn half_width(&self) -> f64 {
        f64::from(self.half_diameters) * 0.5 * self.diameter
    }

    /// Distance between rows (m), √3/2 D in hexagonal packing of equal spheres; where they are unequal in the mean.
    pub fn row_spacing(&self) -> f64 {
        match (&self.sizes, self.packing) {
            (Some(sizes), _) => sizes.depths[sizes.depths.len() - 1] / f64::from(self.rows - 1),
            (None, SheetPacking::Hexagonal) => 0.75_f64.sqrt() * self.diameter,
            (None, SheetPacking::Square) => self.diameter,
        }
    }

    /// Depth of a row's centres (m); `row` may be fractional, as in a lens face between two rows, and lie behind the last.
    pub fn depth(&self, row: f64) -> f64 {
        let Some(sizes) = &self.sizes else { return (row - 1.0) * self.row_spacing() };
        let last = sizes.depths.len() - 1;
        let before = ((row - 1.0).max(0.0).floor() as usize).min(last - 1);
        let [near, far] = [sizes.depths[before], sizes.depths[before + 1]];
        near + (row - 1.0 - before as f64) * (far - near)
    }

    /// Number of sites in a row.
    pub fn columns(&self, row: u32) -> u32 {
        let first = self.first_position(row);
        (self.half_diameters - first) / 2 + 1
    }

    /// Half-diameters from the axis to the first site of a row: 0, but 1 in even rows of hexagonal packing.
    fn first_position(&self, row: u32) -> u32 {
        match self.packing {
            SheetPacking::Hexagonal => (row + 1) % 2,
            SheetPacking::Square => 0,
        }
    }

    /// The site at a row and column; both count from 1.
    pub fn site(&self, row: u32, column: u32) -> Option<Site> {
        if row < 1 || row > self.rows || column < 1 || column > self.columns(row) {
            return None;
        }
        let position = self.first_position(row) + 2 * (column - 1);
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

    /// In square packing all rows are alike and D apart.
    #[test]
    fn a_square_sheet_has_its_spheres_straight_below_each_other() {
        let sheet = HexagonalSheet::packed(SheetPacking::Square, 2.0, 5, 3.5).unwrap();
        for (index, site) in sheet.sites().iter().enumerate() {
            assert_eq!((sheet.index(site.row, site.column), site.z), (Some(index), 2.0 * f64::from(site.row - 1)));
            assert_eq!(site.x, 2.0 * f64::from(site.column - 1));
        }
        assert_eq!(sheet.len(), 20);
    }

    /// Whatever their sizes, spheres of two rows beside each other touch and no others overlap.
    #[test]
    fn rows_of_several_sizes_touch() {
        for (packing, diameters) in [
            (SheetPacking::Hexagonal, vec![1.0, 0.8]),
            (SheetPacking::Hexagonal, vec![0.7, 1.0, 0.9]),
            (SheetPacking::Square, vec![1.0, 0.3]),
        ] {
            let sheet = HexagonalSheet::packed(packing, 1.0, 9, 3.0).unwrap().with_diameters(&diameters).unwrap();
            let sites = sheet.sites();
            let mut touching = vec![0; sites.len()];
            for (i, a) in sites.iter().enumerate() {
                for (j, b) in sites.iter().enumerate().skip(i + 1) {
                    let reach = 0.5 * (sheet.row_diameter(a.row) + sheet.row_diameter(b.row));
                    let gap = (a.x - b.x).hypot(a.z - b.z) - reach;
                    assert!(gap > -1e-12, "{packing:?} {a:?} {b:?} {gap}");
                    if gap < 1e-12 && a.row != b.row {
                        (touching[i], touching[j]) = (touching[i] + 1, touching[j] + 1);
                    }
                }
            }
            // Two above and two below, or one and one; away from the mirror lines.
            let expected = if packing == SheetPacking::Hexagonal { 4 } else { 2 };
            for (site, touching) in sites.iter().zip(&touching) {
                if (2..9).contains(&site.row) && (0.75..2.25).contains(&site.x) {
                    assert_eq!(*touching, expected, "{packing:?} {site:?}");
                }
            }
            assert!((sheet.depth(1.5) - 0.5 * sheet.depth(2.0)).abs() < 1e-12);
            assert!(sheet.depth(12.0) > sheet.depth(9.0));
        }
        let sheet = HexagonalSheet::new(1.0, 5, 3.0).unwrap();
        let with = |diameters: &[f64]| sheet.clone().with_diameters(diameters).unwrap_err();
        assert_eq!(with(&[]), LatticeError::Sizes(0, 5));
        assert_eq!(with(&[1.0, 1.1]), LatticeError::Wide(2, 1.1, 1.0));
        assert!(matches!(with(&[1.0, f64::NAN]), LatticeError::Wide(2, ..)));
        // Rows of half the size do not touch; between smaller ones the rows beside meet.
        assert_eq!(with(&[0.5]), LatticeError::Small(1));
        assert_eq!(with(&[1.0, 0.3]), LatticeError::Small(2));
        assert!(sheet.clone().with_diameters(&[1.0]).unwrap().is_close_packed());
    }

    #[test]
    fn what_cannot_be_laid_is_refused() {
        assert_eq!(HexagonalSheet::new(-1.0, 5, 2.0), Err(LatticeError::Diameter(-1.0)));
        assert_eq!(HexagonalSheet::new(1.0, 1, 2.0), Err(LatticeError::Rows(1)));
        assert_eq!(HexagonalSheet::new(1.0, 5, 2.25), Err(LatticeError::HalfWidth(2.25)));
        assert!(HexagonalSheet::new(1.0, 5, f64::NAN).is_err());
    }
}
