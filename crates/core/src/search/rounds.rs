//! Methods: each kind of search, begun anew whenever it has ended.

use super::method::{Again, Begin, ORDER, Parameters, Round};
use super::{Assignment, LocalOptimality, Loss, Method, Parametrisation, Rng, Search, Space, sane};

/// Choices that a local search asks for at a time: two registers of eight.
pub(super) const BATCH: usize = 16;

/// What rounds so far have found.
pub(super) struct Begun {
    best: Option<(Assignment, f64)>,
}

impl Begun {
    /// The best so far, or what there is without one.
    pub fn so_far(&self, space: &Space) -> Assignment {
        self.best.as_ref().map_or_else(|| vec![0; space.sites.len()], |(assignment, _)| assignment.clone())
    }

    /// The best with rectangles and sites changed at random.
    pub fn kicked(&self, space: &Space, rng: &mut Rng) -> Assignment {
        let mut assignment = self.so_far(space);
        for _ in 0..1 + rng.below(3) {
            let letter = rng.below(u64::from(space.alphabet)) as u8;
            for site in space.rectangle(rng, 6) {
                assignment[site] = letter;
            }
        }
        for _ in 0..1 + rng.below(1 + space.sites.len() as u64 / 30) {
            space.flip(&mut assignment, rng);
        }
        assignment
    }
}

/// A method without an end of its own: whoever asks ends it.
pub struct Rounds {
    method: Method,
    space: Space,
    rng: Rng,
    round: Round,
    /// Whether the second part of a round is under way.
    improving: bool,
    asked: Vec<Assignment>,
    begun: Begun,
    local_optimality: LocalOptimality,
    /// Rounds that have ended.
    ended: u64,
}

impl Rounds {
    /// Begins with `starts`, of which those that need one take the first; it is the first letter everywhere where there is none.
    /// `parametrisation` is what methods search that have fields, or that take what is brought along; without one they search fields
    /// of [`ORDER`], level sets where it is not theirs to say.
    pub fn new(
        method: Method,
        space: &Space,
        mut starts: Vec<Assignment>,
        parametrisation: Option<Parametrisation>,
        seed: u64,
    ) -> Self {
        let mut rng = Rng::new(seed);
        if starts.is_empty() {
            starts.push(vec![0; space.sites.len()]);
        }
        let seed = rng.bits();
        let row = method.row();
        let parametrisation = match row.parameters {
            Parameters::Letters => None,
            Parameters::Fields(make) => Some(parametrisation.unwrap_or_else(|| make(space, ORDER, &starts[0]))),
            Parameters::Brought => {
                Some(parametrisation.unwrap_or_else(|| Parametrisation::level_sets(space, ORDER, &starts[0])))
            }
        };
        let round = (row.begin)(Begin { space, starts, parametrisation, seed });
        let (space, begun) = (space.clone(), Begun { best: None });
        Self {
            method,
            space,
            rng,
            round,
            improving: false,
            asked: Vec::new(),
            begun,
            local_optimality: LocalOptimality::None,
            ended: 0,
        }
    }

    /// Rounds that have ended.
    pub fn ended(&self) -> u64 {
        match self.method.row().parameters {
            Parameters::Letters => self.ended,
            Parameters::Fields(_) | Parameters::Brought => self.round.restarts(),
        }
    }

    /// What comes after what has just ended; none if that was the last.
    fn next_round(&mut self) -> Option<Round> {
        let seed = self.rng.bits();
        let row = self.method.row();
        if let (Some(improve), false) = (row.improve, self.improving)
            && let Some((assignment, loss)) = self.round.best()
        {
            self.improving = true;
            return Some(improve(&self.space, assignment.clone(), loss, seed));
        }
        self.improving = false;
        self.ended += 1;
        let Self { space, begun, rng, .. } = self;
        row.again.map(|again| again(Again { space, begun, rng, seed }))
    }
}

impl Search<Loss> for Rounds {
    fn ask(&mut self) -> Vec<Assignment> {
        if self.space.flips() == 0 {
            // One assignment only.
            self.asked = if self.begun.best.is_none() { vec![vec![0; self.space.sites.len()]] } else { Vec::new() };
            return self.asked.clone();
        }
        self.asked = self.round.ask();
        // A round that begins always asks for something.
        while self.asked.is_empty() {
            let Some(next) = self.next_round() else { break };
            self.round = next;
            self.asked = self.round.ask();
        }
        self.asked.clone()
    }

    fn tell(&mut self, losses: &[Loss]) {
        if self.space.flips() > 0 {
            self.round.tell(losses);
        }
        for (assignment, loss) in self.asked.drain(..).zip(losses) {
            let loss = sane(loss.total);
            if self.begun.best.as_ref().is_none_or(|(_, best)| loss < *best) {
                self.begun.best = Some((assignment, loss));
                self.local_optimality = LocalOptimality::None;
            }
        }
        if let Some((best, _)) = &self.begun.best
            && self.round.best().is_some_and(|(assignment, _)| assignment == best)
        {
            self.local_optimality = self.local_optimality.max(self.round.local_optimality());
        }
    }

    fn best(&self) -> Option<(&Assignment, f64)> {
        self.begun.best.as_ref().map(|(assignment, loss)| (assignment, *loss))
    }

    fn local_optimality(&self) -> LocalOptimality {
        self.local_optimality
    }
}
