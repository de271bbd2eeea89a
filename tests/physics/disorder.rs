//! A hexagonal packing of steel spheres that one sphere strikes: A. Leonard, C. Chong, P. G. Kevrekidis and C. Daraio, Granular Matter 16, 531 (2014),
//! arXiv 1305.0171. Of its text the abstract and introduction were to be had: waves have no constant speed, their decay is predicted by elastic
//! collisions of one sphere with two (the ternary collision approximation), and weak disorder makes amplitudes decay faster along lattice directions.

use std::sync::atomic::AtomicBool;

use granulens::contact::{Constants, LawKind};
use granulens::dem::{ForcePulse, Impact, Integrator, Record, simulate};
use granulens::material::find;
use granulens::sample::{Sample, Sphere};

const DIAMETER: f64 = 19.05e-3;

/// The first sphere comes along the last axis at a speed (m/s).
fn struck(spheres: Vec<Sphere<2>>, speed: f64, window: f64) -> Record<2> {
    let steel = find("302", &[]).unwrap();
    let sample = Sample { materials: vec![steel], spheres };
    let step = 2e-7;
    let impact = Impact {
        mirrors: Vec::new(),
        law: LawKind::Hertz,
        constants: Constants::Code,
        pulse: ForcePulse { force: 0.0, duration: step },
        slope: 0.0,
        struck: vec![0],
        moving: vec![(0, speed)],
        exit: Vec::new(),
        integrator: Integrator::Verlet,
        step,
        window,
    };
    let record = simulate(&sample, &impact, &AtomicBool::new(false)).unwrap();
    assert!(record.stop.is_none(), "{:?}", record.stop);
    record
}

fn sphere(x: f64, z: f64, radius: f64) -> Sphere<2> {
    Sphere { centre: [x * DIAMETER, z * DIAMETER], radius, material: 0 }
}

/// One sphere strikes two that lie 30 degrees to both sides of its way: along the lines of centres u each, so that momentum says v = v' + √3 u, energy v² = v'² + 2 u²,
/// and u = (2√3/5) v, v' = −v/5. While they are pressed together these lines turn by no more than the overlap over the diameter, here 10⁻⁴.
#[test]
fn one_sphere_strikes_two() {
    let (speed, depth) = (0.1, 0.75_f64.sqrt());
    let radius = 0.5 * DIAMETER;
    let record =
        struck(vec![sphere(0.0, 0.0, radius), sphere(-0.5, depth, radius), sphere(0.5, depth, radius)], speed, 400e-6);
    let [first, left, right] = [0, 1, 2].map(|k| record.velocity[k]);
    let u = left[0].hypot(left[1]);
    assert!((u / speed - 2.0 * 3.0_f64.sqrt() / 5.0).abs() < 1e-3, "u/v = {}", u / speed);
    assert!((first[1] / speed + 0.2).abs() < 1e-3, "v'/v = {}", first[1] / speed);
    assert!((left[0] + right[0]).abs() < 1e-12 && (left[1] / u - depth).abs() < 1e-3);
}
