//! What a crystal does depends neither on where it lies, nor on which side is left, nor on how its spheres are numbered; and its
//! contacts push both ways. For the fixed-list simulator; `tests/rig` has the same for rigs, and `tests/repeat` holds batches to the
//! bits of this simulator.
//!
//! Tolerances: the compared runs differ in the rounding of places and in the order of sums, some 10⁻¹⁶ of the forces, which
//! grows by less than 10⁴ in these runs (physics that is not chaotic: a force disturbed by 10⁻¹³ moves the lens's maxima by
//! less than 10⁻¹⁰).

use granulens_core::contact::{Constants, LawKind};
use granulens_core::dem::{ForcePulse, Impact, Integrator, Mirror, Record};
use granulens_core::sample::{Sample, Sphere};
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::{Rng, SeedableRng};

use crate::problem::{DIAMETER, run};
use crate::reference::{difference, material};

const LAWS: [LawKind; 4] = [LawKind::Thesis, LawKind::Consistent, LawKind::Hertz, LawKind::Linear];
const ROWS: usize = 8;
const COLUMNS: usize = 6;
/// Distance of the mirrors, in diameters.
const WIDTH: f64 = 5.5;
const TOLERANCE: f64 = 1e-12;

/// A sheet with three materials by chance between two mirrors, struck on its first row.
fn crystal(seed: u64, law: LawKind) -> (Sample<2>, Impact) {
    let mut chance = Xoshiro256PlusPlus::seed_from_u64(seed);
    let mut spheres = Vec::new();
    for row in 0..ROWS {
        for column in 0..COLUMNS {
            let x = column as f64 + if row % 2 == 1 { 0.5 } else { 0.0 };
            let centre = [x * DIAMETER, row as f64 * 0.75_f64.sqrt() * DIAMETER];
            spheres.push(Sphere { centre, radius: 0.5 * DIAMETER, material: (chance.next_u64() % 3) as usize });
        }
    }
    let sample = Sample { materials: ["440c", "brass", "al"].map(material).to_vec(), spheres };
    let impact = Impact {
        mirrors: vec![
            Mirror { axis: 0, position: 0.0, inward: 1.0 },
            Mirror { axis: 0, position: WIDTH * DIAMETER, inward: -1.0 },
        ],
        law,
        constants: Constants::Code,
        pulse: ForcePulse { force: 5e3, duration: 10e-6 },
        periods: Vec::new(),
        slope: 0.0,
        struck: (0..COLUMNS).collect(),
        faces: Vec::new(),
        moving: Vec::new(),
        projectile: None,
        exit: Vec::new(),
        integrator: Integrator::Verlet,
        step: 1e-7,
        window: 40e-6,
    };
    (sample, impact)
}

/// Compares two runs; sphere k of the first is sphere `place[k]` of the second, whose x is `side` times that of the first.
fn alike(a: &Record<2>, b: &Record<2>, place: &[usize], side: f64, what: &str) {
    let fastest = a.velocity.iter().flatten().fold(0.0_f64, |greatest, v| greatest.max(v.abs()));
    assert!(fastest > 1.0, "{what}: nothing moves");
    for (k, &j) in place.iter().enumerate() {
        let (v, w) = (a.velocity[k], b.velocity[j]);
        let apart = (v[0] - side * w[0]).abs().max((v[1] - w[1]).abs());
        assert!(apart < TOLERANCE * fastest, "{what}: sphere {k} at {v:?} and {w:?}");
        let greatest = a.max_kinetic.iter().copied().fold(0.0, f64::max);
        assert!(difference(a.max_kinetic[k], b.max_kinetic[j], greatest) < TOLERANCE, "{what}: sphere {k}");
    }
    assert!(difference(a.ledger.dissipated, b.ledger.dissipated, a.ledger.work_in) < TOLERANCE, "{what}: dissipated");
}

fn same() -> Vec<usize> {
    (0..ROWS * COLUMNS).collect()
}

#[test]
fn a_shifted_crystal_moves_alike() {
    for (seed, law) in (1..).zip(LAWS) {
        let (sample, impact) = crystal(seed, law);
        let (mut shifted, mut shifted_impact) = (sample.clone(), impact.clone());
        let by = [0.37 * DIAMETER, -11.0 * DIAMETER];
        for sphere in &mut shifted.spheres {
            sphere.centre = [sphere.centre[0] + by[0], sphere.centre[1] + by[1]];
        }
        shifted_impact.mirrors.iter_mut().for_each(|mirror| mirror.position += by[0]);
        // Places so shifted are rounded by 10⁻¹⁵ of a diameter: directions of contacts by as much.
        alike(&run(&sample, &impact), &run(&shifted, &shifted_impact), &same(), 1.0, &format!("{law}"));
    }
}

#[test]
fn a_mirrored_crystal_moves_as_the_mirror_image() {
    for (seed, law) in (11..).zip(LAWS) {
        let (sample, impact) = crystal(seed, law);
        let (mut image, mut image_impact) = (sample.clone(), impact.clone());
        image.spheres.iter_mut().for_each(|sphere| sphere.centre[0] = -sphere.centre[0]);
        for mirror in &mut image_impact.mirrors {
            (mirror.position, mirror.inward) = (-mirror.position, -mirror.inward);
        }
        alike(&run(&sample, &impact), &run(&image, &image_impact), &same(), -1.0, &format!("{law}"));
    }
}

/// Spheres of a row in another order; rows stay in order of depth, as a sample asks.
#[test]
fn renumbered_spheres_move_alike() {
    for (seed, law) in (21..).zip(LAWS) {
        let (sample, impact) = crystal(seed, law);
        let mut chance = Xoshiro256PlusPlus::seed_from_u64(seed);
        let mut order = same();
        for row in order.chunks_mut(COLUMNS) {
            for k in (1..row.len()).rev() {
                row.swap(k, (chance.next_u64() % (k as u64 + 1)) as usize);
            }
        }
        assert_ne!(order, same());
        let renumbered = Sample { spheres: order.iter().map(|&k| sample.spheres[k]).collect(), ..sample.clone() };
        let mut place = same();
        order.iter().enumerate().for_each(|(j, &k)| place[k] = j);
        alike(&run(&sample, &impact), &run(&renumbered, &impact), &place, 1.0, &format!("{law}"));
    }
}

/// Forces are equal and opposite: without mirrors and loads the momentum of a crystal into which some spheres fly stays what it
/// was, to rounding of each of some 400 steps.
#[test]
fn contacts_push_both_ways() {
    for (seed, law) in (31..).zip(LAWS) {
        let (sample, mut impact) = crystal(seed, law);
        impact.mirrors.clear();
        impact.pulse.force = 0.0;
        impact.moving = vec![(0, 8.0), (2, 3.0), (3, 12.0)];
        let record = run(&sample, &impact);
        let before: f64 = impact.moving.iter().map(|&(k, speed)| sample.mass(k) * speed).sum();
        let sum =
            |axis: usize| (0..sample.spheres.len()).map(|k| sample.mass(k) * record.velocity[k][axis]).sum::<f64>();
        assert!((sum(1) / before - 1.0).abs() < 1e-13, "{law}: {} and {before}", sum(1));
        assert!(sum(0).abs() < 1e-13 * before, "{law}: {} across", sum(0));
        let across = record.velocity.iter().map(|v| v[0].abs()).fold(0.0, f64::max);
        assert!(across > 0.1, "{law}: nothing moves across");
    }
}
