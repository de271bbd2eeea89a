//! How far a study is, and what it has found.

use serde::{Deserialize, Serialize};

use super::rung::{Judged, Rung};
use super::{BaselineScores, Entry, Final, Robustness, Study};
use crate::score::Scores;
use crate::search::{LocalOptimality, front, hypervolume, knee};

/// A layout that was found.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Found {
    /// Its scores, over all impacts.
    #[serde(flatten)]
    pub scores: Scores,
    /// Its evaluation.
    #[serde(flatten)]
    pub entry: Entry,
    /// The number that was made small.
    pub loss: f64,
    /// Which evaluation at its step it was, from 1.
    pub evaluation: u64,
    /// Whether it keeps the objective's limits.
    pub within_limits: bool,
    /// Whether it is known that no flip of a single site makes the objective better.
    pub one_opt: bool,
    /// Whether it is known that no flips of two sites make the objective better.
    pub two_opt: bool,
}

impl Found {
    /// One of a rung's evaluations.
    pub fn new(study: &Study, rung: &Rung, judged: &Judged, local_optimality: LocalOptimality) -> Self {
        Self {
            scores: judged.scores(study),
            entry: judged.entry.clone(),
            loss: judged.loss.total,
            evaluation: rung.number(&judged.assignment).unwrap_or(0),
            within_limits: judged.loss.miss == 0.0,
            one_opt: local_optimality >= LocalOptimality::OneOpt,
            two_opt: local_optimality == LocalOptimality::TwoOpt,
        }
    }
}

/// Why a study ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Ended {
    /// All stages are done, and the last has used up its evaluations.
    Budget,
    /// All stages are done, and the last found nothing that it had not seen.
    NothingNew,
    /// The time that one run may take is over; run again to go on.
    Time,
    /// On request; run again to go on.
    Interrupted,
    /// Others have not evaluated yet what it asks for; run again to go on.
    Asked,
}

impl Ended {
    /// Whether to run again is to go on.
    pub fn goes_on(self) -> bool {
        matches!(self, Self::Time | Self::Interrupted | Self::Asked)
    }
}

/// How far a stage is.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct StageState {
    /// Its method.
    pub method: String,
    /// Its step (s).
    #[serde(rename = "step_s")]
    pub step: f64,
    /// Evaluations of layouts that were new at this step; of a climb at its screen's too.
    pub evaluations: u64,
    /// How many layouts a climb has judged at this step.
    #[serde(default, skip_serializing_if = "is_none")]
    pub judged: u64,
    /// Rounds of the method that have ended.
    pub rounds: u64,
    /// The best layout at this step when the stage ended.
    pub best: Option<Scores>,
    /// Whether that keeps the limits.
    pub within_limits: bool,
}

fn is_none(count: &u64) -> bool {
    *count == 0
}

fn one() -> u64 {
    1
}

/// What was evaluated at one time step, and how well its order of layouts agrees with the finest step's.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct RungState {
    /// The step (s).
    #[serde(rename = "step_s")]
    pub step: f64,
    /// Over how many forces layouts are judged.
    #[serde(default = "one")]
    pub forces: u64,
    /// Layouts evaluated at it.
    pub evaluations: u64,
    /// Spearman's rank correlation of the objective with that at the finest step, over the layouts evaluated at both.
    pub rank_correlation: Option<f64>,
    /// How many these are.
    pub shared: u64,
}

/// What a surrogate without a simulation is worth.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SurrogateState {
    /// Which: see [`ArrivalSurrogate`](crate::evaluate::ArrivalSurrogate); or `rays`, of layouts that were laid from lenses: how many of these run
    /// through the focus and not through the protected region.
    pub name: String,
    /// Spearman's rank correlation of its order, the most promising first, with that of the objective at the finest step.
    pub rank_correlation: Option<f64>,
    /// Over how many layouts.
    pub shared: u64,
}

/// The layouts that no other dominates, where several measures are traded.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Front {
    /// The traded measures.
    pub measures: Vec<String>,
    /// Its layouts, in the order of the first measure's loss.
    pub layouts: Vec<Found>,
    /// Volume that it dominates below the start's losses.
    pub hypervolume: Option<f64>,
    /// Place in `layouts` of the knee.
    pub knee: Option<usize>,
}

/// A best so far.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Improvement {
    /// After how many evaluations, of all stages.
    pub evaluations: u64,
    /// The step (s).
    #[serde(rename = "step_s")]
    pub step: f64,
    /// The number that is made small; at another step it is another number.
    pub loss: f64,
    /// Whether the limits are kept.
    pub within_limits: bool,
}

/// How far a study is. Nothing in it depends on when and how often it was interrupted.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// Evaluations, of all stages.
    pub evaluations: u64,
    /// How many of these a guard stopped.
    pub stopped: u64,
    /// The stages begun so far.
    pub stages: Vec<StageState>,
    /// Why it ended.
    pub ended: Ended,
    /// The first start's scores, at the first stage's step.
    pub start: Option<Found>,
    /// The best layout, at the finest step that is reached: of those within the limits that with the least loss. None if no
    /// layout is within the limits.
    pub best: Option<Found>,
    /// Where there is no best: the layout that comes nearest to the limits.
    pub nearest: Option<Found>,
    /// The different steps, in the order in which the stages use them.
    pub rungs: Vec<RungState>,
    /// What surrogates without a simulation are worth; at the end.
    #[serde(default)]
    pub glances: Vec<SurrogateState>,
    /// Where several measures are traded: the front at the finest step that is reached.
    pub front: Option<Front>,
    /// Every evaluation that was the best so far, or the nearest to the limits.
    pub history: Vec<Improvement>,
    /// What layouts are compared with, at the finest step that is reached; simulated at the end.
    pub baselines: Vec<BaselineScores>,
    /// The figures of the best layout, or the nearest, at the finest step that is reached and at half of it.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub finals: Vec<Final>,
    /// What the best layout, or the nearest, loses where it is not built as drawn, at the finest step that is reached.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub tolerance: Option<Robustness>,
}

impl State {
    /// The best layout or the nearest.
    pub fn found(&self) -> Option<&Found> {
        self.best.as_ref().or(self.nearest.as_ref())
    }
}

/// The front of a rung's evaluations; none where nothing is traded.
pub fn front_of(study: &Study, rung: &Rung, start: Option<&Judged>) -> Option<Front> {
    let measures: Vec<String> = study.objective.goals().map(|term| term.measure.name().to_owned()).collect();
    if measures.len() < 2 {
        return None;
    }
    let within: Vec<&Judged> = rung.ranked().into_iter().filter(|judged| judged.loss.miss == 0.0).collect();
    let losses: Vec<_> = within.iter().map(|judged| judged.loss.clone()).collect();
    let mut members: Vec<&Judged> = front(&losses).into_iter().map(|k| within[k]).collect();
    members.sort_by(|a, b| a.loss.parts[0].total_cmp(&b.loss.parts[0]));
    let points: Vec<Vec<f64>> = members.iter().map(|judged| judged.loss.parts.clone()).collect();
    let reference = start.filter(|start| start.loss.is_finite()).map(|start| start.loss.parts.as_slice());
    Some(Front {
        measures,
        layouts: members.iter().map(|judged| Found::new(study, rung, judged, LocalOptimality::None)).collect(),
        hypervolume: reference.map(|reference| hypervolume(&points, reference)),
        knee: knee(&points),
    })
}
