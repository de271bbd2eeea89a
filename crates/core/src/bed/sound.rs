//! How fast a push travels through a bed (Kondic et al. 2012, section II).

use super::measure::surface;
use super::settle::STEP;
use super::{Bed, Grains};
use crate::Context;
use crate::dem::rig::{Body, Curve, Load, LoadKind, RigError, RigStop, Simulation};

/// A bed in which no sound speed was found.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SoundError {
    /// The rig cannot be set in motion.
    #[error(transparent)]
    Rig(#[from] RigError),
    /// A guard or the caller stopped it.
    #[error(transparent)]
    Stop(#[from] RigStop),
    /// The push did not reach the bottom.
    #[error("the push did not reach the bottom of the bed within {0:.0} tau_c")]
    Unheard(f64),
    /// There is no grain to push.
    #[error("the bed has no grains")]
    Empty,
}

/// The push, in weights of a mean grain: small against what the bed carries at the bottom.
const PUSH: f64 = 10.0;
/// A change of the force on the bottom counts as heard from this part of its greatest on.
const HEARD: f64 = 0.05;

/// Steps between two looks at the bottom.
const LOOK: u64 = 5;

/// A push on the top grain in the middle, and what of it reached the bottom.
#[derive(Clone, Debug, PartialEq)]
pub struct Sound {
    /// Height of the surface where it was pushed over the time of arrival (d/τ_c).
    pub speed: f64,
    /// When the force on the bottom first reached 5 % of the greatest that the push makes there (τ_c from the push).
    pub arrival: f64,
    /// Time (τ_c) and by how much the force on the bottom differs from that of the same bed left alone (m d/τ_c²).
    pub bottom: Vec<[f64; 2]>,
}

/// Pushes the top grain in the middle of a bed at rest and listens at its bottom.
///
/// # Errors
/// See [`SoundError`].
pub fn listen(bed: &Bed, grains: &Grains, context: &Context) -> Result<Sound, SoundError> {
    let middle = 0.5 * bed.width;
    let near = |x: f64| (x - middle).abs() < 1.0;
    let top = (0..bed.grains.len())
        .filter(|&i| near(bed.grains[i].centre[0]))
        .max_by(|&a, &b| bed.grains[a].centre[1].total_cmp(&bed.grains[b].centre[1]))
        .ok_or(SoundError::Empty)?;
    let height = surface(bed, middle);
    let push = PUSH * grains.fall();
    let bottom = |pushed: bool| -> Result<Vec<f64>, SoundError> {
        let mut rig = grains.rig(bed, true);
        if pushed {
            let curve = Curve::Square { peak: push, start: 0.0, duration: 1e9 };
            let bodies = vec![Body::Sphere(top)];
            rig.loads = vec![Load { bodies, direction: [0.0, -1.0], kind: LoadKind::Force, curve }];
        }
        let walls = bed.grains.len()..bed.grains.len() + bed.walls.len();
        let mut simulation = Simulation::new(rig, STEP)?;
        let mut forces = Vec::new();
        // Slow beds carry sound at about one diameter a unit of time.
        for _ in 0..(1.5 * height / (LOOK as f64 * STEP)) as usize {
            simulation.advance(LOOK, context)?;
            forces.push(walls.clone().map(|i| simulation.view().net_force(i)[1]).sum());
        }
        Ok(forces)
    };
    // Against the same bed left alone, so that its own creeping is not heard.
    let (pushed, alone) = (bottom(true)?, bottom(false)?);
    let bottom: Vec<[f64; 2]> = (pushed.iter().zip(&alone).enumerate())
        .map(|(k, (a, b))| [(k + 1) as f64 * LOOK as f64 * STEP, (a - b).abs()])
        .collect();
    let most = bottom.iter().map(|[_, change]| *change).fold(0.0, f64::max);
    match bottom.iter().find(|[_, change]| *change >= HEARD * most) {
        Some(&[arrival, _]) if most > 1e-3 * push => Ok(Sound { speed: height / arrival, arrival, bottom }),
        _ => Err(SoundError::Unheard(1.5 * height)),
    }
}
