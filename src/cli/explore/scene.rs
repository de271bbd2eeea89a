//! A layout under the design's impact: energies, scores, verdict.

use std::time::Instant;

use granulens::design::{Accuracy, Design};
use granulens::evaluate::{Comparison, EvaluatorError, Forces, Overrides, compare, glimpse};
use granulens::report;
use serde::Deserialize;
use serde_json::{Value, json};

use super::desk::{laid, read};
use super::server::Shared;
use crate::cli::failure::Failure;
use crate::cli::propose;

/// How exact the numbers are to be.
#[derive(Clone, Copy, Deserialize, PartialEq, Eq)]
#[serde(rename_all = "kebab-case")]
pub enum Detail {
    /// At the step for 1 %, energies only: while something moves.
    Coarse,
    /// At the design's own step, energies only, over its own force.
    Fine,
    /// All that `granulens compare` says, over its forces.
    Whole,
}

/// A painted layout: names of materials, and for each site a place among these.
#[derive(Deserialize)]
pub struct Painted {
    pub palette: Vec<String>,
    pub materials: Vec<u8>,
}

#[derive(Deserialize)]
pub struct Asked {
    text: String,
    /// In place of the proposed lens.
    #[serde(default)]
    layout: Option<Painted>,
    detail: Detail,
    tab: String,
}

#[derive(Deserialize)]
pub struct Tab {
    tab: String,
}

/// Asks the tab's simulation to stop.
pub fn cancel(asked: &Tab, shared: &Shared) -> Result<Value, Failure> {
    shared.work.cancel(&asked.tab, "scene");
    Ok(json!({ "cancelled": true }))
}

/// The comparison that the page asks for: of a painted layout, or of the proposed lens.
pub fn comparison<'a>(design: &'a Design, layout: Option<&Painted>) -> Result<Comparison<'a>, Failure> {
    let overrides = Overrides::default();
    match layout {
        Some(painted) => Comparison::of_layout(
            design,
            "layout".to_owned(),
            &laid(design, &painted.palette, &painted.materials)?,
            overrides,
        ),
        None => Comparison::of_lens(design, &propose(design)?, overrides),
    }
    .map_err(|error| Failure::of_plan(design, &overrides, &error))
}

/// Simulates; a newer request of the same tab takes its place.
pub fn simulate(asked: Asked, shared: &Shared) -> Result<Value, Failure> {
    let begun = Instant::now();
    let job = shared.work.begin(&asked.tab, "scene");
    let mut design = read(&asked.text, shared)?;
    if asked.detail == Detail::Coarse {
        (design.accuracy, design.step) = (Accuracy::OnePercent, None);
    }
    let comparison = comparison(&design, asked.layout.as_ref())?;
    let outcome = match asked.detail {
        Detail::Coarse | Detail::Fine => glimpse(&comparison, job.context()),
        Detail::Whole => compare(&comparison.over(Forces::USUAL), job.context()),
    };
    let outcome = match outcome {
        Ok(outcome) if !stopped(&job) => outcome,
        Ok(_) | Err(EvaluatorError::Interrupted) => return Ok(json!({ "cancelled": true })),
        Err(error) => return Err(error.into()),
    };
    let subject = &outcome.arrangements[0];
    Ok(json!({
        "numbers": report::numbers(&outcome),
        "palette": outcome.materials,
        "materials": subject.layout,
        "felt": subject.record,
        "others": outcome.arrangements[1..].iter().map(|other| json!({
            "name": other.name, "kind": other.kind, "materials": other.layout, "max_kinetic": other.record.max_kinetic,
        })).collect::<Vec<_>>(),
        "words": report::table(&outcome),
        "step": outcome.manifest.method.words(),
        "ms": begun.elapsed().as_secs_f64() * 1e3,
    }))
}

fn stopped(job: &super::work::Job) -> bool {
    job.context().stopped()
}
