//! One layout beside the uniform crystals that G and Q refer to: what `check` says of it, in the numbers of `compare`.

use rayon::prelude::*;

use super::forces::under_forces;
use super::{EvaluateError, Evaluation, EvaluatorError, Forces, Plan, Subject};
use crate::Context;
use crate::dem::Stop;
use crate::design::Design;
use crate::layout::{Baseline, Layout};
use crate::material::Material;
use crate::score::{Scores, Spreads, over_forces};

/// A layout with G and Q.
#[derive(Clone, Debug)]
pub struct Beside {
    /// The layout's own run, at the design's own force.
    pub evaluation: Evaluation,
    /// The material that Q refers to.
    pub reference: Option<String>,
    /// Uniform crystals that a guard stopped, and why: ratios to them are not there.
    pub stopped: Vec<(String, Stop)>,
    /// The forces that the layout was judged over (N); none with the design's own alone.
    pub forces: Vec<f64>,
    /// The scores over these, and how they scatter; none where a guard stopped one of the runs.
    pub over_forces: Option<(Scores, Spreads)>,
}

/// Where in a palette stands what Q refers to: what the design says, which joins the palette where it is not there. Where the
/// design says nothing, the first of those that the layout `holds` that is not the host.
pub(super) fn reference<L, R>(
    design: &Design<L, R>,
    palette: &mut Vec<Material>,
    mut holds: impl Iterator<Item = u8>,
) -> Option<u8> {
    let Some(reference) = design.reference() else { return holds.find(|&material| material != 0) };
    let place = palette.iter().position(|material| material == reference).unwrap_or_else(|| {
        palette.push(reference.clone());
        palette.len() - 1
    });
    u8::try_from(place).ok()
}

/// Has a design name what Q refers to, as [`beside_uniform`] and [`compare`](super::compare()) take it of a piece of these materials, places in the palette, and says so
/// where it named nothing.
pub fn refer<L, R>(design: &mut Design<L, R>, palette: &[Material], held: &[u8]) -> Option<String> {
    if design.reference().is_some() {
        return None;
    }
    let place = reference(design, &mut palette.to_vec(), held.iter().copied())?;
    let material = palette[usize::from(place)].clone();
    let words = unnamed(&material.name);
    design.compared_with = Some(material);
    Some(words)
}

/// What is said where the design does not say what Q refers to.
pub fn unnamed(material: &str) -> String {
    format!(
        "the design names no material that Q, strips and mixtures refer to; taken is {material}, the first that is not the host. Name \
         it as compare.material"
    )
}

/// Evaluates a layout, or a piece of two halves, beside the crystals of the host and of the design's lens material alone, which `compare` has among its
/// baselines: F, P, C, G and Q of [`compare`](super::compare) to the last bit, without strips and mixtures. `plan` is how it is simulated, `forces` over how
/// many forces it is judged besides its own, `context` says when to stop.
///
/// # Errors
/// See [`EvaluatorError`].
pub fn beside_uniform<'a>(
    design: &Design,
    given: impl Into<Subject<'a>>,
    plan: &Plan,
    forces: Forces,
    context: &Context,
) -> Result<Beside, EvaluatorError> {
    let given: Subject<'_> = given.into();
    let mut subject = given.layout.clone();
    let held = given.layout.materials.iter().chain(given.left.unwrap_or_default()).copied();
    let reference = reference(design, &mut subject.palette, held);
    let kinds = std::iter::once((Baseline::AllHost, 0)).chain(reference.map(|material| (Baseline::AllLens, material)));
    let (names, baselines): (Vec<String>, Vec<Layout>) =
        kinds.map(|(kind, material)| (kind.name(), kind.layout(&subject, [1, 1], material))).unzip();
    let reference = reference.map(|material| subject.palette[usize::from(material)].name.clone());
    let own = Subject { layout: &subject, left: given.left };
    let pieces: Vec<Subject<'_>> = std::iter::once(own).chain(baselines.iter().map(Subject::from)).collect();
    let runs = pieces
        .par_iter()
        .map(|piece| piece.evaluate(design, plan, context))
        .collect::<Result<Vec<_>, EvaluateError>>()?;
    let stopped = runs.iter().skip(1).zip(&names);
    let stopped = stopped.filter_map(|(run, name)| Some((name.clone(), run.record.stop.clone()?))).collect();
    let uniform = |k: usize| runs.get(k).filter(|run| run.record.stop.is_none()).map(|run| &run.scores);
    let (host, lens) = (uniform(1).map(|host| host.focal_mean), uniform(2).map(|lens| lens.protected_mean));
    let mut evaluation = runs[0].clone();
    evaluation.scores.relate(host, lens);
    if forces.is_one() || matches!(evaluation.record.stop, Some(Stop::Interrupted { .. })) {
        return Ok(Beside { evaluation, reference, stopped, forces: Vec::new(), over_forces: None });
    }
    let forces = forces.about(design.impact.strength());
    let runs = under_forces(design, plan, &pieces, &forces, context)?;
    let related = |force: usize| {
        let run = |k: usize| runs.get(k).map(|runs| &runs[force]).filter(|run| run.stop.is_none());
        let mut scores = run(0)?.scores.clone();
        scores.relate(run(1).map(|run| run.scores.focal_mean), run(2).map(|run| run.scores.protected_mean));
        Some(scores)
    };
    let scores: Option<Vec<Scores>> = (0..forces.len()).map(related).collect();
    Ok(Beside { evaluation, reference, stopped, forces, over_forces: scores.map(|scores| over_forces(&scores)) })
}
