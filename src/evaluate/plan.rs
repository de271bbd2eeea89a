//! How a design is simulated: step and window, one for all of its arrangements, each with its reason.

use crate::contact::{AnyLaw, Constants, LawKind, NormalLaw, Pair};
use crate::dem::{ForcePulse, Integrator, stable_step};
use crate::design::{Accuracy, Design};
use crate::material::Material;
use crate::units::Dimension::{Force, Fraction, Time};
use crate::wave::{self, Dimension};

/// What the command line may set in place of the design file.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Overrides {
    /// The integrator.
    pub integrator: Option<Integrator>,
    /// The step (s).
    pub step: Option<f64>,
    /// The window (s).
    pub window: Option<f64>,
    /// The first random seed.
    pub first_seed: Option<u64>,
}

/// Step and window for all arrangements of a design.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// The integrator.
    pub integrator: Integrator,
    /// The step (s).
    pub step: f64,
    /// Why this step.
    pub step_reason: String,
    /// The window (s).
    pub window: f64,
    /// Why this window.
    pub window_reason: String,
    /// The first random seed.
    pub first_seed: u64,
    /// What the user should know about these choices.
    pub warnings: Vec<String>,
}

/// A step or window with which nothing can be simulated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PlanError {
    /// The step is above the stability limit of the stiffest contact present.
    #[error(
        "step = {} is unstable: the stiffest contact present ({contact}, about {stiffness:.2e} N/m) allows at most {}",
        Time.show(*step), Time.show(*limit)
    )]
    Step {
        /// The step asked for (s).
        step: f64,
        /// The greatest stable one (s).
        limit: f64,
        /// Materials of the stiffest contact.
        contact: String,
        /// Its stiffness (N/m).
        stiffness: f64,
    },
    /// The window ends before the pulse does.
    #[error("window = {} ends before the pulse of {} does", Time.show(*window), Time.show(*pulse))]
    Window {
        /// The window asked for (s).
        window: f64,
        /// Duration of the pulse (s).
        pulse: f64,
    },
}

impl PlanError {
    /// What to try.
    pub fn help(&self) -> String {
        match self {
            Self::Step { limit, .. } => {
                format!("Leave the step out to have it chosen, or try \"{}\".", Time.show(limit / TENTH_PERCENT))
            }
            Self::Window { .. } => "Leave the window out to have it chosen.".to_owned(),
        }
    }
}

/// The stability limit over the step at which F and P of the lens problem are within 0.1 % of the converged ones: 1e-7 s
/// of the 1.38e-6 s that its steel on brass allows, with Verlet as with Runge-Kutta.
const TENTH_PERCENT: f64 = 13.7;

/// The same for 1 %: 4e-7 s with Verlet, 5e-7 s with Runge-Kutta.
fn one_percent(integrator: Integrator) -> f64 {
    match integrator {
        Integrator::Verlet => 3.44,
        Integrator::Rk4 => 2.75,
    }
}

/// Greatest contact force in the sheet over the force that a struck sphere hands to each of its two contacts, as
/// measured on lens, host and lens material under 10.5 and 26 kN: 1.11 to 1.26 for plastic laws; up to 3.7 for elastic ones,
/// whose stiffness grows with the cube root of the force only.
fn overshoot(law: LawKind) -> f64 {
    match law {
        LawKind::Hertz | LawKind::HertzThesis => 3.75,
        LawKind::Thesis | LawKind::ThesisStatic | LawKind::Consistent | LawKind::Linear | LawKind::LinearStatic => 1.2,
    }
}

/// The contact that limits the step.
struct Stiffest {
    names: String,
    stiffness: f64,
    force: f64,
    limit: f64,
}

fn stiffest(materials: &[Material], diameter: f64, law: LawKind, constants: Constants, pulse: ForcePulse) -> Stiffest {
    let force = overshoot(law) * wave::contact_force(pulse.force);
    let mut found = Stiffest { names: String::new(), stiffness: 0.0, force, limit: f64::INFINITY };
    for (k, a) in materials.iter().enumerate() {
        for b in &materials[k..] {
            let pair = Pair::new([a, b], [0.5 * diameter; 2], constants);
            let stiffness = AnyLaw::new(law, &pair).stiffness_max(force);
            let lighter = a.sphere_mass(diameter).min(b.sphere_mass(diameter));
            let limit = stable_step::<2>(stiffness, lighter);
            if limit < found.limit {
                found = Stiffest { names: format!("{} on {}", a.name, b.name), stiffness, force, limit };
            }
        }
    }
    found
}

impl Plan {
    /// Chooses what is not given. `materials` are all that occur in any arrangement.
    ///
    /// An automatic step is the largest that meets the accuracy class and divides the pulse.
    ///
    /// # Errors
    /// See [`PlanError`].
    pub fn new(design: &Design, overrides: Overrides, materials: &[Material]) -> Result<Self, PlanError> {
        let integrator = overrides.integrator.unwrap_or(design.integrator);
        let diameter = design.lattice.diameter();
        let stiffest = stiffest(materials, diameter, design.law, design.constants, design.impact);
        let divisor = match design.accuracy {
            Accuracy::TenthPercent => TENTH_PERCENT,
            Accuracy::OnePercent => one_percent(integrator),
        };
        let accurate = stiffest.limit / divisor;
        let class = Fraction.show(design.accuracy.fraction());
        let limit = format!(
            "stability limit {} (stiffest contact {}: {:.2e} N/m when unloading from {})",
            Time.show(stiffest.limit),
            stiffest.names,
            stiffest.stiffness,
            Force.show(stiffest.force)
        );
        let mut warnings = Vec::new();
        let pulse = design.impact.duration;
        let (step, step_reason) = match overrides.step.or(design.step) {
            Some(step) if step > stiffest.limit => {
                let Stiffest { names, stiffness, limit, .. } = stiffest;
                return Err(PlanError::Step { step, limit, contact: names, stiffness });
            }
            Some(step) => {
                if step > accurate * (1.0 + 1e-9) {
                    warnings.push(format!(
                        "a step of {} misses the {class} class, which asks for {} or less; halve it and compare",
                        Time.show(step),
                        Time.show(accurate)
                    ));
                }
                (step, format!("given; {limit}"))
            }
            None => {
                let parts = (pulse / accurate).ceil();
                (pulse / parts, format!("{class} class: {limit} over {divisor}, {parts} steps in the pulse"))
            }
        };
        let speed = |m: &Material| wave::bound(Dimension::Two, [m, m], diameter, design.constants).speed;
        let slowest = materials.iter().min_by(|a, b| speed(a).total_cmp(&speed(b))).unwrap_or(&design.host);
        let chosen = design.target.window(&design.lattice, speed(slowest));
        let formula = format!(
            "(depth of the regions' far edge + 10 rows)/({:.0} m/s, {}) + 120 us",
            speed(slowest),
            slowest.name
        );
        let (window, window_reason) = match overrides.window.or(design.window) {
            Some(window) if window <= pulse => return Err(PlanError::Window { window, pulse }),
            Some(window) => (window, format!("given; the formula {formula} gives {}", Time.show(chosen))),
            None => (chosen, formula),
        };
        let first_seed = overrides.first_seed.unwrap_or(design.first_seed);
        Ok(Self { integrator, step, step_reason, window, window_reason, first_seed, warnings })
    }
}
