//! The section [run]: step, window, and why.

use super::file::RunFile;
use super::step::{dividing_step, needed, resolution};
use crate::dem::rig::Rig;
use crate::dem::{Integrator, MoveIn, Spheres};
use crate::design::Accuracy;
use crate::document::{DocumentError, Scope};
use crate::units::Dimension;

/// How a rig is run.
#[derive(Clone, Debug, PartialEq)]
pub struct RunPlan {
    /// The scheme in time: Verlet's or Adams's.
    pub integrator: Integrator,
    /// The step (s).
    pub step: f64,
    /// Why this step.
    pub step_reason: String,
    /// How long the run lasts (s).
    pub window: f64,
    /// Why this window.
    pub window_reason: String,
    /// What the user should know about these choices.
    pub warnings: Vec<String>,
}

impl RunPlan {
    /// Steps of the whole run.
    pub fn steps(&self) -> u64 {
        // A window of so many steps, up to rounding, is not one step longer.
        (self.window / self.step * (1.0 - 1e-12)).ceil() as u64
    }
}

/// More steps than this are taken for a slip of a prefix.
const MOST_STEPS: f64 = 1e12;

/// Reads [run]: also drag, whether the rig is precompressed, and the domain are put into `rig`, whose first `crystal` spheres are those
/// of the crystal.
pub(super) fn plan<const D: usize>(
    rig: &mut Rig<D>,
    (diameter, crystal): (f64, usize),
    scope: &Scope,
    file: &RunFile,
) -> Result<RunPlan, DocumentError>
where
    Spheres: MoveIn<D>,
{
    let window = scope.required("window", &file.window)?;
    let length = window.positive(Dimension::Time)?;
    if let Some(entry) = scope.optional("drag", &file.drag) {
        rig.drag = entry.quantity(Dimension::Rate)?;
        if rig.drag < 0.0 {
            return Err(entry.refuse("must not be negative"));
        }
    }
    if let Some(entry) = scope.optional("precompressed", &file.precompressed) {
        rig.precompressed |= entry.yes()?;
    }
    let leave = match scope.optional("leave", &file.leave) {
        Some(entry) => match entry.length(diameter)? {
            leave if leave <= 0.0 => return Err(entry.refuse("must be more than zero")),
            leave => leave,
        },
        None => 100.0 * diameter,
    };
    let (mut low, mut high) = ([f64::INFINITY; D], [f64::NEG_INFINITY; D]);
    for sphere in &rig.sample.spheres {
        for k in 0..D {
            low[k] = low[k].min(sphere.centre[k] - leave);
            high[k] = high[k].max(sphere.centre[k] + leave);
        }
    }
    rig.domain = Some([low, high]);

    let accuracy = match scope.optional("accuracy", &file.accuracy) {
        Some(entry) => match entry.quantity(Dimension::Fraction)? {
            part if (part / 1e-3 - 1.0).abs() < 1e-9 => Accuracy::TenthPercent,
            part if (part / 1e-2 - 1.0).abs() < 1e-9 => Accuracy::OnePercent,
            _ => {
                return Err(entry.fail("must be \"0.1 %\" or \"1 %\"", "For any other accuracy give run.step instead."));
            }
        },
        None => Accuracy::default(),
    };
    let schemes = [Integrator::Verlet, Integrator::Adams].map(|scheme| (scheme.to_string(), scheme));
    let schemes = [(&*schemes[0].0, schemes[0].1), (&*schemes[1].0, schemes[1].1)];
    let integrator = match scope.optional("integrator", &file.integrator) {
        Some(entry) => entry.choice("integrator of rigs", &schemes)?,
        None => Integrator::Verlet,
    };
    let needed = needed(rig, crystal, length, accuracy, integrator);
    let mut warnings = Vec::new();
    // A run errs by no more than its class, in its energy too; but the jumps of dashpots are resolved to some percent of what they
    // take, as in beds.
    rig.residual_limit = if rig.laws.has_dashpots() { 0.1 } else { accuracy.fraction() };
    let (step, step_reason) = match scope.optional("step", &file.step) {
        Some(entry) => {
            let step = entry.positive(Dimension::Time)?;
            if step > length {
                return Err(entry.fail("is longer than run.window", "Shorten it, or leave it out to have it chosen."));
            }
            if step > needed.step * (1.0 + 1e-9) {
                let class = Dimension::Fraction.show(accuracy.fraction());
                let (step, needed) = (Dimension::Time.show(step), Dimension::Time.show(needed.step));
                warnings.push(format!(
                    "a step of {step} may miss the {class} class, for which {needed} would be chosen; halve it and compare"
                ));
            }
            (step, format!("given; {}", needed.reason))
        }
        None => {
            rig.resolution = Some(resolution(accuracy));
            let most = needed.step.min(length);
            // Steps that fill the pulses, or else the window.
            (dividing_step(rig, most).unwrap_or_else(|| length / (length / most).ceil()), needed.reason)
        }
    };
    if length / step > MOST_STEPS {
        return Err(window.fail("would take more than 1e12 steps", "Check its unit, and that of run.step."));
    }
    Ok(RunPlan { integrator, step, step_reason, window: length, window_reason: "given".to_owned(), warnings })
}
