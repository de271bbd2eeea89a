//! Which material and which family: all of them by what rays propose, by first arrivals, and the best by simulation.

use std::collections::BTreeMap;

use rayon::prelude::*;
use serde::Serialize;

use super::{ArrivalSurrogate, Comparison, EvaluatorError, Overrides, glimpse};
use crate::Context;
use crate::design::Design;
use crate::lens::{Family, Lens, LensRequest, propose};
use crate::material::Material;
use crate::score::Scores;

/// A lens of one material and one family, and what is known of it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Ranked {
    /// Name of the material.
    pub material: String,
    /// The family.
    pub family: String,
    /// Why there is no such lens, if so; all that follows is then missing.
    pub refused: Option<String>,
    /// Wave speed of the host over that of the lens.
    pub speed_ratio: Option<f64>,
    /// Part of the struck width that rays send to the focus, and the same without a lens.
    pub fraction: Option<[f64; 2]>,
    /// Part of the struck width whose rays pass the protected region, and the same without a lens.
    pub protected: Option<[f64; 2]>,
    /// By how much later (s) the wave comes down on the focus than on the protected region, by first arrivals; see [`ArrivalSurrogate::delay`].
    #[serde(rename = "delay_s")]
    pub delay: Option<f64>,
    /// Spheres of the lens in the piece to be built, and its mass (kg).
    pub spheres: Option<u64>,
    /// Mass of the piece (kg).
    #[serde(rename = "mass_kg")]
    pub mass: Option<f64>,
    /// C, G, Q, F and P under the design's own force, of those that were simulated.
    pub scores: Option<Scores>,
    /// What a guard said of a simulation.
    pub stop: Option<String>,
}

/// The design with a lens of this material and family in place of its own: what else is decided about the lens stays, as far as it has
/// a meaning for the family.
fn with(design: &Design, material: &Material, family: Family) -> Design {
    let own = design.lens.clone();
    let rows = own.as_ref().map_or([2, design.target.focal_rows()[0].saturating_sub(1).max(3)], |lens| lens.rows);
    let plain = own.unwrap_or_else(|| LensRequest::new(family, material.clone(), rows));
    let request = LensRequest {
        family,
        material: material.clone(),
        others: Vec::new(),
        radius: None,
        parameters: if family == plain.family { plain.parameters.clone() } else { BTreeMap::new() },
        axis: plain.axis.filter(|_| family.has_axis()),
        raster: plain.raster.filter(|_| family == plain.family),
        ..plain
    };
    // Of baselines only those are wanted that G and Q refer to.
    Design { lens: Some(request), compared_with: None, seeds: 0, ..design.clone() }
}

/// All materials in all families: the `simulated` best by rays are simulated, with the step and window that `compare` would take for
/// each, and come first, by contrast; the others follow by the part of the struck width that rays send to the focus; those that cannot
/// be come last, in the order given.
///
/// # Errors
/// See [`EvaluatorError`].
pub fn rank(
    design: &Design,
    materials: &[Material],
    families: &[Family],
    simulated: usize,
    context: &Context,
) -> Result<Vec<Ranked>, EvaluatorError> {
    let pairs: Vec<(Material, Family)> = families
        .iter()
        .flat_map(|&family| materials.iter().map(move |material| (material.clone(), family)))
        .filter(|(material, family)| {
            let splits = family.is_split() || family.spares() || design.target.foci.len() == 1;
            material.name != design.host.name && splits
        })
        .collect();
    let mut all: Vec<(Design, Option<Lens>, Ranked)> = pairs
        .par_iter()
        .map(|(material, family)| {
            let design = with(design, material, *family);
            let request = design.lens.as_ref().expect("with gives it one");
            let lens = propose(&design.lattice, &design.host, request, &design.target, design.constants);
            let ranked = proposed(&design, material, *family, &lens);
            (design, lens.ok(), ranked)
        })
        .collect();
    // Stable: of equals the first given stays first.
    let by_rays = |ranked: &Ranked| ranked.fraction.map_or(f64::INFINITY, |[with, _]| -with);
    all.sort_by(|a, b| by_rays(&a.2).total_cmp(&by_rays(&b.2)));
    for (design, lens, ranked) in all.iter_mut().take(simulated) {
        let Some(lens) = lens else { break };
        let comparison = Comparison::of_lens(design, lens, Overrides::default())?;
        let first = glimpse(&comparison, context)?.arrangements.swap_remove(0);
        ranked.stop = first.stop.map(|stop| stop.to_string());
        ranked.scores = Some(first.scores).filter(|_| ranked.stop.is_none());
    }
    let mut ranked: Vec<Ranked> = all.into_iter().map(|(_, _, ranked)| ranked).collect();
    let by_contrast =
        |ranked: &Ranked| ranked.scores.as_ref().and_then(|scores| scores.contrast).map_or(f64::INFINITY, |c| -c);
    ranked.sort_by(|a, b| by_contrast(a).total_cmp(&by_contrast(b)));
    Ok(ranked)
}

fn proposed(
    design: &Design,
    material: &Material,
    family: Family,
    lens: &Result<Lens, crate::lens::LensError>,
) -> Ranked {
    let empty = Ranked {
        material: material.name.clone(),
        family: family.name().to_owned(),
        refused: None,
        speed_ratio: None,
        fraction: None,
        protected: None,
        delay: None,
        spheres: None,
        mass: None,
        scores: None,
        stop: None,
    };
    match lens {
        Err(error) => Ranked { refused: Some(error.to_string()), ..empty },
        Ok(lens) => {
            let layout = lens.layout();
            let piece = layout.piece(|material| design.price(material));
            Ranked {
                speed_ratio: Some(lens.host_speed / lens.lens_speed),
                fraction: Some([lens.fraction, lens.fraction_without]),
                protected: Some(lens.protected),
                delay: Some(ArrivalSurrogate::Eikonal.delay(design, &layout)),
                spheres: Some(piece.amount.spheres),
                mass: Some(piece.amount.mass),
                ..empty
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::material::library;

    /// What is ranked is what a design of that material and family gives: the thesis's lens among others. Slower materials alone gather,
    /// so no gathering lens of tungsten carbide in steel can be.
    #[test]
    fn the_ranking_says_what_each_design_would() {
        let design = Design::read(Path::new(env!("CARGO_MANIFEST_DIR")).join("designs/quickstart.toml")).unwrap();
        let never = Context::default();
        let families = [Family::PlanoConvex, Family::AsphericFront];
        let ranked = rank(&design, &library(), &families, 1, &never).unwrap();
        assert_eq!(ranked.len(), 2 * (library().len() - 1), "every pair but those of the host");
        let brass = ranked.iter().find(|r| r.material == "brass-260" && r.family == "plano-convex").unwrap();
        let request = design.lens.as_ref().unwrap();
        let lens = propose(&design.lattice, &design.host, request, &design.target, design.constants).unwrap();
        assert_eq!(brass.fraction, Some([lens.fraction, lens.fraction_without]));
        assert_eq!(brass.spheres, Some(278), "as README says of the piece");
        let carbide = ranked.iter().find(|r| r.material == "tungsten-carbide").unwrap();
        assert!(carbide.refused.as_ref().is_some_and(|why| why.contains("gathers nothing")), "{carbide:?}");
        let best = &ranked[0];
        assert!(best.scores.as_ref().is_some_and(|scores| scores.contrast.is_some_and(|c| c > 1.0)), "{best:?}");
        let most = ranked.iter().filter_map(|r| r.fraction).map(|[with, _]| with).fold(0.0, f64::max);
        assert_eq!(best.fraction.map(|[with, _]| with), Some(most), "the best by rays is simulated");
        assert!(ranked[1..].iter().all(|r| r.scores.is_none()));
    }
}
