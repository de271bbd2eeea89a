//! Maps that take seconds: what exchanging single spheres does to C, and how scores change with what each is made of.

use granulens::dem::{GradientError, Stop};
use granulens::design::{Accuracy, Design};
use granulens::evaluate::{EvaluatorError, Overrides, Plan, SensitivityError, sensitivities, swaps};
use granulens::layout::Layout;
use granulens::score::Measure;
use serde::Deserialize;
use serde_json::{Value, json};

use super::desk::{laid, read};
use super::scene::Painted;
use super::server::Shared;
use crate::cli::failure::Failure;
use crate::cli::{propose, sensitivity};

#[derive(Deserialize)]
pub struct Asked {
    text: String,
    /// In place of the proposed lens.
    #[serde(default)]
    layout: Option<Painted>,
    tab: String,
}

/// What is to be simulated, at the step for 1 %.
fn coarse(asked: &Asked, shared: &Shared) -> Result<(Design, Layout, Plan), Failure> {
    let mut design = read(&asked.text, shared)?;
    (design.accuracy, design.step) = (Accuracy::OnePercent, None);
    let layout = match &asked.layout {
        Some(painted) => laid(&design, &painted.palette, &painted.materials)?,
        None => propose(&design)?.layout(),
    };
    let overrides = Overrides::default();
    let plan = Plan::new(&design, overrides, &layout.palette)
        .map_err(|error| Failure::of_plan(&design, &overrides, &error))?;
    Ok((design, layout, plan))
}

/// Exchanges every sphere; a newer request of the same tab takes its place.
pub fn exchanged(asked: &Asked, shared: &Shared) -> Result<Value, Failure> {
    let job = shared.work.begin(&asked.tab, "swaps");
    let (design, layout, plan) = coarse(asked, shared)?;
    match swaps(&design, &layout, &plan, job.context()) {
        Err(EvaluatorError::Interrupted) => Ok(json!({ "cancelled": true })),
        _ if job.context().stopped() => Ok(json!({ "cancelled": true })),
        found => Ok(json!(found?)),
    }
}

/// Derivatives of F and P by every sphere, with their secants, as `granulens sensitivity` has them at this step; a newer request of the same tab
/// takes its place.
pub fn derivatives(asked: &Asked, shared: &Shared) -> Result<Value, Failure> {
    let job = shared.work.begin(&asked.tab, "sensitivity");
    let (design, layout, plan) = coarse(asked, shared)?;
    let of = [Measure::FocalMean, Measure::ProtectedMean];
    match sensitivities(&design, &layout, &plan, &of, job.context()) {
        Err(
            SensitivityError::Stopped(Stop::Interrupted { .. })
            | SensitivityError::Gradient(GradientError::Stopped(Stop::Interrupted { .. })),
        ) => Ok(json!({ "cancelled": true })),
        _ if job.context().stopped() => Ok(json!({ "cancelled": true })),
        Ok(found) => Ok(json!({ "sensitivities": found.of })),
        Err(error) => Err(sensitivity::failure(&error)),
    }
}
