//! Where the energy went: work in = kinetic + stored + dissipated.
//!
//! The work of the contacts is integrated over the overlap, independently of the velocities that carry the kinetic energy,
//! so the ledger closes only as far as the motion is resolved. It is blind to how finely the contacts' memories
//! are sampled: that shows when the step is halved.

use serde::{Deserialize, Serialize};

use super::body::Grains;
use super::contacts::{Contacts, Laws};
use super::plate::Plate;

/// Energies (J) of the simulated half, spheres and contacts on mirrors counting by their part in it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Ledger {
    /// Work of the load, and kinetic energy at the start.
    pub work_in: f64,
    /// Σ ½ m v², of a projectile too, and ½ I ω² where spheres turn
    pub kinetic: f64,
    /// What the contacts would give back on opening, and what their tangential springs hold.
    pub stored: f64,
    /// ∫F dδ of all contacts, and ∫T u dt by friction, less what they store.
    pub dissipated: f64,
    /// Σ ½ δ_max F_max, the estimate of Burgoyne 2016, eq. 5.6.
    pub estimate: f64,
}

impl Ledger {
    /// That of so many times as much of a crystal.
    #[must_use]
    pub fn times(self, share: f64) -> Self {
        let Self { work_in, kinetic, stored, dissipated, estimate } = self;
        Self {
            work_in: share * work_in,
            kinetic: share * kinetic,
            stored: share * stored,
            dissipated: share * dissipated,
            estimate: share * estimate,
        }
    }

    /// Draws the balance.
    pub(super) fn close<const D: usize>(
        grains: &Grains<f64, D>,
        contacts: &Contacts<'_, f64, D>,
        laws: &dyn Laws<f64, D>,
        work_in: f64,
    ) -> Self {
        let mut ledger = Self { work_in, ..Self::default() };
        for i in 0..grains.reached {
            ledger.kinetic += 0.5 * grains.mass(i) * grains.speed_squared(i);
        }
        for (c, account) in contacts.account.iter().enumerate() {
            let (weight, stored) = (contacts.list.weight[c], contacts.stored(laws, c));
            let (overlap_max, force_max) = contacts.greatest(c, 0);
            ledger.stored += weight * stored;
            ledger.dissipated += weight * (account.work - stored);
            ledger.estimate += weight * 0.5 * overlap_max * force_max;
        }
        ledger.kinetic += contacts.plate.as_ref().map_or(0.0, Plate::kinetic);
        if let Some(friction) = &contacts.friction {
            ledger.kinetic += friction.kinetic();
            for (c, work) in friction.work.iter().enumerate() {
                let (weight, stored) = (contacts.list.weight[c], friction.stored(c));
                ledger.stored += weight * stored;
                ledger.dissipated += weight * (work - stored);
            }
        }
        ledger
    }

    /// (work in − kinetic − stored − dissipated)/work in; none before any work was done.
    pub fn residual(&self) -> Option<f64> {
        let left = self.work_in - self.kinetic - self.stored - self.dissipated;
        (self.work_in != 0.0).then(|| left / self.work_in)
    }
}
