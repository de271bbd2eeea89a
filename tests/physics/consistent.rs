//! The energy-consistent law against the published one: collisions, chains and the lens.

use granulens::contact::{Constants, Hertz, LawKind, Pair};
use granulens::dem::{ForcePulse, Impact, Integrator, Record};
use granulens::sample::{Sample, Sphere};
use rayon::prelude::*;

use crate::collision::collide;
use crate::lens::{scores, solve};
use crate::problem::{DIAMETER, is_lens, layout, run};
use crate::reference::{difference, material};

const NAMES: [&str; 4] = ["440c", "brass", "302", "al"];

fn pairs() -> Vec<[&'static str; 2]> {
    (0..4).flat_map(|a| (a..4).map(move |b| [NAMES[a], NAMES[b]])).collect()
}

fn restitution(law: LawKind, names: [&str; 2], speed: f64, refine: f64) -> f64 {
    let [a, b] = names.map(material);
    let mass = 1.0 / (1.0 / a.sphere_mass(DIAMETER) + 1.0 / b.sphere_mass(DIAMETER));
    let pair = Pair::new([&a, &b], [0.5 * DIAMETER; 2], Constants::Code);
    let k = Hertz::new(&pair).coefficient;
    let elastic = 2.943_275 * (5.0 * mass * speed * speed / (4.0 * k)).powf(0.4) / speed;
    let plastic = std::f64::consts::PI * (mass / pair.plastic_stiffness()).sqrt();
    let duration = elastic.max(plastic);
    let (_, record) = collide(names, speed, |i| {
        (i.law, i.integrator) = (law, Integrator::Verlet);
        (i.step, i.window) = (duration / (8000.0 * refine), 1.5 * duration);
    });
    (record.velocity[1][0] - record.velocity[0][0]) / speed
}

fn yield_speed(names: [&str; 2]) -> f64 {
    let [a, b] = names.map(material);
    let mass = 1.0 / (1.0 / a.sphere_mass(DIAMETER) + 1.0 / b.sphere_mass(DIAMETER));
    let pair = Pair::new([&a, &b], [0.5 * DIAMETER; 2], Constants::Code);
    let regions = pair.regions(1.0);
    (0.8 * regions.yield_force * regions.yield_overlap / mass).sqrt()
}

#[test]
fn explore_collisions() {
    for names in pairs() {
        println!("{names:?} yield speed {:.4}", yield_speed(names));
        for k in 0..=22 {
            let speed = 0.01 * 5000_f64.powf(f64::from(k) / 22.0);
            let e = [LawKind::Thesis, LawKind::Consistent].map(|law| restitution(law, names, speed, 1.0));
            let fine = restitution(LawKind::Consistent, names, speed, 4.0);
            println!("{speed:9.4} {:.5} {:.5} {:.1e}", e[0], e[1], e[1] - fine);
        }
        for speed in [5.0, 20.0] {
            let e = [LawKind::Thesis, LawKind::Consistent].map(|law| restitution(law, names, speed, 1.0));
            println!("{speed:9.4} {:.5} {:.5} ", e[0], e[1]);
        }
    }
}

fn chain(names: [&str; 2], law: LawKind, step: f64) -> Record<1> {
    let materials = names.map(material);
    let radius = 0.5 * DIAMETER;
    let pair = Pair::new([&materials[0], &materials[1]], [radius; 2], Constants::Code);
    let sample = Sample {
        materials: materials.to_vec(),
        spheres: (0..50)
            .map(|i| Sphere { centre: [f64::from(i) * DIAMETER], radius, material: (i % 2) as usize })
            .collect(),
    };
    run(
        &sample,
        &Impact {
            mirrors: Vec::new(),
            law,
            constants: Constants::Code,
            pulse: ForcePulse { force: 2.0 * pair.plastic_force(), duration: 100e-6 },
            struck: vec![0],
            moving: Vec::new(),
            exit: vec![49],
            integrator: Integrator::Verlet,
            step,
            window: 700e-6,
        },
    )
}

#[test]
fn explore_chains() {
    for names in [["440c", "440c"], ["brass", "440c"], ["brass", "brass"]] {
        let of = |law, step| {
            let record = chain(names, law, step);
            let at = |i: usize| record.arrival[i].unwrap();
            (
                30.0 * DIAMETER / (at(39) - at(9)),
                record.ledger.dissipated,
                record.max_kinetic[30],
                record.ledger.residual(),
            )
        };
        println!(
            "{names:?} {:?} {:?} {:?}",
            of(LawKind::Thesis, 5e-8),
            of(LawKind::Consistent, 5e-8),
            of(LawKind::Consistent, 1e-8)
        );
    }
}

#[test]
fn explore_lens() {
    let layout = layout(is_lens);
    let mut runs = Vec::new();
    for (force, window) in [(26e3, 250e-6), (10.5e3, 350e-6)] {
        for law in [LawKind::Thesis, LawKind::Consistent, LawKind::ThesisStatic] {
            for step in [4e-7, 10.0 / 3.0 * 1e-7, 20e-6 / 70.0, 2.5e-7, 2e-7, 1e-7, 5e-8, 2e-8] {
                runs.push((force, window, law, step));
            }
        }
    }
    let lines: Vec<String> = runs.into_par_iter().map(|(force, window, law, step)| {
        let record = solve(&layout, |i| (i.law, i.step, i.window, i.pulse.force) = (law, step, window, force));
        let [f, p] = scores(&record, &layout);
        let peak = record.max_contact_force.iter().copied().fold(0.0, f64::max);
        format!("{force} {law} {step:.2e}: F {f:.6} P {p:.6} F/P {:.4} peak {peak:.0} over {:.3} {:?} residual {:.1e} {:?}", f / p, peak * 3_f64.sqrt()/ force, record.ledger.dissipated, record.ledger.residual().unwrap(), record.stop)
    }).collect();
    println!("{}", lines.join("\n"));
}

#[allow(dead_code)]
fn _unused() {
    let _ = difference(0.0, 0.0, 0.0);
}
