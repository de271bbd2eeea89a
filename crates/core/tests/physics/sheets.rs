//! Sheets that are no hexagonal ones of equal spheres: square packing, and rows of several sizes, against chains.

use granulens_core::Context;
use granulens_core::contact::{Constants, LawKind, Pair};
use granulens_core::dem::{ForcePulse, Impact, Integrator, Mirror, simulate_batch};
use granulens_core::lattice::{HexagonalSheet, SheetPacking};
use granulens_core::layout::Layout;
use granulens_core::real::Width;
use granulens_core::sample::{Sample, Sphere};

use crate::problem::{DIAMETER, run};
use crate::reference::{difference, material};

fn impact(struck: Vec<usize>, law: LawKind, force: f64) -> Impact {
    Impact {
        mirrors: Vec::new(),
        law,
        constants: Constants::Code,
        pulse: ForcePulse { force, duration: 20e-6 },
        periods: Vec::new(),
        slope: 0.0,
        struck,
        faces: Vec::new(),
        moving: Vec::new(),
        projectile: None,
        exit: Vec::new(),
        integrator: Integrator::Adams,
        step: 1e-7,
        window: 150e-6,
    }
}

/// Between its mirrors.
fn on_sheet(sheet: &HexagonalSheet, law: LawKind, force: f64) -> Impact {
    let mirrors = vec![
        Mirror { axis: 0, position: 0.0, inward: 1.0 },
        Mirror { axis: 0, position: sheet.half_width(), inward: -1.0 },
    ];
    Impact { mirrors, ..impact((0..sheet.columns(1) as usize).collect(), law, force) }
}

/// A plane wave along the columns of a square sheet is one along as many chains: spheres of a row move alike and do not press each other. So it is that of
/// the chain of the same spheres, equal or of sizes that alternate, and brass between steel, to rounding and its growth.
#[test]
fn a_plane_wave_in_square_packing_is_that_of_a_chain() {
    for sizes in [vec![DIAMETER], vec![DIAMETER, 0.6 * DIAMETER, 0.8 * DIAMETER]] {
        let sheet = HexagonalSheet::packed(SheetPacking::Square, DIAMETER, 18, 3.5).unwrap();
        let sheet = sheet.with_diameters(&sizes).unwrap();
        let palette = vec![material("440c"), material("brass")];
        let layout = Layout::new(sheet.clone(), palette.clone(), |site| u8::from((6..9).contains(&site.row)));
        let record = run(&layout.sample(), &on_sheet(&sheet, LawKind::Thesis, 6e3));
        assert_eq!(record.stop, None);
        let spheres = (1..=18).map(|row| Sphere {
            centre: [sheet.depth(f64::from(row))],
            radius: 0.5 * sheet.row_diameter(row),
            material: usize::from((6..9).contains(&row)),
        });
        let chain = Sample { materials: palette, spheres: spheres.collect() };
        let alone = run(&chain, &impact(vec![0], LawKind::Thesis, 6e3));
        for (k, site) in sheet.sites().iter().enumerate() {
            let off = difference(record.max_kinetic[k], alone.max_kinetic[site.row as usize - 1], 1e-12);
            assert!(off < 1e-9, "{sizes:?} {site:?}: {off:e}");
        }
        // Side by side to the bit.
        let samples = vec![layout.sample(); 3];
        let impact = on_sheet(&sheet, LawKind::Thesis, 6e3);
        let briefs = simulate_batch(&samples, &impact, Width::widest(), &Context::default()).unwrap();
        assert!(briefs.iter().all(|brief| brief.max_kinetic == record.max_kinetic));
    }
}

/// A plane wave in a hexagonal sheet of rows of several sizes, under Hertz's law and small overlaps: the rows move as a chain with two contacts of k δ^{3/2} from
/// sphere to sphere, each at an angle θ whose cosine is the distance of the rows over that of the centres, so that a row presses the next with
/// 2 k cos^{5/2} θ u^{3/2}. Integrated here by itself. Overlaps are 1e-4 of the radii and less, and so are the changes of angles.
#[test]
fn a_plane_wave_through_rows_of_several_sizes_is_that_of_a_chain_of_rows() {
    let sizes = [DIAMETER, 0.8 * DIAMETER, 0.9 * DIAMETER, 0.8 * DIAMETER];
    let sheet = HexagonalSheet::new(DIAMETER, 14, 3.0).unwrap().with_diameters(&sizes).unwrap();
    let steel = material("440c");
    let layout = Layout::new(sheet.clone(), vec![steel.clone()], |_| 0);
    // Until the wave has passed the last row.
    let record = run(&layout.sample(), &Impact { window: 300e-6, ..on_sheet(&sheet, LawKind::Hertz, 2.0) });
    assert_eq!(record.stop, None);
    assert!(record.ledger.residual().unwrap().abs() < 1e-4);

    let rows = sheet.rows() as usize;
    let mass: Vec<f64> = (1..=sheet.rows()).map(|row| steel.sphere_mass(sheet.row_diameter(row))).collect();
    let link = |row: u32| {
        let radii = [row, row + 1].map(|row| 0.5 * sheet.row_diameter(row));
        let down = sheet.depth(f64::from(row + 1)) - sheet.depth(f64::from(row));
        let hertz = Pair::new([&steel; 2], radii, Constants::Code).hertz_coefficient();
        2.0 * hertz * (down / (radii[0] + radii[1])).powf(2.5)
    };
    let link: Vec<f64> = (1..sheet.rows()).map(link).collect();
    let (mut x, mut v, mut most) = (vec![0.0; rows], vec![0.0; rows], vec![0.0_f64; rows]);
    let step = 5e-9;
    let push = |x: &[f64], time: f64| -> Vec<f64> {
        let mut force = vec![0.0; rows];
        // The same impulse: the load acts on whole steps.
        force[0] = if time < 20e-6 - 0.5 * step { 2.0 } else { 0.0 };
        for (k, stiffness) in link.iter().enumerate() {
            let pressed = stiffness * (x[k] - x[k + 1]).max(0.0).powf(1.5);
            (force[k], force[k + 1]) = (force[k] - pressed, force[k + 1] + pressed);
        }
        force
    };
    for n in 0..60_000 {
        let force = push(&x, f64::from(n) * step);
        for k in 0..rows {
            v[k] += 0.5 * step * force[k] / mass[k];
            x[k] += step * v[k];
        }
        let force = push(&x, f64::from(n) * step);
        for k in 0..rows {
            v[k] += 0.5 * step * force[k] / mass[k];
            most[k] = most[k].max(v[k].abs());
        }
    }
    for (k, site) in sheet.sites().iter().enumerate() {
        let row = site.row as usize - 1;
        let expected = 0.5 * mass[row] * most[row] * most[row];
        assert!(
            difference(record.max_kinetic[k], expected, 0.0) < 2e-3,
            "{site:?}: {} {expected}",
            record.max_kinetic[k]
        );
    }
}
