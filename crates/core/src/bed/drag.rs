//! What resists an intruder: its acceleration against depth and speed, impulse and stopping time.
//!
//! Poncelet's law (Kondic et al. 2012, eq. A1) splits the force of the grains into a part by depth and a part by speed,
//!
//!   F = F₀ + κ D + β u²,
//!
//! with D the depth of the lowest point and u the speed downwards. F₀, κ and β are found by least squares over the moments from the
//! touch of the surface to the first stop.

use serde::Serialize;

use super::Moment;

/// A number that was fitted.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Fitted {
    /// The number.
    pub value: f64,
    /// Half the width of its 95 % interval. Residuals of successive moments are alike, so it counts as many independent ones as
    /// their correlation from one to the next leaves: n (1 − ρ)/(1 + ρ).
    pub interval: f64,
}

/// How an intruder is stopped.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Drag {
    /// F₀ (m d/τ_c²).
    pub constant: Fitted,
    /// κ (m/τ_c²): what each diameter of depth adds.
    pub per_depth: Fitted,
    /// β (m/d): what the square of the speed adds.
    pub per_speed_squared: Fitted,
    /// The part of the force's variance that the law explains.
    pub explained: f64,
    /// Moments that were fitted.
    pub moments: usize,
    /// ∫F dt from touch to stop (m d/τ_c).
    pub impulse: f64,
    /// Time from touch to stop (τ_c).
    pub stopping_time: f64,
}

/// Numbers of the law.
const NUMBERS: usize = 3;

impl Drag {
    /// Of an impact, if the intruder touched, stopped, and was seen often enough between.
    pub fn of(moments: &[Moment]) -> Option<Self> {
        let touch = moments.iter().position(|moment| moment.depth > 0.0)?;
        let stop = touch + moments[touch..].iter().position(|moment| moment.velocity[1] >= 0.0)?;
        let seen = &moments[touch..stop];
        let law: Vec<([f64; NUMBERS], f64)> =
            seen.iter().map(|m| ([1.0, m.depth, m.velocity[1] * m.velocity[1]], m.force[1])).collect();
        let Regression { values, errors, explained } = Regression::of(&law)?;
        let fitted = |k: usize| Fitted { value: values[k], interval: 1.96 * errors[k] };
        let mean_force = |two: &[Moment]| 0.5 * (two[0].force[1] + two[1].force[1]) * (two[1].time - two[0].time);
        Some(Self {
            constant: fitted(0),
            per_depth: fitted(1),
            per_speed_squared: fitted(2),
            explained,
            moments: seen.len(),
            impulse: moments[touch..=stop].windows(2).map(mean_force).sum(),
            stopping_time: moments[stop].time - moments[touch].time,
        })
    }
}

/// Least squares for y = Σ c_k x_k.
struct Regression<const N: usize> {
    values: [f64; N],
    /// Standard errors, of as many independent observations as the residuals' correlation leaves.
    errors: [f64; N],
    explained: f64,
}

impl<const N: usize> Regression<N> {
    fn of(rows: &[([f64; N], f64)]) -> Option<Self> {
        if rows.len() < N + 3 {
            return None;
        }
        let normal: [[f64; N]; N] =
            std::array::from_fn(|i| std::array::from_fn(|k| rows.iter().map(|(x, _)| x[i] * x[k]).sum()));
        let right: [f64; N] = std::array::from_fn(|i| rows.iter().map(|(x, y)| x[i] * y).sum());
        let inverse = inverse(normal)?;
        let values: [f64; N] = std::array::from_fn(|i| (0..N).map(|k| inverse[i][k] * right[k]).sum());
        let rests: Vec<f64> = rows.iter().map(|(x, y)| y - (0..N).map(|k| values[k] * x[k]).sum::<f64>()).collect();
        let squares = rests.iter().map(|r| r * r).sum::<f64>();
        let mean = rows.iter().map(|(_, y)| y).sum::<f64>() / rows.len() as f64;
        let spread = rows.iter().map(|(_, y)| (y - mean) * (y - mean)).sum::<f64>();
        let alike = rests.windows(2).map(|two| two[0] * two[1]).sum::<f64>() / squares.max(f64::MIN_POSITIVE);
        let alike = alike.clamp(0.0, 0.99);
        let inflation = (1.0 + alike) / (1.0 - alike);
        let variance = squares / (rows.len() - N) as f64 * inflation;
        let errors = std::array::from_fn(|k| (variance * inverse[k][k]).max(0.0).sqrt());
        Some(Self { values, errors, explained: if spread > 0.0 { 1.0 - squares / spread } else { 1.0 } })
    }
}

/// The inverse of a symmetric positive matrix, by Gauss and Jordan with pivots; none where it is singular to rounding.
fn inverse<const N: usize>(mut matrix: [[f64; N]; N]) -> Option<[[f64; N]; N]> {
    let mut inverse: [[f64; N]; N] = std::array::from_fn(|i| std::array::from_fn(|k| if i == k { 1.0 } else { 0.0 }));
    let size = matrix.iter().flatten().fold(0.0_f64, |most, x| most.max(x.abs()));
    for column in 0..N {
        let pivot = (column..N).max_by(|&a, &b| matrix[a][column].abs().total_cmp(&matrix[b][column].abs()))?;
        if matrix[pivot][column].abs() <= 1e-14 * size {
            return None;
        }
        matrix.swap(column, pivot);
        inverse.swap(column, pivot);
        let by = matrix[column][column];
        for k in 0..N {
            matrix[column][k] /= by;
            inverse[column][k] /= by;
        }
        for row in (0..N).filter(|&row| row != column) {
            let by = matrix[row][column];
            for k in 0..N {
                matrix[row][k] -= by * matrix[column][k];
                inverse[row][k] -= by * inverse[column][k];
            }
        }
    }
    Some(inverse)
}

/// The exponent p of y ∝ xᵖ over points that are all positive, by least squares of the logarithms; none of fewer than five points.
pub fn exponent(points: &[[f64; 2]]) -> Option<Fitted> {
    let rows: Option<Vec<([f64; 2], f64)>> =
        points.iter().map(|&[x, y]| (x > 0.0 && y > 0.0).then(|| ([1.0, x.ln()], y.ln()))).collect();
    let Regression { values, errors, .. } = Regression::of(&rows?)?;
    Some(Fitted { value: values[1], interval: 1.96 * errors[1] })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::dem::rig::EnergyLedger;

    /// An intruder that obeys the law exactly has its numbers found, its impulse is m(v₀ + g t), and where noise is added the
    /// intervals cover the truth.
    #[test]
    fn the_law_s_numbers_are_found() {
        let (mass, g, constant, per_depth, per_square) = (100.0, 1e-3, 0.4, 0.3, 12.0);
        let (mut depth, mut speed, step) = (-0.1_f64, 0.7_f64, 0.002);
        let mut moments = Vec::new();
        for k in 0..200_000 {
            let force =
                |depth: f64, u: f64| if depth > 0.0 { constant + per_depth * depth + per_square * u * u } else { 0.0 };
            if k % 50 == 0 {
                moments.push(Moment {
                    time: f64::from(k) * step,
                    depth,
                    velocity: [0.0, -speed],
                    turn: 0.0,
                    force: [0.0, force(depth, speed)],
                    energy: EnergyLedger::default(),
                });
            }
            // Midpoint rule.
            let half = speed + 0.5 * step * (g - force(depth, speed) / mass);
            let middle = depth + 0.5 * step * speed;
            speed += step * (g - force(middle, half) / mass);
            depth += step * half;
            if speed < -0.001 {
                break;
            }
        }
        let drag = Drag::of(&moments).unwrap();
        let off = |fitted: Fitted, truth: f64| (fitted.value / truth - 1.0).abs();
        assert!(off(drag.constant, constant) < 1e-9 && off(drag.per_depth, per_depth) < 1e-9, "{drag:?}");
        assert!(off(drag.per_speed_squared, per_square) < 1e-9 && drag.explained > 1.0 - 1e-12, "{drag:?}");
        // Momentum: what the grains took is what the intruder had, and what gravity gave it; touch and stop are seen to a look.
        let wanted = mass * (0.7 + g * drag.stopping_time);
        assert!((drag.impulse / wanted - 1.0).abs() < 0.01, "{} {wanted}", drag.impulse);
        for (k, moment) in moments.iter_mut().enumerate() {
            moment.force[1] += 0.2 * (k as f64 * 2.399_963).sin();
        }
        let noisy = Drag::of(&moments).unwrap();
        assert!((noisy.per_depth.value - per_depth).abs() < noisy.per_depth.interval, "{noisy:?}");
    }

    #[test]
    fn exponents_are_found() {
        let points: Vec<[f64; 2]> = (1..9).map(|k| [f64::from(k), 3.0 * f64::from(k).powf(1.4)]).collect();
        assert!((exponent(&points).unwrap().value - 1.4).abs() < 1e-12);
        assert!(exponent(&points[..4]).is_none() && exponent(&[[0.0, 1.0]; 9]).is_none());
    }
}
