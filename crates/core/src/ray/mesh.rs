//! The mesh of first arrivals: the sites of a hexagonal sheet, or points a whole number of times as dense.

use crate::lattice::HexagonalSheet;

/// Equilateral triangles between the mirror lines, row 1 and the last row. Points are counted row by row from the axis on; places across
/// are in half steps from the axis, of even rows (from 0 on) even ones, of odd rows odd ones.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Mesh {
    /// Side of a triangle (m).
    pub step: f64,
    /// Rows.
    pub rows: u32,
    /// Half steps from mirror line to mirror line.
    width: i64,
    /// Points of even and of odd rows.
    points: [usize; 2],
}

/// No neighbour: beyond the first or the last row.
pub(super) const NONE: u32 = u32::MAX;

impl Mesh {
    /// `finer` times as dense as the sites; at least 1.
    pub fn new(lattice: &HexagonalSheet, finer: u32) -> Self {
        let width = (2.0 * lattice.half_width() / lattice.diameter()).round() as i64 * i64::from(finer);
        let points = [0, 1].map(|first| ((width - first) / 2 + 1) as usize);
        let step = lattice.diameter() / f64::from(finer);
        Self { step, rows: (lattice.rows() - 1) * finer + 1, width, points }
    }

    /// Number of points.
    pub fn len(&self) -> usize {
        self.start(self.rows)
    }

    /// Number of points in a row, from 0 on.
    pub fn points(&self, row: u32) -> usize {
        self.points[row as usize % 2]
    }

    /// Index of the first point of a row.
    pub fn start(&self, row: u32) -> usize {
        (row as usize / 2) * (self.points[0] + self.points[1]) + if row % 2 == 1 { self.points[0] } else { 0 }
    }

    /// Where the k-th point of a row lies (m).
    pub fn at(&self, row: u32, k: usize) -> [f64; 2] {
        let half_steps = 2 * k as i64 + i64::from(row % 2);
        [half_steps as f64 * 0.5 * self.step, f64::from(row) * 0.75_f64.sqrt() * self.step]
    }

    /// The point at a row and so many half steps from the axis, mirrored into the crystal.
    pub fn index(&self, row: i64, half_steps: i64) -> Option<usize> {
        let row = u32::try_from(row).ok().filter(|row| *row < self.rows)?;
        let inside = half_steps.abs();
        let inside = if inside > self.width { 2 * self.width - inside } else { inside };
        Some(self.start(row) + usize::try_from(inside / 2).ok()?)
    }

    /// The six neighbours of every point, in order around it, or [`NONE`].
    pub fn neighbours(&self) -> Vec<[u32; 6]> {
        let mut all = Vec::with_capacity(self.len());
        let short = |index: usize| u32::try_from(index).unwrap_or(NONE);
        for row in 0..self.rows {
            let (above, here, below) =
                (row.checked_sub(1).map(|row| self.start(row)), self.start(row), self.start(row + 1));
            let below = (row + 1 < self.rows).then_some(below);
            // Half a step to the left and to the right in the rows beside this one are so many places from the same k.
            let [left, right] = if row.is_multiple_of(2) { [-1, 0] } else { [0, 1] };
            let beside = self.points(row + 1) as i64;
            let last = self.points(row) as i64;
            // A place beyond either end is the mirror image of one within: of the end itself where the row has a point on the
            // mirror line, of its neighbour where it has not.
            let within = |k: i64, row: u32, points: i64| {
                let on_axis = row.is_multiple_of(2);
                let on_far = (self.width - i64::from(row % 2)) % 2 == 0;
                let low = if k < 0 { if on_axis { -k } else { -k - 1 } } else { k };
                let high = if low < points { low } else { 2 * (points - 1) - low + i64::from(!on_far) };
                high as usize
            };
            for k in 0..last {
                let beyond = |start: Option<usize>, k: i64| {
                    start.map_or(NONE, |start| short(start + within(k, row + 1, beside)))
                };
                all.push([
                    short(here + within(k + 1, row, last)),
                    beyond(below, k + right),
                    beyond(below, k + left),
                    short(here + within(k - 1, row, last)),
                    beyond(above, k + left),
                    beyond(above, k + right),
                ]);
            }
        }
        all
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// What `index` says of every place around every point, for widths that end in even and in odd rows.
    #[test]
    fn neighbours_are_the_places_around_a_point() {
        for (half_width, finer) in [(3.0, 1), (2.5, 1), (2.5, 3), (3.0, 2)] {
            let mesh = Mesh::new(&HexagonalSheet::new(1.0, 5, half_width).unwrap(), finer);
            let neighbours = mesh.neighbours();
            let mut point = 0;
            for row in 0..mesh.rows {
                for k in 0..mesh.points(row) {
                    let (row, p) = (i64::from(row), 2 * k as i64 + i64::from(row % 2));
                    let around = [(0, 2), (1, 1), (1, -1), (0, -2), (-1, -1), (-1, 1)];
                    let expected =
                        around.map(|(down, across)| mesh.index(row + down, p + across).map_or(NONE, |n| n as u32));
                    assert_eq!(neighbours[point], expected, "{half_width} {finer} {row} {p}");
                    point += 1;
                }
            }
            assert_eq!(point, mesh.len());
        }
    }
}
