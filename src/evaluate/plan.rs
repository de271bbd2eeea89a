//! How a design is simulated: step and window, one for all of its arrangements, each with its reason.

use super::stiffest::{IN_PULSE, Stiffest, dividing, divisor, overshoot};
use super::{ImpactLoad, dimension_of, struck_force};
use crate::contact::{AnyLaw, LawKind, NormalLaw, Pair};
use crate::dem::{Integrator, Strike};
use crate::design::{Design, DesignRef, SpaceDesign};
use crate::lattice::Layered;
use crate::material::Material;
use crate::units::Dimension::{Fraction, Time};
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
    /// Laws among those of several that have another step (s).
    pub own_steps: Vec<(LawKind, f64)>,
    /// The window (s).
    pub window: f64,
    /// Why this window.
    pub window_reason: String,
    /// The first random seed.
    pub first_seed: u64,
    /// What the user should know about these choices.
    pub warnings: Vec<String>,
}

/// What a plan has to know of a crystal.
struct Ground {
    dimension: Dimension,
    /// Of its spheres (m), and those that occur where rows differ.
    diameter: f64,
    diameters: Vec<f64>,
    /// What its layers are called.
    row: &'static str,
    /// That the wave has to pass (m)
    depth: f64,
}

/// Layers behind the regions that the wave has to pass within the window.
const MARGIN: u32 = 10;

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
        /// The greatest that meets the accuracy class (s).
        accurate: f64,
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
            Self::Step { accurate, .. } => {
                format!("Leave the step out to have it chosen, or try \"{}\".", Time.show(*accurate))
            }
            Self::Window { .. } => "Leave the window out to have it chosen.".to_owned(),
        }
    }
}

/// Step and window that serve all impacts: the shortest step and the longest window that any of them asks for. Where they are under several laws each law has
/// a step of its own, since the stiffest may ask for one twenty times as short as the others: the one that its contacts ask for; where a step is given that is
/// the one of the design's law, and each other law takes the same part of its own.
///
/// # Errors
/// A step or window with which one of them cannot be simulated.
pub fn common_plan<'d>(
    design: impl Into<DesignRef<'d>>,
    loads: &[ImpactLoad],
    overrides: Overrides,
    palette: &[Material],
) -> Result<Plan, PlanError> {
    let design = design.into();
    let mut laws: Vec<LawKind> = Vec::new();
    let law_of = |load: &ImpactLoad| load.law.unwrap_or(design.law());
    for law in loads.iter().map(law_of) {
        if !laws.contains(&law) {
            laws.push(law);
        }
    }
    let strikes = |law: Option<LawKind>| -> Vec<Strike> {
        loads.iter().filter(|load| law.is_none_or(|law| law_of(load) == law)).map(|load| load.strike).collect()
    };
    if let [] | [_] = laws[..] {
        return under_law(design, laws.first().copied(), &strikes(None), overrides, palette);
    }
    let mut common = under_law(design, None, &strikes(None), overrides, palette)?;
    // What would be chosen, whatever is given.
    let free = |law: Option<LawKind>, strikes: &[Strike]| {
        let overrides = Overrides { step: None, ..overrides };
        let plan = match design {
            DesignRef::Plane(design) => {
                let design = Design { step: None, ..design.clone() };
                under_law((&design).into(), law, strikes, overrides, palette)
            }
            DesignRef::Space(design) => {
                let design = SpaceDesign { step: None, ..design.clone() };
                under_law((&design).into(), law, strikes, overrides, palette)
            }
        };
        plan.map(|plan| plan.step)
    };
    let reference = free(None, &strikes(None))?;
    for law in laws {
        let of_law = strikes(Some(law));
        let part = free(Some(law), &of_law)? / reference;
        let step = if part == 1.0 {
            common.step
        } else {
            let most = common.step * part;
            let durations: Vec<f64> = of_law.iter().filter_map(Strike::duration).collect();
            dividing(most * (1.0 + 1e-9), &durations).unwrap_or(most)
        };
        // A step that is chosen is stable under its law; one that follows from a given step may not be.
        under_law(design, Some(law), &of_law, Overrides { step: Some(step), ..overrides }, palette)?;
        if step != common.step {
            common.step_reason += &format!("; under {law} {}", Time.show(step));
            common.own_steps.push((law, step));
        }
    }
    Ok(common)
}

/// Step and window for what strikes under one law, or the design's.
fn under_law(
    design: DesignRef<'_>,
    law: Option<LawKind>,
    strikes: &[Strike],
    overrides: Overrides,
    palette: &[Material],
) -> Result<Plan, PlanError> {
    let law = law.unwrap_or(design.law());
    let under = |impact: Strike| match design {
        DesignRef::Plane(design) => Plan::new(&Design { impact, law, ..design.clone() }, overrides, palette),
        DesignRef::Space(design) => Plan::in_space(&Design { impact, law, ..design.clone() }, overrides, palette),
    };
    let mut common: Option<Plan> = None;
    for &strike in strikes {
        let plan = under(strike)?;
        let Some(common) = &mut common else {
            common = Some(plan);
            continue;
        };
        if plan.step < common.step {
            (common.step, common.step_reason) = (plan.step, plan.step_reason);
        }
        if plan.window > common.window {
            (common.window, common.window_reason) = (plan.window, plan.window_reason);
        }
        for warning in plan.warnings {
            if !common.warnings.contains(&warning) {
                common.warnings.push(warning);
            }
        }
    }
    common.map_or_else(|| under(design.impact()), Ok)
}

impl Plan {
    /// The step under one of the laws (s).
    pub fn step_under(&self, law: LawKind) -> f64 {
        self.own_steps.iter().find(|(known, _)| *known == law).map_or(self.step, |(_, step)| *step)
    }

    /// Chooses what is not given. `materials` are all that occur in any arrangement.
    ///
    /// An automatic step is the largest that meets the accuracy class and divides the pulse.
    ///
    /// # Errors
    /// See [`PlanError`].
    pub fn new(design: &Design, overrides: Overrides, materials: &[Material]) -> Result<Self, PlanError> {
        let lattice = &design.lattice;
        let far = design.target.focal_rows()[1].max(design.target.protect.rows[1]);
        let ground = Ground {
            dimension: dimension_of(lattice),
            diameter: lattice.diameter(),
            diameters: lattice.diameters(),
            row: "rows",
            depth: lattice.depth(f64::from(far + MARGIN)),
        };
        Self::on(ground, design, overrides, materials)
    }

    /// The same of a design in space.
    ///
    /// # Errors
    /// See [`PlanError`].
    pub fn in_space(design: &SpaceDesign, overrides: Overrides, materials: &[Material]) -> Result<Self, PlanError> {
        let (block, target) = (&design.lattice, &design.target);
        let solids = target.foci.iter().map(|focus| &focus.region).chain([&target.protect]);
        let last = solids.map(|solid| solid.layers(block.layer_spacing(), block.layers())[1]).max().unwrap_or(1);
        let ground = Ground {
            dimension: Dimension::Three,
            diameter: block.diameter(),
            diameters: vec![block.diameter()],
            row: "layers",
            depth: f64::from(last - 1 + MARGIN) * block.layer_spacing(),
        };
        Self::on(ground, design, overrides, materials)
    }

    fn on<L, R>(
        ground: Ground,
        design: &Design<L, R>,
        overrides: Overrides,
        materials: &[Material],
    ) -> Result<Self, PlanError> {
        // Friction is a rig's, and rigs are advanced with Verlet.
        let integrator = match design.friction {
            Some(_) => Integrator::Verlet,
            None => overrides.integrator.unwrap_or(design.integrator),
        };
        let Ground { dimension, diameter, diameters, row, depth } = ground;
        let force = overshoot(design.law)
            * match design.impact {
                Strike::Pulse(pulse) => dimension.contact_force(pulse.force),
                // The flat meets each sphere in one contact, which bears all of it.
                Strike::Projectile(_) => {
                    let driving = materials.iter().map(|material| struck_force(design, dimension, material, diameter));
                    driving.fold(0.0, f64::max)
                }
            };
        // Each material in each size.
        let kinds: Vec<(Material, f64)> =
            diameters.iter().flat_map(|&d| materials.iter().map(move |material| (material.clone(), d))).collect();
        let (made_of, wide): (Vec<Material>, Vec<f64>) = kinds.into_iter().unzip();
        let stiffness = |a: usize, b: usize| {
            let radii = [0.5 * wide[a], 0.5 * wide[b]];
            let pair = Pair::new([&made_of[a], &made_of[b]], radii, design.constants);
            AnyLaw::new(design.law, &pair).stiffness_max(force)
        };
        let stiffest = match dimension {
            Dimension::Three => Stiffest::find::<3>(&made_of, |k| wide[k], force, stiffness),
            _ => Stiffest::find::<2>(&made_of, |k| wide[k], force, stiffness),
        };
        let divisor = divisor(design.accuracy, integrator);
        let accurate = stiffest.limit / divisor;
        let class = Fraction.show(design.accuracy.fraction());
        let limit = stiffest.words();
        let mut warnings = design.notes.clone();
        let pulse = design.impact.duration();
        let (step, step_reason) = match overrides.step.or(design.step) {
            Some(step) if step > integrator.stability() * stiffest.limit => {
                let Stiffest { names, stiffness, limit, .. } = stiffest;
                let limit = integrator.stability() * limit;
                return Err(PlanError::Step { step, limit, accurate, contact: names, stiffness });
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
                let most = pulse.map_or(accurate, |pulse| accurate.min(pulse / IN_PULSE));
                let step = pulse.and_then(|pulse| dividing(most, &[pulse])).unwrap_or(most);
                let cut = pulse.map_or(String::new(), |pulse| format!(", {:.0} steps in the pulse", pulse / step));
                (step, format!("{class} class: {limit} over {divisor}{cut}"))
            }
        };
        let speed = |m: &Material| wave::bound(dimension, [m, m], diameter, design.constants).speed;
        let slowest = materials.iter().min_by(|a, b| speed(a).total_cmp(&speed(b))).unwrap_or(&design.host);
        let chosen = crate::target::window(depth, speed(slowest));
        let formula = format!(
            "(depth of the regions' far edge + {MARGIN} {row})/({:.0} m/s, {}) + 120 us",
            speed(slowest),
            slowest.name
        );
        let (window, window_reason) = match overrides.window.or(design.window) {
            Some(window) if pulse.is_some_and(|pulse| window <= pulse) => {
                return Err(PlanError::Window { window, pulse: pulse.unwrap_or_default() });
            }
            Some(window) => (window, format!("given; the formula {formula} gives {}", Time.show(chosen))),
            None => (chosen, formula),
        };
        let first_seed = overrides.first_seed.unwrap_or(design.first_seed);
        Ok(Self { integrator, step, step_reason, own_steps: Vec::new(), window, window_reason, first_seed, warnings })
    }
}
