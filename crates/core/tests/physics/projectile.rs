//! A flat that strikes a crystal, against closed forms, a conservation law, and the same blow as a rig.

use granulens_core::Context;
use granulens_core::contact::{Constants, Hertz, LawKind, Pair};
use granulens_core::dem::rig::simulate_as_rig;
use granulens_core::dem::{
    ForcePulse, Impact, Integrator, Mirror, MoveIn, Projectile, Record, Spheres, simulate, simulate_batch,
    simulate_batch_under,
};
use granulens_core::lattice::{Block, BlockSide, Cell, Layered};
use granulens_core::real::Width;
use granulens_core::sample::{Sample, Sphere};
use granulens_core::wave::{Dimension, bound, driving_force};

use crate::problem::{DIAMETER, run};
use crate::reference::{difference, material};

fn impact(struck: Vec<usize>, projectile: Projectile) -> Impact {
    Impact {
        mirrors: Vec::new(),
        law: LawKind::Thesis,
        constants: Constants::Code,
        pulse: ForcePulse { force: 0.0, duration: 0.0 },
        periods: Vec::new(),
        slope: 0.0,
        struck,
        faces: Vec::new(),
        moving: Vec::new(),
        projectile: Some(projectile),
        exit: Vec::new(),
        integrator: Integrator::Adams,
        step: 1e-7,
        window: 60e-6,
    }
}

fn sphere<const D: usize>(centre: [f64; D], material: usize) -> Sphere<D> {
    Sphere { centre, radius: 0.5 * DIAMETER, material }
}

/// One sphere and a flat of mass M under Hertz's law: an elastic collision, after which v = 2 M u/(M + m) and V = (M − m) u/(M + m); and at closest
/// approach 1/2 μ u² = 1/2 (2/5) k δ^{5/2}, the contact with the image taking twice the flat's way. Tolerance: a contact is cut into
/// some 400 steps, and opens and closes within one.
#[test]
fn a_flat_hands_a_sphere_what_an_elastic_collision_does() {
    let steel = material("440c");
    let sample = Sample { materials: vec![steel.clone()], spheres: vec![sphere([0.0], 0)] };
    let hertz = Hertz::new(&Pair::new([&steel, &steel], [0.5 * DIAMETER; 2], Constants::Code));
    let m = sample.mass(0);
    for (of_sphere, speed) in [(20.0, 2.0), (3.0, 2.0), (0.4, 5.0)] {
        let mass = of_sphere * m;
        for integrator in [Integrator::Verlet, Integrator::Adams, Integrator::Rk4] {
            let projectile = Projectile { mass, speed, front: None };
            let impact = Impact { law: LawKind::Hertz, integrator, ..impact(vec![0], projectile) };
            let record = run(&sample, &Impact { window: 100e-6, ..impact });
            assert_eq!(record.stop, None);
            let [_, after] = record.projectile.unwrap();
            let reduced = mass * m / (mass + m);
            for (ours, exact) in [
                (record.velocity[0][0], 2.0 * mass * speed / (mass + m)),
                (after, (mass - m) * speed / (mass + m)),
                (record.contacts[0].overlap_max, (2.5 * reduced * speed * speed / hertz.coefficient).powf(0.4)),
            ] {
                let off = (ours - exact).abs() / exact.abs().max(0.01 * speed * exact.abs());
                assert!(
                    (ours - exact).abs() < 1e-4 * exact.abs().max(speed),
                    "{integrator} {of_sphere}: {ours} {exact} {off:e}"
                );
            }
            assert!(record.ledger.residual().unwrap().abs() < 1e-4, "{:?}", record.ledger);
        }
    }
}

/// A heavy flat that drives a wave into a chain of linear springs loses what the wave takes up, F = m v V/h: in the mean over its first 150 spheres, of which the
/// front, which begins with a whole sphere at once and spreads with the cube root of the way, is 1 or 2.
#[test]
fn a_heavy_flat_drives_a_wave_of_its_own_speed() {
    for name in ["440c", "brass"] {
        let of = material(name);
        let spheres = (0..200).map(|k| sphere([f64::from(k) * DIAMETER], 0)).collect();
        let sample = Sample { materials: vec![of.clone()], spheres };
        let (mass, speed) = (1e7 * sample.mass(0), 3.0);
        let wave = bound(Dimension::One, [&of; 2], DIAMETER, Constants::Code).speed;
        let window = 150.0 * DIAMETER / wave;
        let impact = impact(vec![0], Projectile { mass, speed, front: None });
        let record = run(&sample, &Impact { law: LawKind::LinearStatic, window, ..impact });
        let time = record.steps as f64 * 1e-7;
        let force = mass * (speed - record.projectile.unwrap()[1]) / time;
        let expected = driving_force(Dimension::One, speed, &of, DIAMETER, Constants::Code);
        assert!((force / expected - 1.0).abs() < 0.015, "{name}: {force} {expected}");
    }
}

/// 440c with brass in it, in the half of a sheet between mirrors, or in the half x >= 0 of a block in space.
fn sheet() -> (Sample<2>, Impact) {
    let mut spheres = Vec::new();
    let mut struck = Vec::new();
    for row in 0..12_usize {
        for column in 0..6_usize {
            let x = (column as f64 + if row % 2 == 1 { 0.5 } else { 0.0 }) * DIAMETER;
            if row == 0 {
                struck.push(spheres.len());
            }
            let brass = (3..6).contains(&row) && column < 3;
            spheres.push(sphere([x, row as f64 * 0.75_f64.sqrt() * DIAMETER], usize::from(brass)));
        }
    }
    let sample = Sample { materials: vec![material("440c"), material("brass")], spheres };
    let mirrors = vec![
        Mirror { axis: 0, position: 0.0, inward: 1.0 },
        Mirror { axis: 0, position: 5.5 * DIAMETER, inward: -1.0 },
    ];
    let impact = Impact { mirrors, ..impact(struck, Projectile { mass: 10e-3, speed: 15.0, front: None }) };
    (sample, impact)
}

fn block() -> (Block, Sample<3>, Impact) {
    let block = Block::new(Cell::<3>::named("hcp").unwrap(), DIAMETER, 8, [6, 3], 3, [BlockSide::Free; 2]).unwrap();
    let brass = |site: &granulens_core::lattice::CrystalSite<3>| {
        usize::from((3..5).contains(&site.layer) && site.centre[0].hypot(site.centre[1]) < 1.6 * DIAMETER)
    };
    let spheres = block.sites().iter().map(|site| sphere(site.centre, brass(site))).collect();
    let sample = Sample { materials: vec![material("440c"), material("brass")], spheres };
    let mirrors = vec![Mirror { axis: 0, position: 0.0, inward: 1.0 }];
    let impact =
        Impact { mirrors, ..impact(block.layer(1).collect(), Projectile { mass: 30e-3, speed: 15.0, front: None }) };
    (block, sample, impact)
}

/// Momentum along the axis: what the flat has lost the simulated parts of the spheres have, by Newton's third law, to rounding; and energy.
fn conserves<const D: usize>(sample: &Sample<D>, impact: &Impact, record: &Record<D>) {
    let Projectile { mass, speed, .. } = impact.projectile.unwrap();
    let part = |i: usize| {
        let on = impact.mirrors.iter().filter(|mirror| mirror.carries(&sample.spheres[i].centre, 1e-3)).count();
        0.5_f64.powi(on as i32)
    };
    let spheres = 0..sample.spheres.len();
    let given: f64 = spheres.map(|i| part(i) * sample.mass(i) * record.velocity[i][D - 1]).sum();
    let lost = mass * (speed - record.projectile.unwrap()[1]);
    assert!(given > 0.5 * mass * speed && difference(given, lost, 0.0) < 1e-10, "{given} {lost}");
    assert!(record.ledger.residual().unwrap().abs() < 1e-4, "{:?}", record.ledger);
}

/// As a rig with a flat, whose contacts are looked for and whose flat is a body of its own: the same table of coefficients, other orders of sums.
fn moves_as_a_rig<const D: usize>(sample: &Sample<D>, impact: &Impact)
where
    Spheres: MoveIn<D>,
{
    for integrator in [Integrator::Verlet, Integrator::Adams] {
        let impact = Impact { integrator, ..impact.clone() };
        let never = Context::default();
        let record = simulate(sample, &impact, &never).unwrap();
        let again = simulate_as_rig(sample, &impact, None, &never).unwrap();
        assert_eq!((&record.stop, &again.stop), (&None, &None));
        for i in 0..sample.spheres.len() {
            for (a, b) in [
                (again.max_kinetic[i], record.max_kinetic[i]),
                (again.max_net_force[i], record.max_net_force[i]),
                // A rig tells of contacts between spheres alone.
                (
                    again.max_contact_force[i],
                    if impact.struck.contains(&i) { again.max_contact_force[i] } else { record.max_contact_force[i] },
                ),
            ] {
                assert!(difference(a, b, 1e-6) < 1e-8, "{integrator} sphere {i}: {a} {b}");
            }
        }
        for (a, b) in again.projectile.unwrap().into_iter().zip(record.projectile.unwrap()) {
            assert!(difference(a, b, 0.0) < 1e-9, "{integrator}: {a} {b}");
        }
        assert!(difference(again.ledger.work_in, record.ledger.work_in, 0.0) < 1e-12);
        conserves(sample, &impact, &record);
    }
}

#[test]
fn a_flat_strikes_a_sheet_as_it_does_a_rig() {
    let (sample, impact) = sheet();
    moves_as_a_rig(&sample, &impact);
}

#[test]
fn a_flat_strikes_a_crystal_in_space_as_it_does_a_rig() {
    let (_, sample, impact) = block();
    moves_as_a_rig(&sample, &impact);
}

/// Side by side, each with a speed of its own, to the bit as alone; and half the crystal under half the flat is the whole under the whole.
#[test]
fn flats_in_lanes_and_on_the_whole_crystal_are_those_of_the_half() {
    let never = Context::default();
    let (sample, impact) = sheet();
    let speeds: Vec<Projectile> =
        (0..5).map(|k| Projectile { mass: 10e-3, speed: 12.0 + 1.5 * f64::from(k), front: None }).collect();
    let samples = vec![sample.clone(); speeds.len()];
    for width in [Width::Scalar, Width::widest()] {
        let briefs = simulate_batch_under(&samples, &impact, &speeds, None, None, width, &never).unwrap();
        for (brief, &projectile) in briefs.iter().zip(&speeds) {
            let alone = run(&sample, &Impact { projectile: Some(projectile), ..impact.clone() });
            assert_eq!((&brief.max_kinetic, &brief.stop), (&alone.max_kinetic, &None));
        }
    }
    let (block, sample, impact) = block();
    let alone = run(&sample, &impact);
    assert_eq!(
        simulate_batch(std::slice::from_ref(&sample), &impact, Width::widest(), &never).unwrap()[0].max_kinetic,
        alone.max_kinetic
    );
    let (mut whole, mut images) = (sample.clone(), Vec::new());
    whole.spheres.clear();
    for (i, (sphere, &copies)) in sample.spheres.iter().zip(block.copies()).enumerate() {
        let [x, y, z] = sphere.centre;
        for x in [x, -x].into_iter().take(usize::from(copies)) {
            whole.spheres.push(Sphere { centre: [x, y, z], ..*sphere });
            images.push(i);
        }
    }
    let struck = (0..images.len()).filter(|&k| block.layer(1).contains(&images[k])).collect();
    let projectile = impact.projectile.map(|flat| Projectile { mass: 2.0 * flat.mass, ..flat });
    let both = run(&whole, &Impact { mirrors: Vec::new(), struck, projectile, ..impact });
    for (k, &i) in images.iter().enumerate() {
        let off = difference(both.max_kinetic[k], alone.max_kinetic[i], 1e-12);
        assert!(off < 1e-9, "sphere {k}: {off:e}");
    }
    for (a, b) in both.projectile.unwrap().into_iter().zip(alone.projectile.unwrap()) {
        assert!(difference(a, b, 0.0) < 1e-10, "{a} {b}");
    }
}
