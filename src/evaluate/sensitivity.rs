//! How scores change with every single sphere: derivatives by the adjoint, and secants beside them that say how far to trust these; and with
//! what all spheres of a material share.

use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::{Plan, impact};
use crate::Context;
use crate::dem::{BatchError, Gradient, GradientError, Gradients, Impact, Stop, gradient, simulate_batch_under};
use crate::design::Design;
use crate::layout::Layout;
use crate::real::Width;
use crate::sample::Sample;
use crate::score::{Measure, means};
use crate::stats::Mean;

/// Of which measures there are derivatives. G is F over that of another crystal, and Q is P over that of another: their logarithms
/// have the derivatives of F and P.
pub const MEASURES: [Measure; 5] =
    [Measure::FocalMean, Measure::ProtectedMean, Measure::Contrast, Measure::FocalGain, Measure::Protection];

/// The relative change of density over which secants are taken.
pub const SECANT: f64 = 0.01;

/// A derivative counts as linear where the secant differs from it by no more than this part of the greater of the two, ...
const LINEAR: f64 = 0.1;
/// ... or by so little that a change of a hundredth does not show in six digits.
const NEGLIGIBLE: f64 = 1e-4;

/// One measure and how it changes: derivatives of its logarithm by the logarithms of each sphere's quantities, in order of the sites. A
/// sphere and its image in the other half change alike.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Derivatives {
    /// Which.
    #[serde(with = "by_name")]
    pub measure: Measure,
    /// By the logarithm of the impact's force.
    #[serde(rename = "d_force")]
    pub force: f64,
    /// By ln ρ of each sphere.
    #[serde(rename = "d_density")]
    pub density: Vec<f64>,
    /// By ln E.
    #[serde(rename = "d_youngs_modulus")]
    pub youngs_modulus: Vec<f64>,
    /// By ln σ_y.
    #[serde(rename = "d_yield_stress")]
    pub yield_stress: Vec<f64>,
    /// By ln r, centres in their places.
    #[serde(rename = "d_radius")]
    pub radius: Vec<f64>,
    /// By ln ρ, over a change of [`SECANT`].
    pub secant_density: Vec<f64>,
    /// Whether a sphere's derivative says what a change of a hundredth does.
    pub linear: Vec<bool>,
    /// The part of the spheres, among those that matter at all, of which that holds; none where no sphere matters.
    pub linear_share: Option<f64>,
}

impl Derivatives {
    /// How far they are to be trusted, in words.
    pub fn trust(&self) -> String {
        let percent = 100.0 * SECANT;
        self.linear_share.map_or_else(
            || "no sphere matters".to_owned(),
            |share| format!("linear over {percent} % of density at {:.0} % of the spheres that matter", 100.0 * share),
        )
    }
}

/// A measure by its name.
mod by_name {
    use super::{Measure, Serialize};
    use serde::de::{Deserialize, Deserializer, Error};

    pub fn serialize<S: serde::Serializer>(measure: &Measure, to: S) -> Result<S::Ok, S::Error> {
        measure.name().serialize(to)
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(from: D) -> Result<Measure, D::Error> {
        let name = String::deserialize(from)?;
        Measure::find(&name).ok_or_else(|| D::Error::custom(format!("{name} is no measure")))
    }
}

/// Whether a derivative and the secant beside it say the same.
fn is_linear(derivative: f64, secant: f64) -> bool {
    (derivative - secant).abs() <= LINEAR * derivative.abs().max(secant.abs()) + NEGLIGIBLE
}

/// Of the spheres that matter the part that is linear.
fn linear_share(density: &[f64], secants: &[f64], linear: &[bool]) -> Option<f64> {
    let matters = |&site: &usize| density[site].abs().max(secants[site].abs()) > NEGLIGIBLE;
    let of: Vec<usize> = (0..density.len()).filter(matters).collect();
    (!of.is_empty()).then(|| of.iter().filter(|&&site| linear[site]).count() as f64 / of.len() as f64)
}

/// What was found, and what it took.
#[derive(Clone, Debug, PartialEq)]
pub struct Sensitivities {
    /// One for each measure asked for.
    pub of: Vec<Derivatives>,
    /// F and P (J), those of `check` at the same step.
    pub means: [f64; 2],
    /// Memory of the derivatives (bytes).
    pub bytes: usize,
}

/// Why there are none.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SensitivityError {
    /// The run has no derivatives.
    #[error(transparent)]
    Gradient(#[from] GradientError),
    /// Crystals for the secants cannot be simulated.
    #[error(transparent)]
    Batch(#[from] BatchError),
    /// A guard stopped one of them.
    #[error("a crystal for the secants cannot be followed: {0}")]
    Stopped(Stop),
    /// Of this measure there are none.
    #[error("there are no derivatives of {}", .0.name())]
    Measure(Measure),
    /// The region received nothing within the window.
    #[error("{} is zero within this window, so that its logarithm has no derivative", .0.name())]
    Nothing(Measure),
}

/// How measures of a layout under a design's impact change with every sphere.
///
/// # Errors
/// See [`SensitivityError`].
pub fn sensitivities(
    design: &Design,
    layout: &Layout,
    plan: &Plan,
    measures: &[Measure],
    context: &Context,
) -> Result<Sensitivities, SensitivityError> {
    if let Some(&other) = measures.iter().find(|measure| !MEASURES.contains(measure)) {
        return Err(SensitivityError::Measure(other));
    }
    let (sample, impact) = (layout.sample(), impact(design, plan));
    let slopes = Slopes::of(design, &sample, &impact, context)?;
    for &measure in measures {
        slopes.exist(measure)?;
    }
    let secants = secants(design, &sample, &impact, slopes.values, context)?;
    let of = measures
        .iter()
        .map(|&measure| {
            let shares = shares(measure);
            let each = |part: fn(&Gradient) -> &[f64]| -> Vec<f64> {
                (0..sample.spheres.len()).map(|site| slopes.log(measure, &|gradient| part(gradient)[site])).collect()
            };
            let density = each(|gradient| &gradient.density);
            let secant_density: Vec<f64> = secants.iter().map(|[f, p]| shares[0] * f + shares[1] * p).collect();
            let linear: Vec<bool> =
                density.iter().zip(&secant_density).map(|(&slope, &secant)| is_linear(slope, secant)).collect();
            Derivatives {
                measure,
                force: slopes.log(measure, &|gradient| gradient.load),
                linear_share: linear_share(&density, &secant_density, &linear),
                density,
                youngs_modulus: each(|gradient| &gradient.youngs_modulus),
                yield_stress: each(|gradient| &gradient.yield_stress),
                radius: each(|gradient| &gradient.radius),
                secant_density,
                linear,
            }
        })
        .collect();
    Ok(Sensitivities { of, means: slopes.values, bytes: slopes.gradients.bytes })
}

/// F and P of a run, and their derivatives.
struct Slopes {
    gradients: Gradients,
    values: [f64; 2],
}

impl Slopes {
    fn of(design: &Design, sample: &Sample<2>, impact: &Impact, context: &Context) -> Result<Self, SensitivityError> {
        let gradients = gradient(sample, impact, design.friction, &sums(design, sample.spheres.len()), context)?;
        let values = means(&gradients.max_kinetic, &design.lattice, &design.target);
        Ok(Self { gradients, values })
    }

    /// Whether a measure has a logarithm.
    fn exist(&self, measure: Measure) -> Result<(), SensitivityError> {
        for ((value, share), part) in
            self.values.into_iter().zip(shares(measure)).zip([Measure::FocalMean, Measure::ProtectedMean])
        {
            if share != 0.0 && value <= 0.0 {
                return Err(SensitivityError::Nothing(part));
            }
        }
        Ok(())
    }

    /// Of the logarithm of a measure.
    fn log(&self, measure: Measure, part: &dyn Fn(&Gradient) -> f64) -> f64 {
        let shares = shares(measure);
        (0..2).map(|k| over(shares[k] * part(&self.gradients.of[k]), self.values[k])).sum()
    }
}

/// How the logarithm of a measure changes with the logarithm of what all spheres of a material share, and of the force, in the mean over several
/// forces: that of the geometric mean by which layouts are judged.
#[derive(Clone, Debug, PartialEq)]
pub struct Shared {
    /// Which measure.
    pub measure: Measure,
    /// By ln ρ of each material, in order of the palette.
    pub density: Vec<f64>,
    /// By ln E.
    pub youngs_modulus: Vec<f64>,
    /// By ln σ_y.
    pub yield_stress: Vec<f64>,
    /// By ln of the force, where that is asked. Of G and Q less that of the uniform crystals that they refer to, which are struck alike.
    pub force: Option<f64>,
}

/// How measures of a layout change with what all spheres of a material share, and `with_force` with the force too, under each of these parts of the
/// design's force. They are sums over spheres of what [`sensitivities`] finds of each.
///
/// # Errors
/// See [`SensitivityError`].
pub fn shared_slopes(
    design: &Design,
    layout: &Layout,
    plan: &Plan,
    (measures, factors, with_force): (&[Measure], &[f64], bool),
    context: &Context,
) -> Result<Vec<Shared>, SensitivityError> {
    if let Some(&other) = measures.iter().find(|measure| !MEASURES.contains(measure)) {
        return Err(SensitivityError::Measure(other));
    }
    let uniform = |material: &crate::material::Material| {
        let palette = vec![material.clone()];
        Layout { materials: vec![0; layout.materials.len()], palette, ..layout.clone() }.sample()
    };
    let refers = |measure: Measure| with_force && measures.contains(&measure);
    let host = refers(Measure::FocalGain).then(|| uniform(&layout.palette[0]));
    let reference = design.reference().filter(|_| refers(Measure::Protection)).map(uniform);
    let piece = Some(layout.sample());
    let runs: Vec<[Option<Slopes>; 3]> = factors
        .par_iter()
        .map(|&factor| {
            let strike = design.impact.with_strength(factor * design.impact.strength());
            let impact = impact(design, plan).struck_by(strike);
            let of = |sample: &Option<Sample<2>>| {
                sample.as_ref().map(|sample| Slopes::of(design, sample, &impact, context)).transpose()
            };
            Ok([of(&piece)?, of(&host)?, of(&reference)?])
        })
        .collect::<Result<_, SensitivityError>>()?;
    let one = |&measure: &Measure| {
        let pieces: Vec<&Slopes> = runs.iter().filter_map(|[piece, ..]| piece.as_ref()).collect();
        pieces.iter().try_for_each(|slopes| slopes.exist(measure))?;
        let mean =
            |part: &dyn Fn(&Slopes) -> f64| Mean::of(&pieces.iter().map(|run| part(run)).collect::<Vec<_>>()).mean;
        let by = |part: fn(&Gradient) -> &[f64]| -> Vec<f64> {
            let of_material = |material: usize| {
                let sites = || (0..layout.materials.len()).filter(|&i| usize::from(layout.materials[i]) == material);
                let sum = |gradient: &Gradient| sites().map(|i| part(gradient)[i]).sum();
                mean(&|run| run.log(measure, &sum))
            };
            (0..layout.palette.len()).map(of_material).collect()
        };
        // What it refers to: F of the host alone, P of the lens material alone.
        let beside = match measure {
            Measure::FocalGain => Some((1, Measure::FocalMean)),
            Measure::Protection => Some((2, Measure::ProtectedMean)),
            _ => None,
        };
        let load = |gradient: &Gradient| gradient.load;
        let mut force = with_force.then(|| mean(&|run| run.log(measure, &load)));
        if let (Some(force), Some((which, part))) = (&mut force, beside) {
            let others: Vec<&Slopes> = runs.iter().filter_map(|runs| runs[which].as_ref()).collect();
            others.iter().try_for_each(|slopes| slopes.exist(part))?;
            *force -= others.iter().map(|run| run.log(part, &load)).sum::<f64>() / others.len().max(1) as f64;
        }
        Ok(Shared {
            measure,
            density: by(|gradient| &gradient.density),
            youngs_modulus: by(|gradient| &gradient.youngs_modulus),
            yield_stress: by(|gradient| &gradient.yield_stress),
            force,
        })
    };
    measures.iter().map(one).collect()
}

/// Zero of nothing, whatever it is divided by.
fn over(a: f64, b: f64) -> f64 {
    if a == 0.0 { 0.0 } else { a / b }
}

/// Powers of F and P in a measure.
fn shares(measure: Measure) -> [f64; 2] {
    match measure {
        Measure::FocalMean | Measure::FocalGain => [1.0, 0.0],
        Measure::ProtectedMean | Measure::Protection => [0.0, 1.0],
        _ => [1.0, -1.0],
    }
}

/// F and P as sums over spheres.
fn sums(design: &Design, spheres: usize) -> [Vec<(usize, f64)>; 2] {
    let mut sums = [Vec::new(), Vec::new()];
    let mut one = vec![0.0; spheres];
    for i in 0..spheres {
        one[i] = 1.0;
        let weights = means(&one, &design.lattice, &design.target);
        for (sum, weight) in sums.iter_mut().zip(weights) {
            if weight != 0.0 {
                sum.push((i, weight));
            }
        }
        one[i] = 0.0;
    }
    sums
}

/// Of ln F and ln P by ln ρ of each sphere, over a change of [`SECANT`].
fn secants(
    design: &Design,
    sample: &Sample<2>,
    impact: &Impact,
    values: [f64; 2],
    context: &Context,
) -> Result<Vec<[f64; 2]>, SensitivityError> {
    let heavier = |i: usize| {
        let mut sample = sample.clone();
        let mut material = sample.materials[sample.spheres[i].material].clone();
        material.density *= 1.0 + SECANT;
        sample.spheres[i].material = sample.materials.len();
        sample.materials.push(material);
        sample
    };
    let width = Width::widest();
    let groups: Vec<Vec<usize>> =
        (0..sample.spheres.len()).collect::<Vec<_>>().chunks(width.lanes()).map(<[usize]>::to_vec).collect();
    let group = |sites: &Vec<usize>| -> Result<Vec<[f64; 2]>, SensitivityError> {
        let samples: Vec<Sample<2>> = sites.iter().map(|&i| heavier(i)).collect();
        let strikes = vec![impact.strike(); samples.len()];
        let briefs = simulate_batch_under(&samples, impact, &strikes, design.friction, None, width, context)?;
        let secant = |brief: crate::dem::PeakEnergies| {
            if let Some(stop) = brief.stop {
                return Err(SensitivityError::Stopped(stop));
            }
            let changed = means(&brief.max_kinetic, &design.lattice, &design.target);
            Ok([0, 1].map(|k| if values[k] > 0.0 { (changed[k] / values[k]).ln() / SECANT.ln_1p() } else { 0.0 }))
        };
        briefs.into_iter().map(secant).collect()
    };
    let found: Result<Vec<_>, SensitivityError> = groups.par_iter().map(group).collect();
    if context.stopped() {
        return Err(SensitivityError::Stopped(Stop::Interrupted { time_s: 0.0 }));
    }
    Ok(found?.into_iter().flatten().collect())
}
