//! Files for other tools, read back by other readers; and LAMMPS as a witness.

mod lammps;
mod views;

use std::sync::atomic::AtomicBool;

use granulens::contact::{Constants, LawKind};
use granulens::dem::ForcePulse;
use granulens::dem::rig::{Rig, Simulation};
use granulens::export::whole_crystal;
use granulens::lattice::HexagonalSheet;
use granulens::layout::Layout;
use granulens::material::find;

static GO: AtomicBool = AtomicBool::new(false);

const DIAMETER: f64 = 6.35e-3;

/// A small lens: brass about the axis in rows 4 to 8 of a sheet of 440c, 12 rows deep and 9 diameters around.
fn layout() -> Layout {
    let sheet = HexagonalSheet::new(DIAMETER, 12, 4.5).unwrap();
    let palette = ["440c", "brass"].map(|name| find(name, &[]).unwrap()).to_vec();
    Layout::new(sheet, palette, |site| u8::from((4..=8).contains(&site.row) && site.x < 2.2 * DIAMETER))
}

fn rig(law: LawKind) -> Rig<2> {
    whole_crystal(&layout(), ForcePulse { force: 2e3, duration: 20e-6 }, law, Constants::Code)
}

fn run(rig: Rig<2>, step: f64, steps: u64) -> Simulation<2> {
    let mut simulation = Simulation::new(rig, step).unwrap();
    simulation.advance(steps, &GO).unwrap();
    simulation
}
