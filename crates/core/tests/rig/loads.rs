//! Loads, bars and flats on single bodies, against closed forms.

use granulens_core::contact::LawKind;
use granulens_core::dem::rig::{Bar, Body, Cluster, Curve, Face, Flat, Load, LoadKind, Simulation};

use crate::reference::difference;
use crate::rigs::{DIAMETER, GO, rig, run};

/// A free sphere under each pulse: its final velocity is the impulse over the mass, exactly; its displacement after the pulse
/// is that of a symmetric pulse, J/m (t − T/2), to the second order of the step.
#[test]
fn a_free_sphere_takes_up_the_impulse() {
    let (peak, start, duration) = (1000.0, 3.3e-6, 20e-6);
    let curves = [
        Curve::Square { peak, start, duration },
        Curve::HalfSine { peak, start, duration },
        Curve::Triangle { peak, start, duration },
        Curve::table(&[(3e-6, 0.0), (8e-6, 900.0), (18e-6, 900.0), (23e-6, 0.0)]).unwrap(),
    ];
    for curve in curves {
        let mut rig = rig(&[[0.0, 0.0]], LawKind::Thesis);
        let mass = rig.mass[0];
        let impulse = curve.integral(1.0);
        let middle = 0.5 * curve.end() + 0.5 * if let Curve::Table(_) = curve { 3e-6 } else { start };
        rig.loads = vec![Load {
            bodies: vec![Body::Sphere(0)],
            direction: [0.6, 0.8],
            kind: LoadKind::Force,
            curve: curve.clone(),
        }];
        let simulation = run(rig, 7e-7, 50);
        let (view, time) = (simulation.view(), simulation.time());
        let [vx, vz] = view.velocity(0);
        assert!((vx / (0.6 * impulse / mass) - 1.0).abs() < 1e-12 && (vz / vx - 0.8 / 0.6).abs() < 1e-12);
        // The mean force of each step counts as constant in it: (h/T)²/6 of the way at most.
        let way = impulse / mass * (time - middle);
        assert!((view.displacement(0)[0] / (0.6 * way) - 1.0).abs() < 3e-4, "{curve:?}");
        assert!(simulation.ledger().residual().unwrap().abs() < 1e-12, "work of a force is exact");
    }
}

/// A sphere whose velocity is prescribed for a while follows it whatever it pushes, then is free: it is slowed by the
/// sphere it pushes only after the end. The work put in is what the ledger finds.
#[test]
fn a_prescribed_velocity_overrules_contacts_until_it_ends() {
    let mut rig = rig(&[[0.0, 0.0], [0.0, 1.0]], LawKind::Thesis);
    rig.loads = vec![Load {
        bodies: vec![Body::Sphere(0)],
        direction: [0.0, 1.0],
        kind: LoadKind::Velocity,
        curve: Curve::Square { peak: 5.0, start: 0.0, duration: 10e-6 },
    }];
    let mut simulation = Simulation::new(rig, 5e-8).unwrap();
    simulation.advance(199, &GO).unwrap();
    assert_eq!(simulation.view().velocity(0), [0.0, 5.0]);
    let moved = simulation.view().displacement(0)[1];
    assert!((moved - 5.0 * simulation.time()).abs() < 1e-15);
    assert!(simulation.view().velocity(1)[1] > 0.5);
    simulation.advance(401, &GO).unwrap();
    assert!(simulation.view().velocity(0)[1] < 4.9, "free again");
    assert!(simulation.ledger().residual().unwrap().abs() < 1e-4);
}

/// A sphere fixed to a bar under a constant incoming force F: m v̇ = 2F − Z v, so v = (2F/Z)(1 − exp(−Zt/m)); the reflected
/// force F − Z v starts as from a fixed end, +F, and ends as from a free one, −F. Crank and Nicolson's second order:
/// halving the step quarters the error. The second case is stiff (Z h/m = 9) and must still settle.
#[test]
fn a_bar_answers_with_its_exact_impedance() {
    let velocity = |impedance_over_mass: f64, step: f64, steps: u64| {
        let mut rig = rig(&[[0.0]], LawKind::Thesis);
        rig.residual_limit = 1e-12;
        let impedance = impedance_over_mass * rig.mass[0];
        let incident = Some(Curve::Square { peak: 100.0, start: 0.0, duration: 1.0 });
        rig.bars = vec![Bar { body: Body::Sphere(0), axis: 0, impedance, incident }];
        let simulation = run(rig, step, steps);
        // The balance of each step is out by what the ledger knows of, however stiff the bar, so that rounding is left.
        assert!(simulation.ledger().residual().unwrap().abs() < 1e-12, "{:?}", simulation.ledger());
        simulation.view().velocity(0)[0] * impedance / 200.0
    };
    let error = |step: f64| velocity(1e6, step, (2e-6 / step).round() as u64) - (1.0 - (-2.0_f64).exp());
    let (coarse, fine) = (error(1e-7), error(5e-8));
    assert!(fine.abs() < 1e-4 && (3.8..4.2).contains(&(coarse / fine)), "{coarse} {fine}");
    assert!((velocity(9e7, 1e-7, 400) - 1.0).abs() < 1e-12);
}

/// The force that a bar takes up equals the force that a chain hands on: momentum given to a chain by a blow ends in its bar.
#[test]
fn a_bar_swallows_the_momentum_of_a_chain() {
    let centres: Vec<[f64; 1]> = (0..6).map(|k| [f64::from(k)]).collect();
    let mut rig = rig(&centres, LawKind::Hertz);
    rig.velocity[0] = [1.0];
    let momentum = rig.mass[0];
    let impedance = 1e5 * rig.mass[0];
    rig.bars = vec![Bar { body: Body::Sphere(5), axis: 0, impedance, incident: None }];
    let mut simulation = Simulation::new(rig, 1e-7).unwrap();
    let mut taken = 0.0;
    for _ in 0..6000 {
        let before = simulation.view().velocity(5)[0];
        simulation.advance(1, &GO).unwrap();
        taken += 0.5 * 1e-7 * impedance * (before + simulation.view().velocity(5)[0]);
    }
    let view = simulation.view();
    let left: f64 = (0..6).map(|i| simulation.rig().mass[i] * view.velocity(i)[0]).sum();
    assert!(((taken + left) / momentum - 1.0).abs() < 1e-12, "{taken} {left} {momentum}");
    assert!(simulation.ledger().absorbed / simulation.ledger().work_in > 0.5);
    assert!(simulation.ledger().residual().unwrap().abs() < 1e-5);
}

/// A sphere against a wall counts as two equal spheres at twice overlap and speed: the symmetric collision of two spheres,
/// seen from the plane between them.
#[test]
fn a_wall_is_an_equal_sphere_in_a_mirror() {
    for law in [LawKind::Hertz, LawKind::Thesis, LawKind::Consistent] {
        let mut pair = rig(&[[0.0, 0.0], [0.0, 1.0]], law);
        pair.velocity = vec![[0.0, 3.0], [0.0, -3.0]];
        let mut single = rig(&[[0.0, 0.0]], law);
        single.velocity = vec![[0.0, 3.0]];
        single.flats = vec![Flat::wall("wall", [0.0, 0.5 * DIAMETER], [0.0, -1.0])];
        let (pair, single) = (run(pair, 1e-7, 600), run(single, 1e-7, 600));
        let [both, one] = [pair.view().velocity(0)[1], single.view().velocity(0)[1]];
        assert!(one < -0.5 && (both / one - 1.0).abs() < 1e-12, "{law}: {both} {one}");
        let [both, one] = [pair.ledger(), single.ledger()];
        assert!((both.dissipated - 2.0 * one.dissipated).abs() < 1e-12 * both.work_in, "{law}");
    }
}

/// A free plate of finite mass between two spheres takes part in momentum and energy: at Hertz's law all energy is back
/// after the blow, and plate and spheres have shared the momentum.
#[test]
fn a_plate_of_finite_mass_shares_momentum_and_energy() {
    let mut rig = rig(&[[0.0, 0.0, 0.0], [2.0, 1.0, 0.0]], LawKind::Hertz);
    let corners = [[-9.0, -9.0], [9.0, -9.0], [9.0, 9.0], [-9.0, 9.0]]
        .map(|[x, y]| [x * DIAMETER, y * DIAMETER, -0.5 * DIAMETER]);
    rig.flats = vec![Flat {
        face: Face::Polygon(corners.to_vec()),
        mass: 0.01,
        velocity: [0.0, 0.0, 2.0],
        held: [false; 3],
        ..Flat::wall("plate", [0.0, 0.0, -0.5 * DIAMETER], [0.0, 0.0, 1.0])
    }];
    let mass = rig.mass[0];
    let simulation = run(rig, 1e-7, 2000);
    let (view, plate) = (simulation.view(), simulation.view().flat(0).velocity[2]);
    let momentum = 0.01 * plate + mass * (view.velocity(0)[2] + view.velocity(1)[2]);
    assert!((momentum / 0.02 - 1.0).abs() < 1e-12);
    // Elastic, one plate and two equal spheres struck alike: like a body of twice the mass.
    let (heavy, light) = (0.01, 2.0 * mass);
    let expected = 2.0 * heavy / (heavy + light) * 2.0;
    // The step is 1/300 of the contact time, π/ω: (ωh)²/24 = 5e-6.
    assert!((view.velocity(0)[2] / expected - 1.0).abs() < 5e-6, "{} {expected}", view.velocity(0)[2]);
    assert!(simulation.ledger().residual().unwrap().abs() < 1e-5);
}

/// A ball on a wall under gravity: dropped from height h it flies for √(2h/g), and bounces back to h off a hard elastic wall.
#[test]
fn a_ball_bounces_back_to_its_height() {
    let mut rig = rig(&[[0.0, 0.0]], LawKind::Hertz);
    let height = 1e-3;
    rig.gravity = [0.0, 9.81];
    rig.flats = vec![Flat::wall("floor", [0.0, 0.5 * DIAMETER + height], [0.0, -1.0])];
    let mut simulation = Simulation::new(rig, 2e-7).unwrap();
    let fall = (2.0 * height / 9.81_f64).sqrt();
    simulation.advance((fall / 2e-7) as u64 - 10, &GO).unwrap();
    let expected = 9.81 * simulation.time();
    assert!((simulation.view().velocity(0)[1] / expected - 1.0).abs() < 1e-9);
    let mut highest = f64::INFINITY;
    for _ in 0..160 {
        simulation.advance(1000, &GO).unwrap();
        highest = highest.min(simulation.view().displacement(0)[1]);
    }
    // The summit lies between two looks 0.2 ms apart: at most g (0.1 ms)²/2 below.
    assert!(highest.abs() < 0.5 * 9.81 * 1e-8 + 1e-6 * height, "{highest}");
    // Works are sums of trapezoids over 300 steps of a contact: (π/300)²/12 = 1e-5.
    assert!(simulation.ledger().residual().unwrap().abs() < 3e-5);
}

/// A plate and a cluster that fall by h have m g h less potential energy and as much kinetic: the balance is that of each sign, not of a sum.
#[test]
fn what_falls_turns_potential_into_kinetic_energy() {
    let mut rig = rig(&[[9.0, 0.0], [19.0, 0.0], [20.0, 0.0]], LawKind::Hertz);
    rig.gravity = [0.0, 9.81];
    rig.flats =
        vec![Flat { mass: 2.0, velocity: [0.0, 0.5], held: [false; 2], ..Flat::wall("ram", [0.0, -1.0], [0.0, 1.0]) }];
    rig.clusters = vec![Cluster {
        members: vec![1, 2],
        centre: [19.5 * DIAMETER, 0.0],
        mass: 0.3,
        inertia: 1e-6,
        turns: true,
        velocity: [0.0, -0.2],
        spin: 0.0,
    }];
    let mass = rig.mass[0];
    let simulation = run(rig, 1e-6, 1000);
    let (view, ledger) = (simulation.view(), simulation.ledger());
    let ways = [view.flat(0).moved[1], view.cluster(0).moved[1], view.displacement(0)[1]];
    let lost: f64 = ways.iter().zip([2.0, 0.3, mass]).map(|(way, mass)| mass * 9.81 * way).sum();
    assert!(ways[0] > 0.0 && ways[1] < 0.0 && lost > 1e-3);
    assert!(difference(ledger.potential, -lost, 0.0) < 1e-12, "{ledger:?}");
    let started = 0.5 * (2.0 * 0.5 * 0.5 + 0.3 * 0.2 * 0.2);
    assert!(difference(ledger.kinetic, started + lost, 0.0) < 1e-9, "{ledger:?}");
    assert!(ledger.residual().unwrap().abs() < 1e-12);
}
