//! Simulated annealing in batches.

use super::method::{Again, Begin, ByTotal, Parameters, Round, Row};
use super::rounds::BATCH;
use super::{Assignment, Rng, Search, Space, sane, shifted};
use crate::real::Number;

/// Changes that an annealing tries, times the number of flips.
const CHANGES: usize = 10;

/// Annealings, the first from the start, each later one from the best of all.
pub(super) const METHOD: Row = Row {
    name: "anneal",
    about: "simulated annealing, begun anew from the best",
    parameters: Parameters::Letters,
    starts: 1,
    takes_batch: false,
    begin: |Begin { space, mut starts, seed, .. }| from(space, starts.swap_remove(0), seed),
    improve: None,
    again: Some(|Again { space, begun, seed, .. }| from(space, begun.so_far(space), seed)),
};

fn from(space: &Space, start: Assignment, seed: u64) -> Round {
    Box::new(ByTotal(Annealing::new(space, start, CHANGES * space.flips(), BATCH, seed)))
}

/// Moves by which the scale of losses is found, before anything is accepted.
const PROBES: usize = 48;

/// First and last temperature, over the median change of the loss in those moves.
const HOT: f64 = 0.5;
const COLD: f64 = 0.005;

/// Simulated annealing (Metropolis 1953; Kirkpatrick 1983): a change that makes the loss worse by d is taken with
/// probability exp(-d/T), the temperature T falling by the same factor at every one of `length` changes tried.
///
/// Changes are asked for in batches, all from the same assignment, and looked at in order up to the first that is taken; those
/// behind it count as not tried. That is the serial method to the letter; it wastes much while hot and little when cold.
///
/// Changes: one site's letter (a half), two neighbours' letters exchanged (a quarter), a small block of one letter (a quarter).
#[derive(Clone, Debug)]
pub struct Annealing {
    space: Space,
    neighbours: Vec<[usize; 2]>,
    rng: Rng,
    batch: usize,
    /// Changes to try in all, and tried so far.
    length: usize,
    tried: usize,
    current: (Assignment, f64),
    best: Option<(Assignment, f64)>,
    asked: Vec<Assignment>,
    /// Median change of the loss in the first moves; none before these.
    scale: Option<f64>,
    begun: bool,
}

impl Annealing {
    /// Begins at `start`; `length` changes are tried, `batch` at a time.
    pub fn new(space: &Space, start: Assignment, length: usize, batch: usize, seed: u64) -> Self {
        Self {
            space: space.clone(),
            neighbours: space.neighbours(),
            rng: Rng::new(seed),
            batch: batch.max(1),
            length,
            tried: 0,
            current: (start, f64::INFINITY),
            best: None,
            asked: Vec::new(),
            scale: None,
            begun: false,
        }
    }

    /// Where it stands, and the loss there.
    pub fn current(&self) -> &(Assignment, f64) {
        &self.current
    }

    /// Changes tried so far.
    pub fn tried(&self) -> usize {
        self.tried
    }

    fn changed(&mut self) -> Assignment {
        let (mut assignment, alphabet) = (self.current.0.clone(), self.space.alphabet);
        match self.rng.below(4) {
            0 if alphabet > 1 => {
                // The least disorderly block is of another letter than the one that stands in its middle.
                let middle = self.rng.below(assignment.len() as u64) as usize;
                let letter = shifted(assignment[middle], 1 + self.rng.below(u64::from(alphabet) - 1) as u8, alphabet);
                for site in self.space.around(middle, &mut self.rng, 4) {
                    assignment[site] = letter;
                }
            }
            1 if !self.neighbours.is_empty() => {
                // A few attempts at two that differ; in a uniform assignment there are none.
                for _ in 0..20 {
                    let [a, b] = self.neighbours[self.rng.below(self.neighbours.len() as u64) as usize];
                    if assignment[a] != assignment[b] {
                        assignment.swap(a, b);
                        return assignment;
                    }
                }
                self.space.flip(&mut assignment, &mut self.rng);
            }
            _ => self.space.flip(&mut assignment, &mut self.rng),
        }
        assignment
    }

    /// T = scale · HOT (COLD/HOT)^(tried/length)
    fn temperature(&self) -> f64 {
        let part = self.tried as f64 / self.length.max(1) as f64;
        self.scale.unwrap_or(0.0) * HOT * super::exp(part * Number::ln(COLD / HOT))
    }
}

impl Search for Annealing {
    fn ask(&mut self) -> Vec<Assignment> {
        self.asked = if !self.begun {
            vec![self.current.0.clone()]
        } else if self.tried >= self.length || self.space.flips() == 0 {
            Vec::new()
        } else {
            let count = if self.scale.is_none() { PROBES } else { self.batch };
            (0..count).map(|_| self.changed()).collect()
        };
        self.asked.clone()
    }

    fn tell(&mut self, losses: &[f64]) {
        let asked = std::mem::take(&mut self.asked);
        let told: Vec<(Assignment, f64)> = asked.into_iter().zip(losses.iter().map(|&loss| sane(loss))).collect();
        for (assignment, loss) in &told {
            if self.best.as_ref().is_none_or(|(_, best)| loss < best) {
                self.best = Some((assignment.clone(), *loss));
            }
        }
        if !self.begun {
            self.begun = true;
            self.current.1 = told.first().map_or(f64::INFINITY, |(_, loss)| *loss);
            return;
        }
        if self.scale.is_none() {
            let mut changes: Vec<f64> = told
                .iter()
                .map(|(_, loss)| (loss - self.current.1).abs())
                .filter(|change| change.is_finite())
                .collect();
            changes.sort_by(f64::total_cmp);
            self.scale = Some(changes.get(changes.len() / 2).copied().unwrap_or(1.0));
            // The best of them is as good a place to begin as any.
            if let Some((assignment, loss)) = self.best.clone() {
                self.current = (assignment, loss);
            }
            return;
        }
        for (assignment, loss) in told {
            self.tried += 1;
            let rise = loss - self.current.1;
            // u < exp(-rise/T), without the exponential; what is not finite is never taken in place of what is.
            let taken = rise <= 0.0 || rise < -self.temperature() * Number::ln(self.rng.unit().max(1e-300));
            if taken && (loss.is_finite() || !self.current.1.is_finite()) {
                self.current = (assignment, loss);
                break;
            }
        }
    }

    fn best(&self) -> Option<(&Assignment, f64)> {
        self.best.as_ref().map(|(assignment, loss)| (assignment, *loss))
    }
}
