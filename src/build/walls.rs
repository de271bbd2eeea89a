//! What the frame's walls change, by simulation: the whole piece between walls, beside the half between its mirrors.
//!
//! A mirror line cuts through the outermost spheres of every other row; a wall cannot, and touches these spheres from outside. Rows
//! between end half a diameter before it. Both are simulated as rigs that find their contacts, so that nothing but the walls differs.

use std::sync::atomic::AtomicBool;

use serde::Serialize;

use crate::dem::rig::{
    Body, Curve, Face, Flat, Friction, Law, LawBook, Load, LoadKind, Rig, RigError, RigStop, Simulation,
};
use crate::dem::steps_in;
use crate::design::Design;
use crate::evaluate::Plan;
use crate::layout::{Layout, whole};
use crate::sample::{Sample, Sphere};
use crate::score::{means, ratio};

/// F, P and C of one way of holding the piece.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct WallEffect {
    /// What holds it, in words.
    pub held: &'static str,
    /// F (J)
    #[serde(rename = "focal_mean_J")]
    pub focal_mean: f64,
    /// P (J)
    #[serde(rename = "protected_mean_J")]
    pub protected_mean: f64,
    /// C = F/P
    pub contrast: Option<f64>,
}

/// A piece in walls that cannot be simulated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum WallError {
    /// It cannot be set in motion.
    #[error(transparent)]
    Rig(#[from] RigError),
    /// A guard stopped it, or the caller.
    #[error("{0}")]
    Stopped(RigStop),
}

/// The piece between side walls, and with an end wall too; then as it was designed, between mirrors and with a free end.
///
/// # Errors
/// See [`WallError`].
pub fn in_walls(
    design: &Design,
    layout: &Layout,
    plan: &Plan,
    interrupt: &AtomicBool,
) -> Result<Vec<WallEffect>, WallError> {
    let mut ways = [
        ("mirrors, end free", false, false),
        ("side walls, end free", true, false),
        ("side walls and end wall", true, true),
    ]
    .map(|(held, sides, end)| (held, sides, end, Err(WallError::Stopped(RigStop::Interrupted { time: 0.0 }))));
    rayon::scope(|scope| {
        for (_, sides, end, result) in &mut ways {
            let (sides, end) = (*sides, *end);
            scope.spawn(move |_| *result = simulated(design, layout, plan, [sides, end], interrupt));
        }
    });
    ways.into_iter()
        .map(|(held, _, _, result)| {
            let [focal_mean, protected_mean] = means(&result?, &design.lattice, &design.target);
            Ok(WallEffect { held, focal_mean, protected_mean, contrast: ratio(focal_mean, protected_mean) })
        })
        .collect()
}

/// Greatest kinetic energy by site of the half (J), the mean of a sphere and its image.
fn simulated(
    design: &Design,
    layout: &Layout,
    plan: &Plan,
    [sides, end]: [bool; 2],
    interrupt: &AtomicBool,
) -> Result<Vec<f64>, WallError> {
    let radius = 0.5 * layout.lattice.diameter();
    let mut spheres = whole(layout);
    let half_width = layout.lattice.half_width();
    if !sides {
        // What repeats itself after twice the half width moves as between mirrors; a sphere on the far one is then its own image.
        spheres.retain(|sphere| sphere.x > 1e-9 * radius - half_width);
    }
    let mut rig = Rig::new(
        Sample {
            materials: layout.palette.clone(),
            spheres: spheres
                .iter()
                .map(|sphere| Sphere { centre: [sphere.x, sphere.z], radius, material: usize::from(sphere.material) })
                .collect(),
        },
        LawBook::Materials {
            law: Law::Named(design.law),
            constants: design.constants,
            pairs: Vec::new(),
            friction: design.friction.map(Friction::mindlin),
        },
    );
    let wall = |name: &str, point: [f64; 2], normal: [f64; 2]| Flat {
        name: name.to_owned(),
        point,
        normal,
        face: Face::Plane,
        mass: f64::INFINITY,
        velocity: [0.0; 2],
        held: [true; 2],
    };
    if sides {
        let far = spheres.iter().map(|sphere| sphere.x).fold(0.0, f64::max) + radius;
        rig.flats.push(wall("left", [-far, 0.0], [1.0, 0.0]));
        rig.flats.push(wall("right", [far, 0.0], [-1.0, 0.0]));
    } else {
        rig.periods[0] = Some(2.0 * half_width);
    }
    if end {
        let deep = spheres.iter().map(|sphere| sphere.z).fold(0.0, f64::max) + radius;
        rig.flats.push(wall("end", [0.0, deep], [0.0, -1.0]));
    }
    rig.loads.push(Load {
        bodies: (0..spheres.len()).filter(|&i| spheres[i].row == 1).map(Body::Sphere).collect(),
        direction: [0.0, 1.0],
        kind: LoadKind::Force,
        curve: Curve::Square { peak: design.impact.force, start: 0.0, duration: design.impact.duration },
    });
    let mass = rig.mass.clone();
    let mut simulation = Simulation::new(rig, plan.step)?.watching(Vec::new());
    simulation.advance(steps_in(plan.window, plan.step), interrupt).map_err(WallError::Stopped)?;
    let speed = simulation.greatest_speed();
    let mut energy = vec![[0.0, 0.0]; layout.materials.len()];
    for (k, sphere) in spheres.iter().enumerate() {
        let [sum, count] = &mut energy[sphere.site];
        *sum += 0.5 * mass[k] * speed[k] * speed[k];
        *count += 1.0;
    }
    Ok(energy.into_iter().map(|[sum, count]| sum / count).collect())
}
