//! The table of methods: what each is called and does, what it needs of whoever asks, and how a round of it begins.
//!
//! A method is a [`Row`] in its own file and a line in [`METHODS`]; study files, their reference and schema, pages and bindings read the table.

use std::fmt;
use std::str::FromStr;

use super::rounds::Begun;
use super::{Assignment, Loss, Parametrisation, Rng, Search, Space};
use super::{anneal, curves, genetic, level_set, local, nsga, parametric, simplices, swarm};

/// All methods, in the order in which they are listed.
const METHODS: &[&Row] = &[
    &genetic::GENETIC,
    &local::FLIPS,
    &local::SWAPS,
    &local::PAIRS,
    &genetic::AND_LOCAL,
    &anneal::METHOD,
    &level_set::METHOD,
    &curves::METHOD,
    &parametric::METHOD,
    &simplices::METHOD,
    &swarm::METHOD,
    &parametric::SCREEN,
    #[cfg(feature = "bayes")]
    &super::bayes::METHOD,
    &nsga::METHOD,
];

/// The name of the method that only builds with the feature `bayes` have.
pub(super) const BAYES: &str = "lens-family-bayes";

/// Half waves each way of a level set, and one more, or knots of a curve, where nobody says how many.
pub const ORDER: usize = 6;

/// A search under way, for as many rounds as there are: see [`Rounds`](super::Rounds).
pub(super) type Round = Box<dyn Search<Loss> + Send>;

/// A search that goes on from an assignment and its loss, with a seed.
type Improve = fn(&Space, Assignment, f64, u64) -> Round;

/// What a method searches.
#[derive(Clone, Copy)]
pub(super) enum Parameters {
    /// The letters themselves.
    Letters,
    /// Numbers of which letters follow: of so many cosines or knots (`order`), from those that come nearest to an assignment.
    Fields(fn(&Space, usize, &[u8]) -> Parametrisation),
    /// The numbers of a parametrisation that whoever asks brings along: of a lens family.
    Brought,
}

/// What a method is.
pub(super) struct Row {
    /// As it is written in files.
    pub name: &'static str,
    /// What it does, in a line.
    pub about: &'static str,
    pub parameters: Parameters,
    /// How many of the best assignments so far it begins with, where nobody says.
    pub starts: usize,
    /// Whether it can be told how many points to ask for at a time.
    pub takes_batch: bool,
    /// Its first round.
    pub begin: fn(Begin<'_>) -> Round,
    /// What follows within a round upon its first part, from that part's best and its loss.
    pub improve: Option<Improve>,
    /// A round after one has ended; none where the first does not end but for want of anything new.
    pub again: Option<fn(Again<'_>) -> Round>,
}

/// What a first round begins with.
pub(super) struct Begin<'a> {
    pub space: &'a Space,
    /// At least one.
    pub starts: Vec<Assignment>,
    /// There where the method searches numbers.
    pub parametrisation: Option<Parametrisation>,
    pub seed: u64,
}

/// What a later round begins with.
pub(super) struct Again<'a> {
    pub space: &'a Space,
    pub begun: &'a Begun,
    pub rng: &'a mut Rng,
    pub seed: u64,
}

/// How to search: a row of the table.
#[derive(Clone, Copy)]
pub struct Method(&'static Row);

impl Method {
    /// What is taken where nobody says: rounds of a genetic search and a local search from its best.
    pub const USUAL: Self = Self(&genetic::AND_LOCAL);

    /// Those that this build has.
    pub fn all() -> impl Iterator<Item = Self> {
        METHODS.iter().map(|row| Self(row))
    }

    pub(super) fn row(self) -> &'static Row {
        self.0
    }

    /// The name as it is written in files.
    pub fn name(self) -> &'static str {
        self.0.name
    }

    /// What it does, in a line.
    pub fn about(self) -> &'static str {
        self.0.about
    }

    /// How many of the best assignments so far it begins with, where nobody says.
    pub fn starts(self) -> usize {
        self.0.starts
    }

    /// Whether it can be told how many points to ask for at a time.
    pub fn takes_batch(self) -> bool {
        self.0.takes_batch
    }

    /// Whether it can be told how many cosines or knots its fields have.
    pub fn takes_order(self) -> bool {
        matches!(self.0.parameters, Parameters::Fields(_))
    }

    /// Whether it searches the parameters of a parametrisation that is to be brought along.
    pub fn takes_parametrisation(self) -> bool {
        matches!(self.0.parameters, Parameters::Brought)
    }

    /// What it searches beside letters, from a start: fields of an order; none where it searches letters, or what is brought along.
    pub fn fields(self, space: &Space, order: usize, start: &[u8]) -> Option<Parametrisation> {
        match self.0.parameters {
            Parameters::Fields(make) => Some(make(space, order, start)),
            Parameters::Letters | Parameters::Brought => None,
        }
    }
}

impl PartialEq for Method {
    fn eq(&self, other: &Self) -> bool {
        self.name() == other.name()
    }
}

impl Eq for Method {}

impl fmt::Debug for Method {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
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
    let others = Method::all().map(Method::name).filter(|name| *name != BAYES);
    others.chain([BAYES]).collect::<Vec<_>>().join(", ")
}

impl FromStr for Method {
    type Err = MethodError;
    fn from_str(name: &str) -> Result<Self, MethodError> {
        match Self::all().find(|method| method.name() == name) {
            Some(method) => Ok(method),
            None if name == BAYES => Err(MethodError::NotBuilt),
            None => Err(MethodError::Unknown(name.to_owned())),
        }
    }
}

/// A search that is told one number, told the whole of a loss.
pub(super) struct ByTotal<S>(pub S);

impl<S: Search> Search<Loss> for ByTotal<S> {
    fn ask(&mut self) -> Vec<Assignment> {
        self.0.ask()
    }
    fn tell(&mut self, losses: &[Loss]) {
        self.0.tell(&losses.iter().map(|loss| loss.total).collect::<Vec<_>>());
    }
    fn best(&self) -> Option<(&Assignment, f64)> {
        self.0.best()
    }
    fn local_optimality(&self) -> super::LocalOptimality {
        self.0.local_optimality()
    }
    fn restarts(&self) -> u64 {
        self.0.restarts()
    }
}
