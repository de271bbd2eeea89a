//! The search over the parameters that a family has beside rows and radius.
//!
//! Rows are whole, and they and the radius decide most of a lens. So these are found first, with all else as it usually is (`solve`). Then the curvature and
//! what is open are moved together between the same rows, by Nelder and Mead's simplex, and rows are sought anew with what they have come to.

use argmin::core::{CostFunction, Error, Executor, State};
use argmin::solver::neldermead::NelderMead;

use super::plano_convex::Shape;
use super::problem::{Candidate, Problem};
use super::solve::{Grid, TIE};

/// Rays behind a fraction, as many as the search of rows and radius has where it refines.
const RAYS: usize = 129;

/// How often simplex and rows take turns.
const ROUNDS: u32 = 2;

/// Steps of a simplex at most.
const STEPS: u64 = 200;

/// Edges of the first simplex, in parts of the ranges.
const EDGE: f64 = 0.05;

impl Problem<'_> {
    /// A shape, and the fraction that it serves.
    pub(super) fn judged(&self, shape: Shape) -> Candidate {
        Candidate { shape, fraction: self.served([shape.apex_row, shape.back_row], 1.0 / shape.radius, RAYS) }
    }

    /// Moves what is open from a lens that was found without it. The values that it comes to are the problem's from then on.
    pub(super) fn seek(&mut self, found: Option<Candidate>) -> Option<Candidate> {
        let mut best = found?;
        for _ in 0..ROUNDS {
            let before = best;
            if let Some((values, candidate)) = self.moved(&best) {
                (self.values, best) = (values, candidate);
            }
            let are_fixed = self.apex_row.is_some() && self.back_row.is_some();
            let anew = if are_fixed { None } else { self.best(Grid::fine(self)) };
            if let Some(anew) = anew.filter(|anew| self.beats(anew, self, &best)) {
                best = anew;
            }
            if best == before {
                break;
            }
        }
        Some(best)
    }

    /// Whether a lens serves more than one of another problem's values, or as much with fewer spheres.
    fn beats(&self, new: &Candidate, of: &Self, old: &Candidate) -> bool {
        let gain = new.fraction - old.fraction;
        gain > TIE || (gain > -TIE && self.count(&new.shape) < of.count(&old.shape))
    }

    /// Better values and curvature between the same rows, if the simplex comes to any.
    fn moved(&self, from: &Candidate) -> Option<(Vec<f64>, Candidate)> {
        let rows = [from.shape.apex_row, from.shape.back_row];
        let bend = self.family.greatest_curvature(&self.place(rows));
        let simplex = || Simplex { problem: self, rows, bend };
        let start = simplex().point(1.0 / from.shape.radius);
        let mut corners = vec![start.clone()];
        for k in 0..start.len() {
            let mut corner = start.clone();
            corner[k] += if start[k] < 0.5 { EDGE } else { -EDGE };
            corners.push(corner);
        }
        // It only fails for tolerances below zero, and what cannot be moved is left as it is.
        let solver = NelderMead::new(corners).with_sd_tolerance(1e-3 * TIE).ok()?;
        let run = Executor::new(simplex(), solver).configure(|state| state.max_iters(STEPS)).run().ok()?;
        let point = run.state().get_best_param()?.clone();
        let (values, curvature) = simplex().meant(&point);
        let other = Problem { values: values.clone(), ..self.clone() };
        let radius = self.radius.unwrap_or(1.0 / curvature);
        let candidate = other.judged(Shape { radius, ..from.shape });
        other.beats(&candidate, self, from).then_some((values, candidate))
    }
}

/// What the simplex moves: the curvature, where it is not given, and what is open, each from 0 to 1 within its range.
struct Simplex<'a> {
    problem: &'a Problem<'a>,
    rows: [u32; 2],
    /// The greatest curvature (1/m).
    bend: f64,
}

impl Simplex<'_> {
    fn bends(&self) -> bool {
        self.problem.radius.is_none() && self.problem.family.is_curved()
    }

    /// Least and greatest value (SI) of each open parameter, and its place.
    fn ranges(&self) -> impl Iterator<Item = (usize, [f64; 2])> {
        let diameter = self.problem.stack.diameter;
        self.problem.open.iter().map(move |&k| {
            let parameter = &self.problem.family.parameters()[k];
            (k, parameter.range.map(|value| value * parameter.quantity.unit(diameter)))
        })
    }

    fn point(&self, curvature: f64) -> Vec<f64> {
        let bend = self.bends().then(|| curvature / self.bend);
        let open = self.ranges().map(|(k, [least, most])| (self.problem.values[k] - least) / (most - least));
        bend.into_iter().chain(open).collect()
    }

    /// The values and the curvature that a point stands for; outside of its ranges those of the nearest within.
    fn meant(&self, point: &[f64]) -> (Vec<f64>, f64) {
        let mut numbers = point.iter().map(|x| x.clamp(0.0, 1.0));
        let curvature = match (self.problem.radius, self.bends()) {
            (Some(radius), _) => 1.0 / radius,
            // A flat face is no lens.
            (None, true) => numbers.next().map_or(1.0, |part| part.max(1e-3) * self.bend),
            (None, false) => self.problem.family.curvatures(&self.problem.place(self.rows), 1)[0],
        };
        let mut values = self.problem.values.clone();
        for ((k, [least, most]), part) in self.ranges().zip(numbers) {
            values[k] = least + part * (most - least);
        }
        (values, curvature)
    }
}

impl CostFunction for Simplex<'_> {
    type Param = Vec<f64>;
    type Output = f64;

    /// Minus the fraction; of equal ones that is better which takes less of the crystal.
    fn cost(&self, point: &Vec<f64>) -> Result<f64, Error> {
        let (values, curvature) = self.meant(point);
        let problem = Problem { values, ..self.problem.clone() };
        let beyond: f64 = point.iter().map(|x| (x - x.clamp(0.0, 1.0)).abs()).sum();
        let Some(form) = problem.form(self.rows, curvature) else { return Ok(1.0 + beyond) };
        let extents = form.extents(2 + problem.others.len(), problem.stack.half_width, problem.symmetry);
        let all = problem
            .symmetry
            .extent([0.0, problem.stack.half_width], |_| problem.stack.depth(f64::from(problem.stack.rows)));
        Ok(beyond + TIE * extents.iter().sum::<f64>() / all - problem.served(self.rows, curvature, RAYS))
    }
}
