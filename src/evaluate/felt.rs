//! What a layout's regions and its far end felt, beyond energies.

use serde::{Deserialize, Serialize};

use super::blow::Field;
use crate::dem::Record;
use crate::lattice::HexagonalSheet;
use crate::target::Target;

/// What is known of a run with full records. Pairs are of the focal and the protected region.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Felt {
    /// Mean over a region of each sphere's greatest momentum, √(2 m E) (kg m/s)
    #[serde(rename = "momentum_kg_m_s")]
    pub momentum: [f64; 2],
    /// Greatest force at one contact of a region's spheres (N)
    #[serde(rename = "force_N")]
    pub force: [f64; 2],
    /// When the first sphere of a region reached 1 % of its own greatest speed (s)
    #[serde(rename = "arrival_s")]
    pub arrival: [Option<f64>; 2],
    /// Greatest momentum of the last row of one half along the axis (kg m/s)
    #[serde(rename = "far_momentum_kg_m_s")]
    pub far_momentum: f64,
    /// Greatest total contact force on the last row of one half along the axis (N)
    #[serde(rename = "far_force_N")]
    pub far_force: f64,
    /// The part of the work of the load that contacts have dissipated.
    pub dissipation: f64,
}

impl Felt {
    /// Of a run on a field, whose spheres have these masses (kg).
    pub(super) fn new(
        record: &Record<2>,
        field: &Field,
        lattice: &HexagonalSheet,
        target: &Target,
        mass: impl Fn(usize) -> f64,
    ) -> Self {
        let regions = [target.focal_sites(lattice), target.protect.sites(lattice)];
        let both = |sites: &Vec<usize>| -> Vec<usize> { sites.iter().flat_map(|&site| field.on(site)).collect() };
        let momentum = regions.each_ref().map(|sites| {
            let of: Vec<f64> =
                both(sites).into_iter().map(|i| (2.0 * mass(i) * record.max_kinetic[i]).sqrt()).collect();
            if of.is_empty() { 0.0 } else { of.iter().sum::<f64>() / of.len() as f64 }
        });
        let force = regions
            .each_ref()
            .map(|sites| both(sites).into_iter().map(|i| record.max_contact_force[i]).fold(0.0, f64::max));
        let arrival =
            regions.each_ref().map(|sites| both(sites).into_iter().filter_map(|i| record.arrival[i]).reduce(f64::min));
        let share = if field.is_whole() { 0.5 } else { 1.0 };
        let ledger = &record.ledger;
        Self {
            momentum,
            force,
            arrival,
            far_momentum: share * record.exit_momentum,
            far_force: share * record.exit_force,
            dissipation: if ledger.work_in > 0.0 { ledger.dissipated / ledger.work_in } else { 0.0 },
        }
    }
}
