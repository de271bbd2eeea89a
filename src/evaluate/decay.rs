//! How the design's wave decays in the uniform crystals of its materials.

use std::sync::atomic::AtomicBool;

use super::{EvaluateError, Plan, evaluate};
use crate::dem::Record;
use crate::design::Design;
use crate::layout::Layout;
use crate::material::Material;
use crate::wave::{Decay, Dimension, RowPassage, bound};

/// Simulates the uniform crystal of each material of a palette under the design's impact and fits its decay; none for one whose
/// wave says nothing of it, see [`Decay::fit`].
///
/// # Errors
/// See [`EvaluateError`].
pub fn calibrate(
    design: &Design,
    plan: &Plan,
    palette: &[Material],
    interrupt: &AtomicBool,
) -> Result<Vec<Option<Decay>>, EvaluateError> {
    palette
        .iter()
        .map(|material| {
            let layout = Layout::new(design.lattice, vec![material.clone()], |_| 0);
            Ok(decay(design, material, &evaluate(design, &layout, plan, interrupt)?.record))
        })
        .collect()
}

/// The decay that the record of a uniform crystal shows, from the means of its rows.
pub fn decay(design: &Design, material: &Material, record: &Record<2>) -> Option<Decay> {
    let lattice = &design.lattice;
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
    let bound = bound(Dimension::Two, [material, material], lattice.diameter(), design.constants).speed;
    Decay::fit(bound, &rows)
}
