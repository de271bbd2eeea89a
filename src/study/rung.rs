//! All that is known at one step: evaluations in their order, and the best of them.

use std::collections::HashMap;

use rayon::prelude::*;

use super::aggregate::summary;
use super::family::RayNotes;
use super::{Entry, Study, SurrogateState};
use crate::design::{Design, DesignRef};
use crate::evaluate::ArrivalSurrogate;
use crate::layout::LayoutStats;
use crate::score::Scores;
use crate::search::{Assignment, Loss, rank_correlation};

/// Layouts that are guessed at, so that it takes a second or two.
const GLANCED: usize = 256;

/// One evaluation, judged.
#[derive(Clone, Debug)]
pub struct Judged {
    /// The layout's letters.
    pub assignment: Assignment,
    /// Its scores.
    pub entry: Entry,
    /// What the layout itself says.
    pub stats: LayoutStats,
    /// What it costs.
    pub loss: Loss,
}

impl Judged {
    /// All measures, each the value that counts over all impacts.
    pub fn scores(&self, study: &Study) -> Scores {
        summary(&self.entry, &self.stats, study.objective.aggregate)
    }
}

/// The evaluations at one step, in the order in which they were asked for.
#[derive(Clone, Debug, Default)]
pub struct Rung {
    all: Vec<Judged>,
    place: HashMap<Assignment, usize>,
}

impl Rung {
    /// Adds an evaluation of an assignment that is new here.
    pub fn add(&mut self, study: &Study, assignment: &Assignment, entry: Entry) -> &Judged {
        let stats = study.counter.stats(&study.materials(assignment));
        let loss = study.objective.loss(&entry, &stats);
        self.place.insert(assignment.clone(), self.all.len());
        self.all.push(Judged { assignment: assignment.clone(), entry, stats, loss });
        &self.all[self.all.len() - 1]
    }

    /// What is known of an assignment.
    pub fn get(&self, assignment: &Assignment) -> Option<&Judged> {
        self.place.get(assignment).map(|&place| &self.all[place])
    }

    /// All, in order.
    pub fn all(&self) -> &[Judged] {
        &self.all
    }

    /// Which evaluation it was, from 1.
    pub fn number(&self, assignment: &Assignment) -> Option<u64> {
        self.place.get(assignment).map(|&place| place as u64 + 1)
    }

    /// Those that came to their end, the best first: by what they miss, then by their loss; of two that are alike the older.
    pub fn ranked(&self) -> Vec<&Judged> {
        let mut ranked: Vec<&Judged> = self.all.iter().filter(|judged| judged.loss.is_finite()).collect();
        ranked.sort_by(|a, b| order(&a.loss).partial_cmp(&order(&b.loss)).unwrap_or(std::cmp::Ordering::Equal));
        ranked
    }

    /// What surrogates without a simulation would have said of some of the layouts, evenly over their order; and what rays said of
    /// those of them that were laid from lenses, if there are any.
    pub(super) fn glances(&self, study: &Study, rays: &RayNotes) -> Vec<SurrogateState> {
        let finished: Vec<&Judged> = self.all.iter().filter(|judged| judged.loss.is_finite()).collect();
        let count = finished.len().min(GLANCED);
        let some: Vec<&Judged> = (0..count).map(|k| finished[k * finished.len() / count]).collect();
        let told = |name: &str, costs: &[f64], losses: &[f64]| SurrogateState {
            name: name.to_owned(),
            rank_correlation: rank_correlation(costs, losses),
            shared: losses.len() as u64,
        };
        let losses: Vec<f64> = some.iter().map(|judged| judged.loss.total).collect();
        let late = |design: &Design, surrogate: ArrivalSurrogate| {
            let early: Vec<f64> = some
                .par_iter()
                .map(|judged| -surrogate.delay(design, &study.sheet(design, &judged.assignment)))
                .collect();
            told(surrogate.name(), &early, &losses)
        };
        let mut glances = match study.design() {
            DesignRef::Plane(design) if design.lattice.is_close_packed() => {
                ArrivalSurrogate::ALL.map(|surrogate| late(design, surrogate)).to_vec()
            }
            // Both are of hexagonal sheets of equal spheres.
            DesignRef::Plane(_) | DesignRef::Space(_) => Vec::new(),
        };
        let traced = some.iter().filter_map(|judged| Some((-rays.of(&judged.assignment)?, judged.loss.total)));
        let (scattered, losses): (Vec<f64>, Vec<f64>) = traced.unzip();
        if !losses.is_empty() {
            glances.push(told("rays", &scattered, &losses));
        }
        glances
    }

    /// The rank correlation of the losses here and there, over the layouts known at both, and how many these are.
    pub fn correlation(&self, finer: &Self) -> (Option<f64>, usize) {
        let finite = |judged: &&Judged| judged.loss.is_finite();
        let both = self.all.iter().filter(finite).filter_map(|coarse| {
            let fine = finer.get(&coarse.assignment).filter(finite)?;
            Some((coarse.loss.total, fine.loss.total))
        });
        let (coarse, fine): (Vec<f64>, Vec<f64>) = both.unzip();
        (rank_correlation(&coarse, &fine), coarse.len())
    }
}

/// What keeps the limits comes first, by its loss; then what misses them, by its loss with the penalties.
pub fn order(loss: &Loss) -> (bool, f64) {
    (loss.miss > 0.0, loss.total)
}
