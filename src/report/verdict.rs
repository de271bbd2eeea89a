//! The verdict in words: what the first arrangement beats, what it equals, what beats it.

use super::digits::significant;
use crate::outcome::{Outcome, Verdict, Word};
use crate::score::Measure;
use crate::units::Dimension;

/// Over which forces it is judged.
pub fn over<S, R, P>(outcome: &Outcome<S, R, P>) -> String {
    match strengths(&outcome.forces, &outcome.speeds) {
        None => "none: interrupted, or nothing to compare with".to_owned(),
        Some((1, what)) => format!("{what}, which does not say how much scores scatter; within 4 % nothing is decided"),
        Some((_, what)) => format!("{what}; equal is what lies within two standard deviations of the difference"),
    }
}

/// How many forces or, where a projectile strikes, speeds there are, and which: `8 forces from 25.7 kN to 26.3 kN`.
pub fn strengths(forces: &[f64], speeds: &[f64]) -> Option<(usize, String)> {
    let (strengths, word, dimension) =
        if speeds.is_empty() { (forces, "force", Dimension::Force) } else { (speeds, "speed", Dimension::Speed) };
    let what = match strengths {
        [] => return None,
        [_] => format!("one {word}"),
        [first, .., last] => {
            format!("{} {word}s from {} to {}", strengths.len(), dimension.show(*first), dimension.show(*last))
        }
    };
    Some((strengths.len(), what))
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
