//! One layout under several contact laws: what of its scores is the layout's, and what the law's.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::{EvaluatorError, Forces, Overrides, Plan, PlanError, Subject, beside_uniform};
use crate::Context;
use crate::contact::LawKind;
use crate::design::Design;
use crate::score::{Measure, Scores};

/// The scores of a layout under one law.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LawScores {
    /// The law.
    pub law: LawKind,
    /// The scores; of a run that ended early without ratios.
    #[serde(flatten)]
    pub scores: Scores,
    /// The step (s), chosen for the law.
    pub step_s: f64,
    /// Why one of its runs ended early, if so; the numbers that need it are left out.
    pub stop: Option<String>,
}

/// The scores of a layout under several laws, and how far apart they lie.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct OverLaws {
    /// Law by law.
    pub each: Vec<LawScores>,
    /// Least and greatest.
    pub range: Ranges,
}

/// Least and greatest of each score; none where no law gives one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ranges {
    /// C
    pub contrast: Option<[f64; 2]>,
    /// G
    pub focal_gain: Option<[f64; 2]>,
    /// Q
    pub protection: Option<[f64; 2]>,
}

/// Why a layout has no scores over laws.
#[derive(Debug, thiserror::Error)]
pub enum OverLawsError {
    /// Step or window do not do for one of the laws.
    #[error("under the law {law}: {error}")]
    Plan {
        /// The law.
        law: LawKind,
        /// What is wrong.
        error: PlanError,
    },
    /// It cannot be simulated.
    #[error(transparent)]
    Evaluate(#[from] EvaluatorError),
}

/// The laws by whose range a design is judged: those that yield and create no energy, with rate and without, and the one that the
/// design names.
pub fn design_laws(design: &Design) -> Vec<LawKind> {
    let mut laws =
        vec![LawKind::Consistent, LawKind::ConsistentStatic, LawKind::Mdr, LawKind::MdrStatic, LawKind::Thornton];
    if !laws.contains(&design.law) {
        laws.insert(0, design.law);
    }
    laws
}

/// Simulates a layout, or a piece of two halves, beside its host alone and the design's lens material alone under each law, as `check` does. Each law has the step that its
/// stiffest contact asks for.
///
/// # Errors
/// See [`OverLawsError`]. A run that a guard stops is none: it is told, and its scores are left out.
pub fn over_laws<'a>(
    design: &Design,
    subject: impl Into<Subject<'a>>,
    laws: &[LawKind],
    overrides: Overrides,
    context: &Context,
) -> Result<OverLaws, OverLawsError> {
    let subject: Subject<'_> = subject.into();
    let designs: Vec<Design> = laws.iter().map(|&law| Design { law, ..design.clone() }).collect();
    let plans = designs
        .iter()
        .map(|design| {
            Plan::new(design, overrides, &subject.layout.palette)
                .map_err(|error| OverLawsError::Plan { law: design.law, error })
        })
        .collect::<Result<Vec<_>, _>>()?;
    // Laws side by side, since a law's own runs are few.
    let each = designs
        .par_iter()
        .zip(&plans)
        .map(|(design, plan)| {
            let beside = beside_uniform(design, subject, plan, Forces::ONE, context)?;
            let (mut scores, stop) = (beside.evaluation.scores, beside.evaluation.record.stop);
            if stop.is_some() {
                for ratio in [Measure::Contrast, Measure::FocalGain, Measure::Protection] {
                    scores.set(ratio, None);
                }
            }
            let stop = stop.or_else(|| beside.stopped.into_iter().next().map(|(_, stop)| stop));
            Ok(LawScores { law: design.law, scores, step_s: plan.step, stop: stop.map(|stop| stop.to_string()) })
        })
        .collect::<Result<Vec<_>, EvaluatorError>>()?;
    let range = |of: fn(&LawScores) -> Option<f64>| {
        let values = || each.iter().filter_map(of);
        Some([values().reduce(f64::min)?, values().reduce(f64::max)?])
    };
    let range = Ranges {
        contrast: range(|law| law.scores.contrast),
        focal_gain: range(|law| law.scores.focal_gain),
        protection: range(|law| law.scores.protection),
    };
    Ok(OverLaws { each, range })
}

impl OverLaws {
    /// As a table in words.
    pub fn table(&self) -> String {
        let number = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), |value| format!("{value:.3}"));
        let mut text = format!("{:<18}{:>8}{:>8}{:>8}\n", "under the law", "C", "G", "Q");
        for law in &self.each {
            text += &format!(
                "{:<18}{:>8}{:>8}{:>8}{}\n",
                law.law.name(),
                number(law.scores.contrast),
                number(law.scores.focal_gain),
                number(law.scores.protection),
                law.stop.as_ref().map_or_else(String::new, |stop| format!("  ({stop})")),
            );
        }
        for (words, end) in [("least", 0), ("greatest", 1)] {
            let of = |range: Option<[f64; 2]>| number(range.map(|range| range[end]));
            let Ranges { contrast, focal_gain, protection } = &self.range;
            text += &format!("{words:<18}{:>8}{:>8}{:>8}\n", of(*contrast), of(*focal_gain), of(*protection));
        }
        text
    }
}
