//! The lens problem and its relatives, set up from the library's parts.

use granulens_core::Context;
use granulens_core::contact::{Constants, LawKind};
use granulens_core::dem::{ForcePulse, Impact, Integrator, Mirror, MoveIn, Record, Spheres, simulate};
use granulens_core::lattice::{HexagonalSheet, Site};
use granulens_core::layout::Layout;
use granulens_core::sample::Sample;

use crate::reference::material;

pub const DIAMETER: f64 = 6.35e-3;

pub fn sheet(rows: u32, half_width: f64) -> HexagonalSheet {
    HexagonalSheet::new(DIAMETER, rows, half_width).unwrap()
}

/// Burgoyne 2016, section 5.3.3: rows 5 to 16, front face of radius 16.5 D/sin 60°.
pub fn is_lens(site: &Site) -> bool {
    let radius = 16.5 / 60_f64.to_radians().sin();
    let x = site.x / DIAMETER;
    let depth = (f64::from(site.row) - 5.0) * 0.75_f64.sqrt();
    site.row <= 16 && depth >= radius - (radius * radius - x * x).sqrt() - 1e-9
}

/// Stainless 440c with brass where `brass` says.
pub fn layout(brass: impl Fn(&Site) -> bool) -> Layout {
    Layout::new(sheet(50, 16.5), vec![material("440c"), material("brass")], |site| u8::from(brass(site)))
}

/// The lens problem's impact: 26 kN for 20 µs on every sphere of row 1, mirrors at x = 0 and x = 16.5 D.
pub fn impact(lattice: &HexagonalSheet) -> Impact {
    let sites = lattice.sites();
    let row = |number: u32| (0..sites.len()).filter(|&i| sites[i].row == number).collect::<Vec<_>>();
    Impact {
        mirrors: vec![
            Mirror { axis: 0, position: 0.0, inward: 1.0 },
            Mirror { axis: 0, position: lattice.half_width(), inward: -1.0 },
        ],
        law: LawKind::Thesis,
        constants: Constants::Code,
        pulse: ForcePulse { force: 26e3, duration: 20e-6 },
        periods: Vec::new(),
        slope: 0.0,
        struck: row(1),
        faces: Vec::new(),
        moving: Vec::new(),
        projectile: None,
        exit: row(lattice.rows()),
        integrator: Integrator::Verlet,
        step: 1e-7,
        window: 250e-6,
    }
}

pub fn run<const D: usize>(sample: &Sample<D>, impact: &Impact) -> Record<D>
where
    Spheres: MoveIn<D>,
{
    simulate(sample, impact, &Context::default()).unwrap()
}
