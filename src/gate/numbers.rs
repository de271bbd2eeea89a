//! Whether the scores are what they are, or what step and window make them.

use super::{GateError, Line, Look, Word, given};
use crate::dem::Stop;
use crate::evaluate::{Evaluator, EvaluatorError, Forces, LoadCase};
use crate::score::{Measure, geometric};
use crate::stats::Mean;

/// By how much scores over eight forces may move: twice what the scores of one force scatter by, for the finer class of accuracy.
const MOVES: f64 = 0.02;
/// For the coarser.
const MOVES_COARSE: f64 = 0.05;

pub(super) fn lines(look: &Look) -> Result<Vec<Line>, GateError> {
    let (step, window) = (look.plan.step, look.plan.window);
    let as_it_is = scores(look, step, window)?;
    let finer = scores(look, 0.5 * step, window)?;
    let longer = scores(look, step, 2.0 * window)?;
    let why = [
        "A score that follows the step is the program's, not the layout's.",
        "What comes later may undo what the window shows.",
    ];
    Ok(vec![
        line(look, "half the step", (&as_it_is, &finer), why[0]),
        line(look, "twice the window", (&as_it_is, &longer), why[1]),
    ])
}

/// C, G and Q under each force; none where a guard stopped a run.
type Runs = Vec<(Measure, Vec<f64>)>;

fn scores(look: &Look, step: f64, window: f64) -> Result<Option<Runs>, GateError> {
    let design = look.drawing.design();
    let own = design.impact();
    let strengths = Forces::USUAL.about(own.strength()).into_iter();
    let cases = strengths.map(|strength| look.case(own.with_strength(strength)));
    let cases: Vec<LoadCase> = cases.collect();
    let palette = look.drawing.palette().to_vec();
    let evaluator = match Evaluator::new(design, &cases, palette, given(look.plan, step, window), look.context) {
        // Where the host alone gives way nothing can be said; the check has told it.
        Err(EvaluatorError::Baseline { .. }) => return Ok(None),
        evaluator => evaluator?,
    };
    let runs = evaluator.scores(&[look.drawing.materials()], look.context)?.concat();
    if runs.iter().any(|run| matches!(run.stop, Some(Stop::Interrupted { .. }))) {
        return Err(EvaluatorError::Interrupted.into());
    }
    if runs.iter().any(|run| run.stop.is_some()) {
        return Ok(None);
    }
    let of = |measure: Measure| {
        let values: Option<Vec<f64>> = runs.iter().map(|run| run.scores.get(measure)).collect();
        Some((measure, values?))
    };
    Ok(Some([Measure::Contrast, Measure::FocalGain, Measure::Protection].into_iter().filter_map(of).collect()))
}

fn line(look: &Look, check: &str, (before, after): (&Option<Runs>, &Option<Runs>), why: &str) -> Line {
    let most = if look.drawing.design().accuracy().fraction() > 5e-3 { MOVES_COARSE } else { MOVES };
    let (Some(before), Some(after)) = (before, after) else {
        return Line::new(check, Word::Fail, "a guard stops the run", format!("{} %", 100.0 * most), why);
    };
    let mut parts = Vec::new();
    let mut word = Word::Pass;
    for ((measure, one), (_, two)) in before.iter().zip(after) {
        let moved = geometric(two) / geometric(one) - 1.0;
        // Forces are the same, so their chance is half of it out already; what is left of it is no fault of the step.
        let differences: Vec<f64> = one.iter().zip(two).map(|(a, b)| b / a - 1.0).collect();
        let chance = Mean::of(&differences).interval.unwrap_or(0.0);
        if moved.abs() > most && moved.abs() > chance {
            word = Word::Fail;
        }
        parts.push(format!("{} {:+.2} %", measure.symbol(), 100.0 * moved));
    }
    Line::new(check, word, parts.join(", "), format!("{} % of each, over 8 forces within 1 %", 100.0 * most), why)
}
