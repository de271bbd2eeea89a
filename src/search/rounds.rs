//! Methods: a genetic search, a local one, or the one after the other, begun anew whenever they have ended.

use std::str::FromStr;

use super::{Choice, Dice, Genetic, LocalSearch, Search, Space};

/// Choices that a local search asks for at a time: two registers of eight.
const BATCH: usize = 16;

/// How to search.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Genetic searches, one after the other, each from its own first population.
    Genetic,
    /// Local search from the start; then again and again from the best with rectangles and sites changed at random.
    Local,
    /// Rounds of a genetic search and a local search from its best.
    GeneticLocal,
}

impl Method {
    /// Names as they are written in files.
    pub const NAMES: [(&str, Self); 3] =
        [("genetic", Self::Genetic), ("local", Self::Local), ("genetic+local", Self::GeneticLocal)];

    /// The name as it is written in files.
    pub fn name(self) -> &'static str {
        Self::NAMES.iter().find(|(_, method)| *method == self).map_or("", |(name, _)| name)
    }
}

impl FromStr for Method {
    type Err = String;
    fn from_str(name: &str) -> Result<Self, String> {
        let known = || Self::NAMES.map(|(name, _)| name).join(", ");
        Self::NAMES
            .iter()
            .find(|(known, _)| *known == name)
            .map(|&(_, method)| method)
            .ok_or_else(|| format!("unknown method \"{name}\"; known are {}", known()))
    }
}

enum Stage {
    Genetic(Genetic),
    Local(LocalSearch),
}

impl Stage {
    fn search(&mut self) -> &mut dyn Search {
        match self {
            Self::Genetic(genetic) => genetic,
            Self::Local(local) => local,
        }
    }
}

/// A method without an end of its own: whoever asks ends it.
pub struct Rounds {
    method: Method,
    space: Space,
    dice: Dice,
    stage: Stage,
    asked: Vec<Choice>,
    best: Option<(Choice, f64)>,
    one_opt: bool,
    /// Rounds that have ended.
    ended: u64,
}

impl Rounds {
    /// Begins at, or with, `start`.
    pub fn new(method: Method, space: &Space, start: Choice, seed: u64) -> Self {
        let mut dice = Dice::new(seed);
        let stage = match method {
            Method::Local => Stage::Local(LocalSearch::new(space, start, None, BATCH, dice.bits())),
            _ => Stage::Genetic(Genetic::new(space, vec![start], dice.bits())),
        };
        Self { method, space: space.clone(), dice, stage, asked: Vec::new(), best: None, one_opt: false, ended: 0 }
    }

    /// Rounds that have ended.
    pub fn ended(&self) -> u64 {
        self.ended
    }

    /// The stage after the one that has just ended.
    fn next_stage(&mut self) -> Stage {
        let seed = self.dice.bits();
        if let (Method::GeneticLocal, Stage::Genetic(genetic)) = (self.method, &self.stage)
            && let Some((choice, loss)) = genetic.best()
        {
            return Stage::Local(LocalSearch::new(&self.space, choice.clone(), Some(loss), BATCH, seed));
        }
        self.ended += 1;
        if self.method != Method::Local {
            return Stage::Genetic(Genetic::new(&self.space, Vec::new(), seed));
        }
        let mut choice = self.best.as_ref().map_or_else(Vec::new, |(choice, _)| choice.clone());
        for _ in 0..1 + self.dice.below(3) {
            let letter = self.dice.below(u64::from(self.space.letters)) as u8;
            for site in self.space.rectangle(&mut self.dice, 6) {
                choice[site] = letter;
            }
        }
        for _ in 0..1 + self.dice.below(1 + self.space.sites.len() as u64 / 30) {
            self.space.flip(&mut choice, &mut self.dice);
        }
        Stage::Local(LocalSearch::new(&self.space, choice, None, BATCH, seed))
    }
}

impl Search for Rounds {
    fn ask(&mut self) -> Vec<Choice> {
        if self.space.flips() == 0 {
            // One choice only.
            self.asked = if self.best.is_none() { vec![vec![0; self.space.sites.len()]] } else { Vec::new() };
            return self.asked.clone();
        }
        self.asked = self.stage.search().ask();
        // A stage that begins always asks for something.
        while self.asked.is_empty() {
            self.stage = self.next_stage();
            self.asked = self.stage.search().ask();
        }
        self.asked.clone()
    }

    fn tell(&mut self, losses: &[f64]) {
        if self.space.flips() > 0 {
            self.stage.search().tell(losses);
        }
        for (choice, &loss) in self.asked.drain(..).zip(losses) {
            let loss = super::sane(loss);
            if self.best.as_ref().is_none_or(|(_, best)| loss < *best) {
                self.best = Some((choice, loss));
                self.one_opt = false;
            }
        }
        if let (Stage::Local(local), Some((best, _))) = (&self.stage, &self.best)
            && local.one_opt()
            && local.best().is_some_and(|(choice, _)| choice == best)
        {
            self.one_opt = true;
        }
    }

    fn best(&self) -> Option<(&Choice, f64)> {
        self.best.as_ref().map(|(choice, loss)| (choice, *loss))
    }

    fn one_opt(&self) -> bool {
        self.one_opt
    }
}
