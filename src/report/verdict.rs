//! The verdict in words: what the first arrangement beats, what it equals, what beats it.

use super::digits::significant;
use crate::outcome::{Outcome, Verdict, Word};
use crate::score::Measure;
use crate::units::Dimension;

/// Over which forces it is judged.
pub fn over<S, R, P>(outcome: &Outcome<S, R, P>) -> String {
    match &outcome.forces[..] {
        [] => "none: interrupted, or nothing to compare with".to_owned(),
        [_] => "one force, which does not say how much scores scatter; within 4 % nothing is decided".to_owned(),
        [first, .., last] => format!(
            "{} forces from {} to {}; equal is what lies within two standard deviations of the difference",
            outcome.forces.len(),
            Dimension::Force.show(*first),
            Dimension::Force.show(*last)
        ),
    }
}

/// A line for each measure: `C 2.23: better than flat-height (1.00, ±0.02), ...`.
pub fn lines<S, R, P>(outcome: &Outcome<S, R, P>) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    let mut before = "";
    for verdict in &outcome.verdict {
        if verdict.measure != before {
            lines.push(format!("{} {}: ", symbol(verdict), significant(verdict.value, 3)));
        } else if let Some(line) = lines.last_mut() {
            line.push_str(", ");
        }
        before = &verdict.measure;
        if let Some(line) = lines.last_mut() {
            line.push_str(&against(verdict));
        }
    }
    lines
}

/// Symbol of a verdict's measure.
pub fn symbol(verdict: &Verdict) -> &str {
    Measure::find(&verdict.measure).map_or(verdict.measure.as_str(), |measure| measure.symbol())
}

fn against(verdict: &Verdict) -> String {
    let word = match verdict.word {
        Word::Better => "better than",
        Word::Equal => "equal to",
        Word::Worse => "worse than",
        Word::Undecided => "undecided against",
    };
    let spread = verdict.spread.map_or(String::new(), |spread| format!(" ±{}", significant(spread, 2)));
    format!("{word} {} ({}{spread})", verdict.arrangement, significant(verdict.best, 3))
}
