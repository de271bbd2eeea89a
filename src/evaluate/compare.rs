//! The lens and its baselines, simulated alike and in parallel.

use rayon::prelude::*;

use super::beside::{reference, unnamed};
use super::forces::under_forces;
use super::traced::spot_diagrams;
use super::verdict::{Judged, verdict};
use super::{Doubts, Evaluated, Evaluation, EvaluatorError, Forces, Overrides, Plan, PlanError, Subject};
use super::{method, parted, validity};
use crate::Context;
use crate::dem::Stop;
use crate::design::Design;
use crate::layout::{Baseline, Layout};
use crate::lens::{FocusRays, Lens, Part};
use crate::outcome::{
    ArrangementOutcome, Begun, FORMAT, FocusProposal, Outcome, PartProposal, Proposal, SphereRecord, Verdict,
};
use crate::score::{Scores, over_forces};
use crate::target::Focus;

/// The arrangements to compare: a subject, which may be a proposed lens or any layout, and its baselines.
pub struct Comparison<'a> {
    /// The design whose impact and target count.
    pub design: &'a Design,
    /// Step and window.
    pub plan: Plan,
    /// The forces that the verdict is judged over.
    pub forces: Forces,
    /// The subject's name, `lens` for a proposal.
    pub name: String,
    /// The subject, or its right half.
    pub subject: Layout,
    /// Where its halves differ the material of the image of every site, left of the axis.
    pub left: Option<Vec<u8>>,
    /// Place in the subject's palette of what baselines are made of and Q refers to, where the design names it.
    pub reference: Option<u8>,
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
        let proposal = Some(Proposal { spots: spot_diagrams(design, lens), ..proposal(design, lens) });
        Self::new(design, "lens".to_owned(), (lens.layout(), None), lens.rows(), proposal, overrides)
    }

    /// Any layout, or a piece of two halves, against its baselines: strips and mixtures span the rows in which it differs from the host,
    /// and are made of what the design says, see [`Design::reference`].
    ///
    /// # Errors
    /// A step or window with which nothing can be simulated.
    pub fn of_layout<'b>(
        design: &'a Design,
        name: String,
        subject: impl Into<Subject<'b>>,
        overrides: Overrides,
    ) -> Result<Self, PlanError> {
        let subject: Subject<'_> = subject.into();
        let given = (subject.layout.clone(), subject.left.map(<[u8]>::to_vec));
        Self::new(design, name, given, subject.rows(), None, overrides)
    }

    fn new(
        design: &'a Design,
        name: String,
        (mut subject, left): (Layout, Option<Vec<u8>>),
        rows: [u32; 2],
        proposal: Option<Proposal>,
        overrides: Overrides,
    ) -> Result<Self, PlanError> {
        let held = subject.materials.iter().chain(left.iter().flatten()).copied();
        let reference = reference(design, &mut subject.palette, held);
        let plan = Plan::new(design, overrides, &subject.palette)?;
        Ok(Self { design, plan, forces: Forces::USUAL, name, subject, left, reference, rows, proposal })
    }

    /// What is compared.
    pub fn piece(&self) -> Subject<'_> {
        Subject { layout: &self.subject, left: self.left.as_deref() }
    }

    /// Judged over other forces than the usual ones.
    #[must_use]
    pub fn over(mut self, forces: Forces) -> Self {
        self.forces = forces;
        self
    }

    /// Number of arrangements.
    pub fn len(&self) -> usize {
        1 + self.baselines().len()
    }

    /// Never: the subject is always there.
    pub fn is_empty(&self) -> bool {
        false
    }

    /// The baselines with their layouts.
    fn baselines(&self) -> Vec<(Baseline, Layout)> {
        // Where the design names no second material there is nothing to arrange otherwise.
        let set = match self.reference {
            Some(_) => Baseline::set(self.plan.first_seed, self.design.seeds),
            None => vec![Baseline::AllHost],
        };
        let material = self.reference.unwrap_or_default();
        let count = self.piece().count();
        let lay = |baseline: Baseline| baseline.layout_of_count(&self.subject, self.rows, material, count);
        set.into_iter().map(|baseline| (baseline, lay(baseline))).collect()
    }

    /// The layout of an arrangement by its name.
    pub fn arrangement(&self, name: &str) -> Option<Layout> {
        self.jobs().into_iter().find(|job| job.name == name).map(|job| job.layout)
    }

    /// What is to be simulated: the subject first.
    pub(super) fn jobs(&self) -> Vec<Job> {
        let subject = Job {
            name: self.name.clone(),
            kind: self.name.clone(),
            seed: None,
            layout: self.subject.clone(),
            left: self.left.clone(),
        };
        let others = self.baselines().into_iter().map(|(baseline, layout)| Job {
            name: baseline.name(),
            kind: baseline.kind().to_owned(),
            seed: baseline.seed(),
            layout,
            left: None,
        });
        std::iter::once(subject).chain(others).collect()
    }

    /// What was found, with what is needed to repeat it.
    pub(super) fn outcome(
        &self,
        begun: Begun,
        (forces, verdict): (Vec<f64>, Vec<Verdict>),
        arrangements: Vec<ArrangementOutcome>,
        mut warnings: Vec<String>,
    ) -> Outcome {
        let Self { design, plan, .. } = self;
        let lattice = &design.lattice;
        let forces = parted(design.impact, forces);
        let reference = self.reference.map(|material| self.subject.palette[usize::from(material)].name.clone());
        if let (None, Some(material)) = (design.reference(), &reference) {
            warnings.push(unnamed(material));
        }
        Outcome {
            format: FORMAT,
            manifest: begun.manifest(
                design.file(),
                method(design, plan),
                design.impact_in_words(),
                [plan.first_seed, design.seeds],
            ),
            sites: lattice.sites(),
            diameter: lattice.diameter(),
            half_width: lattice.half_width(),
            target: design.target.clone(),
            materials: self.subject.palette.iter().map(|m| m.name.clone()).collect(),
            reference,
            is_published: self.proposal.is_some() && design.is_published(),
            forces: forces.0,
            speeds: forces.1,
            verdict,
            proposal: self.proposal.clone(),
            swaps: None,
            sensitivities: None,
            inside: None,
            arrangements,
            warnings,
        }
    }
}

/// An arrangement to be simulated.
pub(super) struct Job {
    pub name: String,
    pub kind: String,
    pub seed: Option<u64>,
    pub layout: Layout,
    pub left: Option<Vec<u8>>,
}

impl Job {
    /// What is simulated.
    pub fn piece(&self) -> Subject<'_> {
        Subject { layout: &self.layout, left: self.left.as_deref() }
    }

    /// What it did.
    pub fn arrangement(&self, scores: Scores, record: SphereRecord, stop: Option<Stop>) -> ArrangementOutcome {
        ArrangementOutcome {
            name: self.name.clone(),
            kind: self.kind.clone(),
            seed: self.seed,
            scores,
            over_forces: None,
            simulated: None,
            simulated_fraction: None,
            layout: self.piece().drawn(),
            record,
            stop,
        }
    }
}

/// Simulates subject and baselines on all threads of the current pool. Results do not depend on their number: each
/// arrangement is one thread's work, of which the context is told, and they are collected in order. When it is stopped the outcome holds those that were
/// finished.
///
/// # Errors
/// See [`EvaluatorError`].
pub fn compare(comparison: &Comparison<'_>, context: &Context) -> Result<Outcome, EvaluatorError> {
    let Comparison { design, plan, .. } = comparison;
    let begun = Begun::now();
    let jobs = comparison.jobs();
    let evaluations: Vec<Option<Evaluation>> = jobs
        .par_iter()
        .map(|job| {
            if context.stopped() {
                return Ok(None);
            }
            let evaluation = job.piece().evaluate(design, plan, context)?;
            let complete = !matches!(evaluation.record.stop, Some(Stop::Interrupted { .. }));
            if complete {
                context.finished(&job.name);
            }
            Ok(complete.then_some(evaluation))
        })
        .collect::<Result<_, EvaluatorError>>()?;

    let mut warnings = plan.warnings.clone();
    let mut doubts = Doubts::default();
    let mut arrangements = Vec::new();
    let mut simulated = Vec::new();
    for (job, evaluation) in jobs.into_iter().zip(evaluations) {
        let Some(Evaluation { scores, record, doubts: own }) = evaluation else { continue };
        doubts = doubts.worse(own);
        let piece = job.piece();
        let felt = SphereRecord {
            max_kinetic: piece.on_places(&record.max_kinetic),
            max_net_force: piece.on_places(&record.max_net_force),
            max_contact_force: piece.on_places(&record.max_contact_force),
            arrival: piece.on_places(&record.arrival),
            dissipated: piece.on_places(&record.dissipated),
        };
        arrangements.push(job.arrangement(scores, felt, record.stop));
        simulated.push(job);
    }
    relate(&mut arrangements);
    let whole = arrangements.len() == comparison.len();
    let (forces, verdict) = match whole {
        true => judge(comparison, comparison.forces, &mut arrangements, &simulated, context)?,
        false => (Vec::new(), Vec::new()),
    };
    warnings.extend(stops(&arrangements).into_iter().map(|stop| format!("FAILED: {stop}")));
    warnings.extend(doubts.words("some arrangements"));
    Ok(comparison.outcome(begun, (forces, verdict), arrangements, warnings))
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
pub(super) fn relate(arrangements: &mut [ArrangementOutcome]) {
    let of = |kind: &str| arrangements.iter().find(|a| a.kind == kind && a.stop.is_none()).map(|a| &a.scores);
    let host = of("all-host").map(|scores| scores.focal_mean);
    let lens = of("all-lens").map(|scores| scores.protected_mean);
    let subject = arrangements.first().filter(|a| a.stop.is_none()).map(|a| a.scores.protected_mean);
    for ArrangementOutcome { scores, .. } in arrangements {
        scores.relate(host, lens);
        scores.protected_ratio = subject.and_then(|subject| crate::score::ratio(subject, scores.protected_mean));
    }
}

/// Judges the subject over forces: these, and the verdict. Also gives every arrangement its scores over them.
pub(super) fn judge(
    comparison: &Comparison<'_>,
    forces: Forces,
    arrangements: &mut [ArrangementOutcome],
    simulated: &[Job],
    context: &Context,
) -> Result<(Vec<f64>, Vec<Verdict>), EvaluatorError> {
    let Comparison { design, plan, .. } = comparison;
    let forces = forces.about(design.impact.strength());
    let runs = if forces.len() == 1 {
        Vec::new()
    } else {
        let pieces: Vec<Subject<'_>> = simulated.iter().map(Job::piece).collect();
        match under_forces(design, plan, &pieces, &forces, context) {
            Err(EvaluatorError::Interrupted) => return Ok((Vec::new(), Vec::new())),
            runs => runs?,
        }
    };
    Ok((forces, over_runs(arrangements, runs)))
}

/// The verdict on the first arrangement over the runs of each under several forces, of which each also gets how its scores scatter; without runs, over what they did
/// under the design's own.
pub(super) fn over_runs(arrangements: &mut [ArrangementOutcome], runs: Vec<Vec<Evaluated>>) -> Vec<Verdict> {
    let scores = if runs.iter().all(Vec::is_empty) {
        let own = |a: &ArrangementOutcome| a.stop.is_none().then(|| vec![a.scores.clone()]);
        arrangements.iter().map(own).collect()
    } else {
        let scores = related(&kinds(arrangements), runs);
        for (arrangement, scores) in arrangements.iter_mut().zip(&scores) {
            arrangement.over_forces = scores.as_ref().map(|scores| over_forces(scores).1);
        }
        scores
    };
    of_first(&kinds(arrangements), &scores)
}

fn kinds(arrangements: &[ArrangementOutcome]) -> Vec<&str> {
    arrangements.iter().map(|arrangement| arrangement.kind.as_str()).collect()
}

/// Scores of the runs of each arrangement under each force, related to the uniform crystals under it; none of an arrangement that a guard stopped.
fn related(kinds: &[&str], mut runs: Vec<Vec<Evaluated>>) -> Vec<Option<Vec<Scores>>> {
    let [host, lens] = ["all-host", "all-lens"].map(|kind| kinds.iter().position(|known| *known == kind));
    for force in 0..runs.first().map_or(0, Vec::len) {
        let of = |k: Option<usize>| k.map(|k| &runs[k][force]).filter(|run| run.stop.is_none());
        let host = of(host).map(|run| run.scores.focal_mean);
        let lens = of(lens).map(|run| run.scores.protected_mean);
        runs.iter_mut().for_each(|runs| runs[force].scores.relate(host, lens));
    }
    let finished =
        |runs: Vec<Evaluated>| runs.into_iter().map(|run| run.stop.is_none().then_some(run.scores)).collect();
    runs.into_iter().map(finished).collect()
}

/// The verdict on the first of arrangements of these kinds, by their runs alone.
pub(super) fn of_runs(kinds: &[&str], runs: Vec<Vec<Evaluated>>) -> Vec<Verdict> {
    of_first(kinds, &related(kinds, runs))
}

/// The first of some arrangements against the others; those without scores were stopped by a guard.
fn of_first(kinds: &[&str], scores: &[Option<Vec<Scores>>]) -> Vec<Verdict> {
    let judged = kinds.iter().zip(scores).skip(1);
    let others: Vec<Judged> =
        judged.filter_map(|(kind, scores)| Some(Judged { kind, runs: scores.as_ref()? })).collect();
    scores[0].as_ref().map_or_else(Vec::new, |subject| verdict(subject, &others))
}

/// The verdict of [`compare`] alone, without records: all arrangements under all forces side by side.
///
/// # Errors
/// See [`EvaluatorError`].
pub fn judged(comparison: &Comparison<'_>, context: &Context) -> Result<Vec<Verdict>, EvaluatorError> {
    let Comparison { design, plan, forces, name, .. } = comparison;
    let baselines = comparison.baselines();
    let (kinds, pieces): (Vec<&str>, Vec<Subject<'_>>) = std::iter::once((name.as_str(), comparison.piece()))
        .chain(baselines.iter().map(|(baseline, layout)| (baseline.kind(), Subject::from(layout))))
        .unzip();
    let runs = under_forces(design, plan, &pieces, &forces.about(design.impact.strength()), context)?;
    Ok(of_runs(&kinds, runs))
}

/// What ray tracing proposed, as it is stored.
pub fn proposal(design: &Design, lens: &Lens) -> Proposal {
    let several = lens.foci.len() > 1;
    let layout = lens.layout();
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
        fraction: lens.fraction,
        fraction_without: lens.fraction_without,
        crossing: lens.crossing,
        protected: lens.protected,
        materials: lens.palette.iter().map(|material| material.name.clone()).collect(),
        piece: layout.piece(|material| design.price(material)),
        half: layout.half(|material| design.price(material)),
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
