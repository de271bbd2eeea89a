//! NSGA-II: a population that spreads along the front of several losses.

use std::collections::HashSet;

use super::breed::{brood, first};
use super::front::{crowding, ranks};
use super::method::{Begin, Parameters, Row};
use super::{Assignment, Loss, Rng, Search, Space, knee};

/// For several losses.
pub(super) const METHOD: Row = Row {
    name: "nsga2",
    about: "NSGA-II: a population towards the front of several objectives",
    parameters: Parameters::Letters,
    starts: 16,
    takes_batch: false,
    begin: |Begin { space, starts, seed, .. }| Box::new(Nsga::new(space, starts, seed)),
    improve: None,
    again: None,
};

/// How many members; how many assignments of the first population and of each generation are asked for.
const MEMBERS: usize = 96;
const FIRST: usize = 192;
const CHILDREN: usize = 32;

/// NSGA-II (K. Deb, A. Pratap, S. Agarwal & T. Meyarivan, IEEE Trans. Evol. Comput. 6 (2002) 182) with the children of
/// [`Genetic`](super::Genetic): members are those of the lowest rank, of the last rank that still fits the least crowded;
/// parents win tournaments of two by rank, then by crowding. It ends when no new child is found.
#[derive(Clone, Debug)]
pub struct Nsga {
    space: Space,
    rng: Rng,
    assignments: Vec<Assignment>,
    losses: Vec<Loss>,
    /// Rank, and crowding distance within the rank, of each member.
    standing: Vec<(usize, f64)>,
    asked: Vec<Assignment>,
    known: HashSet<Assignment>,
    given: Vec<Assignment>,
    begun: bool,
    knee: Option<usize>,
}

impl Nsga {
    /// Begins with `given` among its first population.
    pub fn new(space: &Space, given: Vec<Assignment>, seed: u64) -> Self {
        Self {
            space: space.clone(),
            rng: Rng::new(seed),
            assignments: Vec::new(),
            losses: Vec::new(),
            standing: Vec::new(),
            asked: Vec::new(),
            known: HashSet::new(),
            given,
            begun: false,
            knee: None,
        }
    }

    /// The members of the lowest ranks, in the order of rank, then of crowding.
    fn select(&mut self) {
        let rank = ranks(&self.losses);
        let mut order: Vec<(usize, f64, usize)> = Vec::with_capacity(rank.len());
        for level in 0..=rank.iter().copied().max().unwrap_or(0) {
            let alike: Vec<usize> = (0..rank.len()).filter(|&k| rank[k] == level).collect();
            let apart = crowding(&self.losses, &alike);
            order.extend(alike.into_iter().zip(apart).map(|(k, apart)| (level, apart, k)));
        }
        order.sort_by(|a, b| a.0.cmp(&b.0).then(b.1.total_cmp(&a.1)).then(a.2.cmp(&b.2)));
        order.truncate(MEMBERS);
        self.standing = order.iter().map(|&(rank, apart, _)| (rank, apart)).collect();
        self.assignments = order.iter().map(|&(_, _, k)| self.assignments[k].clone()).collect();
        self.losses = order.iter().map(|&(_, _, k)| self.losses[k].clone()).collect();
        let front: Vec<Vec<f64>> = self.front().map(|(_, loss)| loss.parts.clone()).collect();
        self.knee = knee(&front);
    }

    /// The members that no other dominates.
    pub fn front(&self) -> impl Iterator<Item = (&Assignment, &Loss)> {
        let of = self.assignments.iter().zip(&self.losses).zip(&self.standing);
        of.filter(|(_, (rank, _))| *rank == 0).map(|(member, _)| member)
    }
}

impl Search<Loss> for Nsga {
    fn ask(&mut self) -> Vec<Assignment> {
        self.asked.clear();
        if !self.begun {
            self.begun = true;
            let given = std::mem::take(&mut self.given);
            self.asked = first(&self.space, &mut self.rng, given, FIRST, &mut self.known);
        } else if !self.assignments.is_empty() {
            let (assignments, standing) = (&self.assignments, &self.standing);
            self.asked = brood(&self.space, &mut self.rng, CHILDREN, &mut self.known, |rng| {
                let mut pick = || rng.below(assignments.len() as u64) as usize;
                let (a, b) = (pick(), pick());
                let ((rank_a, apart_a), (rank_b, apart_b)) = (standing[a], standing[b]);
                &assignments[if rank_b < rank_a || (rank_b == rank_a && apart_b > apart_a) { b } else { a }]
            });
        }
        self.asked.clone()
    }

    fn tell(&mut self, losses: &[Loss]) {
        for (assignment, loss) in self.asked.drain(..).zip(losses) {
            // What failed cannot stand on a front.
            if loss.is_finite() {
                self.assignments.push(assignment);
                self.losses.push(loss.clone());
            }
        }
        self.select();
    }

    /// The knee of the front, with its total.
    fn best(&self) -> Option<(&Assignment, f64)> {
        let (assignment, loss) = self.front().nth(self.knee?)?;
        Some((assignment, loss.total))
    }
}
