//! A population that exchanges rectangles.

use std::collections::HashSet;

use super::breed::{brood, first};
use super::method::{Again, Begin, ByTotal, Parameters, Row};
use super::rounds::BATCH;
use super::{Assignment, LocalSearch, Reach, Rng, Search, Space, sane};

/// Genetic searches, one after the other, each from its own first population.
pub(super) const GENETIC: Row = Row {
    name: "genetic",
    about: "a population that exchanges rectangles; begun anew when it has converged",
    parameters: Parameters::Letters,
    starts: 16,
    takes_batch: false,
    begin: |Begin { space, starts, seed, .. }| Box::new(ByTotal(Genetic::new(space, starts, seed))),
    improve: None,
    again: Some(|Again { space, seed, .. }| Box::new(ByTotal(Genetic::new(space, Vec::new(), seed)))),
};

/// Rounds of a genetic search and a local search from its best.
pub(super) const AND_LOCAL: Row = Row {
    name: "genetic+local",
    about: "rounds of a genetic search and a local search from its best",
    improve: Some(|space, best, loss, seed| {
        Box::new(ByTotal(LocalSearch::new(space, best, Some(loss), BATCH, Reach::Flips, seed)))
    }),
    ..GENETIC
};

/// How many members; how many assignments of the first population and of each generation are asked for; and after how many
/// generations without a better best the search ends.
const MEMBERS: usize = 48;
const FIRST: usize = 192;
const CHILDREN: usize = 32;
const PATIENCE: usize = 25;

/// A genetic algorithm. The first population is smooth ([`level_set`](super::level_set)), with each uniform assignment and what is given; the
/// best of it are the members. A child exchanges rectangles with another, then changes a little (`breed`); parents win
/// tournaments of three. Members are the best that are known, all different
/// (elitism). It ends when the best has not improved for 25 generations, or when no new child is found.
#[derive(Clone, Debug)]
pub struct Genetic {
    space: Space,
    rng: Rng,
    members: Vec<(Assignment, f64)>,
    asked: Vec<Assignment>,
    known: HashSet<Assignment>,
    given: Vec<Assignment>,
    begun: bool,
    stale: usize,
}

impl Genetic {
    /// Begins with `given` among its first population.
    pub fn new(space: &Space, given: Vec<Assignment>, seed: u64) -> Self {
        let (rng, known) = (Rng::new(seed), HashSet::new());
        Self { space: space.clone(), rng, members: Vec::new(), asked: Vec::new(), known, given, begun: false, stale: 0 }
    }
}

impl Search for Genetic {
    fn ask(&mut self) -> Vec<Assignment> {
        self.asked.clear();
        if self.space.sites.is_empty() {
            return Vec::new();
        }
        if !self.begun {
            self.begun = true;
            let given = std::mem::take(&mut self.given);
            self.asked = first(&self.space, &mut self.rng, given, FIRST, &mut self.known);
        } else if self.stale < PATIENCE {
            let members = &self.members;
            // The best of three random members; members stand in order.
            self.asked = brood(&self.space, &mut self.rng, CHILDREN, &mut self.known, |rng| {
                let end = members.len() as u64;
                let place = (0..3).map(|_| rng.below(end) as usize).min().unwrap_or(0);
                &members[place].0
            });
        }
        self.asked.clone()
    }

    fn tell(&mut self, losses: &[f64]) {
        let before = self.best().map_or(f64::INFINITY, |(_, loss)| loss);
        self.members.extend(self.asked.drain(..).zip(losses.iter().map(|&loss| sane(loss))));
        // Stable: of two that are alike, the older.
        self.members.sort_by(|a, b| a.1.total_cmp(&b.1));
        self.members.truncate(MEMBERS);
        let after = self.best().map_or(f64::INFINITY, |(_, loss)| loss);
        self.stale = if after < before { 0 } else { self.stale + 1 };
    }

    fn best(&self) -> Option<(&Assignment, f64)> {
        self.members.first().map(|(assignment, loss)| (assignment, *loss))
    }
}
