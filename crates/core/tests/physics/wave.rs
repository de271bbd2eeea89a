//! Plane waves in the hexagonal sheet.

use granulens_core::contact::Constants;
use granulens_core::dem::{Integrator, stable_step};
use granulens_core::layout::Layout;
use granulens_core::wave::{Dimension, bound};

use crate::problem::{DIAMETER, impact, run, sheet};
use crate::reference::{Table, difference, material};

/// A sheet that is mirrored every 2.5 D is the sheet of period 5 D of the independent run. Same algorithm, same step.
#[test]
fn a_plane_wave_repeats_the_independent_one_layer_by_layer() {
    let table = Table::read("planar_2D_440c.csv");
    let layout = Layout::new(sheet(50, 2.5), vec![material("440c")], |_| 0);
    let mut impact = impact(&layout.lattice);
    impact.pulse.force = 10_604.643_257_668_553;
    impact.pulse.duration = 100e-6;
    (impact.integrator, impact.step, impact.window) = (Integrator::Rk4, 5e-8, 450e-6);
    let record = run(&layout.sample(), &impact);
    let mass = material("440c").sphere_mass(DIAMETER);
    let mut arrivals = Vec::new();
    for row in 0..table.len() {
        let i = layout.lattice.index(table.number(row, "layer") as u32, 1).unwrap();
        let arrival = record.arrival[i].unwrap();
        assert!(difference(arrival, table.number(row, "arrival"), 0.0) < 1e-8, "layer {row}: {arrival}");
        let speed = (2.0 * record.max_kinetic[i] / mass).sqrt();
        assert!(difference(speed, table.number(row, "max_v"), 0.0) < 1e-8, "layer {row}: {speed}");
        arrivals.push(arrival);
    }
    // Mean local speed between layers 10 and 40 over the two-dimensional bound: 0.9706 (published: about 0.9 and above).
    let steel = material("440c");
    let limit = bound(Dimension::Two, [&steel, &steel], DIAMETER, Constants::Code).speed;
    let speed = 30.0 * layout.lattice.row_spacing() / (arrivals[39] - arrivals[9]);
    assert!((speed / limit - 0.9706).abs() < 1e-4, "{}", speed / limit);
}

/// A row of the sheet under load is a mass on springs; just above the stability limit Verlet must blow up, well
/// below it must not. The limit is that of a sheet all of whose contacts are as stiff as the stiffest.
#[test]
fn the_stability_limit_is_the_period_of_the_stiffest_lattice() {
    // ω² = 4 K/m of a chain, 6 K/m of a hexagonal sheet, 8 K/m of a close-packed crystal; Verlet is stable to h = 2/ω.
    for (limit, factor) in
        [(stable_step::<1>(3e8, 1e-3), 4.0), (stable_step::<2>(3e8, 1e-3), 6.0), (stable_step::<3>(3e8, 1e-3), 8.0)]
    {
        assert!(difference(limit, 2.0 / (factor * 3e8 / 1e-3_f64).sqrt(), 0.0) < 1e-15);
    }
}
