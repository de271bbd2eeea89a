//! Methods: each kind of search, begun anew whenever it has ended.

use std::str::FromStr;

use super::{
    Annealing, Choice, Dice, Driver, Genetic, LocalSearch, Loss, Nsga, Painted, Painter, Proof, Reach, Search, Space,
    sane,
};

/// Choices that a local search asks for at a time: two registers of eight.
const BATCH: usize = 16;

/// Changes that an annealing tries, times the number of flips.
const ANNEALING: usize = 10;

/// Half waves each way of a level set, and one more, or knots of a curve, where nobody says how many.
pub const ORDER: usize = 6;

/// The method that only builds with the feature `bayes` have.
const BAYES: &str = "lens-family-bayes";

/// How to search.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// Genetic searches, one after the other, each from its own first population.
    Genetic,
    /// Local search from the start; then again and again from the best with rectangles and sites changed at random.
    Local(Reach),
    /// Rounds of a genetic search and a local search from its best.
    GeneticLocal,
    /// Annealings, the first from the start, each later one from the best of all.
    Anneal,
    /// CMA-ES over the coefficients of level sets, the first from that which is nearest to the start.
    LevelSet,
    /// CMA-ES over the faces of bands, one band for each letter but the first; from those that are nearest to the start.
    Curves,
    /// Over the parameters of a painter that whoever asks brings along.
    Painter(Driver),
    /// NSGA-II, for several losses.
    Nsga,
}

impl Method {
    /// Names as they are written in files, of what this build has.
    pub const NAMES: &[(&str, Self)] = &[
        ("genetic", Self::Genetic),
        ("local", Self::Local(Reach::Flips)),
        ("local-swaps", Self::Local(Reach::Swaps)),
        ("local-pairs", Self::Local(Reach::Pairs)),
        ("genetic+local", Self::GeneticLocal),
        ("anneal", Self::Anneal),
        ("level-set", Self::LevelSet),
        ("curves", Self::Curves),
        ("lens-family", Self::Painter(Driver::Cma)),
        ("lens-family-simplex", Self::Painter(Driver::Simplices)),
        ("lens-family-swarm", Self::Painter(Driver::Swarm)),
        ("lens-family-screen", Self::Painter(Driver::Screen)),
        #[cfg(feature = "bayes")]
        (BAYES, Self::Painter(Driver::Bayes)),
        ("nsga2", Self::Nsga),
    ];

    /// The name as it is written in files.
    pub fn name(self) -> &'static str {
        Self::NAMES.iter().find(|(_, method)| *method == self).map_or("", |(name, _)| name)
    }

    /// Whether it can be told how many points to ask for at a time.
    pub fn takes_batch(self) -> bool {
        self.name() == BAYES
    }
}

/// A name that stands for no method here.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum MethodError {
    /// Of no method at all.
    #[error("unknown method \"{0}\"; known are {list}", list = known())]
    Unknown(String),
    /// Of one that this build leaves out.
    #[error(
        "method = \"{BAYES}\", but this granulens is built without the feature bayes. Build with cargo build --release --features bayes, or take method = \"lens-family\", which searches the same parameters by CMA-ES"
    )]
    NotBuilt,
}

/// All names of methods.
fn known() -> String {
    let others = Method::NAMES.iter().map(|(name, _)| *name).filter(|name| *name != BAYES);
    others.chain([BAYES]).collect::<Vec<_>>().join(", ")
}

impl FromStr for Method {
    type Err = MethodError;
    fn from_str(name: &str) -> Result<Self, MethodError> {
        match Self::NAMES.iter().find(|(known, _)| *known == name) {
            Some(&(_, method)) => Ok(method),
            None if name == BAYES => Err(MethodError::NotBuilt),
            None => Err(MethodError::Unknown(name.to_owned())),
        }
    }
}

enum Stage {
    Genetic(Genetic),
    Local(LocalSearch),
    Anneal(Annealing),
    Painted(Painted),
    Nsga(Nsga),
}

impl Stage {
    /// The search, where one number is all it is told.
    fn single(&mut self) -> Result<&mut dyn Search, &mut Nsga> {
        match self {
            Self::Genetic(genetic) => Ok(genetic),
            Self::Local(local) => Ok(local),
            Self::Anneal(anneal) => Ok(anneal),
            Self::Painted(painted) => Ok(painted),
            Self::Nsga(nsga) => Err(nsga),
        }
    }

    fn ask(&mut self) -> Vec<Choice> {
        self.single().map_or_else(|nsga| nsga.ask(), |search| search.ask())
    }

    fn tell(&mut self, losses: &[Loss]) {
        match self.single() {
            Ok(search) => search.tell(&losses.iter().map(|loss| loss.total).collect::<Vec<_>>()),
            Err(nsga) => nsga.tell(losses),
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
    proof: Proof,
    /// Rounds that have ended.
    ended: u64,
}

impl Rounds {
    /// Begins with `starts`, of which those that need one take the first; it is the first letter everywhere where there is none.
    /// `painter` is what [`Method::Painter`], [`Method::LevelSet`] and [`Method::Curves`] search; without one they search level
    /// sets, the last one curves, of [`ORDER`].
    pub fn new(method: Method, space: &Space, mut starts: Vec<Choice>, painter: Option<Painter>, seed: u64) -> Self {
        let mut dice = Dice::new(seed);
        if starts.is_empty() {
            starts.push(vec![0; space.sites.len()]);
        }
        let seed = dice.bits();
        let stage = match method {
            Method::Local(reach) => {
                Stage::Local(LocalSearch::new(space, starts.swap_remove(0), None, BATCH, reach, seed))
            }
            Method::Genetic | Method::GeneticLocal => Stage::Genetic(Genetic::new(space, starts, seed)),
            Method::Anneal => Stage::Anneal(annealing(space, starts.swap_remove(0), seed)),
            Method::LevelSet | Method::Curves | Method::Painter(_) => {
                let driver = if let Method::Painter(driver) = method { driver } else { Driver::Cma };
                let painter = painter.unwrap_or_else(|| match method {
                    Method::Curves => Painter::curves(space, ORDER, &starts[0]),
                    _ => Painter::level_sets(space, ORDER, &starts[0]),
                });
                Stage::Painted(Painted::new(painter, driver, seed))
            }
            Method::Nsga => Stage::Nsga(Nsga::new(space, starts, seed)),
        };
        let space = space.clone();
        Self { method, space, dice, stage, asked: Vec::new(), best: None, proof: Proof::None, ended: 0 }
    }

    /// Rounds that have ended.
    pub fn ended(&self) -> u64 {
        match &self.stage {
            Stage::Painted(painted) => painted.restarts(),
            _ => self.ended,
        }
    }

    /// The best so far, or what there is without one.
    fn so_far(&self) -> Choice {
        self.best.as_ref().map_or_else(|| vec![0; self.space.sites.len()], |(choice, _)| choice.clone())
    }

    /// The stage after the one that has just ended; none if that was the last.
    fn next_stage(&mut self) -> Option<Stage> {
        let seed = self.dice.bits();
        if let (Method::GeneticLocal, Stage::Genetic(genetic)) = (self.method, &self.stage)
            && let Some((choice, loss)) = genetic.best()
        {
            let local = LocalSearch::new(&self.space, choice.clone(), Some(loss), BATCH, Reach::Flips, seed);
            return Some(Stage::Local(local));
        }
        self.ended += 1;
        Some(match self.method {
            Method::Genetic | Method::GeneticLocal => Stage::Genetic(Genetic::new(&self.space, Vec::new(), seed)),
            Method::Local(reach) => {
                let start = self.kicked();
                Stage::Local(LocalSearch::new(&self.space, start, None, BATCH, reach, seed))
            }
            Method::Anneal => Stage::Anneal(annealing(&self.space, self.so_far(), seed)),
            Method::LevelSet | Method::Curves | Method::Painter(_) | Method::Nsga => return None,
        })
    }

    /// The best with rectangles and sites changed at random.
    fn kicked(&mut self) -> Choice {
        let mut choice = self.so_far();
        for _ in 0..1 + self.dice.below(3) {
            let letter = self.dice.below(u64::from(self.space.letters)) as u8;
            for site in self.space.rectangle(&mut self.dice, 6) {
                choice[site] = letter;
            }
        }
        for _ in 0..1 + self.dice.below(1 + self.space.sites.len() as u64 / 30) {
            self.space.flip(&mut choice, &mut self.dice);
        }
        choice
    }
}

fn annealing(space: &Space, start: Choice, seed: u64) -> Annealing {
    Annealing::new(space, start, ANNEALING * space.flips(), BATCH, seed)
}

impl Search<Loss> for Rounds {
    fn ask(&mut self) -> Vec<Choice> {
        if self.space.flips() == 0 {
            // One choice only.
            self.asked = if self.best.is_none() { vec![vec![0; self.space.sites.len()]] } else { Vec::new() };
            return self.asked.clone();
        }
        self.asked = self.stage.ask();
        // A stage that begins always asks for something.
        while self.asked.is_empty() {
            let Some(next) = self.next_stage() else { break };
            self.stage = next;
            self.asked = self.stage.ask();
        }
        self.asked.clone()
    }

    fn tell(&mut self, losses: &[Loss]) {
        if self.space.flips() > 0 {
            self.stage.tell(losses);
        }
        for (choice, loss) in self.asked.drain(..).zip(losses) {
            let loss = sane(loss.total);
            if self.best.as_ref().is_none_or(|(_, best)| loss < *best) {
                self.best = Some((choice, loss));
                self.proof = Proof::None;
            }
        }
        if let (Stage::Local(local), Some((best, _))) = (&self.stage, &self.best)
            && local.best().is_some_and(|(choice, _)| choice == best)
        {
            self.proof = self.proof.max(local.proof());
        }
    }

    fn best(&self) -> Option<(&Choice, f64)> {
        self.best.as_ref().map(|(choice, loss)| (choice, *loss))
    }

    fn proof(&self) -> Proof {
        self.proof
    }
}
