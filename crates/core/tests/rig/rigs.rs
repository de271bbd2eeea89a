//! Small rigs, and how they are run.

use granulens_core::Context;
use granulens_core::contact::LawKind;
use granulens_core::dem::rig::{LawBook, Rig, Simulation};
use granulens_core::dem::{MoveIn, Spheres};
use granulens_core::sample::{Sample, Sphere};

use crate::reference::material;

pub const DIAMETER: f64 = 6.35e-3;

pub static GO: std::sync::LazyLock<Context> = std::sync::LazyLock::new(Context::default);

/// Spheres of 440c of one diameter at centres given in diameters.
pub fn spheres<const D: usize>(centres: &[[f64; D]]) -> Sample<D> {
    let sphere = |at: &[f64; D]| Sphere { centre: at.map(|x| x * DIAMETER), radius: 0.5 * DIAMETER, material: 0 };
    Sample { materials: vec![material("440c")], spheres: centres.iter().map(sphere).collect() }
}

pub fn rig<const D: usize>(centres: &[[f64; D]], law: LawKind) -> Rig<D> {
    Rig::new(spheres(centres), LawBook::named(law))
}

/// Runs a rig for so many steps.
pub fn run<const D: usize>(rig: Rig<D>, step: f64, steps: u64) -> Simulation<D>
where
    Spheres: MoveIn<D>,
{
    let mut simulation = Simulation::new(rig, step).unwrap();
    simulation.advance(steps, &GO).unwrap();
    simulation
}

/// A hexagonal sheet: rows across the last axis, `columns` spheres in each, all at x ≥ 0, odd rows half a diameter on.
pub fn hexagonal(rows: usize, columns: usize) -> Vec<[f64; 2]> {
    (0..rows)
        .flat_map(|row| {
            let shift = if row % 2 == 1 { 0.5 } else { 0.0 };
            (0..columns).map(move |k| [k as f64 + shift, row as f64 * 0.75_f64.sqrt()])
        })
        .collect()
}
