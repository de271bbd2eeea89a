//! Methods: each kind of search, begun anew whenever it has ended.

use super::method::{Again, Begin, ORDER, Parameters, Round};
use super::{Choice, Dice, Loss, Method, Painter, Proof, Search, Space, sane};

/// Choices that a local search asks for at a time: two registers of eight.
pub(super) const BATCH: usize = 16;

/// What rounds so far have found.
pub(super) struct Begun {
    best: Option<(Choice, f64)>,
}

impl Begun {
    /// The best so far, or what there is without one.
    pub fn so_far(&self, space: &Space) -> Choice {
        self.best.as_ref().map_or_else(|| vec![0; space.sites.len()], |(choice, _)| choice.clone())
    }

    /// The best with rectangles and sites changed at random.
    pub fn kicked(&self, space: &Space, dice: &mut Dice) -> Choice {
        let mut choice = self.so_far(space);
        for _ in 0..1 + dice.below(3) {
            let letter = dice.below(u64::from(space.letters)) as u8;
            for site in space.rectangle(dice, 6) {
                choice[site] = letter;
            }
        }
        for _ in 0..1 + dice.below(1 + space.sites.len() as u64 / 30) {
            space.flip(&mut choice, dice);
        }
        choice
    }
}

/// A method without an end of its own: whoever asks ends it.
pub struct Rounds {
    method: Method,
    space: Space,
    dice: Dice,
    round: Round,
    /// Whether the second part of a round is under way.
    improving: bool,
    asked: Vec<Choice>,
    begun: Begun,
    proof: Proof,
    /// Rounds that have ended.
    ended: u64,
}

impl Rounds {
    /// Begins with `starts`, of which those that need one take the first; it is the first letter everywhere where there is none.
    /// `painter` is what methods search that have fields, or that take what is brought along; without one they search fields
    /// of [`ORDER`], level sets where it is not theirs to say.
    pub fn new(method: Method, space: &Space, mut starts: Vec<Choice>, painter: Option<Painter>, seed: u64) -> Self {
        let mut dice = Dice::new(seed);
        if starts.is_empty() {
            starts.push(vec![0; space.sites.len()]);
        }
        let seed = dice.bits();
        let row = method.row();
        let painter = match row.parameters {
            Parameters::Letters => None,
            Parameters::Fields(make) => Some(painter.unwrap_or_else(|| make(space, ORDER, &starts[0]))),
            Parameters::Brought => Some(painter.unwrap_or_else(|| Painter::level_sets(space, ORDER, &starts[0]))),
        };
        let round = (row.begin)(Begin { space, starts, painter, seed });
        let (space, begun) = (space.clone(), Begun { best: None });
        Self { method, space, dice, round, improving: false, asked: Vec::new(), begun, proof: Proof::None, ended: 0 }
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
        let seed = self.dice.bits();
        let row = self.method.row();
        if let (Some(improve), false) = (row.improve, self.improving)
            && let Some((choice, loss)) = self.round.best()
        {
            self.improving = true;
            return Some(improve(&self.space, choice.clone(), loss, seed));
        }
        self.improving = false;
        self.ended += 1;
        let Self { space, begun, dice, .. } = self;
        row.again.map(|again| again(Again { space, begun, dice, seed }))
    }
}

impl Search<Loss> for Rounds {
    fn ask(&mut self) -> Vec<Choice> {
        if self.space.flips() == 0 {
            // One choice only.
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
        for (choice, loss) in self.asked.drain(..).zip(losses) {
            let loss = sane(loss.total);
            if self.begun.best.as_ref().is_none_or(|(_, best)| loss < *best) {
                self.begun.best = Some((choice, loss));
                self.proof = Proof::None;
            }
        }
        if let Some((best, _)) = &self.begun.best
            && self.round.best().is_some_and(|(choice, _)| choice == best)
        {
            self.proof = self.proof.max(self.round.proof());
        }
    }

    fn best(&self) -> Option<(&Choice, f64)> {
        self.begun.best.as_ref().map(|(choice, loss)| (choice, *loss))
    }

    fn proof(&self) -> Proof {
        self.proof
    }
}
