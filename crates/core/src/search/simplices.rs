//! Simplices by Nelder and Mead, several side by side.

use argmin::core::{IterState, State};
use argmin::solver::neldermead::NelderMead;

use super::lockstep::Lockstep;
use super::method::Row;
use super::{Optimizer, Rng, parametric, sane};

/// Over the parameters of a parametrisation.
pub(super) const METHOD: Row = Row {
    name: "lens-family-simplex",
    about: "Nelder-Mead over the lens family's parameters, several simplices side by side",
    begin: |begin| parametric::by(begin, Optimizer::Simplices),
    ..parametric::METHOD
};

/// How many at a time: a register of them.
const BESIDE: usize = 8;

/// Losses of a simplex whose standard deviation is below this are alike: it has converged, or lies within one layout.
const ALIKE: f64 = 1e-9;

type Simplex = Lockstep<NelderMead<Vec<f64>, f64>, IterState<Vec<f64>, (), (), (), (), f64>>;

/// One of them.
enum Place {
    /// Its corners, which are asked for first.
    Corners(Vec<Vec<f64>>),
    Moving(Box<Simplex>),
}

/// Nelder-Mead as argmin has it (J. A. Nelder & R. Mead, Comput. J. 7 (1965) 308): the first simplex around a start, the others
/// around random points within bounds; one that has converged begins anew around another. Points outside of the bounds are
/// asked for at the nearest point within.
pub struct Simplices {
    bounds: Vec<[f64; 2]>,
    spread: f64,
    rng: Rng,
    places: Vec<Place>,
    /// How many points each of them asked for.
    asked: Vec<usize>,
    restarts: u64,
}

impl Simplices {
    /// Around `start` and seven other points within `bounds`, a lower and an upper one for each parameter; with edges of
    /// `spread` along the parameters.
    pub fn new(start: &[f64], bounds: Vec<[f64; 2]>, spread: f64, seed: u64) -> Self {
        let mut simplices =
            Self { bounds, spread, rng: Rng::new(seed), places: Vec::new(), asked: Vec::new(), restarts: 0 };
        let first = simplices.corners(start.to_vec());
        simplices.places.push(Place::Corners(first));
        for _ in 1..BESIDE {
            let place = simplices.anywhere();
            simplices.places.push(place);
        }
        simplices
    }

    /// How many have begun anew.
    pub fn restarts(&self) -> u64 {
        self.restarts
    }

    fn anywhere(&mut self) -> Place {
        let (bounds, rng) = (&self.bounds, &mut self.rng);
        let middle = bounds.iter().map(|[from, to]| from + (to - from) * rng.unit()).collect();
        Place::Corners(self.corners(middle))
    }

    /// A point, and one along each parameter from it, to the side where there is more room.
    fn corners(&self, middle: Vec<f64>) -> Vec<Vec<f64>> {
        let mut corners = vec![middle.clone()];
        for (k, [from, to]) in self.bounds.iter().enumerate() {
            let mut corner = middle.clone();
            corner[k] += if middle[k] - from < to - middle[k] { self.spread } else { -self.spread };
            corners.push(corner);
        }
        corners
    }

    /// The points whose losses are wanted next.
    pub fn ask(&mut self) -> Vec<Vec<f64>> {
        let mut points = Vec::new();
        self.asked.clear();
        for k in 0..self.places.len() {
            let mut wanted = self.places[k].wanted();
            if wanted.is_empty() {
                self.restarts += 1;
                self.places[k] = self.anywhere();
                wanted = self.places[k].wanted();
            }
            self.asked.push(wanted.len());
            points.extend(wanted);
        }
        for point in &mut points {
            for (x, [from, to]) in point.iter_mut().zip(&self.bounds) {
                *x = x.clamp(*from, *to);
            }
        }
        points
    }

    /// The losses of what was asked for last, in its order.
    pub fn tell(&mut self, losses: &[f64]) {
        let mut losses = losses;
        for (place, count) in self.places.iter_mut().zip(self.asked.drain(..)) {
            let Some((own, rest)) = losses.split_at_checked(count) else { return };
            losses = rest;
            // Means of losses are taken, so they have to be finite.
            let own: Vec<f64> = own.iter().map(|&loss| sane(loss).min(1e6)).collect();
            place.tell(&own);
        }
    }
}

impl Place {
    /// What it asks for; nothing when it has converged.
    fn wanted(&mut self) -> Vec<Vec<f64>> {
        match self {
            Self::Corners(corners) => corners.clone(),
            Self::Moving(simplex) => simplex.ask(),
        }
    }

    fn tell(&mut self, losses: &[f64]) {
        match self {
            Self::Moving(simplex) => simplex.tell(losses),
            Self::Corners(corners) => {
                let solver = NelderMead::new(std::mem::take(corners)).with_sd_tolerance(ALIKE);
                let begun = solver.ok().and_then(|solver| Lockstep::new(solver, IterState::new(), losses));
                if let Some(simplex) = begun {
                    *self = Self::Moving(Box::new(simplex));
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::cell::Cell;

    use argmin::core::{CostFunction, Error, Executor};

    use super::*;

    /// Counts how often it is called.
    struct Valley<'a>(&'a Cell<usize>);

    impl Valley<'_> {
        /// Rosenbrock's, 0 at (1, 1).
        fn at(x: &[f64]) -> f64 {
            (1.0 - x[0]).powi(2) + 100.0 * (x[1] - x[0] * x[0]).powi(2)
        }
    }

    impl CostFunction for Valley<'_> {
        type Param = Vec<f64>;
        type Output = f64;
        fn cost(&self, x: &Vec<f64>) -> Result<f64, Error> {
            self.0.set(self.0.get() + 1);
            Ok(Self::at(x))
        }
    }

    /// Asked and told, a simplex goes where it goes when argmin calls for costs itself, to the bit.
    #[test]
    fn asking_changes_nothing() {
        let corners = vec![vec![-1.2, 1.0], vec![-0.7, 1.0], vec![-1.2, 1.5]];
        let solver = NelderMead::new(corners.clone());
        let count = Cell::new(0);
        let executed =
            Executor::new(Valley(&count), solver.clone()).configure(|state| state.max_iters(60)).run().unwrap();
        let costs: Vec<f64> = corners.iter().map(|x| Valley::at(x)).collect();
        let mut simplex = Lockstep::new(solver, IterState::<Vec<f64>, (), (), (), (), f64>::new(), &costs).unwrap();
        let mut told = costs.into_iter().fold(f64::INFINITY, f64::min);
        let mut evaluations = 3;
        while evaluations < count.get() {
            let costs: Vec<f64> = simplex.ask().iter().map(|x| Valley::at(x)).collect();
            evaluations += costs.len();
            told = costs.iter().copied().fold(told, f64::min);
            simplex.tell(&costs);
        }
        assert_eq!(told, executed.state().get_best_cost());
        assert!(told < 1e-3);
    }

    #[test]
    fn points_stay_within_bounds_and_find_the_valleys_end() {
        let bounds = vec![[-1.5, 1.5], [-0.5, 1.2]];
        let mut simplices = Simplices::new(&[-1.2, 1.0], bounds.clone(), 0.5, 3);
        let mut best = f64::INFINITY;
        for _ in 0..300 {
            let points = simplices.ask();
            assert!(points.iter().flat_map(|x| x.iter().zip(&bounds)).all(|(x, [from, to])| (from..=to).contains(&x)));
            let losses: Vec<f64> = points.iter().map(|x| Valley::at(x)).collect();
            best = losses.iter().copied().fold(best, f64::min);
            simplices.tell(&losses);
        }
        assert!(best < 1e-8, "{best}");
        assert!(simplices.restarts() > 0);
    }
}
