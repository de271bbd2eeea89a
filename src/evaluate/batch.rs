//! Many layouts of one design at once: as many in the lanes of a core as these hold, and groups of these in parallel.

use std::sync::atomic::AtomicBool;

use rayon::prelude::*;

use super::{Overrides, Plan, PlanError, impact};
use crate::dem::{BatchError, ForcePulse, Impact, Stop, simulate_batch};
use crate::design::Design;
use crate::layout::Layout;
use crate::material::Material;
use crate::real::Width;
use crate::score::{means, ratio};

/// Scores of one layout under one impact, as a search needs them.
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
    /// A guard stopped a uniform crystal, to which others are compared.
    #[error("the crystal of {material} alone, to which layouts are compared, cannot be simulated: {stop}")]
    Baseline {
        /// Its material.
        material: String,
        /// Why.
        stop: Stop,
    },
    /// The design has friction, which batches do not follow.
    #[error("searches simulate without friction, and the design asks for {0}")]
    Friction(f64),
    /// The request to stop came before anything was evaluated.
    #[error("interrupted before anything was evaluated")]
    Interrupted,
}

/// Turns layouts of one design into scores, relative to the crystal of host and that of lens material alone under the same
/// impact.
pub struct Evaluator<'a> {
    design: &'a Design,
    plan: Plan,
    impacts: Vec<Impact>,
    palette: Vec<Material>,
    width: Width,
    /// For each impact F of the crystal of host alone, P of that of lens material alone (J); the latter 0 where there is none.
    uniform: Vec<[f64; 2]>,
    no_protection: Option<EvaluatorError>,
}

/// Step and window that serve all impacts: the shortest step and the longest window that any of them asks for.
///
/// # Errors
/// A step or window with which one of them cannot be simulated.
pub fn common_plan(
    design: &Design,
    pulses: &[ForcePulse],
    overrides: Overrides,
    palette: &[Material],
) -> Result<Plan, PlanError> {
    let mut common: Option<Plan> = None;
    for &pulse in pulses {
        let plan = Plan::new(&Design { impact: pulse, ..design.clone() }, overrides, palette)?;
        let Some(common) = &mut common else {
            common = Some(plan);
            continue;
        };
        if plan.step < common.step {
            (common.step, common.step_reason) = (plan.step, plan.step_reason);
        }
        if plan.window > common.window {
            (common.window, common.window_reason) = (plan.window, plan.window_reason);
        }
        for warning in plan.warnings {
            if !common.warnings.contains(&warning) {
                common.warnings.push(warning);
            }
        }
    }
    common.map_or_else(|| Plan::new(design, overrides, palette), Ok)
}

impl<'a> Evaluator<'a> {
    /// Chooses step and window, and simulates the two uniform crystals under each impact. `palette` holds host, lens material,
    /// and others.
    ///
    /// # Errors
    /// See [`EvaluatorError`].
    pub fn new(
        design: &'a Design,
        pulses: &[ForcePulse],
        palette: Vec<Material>,
        overrides: Overrides,
        interrupt: &AtomicBool,
    ) -> Result<Self, EvaluatorError> {
        if let Some(coefficient) = design.friction {
            return Err(EvaluatorError::Friction(coefficient));
        }
        let plan = common_plan(design, pulses, overrides, &palette)?;
        let struck = |&pulse: &ForcePulse| Impact { pulse, ..impact(design, &plan) };
        let impacts: Vec<Impact> = pulses.iter().map(struck).collect();
        let uniform = vec![[1.0; 2]; impacts.len()];
        let width = Width::widest();
        let mut evaluator = Self { design, plan, impacts, palette, width, uniform, no_protection: None };
        let lens = usize::from(evaluator.palette.len() > 1);
        let layouts = [0, lens].map(|material| vec![material as u8; design.lattice.len()]);
        let marks = evaluator.marks(&layouts, interrupt)?;
        for (marks, k) in marks.iter().zip([0, lens]) {
            let Some(stop) = marks.iter().find_map(|marks| marks.stop.as_ref()) else { continue };
            if matches!(stop, Stop::Interrupted { .. }) {
                return Err(EvaluatorError::Interrupted);
            }
            let (material, stop) = (evaluator.palette[k].name.clone(), stop.clone());
            let error = EvaluatorError::Baseline { material, stop };
            // Without its host a layout cannot be judged; without lens material alone it has no Q.
            if k == 0 {
                return Err(error);
            }
            evaluator.no_protection = Some(error);
        }
        let protected = |marks: &Marks| if marks.stop.is_none() { marks.protected_mean } else { 0.0 };
        evaluator.uniform =
            marks[0].iter().zip(&marks[1]).map(|(host, lens)| [host.focal_mean, protected(lens)]).collect();
        Ok(evaluator)
    }

    /// Why there is no Q under one of the impacts, if so: a guard stopped the crystal of lens material alone, as it does where
    /// that is too soft for the impact on its first row.
    pub fn no_protection(&self) -> Option<&EvaluatorError> {
        self.no_protection.as_ref()
    }

    /// Step and window.
    pub fn plan(&self) -> &Plan {
        &self.plan
    }

    /// Scores of layouts, each an index into the palette for every site of the lattice: for each layout the marks under each
    /// impact. The bits of a layout's scores depend neither on the number of threads nor on the layouts beside it.
    ///
    /// # Errors
    /// More kinds of contacts than fit into a table; see [`BatchError`].
    pub fn marks(&self, layouts: &[Vec<u8>], interrupt: &AtomicBool) -> Result<Vec<Vec<Marks>>, BatchError> {
        let lattice = self.design.lattice;
        // Groups of as many layouts as there are lanes, each under each impact.
        let groups: Vec<(usize, &[Vec<u8>])> = (0..self.impacts.len())
            .flat_map(|impact| layouts.chunks(self.width.lanes()).map(move |group| (impact, group)))
            .collect();
        let simulated = groups
            .par_iter()
            .map(|(impact, group)| {
                let sample = |materials: &Vec<u8>| {
                    Layout { lattice, palette: self.palette.clone(), materials: materials.clone() }.sample()
                };
                let samples: Vec<_> = group.iter().map(sample).collect();
                simulate_batch(&samples, &self.impacts[*impact], self.width, interrupt)
            })
            .collect::<Result<Vec<_>, BatchError>>()?;
        let mut briefs: Vec<_> = simulated.into_iter().flatten().collect();
        let mut of_layout: Vec<Vec<Marks>> = layouts.iter().map(|_| Vec::with_capacity(self.impacts.len())).collect();
        for uniform in &self.uniform {
            for (marks, brief) in of_layout.iter_mut().zip(briefs.drain(..layouts.len())) {
                marks.push(self.score(&brief.max_kinetic, brief.stop, uniform));
            }
        }
        Ok(of_layout)
    }

    fn score(&self, max_kinetic: &[f64], stop: Option<Stop>, uniform: &[f64; 2]) -> Marks {
        let [focal_mean, protected_mean] = means(max_kinetic, &self.design.lattice, &self.design.target);
        Marks {
            focal_mean,
            protected_mean,
            contrast: ratio(focal_mean, protected_mean),
            focal_gain: ratio(focal_mean, uniform[0]),
            protection: ratio(protected_mean, uniform[1]),
            stop,
        }
    }
}
