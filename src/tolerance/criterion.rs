//! What is asked of a piece.

use serde::Serialize;

use super::{Tolerances, WorkshopError};
use crate::Context;
use crate::design::Threshold;
use crate::evaluate::{Drawing, EvaluatorError, Overrides};
use crate::score::{Measure, Needs, Scores};

/// What a piece has to do.
#[derive(Clone, Debug, PartialEq)]
pub struct Criterion {
    /// All of these.
    pub thresholds: Vec<Threshold>,
    /// In words: what the yield is of.
    pub words: String,
    /// The baseline that is to be beaten, where nothing else is asked.
    pub baseline: Option<Beaten>,
}

/// The arrangement with the best contrast among those that a lens has to beat.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Beaten {
    /// Its kind.
    pub arrangement: String,
    /// Its contrast.
    pub contrast: f64,
}

/// The best contrast of the flat, uniform and random arrangements of a layout, perfectly built: the verdict's.
///
/// # Errors
/// See [`EvaluatorError`].
pub fn best_baseline(
    drawing: Drawing<'_>,
    overrides: Overrides,
    context: &Context,
) -> Result<Option<Beaten>, EvaluatorError> {
    let verdict = drawing.verdict(overrides, context)?;
    let rivals = verdict.into_iter().filter(|verdict| verdict.measure == Measure::Contrast.name());
    let best = rivals.reduce(|a, b| if b.best > a.best { b } else { a });
    Ok(best.map(|verdict| Beaten { arrangement: verdict.arrangement, contrast: verdict.best }))
}

impl Criterion {
    /// The thresholds of the file of tolerances, or else of the design, or else the best baseline's contrast.
    ///
    /// # Errors
    /// See [`WorkshopError`].
    pub fn new<'a>(
        drawing: impl Into<Drawing<'a>>,
        tolerances: &Tolerances,
        overrides: Overrides,
        context: &Context,
    ) -> Result<Self, WorkshopError> {
        let drawing = drawing.into();
        let asked = tolerances.thresholds.as_deref().unwrap_or(drawing.design().thresholds());
        if !asked.is_empty() {
            let words: Vec<String> = asked.iter().map(in_words).collect();
            return Ok(Self { thresholds: asked.to_vec(), words: words.join(" and "), baseline: None });
        }
        let best = best_baseline(drawing, overrides, context)?;
        let Some(best) = best else {
            return Ok(Self {
                thresholds: Vec::new(),
                words: "nothing: there is no baseline to beat".to_owned(),
                baseline: None,
            });
        };
        // Equal is not better.
        let min = Some(best.contrast.next_up());
        let words = format!("contrast above the best baseline's ({}, {:.4})", best.arrangement, best.contrast);
        Ok(Self {
            thresholds: vec![Threshold { measure: Measure::Contrast, min, max: None }],
            words,
            baseline: Some(best),
        })
    }

    /// The measures that it asks of a run; of the layout itself is asked apart.
    pub fn measures(&self) -> Vec<Measure> {
        self.thresholds.iter().map(|threshold| threshold.measure).collect()
    }

    /// Whether a piece that ran to its end does what is asked; what the layout says by itself is in `of_layout`.
    pub fn admits(&self, scores: &Scores, of_layout: &Scores) -> bool {
        self.thresholds.iter().all(|threshold| {
            let of = if threshold.measure.needs() == Needs::Layout { of_layout } else { scores };
            of.get(threshold.measure).is_some_and(|value| threshold.admits(value))
        })
    }
}

/// A threshold in words: `contrast at least 2`.
fn in_words(threshold: &Threshold) -> String {
    let show = |value: f64| match threshold.measure.unit().dimension() {
        Some(dimension) => dimension.show(value),
        None => format!("{value}"),
    };
    let bound = |word: &str, limit: Option<f64>| limit.map(|limit| format!("{word} {}", show(limit)));
    let bounds = [bound("at least", threshold.min), bound("at most", threshold.max)];
    format!("{} {}", threshold.measure.name(), bounds.into_iter().flatten().collect::<Vec<_>>().join(" and "))
}
