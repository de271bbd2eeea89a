//! A wave that decays, and slows down as it does: what the bound leaves out.

/// How the wave of one impact runs in a uniform crystal of one material, by its amplitude F, the greatest force on a contact.
///
///   V/V_bound = a + b ln F,   d ln F/dz = c + d ln F (not above 0)
///
/// Both straight lines are fitted to a simulation of the uniform crystal under the same impact, so nothing is taken from
/// the crystal to be predicted. The first rows run faster than the bound, as the rate effect makes contacts stiffer, far ones
/// slower. The lines hold for amplitudes of the fit and are continued beyond. F is the maximum over the window, late pushes
/// included, so fits of different windows differ: use one that lets the wave pass the whole crystal of the slowest material.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Decay {
    /// V_bound (m/s)
    pub bound: f64,
    /// F in the struck row (N).
    pub start: f64,
    /// a, b, with F in newtons.
    pub speed: [f64; 2],
    /// c, d (1/m), with F in newtons.
    pub loss: [f64; 2],
}

/// What a simulated wave was in one row of a uniform crystal.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RowPassage {
    /// Depth (m).
    pub depth: f64,
    /// Time of arrival (s).
    pub arrival: f64,
    /// Greatest force on a contact (N).
    pub force: f64,
}

/// Rows to either side over which a local speed is taken: about the length of the pulse.
const SPAN: usize = 3;

/// Fewer rows say nothing of a decay.
const LEAST_ROWS: usize = 16;

/// Continued lines end here: no wave of the fits comes below 0.8.
const LEAST_SPEED: f64 = 0.2;

impl Decay {
    /// Fits the lines to the rows of a uniform crystal, in order; the last ones, which lack what holds them back, are left
    /// out. None for fewer than 16 rows or a wave that never weakens.
    pub fn fit(bound: f64, rows: &[RowPassage]) -> Option<Self> {
        let count = rows.len().checked_sub(SPAN + 1)?;
        if count < LEAST_ROWS || rows.iter().any(|row| !(row.force > 0.0 && row.arrival.is_finite())) {
            return None;
        }
        let (mut speeds, mut losses) = (Vec::new(), Vec::new());
        for k in SPAN..count {
            let (before, here, behind) = (rows[k - SPAN], rows[k], rows[k + SPAN]);
            let way = behind.depth - before.depth;
            speeds.push([here.force.ln(), way / (behind.arrival - before.arrival) / bound]);
            let middle = 0.5 * (before.force.ln() + behind.force.ln());
            losses.push([middle, (behind.force.ln() - before.force.ln()) / way]);
        }
        let start = (rows[0].force * rows[1].force).sqrt();
        Some(Self { bound, start, speed: line(&speeds)?, loss: line(&losses)? })
    }

    /// Wave speed (m/s) at an amplitude (N).
    pub fn speed_at(&self, force: f64) -> f64 {
        self.bound * (self.speed[0] + self.speed[1] * force.ln()).max(LEAST_SPEED)
    }

    /// Amplitude (N) after a way (m), from an amplitude (N): d ln F/dz is followed exactly.
    pub fn after(&self, force: f64, way: f64) -> f64 {
        let [c, d] = self.loss;
        let log = force.ln();
        let rate = (c + d * log).min(0.0);
        // ln F relaxes towards −c/d where d < 0; a line that does not bend is followed straight.
        let change = if (d * way).abs() < 1e-9 { rate * way } else { rate * (d * way).exp_m1() / d };
        (log + change.min(0.0)).exp()
    }
}

/// Intercept and slope of the line of least squares.
fn line(points: &[[f64; 2]]) -> Option<[f64; 2]> {
    let count = points.len() as f64;
    let mean = |k: usize| points.iter().map(|point| point[k]).sum::<f64>() / count;
    let (x, y) = (mean(0), mean(1));
    let spread: f64 = points.iter().map(|point| (point[0] - x).powi(2)).sum();
    let slope = points.iter().map(|point| (point[0] - x) * (point[1] - y)).sum::<f64>() / spread;
    slope.is_finite().then_some([y - slope * x, slope])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rows made with known lines give them back: the force by the closed form of d ln F/dz = c + d ln F, the arrival as the
    /// integral of 1/V by fine steps. Speeds are differences over six rows, losses are taken at their middle; both are of
    /// second order, which leaves some percent of a strongly bent decay and far less of this one.
    #[test]
    fn known_lines_are_found_again() {
        let made = Decay { bound: 1400.0, start: 17e3, speed: [-0.2, 0.137], loss: [30.0, -4.0] };
        let (mut force, mut arrival) = (made.start, 0.0);
        let rows: Vec<RowPassage> = (0..50)
            .map(|row| {
                let passage = RowPassage { depth: 5.5e-3 * f64::from(row), arrival, force };
                for _ in 0..200 {
                    let step = 5.5e-3 / 200.0;
                    arrival += step / made.speed_at(made.after(force, 0.5 * step));
                    force = made.after(force, step);
                }
                passage
            })
            .collect();
        let found = Decay::fit(1400.0, &rows).unwrap();
        assert!((found.speed[1] / made.speed[1] - 1.0).abs() < 0.02, "{found:?}");
        assert!((found.loss[1] / made.loss[1] - 1.0).abs() < 0.02, "{found:?}");
        for force in [2e3, 5e3, 12e3] {
            assert!((found.speed_at(force) / made.speed_at(force) - 1.0).abs() < 2e-3);
        }
        assert_eq!(Decay::fit(1400.0, &rows[..12]), None);
    }

    /// One long way is many short ones.
    #[test]
    fn ways_add_up() {
        let decay = Decay { bound: 1.0, start: 1.0, speed: [1.0, 0.0], loss: [30.0, -4.0] };
        let short = (0..100).fold(9e3, |force, _| decay.after(force, 1e-3));
        assert!((decay.after(9e3, 0.1) / short - 1.0).abs() < 1e-12);
        // Below the least amplitude of the line nothing grows.
        assert_eq!(decay.after(1e3, 0.1), 1e3_f64.ln().exp());
    }
}
