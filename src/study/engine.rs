//! Who evaluates what a search asks for: this process, or others.

use super::entry::pack;
use super::{Entry, Key, Study, StudyError, baselines};
use crate::Context;
use crate::dem::Stop;
use crate::evaluate::{Evaluated, Evaluator, EvaluatorError};
use crate::score::Measure;
use crate::search::Assignment;

/// Evaluates layouts, here or elsewhere. Wherever it is done, the same layout gives the same bits.
pub trait Engine {
    /// The evaluations of layouts at one of the study's steps (`rung`), in their order. Fewer than were asked for end the run with
    /// those that there are: the others are not there yet.
    ///
    /// # Errors
    /// Whatever keeps it from evaluating at all; a layout that a guard stops is an evaluation too.
    fn entries(&mut self, rung: usize, assignments: &[&Assignment]) -> Result<Vec<Entry>, StudyError>;
}

/// This process, on the threads of the current pool: what a study's evaluations need besides the study, at each of its steps.
pub struct Local {
    /// For each rung the study with its forces.
    pub(super) at: Vec<Study>,
    /// For each rung.
    pub(super) evaluators: Vec<Evaluator>,
    /// For each rung.
    pub(super) keys: Vec<Key>,
}

impl Local {
    /// Simulates the uniform crystals that layouts are related to, at each of the study's steps.
    ///
    /// # Errors
    /// A step or window with which nothing can be simulated; uniform crystals that a guard stops; a request to stop.
    pub fn new(study: &Study, context: &Context) -> Result<Self, StudyError> {
        let at: Vec<Study> = (0..study.rungs.len()).map(|rung| study.at(rung)).collect();
        let evaluators = (0..study.rungs.len())
            .map(|rung| {
                let (overrides, cases) = (study.overrides(rung), at[rung].cases());
                let evaluator = Evaluator::new(study.design(), &cases, study.palette.clone(), overrides, context)?;
                let evaluator = evaluator.recording(study.detail());
                if !study.has_rivals() {
                    return Ok(evaluator);
                }
                let rivals: Vec<Vec<u8>> = baselines::layouts(study).into_iter().map(|(_, layout)| layout).collect();
                Ok(evaluator.against(&rivals, context)?)
            })
            .collect::<Result<Vec<_>, StudyError>>()?;
        let keys = evaluators.iter().zip(&at).map(|(evaluator, study)| Key::new(study, evaluator.plan())).collect();
        let local = Self { at, evaluators, keys };
        let asks_for_protection = study.objective.terms.iter().any(|term| term.measure == Measure::Protection);
        match local.no_protection() {
            Some(missing) if asks_for_protection => Err(missing.clone().into()),
            _ => Ok(local),
        }
    }

    /// Why there is no Q under one of the impacts, if so.
    pub(super) fn no_protection(&self) -> Option<&EvaluatorError> {
        self.evaluators.iter().find_map(Evaluator::no_protection)
    }

    /// The key of a layout's evaluation at one of the study's steps.
    pub fn key(&self, study: &Study, rung: usize, assignment: &[u8]) -> String {
        self.keys[rung].of(&study.materials(assignment))
    }

    /// See [`Engine::entries`]; fewer than asked for only where it was interrupted.
    ///
    /// # Errors
    /// Layouts that cannot be simulated side by side.
    pub fn entries(
        &self,
        study: &Study,
        rung: usize,
        assignments: &[&Assignment],
        context: &Context,
    ) -> Result<Vec<Entry>, StudyError> {
        self.entries_within(study, rung, assignments, None, context)
    }

    /// The same where runs end as soon as they are above a limit: see [`Evaluator::scores_within`].
    pub(super) fn entries_within(
        &self,
        study: &Study,
        rung: usize,
        assignments: &[&Assignment],
        limits: Option<&[Vec<f64>]>,
        context: &Context,
    ) -> Result<Vec<Entry>, StudyError> {
        let layouts: Vec<Vec<u8>> = assignments.iter().map(|assignment| study.materials(assignment)).collect();
        let runs = match limits {
            None => self.evaluators[rung].scores(&layouts, context)?,
            Some(limits) => self.evaluators[rung].scores_within(&layouts, limits, context)?,
        };
        // Only what comes before the first interrupted one is kept, so that the journal's order is that of the search.
        let is_interrupted =
            |runs: &Vec<Evaluated>| runs.iter().any(|run| matches!(run.stop, Some(Stop::Interrupted { .. })));
        let whole = runs.iter().position(is_interrupted).unwrap_or(runs.len());
        let alphabet = study.alphabet.len() as u8;
        let entry = |((runs, layout), assignment): ((&Vec<Evaluated>, &Vec<u8>), &&Assignment)| {
            Entry::new(self.keys[rung].of(layout), pack(assignment, alphabet), &self.at[rung].by_impact(runs))
        };
        Ok(runs[..whole].iter().zip(&layouts).zip(assignments).map(entry).collect())
    }
}
