//! Waves in chains against independent solutions and the closed-form bound.

use granulens_core::contact::{Constants, LawKind, Pair};
use granulens_core::dem::{ForcePulse, Impact, Integrator};
use granulens_core::material::Material;
use granulens_core::sample::{Sample, Sphere};
use granulens_core::wave::{Dimension, bound};

use crate::problem::{DIAMETER, run};
use crate::reference::{Table, difference, material};

/// Fifty touching spheres of alternating materials; the first is pushed.
fn chain(materials: [Material; 2]) -> Sample<1> {
    let sphere = |k: usize| Sphere { centre: [k as f64 * DIAMETER], radius: 0.5 * DIAMETER, material: k % 2 };
    Sample { materials: materials.to_vec(), spheres: (0..50).map(sphere).collect() }
}

fn push(force: f64, window: f64) -> Impact {
    Impact {
        mirrors: Vec::new(),
        law: LawKind::Thesis,
        constants: Constants::Code,
        pulse: ForcePulse { force, duration: 100e-6 },
        periods: Vec::new(),
        slope: 0.0,
        struck: vec![0],
        faces: Vec::new(),
        moving: Vec::new(),
        projectile: None,
        exit: vec![49],
        integrator: Integrator::Rk4,
        step: 5e-8,
        window,
    }
}

/// The same algorithm at the same step: rounding, and its growth over 14 000 steps.
#[test]
fn chains_repeat_the_independent_ones_sphere_by_sphere() {
    for (file, names) in [
        ("chain_440c-440c_dt5e-08.csv", ["440c", "440c"]),
        ("chain_brass-440c_dt5e-08.csv", ["brass", "440c"]),
        ("chain_brass-brass_dt5e-08.csv", ["brass", "brass"]),
    ] {
        let sample = chain(names.map(material));
        let [a, b] = [&sample.materials[0], &sample.materials[1]];
        let force = 2.0 * Pair::new([a, b], [0.5 * DIAMETER; 2], Constants::Code).plastic_force();
        let record = run(&sample, &push(force, 700e-6));
        let table = Table::read(file);
        for row in 0..table.len() {
            let i = table.number(row, "sphere") as usize - 1;
            for (ours, column) in [(record.arrival[i].unwrap(), "arrival"), (record.max_kinetic[i], "maxKE")] {
                let theirs = table.number(row, column);
                assert!(difference(ours, theirs, 0.0) < 1e-7, "{file} sphere {}: {column} {ours}, {theirs}", i + 1);
            }
        }
    }
}

/// How near waves come to the bound, by the contact force over F_p, rate off (E 100 GPa, σ_y 500 MPa, 5000 kg/m³, 20 to 40
/// spheres behind the first ten): 0.84, 0.89, 0.95, 0.98, 1.00 at 1, 2, 5, 10, 17, to the digits given. At 17 it is no
/// strict bound.
#[test]
fn waves_come_as_near_to_the_bound_as_their_amplitude_allows() {
    let mut model = material("440c");
    (model.youngs_modulus, model.yield_stress, model.density) = (100e9, 500e6, 5000.0);
    let limit = bound(Dimension::One, [&model, &model], DIAMETER, Constants::Code);
    for (amplitude, reached) in [(1.0, 0.84), (2.0, 0.89), (5.0, 0.95), (10.0, 0.98), (17.0, 1.00)] {
        let mut impact = push(amplitude * limit.plastic_force, 700e-6);
        impact.law = LawKind::ThesisStatic;
        let record = run(&chain([model.clone(), model.clone()]), &impact);
        let [first, last] = [9, 39].map(|i| record.arrival[i].unwrap());
        let ours = 30.0 * DIAMETER / (last - first) / limit.speed;
        println!("{amplitude} F_p: {ours}");
        assert!((ours - reached).abs() <= 0.005, "{amplitude} F_p: {ours} and {reached}");
    }
}
