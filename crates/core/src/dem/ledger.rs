//! Where the energy went: work in = kinetic + stored + dissipated.
//!
//! The work of the contacts is integrated over the overlap, independently of the velocities that carry the kinetic energy,
//! so the ledger closes only as far as the motion is resolved. It is blind to how finely the contacts' memories
//! are sampled: that shows when the step is halved.

use serde::{Deserialize, Serialize};

use super::body::Grains;
use super::contacts::Contacts;
use super::table::LawTable;
use crate::contact::NormalLaw;

/// Energies (J) of the simulated half, spheres and contacts on mirrors counting by their part in it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Ledger {
    /// Work of the load, and kinetic energy at the start.
    pub work_in: f64,
    /// Σ ½ m v²
    pub kinetic: f64,
    /// What the contacts would give back on opening.
    pub stored: f64,
    /// ∫F dδ of all contacts, less what they store.
    pub dissipated: f64,
    /// Σ ½ δ_max F_max, the estimate of Burgoyne 2016, eq. 5.6.
    pub estimate: f64,
}

impl Ledger {
    /// Draws the balance.
    pub(super) fn close<const D: usize, L: NormalLaw + Copy + Sync>(
        grains: &Grains<f64, D>,
        contacts: &Contacts<f64, D, LawTable<L>>,
        work_in: f64,
    ) -> Self {
        let mut ledger = Self { work_in, ..Self::default() };
        for i in 0..grains.reached {
            ledger.kinetic += 0.5 * grains.weight[i] / grains.inverse_mass[i] * grains.speed_squared(i);
        }
        for (c, (history, account)) in contacts.history.iter().zip(&contacts.account).enumerate() {
            let weight = contacts.weight[c];
            let stored = contacts.laws.of(c).stored(account.overlap, history);
            ledger.stored += weight * stored;
            ledger.dissipated += weight * (account.work - stored);
            ledger.estimate += weight * 0.5 * history.overlap_max * history.force_max;
        }
        ledger
    }

    /// (work in − kinetic − stored − dissipated)/work in; none before any work was done.
    pub fn residual(&self) -> Option<f64> {
        let left = self.work_in - self.kinetic - self.stored - self.dissipated;
        (self.work_in != 0.0).then(|| left / self.work_in)
    }
}
