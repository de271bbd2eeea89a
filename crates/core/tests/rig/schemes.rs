//! Rigs by Adams's scheme: its order, and what it does to all that moves.

use granulens_core::contact::LawKind;
use granulens_core::dem::Integrator::{self, Adams, Rk4, Verlet};
use granulens_core::dem::rig::{
    Bar, Body, Cluster, Curve, Face, Flat, Friction, Law, LawBook, Load, LoadKind, Rig, RigError, Simulation,
};
use granulens_core::dem::{MoveIn, Spheres};

use crate::rigs::{DIAMETER, GO, rig};

fn end<const D: usize>(integrator: Integrator, rig: &Rig<D>, step: f64, time: f64) -> Simulation<D>
where
    Spheres: MoveIn<D>,
{
    let mut simulation = Simulation::by(integrator, rig.clone(), step).unwrap();
    simulation.advance((time / step).round() as u64, &GO).unwrap();
    simulation
}

/// Two spheres against each other under Hertz's law, within the contact, whose energy is as it was: of fourth order by Adams's scheme, of second by
/// Verlet's (as crystals: `physics::collision`). The errors that the first steps make are there both times.
#[test]
fn a_contact_is_of_fourth_order() {
    let mut pair = rig(&[[0.0], [1.0]], LawKind::Hertz);
    pair.velocity[0] = [5.0];
    let energy = |integrator, step: f64, time| {
        let simulation = end(integrator, &pair, step, time);
        // Verlet's balance holds back what the scheme does; energies themselves are asked for.
        simulation.ledger().kinetic + simulation.ledger().stored
    };
    let error = |integrator, step: f64| (energy(integrator, step, 12e-6) / energy(integrator, step, 4e-6) - 1.0).abs();
    let ratio = |integrator| (error(integrator, 1e-7) / error(integrator, 5e-8)).log2();
    let (adams, verlet) = (ratio(Adams), ratio(Verlet));
    assert!((3.7..4.1).contains(&adams), "{adams}");
    assert!((1.9..2.1).contains(&verlet), "{verlet}");
}

/// A plate on a bar: v = v₀ e^(−Z t/m), with the corrector in the implicit equation of the new velocity. What went before the start is taken to be as it is
/// there, which costs the first steps their order; so two later moments are compared. What the bar takes is what the plate loses.
#[test]
fn a_bar_is_of_fourth_order() {
    let mut rig = rig(&[[9.0, 0.0]], LawKind::Hertz);
    let ram = Flat::wall("ram", [0.0, -1.0], [0.0, 1.0]);
    rig.flats = vec![Flat { mass: 2.0, velocity: [0.0, 3.0], held: [false; 2], ..ram }];
    rig.bars = vec![Bar { body: Body::Flat(0), axis: 1, impedance: 4000.0, incident: None }];
    let velocity = |integrator, step, time| end(integrator, &rig, step, time).view().flat(0).velocity[1];
    let error = |integrator, step| {
        (velocity(integrator, step, 1e-3) / velocity(integrator, step, 4e-4) / f64::exp(-1.2) - 1.0).abs()
    };
    let [adams, verlet] = [Adams, Verlet].map(|scheme| (error(scheme, 2e-5) / error(scheme, 1e-5)).log2());
    assert!((3.7..4.3).contains(&adams) && (1.9..2.1).contains(&verlet), "{adams} {verlet}");
    let simulation = end(Adams, &rig, 1e-6, 1e-3);
    assert!((simulation.ledger().absorbed / (9.0 * (1.0 - f64::exp(-4.0))) - 1.0).abs() < 1e-5);
}

/// A fall from rest is exact, of a sphere, of a plate and of a cluster, and so is a constant load; the balance closes.
#[test]
fn a_fall_is_exact() {
    let mut rig = rig(&[[0.0, 0.0], [3.0, 0.0], [4.0, 0.0]], LawKind::Hertz);
    rig.gravity = [0.0, 9.81];
    rig.flats =
        vec![Flat { mass: 2.0, velocity: [0.0; 2], held: [false; 2], ..Flat::wall("ram", [0.0, -1.0], [0.0, 1.0]) }];
    rig.clusters = vec![Cluster {
        members: vec![1, 2],
        centre: [3.5 * DIAMETER, 0.0],
        mass: 2e-3,
        inertia: 1e-8,
        turns: true,
        velocity: [0.0; 2],
        spin: 40.0,
    }];
    let push = 2.0;
    rig.loads = vec![Load {
        bodies: vec![Body::Sphere(0)],
        direction: [1.0, 0.0],
        kind: LoadKind::Force,
        curve: Curve::Square { peak: push, start: 0.0, duration: 1.0 },
    }];
    let simulation = end(Adams, &rig, 1e-6, 1e-3);
    let (view, t) = (simulation.view(), 1e-3);
    let fallen = 0.5 * 9.81 * t * t;
    for way in [view.displacement(0)[1], view.flat(0).moved[1], view.cluster(0).moved[1]] {
        assert!((way / fallen - 1.0).abs() < 1e-9, "{way} {fallen}");
    }
    assert!((view.displacement(0)[0] / (0.5 * push / rig.mass[0] * t * t) - 1.0).abs() < 1e-9);
    assert!((view.cluster(0).angle - 40.0 * t).abs() < 1e-12);
    assert!(simulation.ledger().residual().unwrap().abs() < 1e-9);
}

/// What friction does is the same by both schemes but for their errors: an oblique blow of two balls, one of them a cluster's, and of
/// a ball on a plate of finite mass.
#[test]
fn friction_flats_and_clusters_come_to_the_same() {
    let mut rig = rig(&[[0.0, 0.0], [0.6, 0.8], [1.6, 0.8], [-1.0, 3.0]], LawKind::Hertz);
    rig.laws = LawBook::Materials {
        law: Law::Named(LawKind::Hertz),
        constants: Default::default(),
        pairs: Vec::new(),
        friction: Some(Friction::mindlin(0.3)),
    };
    rig.velocity[0] = [0.0, 4.0];
    rig.velocity[3] = [2.0, -3.0];
    let mass = rig.mass[0];
    rig.clusters = vec![Cluster {
        members: vec![1, 2],
        centre: [1.1 * DIAMETER, 0.8 * DIAMETER],
        mass: 2.0 * mass,
        inertia: 2.0 * (rig.inertia[1] + mass * (0.5 * DIAMETER).powi(2)),
        turns: true,
        velocity: [0.0; 2],
        spin: 0.0,
    }];
    rig.flats = vec![Flat {
        face: Face::Plane,
        mass: 0.01,
        velocity: [0.0; 2],
        held: [false; 2],
        ..Flat::wall("plate", [0.0, 3.51 * DIAMETER], [0.0, -1.0])
    }];
    rig.velocity[3] = [2.0, 3.0];
    let numbers = |integrator, step: f64| {
        let simulation = end(integrator, &rig, step, 100e-6);
        let (view, cluster) = (simulation.view(), simulation.view().cluster(0));
        let spins = [view.spin(0)[2], view.spin(3)[2], cluster.spin];
        [view.velocity(0), view.velocity(3), cluster.velocity, view.flat(0).velocity]
            .into_iter()
            .flatten()
            .chain(spins.map(|spin| 0.5 * DIAMETER * spin))
            .collect::<Vec<f64>>()
    };
    let exact = numbers(Verlet, 5e-9);
    let error = |found: Vec<f64>| exact.iter().zip(found).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    let [coarse, fine] = [1e-7, 2.5e-8].map(|step| error(numbers(Adams, step)));
    // Contacts begin and end within steps, which is of first order or better: a quarter of the step.
    assert!(coarse < 1e-3 && fine < 0.3 * coarse, "{coarse} {fine}");
    assert!(exact[6..8].iter().any(|v| v.abs() > 1e-2) && exact[8..].iter().all(|v| v.abs() > 0.05), "{exact:?}");
}

#[test]
fn runge_kutta_is_refused() {
    let refused = Simulation::by(Rk4, rig(&[[0.0, 0.0]], LawKind::Hertz), 1e-7).err();
    assert_eq!(refused, Some(RigError::Scheme(Rk4)));
    assert!(refused.unwrap().to_string().contains("verlet or adams, not by rk4"));
}
