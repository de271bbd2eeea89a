//! Choices that follow from a few real parameters, searched by CMA-ES.

use std::sync::Arc;

use super::level_set::Waves;
use super::{Choice, Cma, Dice, Search, Space, sane};

/// From parameters, of any finite values, to a choice.
pub type Paint = dyn Fn(&[f64]) -> Choice + Send + Sync;

/// A map from real parameters to choices.
#[derive(Clone)]
pub struct Painter {
    /// The parameters to begin with; each is searched with a standard deviation of `spread`.
    pub start: Vec<f64>,
    /// First standard deviation of every parameter.
    pub spread: f64,
    /// From parameters, of any finite values, to a choice.
    pub paint: Arc<Paint>,
}

impl Painter {
    /// Level sets with up to `order` - 1 half waves each way, from the one that comes nearest to `start`.
    pub fn level_sets(space: &Space, order: usize, start: &[u8]) -> Self {
        let waves = Waves::new(space, order);
        let fit = waves.fit(start);
        Self { start: fit, spread: 0.5, paint: Arc::new(move |weights| waves.choice(weights)) }
    }
}

/// CMA-ES over a painter's parameters. When it has converged it begins anew with twice as many points a generation, from
/// the best parameters so far and from random ones in turn, without end (IPOP: A. Auger & N. Hansen, CEC 2005).
pub struct Painted {
    painter: Painter,
    cma: Cma,
    dice: Dice,
    points: Vec<Vec<f64>>,
    asked: Vec<Choice>,
    best: Option<(Choice, Vec<f64>, f64)>,
    /// How often it has begun anew.
    restarts: u64,
}

/// Points of a generation at first: two registers of eight.
const POINTS: usize = 16;

/// Restarts after which generations are as large as they get.
const DOUBLINGS: u64 = 4;

impl Painted {
    /// Begins at the painter's start.
    pub fn new(painter: Painter, seed: u64) -> Self {
        let mut dice = Dice::new(seed);
        let cma = Cma::new(painter.start.clone(), painter.spread, POINTS, dice.bits());
        Self { painter, cma, dice, points: Vec::new(), asked: Vec::new(), best: None, restarts: 0 }
    }

    /// How often it has begun anew.
    pub fn restarts(&self) -> u64 {
        self.restarts
    }

    fn begin_anew(&mut self) {
        self.restarts += 1;
        let near = match &self.best {
            Some((_, point, _)) if self.restarts.is_multiple_of(2) => point.clone(),
            _ => self.painter.start.iter().map(|_| 2.0 * self.painter.spread * self.dice.bell()).collect(),
        };
        let points = POINTS << self.restarts.min(DOUBLINGS);
        self.cma = Cma::new(near, self.painter.spread, points, self.dice.bits());
    }
}

impl Search for Painted {
    fn ask(&mut self) -> Vec<Choice> {
        if self.painter.start.is_empty() {
            return Vec::new();
        }
        if self.cma.has_converged() {
            self.begin_anew();
        }
        self.points = self.cma.ask();
        self.asked = self.points.iter().map(|point| (self.painter.paint)(point)).collect();
        self.asked.clone()
    }

    fn tell(&mut self, losses: &[f64]) {
        self.cma.tell(losses);
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
}
