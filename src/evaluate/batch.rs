//! Many layouts of one design at once: as many in the lanes of a core as these hold, and groups of these in parallel.

use std::sync::atomic::AtomicBool;

use rayon::prelude::*;

use super::{Overrides, Plan, PlanError, impact};
use crate::dem::{BatchError, Impact, Stop, simulate_batch};
use crate::design::Design;
use crate::layout::Layout;
use crate::material::Material;
use crate::real::Width;
use crate::score::{means, ratio};

/// Scores of one layout, as a search needs them.
#[derive(Clone, Debug, PartialEq)]
pub struct Marks {
    /// F (J)
    pub focal_mean: f64,
    /// P (J)
    pub protected_mean: f64,
    /// C = F/P
    pub contrast: Option<f64>,
    /// G = F/F(all host)
    pub focal_gain: Option<f64>,
    /// Q = P/P(all lens material)
    pub protection: Option<f64>,
    /// Why the run ended early, if it did; its numbers are then not to be trusted.
    pub stop: Option<Stop>,
}

/// A design that cannot be evaluated in batches.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum EvaluatorError {
    /// A step or window with which nothing can be simulated.
    #[error(transparent)]
    Plan(#[from] PlanError),
    /// Layouts that do not go together, or spheres that overlap at rest.
    #[error(transparent)]
    Batch(#[from] BatchError),
    /// A guard stopped a uniform crystal, to which all others are compared.
    #[error("the crystal of {material} alone, to which layouts are compared, cannot be simulated: {stop}")]
    Baseline {
        /// Its material.
        material: String,
        /// Why.
        stop: Stop,
    },
    /// The request to stop came before anything was evaluated.
    #[error("interrupted before anything was evaluated")]
    Interrupted,
}

/// Turns layouts of one design into scores, relative to the crystal of host and that of lens material alone.
pub struct Evaluator<'a> {
    design: &'a Design,
    plan: Plan,
    impact: Impact,
    palette: Vec<Material>,
    width: Width,
    /// F of the crystal of host alone, P of that of lens material alone (J).
    uniform: [f64; 2],
}

impl<'a> Evaluator<'a> {
    /// Chooses step and window, and simulates the two uniform crystals. `palette` holds host, lens material, and others.
    ///
    /// # Errors
    /// See [`EvaluatorError`].
    pub fn new(
        design: &'a Design,
        palette: Vec<Material>,
        overrides: Overrides,
        interrupt: &AtomicBool,
    ) -> Result<Self, EvaluatorError> {
        let plan = Plan::new(design, overrides, &palette)?;
        let impact = impact(design, &plan);
        let mut evaluator = Self { design, plan, impact, palette, width: Width::widest(), uniform: [0.0; 2] };
        let lens = usize::from(evaluator.palette.len() > 1);
        let uniform = [0, lens].map(|material| vec![material as u8; design.lattice.len()]);
        let marks = evaluator.marks(&uniform, interrupt)?;
        for (marks, k) in marks.iter().zip([0, lens]) {
            match &marks.stop {
                Some(Stop::Interrupted { .. }) => return Err(EvaluatorError::Interrupted),
                Some(stop) => {
                    let (material, stop) = (evaluator.palette[k].name.clone(), stop.clone());
                    return Err(EvaluatorError::Baseline { material, stop });
                }
                None => {}
            }
        }
        evaluator.uniform = [marks[0].focal_mean, marks[1].protected_mean];
        Ok(evaluator)
    }

    /// Step and window.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// Scores of layouts, each an index into the palette for every site of the lattice. The bits of a layout's scores depend
    /// neither on the number of threads nor on the layouts beside it.
    ///
    /// # Errors
    /// More kinds of contacts than fit into a table; see [`BatchError`].
    pub fn marks(&self, layouts: &[Vec<u8>], interrupt: &AtomicBool) -> Result<Vec<Marks>, BatchError> {
        let lattice = self.design.lattice;
        let group = |layouts: &[Vec<u8>]| {
            let sample = |materials: &Vec<u8>| {
                Layout { lattice, palette: self.palette.clone(), materials: materials.clone() }.sample()
            };
            let samples: Vec<_> = layouts.iter().map(sample).collect();
            simulate_batch(&samples, &self.impact, self.width, interrupt)
        };
        let groups: Vec<_> = layouts.par_chunks(self.width.lanes()).map(group).collect::<Result<_, BatchError>>()?;
        let marks = |brief: crate::dem::Brief| {
            let [focal_mean, protected_mean] = means(&brief.max_kinetic, &lattice, &self.design.target);
            Marks {
                focal_mean,
                protected_mean,
                contrast: ratio(focal_mean, protected_mean),
                focal_gain: ratio(focal_mean, self.uniform[0]),
                protection: ratio(protected_mean, self.uniform[1]),
                stop: brief.stop,
            }
        };
        Ok(groups.into_iter().flatten().map(marks).collect())
    }
}
