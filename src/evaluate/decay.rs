//! How an impact's wave decays in the uniform crystals of a palette.

use super::{EvaluateError, Plan, simulated};
use crate::Context;
use crate::contact::Constants;
use crate::dem::Record;
use crate::design::Design;
use crate::lattice::HexagonalSheet;
use crate::layout::Layout;
use crate::material::Material;
use crate::wave::{Decay, Dimension, RowPassage, bound};

/// Half width of the crystals that are simulated (diameters): across a plane wave all spheres move alike, and mirrors make it as
/// wide as one likes.
const HALF_WIDTH: f64 = 1.0;

/// Times that a wave at the bound takes to the last row, for which a crystal is watched: no wave of an impact strong enough for
/// the bound comes below half of it.
const CROSSINGS: f64 = 2.5;

/// Simulates the uniform crystal of each material of a palette under the design's impact, as a narrow strip: a few hundred
/// spheres each, whatever the design's width.
///
/// None for a material of which a guard stops the run, since the impact is too strong for it, or in which the wave does not come
/// to the second row.
///
/// # Errors
/// See [`EvaluateError`].
pub fn calibrate(
    design: &Design,
    plan: &Plan,
    palette: &[Material],
    context: &Context,
) -> Result<Vec<Option<Decay>>, EvaluateError> {
    let lattice = &design.lattice;
    // A narrower crystal of as many rows is one if the design's is.
    let Ok(strip) = lattice.with_half_width(HALF_WIDTH) else { return Ok(Vec::new()) };
    let design = Design { lattice: strip.clone(), ..design.clone() };
    palette
        .iter()
        .map(|material| {
            let layout = Layout::new(strip.clone(), vec![material.clone()], |_| 0);
            let speed = bound(Dimension::Two, [material, material], strip.diameter(), design.constants).speed;
            let window =
                CROSSINGS * strip.depth(f64::from(strip.rows())) / speed + design.impact.duration().unwrap_or(0.0);
            let plan = Plan { window: window.max(plan.window), ..plan.clone() };
            let record = simulated(&design, &layout.sample(), &plan, context)?;
            Ok(if record.stop.is_some() { None } else { decay(&strip, material, design.constants, &record) })
        })
        .collect()
}

/// The decay that the record of a uniform crystal shows, from the means of its rows.
pub fn decay(lattice: &HexagonalSheet, material: &Material, constants: Constants, record: &Record<2>) -> Option<Decay> {
    let passage = |row: u32| {
        let start = lattice.index(row, 1)?;
        let sites = start..start + lattice.columns(row) as usize;
        let count = sites.len() as f64;
        let arrivals: Option<f64> = sites.clone().map(|i| record.arrival[i]).sum();
        let force: f64 = sites.map(|i| record.max_contact_force[i]).sum();
        Some(RowPassage { depth: lattice.depth(f64::from(row)), arrival: arrivals? / count, force: force / count })
    };
    // A window that ends early leaves the last rows out.
    let rows: Vec<RowPassage> = (1..=lattice.rows()).map_while(passage).collect();
    let bound = bound(Dimension::Two, [material, material], lattice.diameter(), constants).speed;
    Decay::measured(bound, &rows)
}
