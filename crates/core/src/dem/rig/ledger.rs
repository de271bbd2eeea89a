//! Where the energy of a rig went, by mechanism.

use serde::{Deserialize, Serialize};

/// Energies (J) of the simulated part, spheres and contacts on mirrors counting by their part in it:
///
///   work in = kinetic + stored + wound + potential + dissipated + friction + absorbed
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct EnergyLedger {
    /// Work of loads and prescribed motion, and energy present at the start.
    pub work_in: f64,
    /// Σ ½ m v² of spheres and flats, and Σ ½ I ω².
    pub kinetic: f64,
    /// What the contacts would give back on opening.
    pub stored: f64,
    /// What the tangential springs hold.
    pub wound: f64,
    /// −Σ m g·u, against the start.
    pub potential: f64,
    /// ∫F dδ of all contacts, less what they store: plastic and viscous loss along the normal.
    pub dissipated: f64,
    /// Loss by tangential forces.
    pub friction: f64,
    /// What bars took away, and drag.
    pub absorbed: f64,
    /// The most energy that was at hand so far, put in or set free by falling, as far as it was looked at.
    pub at_hand: f64,
}

impl EnergyLedger {
    /// What is left over (J): zero in an exact integration.
    pub fn left(&self) -> f64 {
        let Self { work_in, kinetic, stored, wound, potential, dissipated, friction, absorbed, .. } = self;
        work_in - kinetic - stored - wound - potential - dissipated - friction - absorbed
    }

    /// What is left over relative to the most energy that was at hand; none before there was any.
    pub fn residual(&self) -> Option<f64> {
        (self.at_hand > 0.0).then(|| self.left() / self.at_hand)
    }
}
