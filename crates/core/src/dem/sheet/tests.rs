//! Sheets against the simulator with lists, closed forms and themselves.

use super::*;
use crate::Context;
use crate::contact::LawKind;
use crate::dem::{Impact, Integrator, Mirror, simulate};
use crate::lattice::HexagonalSheet;
use crate::layout::{Layout, random_choice};
use crate::material::find;

fn metals() -> Vec<Material> {
    ["440c", "brass", "al"].iter().map(|name| find(name, &[]).unwrap()).collect()
}

/// Materials mixed at random, other ones for each seed.
fn mix(grid: &Grid, seed: u64) -> Vec<u8> {
    let (first, second) = (random_choice(seed, grid.len()), random_choice(seed + 1000, grid.len()));
    first.iter().zip(&second).map(|(a, b)| a + b).collect()
}

/// A squeezed sheet without ends, shaken.
fn shaken(rows: usize, columns: usize, designs: &[&[u8]], width: Width) -> Sheet {
    let grid = Grid {
        rows,
        columns: [columns; 2],
        diameter: 6.35e-3,
        spacing: 6.35e-3 * (1.0 - 1e-3),
        sides: Sides::Periodic,
        joined: true,
    };
    let mut sheet = Sheet::new(grid, &metals(), designs, 1e-7, width).unwrap();
    let velocities: Vec<[f64; 2]> =
        (0..grid.len()).map(|k| [0.3 * (k as f64 * 0.7).sin(), 0.3 * (k as f64 * 1.3).cos()]).collect();
    sheet.set_velocities(&velocities);
    sheet
}

fn largest(numbers: &[[f64; 2]]) -> f64 {
    numbers.iter().flatten().fold(0.0, |greatest, number| number.abs().max(greatest))
}

fn apart(a: &[[f64; 2]], b: &[[f64; 2]]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).flat_map(|(a, b)| [a[0] - b[0], a[1] - b[1]]).fold(0.0, |greatest, d| d.abs().max(greatest))
}

/// A half crystal between mirrors, of either half width, struck so that overlaps reach far beyond the series of the law, in the
/// simulator that follows lists of contacts: the same scheme with other roundings, whose growth in 60 µs of a wave stays below
/// a thousandfold (10⁻¹³ of the greatest motion).
#[test]
fn a_sheet_between_mirrors_moves_as_the_simulator_with_lists_says() {
    for half_width in [6.0, 6.5] {
        let lattice = HexagonalSheet::new(6.35e-3, 25, half_width).unwrap();
        let grid = Grid::of_lattice(&lattice);
        assert_eq!(grid.len(), lattice.len());
        let materials = mix(&grid, 3);
        let layout = Layout { lattice: lattice.clone(), palette: metals(), materials: materials.clone() };
        let struck: Vec<usize> = (0..lattice.columns(1) as usize).collect();
        let impact = Impact {
            mirrors: vec![
                Mirror { axis: 0, position: 0.0, inward: 1.0 },
                Mirror { axis: 0, position: lattice.half_width(), inward: -1.0 },
            ],
            law: LawKind::Hertz,
            constants: Constants::default(),
            pulse: ForcePulse { force: 10e3, duration: 20.03e-6 },
            periods: Vec::new(),
            slope: 0.0,
            struck: struck.clone(),
            faces: Vec::new(),
            moving: Vec::new(),
            projectile: None,
            exit: Vec::new(),
            integrator: Integrator::Verlet,
            step: 1e-7,
            window: 60e-6,
        };
        let record = simulate(&layout.sample(), &impact, &Context::default()).unwrap();
        assert_eq!(record.stop, None);
        for width in Width::available() {
            let mut sheet = Sheet::new(grid, &layout.palette, &[&materials], impact.step, width).unwrap();
            sheet.strike(impact.pulse.force, impact.pulse.duration, &struck);
            sheet.watch_speeds();
            sheet.advance(record.steps, 2).unwrap();
            assert!(sheet.deepest_overlap() > 0.04, "{}", sheet.deepest_overlap());
            let (moved, speed) = (largest(&record.displacement), largest(&record.velocity));
            assert!(apart(&sheet.displacements(0), &record.displacement) < 1e-12 * moved);
            assert!(apart(&sheet.velocities(0), &record.velocity) < 1e-12 * speed);
            let greatest = record.max_kinetic.iter().copied().fold(0.0, f64::max);
            for (ours, theirs) in sheet.greatest_kinetic(0).unwrap().iter().zip(&record.max_kinetic) {
                assert!((ours - theirs).abs() < 1e-12 * greatest);
            }
            // Not all of the crystal has been reached, and what has not is at rest.
            assert!(sheet.reached < grid.rows && sheet.displacements(0)[grid.len() - 1] == [0.0; 2]);
        }
    }
}

/// One crystal among others, in registers of any width, its rows shared out among any number of bands.
#[test]
fn bits_depend_on_neither_width_nor_bands_nor_neighbours() {
    let grid = *shaken(12, 11, &[&[0; 132]], Width::Scalar).grid();
    let mixes: Vec<Vec<u8>> = (1..=8).map(|seed| mix(&grid, seed)).collect();
    let alone: Vec<_> = mixes
        .iter()
        .map(|mix| {
            let mut sheet = shaken(12, 11, &[mix], Width::Scalar);
            sheet.advance(300, 1).unwrap();
            (sheet.displacements(0), sheet.velocities(0))
        })
        .collect();
    for width in Width::available() {
        for bands in [1, 2, 3, 5, 6] {
            let mut lone = shaken(12, 11, &[&mixes[2]], width);
            lone.advance(300, bands).unwrap();
            assert!((lone.displacements(0), lone.velocities(0)) == alone[2], "{width:?}, {bands} bands");
            let group: Vec<&[u8]> = mixes[..width.lanes()].iter().map(Vec::as_slice).collect();
            let mut together = shaken(12, 11, &group, width);
            together.advance(300, bands).unwrap();
            for k in 0..group.len() {
                assert!((together.displacements(k), together.velocities(k)) == alone[k], "{width:?}, {bands}, {k}");
            }
        }
    }
}

/// Kinetic and elastic energy keep their sum: what Verlet leaves of it shrinks as the square of the step, and momentum is kept to
/// rounding.
#[test]
fn a_closed_sheet_keeps_energy_and_momentum() {
    let drift = |step: f64| {
        let grid = *shaken(10, 9, &[&[0; 90]], Width::Scalar).grid();
        let materials = mix(&grid, 5);
        let mut sheet = Sheet::new(grid, &metals(), &[&materials], step, Width::widest()).unwrap();
        let velocities: Vec<[f64; 2]> = (0..90).map(|k| [0.2 * (k as f64).sin(), 0.2 * (k as f64).cos()]).collect();
        sheet.set_velocities(&velocities);
        let momentum = |sheet: &Sheet| {
            let mass: Vec<f64> = materials.iter().map(|&m| metals()[usize::from(m)].sphere_mass(6.35e-3)).collect();
            let velocities = sheet.velocities(0);
            [0, 1].map(|axis| mass.iter().zip(&velocities).map(|(m, v)| m * v[axis]).sum::<f64>())
        };
        let (energy, impulse) = (sheet.kinetic_energy(0) + sheet.elastic_energy(0), momentum(&sheet));
        let moving = sheet.kinetic_energy(0);
        let mut worst = 0.0_f64;
        for _ in 0..40 {
            sheet.advance((5e-6 / step).round() as u64, 1).unwrap();
            worst = worst.max((sheet.kinetic_energy(0) + sheet.elastic_energy(0) - energy).abs() / moving);
        }
        assert!((sheet.kinetic_energy(0) / moving - 1.0).abs() > 1e-3, "nothing happened");
        let now = momentum(&sheet);
        assert!((0..2).all(|k| (now[k] - impulse[k]).abs() < 1e-12 * moving.sqrt()), "{impulse:?} {now:?}");
        worst
    };
    let (coarse, fine) = (drift(2e-7), drift(1e-7));
    assert!(coarse < 1e-3, "{coarse}");
    assert!((3.0..5.5).contains(&(coarse / fine)), "{coarse} {fine}");
}

/// What pushes a displaced sphere from rest is the slope of the elastic energy, which is computed from the law's own formula: to what
/// the second difference leaves, (small/overlap)² = 2e-10, and to rounding of the energy over it, 1e-6.
#[test]
fn forces_are_the_slope_of_the_energy() {
    let rows = 6;
    let at = 6 * 2 + 3;
    let energy = |shift: [f64; 2]| {
        let mut sheet = shaken(rows, 6, &[&[1; 36]], Width::Scalar);
        let place = sheet.fixed.store.at(2, 3);
        sheet.state.x.get_mut()[place] += shift[0] / 6.35e-3;
        sheet.state.z.get_mut()[place] += shift[1] / 6.35e-3;
        sheet
    };
    // A displacement of a fifth of the overlap, and a difference far below it.
    let (shift, small) = ([1.1e-6, -0.7e-6], 1e-10);
    let mut sheet = energy(shift);
    sheet.set_velocities(&[[0.0; 2]; 36]);
    sheet.advance(1, 1).unwrap();
    let mass = metals()[1].sphere_mass(6.35e-3);
    let moved = sheet.displacements(0)[at];
    for axis in 0..2 {
        let mut ahead = shift;
        ahead[axis] += small;
        let mut behind = shift;
        behind[axis] -= small;
        let slope = (energy(ahead).elastic_energy(0) - energy(behind).elastic_energy(0)) / (2.0 * small);
        // From rest a step moves by h² F/(2 m).
        let force = 2.0 * mass * (moved[axis] - shift[axis]) / (1e-7 * 1e-7);
        assert!((force / -slope - 1.0).abs() < 1e-5, "axis {axis}: {force} {slope}");
    }
}

#[test]
fn what_makes_no_sheet_is_refused() {
    let good = Grid { rows: 6, columns: [5; 2], diameter: 1e-2, spacing: 1e-2, sides: Sides::Open, joined: false };
    let refused = |grid: Grid| Sheet::new(grid, &metals(), &[&vec![0; grid.len()]], 1e-7, Width::Scalar).unwrap_err();
    assert!(matches!(refused(Grid { rows: 1, ..good }), SheetError::Grid(GridError::Small { .. })));
    assert!(matches!(refused(Grid { columns: [5, 6], ..good }), SheetError::Grid(GridError::Columns(_))));
    assert!(matches!(refused(Grid { rows: 7, joined: true, ..good }), SheetError::Grid(GridError::Odd(7))));
    assert!(matches!(refused(Grid { spacing: 1.1e-2, ..good }), SheetError::Grid(GridError::Spacing { .. })));
    let new = |designs: &[&[u8]], step| Sheet::new(good, &metals(), designs, step, Width::Scalar).unwrap_err();
    assert!(matches!(new(&[&[0; 29]], 1e-7), SheetError::Length { design: 1, given: 29, spheres: 30 }));
    assert!(matches!(new(&[&[3; 30]], 1e-7), SheetError::Materials { materials: 3, used: 3 }));
    assert!(matches!(new(&[&[0; 30], &[0; 30]], 1e-7), SheetError::Designs { designs: 2, lanes: 1 }));
    assert!(matches!(new(&[&[0; 30]], 0.0), SheetError::Step(_)));
    // A step beyond what contacts allow, and an impact beyond the law.
    let mut coarse = Sheet::new(good, &metals(), &[&[0; 30]], 2e-6, Width::Scalar).unwrap();
    coarse.strike(10e3, 20e-6, &[0, 1, 2, 3, 4]);
    assert!(matches!(coarse.advance(640, 1), Err(SheetStop::Step { .. } | SheetStop::Overlap { .. })));
    let mut violent = Sheet::new(good, &metals(), &[&[0; 30]], 1e-7, Width::Scalar).unwrap();
    violent.strike(1e6, 20e-6, &[0, 1, 2, 3, 4]);
    assert!(matches!(violent.advance(640, 1), Err(SheetStop::Overlap { .. })));
}
