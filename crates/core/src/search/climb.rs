//! Annealing at low temperature in two steps: a cheap score screens, a costly one decides.

use super::beside::Beside;
use super::{Assignment, Rng, Space, exp, sane};
use crate::real::Number;

/// Proposals that are screened at a time: two registers of eight.
const SCREENED: usize = 16;

/// First and last temperature, in units of the loss.
pub const TEMPERATURES: [f64; 2] = [0.002, 0.0005];

/// How far the screen may err before anything is known of it, by how much that is corrected at a time, and its bounds.
const ALLOWANCE: f64 = 0.005;
const CORRECTION: f64 = 0.0005;
const MOST_ALLOWANCE: f64 = 0.05;

/// At most so many good assignments of others are kept to take pieces from.
const POOL: usize = 12;

/// What a climb wants to know next.
#[derive(Clone, Debug, PartialEq)]
pub enum Wanted {
    /// The losses of assignments by the cheap score. One that is above its threshold may be told as anything that is, such as infinity.
    Screen {
        /// What they are changed from; it has been judged.
        from: Assignment,
        /// The assignments.
        assignments: Vec<Assignment>,
        /// For each the greatest loss that is of interest.
        thresholds: Vec<f64>,
    },
    /// The losses of assignments by the costly score.
    Judge(Vec<Assignment>),
}

/// Where one of several climbs side by side stands.
#[derive(Clone, Debug)]
struct Walker {
    current: (Assignment, f64),
    best: (Assignment, f64),
    /// How much worse than by the costly score an assignment may look to the cheap one.
    allowance: f64,
}

/// What was asked for last.
#[derive(Clone, Debug)]
enum Turn {
    /// The starts, to be judged.
    Begin(Vec<Assignment>),
    /// Proposals and what each may lose.
    Screen(Vec<(Assignment, f64)>),
    /// What has passed, the best last, with what each may lose; the last one is judged.
    Judge(Vec<(Assignment, f64)>),
    End,
}

/// Metropolis's method with the threshold T ln(1/u) of each proposal drawn before it is looked at. Sixteen proposals from the same
/// assignment are screened; those that the cheap score sees within threshold and an allowance are judged by the costly score, the most promising first, up to the
/// first one within its threshold, which is taken. The allowance follows from what happens: it is such that about one of
/// sixteen is judged, so that both kinds of scores cost alike.
///
/// The temperature falls by the same factor at every proposal, from the first to the last of [`TEMPERATURES`]. Several starts are
/// climbed from in turn, and take pieces of each other; after each equal part of the first half of all proposals the worse half of them is given up.
///
/// Proposals: a neighbour's letter on a site (40 %; one in eight of them any letter), two neighbours exchanged (20 %), a disc of one
/// letter (12 %), a disc shifted by one step (16 %), a close-packed line of one letter (6 %), a rectangle of another good assignment (6 %).
#[derive(Clone, Debug)]
pub struct Climb {
    space: Space,
    beside: Beside,
    rng: Rng,
    temperatures: [f64; 2],
    /// Proposals to screen in all, and screened so far.
    length: u64,
    tried: u64,
    walkers: Vec<Walker>,
    /// Walkers at the beginning.
    began: usize,
    /// Whose turn it is.
    turn: usize,
    asked: Turn,
    /// Good assignments that pieces are taken from, the best first.
    pool: Vec<(Assignment, f64)>,
}

impl Climb {
    /// Begins at `starts`, at least one, with `length` proposals to be screened.
    pub fn new(space: &Space, starts: Vec<Assignment>, length: u64, temperatures: [f64; 2], seed: u64) -> Self {
        Self {
            space: space.clone(),
            beside: Beside::new(space),
            rng: Rng::new(seed),
            temperatures,
            length,
            tried: 0,
            began: starts.len(),
            walkers: Vec::new(),
            turn: 0,
            asked: Turn::Begin(starts),
            pool: Vec::new(),
        }
    }

    /// Proposals screened so far.
    pub fn tried(&self) -> u64 {
        self.tried
    }

    /// How many climbs there still are.
    pub fn walkers(&self) -> usize {
        self.walkers.len()
    }

    /// The best assignment so far, and its loss by the costly score.
    pub fn best(&self) -> Option<(&Assignment, f64)> {
        let best = self.walkers.iter().map(|walker| &walker.best).min_by(|a, b| a.1.total_cmp(&b.1));
        best.map(|(assignment, loss)| (assignment, *loss))
    }

    /// What is wanted next; nothing when the climb has ended.
    pub fn ask(&mut self) -> Option<Wanted> {
        match &self.asked {
            Turn::Begin(starts) => Some(Wanted::Judge(starts.clone())),
            Turn::Judge(passed) => passed.last().map(|(assignment, _)| Wanted::Judge(vec![assignment.clone()])),
            Turn::Screen(proposals) => {
                let walker = &self.walkers[self.turn];
                let most = walker.current.1 + walker.allowance;
                let (assignments, thresholds) =
                    proposals.iter().map(|(assignment, may_lose)| (assignment.clone(), most + may_lose)).unzip();
                Some(Wanted::Screen { from: walker.current.0.clone(), assignments, thresholds })
            }
            Turn::End => None,
        }
    }

    /// The losses of what was asked for last, in its order; less is better. A failed one is infinite or not a number.
    pub fn tell(&mut self, losses: &[f64]) {
        match std::mem::replace(&mut self.asked, Turn::End) {
            Turn::Begin(starts) => {
                for (assignment, &loss) in starts.into_iter().zip(losses) {
                    let start = (assignment, sane(loss));
                    self.remember(&start);
                    self.walkers.push(Walker { current: start.clone(), best: start, allowance: ALLOWANCE });
                }
                self.propose();
            }
            Turn::Screen(proposals) => {
                self.tried += proposals.len() as u64;
                let walker = &mut self.walkers[self.turn];
                let most = walker.current.1 + walker.allowance;
                let mut passed: Vec<(f64, (Assignment, f64))> = proposals
                    .into_iter()
                    .zip(losses)
                    .filter(|((_, may_lose), loss)| **loss <= most + may_lose)
                    .map(|(proposal, &loss)| (loss, proposal))
                    .collect();
                let correction = CORRECTION * (1.0 - passed.len() as f64);
                walker.allowance = (walker.allowance + correction).clamp(-MOST_ALLOWANCE, MOST_ALLOWANCE);
                // The sort is stable: of two that are alike the first one proposed is judged first.
                passed.sort_by(|a, b| a.0.total_cmp(&b.0));
                passed.reverse();
                self.asked = Turn::Judge(passed.into_iter().map(|(_, proposal)| proposal).collect());
                self.next();
            }
            Turn::Judge(mut passed) => {
                if let (Some((assignment, may_lose)), Some(&loss)) = (passed.pop(), losses.first()) {
                    let loss = sane(loss);
                    let walker = &mut self.walkers[self.turn];
                    if loss.is_finite() && loss <= walker.current.1 + may_lose {
                        walker.current = (assignment, loss);
                        passed.clear();
                        if loss < walker.best.1 {
                            walker.best = walker.current.clone();
                            let best = walker.best.clone();
                            self.remember(&best);
                        }
                    }
                }
                self.asked = Turn::Judge(passed);
                self.next();
            }
            Turn::End => {}
        }
    }

    /// Goes on where nothing is left to be judged.
    fn next(&mut self) {
        if matches!(&self.asked, Turn::Judge(passed) if passed.is_empty()) {
            self.turn += 1;
            if self.turn >= self.walkers.len() {
                self.turn = 0;
                self.give_up();
            }
            self.propose();
        }
    }

    /// Of what climbs side by side the worse half ends after each of equal parts of the first half of all proposals.
    fn give_up(&mut self) {
        let halvings = u64::from(self.began.next_power_of_two().trailing_zeros());
        if halvings == 0 {
            return;
        }
        let part = (self.length / 2 / halvings).max(1);
        let left = self.began >> (self.tried / part).min(halvings);
        if left.max(1) < self.walkers.len() {
            self.walkers.sort_by(|a, b| a.best.1.total_cmp(&b.best.1));
            self.walkers.truncate(left.max(1));
        }
    }

    /// Keeps a good assignment; of assignments that differ in less than one in twenty sites the better one.
    fn remember(&mut self, new: &(Assignment, f64)) {
        let alike = |a: &Assignment| a.iter().zip(&new.0).filter(|(a, b)| a != b).count() * 20 < new.0.len();
        if self.pool.iter().any(|(assignment, loss)| *loss <= new.1 && alike(assignment)) {
            return;
        }
        self.pool.retain(|(assignment, _)| !alike(assignment));
        let place = self.pool.partition_point(|(_, loss)| *loss <= new.1);
        self.pool.insert(place, new.clone());
        self.pool.truncate(POOL);
    }

    /// First temperature times a power of the ratio of last and first.
    fn temperature(&self) -> f64 {
        let [hot, cold] = self.temperatures;
        hot * exp(Number::ln(cold / hot) * (self.tried as f64 / self.length as f64).min(1.0))
    }

    fn propose(&mut self) {
        if self.tried >= self.length || self.walkers.is_empty() || self.space.flips() == 0 {
            self.asked = Turn::End;
            return;
        }
        let temperature = self.temperature();
        let count = SCREENED.min(usize::try_from(self.length - self.tried).unwrap_or(SCREENED));
        let from = self.walkers[self.turn].current.0.clone();
        let propose = |_| {
            let assignment = self.changed(&from);
            // u < exp(-d/T), without the exponential.
            (assignment, -temperature * Number::ln(self.rng.unit().max(1e-300)))
        };
        self.asked = Turn::Screen((0..count).map(propose).collect());
    }

    /// Another assignment near to one.
    fn changed(&mut self, from: &Assignment) -> Assignment {
        // In a uniform assignment much changes nothing.
        for _ in 0..100 {
            let assignment = self.move_of(from);
            if assignment != *from {
                return assignment;
            }
        }
        let mut assignment = from.clone();
        self.space.flip(&mut assignment, &mut self.rng);
        assignment
    }

    fn move_of(&mut self, from: &Assignment) -> Assignment {
        let rng = &mut self.rng;
        let site = rng.below(from.len() as u64) as usize;
        let paint = |sites: Vec<usize>, letter: u8| {
            let mut assignment = from.clone();
            sites.into_iter().for_each(|site| assignment[site] = letter);
            assignment
        };
        let any = |rng: &mut Rng| rng.below(u64::from(self.space.alphabet)) as u8;
        match rng.below(100) {
            0..40 => {
                let letter = match self.beside.step(site, self.beside.direction(rng)) {
                    Some(other) if rng.below(8) > 0 => from[other],
                    _ => any(rng),
                };
                paint(vec![site], letter)
            }
            40..60 => {
                let mut assignment = from.clone();
                if let Some(other) = self.beside.step(site, self.beside.direction(rng)) {
                    assignment.swap(site, other);
                }
                assignment
            }
            60..72 => {
                let radius = 1 + rng.below(3) / 2;
                let letter = if rng.below(2) == 0 { any(rng) } else { from[site] };
                paint(self.beside.disc(site, radius), letter)
            }
            72..88 => {
                let (radius, direction) = (1 + rng.below(3), self.beside.direction(rng));
                self.beside.shift(from, &self.beside.disc(site, radius), direction)
            }
            88..94 => {
                let (direction, length) = (self.beside.direction(rng), 3 + rng.below(6));
                let letter = if rng.below(2) == 0 { any(rng) } else { from[site] };
                paint(self.beside.line(site, direction, length), letter)
            }
            _ => {
                let Some((other, _)) = self.pool.get(rng.below(self.pool.len().max(1) as u64) as usize) else {
                    return from.clone();
                };
                let mut assignment = from.clone();
                for site in self.space.rectangle(rng, 8) {
                    assignment[site] = other[site];
                }
                assignment
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn space() -> Space {
        Space::sheet((0..64).map(|k| [1 + k / 8, 1 + k % 8]), 3)
    }

    /// How many sites differ from a pattern, in units of 0.01, and what a cheap score that errs by half as much says.
    fn score(assignment: &Assignment) -> f64 {
        assignment.iter().enumerate().filter(|&(k, &letter)| usize::from(letter) != k / 8 % 3).count() as f64 * 0.01
    }

    fn cheap(assignment: &Assignment) -> f64 {
        let noise = assignment.iter().enumerate().map(|(k, &letter)| (k + 1) * usize::from(letter)).sum::<usize>() % 11;
        score(assignment) + 0.001 * (noise as f64 - 5.0)
    }

    /// Runs a climb to its end; its best, how much was judged, and all that was asked for.
    fn run(starts: Vec<Assignment>, length: u64, seed: u64, cut: bool) -> (f64, usize, Vec<Wanted>) {
        let mut climb = Climb::new(&space(), starts, length, TEMPERATURES, seed);
        let (mut judged, mut all) = (0, Vec::new());
        while let Some(wanted) = climb.ask() {
            let losses: Vec<f64> = match &wanted {
                Wanted::Judge(assignments) => {
                    judged += assignments.len();
                    assignments.iter().map(score).collect()
                }
                Wanted::Screen { assignments, thresholds, .. } => assignments
                    .iter()
                    .zip(thresholds)
                    .map(|(assignment, &most)| Some(cheap(assignment)).filter(|&loss| !cut || loss <= most))
                    .map(|loss| loss.unwrap_or(f64::INFINITY))
                    .collect(),
            };
            climb.tell(&losses);
            all.push(wanted);
        }
        assert_eq!(climb.tried(), length);
        (climb.best().unwrap().1, judged, all)
    }

    #[test]
    fn a_pattern_is_found_and_few_are_judged() {
        for seed in 1..=5 {
            let (best, judged, _) = run(vec![vec![0; 64]], 12_000, seed, true);
            assert!(best < 0.025, "seed {seed}: {best}");
            assert!(judged < 12_000 / 8, "seed {seed}: {judged}");
        }
    }

    /// What is above its threshold does not matter beyond that.
    #[test]
    fn a_run_that_is_cut_short_changes_nothing() {
        let starts = || vec![vec![0; 64], vec![1; 64], vec![2; 64], (0..64).map(|k| (k % 3) as u8).collect()];
        assert_eq!(run(starts(), 3000, 7, true), run(starts(), 3000, 7, false));
        assert_ne!(run(starts(), 3000, 8, true).2, run(starts(), 3000, 7, true).2);
    }

    #[test]
    fn of_several_climbs_one_is_left() {
        let starts = vec![vec![0; 64], vec![1; 64], vec![2; 64], (0..64).map(|k| (k % 3) as u8).collect::<Vec<_>>()];
        let mut climb = Climb::new(&space(), starts, 4000, TEMPERATURES, 1);
        let mut walkers = Vec::new();
        while let Some(wanted) = climb.ask() {
            let (Wanted::Judge(assignments) | Wanted::Screen { assignments, .. }) = wanted;
            climb.tell(&assignments.iter().map(score).collect::<Vec<_>>());
            walkers.push((climb.tried(), climb.walkers()));
        }
        let at = |tried: u64| walkers.iter().find(|(t, _)| *t >= tried).unwrap().1;
        assert_eq!([16, 900, 1100, 1900, 2100, 4000].map(at), [4, 4, 2, 2, 1, 1]);
    }

    /// With next to no temperature nothing is taken that is worse, and no allowance of the screen changes that.
    #[test]
    fn what_is_taken_is_within_its_threshold() {
        let mut climb = Climb::new(&space(), vec![vec![0; 64]], 4000, [1e-12; 2], 3);
        let mut last = f64::INFINITY;
        while let Some(wanted) = climb.ask() {
            let losses: Vec<f64> = match &wanted {
                Wanted::Judge(assignments) => assignments.iter().map(score).collect(),
                Wanted::Screen { from, assignments, .. } => {
                    assert!(score(from) <= last + 1e-10);
                    last = score(from);
                    assignments.iter().map(cheap).collect()
                }
            };
            climb.tell(&losses);
        }
        assert!(last < score(&vec![0; 64]));
    }
}
