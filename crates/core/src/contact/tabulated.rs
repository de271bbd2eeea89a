//! A measured or computed force-displacement curve as a law.

use super::{ForceLaw, History, NormalLaw};

/// Force over overlap from a table, loading and unloading alike.
///
/// Between the points runs a cubic that is monotone where the points are (Fritsch and Butland 1984), so that force,
/// stiffness and energy are smooth and no wiggle is invented.
#[derive(Clone, Debug, PartialEq)]
pub struct Tabulated {
    overlaps: Vec<f64>,
    forces: Vec<f64>,
    /// dF/dδ at the points (N/m)
    slopes: Vec<f64>,
    /// ∫F dδ up to the points (J)
    energies: Vec<f64>,
    stiffness_max: f64,
}

/// Points that make no law.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum TableError {
    /// Fewer than three points.
    #[error("a force-displacement table needs at least three points, there are {0}")]
    Short(usize),
    /// A number is not finite.
    #[error("point {0} holds a number that is not finite")]
    NotFinite(usize),
    /// The first point is not the origin.
    #[error("the table begins at {overlap} m, {force} N; a contact begins at 0, 0")]
    Origin {
        /// First overlap (m).
        overlap: f64,
        /// First force (N).
        force: f64,
    },
    /// Overlaps do not increase.
    #[error("the overlap of point {0} is not above that of the point before it")]
    Order(usize),
    /// The force falls.
    #[error("the force of point {0} is below that of the point before it; a contact cannot soften")]
    Falling(usize),
}

impl Tabulated {
    /// A law through points (overlap in m, force in N), the first of them 0, 0.
    ///
    /// # Errors
    /// See [`TableError`]; points are counted from 1.
    pub fn new(points: &[(f64, f64)]) -> Result<Self, TableError> {
        if points.len() < 3 {
            return Err(TableError::Short(points.len()));
        }
        if let Some(bad) = points.iter().position(|(d, f)| !d.is_finite() || !f.is_finite()) {
            return Err(TableError::NotFinite(bad + 1));
        }
        if points[0] != (0.0, 0.0) {
            return Err(TableError::Origin { overlap: points[0].0, force: points[0].1 });
        }
        if let Some(bad) = points.windows(2).position(|w| w[1].0 <= w[0].0) {
            return Err(TableError::Order(bad + 2));
        }
        if let Some(bad) = points.windows(2).position(|w| w[1].1 < w[0].1) {
            return Err(TableError::Falling(bad + 2));
        }
        let secant: Vec<f64> = points.windows(2).map(|w| (w[1].1 - w[0].1) / (w[1].0 - w[0].0)).collect();
        let last = points.len() - 1;
        let mut slopes = vec![0.0; points.len()];
        for k in 1..last {
            let (before, after) = (points[k].0 - points[k - 1].0, points[k + 1].0 - points[k].0);
            let (left, right) = (secant[k - 1], secant[k]);
            if left > 0.0 && right > 0.0 {
                // The weighted harmonic mean keeps the cubic monotone.
                let (w1, w2) = (2.0 * after + before, after + 2.0 * before);
                slopes[k] = (w1 + w2) / (w1 / left + w2 / right);
            }
        }
        // At the ends the parabola through three points, held within what is monotone.
        let end =
            |h0: f64, h1: f64, d0: f64, d1: f64| (((2.0 * h0 + h1) * d0 - h0 * d1) / (h0 + h1)).clamp(0.0, 3.0 * d0);
        let step = |k: usize| points[k + 1].0 - points[k].0;
        slopes[0] = end(step(0), step(1), secant[0], secant[1]);
        slopes[last] = end(step(last - 1), step(last - 2), secant[last - 1], secant[last - 2]);

        let (overlaps, forces): (Vec<f64>, Vec<f64>) = points.iter().copied().unzip();
        let mut law = Self { overlaps, forces, slopes, energies: vec![0.0], stiffness_max: 0.0 };
        for k in 0..last {
            let h = step(k);
            let cell =
                h * 0.5 * (law.forces[k] + law.forces[k + 1]) + h * h / 12.0 * (law.slopes[k] - law.slopes[k + 1]);
            law.energies.push(law.energies[k] + cell);
            // The slope of the cubic is a parabola: its greatest value is at an end or at its vertex.
            let (m0, m1) = (law.slopes[k], law.slopes[k + 1]);
            let (b, c) = (6.0 * secant[k] - 4.0 * m0 - 2.0 * m1, 3.0 * (m0 + m1 - 2.0 * secant[k]));
            let vertex = if c < 0.0 { (-b / (2.0 * c)).clamp(0.0, 1.0) } else { 0.0 };
            let steepest = (m0 + vertex * (b + vertex * c)).max(m0).max(m1);
            law.stiffness_max = law.stiffness_max.max(steepest);
        }
        Ok(law)
    }

    /// The greatest overlap in the table (m); beyond it nothing is known.
    pub fn range(&self) -> f64 {
        self.overlaps[self.overlaps.len() - 1]
    }

    /// The cell that holds an overlap, and where in it, from 0 to 1; beyond the table its last cell, from 1 on.
    fn cell(&self, overlap: f64) -> (usize, f64) {
        let after = self.overlaps.partition_point(|&d| d <= overlap).clamp(1, self.overlaps.len() - 1);
        let h = self.overlaps[after] - self.overlaps[after - 1];
        (after - 1, (overlap - self.overlaps[after - 1]) / h)
    }
}

impl ForceLaw<f64> for Tabulated {
    /// Beyond the table the force goes on along the last slope; a run is stopped there by its guard.
    fn force(&self, overlap: f64, _: f64, _: &History) -> f64 {
        if overlap <= 0.0 {
            return 0.0;
        }
        let (k, t) = self.cell(overlap);
        let h = self.overlaps[k + 1] - self.overlaps[k];
        if t > 1.0 {
            return self.forces[k + 1] + self.slopes[k + 1] * (t - 1.0) * h;
        }
        let (f0, f1, m0, m1) = (self.forces[k], self.forces[k + 1], self.slopes[k] * h, self.slopes[k + 1] * h);
        f0 + t * (m0 + t * (3.0 * (f1 - f0) - 2.0 * m0 - m1 + t * (m0 + m1 - 2.0 * (f1 - f0))))
    }
}

impl NormalLaw for Tabulated {
    /// ∫F dδ of the cubic.
    fn stored(&self, overlap: f64, _: &History) -> f64 {
        if overlap <= 0.0 {
            return 0.0;
        }
        let (k, t) = self.cell(overlap);
        let h = self.overlaps[k + 1] - self.overlaps[k];
        if t > 1.0 {
            let beyond = (t - 1.0) * h;
            return self.energies[k + 1] + beyond * (self.forces[k + 1] + 0.5 * self.slopes[k + 1] * beyond);
        }
        let (f0, f1, m0, m1) = (self.forces[k], self.forces[k + 1], self.slopes[k] * h, self.slopes[k + 1] * h);
        let (second, third) = (3.0 * (f1 - f0) - 2.0 * m0 - m1, m0 + m1 - 2.0 * (f1 - f0));
        self.energies[k] + h * t * (f0 + t * (m0 / 2.0 + t * (second / 3.0 + t * third / 4.0)))
    }

    fn stiffness_max(&self, _: f64) -> f64 {
        self.stiffness_max
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Hertz's law in 33 points: the cubic is of third order where the curve is smooth, (h/δ)³ ≈ 3e-5 times the third
    /// derivative of x^1.5 (3/8 at most away from the first cells) over 6·4; the table is far from that near zero.
    #[test]
    fn a_table_of_hertz_follows_hertz() {
        let points: Vec<(f64, f64)> = (0..=32).map(|k| f64::from(k) / 32.0).map(|d| (d, d.powf(1.5))).collect();
        let law = Tabulated::new(&points).unwrap();
        for k in 64..=320 {
            let d = f64::from(k) / 320.0;
            assert!((law.force(d, 0.0, &History::new()) - d.powf(1.5)).abs() < 3e-5, "{d}");
        }
        assert!((law.stored(1.0, &History::new()) - 0.4).abs() < 1e-3);
        assert!(law.stiffness_max(0.0) >= 1.49);
    }

    /// Energy is the integral of the force, inside the table and beyond.
    #[test]
    fn force_is_the_slope_of_the_energy() {
        let law = Tabulated::new(&[(0.0, 0.0), (1.0, 1.0), (2.0, 1.0), (2.5, 4.0), (4.0, 5.0)]).unwrap();
        let history = History::new();
        let mut last = 0.0;
        for k in 1..500 {
            let d = f64::from(k) * 0.01 + 0.003;
            let slope = (law.stored(d + 1e-5, &history) - law.stored(d - 1e-5, &history)) / 2e-5;
            let force = law.force(d, 0.0, &history);
            assert!((slope - force).abs() < 1e-7, "{d}: {slope} {force}");
            assert!(force >= last - 1e-12, "monotone at {d}");
            last = force;
        }
    }

    #[test]
    fn tables_that_make_no_law_are_refused() {
        assert_eq!(Tabulated::new(&[(0.0, 0.0), (1.0, 1.0)]), Err(TableError::Short(2)));
        assert_eq!(Tabulated::new(&[(0.0, 0.0), (1.0, 2.0), (2.0, 1.0)]), Err(TableError::Falling(3)));
        assert_eq!(Tabulated::new(&[(0.0, 0.0), (1.0, 2.0), (1.0, 3.0)]), Err(TableError::Order(3)));
        let late = Tabulated::new(&[(0.1, 0.0), (1.0, 2.0), (2.0, 3.0)]);
        assert_eq!(late, Err(TableError::Origin { overlap: 0.1, force: 0.0 }));
    }
}
