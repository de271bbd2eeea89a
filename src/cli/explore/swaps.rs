//! What exchanging single spheres does to C, for who paints.

use granulens::design::Accuracy;
use granulens::evaluate::{EvaluatorError, Overrides, Plan, swaps};
use serde::Deserialize;
use serde_json::{Value, json};

use super::desk::{laid, read};
use super::scene::Painted;
use super::server::Shared;
use crate::cli::failure::Failure;
use crate::cli::propose;

#[derive(Deserialize)]
pub struct Asked {
    text: String,
    /// In place of the proposed lens.
    #[serde(default)]
    layout: Option<Painted>,
    tab: String,
}

/// Simulates them at the step for 1 %; a newer request of the same tab takes its place.
pub fn map(asked: &Asked, shared: &Shared) -> Result<Value, Failure> {
    let job = shared.work.begin(&asked.tab, "swaps");
    let mut design = read(&asked.text, shared)?;
    (design.accuracy, design.step) = (Accuracy::OnePercent, None);
    let layout = match &asked.layout {
        Some(painted) => laid(&design, &painted.palette, &painted.materials)?,
        None => propose(&design)?.layout(),
    };
    let overrides = Overrides::default();
    let plan = Plan::new(&design, overrides, &layout.palette)
        .map_err(|error| Failure::of_plan(&design, &overrides, &error))?;
    match swaps(&design, &layout, &plan, job.context()) {
        Err(EvaluatorError::Interrupted) => Ok(json!({ "cancelled": true })),
        _ if job.context().stopped() => Ok(json!({ "cancelled": true })),
        found => Ok(json!(found?)),
    }
}
