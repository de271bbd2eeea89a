//! The lens problem against independent solutions.

use granulens::dem::{Impact, Integrator, Record};
use granulens::layout::Layout;

use granulens::target::Region;

use crate::problem::{DIAMETER, impact, is_lens, layout, run};
use crate::reference::{Table, difference};

pub fn solve(layout: &Layout, change: impl Fn(&mut Impact)) -> Record<2> {
    let mut impact = impact(&layout.lattice);
    change(&mut impact);
    run(&layout.sample(), &impact)
}

/// The same algorithm at the same step. The problem is not chaotic within 300 µs: a force perturbed by 1e-13 changes
/// maxima by less than 1e-10, so rounding leaves about 1e-9.
#[test]
fn runge_kutta_repeats_the_independent_solution_sphere_by_sphere() {
    for (file, brass) in [("lens_lens_26kN_dt5e-08.csv", true), ("lens_440c_26kN_dt5e-08.csv", false)] {
        let layout = layout(|site| brass && is_lens(site));
        let record = solve(&layout, |i| {
            (i.integrator, i.step, i.window) = (Integrator::Rk4, 5e-8, 300e-6);
        });
        assert_eq!(record.stop, None);
        assert_eq!(record.missed_contact, None);
        let table = Table::read(file);
        assert_eq!(table.len(), record.max_kinetic.len());
        for i in 0..table.len() {
            let same = table.text(i, "mat") == if layout.materials[i] == 1 { "brass" } else { "440c" };
            assert!(same, "{file}: material of sphere {i}");
            for (ours, column) in [
                (record.max_kinetic[i], "maxKE_300us"),
                (record.max_net_force[i], "max_net_force"),
                (record.max_contact_force[i], "max_contact_force"),
            ] {
                let theirs = table.number(i, column);
                assert!(difference(ours, theirs, 0.0) < 1e-8, "{file} sphere {i} {column}: {ours} and {theirs}");
            }
            let sites = layout.lattice.sites();
            for (ours, column) in
                [(sites[i].x + record.displacement[i][0], "x_end"), (sites[i].z + record.displacement[i][1], "z_end")]
            {
                // A millionth of a diameter is far above rounding after 6000 steps and far below any motion of interest.
                let theirs = table.number(i, column);
                assert!((ours - theirs).abs() < 1e-6 * DIAMETER, "{file} sphere {i} {column}: {ours} and {theirs}");
            }
        }
    }
}

fn mean(record: &Record<2>, layout: &Layout, rows: [u32; 2], x: [f64; 2]) -> f64 {
    let region = Region { rows, x: x.map(|x| x * DIAMETER) };
    let inside = region.sites(&layout.lattice);
    inside.iter().map(|&i| record.max_kinetic[i]).sum::<f64>() / inside.len() as f64
}

/// F and P of the lens problem's regions.
pub fn scores(record: &Record<2>, layout: &Layout) -> [f64; 2] {
    [mean(record, layout, [30, 34], [0.0, 2.5]), mean(record, layout, [30, 34], [12.0, 16.5])]
}

/// Against the converged solution (0..250 µs): 1 % at 4e-7 s and 0.1 % at 1e-7 s are the accuracy classes that the step is
/// chosen by.
#[test]
fn velocity_verlet_reaches_its_accuracy_classes() {
    let layout = layout(is_lens);
    for (step, accuracy) in [(4e-7, 1e-2), (1e-7, 1e-3)] {
        let record = solve(&layout, |i| i.step = step);
        let ours = scores(&record, &layout);
        for (ours, converged) in ours.iter().zip([0.331_306, 0.135_892]) {
            assert!(difference(*ours, converged, 0.0) < accuracy, "step {step}: {ours} and {converged}");
        }
        println!("step {step}: {ours:?} residual {:?}", record.ledger.residual());
    }
}

/// Energy at the end of the published problem's 300 µs, against the independent run with the finest step. The ledger must
/// close to 2e-4 at 1e-7 s.
#[test]
fn energy_of_the_lens_problem() {
    let layout = layout(is_lens);
    let record = solve(&layout, |i| i.window = 300e-6);
    let ledger = record.ledger;
    assert!(ledger.residual().unwrap().abs() < 2e-4, "{ledger:?}");
    for (ours, theirs) in [
        (ledger.work_in, 734.336_045),
        (ledger.kinetic, 59.538_916),
        (ledger.dissipated, 673.924_305),
        (ledger.estimate, 935.562_076),
    ] {
        // The accuracy class of the step.
        assert!(difference(ours, theirs, 0.0) < 1e-3, "{ours} and {theirs}: {ledger:?}");
    }
    // Losses shared out to spheres are the losses of the contacts.
    let weights = layout.lattice.sites().into_iter().map(|s| {
        let on_mirror = s.x < 1e-9 || (s.x - layout.lattice.half_width()).abs() < 1e-9;
        if on_mirror { 0.5 } else { 1.0 }
    });
    let shared: f64 = weights.zip(&record.dissipated).map(|(w, d)| w * d).sum();
    assert!(difference(shared, ledger.dissipated, 0.0) < 1e-12, "{shared}");
}
