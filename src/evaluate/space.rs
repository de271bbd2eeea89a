//! Crystals in space: a lens or any layout, its baselines and strips of 1, 2, ... layers, all side by side in lanes.
//!
//! What is judged is what [`compare`](super::compare) judges in the plane; here records are kept of the subject alone, and all else is energies.

use rayon::prelude::*;

use super::beside::reference;
use super::compare::{of_runs, over_runs, relate};
use super::load::{ImpactLoad, Imperfection};
use super::part::{Parts, simulated_fraction, walls};
use super::{Doubts, EvaluateError, Evaluated, Evaluation, EvaluatorError, Forces, Overrides, Plan, PlanError};
use super::{NO_PULSE, method, parted, stops, unnamed};
use crate::Context;
use crate::dem::{Impact, Mirror, Period, Stop, Strike, simulate_batch_under};
use crate::design::SpaceDesign;
use crate::lattice::{Block, BlockSide, Layered, Outline};
use crate::layout::{Baseline, Layout};
use crate::lens::{Body, LensRequest};
use crate::outcome::{
    ArrangementOutcome, Begun, FORMAT, SpaceOutcome, SpaceProposal, SpaceSite, SphereRecord, Verdict,
};
use crate::real::Width;
use crate::sample::Sample;
use crate::score::{Scores, Spreads, over_forces as over_forces_of};

/// The design's impact: a pulse on layer 1, or half of a projectile before it, sides as the block's, the far end free.
pub fn impact_in_space(design: &SpaceDesign, plan: &Plan) -> Impact {
    let block = &design.lattice;
    let (mirrors, periods) = sides(block, false);
    let impact = Impact {
        mirrors,
        periods,
        law: design.law,
        constants: design.constants,
        pulse: NO_PULSE,
        slope: 0.0,
        struck: block.layer(1).collect(),
        faces: walls(block, false),
        moving: Vec::new(),
        projectile: None,
        exit: block.layer(block.layers()).collect(),
        integrator: plan.integrator,
        step: plan.step,
        window: plan.window,
    };
    impact.struck_by(design.impact.of_part(0.5))
}

/// What ends a crystal across the wave, across an axis: its half x ≥ 0, or the whole.
pub(super) fn sides(block: &Block, whole: bool) -> (Vec<Mirror>, Vec<Period>) {
    // Around an outline stand walls of another kind.
    let ends = if block.outline() == Outline::All { block.sides() } else { [BlockSide::Free; 2] };
    let ([half, high], [across, along]) = (block.half_widths(), ends);
    let radius = 0.5 * block.diameter();
    let (mut mirrors, mut periods) = (Vec::new(), Vec::new());
    if !whole {
        mirrors.push(Mirror { axis: 0, position: 0.0, inward: 1.0 });
    }
    let far = match across {
        // The structure is its own image there, and so a period of the half is two mirrors.
        BlockSide::Mirror => Some(half),
        BlockSide::Period if !whole => Some(half),
        BlockSide::Period => {
            periods.push(Period { axis: 0, length: 2.0 * half });
            None
        }
        BlockSide::Wall => Some(half + radius),
        BlockSide::Free => None,
    };
    mirrors.extend(far.filter(|_| whole).map(|far| Mirror { axis: 0, position: -far, inward: 1.0 }));
    mirrors.extend(far.map(|far| Mirror { axis: 0, position: far, inward: -1.0 }));
    match along {
        BlockSide::Period => periods.push(Period { axis: 1, length: 2.0 * high }),
        BlockSide::Mirror | BlockSide::Wall => {
            let y = |fold: fn(f64, f64) -> f64, from| block.sites().iter().map(|site| site.centre[1]).fold(from, fold);
            mirrors.push(Mirror { axis: 1, position: y(f64::min, f64::INFINITY) - radius, inward: 1.0 });
            mirrors.push(Mirror { axis: 1, position: y(f64::max, f64::NEG_INFINITY) + radius, inward: -1.0 });
        }
        BlockSide::Free => {}
    }
    (mirrors, periods)
}

/// Simulates and scores one layout of a design in space, with full records.
///
/// # Errors
/// See [`EvaluateError`].
pub fn evaluate_in_space(
    design: &SpaceDesign,
    layout: &Layout<Block>,
    plan: &Plan,
    context: &Context,
) -> Result<Evaluation<3>, EvaluateError> {
    let sample = layout.sample_in_space();
    let record = Parts::new(design, plan, &ImpactLoad::from(design.impact), false).recorded(layout, context)?;
    let within = design.target.on(&design.lattice);
    let mut scores = Scores::of_sites(&record.max_kinetic, &within);
    scores.add_records(&record, &within, |site| [site; 2], 1.0, |sphere| sample.mass(sphere));
    add_piece(&mut scores, design, layout);
    let doubts = Doubts::of(&record, &sample, &record.max_kinetic, (design, layout.lattice.diameter()), &within);
    Ok(Evaluation { scores, record, doubts })
}

/// Adds what a layout in space says by itself.
pub(crate) fn add_piece(scores: &mut Scores, design: &SpaceDesign, layout: &Layout<Block>) {
    let piece = layout.piece_in_space(|material| design.price(material)).amount;
    (scores.piece_mass, scores.piece_cost, scores.piece_spheres) = (Some(piece.mass), piece.cost, Some(piece.spheres));
}

/// A run's scores, and the greatest kinetic energy of each sphere (J).
type Run = (Evaluated, Vec<f64>);

/// Layouts of one design, each under its forces, in lanes: for each layout its energies and scores under each, not yet related to uniform crystals.
/// The bits of a layout's numbers depend neither on the number of threads nor on what stands beside it.
///
/// # Errors
/// See [`EvaluatorError`].
fn under_forces(
    design: &SpaceDesign,
    plan: &Plan,
    asked: &[(&Layout<Block>, &[f64])],
    context: &Context,
) -> Result<Vec<Vec<Run>>, EvaluatorError> {
    let within = design.target.on(&design.lattice);
    let (parts, drawn) = (Parts::new(design, plan, &ImpactLoad::from(design.impact), false), Imperfection::default());
    let width = Width::widest();
    let is_sixth: Vec<bool> = asked.iter().map(|(layout, _)| parts.is_sixth(&layout.materials, &drawn)).collect();
    // The forces of a layout stand together, so that a lane's contacts are of few kinds; and what is simulated in one part.
    let mut members: Vec<(usize, f64)> =
        asked.iter().enumerate().flat_map(|(k, (_, forces))| forces.iter().map(move |&force| (k, force))).collect();
    members.sort_by_key(|&(k, _)| is_sixth[k]);
    let alike = members.chunk_by(|a, b| is_sixth[a.0] == is_sixth[b.0]);
    let groups: Vec<&[(usize, f64)]> = alike.flat_map(|alike| alike.chunks(width.lanes())).collect();
    let found = groups
        .par_iter()
        .map(|group| {
            let field = parts.field(is_sixth[group[0].0]);
            let sample = |&(k, _): &(usize, f64)| field.sample(&asked[k].0.palette, &asked[k].0.materials, &drawn);
            let samples: Vec<Sample<3>> = group.iter().map(sample).collect();
            let strikes: Vec<Strike> =
                group.iter().map(|&(_, strength)| field.impact.strike().with_strength(strength)).collect();
            let briefs = simulate_batch_under(&samples, &field.impact, &strikes, None, None, width, context)?;
            let scored = briefs.into_iter().map(|brief| {
                let max_kinetic = field.folded(&brief.max_kinetic);
                let scores = Scores::of_sites(&max_kinetic, &within);
                (Evaluated { scores, stop: brief.stop.map(|stop| field.named(stop)) }, max_kinetic)
            });
            Ok(scored.collect::<Vec<_>>())
        })
        .collect::<Result<Vec<_>, EvaluatorError>>()?;
    // Those of a layout keep their order.
    let mut runs: Vec<Vec<Run>> = asked.iter().map(|_| Vec::new()).collect();
    for (&(k, _), run) in groups.into_iter().flatten().zip(found.into_iter().flatten()) {
        runs[k].push(run);
    }
    Ok(runs)
}

/// A layout in space beside the uniform crystals that G and Q refer to.
pub struct SpaceBeside {
    /// F of the host alone and P of the design's lens material alone (J), where no guard stopped them.
    pub uniform: [Option<f64>; 2],
    /// Uniform crystals that a guard stopped, and why.
    pub stopped: Vec<(String, Stop)>,
    /// The material that Q refers to.
    pub reference: Option<String>,
    /// The forces that the layout was judged over (N); none with the design's own alone.
    pub forces: Vec<f64>,
    /// The scores over these, and how they scatter; none where a guard stopped one of the runs.
    pub over_forces: Option<(Scores, Spreads)>,
}

/// The uniform crystals that a layout in space is compared with, under the design's own force and, with the layout, under several.
///
/// # Errors
/// See [`EvaluatorError`].
pub fn beside_in_space(
    design: &SpaceDesign,
    layout: &Layout<Block>,
    plan: &Plan,
    forces: Forces,
    context: &Context,
) -> Result<SpaceBeside, EvaluatorError> {
    let mut subject = layout.clone();
    let reference = reference(design, &mut subject.palette, subject.materials.iter().copied());
    let kinds = std::iter::once((Baseline::AllHost, 0)).chain(reference.map(|material| (Baseline::AllLens, material)));
    let (names, uniform): (Vec<String>, Vec<Layout<Block>>) =
        kinds.map(|(kind, material)| (kind.name(), kind.layout(&subject, [1, 1], material))).unzip();
    let own = design.impact.strength();
    let over = if forces.is_one() { Vec::new() } else { forces.about(own) };
    let all: Vec<f64> = [own].into_iter().chain(over.iter().copied()).collect();
    // Under the design's own force the subject has been followed already, with records.
    let asked: Vec<(&Layout<Block>, &[f64])> =
        std::iter::once((&subject, &over[..])).chain(uniform.iter().map(|layout| (layout, &all[..]))).collect();
    let runs = under_forces(design, plan, &asked, context)?;
    if runs.iter().flatten().any(|(run, _)| matches!(run.stop, Some(Stop::Interrupted { .. }))) {
        return Err(EvaluatorError::Interrupted);
    }
    let stopped = runs.iter().skip(1).zip(&names);
    let stopped = stopped.filter_map(|(runs, name)| Some((name.clone(), runs[0].0.stop.clone()?))).collect();
    let of = |k: usize, force: usize| Some(&runs.get(k)?.get(force)?.0).filter(|run| run.stop.is_none());
    let means = |force: usize| {
        [of(1, force).map(|run| run.scores.focal_mean), of(2, force).map(|run| run.scores.protected_mean)]
    };
    let related = |k: usize| {
        let mut scores = of(0, k)?.scores.clone();
        let [host, lens] = means(k + 1);
        scores.relate(host, lens);
        Some(scores)
    };
    let over_forces =
        if over.is_empty() { None } else { (0..over.len()).map(related).collect::<Option<Vec<Scores>>>() };
    Ok(SpaceBeside {
        uniform: means(0),
        stopped,
        reference: reference.map(|material| subject.palette[usize::from(material)].name.clone()),
        forces: over,
        over_forces: over_forces.map(|scores| over_forces_of(&scores)),
    })
}

/// The arrangements to compare in space: a subject, which may be a proposed lens or any layout, its baselines, and strips from its first layer on
/// of one layer up to as many as it has.
pub struct SpaceComparison<'a> {
    /// The design whose impact and target count.
    pub design: &'a SpaceDesign,
    /// Step and window.
    pub plan: Plan,
    /// The forces that the verdict is judged over.
    pub forces: Forces,
    /// The subject's name, `lens` for a proposal.
    pub name: String,
    /// The subject.
    pub subject: Layout<Block>,
    /// Place in the subject's palette of what baselines are made of and Q refers to.
    pub reference: Option<u8>,
    /// First and last layer in which the subject holds anything but the host.
    pub layers: [u32; 2],
    /// What ray tracing said about it.
    pub proposal: Option<SpaceProposal>,
}

impl<'a> SpaceComparison<'a> {
    /// A proposed lens against its baselines.
    ///
    /// # Errors
    /// A step or window with which nothing can be simulated.
    pub fn of_lens(
        design: &'a SpaceDesign,
        (body, request, materials): (&Body, &LensRequest, Vec<u8>),
        overrides: Overrides,
    ) -> Result<Self, PlanError> {
        let palette = design.palette_of_lens(request);
        let layout = Layout { lattice: design.lattice.clone(), palette, materials };
        let proposal = space_proposal(design, body, request, &layout);
        Ok(Self { proposal: Some(proposal), ..Self::of_layout(design, "lens".to_owned(), layout, overrides)? })
    }

    /// Any layout against its baselines.
    ///
    /// # Errors
    /// A step or window with which nothing can be simulated.
    pub fn of_layout(
        design: &'a SpaceDesign,
        name: String,
        mut subject: Layout<Block>,
        overrides: Overrides,
    ) -> Result<Self, PlanError> {
        let block = &subject.lattice;
        let held = (1..=block.layers()).filter(|&layer| subject.materials[block.layer(layer)].iter().any(|&m| m != 0));
        let layers =
            held.fold(None, |range, layer| Some(range.map_or([layer; 2], |[first, _]: [u32; 2]| [first, layer])));
        let reference = reference(design, &mut subject.palette, subject.materials.iter().copied());
        let plan = Plan::in_space(design, overrides, &subject.palette)?;
        let layers = layers.unwrap_or([1, 1]);
        Ok(Self { design, plan, forces: Forces::USUAL, name, subject, reference, layers, proposal: None })
    }

    /// Judged over other forces than the usual ones.
    #[must_use]
    pub fn over(mut self, forces: Forces) -> Self {
        self.forces = forces;
        self
    }

    /// Number of arrangements.
    pub fn len(&self) -> usize {
        self.arrangements().len()
    }

    /// Of each arrangement, the subject first, the part of the crystal in which it is simulated: a half or a sixth.
    pub fn fractions(&self) -> Vec<f64> {
        self.arrangements().iter().map(|(.., layout)| simulated_fraction(layout)).collect()
    }

    /// Never: the subject is always there.
    pub fn is_empty(&self) -> bool {
        false
    }

    /// Name, kind, seed and layout of all, the subject first.
    fn arrangements(&self) -> Vec<(String, String, Option<u64>, Layout<Block>)> {
        let mut all = vec![(self.name.clone(), self.name.clone(), None, self.subject.clone())];
        let Some(material) = self.reference else {
            let host = Baseline::AllHost.layout(&self.subject, self.layers, 0);
            all.push(("all-host".to_owned(), "all-host".to_owned(), None, host));
            return all;
        };
        for baseline in Baseline::set(self.plan.first_seed, self.design.seeds).into_iter().chain(strips(self.layers)) {
            // Strips are no seeds of one kind: each is a rival of its own.
            let kind =
                if matches!(baseline, Baseline::Strip(_)) { baseline.name() } else { baseline.kind().to_owned() };
            all.push((baseline.name(), kind, baseline.seed(), baseline.layout(&self.subject, self.layers, material)));
        }
        all
    }
}

/// Strips of one layer up to one less than all layers that a lens spans, which is its strip of the same height.
pub fn strips(layers: [u32; 2]) -> impl Iterator<Item = Baseline> {
    (1..=layers[1] - layers[0]).map(Baseline::Strip)
}

/// What ray tracing proposed, as it is stored.
fn space_proposal(design: &SpaceDesign, body: &Body, request: &LensRequest, layout: &Layout<Block>) -> SpaceProposal {
    SpaceProposal {
        family: request.family.name().to_owned(),
        symmetry: request.symmetry,
        host_speed: body.speeds[0],
        lens_speed: body.speeds[1],
        apex_layer: body.apex_row,
        back_layer: body.back_row,
        radius: body.radius,
        parameters: body.parameters.clone(),
        steepest: body.steepest,
        fraction: body.fraction,
        fraction_without: body.fraction_without,
        protected: body.protected,
        materials: layout.palette.iter().map(|material| material.name.clone()).collect(),
        piece: layout.piece_in_space(|material| design.price(material)),
        faces: body.form.faces(design.stack(request.symmetry).half_width),
    }
}

/// Simulates subject, baselines and strips on all threads of the current pool, each under the design's own force and those of the verdict.
/// When it is stopped the outcome holds no arrangement.
///
/// # Errors
/// See [`EvaluatorError`].
pub fn compare_in_space(comparison: &SpaceComparison<'_>, context: &Context) -> Result<SpaceOutcome, EvaluatorError> {
    let SpaceComparison { design, plan, .. } = comparison;
    let begun = Begun::now();
    let named = comparison.arrangements();
    let own = design.impact.strength();
    // The design's own force comes first; where the verdict is over it alone it is not simulated twice. Under it the subject is followed with
    // records, which say the same energies.
    let over = if comparison.forces.is_one() { Vec::new() } else { comparison.forces.about(own) };
    let forces: Vec<f64> = [own].into_iter().chain(over.iter().copied()).collect();
    let subject = evaluate_in_space(design, &comparison.subject, plan, context)?;
    context.finished(&comparison.name);
    let Evaluation { scores, record, doubts } = subject;
    let mut subject = Some((
        Evaluated { scores, stop: record.stop },
        SphereRecord {
            max_kinetic: record.max_kinetic,
            max_net_force: record.max_net_force,
            max_contact_force: record.max_contact_force,
            arrival: record.arrival,
            dissipated: record.dissipated,
        },
    ));
    let under = |layout: &Layout<Block>| if std::ptr::eq(layout, &named[0].3) { &over[..] } else { &forces[..] };
    let mut runs = Vec::new();
    // A few at a time, so that progress is seen.
    let lanes = Width::widest().lanes() * rayon::current_num_threads();
    let mut arrangements = Vec::new();
    for some in named.chunks(lanes.div_ceil(forces.len()).max(1)) {
        let asked: Vec<(&Layout<Block>, &[f64])> = some.iter().map(|(.., layout)| (layout, under(layout))).collect();
        let found = under_forces(design, plan, &asked, context)?;
        for ((name, kind, seed, layout), mut of_layout) in some.iter().zip(found) {
            let (own, record) = subject.take().unwrap_or_else(|| {
                let (mut run, max_kinetic) = of_layout.remove(0);
                add_piece(&mut run.scores, design, layout);
                context.finished(name);
                (run, SphereRecord { max_kinetic, ..SphereRecord::default() })
            });
            arrangements.push(ArrangementOutcome {
                name: name.clone(),
                kind: kind.clone(),
                seed: *seed,
                scores: own.scores,
                over_forces: None,
                simulated: None,
                simulated_fraction: Some(simulated_fraction(layout)),
                layout: layout.materials.clone(),
                record,
                stop: own.stop,
            });
            runs.push(of_layout.into_iter().map(|(run, _)| run).collect::<Vec<Evaluated>>());
        }
        let all = arrangements.iter().map(|a| &a.stop).chain(runs.iter().flatten().map(|run| &run.stop));
        if all.into_iter().any(|stop| matches!(stop, Some(Stop::Interrupted { .. }))) {
            return Err(EvaluatorError::Interrupted);
        }
    }
    let mut warnings = plan.warnings.clone();
    relate(&mut arrangements);
    let verdict = over_runs(&mut arrangements, runs);
    let forces = if over.is_empty() { vec![own] } else { over };
    warnings.extend(stops(&arrangements).into_iter().map(|stop| format!("FAILED: {stop}")));
    warnings.extend(doubts.words(&comparison.name));
    Ok(outcome(comparison, begun, (forces, verdict), arrangements, warnings))
}

/// The verdict of [`compare_in_space`] alone, by energies.
///
/// # Errors
/// See [`EvaluatorError`].
pub fn judged_in_space(comparison: &SpaceComparison<'_>, context: &Context) -> Result<Vec<Verdict>, EvaluatorError> {
    let SpaceComparison { design, plan, .. } = comparison;
    let named = comparison.arrangements();
    let kinds: Vec<&str> = named.iter().map(|(_, kind, ..)| kind.as_str()).collect();
    let forces = comparison.forces.about(design.impact.strength());
    let asked: Vec<(&Layout<Block>, &[f64])> = named.iter().map(|(.., layout)| (layout, &forces[..])).collect();
    let runs = under_forces(design, plan, &asked, context)?;
    let runs: Vec<Vec<Evaluated>> = runs.into_iter().map(|of| of.into_iter().map(|(run, _)| run).collect()).collect();
    if runs.iter().flatten().any(|run| matches!(run.stop, Some(Stop::Interrupted { .. }))) {
        return Err(EvaluatorError::Interrupted);
    }
    Ok(of_runs(&kinds, runs))
}

fn outcome(
    comparison: &SpaceComparison<'_>,
    begun: Begun,
    (forces, verdict): (Vec<f64>, Vec<Verdict>),
    arrangements: Vec<ArrangementOutcome>,
    mut warnings: Vec<String>,
) -> SpaceOutcome {
    let SpaceComparison { design, plan, subject, .. } = comparison;
    let block = &design.lattice;
    let forces = parted(design.impact, forces);
    let reference = comparison.reference.map(|material| subject.palette[usize::from(material)].name.clone());
    if let (None, Some(material)) = (design.reference(), &reference) {
        warnings.push(unnamed(material));
    }
    SpaceOutcome {
        swaps: None,
        sensitivities: None,
        inside: None,
        format: FORMAT,
        manifest: begun.manifest(
            design.file(),
            method(design, plan),
            design.impact_in_words(),
            [plan.first_seed, design.seeds],
        ),
        sites: SpaceSite::all(block),
        diameter: block.diameter(),
        half_width: block.half_widths()[0],
        target: design.target.clone(),
        materials: subject.palette.iter().map(|m| m.name.clone()).collect(),
        reference,
        is_published: false,
        forces: forces.0,
        speeds: forces.1,
        verdict,
        proposal: comparison.proposal.clone(),
        arrangements,
        warnings,
    }
}
