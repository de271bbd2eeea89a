//! Where the spheres of a sheet lie, and where their numbers stand in memory.

use crate::lattice::HexagonalSheet;

/// What stands at the two sides of a sheet.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sides {
    /// Nothing.
    Open,
    /// The sheet again.
    Periodic,
    /// Mirror lines, at x = 0 and through or half a spacing beyond the last sphere of the widest row.
    Mirrors,
}

/// A hexagonal sheet of equal spheres, row by row in depth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Grid {
    /// Number of rows.
    pub rows: usize,
    /// Spheres in the rows 1, 3, 5, ..., the first of which lies at x = 0, and in the rows between, half a spacing further.
    pub columns: [usize; 2],
    /// Of the spheres (m).
    pub diameter: f64,
    /// Distance of neighbouring centres at rest (m): the diameter, or less where the sheet is squeezed.
    pub spacing: f64,
    /// What stands at the sides.
    pub sides: Sides,
    /// Whether the first row follows on the last again.
    pub joined: bool,
}

/// A sheet that cannot be.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum GridError {
    /// Too few rows or columns for neighbours that differ.
    #[error("a sheet has at least 2 rows of 3 spheres, this one has {rows} rows of {columns:?}")]
    Small {
        /// Rows.
        rows: usize,
        /// Columns of both kinds of rows.
        columns: [usize; 2],
    },
    /// Columns that do not go with the sides.
    #[error(
        "rows of {0:?} spheres do not go with these sides: equal rows, or the second row one shorter unless periodic"
    )]
    Columns([usize; 2]),
    /// The last row must lie as the second one to be followed by the first.
    #[error("{0} rows cannot be followed by the first one: their number must be even")]
    Odd(usize),
    /// Spheres that do not touch at rest, or are squeezed beyond what a contact law can say.
    #[error("a spacing of {spacing} m does not go with a diameter of {diameter} m: from 0.75 of it to all of it")]
    Spacing {
        /// Distance of centres (m).
        spacing: f64,
        /// Diameter (m).
        diameter: f64,
    },
}

impl Grid {
    /// The sheet that lenses are designed on, between its mirrors.
    pub fn of_lattice(lattice: &HexagonalSheet) -> Self {
        Self {
            rows: lattice.rows() as usize,
            columns: [1, 2].map(|row| lattice.columns(row) as usize),
            diameter: lattice.diameter(),
            spacing: lattice.diameter(),
            sides: Sides::Mirrors,
            joined: false,
        }
    }

    /// Number of spheres.
    pub fn len(&self) -> usize {
        self.rows.div_ceil(2) * self.columns[0] + self.rows / 2 * self.columns[1]
    }

    /// Whether there are no spheres.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Centre of a sphere at rest (m), x and depth; rows and columns count from 0.
    pub fn centre(&self, row: usize, column: usize) -> [f64; 2] {
        let half = if row % 2 == 1 { 0.5 } else { 0.0 };
        [(column as f64 + half) * self.spacing, row as f64 * 0.75_f64.sqrt() * self.spacing]
    }

    /// Row and column of every sphere, in the order in which spheres are numbered.
    pub fn sites(&self) -> impl Iterator<Item = [usize; 2]> + '_ {
        (0..self.rows).flat_map(|row| (0..self.columns[row % 2]).map(move |column| [row, column]))
    }

    pub(super) fn check(&self) -> Result<(), GridError> {
        let [first, second] = self.columns;
        if self.rows < 2 || first < 3 || second < 2 {
            return Err(GridError::Small { rows: self.rows, columns: self.columns });
        }
        let shorter = self.sides != Sides::Periodic && second + 1 == first;
        if first != second && !shorter {
            return Err(GridError::Columns(self.columns));
        }
        if self.joined && !self.rows.is_multiple_of(2) {
            return Err(GridError::Odd(self.rows));
        }
        let precompress = self.spacing / self.diameter;
        if !(self.diameter > 0.0 && self.diameter.is_finite() && (0.75..=1.0).contains(&precompress)) {
            return Err(GridError::Spacing { spacing: self.spacing, diameter: self.diameter });
        }
        Ok(())
    }
}

/// A place in a row that holds no sphere of its own but the image of one: the place, the sphere's, and the sign that its
/// motion across takes.
pub(super) type Ghost = (usize, usize, f64);

/// How a sheet stands in memory. Each row begins with a place for the image of a neighbour on its left, then come its
/// spheres, then a place for that on its right, and room that makes the row a whole number of registers long. Where designs
/// stand side by side, each place holds one number per design.
#[derive(Clone, Debug)]
pub(super) struct Store {
    /// Numbers from a place to the next one: designs side by side.
    pub site: usize,
    /// Numbers from a row to the next one.
    pub stride: usize,
    /// Numbers of a row that are swept: up to the last sphere, in whole registers.
    pub swept: usize,
    /// For both kinds of rows, the images that they hold.
    pub ghosts: [Vec<Ghost>; 2],
}

impl Store {
    /// For so many designs side by side, or for one design whose columns stand side by side in registers of `lanes`.
    pub fn new(grid: &Grid, designs: usize, lanes: usize) -> Self {
        let widest = grid.columns[0].max(grid.columns[1]);
        // The image on the right is read, as the neighbour of the last sphere, but not swept.
        let (swept, stride) = if designs > 1 {
            ((widest + 1) * designs, (widest + 2) * designs)
        } else {
            let swept = (widest + 1).next_multiple_of(lanes);
            (swept, (swept + 1).next_multiple_of(8))
        };
        let ghosts = [0, 1].map(|parity| {
            let last = grid.columns[parity];
            match grid.sides {
                Sides::Open => Vec::new(),
                Sides::Periodic => vec![(0, last, 1.0), (last + 1, 1, 1.0)],
                Sides::Mirrors => {
                    // The line lies through the last sphere of the row that reaches furthest.
                    let on_line = (parity == 0) == (grid.columns[0] > grid.columns[1]);
                    let left = if parity == 0 { 2 } else { 1 };
                    let right = if on_line { last - 1 } else { last };
                    vec![(0, left, -1.0), (last + 1, right, -1.0)]
                }
            }
        });
        Self { site: designs, stride, swept, ghosts }
    }

    /// Where the first number of a place is; columns count from 0 at the first sphere, −1 is the image to its left.
    pub fn at(&self, row: usize, column: usize) -> usize {
        row * self.stride + (column + 1) * self.site
    }
}
