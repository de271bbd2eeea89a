//! Which material is good: the ranking of `granulens design --rank`.

use granulens::evaluate::{EvaluatorError, rank};
use granulens::lens::Family;
use serde::Deserialize;
use serde_json::{Value, json};

use super::desk::read;
use super::server::Shared;
use crate::cli::design::all_materials;
use crate::cli::failure::Failure;

#[derive(Deserialize)]
pub struct Asked {
    text: String,
    /// How many of the best by rays are simulated.
    simulate: usize,
    tab: String,
}

/// Ranks; a newer request of the same tab takes its place.
pub fn ranking(asked: &Asked, shared: &Shared) -> Result<Value, Failure> {
    let job = shared.work.begin(&asked.tab, "rank");
    let design = read(&asked.text, shared)?;
    match rank(&design, &all_materials(&design), &Family::ALL, asked.simulate.min(200), job.context()) {
        Err(EvaluatorError::Interrupted) => Ok(json!({ "cancelled": true })),
        ranked => Ok(json!({ "ranking": ranked?, "host": design.host.name })),
    }
}
