//! One design to one outcome: proposes the lens, lays its baselines, simulates all of them alike, and scores them.
//!
//! - `plan`: step and window, chosen once for all arrangements
//! - `compare`: the lens and its baselines, in parallel

mod compare;
mod plan;

pub use compare::{Comparison, Progress, compare, laid, proposal};
pub use plan::{Overrides, Plan, PlanError};

use std::sync::atomic::AtomicBool;

use crate::contact::Pair;
use crate::dem::{Impact, Mirror, OVERLAP_WARNING, OverlapAtRest, Record, simulate};
use crate::design::Design;
use crate::layout::Layout;
use crate::score::Scores;
use crate::units::Dimension::{Length, Time};
use crate::wave::{self, Dimension, Validity};

/// One arrangement, simulated and scored.
#[derive(Clone, Debug)]
pub struct Evaluation {
    /// The numbers; ratios to baselines are not there yet.
    pub scores: Scores,
    /// What each sphere and contact felt.
    pub record: Record<2>,
    /// What a reader should know before trusting the numbers.
    pub warnings: Vec<String>,
}

/// Simulates and scores one arrangement of a design.
///
/// # Errors
/// Spheres that overlap at rest; no layout on a lattice has such.
pub fn evaluate(
    design: &Design,
    layout: &Layout,
    plan: &Plan,
    interrupt: &AtomicBool,
) -> Result<Evaluation, OverlapAtRest> {
    let record = simulate(&layout.sample(), &impact(design, plan), interrupt)?;
    let scores = Scores::new(&record, &layout.lattice, &design.target);
    let warnings = warnings(&record, layout, design);
    Ok(Evaluation { scores, record, warnings })
}

/// The design's impact: a pulse on row 1, mirrors on both sides, the far end free.
pub fn impact(design: &Design, plan: &Plan) -> Impact {
    let lattice = &design.lattice;
    let sites = lattice.sites();
    let row = |number: u32| (0..sites.len()).filter(|&i| sites[i].row == number).collect();
    Impact {
        mirrors: vec![
            Mirror { axis: 0, position: 0.0, inward: 1.0 },
            Mirror { axis: 0, position: lattice.half_width(), inward: -1.0 },
        ],
        law: design.law,
        constants: design.constants,
        pulse: design.impact,
        struck: row(1),
        moving: Vec::new(),
        exit: row(lattice.rows()),
        integrator: plan.integrator,
        step: plan.step,
        window: plan.window,
    }
}

/// How strong the impact is for each material: contact force over F_p, and what that means for the wave-speed bound.
pub fn validity(design: &Design, material: &crate::material::Material) -> Validity {
    let bound = wave::bound(Dimension::Two, [material, material], design.lattice.diameter(), design.constants);
    Validity::new(design.impact.force, &bound)
}

fn warnings(record: &Record<2>, layout: &Layout, design: &Design) -> Vec<String> {
    let mut warnings = Vec::new();
    let diameter = layout.lattice.diameter();
    if let Some(([a, b], time)) = record.missed_contact {
        warnings.push(format!(
            "spheres {} and {}, which do not touch at rest, may have met after {}; their contact is not simulated",
            a + 1,
            b + 1,
            Time.show(time)
        ));
    }
    let deepest = record.contacts.iter().max_by(|a, b| a.overlap_max.total_cmp(&b.overlap_max));
    if let Some(contact) = deepest.filter(|contact| contact.overlap_max > OVERLAP_WARNING * diameter) {
        warnings.push(format!(
            "overlaps reach {} ({:.1} % of the diameter), where contacts 60 degrees apart grow into each other",
            Length.show(contact.overlap_max),
            100.0 * contact.overlap_max / diameter
        ));
    }
    // The fits behind the plastic laws were made up to about twice δ_p (Burgoyne 2016, section 2.1.1).
    let depth = |contact: &crate::dem::ContactRecord| {
        let materials = contact.spheres.map(|i| &layout.palette[usize::from(layout.materials[i])]);
        let pair = Pair::new(materials, [0.5 * diameter; 2], design.constants);
        contact.overlap_max / pair.regions(1.0).plastic_overlap
    };
    let deep = record.contacts.iter().map(depth).fold(0.0, f64::max);
    if deep > 2.0 && !matches!(design.law, crate::contact::LawKind::Hertz | crate::contact::LawKind::HertzThesis) {
        warnings
            .push(format!("overlaps reach {deep:.1} delta_p; the law was fitted up to about 2 (Burgoyne 2016, 2.1.1)"));
    }
    warnings
}
