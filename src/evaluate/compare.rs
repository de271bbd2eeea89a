//! The lens and its baselines, simulated alike and in parallel.

use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Instant, SystemTime, UNIX_EPOCH};

use rayon::prelude::*;

use super::EvaluateError;
use super::traced::spot_diagrams;
use super::{Doubts, Evaluation, Overrides, Plan, PlanError, evaluate, validity};
use crate::dem::Stop;
use crate::design::Design;
use crate::layout::{Baseline, Layout};
use crate::lens::{FocusRays, Lens, Part};
use crate::outcome::{
    ArrangementOutcome, FORMAT, FocusProposal, Manifest, Outcome, PartProposal, Proposal, SphereRecord,
};
use crate::score::Scores;
use crate::target::Focus;

/// Is told of every arrangement that is finished.
pub trait Progress: Sync {
    /// An arrangement is done.
    fn finished(&self, name: &str);
}

/// Nobody is told.
impl Progress for () {
    fn finished(&self, _: &str) {}
}

/// The arrangements to compare: a subject, which may be a proposed lens or any layout, and its baselines.
pub struct Comparison<'a> {
    /// The design whose impact and target count.
    pub design: &'a Design,
    /// Step and window.
    pub plan: Plan,
    /// The subject's name, `lens` for a proposal.
    pub name: String,
    /// The subject.
    pub subject: Layout,
    /// First and last row in which the subject holds lens material.
    pub rows: [u32; 2],
    /// What ray tracing said about it.
    pub proposal: Option<Proposal>,
}

impl<'a> Comparison<'a> {
    /// A proposed lens against its baselines.
    ///
    /// # Errors
    /// A step or window with which nothing can be simulated.
    pub fn of_lens(design: &'a Design, lens: &Lens, overrides: Overrides) -> Result<Self, PlanError> {
        let subject = lens.layout();
        let plan = Plan::new(design, overrides, &subject.palette)?;
        let proposal = Some(Proposal { spots: spot_diagrams(design, lens), ..proposal(design, lens) });
        Ok(Self { design, plan, name: "lens".to_owned(), rows: lens.rows(), subject, proposal })
    }

    /// Any layout against its baselines: strips and mixtures span the rows in which it differs from the host, and are
    /// made of the design's lens material, or, where the layout holds none of it, of its first that is not the host.
    ///
    /// # Errors
    /// A step or window with which nothing can be simulated.
    pub fn of_layout(
        design: &'a Design,
        name: String,
        mut subject: Layout,
        overrides: Overrides,
    ) -> Result<Self, PlanError> {
        // Baselines are made of the palette's first two.
        if subject.count(1) == 0
            && let Some(&first) = subject.materials.iter().find(|&&m| m > 0)
        {
            subject.palette.swap(1, usize::from(first));
            for material in subject.materials.iter_mut() {
                *material = if *material == first {
                    1
                } else if *material == 1 {
                    first
                } else {
                    *material
                };
            }
        }
        let plan = Plan::new(design, overrides, &subject.palette)?;
        let rows: Vec<u32> = subject
            .lattice
            .sites()
            .iter()
            .zip(&subject.materials)
            .filter(|(_, m)| **m != 0)
            .map(|(s, _)| s.row)
            .collect();
        let rows = [rows.first().copied().unwrap_or(1), rows.last().copied().unwrap_or(1)];
        Ok(Self { design, plan, name, subject, rows, proposal: None })
    }

    /// Number of arrangements.
    pub fn len(&self) -> usize {
        1 + self.baselines().len()
    }

    /// Never: the subject is always there.
    pub fn is_empty(&self) -> bool {
        false
    }

    fn baselines(&self) -> Vec<Baseline> {
        // Without a second material there is nothing to arrange otherwise.
        if self.subject.palette.len() < 2 { Vec::new() } else { Baseline::set(self.plan.first_seed, self.design.seeds) }
    }
}

/// Simulates subject and baselines on all threads of the current pool. Results do not depend on their number: each
/// arrangement is one thread's work, and they are collected in order. When `interrupt` is set the outcome holds those that were
/// finished.
///
/// # Errors
/// Spheres that overlap at rest; no layout on a lattice has such.
pub fn compare(
    comparison: &Comparison<'_>,
    interrupt: &AtomicBool,
    progress: &impl Progress,
) -> Result<Outcome, EvaluateError> {
    let Comparison { design, plan, .. } = comparison;
    let begun = Instant::now();
    let started_unix_s = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |since| since.as_secs());
    let baselines = comparison.baselines();
    let subject = std::iter::once((comparison.name.clone(), comparison.name.clone(), None, comparison.subject.clone()));
    let jobs: Vec<_> = subject
        .chain(baselines.iter().map(|baseline| {
            let layout = baseline.layout(&comparison.subject, comparison.rows);
            (baseline.name(), baseline.kind().to_owned(), baseline.seed(), layout)
        }))
        .collect();
    let evaluations: Vec<Option<Evaluation>> = jobs
        .par_iter()
        .map(|(name, _, _, layout)| {
            if interrupt.load(Ordering::Relaxed) {
                return Ok(None);
            }
            let evaluation = evaluate(design, layout, plan, interrupt)?;
            let complete = !matches!(evaluation.record.stop, Some(Stop::Interrupted { .. }));
            if complete {
                progress.finished(name);
            }
            Ok(complete.then_some(evaluation))
        })
        .collect::<Result<_, EvaluateError>>()?;

    let mut warnings = plan.warnings.clone();
    let mut doubts = Doubts::default();
    let mut arrangements = Vec::new();
    for ((name, kind, seed, layout), evaluation) in jobs.into_iter().zip(evaluations) {
        let Some(Evaluation { scores, record, doubts: own }) = evaluation else { continue };
        doubts = doubts.worse(own);
        arrangements.push(ArrangementOutcome {
            name,
            kind,
            seed,
            spheres: layout.materials.iter().filter(|&&m| m != 0).count(),
            scores,
            layout: layout.materials,
            stop: record.stop,
            record: SphereRecord {
                max_kinetic: record.max_kinetic,
                max_net_force: record.max_net_force,
                max_contact_force: record.max_contact_force,
                arrival: record.arrival,
                dissipated: record.dissipated,
            },
        });
    }
    relate(&mut arrangements);
    warnings.extend(stops(&arrangements).into_iter().map(|stop| format!("FAILED: {stop}")));
    warnings.extend(doubts.words("some arrangements"));
    let lattice = &design.lattice;
    Ok(Outcome {
        format: FORMAT,
        manifest: Manifest {
            format: FORMAT,
            name: design.name.clone(),
            version: env!("CARGO_PKG_VERSION").to_owned(),
            design_file: design.path.display().to_string(),
            design: design.text.clone(),
            impact: design.impact_in_words(),
            law: design.law_name(),
            constants: design.constants.to_string(),
            integrator: plan.integrator.to_string(),
            step_s: plan.step,
            step_reason: plan.step_reason.clone(),
            window_s: plan.window,
            window_reason: plan.window_reason.clone(),
            seeds: [plan.first_seed, design.seeds],
            threads: rayon::current_num_threads(),
            started_unix_s,
            seconds: begun.elapsed().as_secs_f64(),
        },
        sites: lattice.sites(),
        diameter: lattice.diameter(),
        half_width: lattice.half_width(),
        target: design.target.clone(),
        materials: comparison.subject.palette.iter().map(|m| m.name.clone()).collect(),
        proposal: comparison.proposal.clone(),
        arrangements,
        warnings,
    })
}

/// Which guards stopped which arrangements, one line for each reason: `lens, all-host: the energy ledger ...`.
pub fn stops(arrangements: &[ArrangementOutcome]) -> Vec<String> {
    let mut reasons: Vec<(String, Vec<&str>)> = Vec::new();
    for arrangement in arrangements {
        let Some(reason) = arrangement.stop.as_ref().map(Stop::to_string) else { continue };
        match reasons.iter_mut().find(|(known, _)| *known == reason) {
            Some((_, names)) => names.push(&arrangement.name),
            None => reasons.push((reason, vec![&arrangement.name])),
        }
    }
    let all = |names: &[&str]| names.len() == arrangements.len() && names.len() > 1;
    let words = |(reason, names): (String, Vec<&str>)| {
        if all(&names) {
            format!("all {} arrangements: {reason}", names.len())
        } else {
            format!("{}: {reason}", names.join(", "))
        }
    };
    reasons.into_iter().map(words).collect()
}

/// Adds to every arrangement its ratios to the subject and to the uniform ones, where no guard stopped these.
fn relate(arrangements: &mut [ArrangementOutcome]) {
    let of = |kind: &str| arrangements.iter().find(|a| a.kind == kind && a.stop.is_none()).map(|a| a.scores.clone());
    let (host, lens): (Option<Scores>, Option<Scores>) = (of("all-host"), of("all-lens"));
    let subject = arrangements.first().filter(|a| a.stop.is_none()).map(|a| a.scores.clone());
    for arrangement in arrangements {
        arrangement.scores.relate(subject.as_ref(), host.as_ref(), lens.as_ref());
    }
}

/// What ray tracing proposed, as it is stored.
pub fn proposal(design: &Design, lens: &Lens) -> Proposal {
    let several = lens.foci.len() > 1;
    let part = |part: &Part| PartProposal {
        foci: part.foci.iter().map(|focus| focus + 1).collect(),
        window: part.window,
        prescription: part.prescription.clone(),
        fraction: [part.fraction, part.fraction_without],
    };
    let focus = |(rays, focus): (&FocusRays, &Focus)| FocusProposal {
        share: focus.share,
        fraction: [rays.fraction, rays.fraction_without],
        arrival: rays.arrival,
        predicted_gain: rays.gain,
    };
    let strengths: Vec<_> = lens.palette.iter().map(|material| (material, validity(design, material))).collect();
    let [host, material] = [&strengths[0].1, &strengths[1].1];
    Proposal {
        host_speed: lens.host_speed,
        lens_speed: lens.lens_speed,
        speed_ratio: lens.host_speed / lens.lens_speed,
        critical_angle: crate::wave::critical_angle([lens.host_speed, lens.lens_speed]),
        amplitude_host: host.amplitude,
        amplitude_lens: material.amplitude,
        validity: strengths
            .iter()
            .map(|(material, strength)| format!("{}: {}", material.name, strength.words()))
            .collect::<Vec<_>>()
            .join("; "),
        family: lens.family.name().to_owned(),
        prescription: lens.prescription.clone(),
        spheres: lens.spheres,
        fraction: lens.fraction,
        fraction_without: lens.fraction_without,
        crossing: lens.crossing,
        protected: lens.protected,
        counts: lens.first_order.counts.clone(),
        mass: lens.first_order.mass,
        cost: lens.first_order.cost(&lens.palette, &design.prices),
        arrival: lens.first_order.arrival,
        predicted_gain: lens.first_order.gain,
        parts: lens.parts.iter().filter(|_| several).map(part).collect(),
        foci: lens.foci.iter().zip(&design.target.foci).filter(|_| several).map(focus).collect(),
        spots: Vec::new(),
        warnings: lens.warnings.clone(),
        faces: lens.faces(),
        rays: lens.sample_rays(17),
    }
}
