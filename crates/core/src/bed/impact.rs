//! What follows when an intruder strikes a bed.

use serde::{Deserialize, Serialize};

use super::measure::surface;
use super::{Bed, Disk, Frame, Grains, Intruder, Outline};
use crate::Context;
use crate::dem::CheckpointError;
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
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
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
    context: &Context,
    mut progress: impl FnMut(&Moment),
) -> Result<Course, RigError> {
    let mut strike = Strike::new(bed, impact)?;
    while strike.goes_on() {
        strike.go_on(context);
        progress(strike.moment());
    }
    Ok(strike.course())
}

/// An impact on its way.
pub struct Strike {
    impact: BedImpact,
    simulation: Simulation<2>,
    /// Height of the surface (d).
    level: f64,
    /// Grains and walls; the disks of the intruder stand behind both.
    count: [usize; 2],
    seen: Seen,
    stop: Option<RigStop>,
}

/// What was looked at so far.
#[derive(Clone, Debug, Default, Serialize, Deserialize)]
struct Seen {
    moments: Vec<Moment>,
    grain_force: Vec<f64>,
    peak_force: [f64; 2],
    snapshot: Snapshot,
}

impl Strike {
    /// Sets the intruder above the bed.
    ///
    /// # Errors
    /// The rig cannot be set in motion.
    pub fn new(bed: &Bed, impact: &BedImpact) -> Result<Self, RigError> {
        let BedImpact { grains, intruder, .. } = impact;
        let x = impact.place * bed.width;
        let level = surface(bed, x);
        let mut rig = grains.rig(bed, true);
        intruder.place(&mut rig, x, level);
        let simulation = Simulation::new(rig, impact.step)?;
        let count = [bed.grains.len(), bed.walls.len()];
        let mut strike = Self { impact: *impact, simulation, level, count, seen: Seen::default(), stop: None };
        strike.seen.moments.push(strike.look());
        strike.seen.grain_force = vec![0.0; bed.grains.len()];
        Ok(strike)
    }

    /// Steps in the window.
    fn steps(&self) -> u64 {
        (self.impact.window / self.impact.step).round() as u64
    }

    /// Whether the window is not over and nothing stopped the run.
    pub fn goes_on(&self) -> bool {
        self.simulation.steps() < self.steps() && self.stop.is_none()
    }

    /// Goes on to the next look, or until a guard or the caller stops it.
    pub fn go_on(&mut self, context: &Context) {
        let every = ((self.impact.sample / self.impact.step).round() as u64).max(1);
        let left = self.steps() - self.simulation.steps();
        self.stop = self.simulation.advance(every.min(left), context).err();
        let moment = self.look();
        let size = moment.force[0].hypot(moment.force[1]);
        let view = self.simulation.view();
        let mut pushed = view.normal_force_sum();
        pushed.truncate(self.count[0]);
        if size > self.seen.peak_force[0] {
            self.seen.peak_force = [size, moment.time];
            self.seen.snapshot = Snapshot {
                time: moment.time,
                centres: (0..self.count[0]).map(|i| view.position(i)).collect(),
                force: pushed.clone(),
                intruder: disks(&self.simulation, self.members()),
            };
        }
        for (most, now) in self.seen.grain_force.iter_mut().zip(pushed) {
            *most = most.max(now);
        }
        self.seen.moments.push(moment);
    }

    /// Place of the intruder's first disk.
    fn members(&self) -> usize {
        self.count[0] + self.count[1]
    }

    fn look(&self) -> Moment {
        let (simulation, members, intruder) = (&self.simulation, self.members(), &self.impact.intruder);
        let view = simulation.view();
        let start = self.level + intruder.height;
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
        let depth = self.level - (start + moved);
        Moment { time: simulation.time(), depth, velocity, turn, force, energy: simulation.ledger() }
    }

    /// The last moment that was looked at.
    pub fn moment(&self) -> &Moment {
        &self.seen.moments[self.seen.moments.len() - 1]
    }

    /// How often it was looked at since the start.
    pub fn looks(&self) -> u64 {
        self.seen.moments.len() as u64 - 1
    }

    /// Why the run stopped, if it did.
    pub fn stop(&self) -> Option<&RigStop> {
        self.stop.as_ref()
    }

    /// Every body and closed contact as they are now.
    pub fn frame(&self) -> Frame {
        Frame::of(&self.simulation, self.count).unwrap_or_default()
    }

    /// All that a later run needs to go on from here to the same bits.
    pub fn checkpoint(&self) -> Vec<u8> {
        let state = (self.simulation.checkpoint(), &self.seen);
        // Numbers and lists of them: nothing in it can fail.
        postcard::to_stdvec(&state).unwrap_or_default()
    }

    /// Takes up where [`checkpoint`](Self::checkpoint) left an impact of the same bed and file.
    ///
    /// # Errors
    /// See [`CheckpointError`].
    pub fn restore(&mut self, bytes: &[u8]) -> Result<(), CheckpointError> {
        let (state, seen): (Vec<u8>, Seen) = postcard::from_bytes(bytes).map_err(|_| CheckpointError::Damaged)?;
        if seen.moments.is_empty() || seen.grain_force.len() != self.count[0] {
            return Err(CheckpointError::Damaged);
        }
        self.simulation.restore(&state)?;
        self.seen = seen;
        Ok(())
    }

    /// What came of it.
    pub fn course(self) -> Course {
        let Seen { moments, grain_force, peak_force, snapshot } = self.seen;
        let end = moments[moments.len() - 1].time;
        let tail = (end / 3.0).min(100.0);
        let last: Vec<f64> = moments.iter().filter(|m| m.time >= end - tail).map(|m| m.depth).collect();
        let mean = last.iter().sum::<f64>() / last.len() as f64;
        let swing = (last.iter().map(|d| (d - mean) * (d - mean)).sum::<f64>() / last.len() as f64).sqrt();
        let max_depth = moments.iter().map(|m| m.depth).fold(f64::NEG_INFINITY, f64::max);
        let view = self.simulation.view();
        let grains = (0..self.count[0]).map(|i| view.position(i)).collect();
        Course {
            moments,
            final_depth: mean,
            final_swing: swing,
            max_depth,
            peak_force,
            grains,
            grain_force,
            snapshot,
            stop: self.stop,
        }
    }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bed::{Body, Packing, Pile, Sides};

    /// A run that is taken up goes on to the same bits: moments, places, frames; and `strike` is the same run.
    #[test]
    fn an_impact_is_taken_up_to_the_same_bits() {
        let pile = Pile {
            packing: Packing::Hexagonal,
            width: 16.0,
            height: 6.0,
            spread: 0.0,
            seed: 1,
            sides: Sides::Periodic,
        };
        let bed = pile.lay().0;
        let mut grains = Grains::default();
        (grains.grains.tangential_stiffness, grains.walls.tangential_stiffness) = (0.8, 0.8);
        let outline = Outline::Disk { diameter: 3.0 };
        let intruder = Intruder { outline, mass: 9.0, body: Body::Solid, turns: true, speed: 0.7, height: 0.2 };
        let impact = BedImpact::new(grains, intruder, 12.0);
        let never = Context::default();
        let finish = |mut strike: Strike| {
            while strike.goes_on() {
                strike.go_on(&never);
            }
            (strike.frame(), strike.course())
        };
        let mut left = Strike::new(&bed, &impact).unwrap();
        (0..9).for_each(|_| left.go_on(&never));
        let bytes = left.checkpoint();
        let mut taken_up = Strike::new(&bed, &impact).unwrap();
        taken_up.restore(&bytes).unwrap();
        assert_eq!((taken_up.looks(), taken_up.frame()), (9, left.frame()));
        let whole = finish(Strike::new(&bed, &impact).unwrap());
        assert_eq!(finish(taken_up), whole);
        assert_eq!(strike(&bed, &impact, &never, |_| ()).unwrap(), whole.1);
        assert!(whole.0.contacts.iter().any(|contact| contact.tangential != 0.0));
        assert!(Strike::new(&bed, &impact).unwrap().restore(&bytes[..bytes.len() / 2]).is_err());
        let other = BedImpact { grains: Grains { stiffness: 3000.0, ..grains }, ..impact };
        assert!(Strike::new(&bed, &other).unwrap().restore(&bytes).is_err());
    }
}
