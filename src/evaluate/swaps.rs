//! What exchanging single spheres does: where a layout is touchy, and where it could be better.

use serde::{Deserialize, Serialize};

use super::{Evaluated, Evaluator, EvaluatorError, Forces, Overrides, Plan};
use crate::Context;
use crate::design::Design;
use crate::layout::Layout;
use crate::score::geometric;
use crate::stats::Mean;

/// Layouts simulated between two looks at the request to stop.
const BLOCK: usize = 256;

/// Every sphere of a layout exchanged by itself, in both halves alike, as one paints.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Swaps {
    /// C as drawn, under the design's own force.
    pub contrast: f64,
    /// Twice the standard deviation of a change of C under one force, as a part of C: what lies below is chance.
    pub noise: f64,
    /// Site by site the exchange that is best for C, for one of the other materials of the layout's palette.
    pub each: Vec<Swap>,
}

/// One sphere exchanged.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Swap {
    /// For which material.
    pub material: String,
    /// C over that of the layout as drawn, less one; none where a guard stops the run.
    pub change: Option<f64>,
}

/// Exchanges every sphere of a layout for one of each other material of its palette, under the design's own force.
///
/// # Errors
/// See [`EvaluatorError`]; a layout that a guard stops as drawn has no contrast to compare with.
pub fn swaps(design: &Design, layout: &Layout, plan: &Plan, context: &Context) -> Result<Swaps, EvaluatorError> {
    let given = Overrides {
        integrator: Some(plan.integrator),
        step: Some(plan.step),
        window: Some(plan.window),
        first_seed: None,
    };
    let loads = Forces::USUAL.with_own(design.impact.into());
    let contrast = |run: &Evaluated| run.scores.contrast.filter(|_| run.stop.is_none());
    let drawn = Evaluator::new(design, &loads, layout.palette.clone(), given, context)?
        .scores(std::slice::from_ref(&layout.materials), context)?;
    let drawn: Vec<f64> = drawn[0].iter().filter_map(contrast).collect();
    let [at, over @ ..] = &drawn[..] else { return Err(EvaluatorError::Interrupted) };
    let deviation = Mean::of(over).deviation.unwrap_or(0.0);
    let noise = if over.is_empty() { 0.0 } else { 2.0 * 2.0_f64.sqrt() * deviation / geometric(over) };

    let evaluator = Evaluator::new(design, &loads[..1], layout.palette.clone(), given, context)?;
    let others = layout.palette.len().saturating_sub(1);
    let exchanged: Vec<Vec<u8>> = (0..layout.materials.len())
        .flat_map(|site| {
            (0..layout.palette.len() as u8).filter(move |&other| other != layout.materials[site]).map(move |other| {
                let mut materials = layout.materials.clone();
                materials[site] = other;
                materials
            })
        })
        .collect();
    let mut found: Vec<Option<f64>> = Vec::with_capacity(exchanged.len());
    for block in exchanged.chunks(BLOCK) {
        if context.stopped() {
            return Err(EvaluatorError::Interrupted);
        }
        found.extend(evaluator.scores(block, context)?.iter().map(|runs| runs.first().and_then(contrast)));
    }
    let each = (0..layout.materials.len()).map(|site| {
        let here = (0..others).map(|k| {
            let material = exchanged[site * others + k][site];
            let change = found[site * others + k].map(|contrast| contrast / at - 1.0);
            Swap { material: layout.palette[usize::from(material)].name.clone(), change }
        });
        let rank = |swap: &Swap| swap.change.unwrap_or(f64::NEG_INFINITY);
        here.max_by(|a, b| rank(a).total_cmp(&rank(b)))
    });
    Ok(Swaps { contrast: *at, noise, each: each.flatten().collect() })
}
