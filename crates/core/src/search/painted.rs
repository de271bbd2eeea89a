//! Choices that follow from a few real parameters, searched by CMA-ES, by what argmin has, or by a Gaussian process.

#[cfg(feature = "bayes")]
use std::collections::HashSet;
use std::sync::Arc;

#[cfg(feature = "bayes")]
use super::Bayes;
use super::level_set::Waves;
use super::method::{Begin, ByTotal, ORDER, Parameters, Round, Row};
use super::{Bands, Choice, Cma, Dice, Search, Simplices, Space, Swarm, sane};

/// CMA-ES over the parameters of a painter that whoever asks brings along.
pub(super) const METHOD: Row = Row {
    name: "lens-family",
    about: "CMA-ES over the parameters of the design's lens family",
    parameters: Parameters::Brought,
    starts: 1,
    takes_batch: false,
    begin: |begin| by(begin, Driver::Cma),
    improve: None,
    again: None,
};

/// By random parameters, of which those are asked for that a guess likes best.
pub(super) const SCREEN: Row = Row {
    name: "lens-family-screen",
    about: "random parameters of the lens family, of which rays choose what is simulated",
    begin: |begin| by(begin, Driver::Screen),
    ..METHOD
};

/// A painter's parameters searched by a driver.
pub(super) fn by(Begin { space, starts, painter, seed }: Begin<'_>, driver: Driver) -> Round {
    let painter = painter.unwrap_or_else(|| Painter::level_sets(space, ORDER, &starts[0]));
    Box::new(ByTotal(Painted::new(painter, driver, seed)))
}

/// From parameters, of any finite values, to a choice.
pub type Paint = dyn Fn(&[f64]) -> Choice + Send + Sync;

/// A map from real parameters to choices.
#[derive(Clone)]
pub struct Painter {
    /// The parameters to begin with; each is searched with a standard deviation of `spread`.
    pub start: Vec<f64>,
    /// First standard deviation of every parameter.
    pub spread: f64,
    /// The least and the greatest value of every parameter that simplices and swarms ask for.
    pub bounds: Vec<[f64; 2]>,
    /// From parameters, of any finite values, to a choice.
    pub paint: Arc<Paint>,
    /// What a choice is guessed to be worth, more being better, where somebody can guess.
    pub guess: Option<Arc<Guess>>,
    /// How many points a search that is free to ask for any number asks for at a time.
    pub batch: usize,
}

/// Points at a time, where nobody says how many.
pub const BATCH: usize = 4;

/// From a choice to what it is guessed to be worth.
pub type Guess = dyn Fn(&[u8]) -> f64 + Send + Sync;

impl Painter {
    /// Level sets with up to `order` - 1 half waves each way, from the one that comes nearest to `start`.
    pub fn level_sets(space: &Space, order: usize, start: &[u8]) -> Self {
        let waves = Waves::new(space, order);
        let fit = waves.fit(start);
        // As far as restarts of CMA-ES commonly begin.
        let bounds = fit.iter().map(|weight| [weight.min(0.0) - 1.5, weight.max(0.0) + 1.5]).collect();
        let paint = Arc::new(move |weights: &[f64]| waves.choice(weights));
        Self { start: fit, spread: 0.5, bounds, paint, guess: None, batch: BATCH }
    }

    /// Bands between curves with so many knots, from those that come nearest to `start`.
    pub fn curves(space: &Space, knots: usize, start: &[u8]) -> Self {
        let bands = Bands::new(space, knots);
        let fit = bands.fit(start);
        // From a quarter of the rows before the first of them to as much behind the last.
        let bounds = vec![[-1.5, 1.5]; fit.len()];
        // A fifth of the rows.
        Self {
            start: fit,
            spread: 0.4,
            bounds,
            paint: Arc::new(move |heights| bands.choice(heights)),
            guess: None,
            batch: BATCH,
        }
    }
}

/// How a painter's parameters are searched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Driver {
    /// CMA-ES
    Cma,
    /// Nelder-Mead, several simplices side by side
    Simplices,
    /// A particle swarm
    Swarm,
    /// Random parameters, of which those are asked for that a guess likes best
    Screen,
    /// Bayesian optimisation, which asks for no choice twice
    #[cfg(feature = "bayes")]
    Bayes,
}

enum Engine {
    Cma(Box<Cma>),
    Simplices(Simplices),
    Swarm(Box<Swarm>),
    Screen,
    /// With the choices that were asked for.
    #[cfg(feature = "bayes")]
    Bayes(Box<Bayes>, HashSet<Choice>),
}

/// A search of a painter's parameters, without end, but for Bayesian optimisation, which ends where nothing new is left. When CMA-ES
/// has converged it begins anew with twice as many points a generation, from the best parameters so far and from random ones in
/// turn (IPOP: A. Auger & N. Hansen, CEC 2005).
pub struct Painted {
    painter: Painter,
    engine: Engine,
    dice: Dice,
    points: Vec<Vec<f64>>,
    asked: Vec<Choice>,
    best: Option<(Choice, Vec<f64>, f64)>,
    /// How often CMA-ES has begun anew.
    restarts: u64,
}

/// Points that are guessed at for one that is asked for.
const SCREENED: usize = 16;

/// Points of a generation at first: two registers of eight.
const POINTS: usize = 16;

/// Restarts after which generations are as large as they get.
const DOUBLINGS: u64 = 4;

impl Painted {
    /// Begins at the painter's start.
    pub fn new(painter: Painter, driver: Driver, seed: u64) -> Self {
        let mut dice = Dice::new(seed);
        let Painter { start, spread, bounds, .. } = &painter;
        let seed = dice.bits();
        let engine = match driver {
            Driver::Cma => Engine::Cma(Box::new(Cma::new(start.clone(), *spread, POINTS, seed))),
            Driver::Simplices => Engine::Simplices(Simplices::new(start, bounds.clone(), *spread, seed)),
            Driver::Swarm => Engine::Swarm(Box::new(Swarm::new(start, bounds.clone(), seed))),
            Driver::Screen => Engine::Screen,
            #[cfg(feature = "bayes")]
            Driver::Bayes => {
                let bayes = Bayes::new(start, bounds.clone(), painter.batch, seed);
                Engine::Bayes(Box::new(bayes), HashSet::new())
            }
        };
        Self { painter, engine, dice, points: Vec::new(), asked: Vec::new(), best: None, restarts: 0 }
    }

    /// The first of halvings: of so many random points the sixteenth part whose choices are guessed to be best; the start with
    /// the first of them.
    fn screened(&mut self) -> Vec<Vec<f64>> {
        let Painter { start, bounds, paint, guess, .. } = &self.painter;
        let dice = &mut self.dice;
        let drawn: Vec<Vec<f64>> = (0..POINTS * SCREENED)
            .map(|_| bounds.iter().map(|[from, to]| from + (to - from) * dice.unit()).collect())
            .collect();
        let worth = |point: &Vec<f64>| guess.as_ref().map_or(0.0, |guess| guess(&paint(point)));
        let mut ranked: Vec<(f64, Vec<f64>)> = drawn.into_iter().map(|point| (worth(&point), point)).collect();
        // Stable: of two that are alike, the first.
        ranked.sort_by(|a, b| b.0.total_cmp(&a.0));
        let first = (self.restarts == 0).then(|| start.clone());
        self.restarts += 1;
        first.into_iter().chain(ranked.into_iter().map(|(_, point)| point)).take(POINTS).collect()
    }

    /// CMA-ES anew, with larger generations.
    fn begin_anew(&mut self) -> Cma {
        self.restarts += 1;
        let near = match &self.best {
            Some((_, point, _)) if self.restarts.is_multiple_of(2) => point.clone(),
            _ => self.painter.start.iter().map(|_| 2.0 * self.painter.spread * self.dice.bell()).collect(),
        };
        let points = POINTS << self.restarts.min(DOUBLINGS);
        Cma::new(near, self.painter.spread, points, self.dice.bits())
    }
}

impl Search for Painted {
    fn ask(&mut self) -> Vec<Choice> {
        if self.painter.start.is_empty() {
            return Vec::new();
        }
        if matches!(&self.engine, Engine::Cma(cma) if cma.has_converged()) {
            self.engine = Engine::Cma(Box::new(self.begin_anew()));
        }
        self.points = match &mut self.engine {
            Engine::Cma(cma) => cma.ask(),
            Engine::Simplices(simplices) => simplices.ask(),
            Engine::Swarm(swarm) => swarm.ask(),
            Engine::Screen => self.screened(),
            #[cfg(feature = "bayes")]
            Engine::Bayes(bayes, asked) => bayes.ask(&mut |point| asked.insert((self.painter.paint)(point))),
        };
        self.asked = self.points.iter().map(|point| (self.painter.paint)(point)).collect();
        self.asked.clone()
    }

    fn tell(&mut self, losses: &[f64]) {
        match &mut self.engine {
            Engine::Cma(cma) => cma.tell(losses),
            Engine::Simplices(simplices) => simplices.tell(losses),
            Engine::Swarm(swarm) => swarm.tell(losses),
            Engine::Screen => {}
            #[cfg(feature = "bayes")]
            Engine::Bayes(bayes, _) => bayes.tell(losses),
        }
        for ((choice, point), &loss) in self.asked.drain(..).zip(self.points.drain(..)).zip(losses) {
            let loss = sane(loss);
            if self.best.as_ref().is_none_or(|(_, _, best)| loss < *best) {
                self.best = Some((choice, point, loss));
            }
        }
    }

    fn best(&self) -> Option<(&Choice, f64)> {
        self.best.as_ref().map(|(choice, _, loss)| (choice, *loss))
    }

    fn restarts(&self) -> u64 {
        match &self.engine {
            Engine::Cma(_) | Engine::Screen => self.restarts,
            Engine::Simplices(simplices) => simplices.restarts(),
            Engine::Swarm(swarm) => swarm.restarts(),
            #[cfg(feature = "bayes")]
            Engine::Bayes(..) => 0,
        }
    }
}
