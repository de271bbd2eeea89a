//! Uncertain inputs by least squares: Levenberg and Marquardt's method on all records at once, with the clock's offset among the unknowns.
//!
//! Residuals are weighed by the noise of their record, which is found from the residuals themselves in a second round. Slopes are central
//! differences of simulations. Intervals are those of linear least squares, s² (JᵀJ)⁻¹ with Student's quantile: right where residuals are
//! noise that does not hang together, too narrow where curves differ in shape (see [`Matched::neighbours`](super::Matched)).

use rayon::prelude::*;
use serde::Serialize;

use super::{Channel, Data, Input, PredictError, Prediction, align, compare, predict};
use crate::Context;
use crate::dem::{MoveIn, Spheres};
use crate::setup::PreparedRig;
use crate::stats::student;

/// A fitted input.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Fitted {
    /// Which.
    pub input: String,
    /// What its value means.
    pub meaning: &'static str,
    /// As the file has it.
    pub start: f64,
    /// As fitted.
    pub value: f64,
    /// Half the width of its 95 % interval; none where the records do not tell it.
    pub interval: Option<f64>,
    /// Whether the value lies at an end of the range in which it was sought.
    pub at_bound: bool,
}

/// What a fit came to.
#[derive(Clone, Debug, PartialEq)]
pub struct Fit {
    /// The inputs, in the order in which they were asked for.
    pub inputs: Vec<Fitted>,
    /// Measured time − predicted time (s).
    pub offset: f64,
    /// Half the width of its 95 % interval (s); none where it was given, or is not told.
    pub offset_interval: Option<f64>,
    /// The rig with the fitted inputs.
    pub prediction: Prediction,
    /// Simulations that it took.
    pub runs: usize,
}

/// Rounds: with residuals over the peaks of their records, then over their noise.
const ROUNDS: usize = 2;
/// Most steps of a round.
const STEPS: usize = 20;
/// A step below this part of every unknown's nudge ends a round.
const SETTLED: f64 = 1e-3;

/// One set of unknowns with what it predicts.
struct State {
    inputs: Vec<f64>,
    offset: f64,
    prediction: Prediction,
    /// Residuals over the scales of their records; none where nothing is compared.
    residuals: Vec<Option<f64>>,
}

struct Problem<'a, const D: usize> {
    prepared: &'a PreparedRig<D>,
    data: &'a Data,
    channels: &'a [Channel],
    inputs: &'a [Input],
    free_offset: bool,
    context: &'a Context,
}

/// Fits inputs, and the offset unless it is given. None where measurement and prediction hardly overlap in time.
///
/// # Errors
/// See [`PredictError`].
pub fn fit<const D: usize>(
    prepared: &PreparedRig<D>,
    data: &Data,
    channels: &[Channel],
    inputs: &[Input],
    offset: Option<f64>,
    context: &Context,
) -> Result<Option<Fit>, PredictError>
where
    Spheres: MoveIn<D>,
{
    let problem = Problem { prepared, data, channels, inputs, free_offset: offset.is_none(), context };
    let mut scales = compare::peaks(data);
    let start: Vec<f64> = inputs.iter().map(|input| input.start(&prepared.rig)).collect();
    let prediction = problem.run(&start)?;
    let mut runs = 1;
    let Some(offset) = offset.or_else(|| align::offset(data, &prediction, &scales)) else { return Ok(None) };
    let mut state = problem.state(start.clone(), offset, prediction, &scales);
    let mut slopes = Vec::new();
    for round in 0..ROUNDS {
        if round > 0 {
            scales = problem.noise(&state, &scales);
            state = problem.state(state.inputs, state.offset, state.prediction, &scales);
        }
        let mut damping = 1e-3;
        for _ in 0..STEPS {
            slopes = problem.slopes(&state, &scales)?;
            runs += 2 * inputs.len();
            let mut settled = true;
            // A step that does not lessen the misfit is tried again, shorter and steeper.
            for _ in 0..8 {
                let Some(step) = damped(&slopes, &state.residuals, damping) else { break };
                let tried = problem.moved(&state, &step, &scales)?;
                runs += usize::from(!inputs.is_empty());
                if square(&tried.residuals) < square(&state.residuals) {
                    settled =
                        problem.nudges(&state).iter().zip(&step).all(|(nudge, step)| step.abs() < SETTLED * nudge);
                    state = tried;
                    damping = (damping * 0.1).max(1e-9);
                    break;
                }
                damping *= 10.0;
            }
            if settled {
                break;
            }
        }
    }
    let widths = widths(&slopes, &state.residuals);
    let fitted = inputs.iter().zip(&start).zip(&state.inputs).enumerate().map(|(k, ((input, start), value))| Fitted {
        input: input.to_string(),
        meaning: input.meaning(),
        start: *start,
        value: *value,
        interval: widths.as_ref().map(|widths| widths[k]),
        at_bound: input.range().contains(value) && input.start(&prepared.rig) != *value,
    });
    Ok(Some(Fit {
        inputs: fitted.collect(),
        offset: state.offset,
        offset_interval: widths.as_ref().and_then(|widths| widths.get(inputs.len()).copied()),
        prediction: state.prediction,
        runs,
    }))
}

impl<const D: usize> Problem<'_, D>
where
    Spheres: MoveIn<D>,
{
    fn run(&self, values: &[f64]) -> Result<Prediction, PredictError> {
        let inputs: Vec<(Input, f64)> = self.inputs.iter().cloned().zip(values.iter().copied()).collect();
        predict(self.prepared, self.channels, &inputs, self.context)
    }

    fn state(&self, inputs: Vec<f64>, offset: f64, prediction: Prediction, scales: &[f64]) -> State {
        let residuals = align::residuals(self.data, &prediction, offset, scales).into_iter().flatten().collect();
        State { inputs, offset, prediction, residuals }
    }

    /// Steps of differences, one for each unknown.
    fn nudges(&self, state: &State) -> Vec<f64> {
        let offset = self.free_offset.then_some(state.prediction.interval);
        self.inputs.iter().map(Input::nudge).chain(offset).collect()
    }

    fn moved(&self, state: &State, step: &[f64], scales: &[f64]) -> Result<State, PredictError> {
        let inputs: Vec<f64> = state
            .inputs
            .iter()
            .zip(step)
            .zip(self.inputs)
            .map(|((value, step), input)| (value + step).clamp(input.range()[0], input.range()[1]))
            .collect();
        let offset = state.offset + if self.free_offset { step[self.inputs.len()] } else { 0.0 };
        let prediction = if inputs == state.inputs { state.prediction.clone() } else { self.run(&inputs)? };
        Ok(self.state(inputs, offset, prediction, scales))
    }

    /// How residuals change with each unknown, unknown by unknown.
    fn slopes(&self, state: &State, scales: &[f64]) -> Result<Vec<Vec<f64>>, PredictError> {
        let runs: Vec<(usize, f64)> = (0..self.inputs.len()).flat_map(|k| [(k, -1.0), (k, 1.0)]).collect();
        let ends = runs
            .par_iter()
            .map(|&(k, sign)| {
                let mut values = state.inputs.clone();
                let [low, high] = self.inputs[k].range();
                values[k] = (values[k] + sign * self.inputs[k].nudge()).clamp(low, high);
                let prediction = self.run(&values)?;
                Ok((values[k], self.state(values, state.offset, prediction, scales).residuals))
            })
            .collect::<Result<Vec<_>, PredictError>>()?;
        let mut slopes: Vec<Vec<f64>> =
            ends.chunks(2).map(|ends| difference(&ends[0].1, &ends[1].1, ends[1].0 - ends[0].0)).collect();
        if self.free_offset {
            let nudge = state.prediction.interval;
            let at = |offset: f64| {
                let residuals = align::residuals(self.data, &state.prediction, offset, scales);
                residuals.into_iter().flatten().collect::<Vec<_>>()
            };
            slopes.push(difference(&at(state.offset - nudge), &at(state.offset + nudge), 2.0 * nudge));
        }
        Ok(slopes)
    }

    /// Root mean square residual of each record, in SI.
    fn noise(&self, state: &State, scales: &[f64]) -> Vec<f64> {
        let records = align::residuals(self.data, &state.prediction, state.offset, scales);
        records
            .iter()
            .zip(scales)
            .map(|(residuals, scale)| {
                let known: Vec<f64> = residuals.iter().flatten().copied().collect();
                let rms = (known.iter().map(|r| r * r).sum::<f64>() / known.len().max(1) as f64).sqrt();
                // A record without any noise would outweigh all others.
                scale * rms.max(1e-6)
            })
            .collect()
    }
}

fn square(residuals: &[Option<f64>]) -> f64 {
    let known = || residuals.iter().flatten();
    known().map(|r| r * r).sum::<f64>() / known().count().max(1) as f64
}

fn difference(low: &[Option<f64>], high: &[Option<f64>], between: f64) -> Vec<f64> {
    low.iter()
        .zip(high)
        .map(|(low, high)| low.zip(*high).map_or(0.0, |(low, high)| (high - low) / between.max(f64::MIN_POSITIVE)))
        .collect()
}

/// JᵀJ, over what is compared.
fn normal(slopes: &[Vec<f64>], residuals: &[Option<f64>]) -> Vec<Vec<f64>> {
    let product = |a: &[f64], b: &[f64]| {
        residuals.iter().zip(a.iter().zip(b)).filter(|(r, _)| r.is_some()).map(|(_, (a, b))| a * b).sum::<f64>()
    };
    slopes.iter().map(|a| slopes.iter().map(|b| product(a, b)).collect()).collect()
}

/// The step −(JᵀJ + λ diag JᵀJ)⁻¹ Jᵀr; none where an unknown changes nothing.
fn damped(slopes: &[Vec<f64>], residuals: &[Option<f64>], damping: f64) -> Option<Vec<f64>> {
    let mut matrix = normal(slopes, residuals);
    for (k, row) in matrix.iter_mut().enumerate() {
        row[k] *= 1.0 + damping;
    }
    let right = |slope: &Vec<f64>| -slope.iter().zip(residuals).filter_map(|(s, r)| Some(s * (*r)?)).sum::<f64>();
    solved(matrix, slopes.iter().map(right).collect())
}

/// Half widths of the 95 % intervals of all unknowns.
fn widths(slopes: &[Vec<f64>], residuals: &[Option<f64>]) -> Option<Vec<f64>> {
    let (count, unknowns) = (residuals.iter().flatten().count(), slopes.len());
    let freedom = count.checked_sub(unknowns).filter(|freedom| *freedom > 0)?;
    let variance = residuals.iter().flatten().map(|r| r * r).sum::<f64>() / freedom as f64;
    let matrix = normal(slopes, residuals);
    (0..unknowns)
        .map(|k| {
            let unit = (0..unknowns).map(|j| f64::from(u8::from(j == k))).collect();
            let inverse = solved(matrix.clone(), unit)?[k];
            (inverse > 0.0).then(|| student(freedom) * (variance * inverse).sqrt())
        })
        .collect()
}

/// Gauss's elimination with the largest pivot of each column, unknowns scaled to a diagonal of ones; none where the matrix is singular.
fn solved(mut matrix: Vec<Vec<f64>>, mut right: Vec<f64>) -> Option<Vec<f64>> {
    let n = right.len();
    let scale: Vec<f64> = (0..n).map(|k| matrix[k][k].sqrt()).collect();
    if scale.iter().any(|scale| scale.is_nan() || *scale <= 0.0) {
        return None;
    }
    for i in 0..n {
        right[i] /= scale[i];
        for j in 0..n {
            matrix[i][j] /= scale[i] * scale[j];
        }
    }
    for k in 0..n {
        let pivot = (k..n).max_by(|&a, &b| matrix[a][k].abs().total_cmp(&matrix[b][k].abs()))?;
        matrix.swap(k, pivot);
        right.swap(k, pivot);
        if matrix[k][k].abs() < 1e-12 {
            return None;
        }
        for i in k + 1..n {
            let factor = matrix[i][k] / matrix[k][k];
            for j in k..n {
                matrix[i][j] -= factor * matrix[k][j];
            }
            right[i] -= factor * right[k];
        }
    }
    for k in (0..n).rev() {
        let known: f64 = (k + 1..n).map(|j| matrix[k][j] * right[j]).sum();
        right[k] = (right[k] - known) / matrix[k][k];
    }
    Some(right.iter().zip(&scale).map(|(x, scale)| x / scale).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A straight line y = a + b x through 0, 1, 2, 3 with values 1, 3, 5, 8: by the textbook a = 0.8, b = 2.3, s² = 0.15, and standard
    /// errors √(0.15 · 0.7) and √(0.15 / 5); two degrees of freedom.
    #[test]
    fn intervals_are_those_of_linear_least_squares() {
        let (xs, ys) = ([0.0, 1.0, 2.0, 3.0], [1.0, 3.0, 5.0, 8.0]);
        // Residuals measured − predicted from a = b = 0; their slopes are −1 and −x.
        let slopes = vec![vec![-1.0; 4], xs.iter().map(|x| -x).collect()];
        let residuals: Vec<Option<f64>> = ys.iter().map(|y| Some(*y)).collect();
        let step = damped(&slopes, &residuals, 0.0).unwrap();
        assert!((step[0] - 0.8).abs() < 1e-12 && (step[1] - 2.3).abs() < 1e-12, "{step:?}");
        let left: Vec<Option<f64>> = xs.iter().zip(ys).map(|(x, y)| Some(y - step[0] - step[1] * x)).collect();
        let widths = widths(&slopes, &left).unwrap();
        for (width, variance) in widths.iter().zip([0.15 * 0.7, 0.15 / 5.0]) {
            assert!((width / (4.302_653 * f64::sqrt(variance)) - 1.0).abs() < 1e-9, "{widths:?}");
        }
        // What changes nothing cannot be told.
        assert_eq!(damped(&[vec![0.0; 4]], &residuals, 0.0), None);
    }
}
