//! The gate: whether a layout is fit to be built, line by line, each with its number, its limit and why it matters.
//!
//! In: a layout under its design, as `check` has simulated it. Out: [`Gate`]. A line *fails* only where building would be a mistake whatever one thinks of models:
//! the geometry does not close, the stack does not stand, the numbers are not numbers yet, or what was asked is missed. All else *warns*. Of a crystal in space there are the
//! same lines but for those of frame, stack and interfaces, which are of sheets.
//!
//! - `geometry`: frame, stack, catalogue; `numbers`: step and window; `physics`: what the wave does and the laws leave open
//! - `again`: what a second blow on the same piece finds

mod again;
mod geometry;
mod numbers;
mod physics;

use std::fmt::Write as _;

use serde::{Deserialize, Serialize};

use crate::Context;
use crate::dem::ContactRecord;
use crate::design::Threshold;
use crate::evaluate::{Doubts, Drawing, Evaluation, EvaluatorError, LoadCase, OverLawsError, Overrides, Plan};
use crate::score::Scores;
use crate::tolerance::{Criterion, Samples, Tolerances, Workshop, WorkshopError};

/// What a line says.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Word {
    /// As it should be.
    Pass,
    /// Look at it before building.
    Warn,
    /// Do not build.
    Fail,
}

impl Word {
    /// As it is printed.
    pub fn name(self) -> &'static str {
        match self {
            Self::Pass => "pass",
            Self::Warn => "warn",
            Self::Fail => "fail",
        }
    }
}

/// One line of the gate.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Line {
    /// What was looked at.
    pub check: String,
    /// What is said.
    pub word: Word,
    /// The number, with its unit.
    pub number: String,
    /// What it is held to.
    pub limit: String,
    /// Why it matters.
    pub why: String,
}

impl Line {
    fn new(check: &str, word: Word, number: impl Into<String>, limit: impl Into<String>, why: &str) -> Self {
        Self { check: check.to_owned(), word, number: number.into(), limit: limit.into(), why: why.to_owned() }
    }
}

/// All lines; the worst of them is the gate's word.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Gate {
    /// The worst of all lines.
    pub word: Word,
    /// Line by line.
    pub lines: Vec<Line>,
}

impl Gate {
    /// The checks that fail, in words.
    pub fn failed(&self) -> Vec<String> {
        let failed = self.lines.iter().filter(|line| line.word == Word::Fail);
        failed.map(|line| format!("{}: {}, limit {}", line.check, line.number, line.limit)).collect()
    }

    /// As lines of a terminal.
    pub fn words(&self) -> String {
        let mut text = String::new();
        for Line { check, word, number, limit, why } in &self.lines {
            let _ = writeln!(text, "{:4}  {check:24} {number}; limit: {limit}. {why}", word.name());
        }
        let _ = write!(text, "gate: {}", self.word.name());
        text
    }
}

/// What is asked of the gate besides what the design says.
#[derive(Clone, Debug, Default)]
pub struct Asked {
    /// Inner width and depth of the frame that there is (m); without it the frame is made to fit.
    pub frame: [Option<f64>; 2],
    /// The least share of pieces, as built, that keep the thresholds: their tolerances, how many are made, and the seed.
    pub least_yield: Option<(f64, Tolerances, u64, u64)>,
}

/// Why the gate cannot say anything.
#[derive(Debug, thiserror::Error)]
pub enum GateError {
    /// Runs that cannot be.
    #[error(transparent)]
    Evaluator(#[from] EvaluatorError),
    /// Laws under which it cannot be simulated.
    #[error(transparent)]
    Laws(#[from] OverLawsError),
    /// Pieces that cannot be made.
    #[error(transparent)]
    Workshop(#[from] WorkshopError),
}

/// What the run of a layout showed, beside the uniform crystals.
#[derive(Clone, Copy, Debug)]
pub struct Seen<'a> {
    /// Its scores, under the design's own force.
    pub scores: &'a Scores,
    /// Those over several forces, where it was judged over them.
    pub over_forces: Option<&'a Scores>,
    /// What limits the trust in them.
    pub doubts: &'a Doubts,
    /// Its contacts.
    pub contacts: &'a [ContactRecord],
}

impl<'a> Seen<'a> {
    /// Of an evaluation, and the scores over several forces where there are some.
    pub fn of<const D: usize>(evaluation: &'a Evaluation<D>, over_forces: Option<&'a Scores>) -> Self {
        let Evaluation { scores, record, doubts } = evaluation;
        Self { scores, over_forces, doubts, contacts: &record.contacts }
    }
}

/// What the gate looks at.
struct Look<'a> {
    drawing: Drawing<'a>,
    plan: &'a Plan,
    seen: Seen<'a>,
    context: &'a Context,
}

impl Look<'_> {
    /// A case of this piece.
    fn case(&self, case: impl Into<LoadCase>) -> LoadCase {
        LoadCase { halves_differ: self.drawing.halves_differ(), ..case.into() }
    }
}

/// Looks at a layout that was simulated beside the uniform crystals.
///
/// # Errors
/// See [`GateError`].
pub fn gate<'a>(
    drawing: impl Into<Drawing<'a>>,
    plan: &'a Plan,
    seen: Seen<'a>,
    asked: &Asked,
    context: &'a Context,
) -> Result<Gate, GateError> {
    let look = Look { drawing: drawing.into(), plan, seen, context };
    let mut lines = geometry::lines(&look, asked.frame);
    lines.extend(numbers::lines(&look)?);
    lines.extend(thresholds(&look));
    if let Some((least, tolerances, samples, seed)) = &asked.least_yield {
        lines.push(as_built(&look, *least, tolerances, [*samples, *seed])?);
    }
    lines.extend(physics::lines(&look)?);
    lines.extend(again::line(&look)?);
    let word = lines.iter().map(|line| line.word).max().unwrap_or(Word::Pass);
    Ok(Gate { word, lines })
}

/// What the design asks.
fn thresholds(look: &Look) -> Vec<Line> {
    let scores = look.seen.over_forces.unwrap_or(look.seen.scores);
    let line = |threshold: &Threshold| {
        let value = scores.get(threshold.measure).filter(|value| value.is_finite());
        let met = value.is_some_and(|value| threshold.admits(value));
        let number = value.map_or("no value: its denominator is zero or its baseline is missing".to_owned(), |value| {
            format!("{value:.4}")
        });
        let bound = |word: &str, limit: Option<f64>| limit.map(|limit| format!("{word} {limit}"));
        let limits: Vec<String> =
            [bound("at least", threshold.min), bound("at most", threshold.max)].into_iter().flatten().collect();
        let word = if met { Word::Pass } else { Word::Fail };
        Line::new(
            &format!("threshold {}", threshold.measure.name()),
            word,
            number,
            limits.join(" and "),
            "The design file asks for it.",
        )
    };
    look.drawing.design().thresholds().iter().map(line).collect()
}

/// How many pieces keep what is asked once they are built.
fn as_built(look: &Look, least: f64, tolerances: &Tolerances, [count, seed]: [u64; 2]) -> Result<Line, GateError> {
    let (drawing, plan) = (look.drawing, look.plan);
    let mut given = given(plan, plan.step, plan.window);
    // A projectile that strikes pieces in lanes may ask for a finer step than the design's impact; without one the step is what it was asked to be.
    let plan = if tolerances.impact.projectile.is_some() && drawing.is_in_space() {
        let finest = tolerances.plan(drawing, Overrides { step: None, ..given }).map_err(EvaluatorError::from)?.step;
        given.step = Some(finest.min(plan.step));
        &tolerances.plan(drawing, given).map_err(EvaluatorError::from)?
    } else {
        plan
    };
    let criterion = Criterion::new(drawing, tolerances, given, look.context)?;
    let workshop = Workshop::new(drawing, tolerances, plan, &criterion.measures())?;
    let mut samples = Samples::new(&workshop, seed);
    samples.grow(&workshop, count, look.context, |_| Ok::<_, WorkshopError>(()))?;
    let of_layout = drawing.scores();
    let share = samples.share(count as usize, &criterion, &of_layout);
    // What the pieces made decide: only a share that is surely too small fails.
    let word = match share {
        share if share.interval[1] < least => Word::Fail,
        share if share.share < least => Word::Warn,
        _ => Word::Pass,
    };
    Ok(Line::new(
        "yield as built",
        word,
        format!("{} of {count} pieces keep {}", share.words(), criterion.words),
        format!("at least {} %", 100.0 * least),
        "Spheres are never as drawn: this is the share of pieces that do what is asked.",
    ))
}

/// The plan's own, with another step or window.
fn given(plan: &Plan, step: f64, window: f64) -> Overrides {
    Overrides {
        integrator: Some(plan.integrator),
        step: Some(step),
        window: Some(window),
        first_seed: Some(plan.first_seed),
    }
}
