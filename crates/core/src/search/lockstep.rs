//! Solvers of argmin by ask and tell.
//!
//! A solver calls for costs in the midst of an iteration. Here an iteration is begun from a copy of solver and state; where
//! it calls for a cost that is not known it is given up, and what it called for is asked. Once that is told, the iteration
//! begins again, up to the next unknown cost or its end. Solvers are cheap beside what is asked, and deterministic, so that
//! nothing changes by that.

use std::cell::{Cell, RefCell};

use argmin::core::{CostFunction, Error, Problem, Solver, State, SyncAlias, TerminationStatus};

/// Knows some costs, in the order in which they are called for, and takes down what else is called for.
struct Oracle<'a> {
    known: &'a [f64],
    given: Cell<usize>,
    unknown: RefCell<Vec<Vec<f64>>>,
}

impl Oracle<'_> {
    fn give(&self, points: &[&Vec<f64>]) -> Result<Vec<f64>, Error> {
        let from = self.given.get();
        if let Some(known) = self.known.get(from..from + points.len()) {
            self.given.set(from + points.len());
            return Ok(known.to_vec());
        }
        *self.unknown.borrow_mut() = points.iter().map(|&point| point.clone()).collect();
        Err(Error::msg("a cost is not known yet"))
    }
}

impl CostFunction for Oracle<'_> {
    type Param = Vec<f64>;
    type Output = f64;

    fn cost(&self, point: &Vec<f64>) -> Result<f64, Error> {
        Ok(self.give(&[point])?[0])
    }

    fn bulk_cost<P: std::borrow::Borrow<Vec<f64>> + SyncAlias>(&self, points: &[P]) -> Result<Vec<f64>, Error> {
        self.give(&points.iter().map(std::borrow::Borrow::borrow).collect::<Vec<_>>())
    }
}

/// A solver that has been initialised, and how far its present iteration is.
#[derive(Clone)]
pub(super) struct Lockstep<S, I> {
    solver: S,
    state: I,
    /// Costs that the present iteration has called for.
    known: Vec<f64>,
    converged: bool,
}

/// What a solver needs to be driven by [`Lockstep`].
pub(super) trait Driven<I: State>: Clone {
    /// As argmin's `init`, with the costs that it calls for.
    fn begin(self, state: I, known: &[f64]) -> Result<(Self, I), Vec<Vec<f64>>>;
    /// As argmin's `next_iter`: the solver and its state after it, or the points whose costs it calls for.
    fn next(self, state: I, known: &[f64]) -> Result<(Self, I), Vec<Vec<f64>>>;
    /// Whether the solver says that it has converged.
    fn is_done(&mut self, state: &I) -> bool;
}

impl<I: State, S: Clone + for<'a> Solver<Oracle<'a>, I>> Driven<I> for S {
    fn begin(mut self, state: I, known: &[f64]) -> Result<(Self, I), Vec<Vec<f64>>> {
        let mut problem = Problem::new(Oracle { known, given: Cell::new(0), unknown: RefCell::default() });
        match self.init(&mut problem, state) {
            Ok((state, _)) => Ok((self, state)),
            Err(_) => Err(unknown(problem)),
        }
    }

    fn next(mut self, state: I, known: &[f64]) -> Result<(Self, I), Vec<Vec<f64>>> {
        let mut problem = Problem::new(Oracle { known, given: Cell::new(0), unknown: RefCell::default() });
        match self.next_iter(&mut problem, state) {
            Ok((state, _)) => Ok((self, state)),
            Err(_) => Err(unknown(problem)),
        }
    }

    fn is_done(&mut self, state: &I) -> bool {
        matches!(self.terminate(state), TerminationStatus::Terminated(_))
    }
}

fn unknown(problem: Problem<Oracle<'_>>) -> Vec<Vec<f64>> {
    problem.problem.map_or_else(Vec::new, |oracle| oracle.unknown.into_inner())
}

impl<I: State + Clone, S: Driven<I>> Lockstep<S, I> {
    /// Begins with the costs that the solver calls for first; none if these are not all.
    pub fn new(solver: S, state: I, known: &[f64]) -> Option<Self> {
        let (solver, state) = solver.begin(state, known).ok()?;
        Some(Self { solver, state, known: Vec::new(), converged: false })
    }

    /// The points whose costs are wanted next; none when the solver has converged.
    pub fn ask(&mut self) -> Vec<Vec<f64>> {
        while !self.converged {
            match self.solver.clone().next(self.state.clone(), &self.known) {
                Err(unknown) => {
                    // A solver that fails for another reason has nothing to ask.
                    self.converged = unknown.is_empty();
                    return unknown;
                }
                Ok((solver, state)) => {
                    (self.solver, self.state) = (solver, state);
                    self.known.clear();
                    self.converged = self.solver.is_done(&self.state);
                }
            }
        }
        Vec::new()
    }

    /// The costs of what was asked for last.
    pub fn tell(&mut self, costs: &[f64]) {
        self.known.extend_from_slice(costs);
    }

    /// The solver's state after the last whole iteration.
    pub fn state(&self) -> &I {
        &self.state
    }
}
