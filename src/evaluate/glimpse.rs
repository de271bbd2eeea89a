//! A comparison by energies alone, for a screen that follows a hand: all arrangements side by side in vector lanes.

use rayon::prelude::*;

use super::compare::{judge, relate, stops};
use super::{Comparison, EvaluatorError, Forces, impact};
use crate::Context;
use crate::dem::{PeakEnergies, Stop, simulate_batch, simulate_batch_with_friction};
use crate::outcome::{Begun, Outcome, SphereRecord};
use crate::real::Width;
use crate::score::Scores;

/// What `compare` finds of energies under the design's own force, to the last bit: F, P, C, G and Q of every arrangement and the
/// greatest kinetic energy of each sphere, judged over one force; of a piece whose halves differ its right half, for both. Without forces, arrivals, losses and a ledger it takes a fifth of
/// the time.
///
/// # Errors
/// See [`EvaluatorError`]; [`EvaluatorError::Interrupted`] where it was stopped before the end.
pub fn glimpse(comparison: &Comparison<'_>, context: &Context) -> Result<Outcome, EvaluatorError> {
    let begun = Begun::now();
    let Comparison { design, plan, .. } = comparison;
    let width = Width::widest();
    let strikes = impact(design, plan);
    let jobs = comparison.jobs();
    let peak_energies = jobs
        .par_chunks(width.lanes())
        .map(|jobs| {
            let samples: Vec<_> = jobs.iter().map(|job| job.layout.sample()).collect();
            match design.friction {
                Some(mu) => simulate_batch_with_friction(&samples, &strikes, mu, None, width, context),
                None => simulate_batch(&samples, &strikes, width, context),
            }
        })
        .collect::<Result<Vec<_>, _>>()?;
    let mut arrangements = Vec::new();
    for (job, PeakEnergies { max_kinetic, stop }) in jobs.iter().zip(peak_energies.into_iter().flatten()) {
        if matches!(stop, Some(Stop::Interrupted { .. })) {
            return Err(EvaluatorError::Interrupted);
        }
        let mut scores = Scores::of_energies(&max_kinetic, &design.lattice, &design.target);
        scores.add_layout(&job.layout.stats(|material| design.price(material)));
        arrangements.push(job.arrangement(scores, SphereRecord { max_kinetic, ..SphereRecord::default() }, stop));
    }
    relate(&mut arrangements);
    let judged = judge(comparison, Forces::ONE, &mut arrangements, &jobs, context)?;
    let mut warnings = plan.warnings.clone();
    warnings.extend(stops(&arrangements).into_iter().map(|stop| format!("FAILED: {stop}")));
    Ok(comparison.outcome(begun, judged, arrangements, warnings))
}
