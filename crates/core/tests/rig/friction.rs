//! Tangential forces and rotation, against closed forms and an independent solution. Units of Kondic et al.: mean diameter,
//! collision time and the mass of a mean disk are 1, k = π²/2, γ_n = −2 ln e_n, γ_t = γ_n/2.

use std::f64::consts::PI;

use granulens_core::contact::{Constants, LawKind};
use granulens_core::dem::rig::{Arm, Cluster, Flat, Friction, Law, LawBook, Loss, Rig, Simulation, Spring};
use granulens_core::sample::{Sample, Sphere};

use crate::reference::{Table, difference, material};
use crate::rigs::{DIAMETER, GO, run};

pub const STIFFNESS: f64 = PI * PI / 2.0;

/// −2 ln e_n
pub fn damping(restitution: f64) -> f64 {
    -2.0 * restitution.ln()
}

pub fn friction(coefficient: f64, restitution: f64, kt: f64) -> Option<Friction> {
    let spring = if kt > 0.0 { Spring::Constant(kt * STIFFNESS) } else { Spring::None };
    Some(Friction { coefficient, spring, damping: 0.5 * damping(restitution), rolling: 0.0 })
}

/// Disks of given centres and diameters; all of one material.
pub fn disks(disks: &[([f64; 2], f64)], coefficient: f64, kt: f64) -> Rig<2> {
    let spheres = disks.iter().map(|&(centre, d)| Sphere { centre, radius: 0.5 * d, material: 0 }).collect();
    let materials = vec![(Loss::Rate(damping(0.5)), friction(coefficient, 0.5, kt))];
    let laws = LawBook::Dashpot { stiffness: STIFFNESS, materials, cut: false, arm: Arm::Radius };
    let mut rig = Rig::new(Sample { materials: vec![material("440c")], spheres }, laws);
    rig.mass = disks.iter().map(|(_, d)| d * d).collect();
    rig.inertia = disks.iter().map(|(_, d)| d.powi(4) / 8.0).collect();
    rig.residual_limit = 0.05;
    rig
}

/// The independent solution is the limit of vanishing steps to 3e-6. The contact begins and ends between steps, which costs
/// first order: 1e-4 of a unit at a step of 1e-4.
#[test]
fn an_oblique_collision_with_friction_is_the_independent_one() {
    let table = Table::read("beds/collision_oblique_mu0.5.csv");
    for row in 0..table.len() {
        let kt = table.number(row, "kt");
        let at = |step: f64| {
            let mut rig = disks(&[([0.0, 0.0], 1.0), ([1.0, 0.35], 0.8)], 0.5, kt);
            rig.velocity = vec![[0.3, 0.1], [-0.2, 0.0]];
            rig.spin = vec![[0.0, 0.0, 2.0], [0.0, 0.0, -0.1]];
            run(rig, step, (4.0 / step).round() as u64)
        };
        let simulation = at(1e-4);
        let view = simulation.view();
        let ([ax, ay], [bx, by]) = (view.velocity(0), view.velocity(1));
        let (a, b) = (view.position(0), view.position(1));
        let ours = [ax, ay, bx, by, view.spin(0)[2], view.spin(1)[2], a[0], a[1], b[0], b[1]];
        let names = ["vAx", "vAy", "vBx", "vBy", "omegaA", "omegaB", "xA", "yA", "xB", "yB"];
        for (ours, name) in ours.into_iter().zip(names) {
            let theirs = table.number(row, name);
            assert!((ours - theirs).abs() < 1e-4, "k_t {kt}, {name}: {ours} and {theirs}");
        }
        // Where the energy went is known too: work in = kinetic now + normal loss + friction.
        let ledger = simulation.ledger();
        assert!(ledger.friction > 0.01 * ledger.work_in && ledger.residual().unwrap().abs() < 1e-3);
    }
}

/// A disk slides on a wall and comes to roll: v_x = (2 v₀ + s)/3 with the slip s falling at 3 μ g, to 2/3 v₀ (closed form in the
/// file's header). Kinetic friction to the column's ten digits but for the step; static to LAMMPS's own error, 1e-6.
#[test]
fn a_sliding_disk_comes_to_roll() {
    let gravity = PI * PI / 8000.0;
    let table = Table::read("beds/wall_slide_roll.csv");
    for (kt, [v, w], tolerance) in
        [(0.0, ["vx_kinetic", "omega_kinetic"], 2e-6), (0.8, ["vx_static", "omega_static"], 2e-6)]
    {
        let mut rig = disks(&[([0.0, 0.5 - gravity / STIFFNESS], 1.0)], 0.1, kt);
        rig.velocity = vec![[0.05, 0.0]];
        (rig.gravity, rig.precompressed) = ([0.0, -gravity], true);
        rig.flats = vec![Flat::wall("wall", [0.0, 0.0], [0.0, 1.0])];
        let mut simulation = Simulation::new(rig, 0.005).unwrap();
        for row in 1..table.len() {
            simulation.advance(400, &GO).unwrap();
            assert!((simulation.time() - table.number(row, "t")).abs() < 1e-9);
            let view = simulation.view();
            let ours = [view.velocity(0)[0], view.spin(0)[2]];
            let theirs = [table.number(row, v), table.number(row, w)];
            for (a, b) in ours.into_iter().zip(theirs) {
                assert!((a - b).abs() < tolerance, "k_t {kt}, t {}: {a} and {b}", simulation.time());
            }
        }
    }
}

/// Without outer forces angular momentum Σ m r × v + I ω stays, but for one thing: forces act at the radius, not at the middle
/// of the overlap (Kondic et al.), which costs a torque of F_t δ. All of the motion being linear, that is of second order in the
/// speed: a tenth of it must leave a hundredth of the change. With arms that end in the contact it stays to rounding.
#[test]
fn angular_momentum_is_conserved_to_the_order_of_the_overlap() {
    let change = |speed: f64, end: Arm| {
        let mut rig = disks(&[([0.0, 0.0], 1.0), ([0.6, 0.8], 1.0), ([1.2, 0.0], 1.0)], 0.7, 0.8);
        if let LawBook::Dashpot { arm, .. } = &mut rig.laws {
            *arm = end;
        }
        rig.velocity = vec![[0.0; 2], [0.0, -speed], [0.0; 2]];
        rig.spin = vec![[0.0, 0.0, speed], [0.0, 0.0, -2.0 * speed], [0.0, 0.0, 0.5 * speed]];
        let angular = |simulation: &Simulation<2>| -> f64 {
            let (view, rig) = (simulation.view(), simulation.rig());
            (0..3)
                .map(|i| {
                    let ([x, y], [vx, vy]) = (view.position(i), view.velocity(i));
                    rig.mass[i] * (x * vy - y * vx) + rig.inertia[i] * view.spin(i)[2]
                })
                .sum()
        };
        let mut simulation = Simulation::new(rig, 1e-4).unwrap();
        let before = angular(&simulation);
        simulation.advance(15_000, &GO).unwrap();
        assert!(simulation.ledger().friction > 0.01 * simulation.ledger().work_in, "they have rubbed");
        angular(&simulation) - before
    };
    let (fast, slow) = (change(0.1, Arm::Radius), change(0.01, Arm::Radius));
    assert!((80.0..125.0).contains(&(fast / slow)) && fast.abs() < 0.01, "{fast} {slow}");
    let kept = change(0.1, Arm::Contact);
    assert!(kept.abs() < 1e-13, "{kept:e}");
}

/// A 3D oblique impact of two steel spheres under Hertz and Mindlin springs: the motion stays in the plane of the blow, momentum
/// is exact, and turning the whole experiment in space turns its result.
#[test]
fn an_oblique_impact_in_space_does_not_depend_on_how_it_is_turned() {
    let outcome = |turn: [[f64; 3]; 3]| {
        let turned = |v: [f64; 3]| -> [f64; 3] { std::array::from_fn(|k| (0..3).map(|l| turn[k][l] * v[l]).sum()) };
        let centres = [[0.0, 0.0, 0.0], [0.6 * DIAMETER, 0.0, 0.8 * DIAMETER]];
        let spheres = centres.map(|c| Sphere { centre: turned(c), radius: 0.5 * DIAMETER, material: 0 });
        let laws = LawBook::Materials {
            law: Law::Named(LawKind::Hertz),
            constants: Constants::Code,
            pairs: Vec::new(),
            friction: Some(Friction::mindlin(0.3)),
        };
        let mut rig = Rig::new(Sample { materials: vec![material("440c")], spheres: spheres.to_vec() }, laws);
        rig.velocity[0] = turned([0.0, 0.0, 1.0]);
        rig.spin[1] = turned([50.0, 20.0, 0.0]);
        let simulation = run(rig, 5e-8, 2000);
        assert!(simulation.ledger().residual().unwrap().abs() < 1e-5);
        let view = simulation.view();
        let sum: [f64; 3] = std::array::from_fn(|k| view.velocity(0)[k] + view.velocity(1)[k]);
        assert!((sum.iter().map(|v| v * v).sum::<f64>().sqrt() - 1.0).abs() < 1e-12);
        [view.velocity(0), view.spin(0), view.velocity(1), view.spin(1)]
    };
    let straight = outcome([[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]]);
    assert!(straight[1].iter().any(|w| w.abs() > 10.0), "friction has turned it");
    let (c, s) = (0.6, 0.8);
    let turn = [[c, -s, 0.0], [s * s, c * s, -c], [c * s, c * c, s]];
    let turned = outcome(turn);
    for (a, b) in straight.into_iter().zip(turned) {
        let scale = a.iter().map(|x| x * x).sum::<f64>().sqrt().max(1e-3);
        for k in 0..3 {
            let expected: f64 = (0..3).map(|l| turn[k][l] * a[l]).sum();
            assert!((expected - b[k]).abs() < 1e-10 * scale, "{a:?} {b:?}");
        }
    }
}

/// Two spheres that slide throughout: the impulse along the tangent is μ times that along the normal, so Δv_t = μ Δv_n and
/// Δω = (5/2) μ Δv_n/R for solid spheres, whatever the law.
#[test]
fn a_sliding_impact_obeys_coulomb() {
    let laws = LawBook::Materials {
        law: Law::Named(LawKind::Thesis),
        constants: Constants::Code,
        pairs: Vec::new(),
        friction: Some(Friction { coefficient: 0.1, spring: Spring::None, damping: 1e9, rolling: 0.0 }),
    };
    let spheres = [[0.0, 0.0], [0.0, DIAMETER]].map(|centre| Sphere { centre, radius: 0.5 * DIAMETER, material: 0 });
    let mut rig = Rig::new(Sample { materials: vec![material("440c")], spheres: spheres.to_vec() }, laws);
    rig.velocity[0] = [2.0, 1.0];
    let simulation = run(rig, 2e-8, 4000);
    let view = simulation.view();
    let ([tangential, normal], spin) = (view.velocity(1), view.spin(1)[2]);
    // The normal turns by v_t t/D = 0.02 while they touch: the impulses' sum is shorter than their lengths' by 0.02²/24.
    let expected = tangential.hypot(normal) * 0.1 / 1.01_f64.sqrt() * 2.5 / (0.5 * DIAMETER);
    // The arm ends in the contact: it is shorter than R by a half of the overlap, which gets to 0.2 % of D.
    let deepest = simulation.contacts_ever()[0].overlap_max / DIAMETER;
    assert!((1.0 - deepest..1.0 - 0.3 * deepest).contains(&(spin.abs() / expected)), "{expected} {spin} {deepest}");
    assert!(tangential > 0.0 && normal > 0.0 && difference(view.spin(0)[2], spin, 0.0) < 1e-12);
}

/// Head-on, the spring and dashpot gives its exact restitution, below the nominal one where it may pull.
#[test]
fn the_true_restitution_is_the_closed_form() {
    for (nominal, cut) in [(0.9, false), (0.5, false), (0.1, false), (0.5, true), (0.1, true)] {
        let mut rig = disks(&[([0.0, 0.0], 1.0), ([1.0, 0.0], 1.0)], 0.0, 0.0);
        rig.laws = LawBook::Dashpot {
            stiffness: STIFFNESS,
            materials: vec![(Loss::Rate(damping(nominal)), None)],
            cut,
            arm: Arm::Radius,
        };
        rig.velocity[0] = [0.5, 0.0];
        let simulation = run(rig, 1e-4, 40_000);
        let view = simulation.view();
        let ours = (view.velocity(1)[0] - view.velocity(0)[0]) / 0.5;
        let law = granulens_core::contact::Dashpot { stiffness: STIFFNESS, damping: damping(nominal) * 0.5, cut };
        let exact = law.restitution(0.5);
        // The contact ends within a step of where it should: 1e-4 of the collision's π-ish time, times the pull there.
        assert!((ours - exact).abs() < 3e-4, "{nominal} {cut}: {ours} {exact}");
    }
}

/// Two equal disks bound to a dumbbell are struck by a third at one end: momentum and energy are kept, and the dumbbell turns
/// as the free rigid body does. The blow J acts at the arm a: v = J/M, ω = J a/I.
#[test]
fn a_cluster_moves_as_a_rigid_body() {
    let mut rig = disks(&[([-0.5, 0.0], 1.0), ([0.5, 0.0], 1.0), ([0.5, -1.0], 1.0)], 0.0, 0.0);
    rig.laws = LawBook::Dashpot {
        stiffness: STIFFNESS,
        materials: vec![(Loss::Rate(0.0), None)],
        cut: false,
        arm: Arm::Radius,
    };
    rig.velocity[2] = [0.0, 0.02];
    // Solid disks of mass 1 at half a unit: I = 2 (1/8 + 1/4).
    rig.clusters = vec![Cluster {
        members: vec![0, 1],
        centre: [0.0; 2],
        mass: 2.0,
        inertia: 0.75,
        turns: true,
        velocity: [0.0; 2],
        spin: 0.0,
    }];
    let simulation = run(rig, 1e-3, 3000);
    let (view, state) = (simulation.view(), simulation.view().cluster(0));
    let impulse = 0.02 - view.velocity(2)[1];
    assert!(difference(state.velocity[1], impulse / 2.0, 0.0) < 1e-12);
    // The arm turns by 1e-2 while they touch, and the point of contact is off by as much: 1e-4 in ω.
    assert!(difference(state.spin, impulse * 0.5 / 0.75, 0.0) < 1e-3, "{} {impulse}", state.spin);
    // Elastic: the impulse is 2 v over the sum of inverse masses, 1 + 1/2 + a²/I.
    assert!(difference(impulse, 0.04 / (1.5 + 0.25 / 0.75), 0.0) < 1e-3, "{impulse}");
    assert!(simulation.ledger().residual().unwrap().abs() < 1e-5);
}

/// Friction at a member's surface turns the whole: a cluster of one sphere is that sphere, to rounding.
#[test]
fn a_cluster_feels_its_members_couples() {
    let build = |cluster: bool| {
        let mut rig = crate::rigs::rig(&[[0.0, 0.0], [0.6, 0.8]], LawKind::Hertz);
        rig.laws = LawBook::Materials {
            law: Law::Named(LawKind::Hertz),
            constants: Constants::Code,
            pairs: Vec::new(),
            friction: Some(Friction::mindlin(0.3)),
        };
        rig.velocity[0] = [0.0, 2.0];
        if cluster {
            rig.clusters = vec![Cluster {
                members: vec![1],
                centre: [0.6 * DIAMETER, 0.8 * DIAMETER],
                mass: rig.mass[1],
                inertia: rig.inertia[1],
                turns: true,
                velocity: [0.0; 2],
                spin: 0.0,
            }];
        }
        run(rig, 5e-8, 2000)
    };
    let (alone, bound) = (build(false), build(true));
    let spin = alone.view().spin(1)[2];
    assert!(spin.abs() > 10.0, "{spin}");
    assert!(difference(bound.view().cluster(0).spin, spin, 0.0) < 1e-9, "{} {spin}", bound.view().cluster(0).spin);
    for i in [0, 1] {
        for k in [0, 1] {
            let (a, b) = (alone.view().velocity(i)[k], bound.view().velocity(i)[k]);
            assert!((a - b).abs() < 1e-11, "sphere {i}: {a} {b}");
        }
    }
}

/// The same in space, whichever way the spheres slide: where they do so to the end (Maw, Barber and Fawcett 1976) the impulse along the tangent is μ times that along
/// the normal, and Δω = (5/2) μ Δv_n/R. The arms are shorter than the radius by a half of the overlap, and the normal turns by 0.02, which shortens the sum of
/// impulses by 0.02²/24.
#[test]
fn sliding_in_space_obeys_coulomb() {
    for (coefficient, [x, y]) in [(0.1, [1.0, 0.0]), (0.1, [0.6, 0.8]), (0.3, [-0.8, 0.6])] {
        let spheres =
            [[0.0; 3], [0.0, 0.0, DIAMETER]].map(|centre| Sphere { centre, radius: 0.5 * DIAMETER, material: 0 });
        let laws = LawBook::Materials {
            law: Law::Named(LawKind::Hertz),
            constants: Constants::Code,
            pairs: Vec::new(),
            friction: Some(Friction::mindlin(coefficient)),
        };
        let mut rig = Rig::new(Sample { materials: vec![material("440c")], spheres: spheres.to_vec() }, laws);
        // Far above tan θ = (7/2) μ (1 + e), from where on they slide throughout.
        rig.velocity[0] = [4.0 * x, 4.0 * y, 0.5];
        let simulation = run(rig, 5e-8, 3000);
        let (velocity, spin) = (simulation.view().velocity(1), simulation.view().spin(1));
        let size = |v: [f64; 3]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
        let slope = coefficient / (1.0 + coefficient * coefficient).sqrt();
        let expected = 2.5 * slope * size(velocity) / (0.5 * DIAMETER);
        let deepest = simulation.contacts_ever()[0].overlap_max / DIAMETER;
        assert!((1.0 - deepest - 1e-4..1.0).contains(&(size(spin) / expected)), "{spin:?} {expected} {deepest}");
        // In the plane of the blow.
        assert!((x * velocity[1] - y * velocity[0]).abs() < 1e-9 && spin[2].abs() < 1e-9, "{velocity:?} {spin:?}");
    }
}
