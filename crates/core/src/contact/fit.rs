//! A law's constants from what was measured: a force-displacement curve, or restitution over speed.

use argmin::core::{CostFunction, Error, Executor, State};
use argmin::solver::neldermead::NelderMead;

use super::collision::collide;
use super::{AnyLaw, ForceLaw, History, LawKind, Pair};

/// What was measured on one contact.
#[derive(Clone, Debug, PartialEq)]
pub enum Measured {
    /// Overlap (m) and force (N), slowly, in the order in which they were taken: loading, and unloading where there is one.
    Curve(Vec<[f64; 2]>),
    /// Closing speed (m/s) and coefficient of restitution of head-on collisions.
    Restitution(Vec<[f64; 2]>),
}

/// A constant that can be fitted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Constant {
    /// E* (Pa)
    Modulus,
    /// σ_y (Pa)
    YieldStress,
    /// C
    RateConstant,
    /// See [`Tuning`](super::Tuning), as the following.
    SpringBack,
    /// S (1/m)
    SpringBackGrowth,
    /// e
    Restitution,
    /// m
    Hardening,
}

/// A constant with the interval that holds it with a probability of 95 %, were the model true and the scatter that of the points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Estimate {
    /// Which.
    pub constant: Constant,
    /// The value that fits best.
    pub value: f64,
    /// Its interval; none where the points do not determine it.
    pub interval: Option<[f64; 2]>,
}

/// A law fitted to what was measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// The constants.
    pub estimates: Vec<Estimate>,
    /// The pair with these constants.
    pub pair: Pair,
    /// Root of the mean squared deviation: of forces over the greatest, of coefficients of restitution.
    pub deviation: f64,
}

/// Measurements that determine nothing.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum FitError {
    /// Too few points.
    #[error("{points} points for {constants} constants of the law {law}; at least {} are needed", constants + 2)]
    Few {
        /// How many there are.
        points: usize,
        /// How many constants are sought.
        constants: usize,
        /// The law.
        law: LawKind,
    },
    /// A number that cannot have been measured.
    #[error(
        "point {0}: overlaps and forces must not be negative, speeds positive, coefficients of restitution between 0 and 1"
    )]
    Point(usize),
    /// A law that such a measurement says nothing about.
    #[error("restitution over speed says nothing about the law {0}, which loses nothing")]
    Elastic(LawKind),
}

impl Constant {
    /// Its name with the unit, as in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Modulus => "effective_modulus_Pa",
            Self::YieldStress => "yield_stress_Pa",
            Self::RateConstant => "rate_constant",
            Self::SpringBack => "spring_back",
            Self::SpringBackGrowth => "spring_back_growth_per_m",
            Self::Restitution => "restitution",
            Self::Hardening => "hardening",
        }
    }

    /// Those of a law of which a measurement speaks.
    fn of(law: LawKind, measured: &Measured) -> Vec<Self> {
        let slow = matches!(measured, Measured::Curve(_));
        match law {
            LawKind::Hertz | LawKind::HertzThesis => vec![Self::Modulus],
            LawKind::Tsuji if slow => vec![Self::Modulus],
            LawKind::Tsuji => vec![Self::Restitution],
            LawKind::WaltonBraun if slow => vec![Self::YieldStress, Self::SpringBack],
            LawKind::WaltonBraun => vec![Self::SpringBack, Self::SpringBackGrowth],
            LawKind::Storakers => vec![Self::YieldStress, Self::Hardening],
            LawKind::Thornton if !slow => vec![Self::YieldStress],
            LawKind::Linear | LawKind::LinearStatic if slow => vec![Self::YieldStress],
            LawKind::Thesis | LawKind::Consistent | LawKind::Mdr | LawKind::Linear if !slow => {
                vec![Self::YieldStress, Self::RateConstant]
            }
            LawKind::ThesisStatic | LawKind::ConsistentStatic | LawKind::MdrStatic | LawKind::LinearStatic if !slow => {
                vec![Self::YieldStress]
            }
            _ => vec![Self::Modulus, Self::YieldStress],
        }
    }

    fn get(self, pair: &Pair) -> f64 {
        let tuning = &pair.constants.tuning;
        match self {
            Self::Modulus => pair.modulus,
            Self::YieldStress => pair.yield_stress,
            Self::RateConstant => pair.rate_constant,
            Self::SpringBack => tuning.spring_back,
            Self::SpringBackGrowth => tuning.spring_back_growth,
            Self::Restitution => tuning.restitution,
            Self::Hardening => tuning.hardening,
        }
    }

    fn set(self, pair: &mut Pair, value: f64) {
        let tuning = &mut pair.constants.tuning;
        match self {
            Self::Modulus => pair.modulus = value,
            Self::YieldStress => pair.yield_stress = value,
            Self::RateConstant => pair.rate_constant = value,
            Self::SpringBack => tuning.spring_back = value,
            Self::SpringBackGrowth => tuning.spring_back_growth = value,
            Self::Restitution => tuning.restitution = value,
            Self::Hardening => tuning.hardening = value,
        }
    }

    /// The constant from a number that may be anything: positive ones by their logarithm, the others by a square, so that a search has no walls
    /// but zero.
    fn bounded(self, free: f64) -> f64 {
        match self {
            Self::Modulus | Self::YieldStress => free.exp(),
            Self::SpringBack => 1.0 + free * free,
            Self::RateConstant | Self::SpringBackGrowth => free * free,
            Self::Restitution => 1.0 / (1.0 + free * free),
            Self::Hardening => 0.8 * free * free / (1.0 + free * free),
        }
    }

    fn unbounded(self, value: f64) -> f64 {
        match self {
            Self::Modulus | Self::YieldStress => value.ln(),
            Self::SpringBack => (value - 1.0).max(0.01).sqrt(),
            Self::RateConstant => value.max(1e-3).sqrt(),
            Self::SpringBackGrowth => value.max(100.0).sqrt(),
            Self::Restitution => (1.0 / value - 1.0).max(0.01).sqrt(),
            Self::Hardening => (value.max(0.01) / (0.8 - value).max(0.01)).sqrt(),
        }
    }
}

/// A law whose constants are sought.
struct Sought<'a> {
    law: LawKind,
    pair: Pair,
    measured: &'a Measured,
    constants: Vec<Constant>,
}

impl Sought<'_> {
    fn pair(&self, free: &[f64]) -> Pair {
        let mut pair = self.pair;
        for (constant, &free) in self.constants.iter().zip(free) {
            constant.set(&mut pair, constant.bounded(free));
        }
        pair
    }

    /// Model less measurement, of forces over the greatest measured one.
    fn deviations(&self, pair: &Pair) -> Vec<f64> {
        let law = AnyLaw::new(self.law, pair);
        match self.measured {
            Measured::Curve(points) => {
                let greatest = points.iter().map(|[_, force]| *force).fold(f64::MIN_POSITIVE, f64::max);
                let mut history = History::new();
                let mut deviation = |&[overlap, force]: &[f64; 2]| {
                    let ours;
                    (ours, history) = law.respond(overlap, 0.0, &history);
                    (ours - force) / greatest
                };
                points.iter().map(&mut deviation).collect()
            }
            Measured::Restitution(points) => points
                .iter()
                .map(|&[speed, restitution]| collide(&law, pair.reduced_mass, speed).restitution - restitution)
                .collect(),
        }
    }
}

impl CostFunction for Sought<'_> {
    type Param = Vec<f64>;
    type Output = f64;
    fn cost(&self, free: &Vec<f64>) -> Result<f64, Error> {
        let sum: f64 = self.deviations(&self.pair(free)).iter().map(|deviation| deviation * deviation).sum();
        Ok(if sum.is_finite() { sum } else { f64::MAX })
    }
}

/// The constants of a law with which it comes nearest to what was measured, by least squares, beginning at those of the pair: the simplex
/// search of Nelder and Mead, begun anew until it stays; intervals by the linearised model and Student's t.
///
/// # Errors
/// See [`FitError`].
pub fn fit(law: LawKind, pair: &Pair, measured: &Measured) -> Result<Fit, FitError> {
    let constants = Constant::of(law, measured);
    let (points, curve) = match measured {
        Measured::Curve(points) => (points, true),
        Measured::Restitution(points) => (points, false),
    };
    if matches!(law, LawKind::Hertz | LawKind::HertzThesis) && !curve {
        return Err(FitError::Elastic(law));
    }
    let sound = |&[x, y]: &[f64; 2]| {
        let finite = x.is_finite() && y.is_finite() && x >= 0.0 && y >= 0.0;
        finite && (curve || (x > 0.0 && y <= 1.0))
    };
    if let Some(bad) = points.iter().position(|point| !sound(point)) {
        return Err(FitError::Point(bad + 1));
    }
    if points.len() < constants.len() + 2 {
        return Err(FitError::Few { points: points.len(), constants: constants.len(), law });
    }
    let mut best: Vec<f64> = constants.iter().map(|constant| constant.unbounded(constant.get(pair))).collect();
    let count = constants.len();
    let sought = Sought { law, pair: *pair, measured, constants };
    let cost = |free: &Vec<f64>| sought.cost(free).unwrap_or(f64::MAX);
    for round in 0..6 {
        let reach = 0.3 / f64::from(1 + round);
        let mut simplex = vec![best.clone()];
        for k in 0..count {
            let mut corner = best.clone();
            corner[k] += reach
                * if matches!(sought.constants[k], Constant::Modulus | Constant::YieldStress) {
                    1.0
                } else {
                    best[k].abs().max(0.1)
                };
            simplex.push(corner);
        }
        let Ok(solver) = NelderMead::new(simplex).with_sd_tolerance(1e-16) else { break };
        let problem = Sought { law, pair: *pair, measured, constants: sought.constants.clone() };
        let run = Executor::new(problem, solver).configure(|state| state.max_iters(200)).run();
        let Some(found) = run.ok().and_then(|result| result.state().get_best_param().cloned()) else { break };
        let (before, after) = (cost(&best), cost(&found));
        if after < before {
            best = found;
        }
        if after >= before * (1.0 - 1e-9) && round > 1 {
            break;
        }
    }
    let pair = sought.pair(&best);
    let deviations = sought.deviations(&pair);
    let squares: f64 = deviations.iter().map(|deviation| deviation * deviation).sum();
    let freedom = points.len() - count;
    let spread = intervals(&sought, &pair, squares / freedom as f64, freedom);
    let estimates = sought
        .constants
        .iter()
        .enumerate()
        .map(|(k, &constant)| {
            let value = constant.get(&pair);
            let interval = spread.as_ref().map(|spread| [value - spread[k], value + spread[k]]);
            Estimate { constant, value, interval }
        })
        .collect();
    Ok(Fit { estimates, pair, deviation: (squares / points.len() as f64).sqrt() })
}

/// Half the width of each constant's interval: t √(s² (JᵀJ)⁻¹), J by differences in the constants themselves.
fn intervals(sought: &Sought, pair: &Pair, variance: f64, freedom: usize) -> Option<Vec<f64>> {
    let values: Vec<f64> = sought.constants.iter().map(|constant| constant.get(pair)).collect();
    let scale: Vec<f64> = values.iter().map(|value| value.abs().max(1e-6)).collect();
    let mut columns = Vec::with_capacity(values.len());
    for (k, constant) in sought.constants.iter().enumerate() {
        let at = |by: f64| {
            let mut moved = *pair;
            constant.set(&mut moved, values[k] + by * scale[k]);
            sought.deviations(&moved)
        };
        let (above, below) = (at(1e-4), at(-1e-4));
        columns.push(above.iter().zip(&below).map(|(above, below)| (above - below) / 2e-4).collect::<Vec<f64>>());
    }
    let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let normal = columns.iter().map(|a| columns.iter().map(|b| product(a, b)).collect()).collect();
    let inverse = diagonal_of_inverse(normal)?;
    let half = |k: usize| students_t(freedom) * (variance * inverse[k]).sqrt() * scale[k];
    let all: Vec<f64> = (0..values.len()).map(half).collect();
    all.iter().all(|half| half.is_finite()).then_some(all)
}

/// The diagonal of the inverse of a symmetric positive definite matrix, by elimination without pivots; none of one that is singular.
fn diagonal_of_inverse(mut matrix: Vec<Vec<f64>>) -> Option<Vec<f64>> {
    let count = matrix.len();
    let mut inverse: Vec<Vec<f64>> =
        (0..count).map(|i| (0..count).map(|k| f64::from(u8::from(i == k))).collect()).collect();
    for k in 0..count {
        let pivot = matrix[k][k];
        if !(pivot.is_finite() && pivot > 0.0) {
            return None;
        }
        for column in 0..count {
            matrix[k][column] /= pivot;
            inverse[k][column] /= pivot;
        }
        for row in (0..count).filter(|&row| row != k) {
            let factor = matrix[row][k];
            for column in 0..count {
                matrix[row][column] -= factor * matrix[k][column];
                inverse[row][column] -= factor * inverse[k][column];
            }
        }
    }
    Some((0..count).map(|k| inverse[k][k]).collect())
}

/// The 97.5 % point of Student's t, to a percent: the normal one with the first terms of Cornish and Fisher's expansion, exact values below three.
fn students_t(freedom: usize) -> f64 {
    let n = freedom as f64;
    let z = 1.959_964_f64;
    match freedom {
        0 => f64::INFINITY,
        1 => 12.706,
        2 => 4.303,
        _ => {
            z + (z.powi(3) + z) / (4.0 * n)
                + (5.0 * z.powi(5) + 16.0 * z.powi(3) + 3.0 * z) / (96.0 * n * n)
                + (3.0 * z.powi(7) + 19.0 * z.powi(5) + 17.0 * z.powi(3) - 15.0 * z) / (384.0 * n.powi(3))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::diagonal_of_inverse;

    /// Of [[2, 1], [1, 3]], with determinant 5; of a Hilbert matrix, whose inverse has the diagonal 9, 192, 180; and of one that has none.
    #[test]
    fn the_diagonal_is_that_of_known_inverses() {
        let two = diagonal_of_inverse(vec![vec![2.0, 1.0], vec![1.0, 3.0]]).unwrap();
        assert!((two[0] - 0.6).abs() < 1e-15 && (two[1] - 0.4).abs() < 1e-15);
        let hilbert = (0..3).map(|i| (0..3).map(|k| 1.0 / f64::from(i + k + 1)).collect()).collect();
        let three = diagonal_of_inverse(hilbert).unwrap();
        // Its condition is 524.
        assert!(three.iter().zip([9.0, 192.0, 180.0]).all(|(found, known)| (found / known - 1.0).abs() < 1e-12));
        assert_eq!(diagonal_of_inverse(vec![vec![1.0, 1.0], vec![1.0, 1.0]]), None);
    }
}
