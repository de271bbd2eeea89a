//! Where the energy of a rig went, by mechanism.

use serde::{Deserialize, Serialize};

/// Energies (J) of the simulated part, spheres and contacts on mirrors counting by their part in it:
///
///   work in = kinetic + stored + tangential stored + potential + dissipated + friction + absorbed
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct EnergyLedger {
    /// Work of loads and prescribed motion, and energy present at the start.
    pub work_in: f64,
    /// Σ ½ m v² of spheres and flats, and Σ ½ I ω².
    pub kinetic: f64,
    /// What the contacts would give back on opening.
    pub stored: f64,
    /// What the tangential springs hold.
    #[serde(alias = "wound")]
    pub tangential_stored: f64,
    /// −Σ m g·u, against the start.
    pub potential: f64,
    /// ∫F dδ of all contacts, less what they store: plastic and viscous loss along the normal.
    pub dissipated: f64,
    /// Loss by tangential forces.
    pub friction: f64,
    /// What bars took away, and drag.
    pub absorbed: f64,
    /// What velocity Verlet holds back while forces act, Σ h² m a²/8 against the start, and gives back when they end. In each step
    /// Δ(½ m v²) − ½(F + F′) Δx = h² m (a′² − a²)/8 exactly, whatever the force: within a blow the balance is out by it, at its end
    /// it is not.
    #[serde(default)]
    pub held_back: f64,
    /// The most energy that was at hand so far, put in or set free by falling, as far as it was looked at.
    pub at_hand: f64,
}

impl EnergyLedger {
    /// What is left over (J): zero in an exact integration.
    pub fn left(&self) -> f64 {
        let Self { work_in, kinetic, stored, tangential_stored, potential, dissipated, friction, absorbed, .. } = self;
        work_in - kinetic - stored - tangential_stored - potential - dissipated - friction - absorbed
    }

    /// What is left over, without what the scheme holds back, relative to the most energy that was at hand; none before there was
    /// any.
    pub fn residual(&self) -> Option<f64> {
        (self.at_hand > 0.0).then(|| (self.left() + self.held_back) / self.at_hand)
    }
}

/// Energy that contacts under a law have given back beyond what was put into them.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Gain {
    /// The law's name.
    pub law: String,
    /// How much (J), of the simulated part.
    #[serde(rename = "energy_J")]
    pub energy: f64,
}
