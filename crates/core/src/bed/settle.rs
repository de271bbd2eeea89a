//! How a bed comes to rest.
//!
//! With kinetic friction a bed creeps for ever, so it settles without friction and with a little drag, which decides nothing
//! about where the grains end: friction is restored for the impact.

use super::measure::surface;
use super::{Bed, Disk, Grains, Pile};
use crate::dem::rig::{RigError, RigStop, Simulation};
use crate::{Context, Progress};

/// A bed at rest, and how it came there.
#[derive(Clone, Debug, PartialEq)]
pub struct Settled {
    /// The bed.
    pub bed: Bed,
    /// How long it took (τ_c).
    pub time: f64,
    /// Grains taken away as they stood out of the surface.
    pub smoothed: usize,
}

/// A bed that did not come to rest.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SettleError {
    /// The rig cannot be set in motion.
    #[error(transparent)]
    Rig(#[from] RigError),
    /// A guard stopped it, or the caller.
    #[error(transparent)]
    Stop(#[from] RigStop),
    /// It still moves after a long time.
    #[error("after {time:.0} tau_c the bed still has a kinetic energy of {kinetic:.1e} m g d, above {STILL:.0e}")]
    Restless {
        /// How long was waited (τ_c).
        time: f64,
        /// What was left (m g d).
        kinetic: f64,
    },
}

/// A bed is at rest when its kinetic energy is below this part of m g d (Kondic et al. 2012).
const STILL: f64 = 1e-10;
/// The step of an impact (τ_c): 1/50 of a collision.
pub(super) const STEP: f64 = 0.02;
/// The step while a bed settles (τ_c): on the way only stability counts, and at rest forces balance whatever the step.
const SETTLING: f64 = 0.06;
/// Steps between two looks at the kinetic energy.
const LOOK: u64 = 200;
/// Longest wait (τ_c).
const PATIENCE: f64 = 50_000.0;
/// Drag per mass (1/τ_c): falling grains reach g/drag = 0.06 in the default bed.
const DRAG: f64 = 0.02;
/// Grains whose top stands out of the local surface by more than this (d) are taken away.
const ROUGH: f64 = 0.5;

/// Lets a pile settle, smooths its surface and lets it settle again. The context hears of it ([`Progress::Settling`]).
///
/// # Errors
/// See [`SettleError`].
pub fn settle(pile: &Pile, grains: &Grains, context: &Context) -> Result<Settled, SettleError> {
    let (bed, velocities) = pile.lay();
    let mut time = 0.0;
    let mut bed = rest(bed, &velocities, grains, context, &mut time)?;
    let before = bed.grains.len();
    let width = bed.width;
    let local: Vec<f64> = (0..width.ceil() as usize).map(|k| surface(&bed, k as f64 + 0.5)).collect();
    bed.grains.retain(|Disk { centre: [x, y], diameter }| {
        let level = local[(x.rem_euclid(width) as usize).min(local.len() - 1)];
        y + 0.5 * diameter < level + ROUGH
    });
    let smoothed = before - bed.grains.len();
    if smoothed > 0 {
        let still = vec![[0.0; 2]; bed.grains.len()];
        bed = rest(bed, &still, grains, context, &mut time)?;
    }
    Ok(Settled { bed, time, smoothed })
}

/// Follows a bed until it is at rest.
fn rest(
    bed: Bed,
    velocities: &[[f64; 2]],
    grains: &Grains,
    context: &Context,
    time: &mut f64,
) -> Result<Bed, SettleError> {
    let mut rig = grains.rig(&bed, false);
    rig.velocity[..velocities.len()].copy_from_slice(velocities);
    rig.drag = DRAG;
    let unit = grains.fall();
    let begun = *time;
    let mut simulation = Simulation::new(rig, SETTLING)?;
    loop {
        simulation.advance(LOOK, context)?;
        *time = begun + simulation.time();
        let kinetic = simulation.ledger().kinetic / unit;
        context.tell(Progress::Settling { time: *time, kinetic });
        if kinetic < STILL {
            break;
        }
        if *time > PATIENCE {
            return Err(SettleError::Restless { time: *time, kinetic });
        }
    }
    let view = simulation.view();
    let grains = (bed.grains.iter().enumerate())
        .map(|(i, disk)| {
            let [x, y] = view.position(i);
            Disk { centre: [if bed.periodic { x.rem_euclid(bed.width) } else { x }, y], ..*disk }
        })
        .collect();
    Ok(Bed { grains, ..bed })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bed::{Packing, Sides, measure};

    /// A small bed settles, and at rest every grain's weight is carried: the wall's force would be Σ m g, so the volume
    /// fraction is that of a dense packing and nothing moves.
    #[test]
    fn a_small_bed_comes_to_rest() {
        let go = Context::default();
        let pile =
            Pile { packing: Packing::Random, width: 20.0, height: 15.0, spread: 0.2, seed: 5, sides: Sides::Periodic };
        let grains = Grains { stiffness: 400.0, ..Grains::default() };
        let settled = settle(&pile, &grains, &go).unwrap();
        assert!(settled.bed.grains.len() + settled.smoothed == 300 && settled.smoothed < 30);
        let measures = measure(&settled.bed);
        assert!((0.8..0.92).contains(&measures.volume_fraction), "{measures:?}");
        assert!((3.5..5.0).contains(&measures.coordination), "{}", measures.coordination);
        // Held up: the net force on every grain is a small part of its weight.
        let rig = grains.rig(&settled.bed, false);
        let simulation = Simulation::new(rig, STEP).unwrap();
        for i in 0..settled.bed.grains.len() {
            let [x, y] = simulation.view().net_force(i);
            let weight = simulation.rig().mass[i] * grains.fall();
            assert!(x.hypot(y - weight) < 1e-3 * weight, "grain {i}: {x} {y} {weight}");
        }
    }
}
