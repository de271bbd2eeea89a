//! A stage that climbs: see [`Climb`]. Screened with one force at a coarse step, where a run ends as soon as its layout cannot pass; judged at the
//! stage's own step and forces.

use super::aggregate::Aggregate;
use super::run::{Run, Watch};
use super::rung::Judged;
use super::state::Ended;
use super::{Entry, StudyError};
use crate::search::{Assignment, Climb, LocalOptimality, Wanted};

/// A change of a layout is taken to raise F by no more than this, over that of the layout that it changes: a run whose P is too great
/// for so much F ends.
const MOST_RISE: f64 = 1.1;

/// Whether P is above what is of interest under one of the impacts. A sum in another order may differ in its last bits.
pub(super) fn above(entry: &Entry, most: &[f64]) -> bool {
    entry.impacts.iter().zip(most).any(|(scores, most)| scores.protected_mean > most * (1.0 - 1e-9))
}

/// Starts that differ on fewer sites than one in so many are taken for the same.
const ALIKE: usize = 10;

impl Run<'_, '_> {
    /// One stage of this kind.
    pub fn climb(&mut self, k: usize, seed: u64, watch: &mut impl Watch) -> Result<Ended, StudyError> {
        let stage = self.study.stages[k];
        let (space, starts) = (self.study.space(), self.different(k));
        let mut climb = Climb::new(&space, starts, stage.evaluations, stage.temperatures, seed);
        let ended = loop {
            if let Some(ended) = self.is_over() {
                break ended;
            }
            let Some(wanted) = climb.ask() else { break Ended::Budget };
            let (losses, simulated) = match &wanted {
                Wanted::Screen { from, assignments, thresholds } => self.screened(k, from, assignments, thresholds)?,
                Wanted::Judge(assignments) => self.judged(k, assignments)?,
            };
            let whole = losses.is_some();
            if let Some(losses) = losses {
                climb.tell(&losses);
            }
            self.show_best(LocalOptimality::None);
            watch.batch(&self.state, simulated);
            if !whole && self.waits() {
                break Ended::Asked;
            }
        };
        self.show_stage(k);
        Ok(ended)
    }

    /// The best layouts of the stage before, without those that are much like a better one.
    fn different(&self, k: usize) -> Vec<Assignment> {
        let wanted = self.study.stages[k].promote;
        let mut chosen: Vec<Assignment> = Vec::new();
        for assignment in self.promoted_of(k, usize::MAX) {
            let alike = |other: &Assignment| {
                other.iter().zip(&assignment).filter(|(a, b)| a != b).count() * ALIKE < assignment.len()
            };
            if chosen.len() < wanted && !chosen.iter().any(alike) {
                chosen.push(assignment);
            }
        }
        chosen
    }

    /// Losses at the screen, infinite where they are above the threshold; none where the run was interrupted. And how many were
    /// simulated.
    fn screened(
        &mut self,
        k: usize,
        from: &Assignment,
        assignments: &[Assignment],
        thresholds: &[f64],
    ) -> Result<(Option<Vec<f64>>, usize), StudyError> {
        let rung = self.study.stages[k].screen;
        // Of assignments that are alike the highest threshold counts.
        let mut fresh: Vec<(&Assignment, f64)> = Vec::new();
        for (assignment, &most) in assignments.iter().zip(thresholds) {
            match fresh.iter_mut().find(|(known, _)| *known == assignment) {
                Some((_, known)) => *known = known.max(most),
                None if self.rungs[rung].get(assignment).is_none() => fresh.push((assignment, most)),
                None => {}
            }
        }
        let limits = self.limits(k, from, &fresh.iter().map(|(_, most)| *most).collect::<Vec<_>>());
        let fresh: Vec<&Assignment> = fresh.into_iter().map(|(assignment, _)| assignment).collect();
        let (entries, simulated) = self.entries(rung, &fresh, limits.as_deref())?;
        let whole = entries.len() == fresh.len();
        for (at, (assignment, entry)) in fresh.into_iter().zip(entries).enumerate() {
            self.count(k, &entry);
            // Whoever evaluates without limits comes to the same.
            let beyond = |limits: &[Vec<f64>]| above(&entry, &limits[at]);
            if !entry.cut && !limits.as_deref().is_some_and(beyond) {
                self.judge(rung, assignment, entry);
            }
        }
        let loss = |(assignment, &most): (&Assignment, &f64)| {
            let loss = self.rungs[rung].get(assignment).map_or(f64::INFINITY, |judged| judged.loss.total);
            if loss <= most { loss } else { f64::INFINITY }
        };
        Ok((whole.then(|| assignments.iter().zip(thresholds).map(loss).collect()), simulated))
    }

    /// Losses at the stage's own step; none where the run was interrupted. And how many were simulated.
    fn judged(&mut self, k: usize, assignments: &[Assignment]) -> Result<(Option<Vec<f64>>, usize), StudyError> {
        let rung = self.study.stages[k].rung;
        let mut fresh: Vec<&Assignment> = Vec::new();
        for assignment in assignments {
            if self.rungs[rung].get(assignment).is_none() && !fresh.contains(&assignment) {
                fresh.push(assignment);
            }
        }
        let (entries, simulated) = self.entries(rung, &fresh, None)?;
        for (assignment, entry) in fresh.into_iter().zip(entries) {
            self.count(k, &entry);
            self.state.stages[k].judged += 1;
            self.judge(rung, assignment, entry);
        }
        let loss = |assignment: &Assignment| self.rungs[rung].get(assignment).map(|judged| judged.loss.total);
        Ok((assignments.iter().map(loss).collect(), simulated))
    }

    /// For each loss, and each case, the P (J) above which no layout can be below it, as F rises by no more than [`MOST_RISE`]; none where the
    /// objective does not follow from F and P alone.
    fn limits(&self, k: usize, from: &Assignment, losses: &[f64]) -> Option<Vec<Vec<f64>>> {
        let stage = self.study.stages[k];
        let objective = &self.study.objective;
        let Judged { entry, stats, .. } = self.rungs[stage.rung].get(from)?;
        let mean = objective.aggregate == Aggregate::Mean && entry.impacts.len() > 1;
        if mean || !objective.follows_energies() || entry.stop.is_some() {
            return None;
        }
        let evaluator = &self.local.evaluators[stage.screen];
        let limit = |(case, focal): (usize, f64), most: f64| {
            // Under the worst of several impacts none does better than under one of them.
            let loss = |protected: f64| {
                let impacts = vec![evaluator.related(case, focal, protected)];
                let entry = Entry { impacts, over_forces: Vec::new(), ..entry.clone() };
                objective.loss(&entry, stats).total
            };
            // The loss rises with P; halved until nothing is left to halve.
            let (mut low, mut high) = (1e-6 * focal, 1e6 * focal);
            for _ in 0..50 {
                let middle = (low * high).sqrt();
                if loss(middle) > most { high = middle } else { low = middle }
            }
            high
        };
        let focal: Vec<f64> = entry.impacts.iter().map(|scores| MOST_RISE * scores.focal_mean).collect();
        let of = |&most: &f64| focal.iter().copied().enumerate().map(|case| limit(case, most)).collect();
        Some(losses.iter().map(of).collect())
    }
}
