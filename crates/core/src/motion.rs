//! How grains really move: the affine map that fits the displacements around each grain best, and what it leaves.
//!
//! Falk and Langer, PRE 57, 7192 (1998), as Kondic et al. (2012, eqs 3 and 4) use it. Around grain 0 with neighbours m, those
//! within R of it at first, Δ_m = r_m − r_0 before and Δ'_m after:
//!
//!   D² = Σ_m |Δ'_m − A Δ_m|²   is least for   A = (Σ Δ' ⊗ Δ) (Σ Δ ⊗ Δ)⁻¹.

use crate::period::nearest_image;

/// What the motion around one grain is like.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Local {
    /// Neighbours within the radius.
    pub neighbours: usize,
    /// D²_min, summed over the neighbours (square of the places' unit; Falk and Langer 1998, eq. 2.11, without the mean); none below three neighbours.
    pub d2min: Option<f64>,
    /// A, the affine map Δ' ≈ A Δ of the vectors to the neighbours, by rows (x, z); none below three neighbours, or where all lie on one line and A is not determined.
    pub map: Option<[[f64; 2]; 2]>,
}

/// The least number of neighbours by which anything is said.
pub const FEWEST: usize = 3;

/// K's radius of the neighbourhood, in mean diameters.
pub const RADIUS: f64 = 2.5;

/// What cannot be followed.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum MotionError {
    /// Not as many places after as before.
    #[error("{before} grains before and {after} after")]
    Count {
        /// How many before.
        before: usize,
        /// How many after.
        after: usize,
    },
    /// Places that are no finite numbers.
    #[error("grain {0} has a place that is no finite number")]
    Number(usize),
    /// A radius that is not positive.
    #[error("the radius {0} is not positive and finite")]
    Radius(f64),
    /// A period that is not positive.
    #[error("the period {0} is not positive and finite")]
    Period(f64),
    /// A neighbourhood that meets itself round the periodic sides.
    #[error("the radius {radius} is more than half the period {period}")]
    Wide {
        /// Radius.
        radius: f64,
        /// Period.
        period: f64,
    },
}

/// The motion around every grain between two moments, by neighbours within `radius` before, with `period` along x where there is one, both in the
/// unit of the places.
///
/// # Errors
/// See [`MotionError`].
pub fn follow(
    before: &[[f64; 2]],
    after: &[[f64; 2]],
    radius: f64,
    period: Option<f64>,
) -> Result<Vec<Local>, MotionError> {
    if before.len() != after.len() {
        return Err(MotionError::Count { before: before.len(), after: after.len() });
    }
    let positive = |x: f64| x > 0.0 && x.is_finite();
    if !positive(radius) {
        return Err(MotionError::Radius(radius));
    }
    if let Some(period) = period {
        if !positive(period) {
            return Err(MotionError::Period(period));
        }
        if 2.0 * radius > period {
            return Err(MotionError::Wide { radius, period });
        }
    }
    let finite = |place: &[f64; 2]| place.iter().all(|x| x.is_finite());
    if let Some(grain) = (0..before.len()).find(|&i| !(finite(&before[i]) && finite(&after[i]))) {
        return Err(MotionError::Number(grain));
    }
    let nearest = |x: f64| period.map_or(x, |period| nearest_image(x, period));
    let rows = Rows::new(before, radius, period);
    let around = |i: usize| {
        let mut moves: Vec<Move> = Vec::new();
        rows.near(before[i], |m| {
            let old = [nearest(before[m][0] - before[i][0]), before[m][1] - before[i][1]];
            if m != i && old[0] * old[0] + old[1] * old[1] <= radius * radius {
                // Of the images afterwards the one that has moved least against the grain in the middle.
                let across = nearest(after[m][0] - after[i][0] - old[0]);
                moves.push(Move { at: m, old, by: [across, after[m][1] - after[i][1] - old[1]] });
            }
        });
        // In one order, whatever the rows.
        moves.sort_unstable_by_key(|one| one.at);
        fit(&moves)
    };
    Ok((0..before.len()).map(around).collect())
}

/// A neighbour: where it was, and how far it moved, both from the grain in the middle.
struct Move {
    at: usize,
    old: [f64; 2],
    by: [f64; 2],
}

/// Least squares for the change A − 1, which is zero to the last bit where nothing moves.
fn fit(moves: &[Move]) -> Local {
    let neighbours = moves.len();
    if neighbours < FEWEST {
        return Local { neighbours, d2min: None, map: None };
    }
    let sum = |of: &dyn Fn(&Move) -> f64| moves.iter().map(of).sum::<f64>();
    let (xx, xz, zz) = (sum(&|m| m.old[0] * m.old[0]), sum(&|m| m.old[0] * m.old[1]), sum(&|m| m.old[1] * m.old[1]));
    let cross: [[f64; 2]; 2] = std::array::from_fn(|i| std::array::from_fn(|k| sum(&|m| m.by[i] * m.old[k])));
    let determinant = xx * zz - xz * xz;
    let trace = xx + zz;
    let flat = determinant <= FLAT * trace * trace;
    let change = cross.map(|[x, z]| match flat {
        // On a line with direction e, Σ Δ ⊗ Δ is trace · e ⊗ e, whose pseudo-inverse is e ⊗ e over the trace.
        true => [(x * xx + z * xz) / (trace * trace), (x * xz + z * zz) / (trace * trace)],
        false => [(x * zz - z * xz) / determinant, (z * xx - x * xz) / determinant],
    });
    let left = |m: &Move| {
        let rest = |i: usize| m.by[i] - change[i][0] * m.old[0] - change[i][1] * m.old[1];
        rest(0) * rest(0) + rest(1) * rest(1)
    };
    let map = [[1.0 + change[0][0], change[0][1]], [change[1][0], 1.0 + change[1][1]]];
    Local { neighbours, d2min: Some(moves.iter().map(left).sum()), map: (!flat).then_some(map) }
}

/// Neighbours lie on one line where the lesser principal value of Σ Δ ⊗ Δ is below this part of the greater.
const FLAT: f64 = 1e-12;

impl Local {
    /// ‖A − 1‖, the Frobenius norm of the displacement gradient.
    pub fn gradient_norm(&self) -> Option<f64> {
        self.map.map(|[[a, b], [c, d]]| ((a - 1.0).powi(2) + b * b + c * c + (d - 1.0).powi(2)).sqrt())
    }

    /// By how much the neighbourhood has turned (rad), from x towards z: the rotation of A's polar decomposition.
    pub fn rotation(&self) -> Option<f64> {
        self.map.map(|[[a, b], [c, d]]| (c - b).atan2(a + d))
    }

    /// Green and Lagrange's strain E = (AᵀA − 1)/2, as [xx, xz, zz].
    pub fn strain(&self) -> Option<[f64; 3]> {
        self.map
            .map(|[[a, b], [c, d]]| [0.5 * (a * a + c * c - 1.0), 0.5 * (a * b + c * d), 0.5 * (b * b + d * d - 1.0)])
    }

    /// Von Mises' shear strain of E in the plane: half the difference of its principal values.
    pub fn shear(&self) -> Option<f64> {
        self.strain().map(|[xx, xz, zz]| (0.5 * (xx - zz)).hypot(xz))
    }
}

/// Grains in rows along x as high as the reach, each in order of x.
struct Rows {
    low: f64,
    /// A little more than the radius, so that rounding leaves none out.
    reach: f64,
    period: Option<f64>,
    rows: std::collections::BTreeMap<i64, Vec<(f64, usize)>>,
}

impl Rows {
    fn new(places: &[[f64; 2]], radius: f64, period: Option<f64>) -> Self {
        let low = places.iter().map(|place| place[1]).fold(f64::INFINITY, f64::min);
        let mut rows = Self { low, reach: radius * (1.0 + 1e-9), period, rows: std::collections::BTreeMap::new() };
        for (i, &place) in places.iter().enumerate() {
            let (row, x) = (rows.row(place[1]), rows.inside(place[0]));
            rows.rows.entry(row).or_default().push((x, i));
        }
        rows.rows.values_mut().for_each(|row| row.sort_unstable_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1))));
        rows
    }

    fn row(&self, z: f64) -> i64 {
        ((z - self.low) / self.reach).floor() as i64
    }

    fn inside(&self, x: f64) -> f64 {
        self.period.map_or(x, |period| x.rem_euclid(period))
    }

    /// Shows every grain that may be near, once, and perhaps some that are not.
    fn near(&self, place: [f64; 2], mut show: impl FnMut(usize)) {
        let (x, row) = (self.inside(place[0]), self.row(place[1]));
        let reach = self.reach;
        let shifts: &[f64] = if self.period.is_some() { &[-1.0, 0.0, 1.0] } else { &[0.0] };
        for (_, row) in self.rows.range(row - 1..=row + 1) {
            match self.period {
                // So narrow that the windows of two images overlap.
                Some(period) if 2.0 * reach >= period => row.iter().for_each(|&(_, i)| show(i)),
                _ => {
                    for shift in shifts {
                        let middle = x + shift * self.period.unwrap_or(0.0);
                        let from = row.partition_point(|other| other.0 < middle - reach);
                        row[from..].iter().take_while(|other| other.0 <= middle + reach).for_each(|&(_, i)| show(i));
                    }
                }
            }
        }
    }
}
