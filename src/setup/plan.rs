//! The section [run]: step, window, and why.

use super::file::RunFile;
use crate::contact::{AnyLaw, Dashpot, History, NormalLaw, Pair};
use crate::dem::Integrator;
use crate::dem::rig::{Law, LawBook, LoadKind, Rig};
use crate::design::Accuracy;
use crate::document::{DocumentError, Scope};
use crate::evaluate::{Stiffest, divisor, overshoot};
use crate::material::Material;
use crate::units::Dimension;

/// How a rig is run.
#[derive(Clone, Debug, PartialEq)]
pub struct RunPlan {
    /// The step (s).
    pub step: f64,
    /// Why this step.
    pub step_reason: String,
    /// How long the run lasts (s).
    pub window: f64,
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

/// An automatic step cuts the shortest pulse into at least so many.
const IN_PULSE: f64 = 20.0;

/// Reads [run]: also drag, whether the rig is squeezed, and the domain are put into `rig`, whose first `crystal` spheres are those
/// of the crystal.
pub(super) fn plan<const D: usize>(
    rig: &mut Rig<D>,
    (diameter, crystal): (f64, usize),
    scope: &Scope,
    file: &RunFile,
) -> Result<RunPlan, DocumentError> {
    let window = scope.required("window", &file.window)?;
    let length = window.positive(Dimension::Time)?;
    if let Some(entry) = scope.optional("drag", &file.drag) {
        rig.drag = entry.quantity(Dimension::Rate)?;
        if rig.drag < 0.0 {
            return Err(entry.refuse("must not be negative"));
        }
    }
    if let Some(entry) = scope.optional("squeezed", &file.squeezed) {
        rig.squeezed = entry.yes()?;
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
    let stiffest = stiffest(rig, crystal);
    let accurate = stiffest.limit / divisor(accuracy, Integrator::Verlet);
    let class = Dimension::Fraction.show(accuracy.fraction());
    let mut warnings = Vec::new();
    let (step, step_reason) = match scope.optional("step", &file.step) {
        Some(entry) => {
            let step = entry.positive(Dimension::Time)?;
            if step > length {
                return Err(entry.fail("is longer than run.window", "Shorten it, or leave it out to have it chosen."));
            }
            if step > accurate * (1.0 + 1e-9) {
                let (step, accurate) = (Dimension::Time.show(step), Dimension::Time.show(accurate));
                warnings.push(format!(
                    "a step of {step} may miss the {class} class, for which {accurate} would be chosen; halve it and compare"
                ));
            }
            (step, format!("given; {}", stiffest.words()))
        }
        None => {
            let pulse = shortest_pulse(rig) / IN_PULSE;
            // Steps that fill the window.
            let step = length / (length / accurate.min(pulse).min(length)).ceil();
            let reason = if pulse < accurate {
                format!("a {IN_PULSE}th of the shortest pulse")
            } else {
                format!("{class} class: {} over {}", stiffest.words(), divisor(accuracy, Integrator::Verlet))
            };
            (step, reason)
        }
    };
    if length / step > MOST_STEPS {
        return Err(window.fail("would take more than 1e12 steps", "Check its unit, and that of run.step."));
    }
    Ok(RunPlan { step, step_reason, window: length, warnings })
}

/// The shortest force or velocity pulse (s).
fn shortest_pulse<const D: usize>(rig: &Rig<D>) -> f64 {
    use crate::dem::rig::Curve;
    let duration = |curve: &Curve| match curve {
        Curve::Square { duration, .. } | Curve::HalfSine { duration, .. } | Curve::Triangle { duration, .. } => {
            *duration
        }
        // Its points are as dense as it needs; the mean over each step is exact.
        Curve::Table(_) | Curve::Path(_) => f64::INFINITY,
    };
    let bars = rig.bars.iter().filter_map(|bar| bar.incident.as_ref());
    rig.loads.iter().map(|load| &load.curve).chain(bars).map(duration).fold(f64::INFINITY, f64::min)
}

/// The stiffest contact that is to be expected: after the greatest force on a sphere, or after a sphere has been run into at
/// twice the greatest speed, by a body that does not give way. An intruder, however heavy, presses no harder than that.
fn stiffest<const D: usize>(rig: &Rig<D>, crystal: usize) -> Stiffest {
    let LawBook::Materials { law, constants, pairs, .. } = &rig.laws else {
        // Rig files name laws by materials.
        return Stiffest { names: "dashpot".to_owned(), stiffness: 0.0, force: 0.0, limit: f64::INFINITY };
    };
    let magnitude = |v: &[f64; D]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
    let loads = |kind| rig.loads.iter().filter(move |load| load.kind == kind).map(|load| load.curve.peak());
    let bars = || rig.bars.iter().filter_map(|bar| Some((bar.impedance, bar.incident.as_ref()?.peak())));
    let speed = rig
        .velocity
        .iter()
        .map(magnitude)
        .chain(rig.flats.iter().map(|flat| magnitude(&flat.velocity)))
        .chain(loads(LoadKind::Velocity))
        .chain(bars().map(|(impedance, force)| 2.0 * force / impedance))
        .fold(0.0, f64::max);
    let given = loads(LoadKind::Force).chain(bars().map(|(_, force)| 2.0 * force)).fold(0.0, f64::max);

    // Kinds of spheres: each material with the smallest sphere made of it, which is the stiffest for its mass.
    let materials: &[Material] = &rig.sample.materials;
    let radius = |material: usize| {
        let spheres = rig.sample.spheres.iter().filter(|sphere| sphere.material == material);
        let least = spheres.map(|sphere| sphere.radius).fold(f64::INFINITY, f64::min);
        // What the palette holds and no sphere is made of has no say.
        if least.is_finite() { least } else { 1e3 }
    };
    let between = |a: usize, b: usize| -> Box<dyn NormalLaw> {
        let named = pairs.iter().find(|(pair, _)| *pair == [a, b] || *pair == [b, a]).map_or(law, |(_, law)| law);
        match named {
            Law::Named(kind) => {
                let pair = Pair::new([&materials[a], &materials[b]], [radius(a), radius(b)], *constants);
                Box::new(AnyLaw::new(*kind, &pair))
            }
            Law::Tabulated(table) => Box::new((**table).clone()),
            Law::SpringDashpot(law) => Box::new(Dashpot { stiffness: law.stiffness, damping: 0.0, cut: true }),
        }
    };
    let factor = match law {
        Law::Named(kind) => overshoot(*kind),
        Law::Tabulated(_) | Law::SpringDashpot(_) => overshoot(crate::contact::LawKind::Hertz),
    };
    let mut force = factor * given;
    for a in 0..materials.len() {
        let mass = materials[a].sphere_mass(2.0 * radius(a));
        let in_crystal = rig.sample.spheres[..crystal].iter().any(|sphere| sphere.material == a);
        if in_crystal && speed > 0.0 {
            force = force.max(collision_force(&*between(a, a), mass, 2.0 * speed, radius(a)));
        }
    }
    Stiffest::find::<D>(materials, |a| 2.0 * radius(a), force, |a, b| between(a, b).stiffness_max(force))
}

/// The force at which a contact has taken up ½ m v² of a sphere of mass `mass` (kg) that comes at `speed` (m/s), at most that
/// at an overlap of half its radius.
fn collision_force(law: &dyn NormalLaw, mass: f64, speed: f64, radius: f64) -> f64 {
    let parts = 1000;
    let width = 0.5 * radius / f64::from(parts);
    let (mut left, mut force) = (0.5 * mass * speed * speed, 0.0);
    for k in 0..parts {
        force = law.force((f64::from(k) + 0.5) * width, speed, &History::new());
        left -= force * width;
        if left <= 0.0 {
            break;
        }
    }
    force
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::contact::{Constants, LawKind};
    use crate::material::find;

    /// ½ m v² = (2/5) k δ^{5/2}: F = k (5 m v²/4k)^{3/5} (Johnson 1985, section 11.4); a thousand parts to half a radius
    /// resolve the overlap, 2 % of the radius, to 1/40 and the force to 1.5 times that.
    #[test]
    fn the_force_of_a_collision_is_that_of_hertz() {
        let steel = find("440c", &[]).unwrap();
        let (radius, speed) = (3e-3, 20.0);
        let pair = Pair::new([&steel, &steel], [radius; 2], Constants::default());
        let mass = steel.sphere_mass(2.0 * radius);
        let k = pair.hertz_coefficient();
        let exact = k * (5.0 * mass * speed * speed / (4.0 * k)).powf(0.6);
        let found = collision_force(&AnyLaw::new(LawKind::Hertz, &pair), mass, speed, radius);
        assert!((found / exact - 1.0).abs() < 0.04, "{found} {exact}");
    }
}
