//! The plano-convex lens on the hexagonal sheet.

use super::Stack;
use crate::lattice::{HexagonalSheet, Site};
use crate::ray::PlanoConvex;

/// A lens with a circular front, convex towards the impact, and a flat back.
///
/// A site belongs to it if apex row ≤ row ≤ back row and depth(row) − depth(apex row) ≥ R − √(R² − x²). The ideal faces that
/// rays meet pass through sphere centres as this rule does: the apex at the depth of the apex row, the back at that of the
/// back row. So the lens of Burgoyne 2016, fig. 5.16 (rows 5 to 16, R = 16.5 D/sin 60°) ends in its rim of 60° exactly where
/// its faces meet, at the mirror line, and its rays cross the axis at rows 40.97 (paraxial) and 28.62 (rim), the rows 41
/// and 29 stated for it. With the back half a row deeper it would be 41.17 and 28.93, and a front that ends above it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shape {
    /// Row of the apex on the axis.
    pub apex_row: u32,
    /// Last row, that of the flat face.
    pub back_row: u32,
    /// Radius of the curved face (m).
    pub radius: f64,
}

impl Shape {
    /// The lens as rays see it.
    pub fn bench(&self, stack: impl Into<Stack>, speeds: [f64; 2]) -> PlanoConvex {
        let stack = stack.into();
        PlanoConvex {
            apex: stack.depth(f64::from(self.apex_row)),
            radius: self.radius,
            back: stack.depth(f64::from(self.back_row)),
            half_width: stack.half_width,
            end: stack.depth(f64::from(stack.rows)),
            speeds,
        }
    }

    /// Whether a site holds lens material. Sites on the face count as inside to one part in 10⁹ of the diameter: in the
    /// published lens one of them lies on it exactly.
    pub fn contains(&self, lattice: &HexagonalSheet, site: &Site) -> bool {
        let slack = 1e-9 * lattice.diameter();
        if !(self.apex_row..=self.back_row).contains(&site.row) || site.x > self.radius + slack {
            return false;
        }
        let below_root = (self.radius * self.radius - site.x * site.x).max(0.0);
        site.z - lattice.depth(f64::from(self.apex_row)) >= self.radius - below_root.sqrt() - slack
    }

    /// Number of sites that hold lens material.
    pub fn count(&self, lattice: &HexagonalSheet) -> usize {
        (self.apex_row..=self.back_row).map(|row| self.count_in(lattice, row)).sum()
    }

    fn count_in(&self, lattice: &HexagonalSheet, row: u32) -> usize {
        let columns = 1..=lattice.columns(row);
        columns.filter_map(|column| lattice.site(row, column)).filter(|site| self.contains(lattice, site)).count()
    }

    /// First and last row that hold lens material.
    pub fn rows(&self, lattice: &HexagonalSheet) -> [u32; 2] {
        let first = (self.apex_row..self.back_row).find(|&row| self.count_in(lattice, row) > 0);
        [first.unwrap_or(self.back_row), self.back_row]
    }

    /// Angle of the front against the rows at its rim (rad).
    pub fn rim_angle(&self, lattice: &HexagonalSheet) -> f64 {
        let aperture = self.bench(lattice, [1.0, 1.0]).aperture();
        (aperture / self.radius).min(1.0).asin()
    }

    /// Depth at which rays close to the axis meet (m); none if the lens does not gather them.
    ///
    /// With n = V_lens/V_host they slope by −(1 − n) x/R in the lens and by 1/n times that behind it.
    pub fn paraxial_crossing(&self, lattice: &HexagonalSheet, speeds: [f64; 2]) -> Option<f64> {
        let ratio = speeds[1] / speeds[0];
        if ratio >= 1.0 {
            return None;
        }
        let PlanoConvex { apex, back, .. } = self.bench(lattice, speeds);
        let in_lens = self.radius / (1.0 - ratio);
        let left = in_lens - (back - apex);
        Some(if left > 0.0 { back + ratio * left } else { apex + in_lens })
    }
}

/// Least radius (m) of a front that takes `thickness` (m) from apex to back and nowhere exceeds `max_angle` (rad).
///
/// Either it meets the back at no more than that angle, T ≤ R (1 − cos θ), or it reaches the mirror line before it is as
/// steep, W ≤ R sin θ.
pub(super) fn least_radius(thickness: f64, half_width: f64, max_angle: f64) -> f64 {
    (thickness / (1.0 - max_angle.cos())).min(half_width / max_angle.sin())
}
