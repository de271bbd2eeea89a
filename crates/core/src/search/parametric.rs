//! Choices that follow from a few real parameters, searched by CMA-ES, by what argmin has, or by a Gaussian process.

#[cfg(feature = "bayes")]
use std::collections::HashSet;
use std::sync::Arc;

#[cfg(feature = "bayes")]
use super::Bayes;
use super::level_set::Waves;
use super::method::{Begin, ByTotal, ORDER, Parameters, Round, Row};
use super::{Assignment, Bands, Cma, Rng, Search, Simplices, Space, Swarm, sane};

/// CMA-ES over the parameters of a parametrisation that whoever asks brings along.
pub(super) const METHOD: Row = Row {
    name: "lens-family",
    about: "CMA-ES over the parameters of the design's lens family",
    parameters: Parameters::Brought,
    starts: 1,
    takes_batch: false,
    begin: |begin| by(begin, Optimizer::Cma),
    improve: None,
    again: None,
};

/// By random parameters, of which those are asked for that a surrogate likes best.
pub(super) const SCREEN: Row = Row {
    name: "lens-family-screen",
    about: "random parameters of the lens family, of which rays choose what is simulated",
    begin: |begin| by(begin, Optimizer::Screen),
    ..METHOD
};

/// A parametrisation's parameters searched by an optimizer.
pub(super) fn by(Begin { space, starts, parametrisation, seed }: Begin<'_>, optimizer: Optimizer) -> Round {
    let parametrisation = parametrisation.unwrap_or_else(|| Parametrisation::level_sets(space, ORDER, &starts[0]));
    Box::new(ByTotal(Parametric::new(parametrisation, optimizer, seed)))
}

/// From parameters, of any finite values, to an assignment.
pub type Decode = dyn Fn(&[f64]) -> Assignment + Send + Sync;

/// A map from real parameters to assignments.
#[derive(Clone)]
pub struct Parametrisation {
    /// The parameters to begin with; each is searched with a standard deviation of `spread`.
    pub start: Vec<f64>,
    /// First standard deviation of every parameter.
    pub spread: f64,
    /// The least and the greatest value of every parameter that simplices and swarms ask for.
    pub bounds: Vec<[f64; 2]>,
    /// From parameters, of any finite values, to an assignment.
    pub decode: Arc<Decode>,
    /// What an assignment is guessed to be worth, more being better, where somebody can guess.
    pub surrogate: Option<Arc<Surrogate>>,
    /// How many points a search that is free to ask for any number asks for at a time.
    pub batch: usize,
}

/// Points at a time, where nobody says how many.
pub const BATCH: usize = 4;

/// From an assignment to what it is guessed to be worth.
pub type Surrogate = dyn Fn(&[u8]) -> f64 + Send + Sync;

impl Parametrisation {
    /// Level sets with up to `order` - 1 half waves each way, from the one that comes nearest to `start`.
    pub fn level_sets(space: &Space, order: usize, start: &[u8]) -> Self {
        let waves = Waves::new(space, order);
        let fit = waves.fit(start);
        // As far as restarts of CMA-ES commonly begin.
        let bounds = fit.iter().map(|weight| [weight.min(0.0) - 1.5, weight.max(0.0) + 1.5]).collect();
        let decode = Arc::new(move |weights: &[f64]| waves.assignment(weights));
        Self { start: fit, spread: 0.5, bounds, decode, surrogate: None, batch: BATCH }
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
            decode: Arc::new(move |heights| bands.assignment(heights)),
            surrogate: None,
            batch: BATCH,
        }
    }
}

/// How a parametrisation's parameters are searched.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Optimizer {
    /// CMA-ES
    Cma,
    /// Nelder-Mead, several simplices side by side
    Simplices,
    /// A particle swarm
    Swarm,
    /// Random parameters, of which those are asked for that a surrogate likes best
    Screen,
    /// Bayesian optimisation, which asks for no assignment twice
    #[cfg(feature = "bayes")]
    Bayes,
}

enum Engine {
    Cma(Box<Cma>),
    Simplices(Simplices),
    Swarm(Box<Swarm>),
    Screen,
    /// With the assignments that were asked for.
    #[cfg(feature = "bayes")]
    Bayes(Box<Bayes>, HashSet<Assignment>),
}

/// A search of a parametrisation's parameters, without end, but for Bayesian optimisation, which ends where nothing new is left. When CMA-ES
/// has converged it begins anew with twice as many points a generation, from the best parameters so far and from random ones in
/// turn (IPOP: A. Auger & N. Hansen, CEC 2005).
pub struct Parametric {
    parametrisation: Parametrisation,
    engine: Engine,
    rng: Rng,
    points: Vec<Vec<f64>>,
    asked: Vec<Assignment>,
    best: Option<(Assignment, Vec<f64>, f64)>,
    /// How often CMA-ES has begun anew.
    restarts: u64,
}

/// Points that are guessed at for one that is asked for.
const SCREENED: usize = 16;

/// Points of a generation at first: two registers of eight.
const POINTS: usize = 16;

/// Restarts after which generations are as large as they get.
const DOUBLINGS: u64 = 4;

impl Parametric {
    /// Begins at the parametrisation's start.
    pub fn new(parametrisation: Parametrisation, optimizer: Optimizer, seed: u64) -> Self {
        let mut rng = Rng::new(seed);
        let Parametrisation { start, spread, bounds, .. } = &parametrisation;
        let seed = rng.bits();
        let engine = match optimizer {
            Optimizer::Cma => Engine::Cma(Box::new(Cma::new(start.clone(), *spread, POINTS, seed))),
            Optimizer::Simplices => Engine::Simplices(Simplices::new(start, bounds.clone(), *spread, seed)),
            Optimizer::Swarm => Engine::Swarm(Box::new(Swarm::new(start, bounds.clone(), seed))),
            Optimizer::Screen => Engine::Screen,
            #[cfg(feature = "bayes")]
            Optimizer::Bayes => {
                let bayes = Bayes::new(start, bounds.clone(), parametrisation.batch, seed);
                Engine::Bayes(Box::new(bayes), HashSet::new())
            }
        };
        Self { parametrisation, engine, rng, points: Vec::new(), asked: Vec::new(), best: None, restarts: 0 }
    }

    /// The first of halvings: of so many random points the sixteenth part whose assignments are guessed to be best; the start with
    /// the first of them.
    fn screened(&mut self) -> Vec<Vec<f64>> {
        let Parametrisation { start, bounds, decode, surrogate, .. } = &self.parametrisation;
        let rng = &mut self.rng;
        let drawn: Vec<Vec<f64>> = (0..POINTS * SCREENED)
            .map(|_| bounds.iter().map(|[from, to]| from + (to - from) * rng.unit()).collect())
            .collect();
        let worth = |point: &Vec<f64>| surrogate.as_ref().map_or(0.0, |surrogate| surrogate(&decode(point)));
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
            _ => self
                .parametrisation
                .start
                .iter()
                .map(|_| 2.0 * self.parametrisation.spread * self.rng.nearly_normal())
                .collect(),
        };
        let points = POINTS << self.restarts.min(DOUBLINGS);
        Cma::new(near, self.parametrisation.spread, points, self.rng.bits())
    }
}

impl Search for Parametric {
    fn ask(&mut self) -> Vec<Assignment> {
        if self.parametrisation.start.is_empty() {
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
            Engine::Bayes(bayes, asked) => bayes.ask(&mut |point| asked.insert((self.parametrisation.decode)(point))),
        };
        self.asked = self.points.iter().map(|point| (self.parametrisation.decode)(point)).collect();
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
        for ((assignment, point), &loss) in self.asked.drain(..).zip(self.points.drain(..)).zip(losses) {
            let loss = sane(loss);
            if self.best.as_ref().is_none_or(|(_, _, best)| loss < *best) {
                self.best = Some((assignment, point, loss));
            }
        }
    }

    fn best(&self) -> Option<(&Assignment, f64)> {
        self.best.as_ref().map(|(assignment, _, loss)| (assignment, *loss))
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
