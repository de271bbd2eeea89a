//! One layout under several contact laws: what of its scores is the layout's, and what the law's.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::{
    Drawing, Evaluation, EvaluatorError, Forces, Overrides, Plan, PlanError, beside_in_space, beside_uniform,
    evaluate_in_space,
};
use crate::Context;
use crate::contact::LawKind;
use crate::dem::Stop;
use crate::design::{Design, DesignRef, SpaceDesign};
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
pub fn design_laws<'a>(design: impl Into<DesignRef<'a>>) -> Vec<LawKind> {
    let own = design.into().law();
    let mut laws =
        vec![LawKind::Consistent, LawKind::ConsistentStatic, LawKind::Mdr, LawKind::MdrStatic, LawKind::Thornton];
    if !laws.contains(&own) {
        laws.insert(0, own);
    }
    laws
}

/// Simulates a layout, or a piece of two halves, beside its host alone and the design's lens material alone under each law, as `check` does. Each law has the step that its
/// stiffest contact asks for.
///
/// # Errors
/// See [`OverLawsError`]. A run that a guard stops is none: it is told, and its scores are left out.
pub fn over_laws<'a>(
    drawing: impl Into<Drawing<'a>>,
    laws: &[LawKind],
    overrides: Overrides,
    context: &Context,
) -> Result<OverLaws, OverLawsError> {
    let drawing = drawing.into();
    // Laws side by side, since a law's own runs are few.
    let each = match drawing {
        Drawing::Plane(design, subject) => {
            let run = |design: &Design, plan: &Plan| {
                let beside = beside_uniform(design, subject, plan, Forces::ONE, context)?;
                Ok((beside.evaluation.scores, beside.evaluation.record.stop, beside.stopped))
            };
            under_each(design, |design| Drawing::Plane(design, subject).plan(overrides), run, laws)?
        }
        Drawing::Space(design, layout) => {
            let run = |design: &SpaceDesign, plan: &Plan| {
                let Evaluation { mut scores, record, .. } = evaluate_in_space(design, layout, plan, context)?;
                let beside = beside_in_space(design, layout, plan, Forces::ONE, context)?;
                scores.relate(beside.uniform[0], beside.uniform[1]);
                Ok((scores, record.stop, beside.stopped))
            };
            under_each(design, |design| Drawing::Space(design, layout).plan(overrides), run, laws)?
        }
    };
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

/// Scores of a layout, why its run ended early, and which uniform crystals' did.
type Ran = (Scores, Option<Stop>, Vec<(String, Stop)>);

/// A design's layout under each law, each with the plan that it asks for.
fn under_each<L: Clone + Sync, R: Clone + Sync>(
    design: &Design<L, R>,
    plan: impl Fn(&Design<L, R>) -> Result<Plan, PlanError>,
    run: impl Fn(&Design<L, R>, &Plan) -> Result<Ran, EvaluatorError> + Sync,
    laws: &[LawKind],
) -> Result<Vec<LawScores>, OverLawsError>
where
    Design<L, R>: Send,
{
    let of = |&law: &LawKind| {
        let design = Design { law, ..design.clone() };
        let plan = plan(&design).map_err(|error| OverLawsError::Plan { law, error })?;
        Ok((design, plan))
    };
    let planned = laws.iter().map(of).collect::<Result<Vec<_>, OverLawsError>>()?;
    let each = planned.par_iter().map(|(design, plan)| {
        let (mut scores, stop, stopped) = run(design, plan)?;
        if stop.is_some() {
            for ratio in [Measure::Contrast, Measure::FocalGain, Measure::Protection] {
                scores.set(ratio, None);
            }
        }
        let stop = stop.or_else(|| stopped.into_iter().next().map(|(_, stop)| stop));
        Ok(LawScores { law: design.law, scores, step_s: plan.step, stop: stop.map(|stop| stop.to_string()) })
    });
    Ok(each.collect::<Result<Vec<_>, EvaluatorError>>()?)
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
