//! How scores change with every single sphere: derivatives by the adjoint, and secants beside them that say how far to trust these.

use rayon::prelude::*;

use super::{Plan, impact};
use crate::Context;
use crate::dem::{BatchError, Gradient, GradientError, Impact, Stop, gradient, simulate_batch};
use crate::design::Design;
use crate::layout::Layout;
use crate::real::Width;
use crate::sample::Sample;
use crate::score::{Measure, means};

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

/// One measure and how it changes: derivatives of its logarithm by the logarithms of each sphere's quantities, in order of the sites.
#[derive(Clone, Debug, PartialEq)]
pub struct Derivatives {
    /// Which.
    pub measure: Measure,
    /// By ln ρ of each sphere.
    pub density: Vec<f64>,
    /// By ln E.
    pub youngs_modulus: Vec<f64>,
    /// By ln σ_y.
    pub yield_stress: Vec<f64>,
    /// By ln r, centres in their places.
    pub radius: Vec<f64>,
    /// By the logarithm of the impact's force.
    pub force: f64,
    /// By ln ρ, over a change of [`SECANT`].
    pub secant_density: Vec<f64>,
}

impl Derivatives {
    /// Whether a sphere's derivative says what a change of a hundredth does.
    pub fn is_linear(&self, site: usize) -> bool {
        let (derivative, secant) = (self.density[site], self.secant_density[site]);
        (derivative - secant).abs() <= LINEAR * derivative.abs().max(secant.abs()) + NEGLIGIBLE
    }

    /// The part of the spheres, among those that matter at all, of which that holds; none where no sphere matters.
    pub fn linear_share(&self) -> Option<f64> {
        let matters = |&site: &usize| self.density[site].abs().max(self.secant_density[site].abs()) > NEGLIGIBLE;
        let of: Vec<usize> = (0..self.density.len()).filter(matters).collect();
        (!of.is_empty()).then(|| of.iter().filter(|&&site| self.is_linear(site)).count() as f64 / of.len() as f64)
    }
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
    /// The design asks for friction.
    #[error("derivatives are those of crystals without friction, and the design has some")]
    Friction,
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
    if design.friction.is_some() {
        return Err(SensitivityError::Friction);
    }
    let (sample, impact) = (layout.sample(), impact(design, plan));
    let sums = sums(design, sample.spheres.len());
    let gradients = gradient(&sample, &impact, &sums, context)?;
    let values = means(&gradients.max_kinetic, &design.lattice, &design.target);
    for (value, measure) in values.into_iter().zip([Measure::FocalMean, Measure::ProtectedMean]) {
        if measures.iter().any(|&asked| shares(asked)[usize::from(measure == Measure::ProtectedMean)] != 0.0)
            && value <= 0.0
        {
            return Err(SensitivityError::Nothing(measure));
        }
    }
    let secants = secants(design, &sample, &impact, values, context)?;
    let of = measures
        .iter()
        .map(|&measure| {
            let shares = shares(measure);
            let log = |part: &dyn Fn(&Gradient) -> f64| -> f64 {
                (0..2).map(|k| over(shares[k] * part(&gradients.of[k]), values[k])).sum()
            };
            let each = |part: fn(&Gradient) -> &[f64]| {
                (0..sample.spheres.len()).map(|site| log(&|gradient| part(gradient)[site])).collect()
            };
            Derivatives {
                measure,
                density: each(|gradient| &gradient.density),
                youngs_modulus: each(|gradient| &gradient.youngs_modulus),
                yield_stress: each(|gradient| &gradient.yield_stress),
                radius: each(|gradient| &gradient.radius),
                force: log(&|gradient| gradient.load),
                secant_density: secants.iter().map(|[f, p]| shares[0] * f + shares[1] * p).collect(),
            }
        })
        .collect();
    Ok(Sensitivities { of, means: values, bytes: gradients.bytes })
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
        let briefs = simulate_batch(&samples, impact, width, context)?;
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
