//! What a study's layouts are compared with: strips, uniform crystals and random mixtures, under the study's impacts.

use serde::{Deserialize, Serialize};

use super::aggregate::of_runs;
use super::{Study, StudyError, free};
use crate::Context;
use crate::design::DesignRef;
use crate::evaluate::{Evaluator, strips};
use crate::lattice::Layered;
use crate::layout::{Baseline, Layout};
use crate::score::{Measure, Scores};
use crate::search::Rng;
use crate::stats::Mean;

/// One baseline, or several of a kind that differ by their seed.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct BaselineScores {
    /// Such as `flat-height`, `strip-brass-260`, `random-rows`.
    pub name: String,
    /// How many seeds; 1 where nothing is random.
    pub seeds: u64,
    /// C = F/P
    #[serde(alias = "C")]
    pub contrast: Option<Spread>,
    /// G
    #[serde(alias = "G")]
    pub focal_gain: Option<Spread>,
    /// Q
    #[serde(alias = "Q")]
    pub protection: Option<Spread>,
}

/// A mean and how well it is known.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Spread {
    /// The mean over seeds.
    pub mean: f64,
    /// Half the width of the mean's 95 % confidence interval, by Student's distribution; none for a single value.
    pub half_width: Option<f64>,
    /// The least and the greatest value.
    pub range: [f64; 2],
}

impl Spread {
    /// Of some values; none of no value.
    pub fn of(values: &[f64]) -> Option<Self> {
        let range = [values.iter().copied().reduce(f64::min)?, values.iter().copied().reduce(f64::max)?];
        let Mean { mean, interval, .. } = Mean::of(values);
        Some(Self { mean, half_width: interval, range })
    }
}

/// A study's baselines with their names: those of a lens (see [`Baseline`]) made of the material that Q refers to, with as
/// many seeds as the design asks for; strips of each allowed material over the rows that may change, since a strip of a light
/// one may gather much energy and protect nothing; and mixtures of all of them there, with the same seeds.
pub(super) fn layouts(study: &Study) -> Vec<(String, Vec<u8>)> {
    let design = study.design();
    let [first_seed, seeds] = design.seeds();
    let rows_of = free::rows_of(design);
    let rows = |of: &mut dyn Iterator<Item = usize>| {
        let rows: Vec<u32> = of.map(|i| rows_of[i]).collect();
        Some([*rows.iter().min()?, *rows.iter().max()?])
    };
    let start = &study.bases[0];
    let of_start = rows(&mut (0..start.len()).filter(|&i| start[i] != 0));
    let free = rows(&mut study.free.iter().copied()).unwrap_or([1, 1]);
    let mut named: Vec<(String, Vec<u8>)> = Vec::new();
    let reference = design.reference().and_then(|of| study.palette.iter().position(|material| material == of));
    if let Some(reference) = reference {
        let of_lens = Baseline::set(first_seed, seeds).into_iter().map(|baseline| {
            let layout = laid(study, baseline, of_start.unwrap_or(free), reference as u8);
            (baseline.kind().to_owned(), layout)
        });
        named.extend(of_lens);
        // In space thin strips bring more to a focus than a lens may.
        if let DesignRef::Space(_) = design {
            let thin = |baseline: Baseline| (baseline.name(), laid(study, baseline, free, reference as u8));
            named.extend(strips(free).map(thin));
        }
    }
    for (letter, &place) in (0..).zip(&study.alphabet) {
        let strip = study.materials(&vec![letter; study.variables()]);
        named.push((format!("strip-{}", study.palette[usize::from(place)].name), strip));
    }
    for seed in (0..seeds).map(|k| first_seed.wrapping_add(k)) {
        let assignment = study.space().random(&mut Rng::new(seed));
        named.push(("random-rows".to_owned(), study.materials(&assignment)));
    }
    named
}

/// The materials of a baseline, laid for the start.
fn laid(study: &Study, baseline: Baseline, rows: [u32; 2], material: u8) -> Vec<u8> {
    fn on<L: Layered + Clone>(lattice: &L, study: &Study, baseline: Baseline, rows: [u32; 2], material: u8) -> Vec<u8> {
        let (palette, materials) = (study.palette.clone(), study.bases[0].clone());
        baseline.layout(&Layout { lattice: lattice.clone(), palette, materials }, rows, material).materials
    }
    match study.design() {
        DesignRef::Plane(design) => on(&design.lattice, study, baseline, rows, material),
        DesignRef::Space(design) => on(&design.lattice, study, baseline, rows, material),
    }
}

/// Simulates a study's baselines.
pub(super) fn evaluate(
    study: &Study,
    evaluator: &Evaluator,
    context: &Context,
) -> Result<Vec<BaselineScores>, StudyError> {
    let named = layouts(study);
    let layouts: Vec<Vec<u8>> = named.iter().map(|(_, layout)| layout.clone()).collect();
    let runs = evaluator.scores(&layouts, context)?;
    let summaries: Vec<Option<Scores>> =
        runs.iter().zip(&layouts).map(|(runs, layout)| of_runs(study, runs, &study.counter.stats(layout))).collect();
    let mut names: Vec<&String> = named.iter().map(|(name, _)| name).collect();
    names.dedup();
    let scores = |name: &String| {
        let of_kind: Vec<&Scores> = named
            .iter()
            .zip(&summaries)
            .filter(|((kind, _), _)| kind == name)
            .filter_map(|(_, s)| s.as_ref())
            .collect();
        let spread =
            |measure: Measure| Spread::of(&of_kind.iter().filter_map(|scores| scores.get(measure)).collect::<Vec<_>>());
        BaselineScores {
            name: name.clone(),
            seeds: named.iter().filter(|(kind, _)| kind == name).count() as u64,
            contrast: spread(Measure::Contrast),
            focal_gain: spread(Measure::FocalGain),
            protection: spread(Measure::Protection),
        }
    };
    Ok(names.into_iter().map(scores).collect())
}

#[cfg(test)]
mod tests {
    use super::Spread;

    /// By hand: 1, 2, 3, 4 has mean 2.5 and variance 5/3; t = 3.18245 for three degrees of freedom.
    #[test]
    fn intervals_are_students() {
        let spread = Spread::of(&[1.0, 4.0, 2.0, 3.0]).unwrap();
        assert_eq!((spread.mean, spread.range), (2.5, [1.0, 4.0]));
        assert!((spread.half_width.unwrap() - 3.182_446 * (5.0_f64 / 12.0).sqrt()).abs() < 1e-12);
        assert_eq!(Spread::of(&[1.0]).unwrap().half_width, None);
        assert_eq!(Spread::of(&[]), None);
    }
}
