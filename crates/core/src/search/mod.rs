//! Search on discrete designs by ask and tell. Numbers only: what a letter means and where a loss comes from is the caller's.
//!
//! An [`Assignment`] gives each of a [`Space`]'s sites one letter of a small alphabet. A [`Search`] is asked for assignments and told
//! their losses, of which less is better. Everything follows from the seed and the losses told: neither threads nor a
//! clock have a say.
//!
//! - `local`: flips of single sites, then of two, until none improves
//! - `anneal`: simulated annealing; `climb`: the same at low temperature, screened by a cheap score before a costly one decides;
//!   `beside`: who stands beside whom, in a hexagonal sheet or in space
//! - `genetic`: a population that exchanges rectangles; `breed`: how it has children
//! - `cma`: CMA-ES on real parameters; `parametric`: assignments that follow from such; `level_set`: low-order fields, whose signs
//!   decide each site; `curves`: bands between two free curves
//! - `bayes` (with the feature of that name): Bayesian optimisation of real parameters, for few and costly evaluations
//! - `simplices`, `swarm`: other ways to search real parameters, by argmin; `lockstep`: its solvers by ask and tell
//! - `nsga`: several losses at once; `front`: who dominates whom, volume and knee of a front, rank correlation
//! - `method`: the table of these as methods, by name; `rounds`: a method without an end

mod anneal;
#[cfg(feature = "bayes")]
mod bayes;
mod beside;
mod breed;
mod climb;
mod cma;
mod curves;
mod front;
mod genetic;
mod level_set;
mod local;
mod lockstep;
mod method;
mod nsga;
mod parametric;
mod rounds;
mod simplices;
mod swarm;

pub use anneal::Annealing;
#[cfg(feature = "bayes")]
pub use bayes::Bayes;
pub use climb::{Climb, TEMPERATURES, Wanted};
pub use cma::Cma;
pub use curves::Bands;
pub use front::{front, hypervolume, knee, rank_correlation};
pub use genetic::Genetic;
pub use level_set::{Waves, level_set};
pub use local::{LocalSearch, Reach};
pub use method::{Method, MethodError, ORDER};
pub use nsga::Nsga;
pub use parametric::{BATCH, Decode, Optimizer, Parametric, Parametrisation, Surrogate};
pub use rounds::Rounds;
pub use simplices::Simplices;
pub use swarm::Swarm;

use crate::real::Number;

use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::{Rng as _, SeedableRng};

/// A letter for each site.
pub type Assignment = Vec<u8>;

/// What can be chosen.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Space {
    /// Row and column of each site; in space its layer, and its place along x and along y.
    pub sites: Vec<[u32; 3]>,
    /// Size of the alphabet; letters count from 0.
    pub alphabet: u8,
    /// What a crystal in space has beside; none of a hexagonal sheet, where neighbours follow from rows and columns.
    pub adjacency: Option<Adjacency>,
}

/// How the sites of a crystal in space lie to each other.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Adjacency {
    /// Where the axis is along y: what is as far from it on both sides is alike to smooth fields.
    pub axis: u32,
    /// For each site and each direction the site that a step leads to, where that may change.
    pub beside: Vec<Vec<Option<usize>>>,
}

impl Space {
    /// Of a hexagonal sheet: row and column of each site, both from 1 on, and the size of the alphabet.
    pub fn sheet(sites: impl IntoIterator<Item = [u32; 2]>, alphabet: u8) -> Self {
        Self { sites: sites.into_iter().map(|[row, column]| [row, column, 0]).collect(), alphabet, adjacency: None }
    }

    /// Whether sites differ along y.
    fn is_deep(&self) -> bool {
        self.sites.iter().any(|site| site[2] != self.sites[0][2])
    }

    /// Number of assignments that differ from a given one in one site.
    pub fn flips(&self) -> usize {
        self.sites.len() * usize::from(self.alphabet.max(1) - 1)
    }

    /// Any letter on any site, without regard to its neighbours.
    pub fn random(&self, rng: &mut Rng) -> Assignment {
        self.sites.iter().map(|_| rng.below(u64::from(self.alphabet)) as u8).collect()
    }

    /// The sites of a random rectangle, in space a box, that holds at least one, with sides of at most `most` rows and columns.
    fn rectangle(&self, rng: &mut Rng, most: u32) -> Vec<usize> {
        let [row, column, place] = self.sites[rng.below(self.sites.len() as u64) as usize];
        let mut side = || rng.below(u64::from(most.max(1))) as u32;
        let (up, down, left, right) = (side() / 2, side() / 2, side() / 2, side() / 2);
        let [before, behind] = if self.is_deep() { [side() / 2, side() / 2] } else { [0, 0] };
        let holds = |&[r, c, p]: &[u32; 3]| {
            (row.saturating_sub(up)..=row + down).contains(&r)
                && (column.saturating_sub(left)..=column + right).contains(&c)
                && (place.saturating_sub(before)..=place + behind).contains(&p)
        };
        (0..self.sites.len()).filter(|&i| holds(&self.sites[i])).collect()
    }

    /// The sites of a random rectangle, in space a box, around a site, at most `reach` rows and columns to each side.
    fn around(&self, middle: usize, rng: &mut Rng, reach: u32) -> Vec<usize> {
        let [row, column, place] = self.sites[middle];
        let mut side = || rng.below(u64::from(reach)) as u32;
        let (up, across) = (side(), side());
        let along = if self.is_deep() { side() } else { 0 };
        let near =
            |&[r, c, p]: &[u32; 3]| r.abs_diff(row) <= up && c.abs_diff(column) <= across && p.abs_diff(place) <= along;
        (0..self.sites.len()).filter(|&i| near(&self.sites[i])).collect()
    }

    /// All pairs of sites that stand side by side: rows, columns and places along y differ by one at most.
    fn neighbours(&self) -> Vec<[usize; 2]> {
        let beside = |a: usize, b: usize| (0..3).all(|k| self.sites[a][k].abs_diff(self.sites[b][k]) <= 1);
        (0..self.sites.len())
            .flat_map(|a| (a + 1..self.sites.len()).map(move |b| [a, b]))
            .filter(|&[a, b]| beside(a, b))
            .collect()
    }

    /// The first row (`k` = 0) or column (`k` = 1), and how far it is from there to the last, at least one.
    fn range(&self, k: usize) -> (f64, f64) {
        let of = || self.sites.iter().map(|site| site[k]);
        let first = of().min().unwrap_or(0);
        (f64::from(first), f64::from((of().max().unwrap_or(0) - first).max(1)))
    }

    /// The greater of the numbers of rows and columns.
    fn extent(&self) -> u32 {
        let span = |k: usize| {
            let of = || self.sites.iter().map(|site| site[k]);
            of().max().unwrap_or(0) - of().min().unwrap_or(0) + 1
        };
        span(0).max(span(1)).max(span(2))
    }

    /// Gives one site another letter.
    fn flip(&self, assignment: &mut Assignment, rng: &mut Rng) {
        if self.alphabet > 1 {
            let i = rng.below(assignment.len() as u64) as usize;
            let shift = 1 + rng.below(u64::from(self.alphabet) - 1) as u8;
            assignment[i] = shifted(assignment[i], shift, self.alphabet);
        }
    }
}

/// The letter that stands `shift` further on in the alphabet, which is a ring.
fn shifted(letter: u8, shift: u8, alphabet: u8) -> u8 {
    ((u16::from(letter) + u16::from(shift)) % u16::from(alphabet)) as u8
}

/// What an assignment costs, where more than one number counts; less is better.
#[derive(Clone, Debug, PartialEq)]
pub struct Loss {
    /// All in one number, penalties for missed limits included.
    pub total: f64,
    /// By how much limits are missed; 0 if all are kept.
    pub miss: f64,
    /// What is traded for each other, without the penalties.
    pub parts: Vec<f64>,
}

impl Loss {
    /// Of an assignment that failed.
    pub fn failed() -> Self {
        Self { total: f64::INFINITY, miss: f64::INFINITY, parts: Vec::new() }
    }

    /// Whether every number is one.
    pub fn is_finite(&self) -> bool {
        self.total.is_finite() && self.miss.is_finite() && self.parts.iter().all(|part| part.is_finite())
    }
}

/// What is known of the best assignment's neighbours.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub enum LocalOptimality {
    /// Nothing.
    #[default]
    None,
    /// No flip of a single site improves it.
    OneOpt,
    /// Nor of any two.
    TwoOpt,
}

/// Asked for assignments, told their losses: one number each, or a [`Loss`] of several parts.
pub trait Search<L = f64> {
    /// The assignments whose losses are wanted next; none when the search has ended.
    fn ask(&mut self) -> Vec<Assignment>;
    /// The losses of what was asked for last, in its order; less is better. A failed one is infinite or not a number.
    fn tell(&mut self, losses: &[L]);
    /// The best assignment so far, and its loss.
    fn best(&self) -> Option<(&Assignment, f64)>;
    /// What is known of the best assignment's neighbours.
    fn local_optimality(&self) -> LocalOptimality {
        LocalOptimality::None
    }
    /// How often it has begun anew by itself.
    fn restarts(&self) -> u64 {
        0
    }
}

/// Random numbers from raw outputs of xoshiro256++, so that they are the same on every platform.
#[derive(Clone, Debug)]
pub struct Rng(Xoshiro256PlusPlus);

impl Rng {
    /// From a seed.
    pub fn new(seed: u64) -> Self {
        Self(Xoshiro256PlusPlus::seed_from_u64(seed))
    }

    /// Any 64 bits.
    pub fn bits(&mut self) -> u64 {
        self.0.next_u64()
    }

    /// A whole number from 0 to `end` - 1, or 0 if there is none; all alike to 2^-64.
    pub fn below(&mut self, end: u64) -> u64 {
        ((u128::from(self.0.next_u64()) * u128::from(end)) >> 64) as u64
    }

    /// A number from 0 to 1.
    pub fn unit(&mut self) -> f64 {
        crate::stats::fraction(&mut self.0)
    }

    /// The sum of twelve such less six: close to a normal deviate, from sums only.
    pub fn nearly_normal(&mut self) -> f64 {
        (0..12).map(|_| self.unit()).sum::<f64>() - 6.0
    }
}

/// What is not a number is worse than any number.
fn sane(loss: f64) -> f64 {
    if loss.is_nan() { f64::INFINITY } else { loss }
}

/// exp(x) for |x| up to 700, from sums, products and one quotient.
fn exp(x: f64) -> f64 {
    let halvings = (0..11).find(|&k| x.abs() <= 0.5 * f64::from(1 << k)).unwrap_or(11);
    let mut power = Number::exp_small(x.abs() / f64::from(1 << halvings));
    (0..halvings).for_each(|_| power *= power);
    if x < 0.0 { 1.0 / power } else { power }
}

#[cfg(test)]
mod tests;
