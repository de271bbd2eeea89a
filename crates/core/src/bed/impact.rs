//! What follows when an intruder strikes a bed.

use std::sync::atomic::AtomicBool;

use serde::{Deserialize, Serialize};

use super::measure::surface;
use super::{Bed, Disk, Grains, Intruder, Outline};
use crate::dem::rig::{EnergyLedger, Face, RigError, RigStop, Simulation};

/// An impact on a bed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BedImpact {
    /// The grains.
    pub grains: Grains,
    /// What strikes them.
    pub intruder: Intruder,
    /// Where, as a part of the width.
    pub place: f64,
    /// How long it is followed (τ_c).
    pub window: f64,
    /// The step (τ_c).
    pub step: f64,
    /// How often it is looked at (τ_c); at least a step.
    pub sample: f64,
}

impl BedImpact {
    /// The intruder over the middle of the bed, for so long (τ_c), with the usual step for a spread of diameters of 0.2.
    pub fn new(grains: Grains, intruder: Intruder, window: f64) -> Self {
        Self { grains, intruder, place: 0.5, window, step: grains.step(0.8), sample: 0.5 }
    }
}

/// A moment of an impact.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Moment {
    /// Time (τ_c).
    pub time: f64,
    /// D, depth of the intruder's lowest point below the surface before the impact (d).
    pub depth: f64,
    /// Its velocity (d/τ_c), sideways and up.
    pub velocity: [f64; 2],
    /// By how much it has turned (rad) or, for a single disk, its spin (1/τ_c).
    pub turn: f64,
    /// Force of the grains on it (m d/τ_c²).
    pub force: [f64; 2],
    /// Where the energy is and went, of grains and intruder (m d²/τ_c²).
    pub energy: EnergyLedger,
}

/// The bed at one moment.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Snapshot {
    /// Time (τ_c).
    pub time: f64,
    /// Centre of each grain (d).
    pub centres: Vec<[f64; 2]>,
    /// Sum of the normal forces on each grain (m d/τ_c²).
    pub force: Vec<f64>,
    /// The disks of which the intruder is made; of a flat its two ends, without width.
    pub intruder: Vec<Disk>,
}

/// The course of an impact.
#[derive(Clone, Debug, PartialEq)]
pub struct Course {
    /// From the start on.
    pub moments: Vec<Moment>,
    /// Mean depth over the last third, at most 100 τ_c (d).
    pub final_depth: f64,
    /// Standard deviation of the depth there (d).
    pub final_swing: f64,
    /// Greatest depth (d).
    pub max_depth: f64,
    /// Greatest force of the grains on the intruder (m d/τ_c²), and when (τ_c).
    pub peak_force: [f64; 2],
    /// Where each grain ended (d).
    pub grains: Vec<[f64; 2]>,
    /// Greatest normal force on each grain during the impact, as sampled (m d/τ_c²).
    pub grain_force: Vec<f64>,
    /// The bed when the force on the intruder was greatest.
    pub snapshot: Snapshot,
    /// Why the run ended early, if so.
    pub stop: Option<RigStop>,
}

impl Course {
    /// By how much the intruder went deeper than it stayed (d).
    pub fn overshoot(&self) -> f64 {
        self.max_depth - self.final_depth
    }
}

/// Why a guard stopped a run on a bed, its times in the units of beds.
pub fn stop_words(stop: &RigStop) -> String {
    stop.words("tau_c", &|body| body.to_string())
}

/// Follows an impact. `progress` hears each moment.
///
/// # Errors
/// The rig cannot be set in motion. A run that a guard stops is no error: its course says why.
pub fn strike(
    bed: &Bed,
    impact: &BedImpact,
    interrupt: &AtomicBool,
    mut progress: impl FnMut(&Moment),
) -> Result<Course, RigError> {
    let BedImpact { grains, intruder, .. } = impact;
    let x = impact.place * bed.width;
    let level = surface(bed, x);
    let mut rig = grains.rig(bed, true);
    let members = rig.sample.spheres.len();
    intruder.place(&mut rig, x, level);
    let mut simulation = Simulation::new(rig, impact.step)?;
    let every = ((impact.sample / impact.step).round() as u64).max(1);
    let steps = (impact.window / impact.step).round() as u64;
    let look = |simulation: &Simulation<2>| {
        let view = simulation.view();
        let start = level + intruder.height;
        let (moved, velocity, turn, force) = match intruder.outline {
            Outline::Disk { .. } => {
                let moved = view.displacement(members)[1];
                (moved, view.velocity(members), view.spin(members)[2], view.net_force(members))
            }
            Outline::Flat { .. } => {
                let flat = view.flat(0);
                (flat.moved[1], flat.velocity, 0.0, flat.force)
            }
            Outline::Ellipse { .. } | Outline::Ogive { .. } => {
                let state = view.cluster(0);
                // The lowest point changes as it turns.
                let low = (members..simulation.rig().mass.len())
                    .map(|i| view.position(i)[1] - simulation.rig().sample.spheres[i].radius)
                    .fold(f64::INFINITY, f64::min);
                (low - start, state.velocity, state.angle, state.force)
            }
        };
        let depth = level - (start + moved);
        Moment { time: simulation.time(), depth, velocity, turn, force, energy: simulation.ledger() }
    };
    let mut moments = vec![look(&simulation)];
    let mut grain_force = vec![0.0_f64; bed.grains.len()];
    let (mut peak_force, mut snapshot) = ([0.0, 0.0], Snapshot::default());
    let mut stop = None;
    while simulation.steps() < steps && stop.is_none() {
        stop = simulation.advance(every.min(steps - simulation.steps()), interrupt).err();
        let moment = look(&simulation);
        progress(&moment);
        let size = moment.force[0].hypot(moment.force[1]);
        let view = simulation.view();
        let mut pushed = view.pressed();
        pushed.truncate(bed.grains.len());
        if size > peak_force[0] {
            peak_force = [size, moment.time];
            snapshot = Snapshot {
                time: moment.time,
                centres: (0..bed.grains.len()).map(|i| view.position(i)).collect(),
                force: pushed.clone(),
                intruder: disks(&simulation, members),
            };
        }
        for (most, now) in grain_force.iter_mut().zip(pushed) {
            *most = most.max(now);
        }
        moments.push(moment);
    }
    let end = moments[moments.len() - 1].time;
    let tail = (end / 3.0).min(100.0);
    let last: Vec<f64> = moments.iter().filter(|m| m.time >= end - tail).map(|m| m.depth).collect();
    let mean = last.iter().sum::<f64>() / last.len() as f64;
    let swing = (last.iter().map(|d| (d - mean) * (d - mean)).sum::<f64>() / last.len() as f64).sqrt();
    let max_depth = moments.iter().map(|m| m.depth).fold(f64::NEG_INFINITY, f64::max);
    let view = simulation.view();
    let grains = (0..bed.grains.len()).map(|i| view.position(i)).collect();
    Ok(Course {
        moments,
        final_depth: mean,
        final_swing: swing,
        max_depth,
        peak_force,
        grains,
        grain_force,
        snapshot,
        stop,
    })
}

/// The disks that make up the intruder; the ends of a flat.
fn disks(simulation: &Simulation<2>, members: usize) -> Vec<Disk> {
    let (view, rig) = (simulation.view(), simulation.rig());
    if let Some(Face::Polygon(corners)) = rig.flats.first().map(|flat| &flat.face) {
        let moved = view.flat(0).moved;
        return corners.iter().map(|[x, y]| Disk { centre: [x + moved[0], y + moved[1]], diameter: 0.0 }).collect();
    }
    let disk = |i: usize| Disk { centre: view.position(i), diameter: 2.0 * rig.sample.spheres[i].radius };
    (members..rig.mass.len()).map(disk).collect()
}
