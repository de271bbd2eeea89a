//! Contacts with friction: flats as mirror images, energy on closed paths, momentum, order of spheres.
//!
//! - `oblique`: oblique impacts against closed forms and an integration of their equations
//! - `seams`: plates side by side are one face

mod oblique;
mod seams;

use std::sync::Arc;

use granulens_core::contact::{Constants, LawKind, Pair, Tabulated};
use granulens_core::dem::rig::{
    Body, Cluster, Curve, Face, Flat, Friction, Law, LawBook, Load, LoadKind, Loss, Rig, RigError, Simulation, Spring,
    SpringDashpot, Touching,
};
use granulens_core::dem::{MoveIn, Spheres};
use granulens_core::material::Material;
use granulens_core::sample::{Sample, Sphere};

use crate::reference::material;
use crate::rigs::{DIAMETER, GO, run};

/// Numbers from 0 to 1.
struct Draw(u64);

impl Draw {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.next()
    }

    /// A random order.
    fn order(&mut self, count: usize) -> Vec<usize> {
        let mut order: Vec<usize> = (0..count).collect();
        for i in (1..count).rev() {
            order.swap(i, (self.next() * (i + 1) as f64) as usize);
        }
        order
    }
}

/// Every kind of normal law.
fn all_laws() -> Vec<Law> {
    let table: Vec<(f64, f64)> = (0..60).map(|k| f64::from(k) * 1e-5).map(|d| (d, 1.5e10 * d.powf(1.5))).collect();
    let named = LawKind::ALL.iter().map(|&kind| Law::Named(kind));
    let others = [
        Law::SpringDashpot(SpringDashpot { stiffness: 2e7, loss: Loss::Rate(2e4), cut: true }),
        Law::Tabulated(Arc::new(Tabulated::new(&table).unwrap())),
    ];
    named.chain(others).collect()
}

/// Every kind of friction, of μ 0.2.
fn all_frictions() -> [Friction; 6] {
    let kind = |spring, damping| Friction { coefficient: 0.2, spring, damping, rolling: 0.0 };
    [
        kind(Spring::Mindlin, 0.0),
        kind(Spring::Constant(1.4e7), 0.0),
        kind(Spring::Mindlin, 3e5),
        kind(Spring::Constant(1.4e7), 3e5),
        kind(Spring::None, 3e5),
        kind(Spring::CattaneoMindlin, 0.0),
    ]
}

fn book(law: Law, friction: Friction) -> LawBook {
    LawBook::Materials { law, constants: Constants::Code, pairs: Vec::new(), friction: Some(friction) }
}

fn sphere<const D: usize>(centre: [f64; D], radius: f64) -> Sphere<D> {
    Sphere { centre, radius, material: 0 }
}

/// Spheres of 440c, at rest.
fn of<const D: usize>(spheres: Vec<Sphere<D>>, laws: LawBook) -> Rig<D> {
    Rig::new(Sample { materials: vec![material("440c")], spheres }, laws)
}

/// A sphere above a wall at z = 0, or in its place an equal sphere of which the contact is the centre of symmetry: it moves the
/// opposite way and spins the same.
fn above([pair, free]: [bool; 2], velocity: [f64; 2], spin: f64, laws: LawBook) -> Rig<2> {
    let radius = 0.5 * DIAMETER;
    let mut spheres = vec![sphere([0.0, radius], radius)];
    if pair {
        spheres.push(sphere([0.0, -radius], radius));
    }
    let mut rig = of(spheres, laws);
    for (i, sign) in [1.0, -1.0].into_iter().enumerate().take(rig.velocity.len()) {
        rig.velocity[i] = velocity.map(|v| sign * v);
        rig.spin[i] = [0.0, 0.0, spin];
        rig.held[i] = [!free, false];
    }
    if !pair {
        rig.flats = vec![Flat::wall("wall", [0.0, 0.0], [0.0, 1.0])];
    }
    // Some of these blows are long ones of laws that are stiff or lossy; it is the equality that is asked for.
    (rig.residual_limit, rig.overlap_limit) = (1.0, Some(0.9));
    rig
}

/// Both blows side by side: motion to 1e-9 of the speed, and what their contacts show.
fn same_blow(free: bool, velocity: [f64; 2], spin: f64, laws: &LawBook, [step, window]: [f64; 2]) -> [f64; 3] {
    let [mut wall, mut pair] =
        [false, true].map(|pair| Simulation::new(above([pair, free], velocity, spin, laws.clone()), step).unwrap());
    let (speed, mut met) = (velocity[0].hypot(velocity[1]), 0);
    let near = |a: f64, b: f64, scale: f64, what: &str| {
        let case = format!("{what}: {a:e} and {b:e}, {velocity:?} {spin} {laws:?}");
        assert!((a - b).abs() <= 1e-9 * scale, "{case}");
    };
    for _ in 0..80 {
        for simulation in [&mut wall, &mut pair] {
            simulation.advance((window / step / 80.0) as u64, &GO).unwrap();
        }
        let (one, two) = (wall.view(), pair.view());
        for k in 0..2 {
            near(one.velocity(0)[k], two.velocity(0)[k], speed, "velocity");
        }
        near(one.spin(0)[2], two.spin(0)[2], speed / DIAMETER, "spin");
        let [a, b]: [Vec<Touching<2>>; 2] = [one.contacts().collect(), two.contacts().collect()];
        assert_eq!(a.len(), b.len());
        for (a, b) in a.iter().zip(&b) {
            met += 1;
            near(a.force, b.force, b.force_max, "force");
            near(a.tangential, b.tangential, b.force_max, "tangential");
            near(2.0 * a.overlap, b.overlap, b.overlap_max, "overlap");
            near(2.0 * a.overlap_max, b.overlap_max, b.overlap_max, "greatest overlap");
            near(2.0 * a.closing_speed, b.closing_speed, speed, "closing speed");
            let energy = b.force_max * b.overlap_max;
            near(2.0 * a.stored, b.stored, energy, "stored");
            near(2.0 * a.dissipated, b.dissipated, energy, "dissipated");
        }
        let (one, two) = (wall.ledger(), pair.ledger());
        for (a, b) in [
            (one.kinetic, two.kinetic),
            (one.stored, two.stored),
            (one.tangential_stored, two.tangential_stored),
            (one.dissipated, two.dissipated),
            (one.friction, two.friction),
        ] {
            near(2.0 * a, b, two.work_in, "energy");
        }
    }
    assert!(met > 1, "{met} looks at a closed contact");
    let view = wall.view();
    [view.velocity(0)[0], view.velocity(0)[1], view.spin(0)[2]]
}

/// The blow on a wall is that of two equal spheres, to rounding: under every law, with every kind of friction, at every angle
/// between the sliding and the approach. Spheres that spin but keep to their axis slide without turning the normal.
#[test]
fn a_flat_is_an_equal_sphere_in_everything() {
    for law in all_laws() {
        for friction in all_frictions() {
            for angle in [2.0_f64, 10.0, 25.0, 60.0] {
                let speed = 2.0;
                let spin = speed * angle.to_radians().tan() / (0.5 * DIAMETER);
                let laws = book(law.clone(), friction);
                let [_, _, left] = same_blow(false, [0.0, -speed], spin, &laws, [2e-8, 160e-6]);
                assert!(left < spin, "friction has braked it");
            }
        }
    }
}

/// The same of spheres that are free and strike at an angle. As they slide past each other the normal turns by 2 u_t t/D, which it
/// does not at a wall; at 1e-10 m/s that is below 1e-9.
#[test]
fn a_free_oblique_blow_on_a_wall_is_that_of_two_spheres() {
    let spring = Law::SpringDashpot(SpringDashpot { stiffness: 2e7, loss: Loss::Rate(2e4), cut: true });
    for (law, window) in [(Law::Named(LawKind::Hertz), 6.4e-3), (spring, 150e-6)] {
        for friction in [Friction::mindlin(0.092), Friction { damping: 1e4, ..Friction::mindlin(0.3) }] {
            for angle in [1.0_f64, 5.0, 10.0, 20.0, 50.0, 80.0] {
                let (sin, cos) = angle.to_radians().sin_cos();
                let velocity = [1e-10 * sin, -1e-10 * cos];
                let [x, z, spin] = same_blow(true, velocity, 0.0, &book(law.clone(), friction), [window / 8e3, window]);
                assert!(x < velocity[0] && z > 0.0 && spin != 0.0, "{angle}");
            }
        }
    }
}

/// A closed path of overlap and slip, in legs: to each corner (slip, overlap as parts of `most`) and back to the start.
fn closed_path(corners: &[[f64; 2]], most: [f64; 2], [leg, step]: [f64; 2], laws: LawBook) -> Simulation<2> {
    let radius = 0.5 * DIAMETER;
    let mut rig = of(vec![sphere([0.0, 0.0], radius), sphere([0.0, 2.0 * radius], radius)], laws);
    rig.held[0] = [true; 2];
    // It does not turn, so that the way of its centre is the slip.
    rig.inertia[1] = 1e9;
    let path = |k: usize, sign: f64| {
        let mut points = vec![(0.0, 0.0)];
        points.extend(corners.iter().enumerate().map(|(n, at)| ((n + 1) as f64 * leg, sign * at[k] * most[k])));
        points.push(((corners.len() + 1) as f64 * leg, 0.0));
        Curve::path(&points).unwrap()
    };
    let load = |direction, curve| Load { bodies: vec![Body::Sphere(1)], direction, kind: LoadKind::Velocity, curve };
    rig.loads = vec![load([1.0, 0.0], path(0, 1.0)), load([0.0, 1.0], path(1, -1.0))];
    (rig.residual_limit, rig.overlap_limit) = (f64::INFINITY, Some(0.9));
    Simulation::new(rig, step).unwrap()
}

/// Over random closed paths, with every law and friction: friction's entry never falls, not by more than rounding in any step, and
/// what came back is what the ledger says it is.
#[test]
fn no_path_of_overlap_and_slip_makes_energy_of_friction() {
    let mut draw = Draw(11);
    for law in all_laws() {
        for friction in all_frictions() {
            for coefficient in [0.2, 5.0] {
                let corners: Vec<[f64; 2]> =
                    (0..8).map(|_| [draw.between(-1.0, 1.0), draw.between(-0.1, 1.0)]).collect();
                let laws = book(law.clone(), Friction { coefficient, ..friction });
                let mut simulation = closed_path(&corners, [4e-6, 8e-6], [25e-6, 1e-7], laws);
                let (mut before, mut most) = (0.0, 0.0_f64);
                for _ in 0..250 * 9 {
                    simulation.advance(1, &GO).unwrap();
                    let ledger = simulation.ledger();
                    most = most.max(ledger.friction + ledger.tangential_stored);
                    let fell = before - ledger.friction;
                    assert!(fell <= 1e-14 * most, "{fell:e} of {most:e}: {law:?} {friction:?} {coefficient}");
                    before = ledger.friction;
                }
                assert!(before > 0.0 && before.is_finite());
            }
        }
    }
}

/// The work of closed paths, by the forces on the driven sphere: never negative but for the step, and what the ledger books as
/// friction. With Hertz, which gives all back along the normal.
#[test]
fn a_closed_path_takes_work() {
    let mut draw = Draw(5);
    for n in 0..20 {
        let friction = [Friction::mindlin(0.3), Friction::mindlin(20.0)][n % 2];
        let corners: Vec<[f64; 2]> = (0..6).map(|_| [draw.between(-1.0, 1.0), draw.between(0.05, 1.0)]).collect();
        let laws = book(Law::Named(LawKind::Hertz), friction);
        let mut simulation = closed_path(&corners, [4e-6, 8e-6], [25e-6, 1e-8], laws);
        simulation.advance(2500 * 7 + 50, &GO).unwrap();
        let ledger = simulation.ledger();
        let scale = ledger.at_hand;
        assert!(ledger.friction > 0.0, "{n}");
        // The prescribed motion ends with the sphere at rest or in the motion of the last leg: kinetic energy counts.
        assert!(ledger.left().abs() < 1e-3 * scale, "{n}: {:e} of {scale:e}", ledger.left());
        assert!(ledger.work_in - ledger.kinetic > -1e-4 * scale, "{n}");
    }
}

/// Squeeze, shear, squeeze harder, shear back, open: the force of the shear stays while the contact is pressed harder, to the last
/// digit but for rounding; then the cycle has taken what was wound up (case 2).
#[test]
fn a_sheared_contact_pressed_harder_keeps_its_force() {
    let corners = [[0.0, 0.25], [1.0, 0.25], [1.0, 1.0], [0.0, 1.0]];
    let laws = book(Law::Named(LawKind::Hertz), Friction::mindlin(2.0));
    let mut simulation = closed_path(&corners, [1e-6, 16e-6], [50e-6, 2e-7], laws);
    let tangential = |simulation: &Simulation<2>| simulation.view().contacts().next().unwrap().tangential;
    simulation.advance(501, &GO).unwrap();
    let sheared = tangential(&simulation);
    assert!(sheared > 10.0);
    for _ in 0..24 {
        simulation.advance(10, &GO).unwrap();
        assert!((tangential(&simulation) / sheared - 1.0).abs() < 1e-2, "{}", tangential(&simulation));
    }
    simulation.advance(600, &GO).unwrap();
    let ledger = simulation.ledger();
    assert!(simulation.view().contacts().next().is_none() && ledger.friction > 0.0, "{ledger:?}");
}

/// Momenta of a rig of free spheres: linear, and angular about the origin (out of the plane in two dimensions); and the sum of the
/// sizes of the latter's parts.
fn momenta<const D: usize>(simulation: &Simulation<D>) -> ([f64; D], [f64; 3], f64) {
    let (view, rig) = (simulation.view(), simulation.rig());
    let (mut linear, mut angular, mut size) = ([0.0; D], [0.0; 3], 0.0);
    let mut add = |(mass, inertia): (f64, f64), at: [f64; D], v: [f64; D], spin: [f64; 3]| {
        let wide = |u: [f64; D]| -> [f64; 3] { std::array::from_fn(|k| if k < D { u[k] } else { 0.0 }) };
        let (at, v) = (wide(at), wide(v));
        for k in 0..3 {
            let (l, m) = ((k + 1) % 3, (k + 2) % 3);
            let part = mass * (at[l] * v[m] - at[m] * v[l]) + inertia * spin[k];
            angular[k] += part;
            size += part.abs();
        }
        for k in 0..D {
            linear[k] += mass * v[k];
        }
    };
    let clustered: Vec<usize> = rig.clusters.iter().flat_map(|cluster| cluster.members.clone()).collect();
    for i in (0..rig.mass.len()).filter(|i| !clustered.contains(i)) {
        add((rig.mass[i], rig.inertia[i]), view.position(i), view.velocity(i), view.spin(i));
    }
    for (c, cluster) in rig.clusters.iter().enumerate() {
        let state = view.cluster(c);
        let at = std::array::from_fn(|k| cluster.centre[k] + state.moved[k]);
        add((cluster.mass, cluster.inertia), at, state.velocity, [0.0, 0.0, state.spin]);
    }
    (linear, angular, size)
}

/// Spheres of several sizes on a grid of pitch 1.05 of the widest, that fly together and spin.
fn swarm<const D: usize>(draw: &mut Draw, laws: LawBook) -> Rig<D> {
    let side = if D == 2 { 4 } else { 3_usize };
    let spheres: Vec<Sphere<D>> = (0..side.pow(D as u32))
        .map(|n| {
            let place = |k: usize| (n / side.pow(k as u32) % side) as f64 - 0.5 * (side - 1) as f64;
            let centre = std::array::from_fn(|k| 1.02 * DIAMETER * (place(k) + draw.between(-0.02, 0.02)));
            sphere(centre, 0.5 * DIAMETER * draw.between(0.8, 0.95))
        })
        .collect();
    let mut rig = of(spheres, laws);
    for i in 0..rig.velocity.len() {
        let centre = rig.sample.spheres[i].centre;
        rig.velocity[i] = std::array::from_fn(|k| -1e3 * centre[k] + draw.between(-2.0, 2.0));
        let spin = [0, 1, 2].map(|_| draw.between(-2e3, 2e3));
        rig.spin[i] = if D == 2 { [0.0, 0.0, spin[2]] } else { spin };
    }
    (rig.residual_limit, rig.overlap_limit) = (1.0, Some(0.9));
    rig
}

/// Linear and angular momentum of isolated spheres stay to rounding, in every law, in the plane and in space; and with a cluster
/// among them.
#[test]
fn momentum_and_angular_momentum_are_kept() {
    fn kept<const D: usize>(rig: Rig<D>, what: &str)
    where
        Spheres: MoveIn<D>,
    {
        let mut simulation = Simulation::new(rig, 2e-8).unwrap();
        let (linear, angular, size) = momenta(&simulation);
        simulation.advance(6000, &GO).unwrap();
        let (now, turned, _) = momenta(&simulation);
        let rubbed = simulation.ledger().friction / simulation.ledger().work_in;
        assert!(rubbed > 1e-3, "{what}: they have rubbed by {rubbed:e}");
        let scale: f64 = simulation.rig().mass.iter().sum::<f64>() * 5.0;
        let apart = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
        assert!(apart(&now, &linear) < 1e-13 * scale, "{what}: {now:?} {linear:?}");
        // Rounding of positions and sums over some thousand steps.
        assert!(apart(&turned, &angular) < 1e-12 * size, "{what}: {turned:?} {angular:?} of {size:e}");
    }
    let mut draw = Draw(3);
    for law in all_laws() {
        let rolls = |friction: Friction| Friction { rolling: 0.05, ..friction };
        for friction in all_frictions().into_iter().chain([rolls(Friction::mindlin(0.2)), rolls(all_frictions()[5])]) {
            let laws = book(law.clone(), friction);
            kept::<2>(swarm(&mut draw, laws.clone()), &format!("plane {laws:?}"));
            kept::<3>(swarm(&mut draw, laws.clone()), &format!("space {laws:?}"));
        }
    }
    // Two neighbours as one rigid body.
    let mut rig: Rig<2> = swarm(&mut draw, book(Law::Named(LawKind::Hertz), Friction::mindlin(0.4)));
    let members = vec![5, 6];
    let centre = std::array::from_fn(|k| members.iter().map(|&i| 0.5 * rig.sample.spheres[i].centre[k]).sum());
    let (mass, inertia) = (2.0 * rig.mass[5], 8.0 * rig.inertia[5]);
    rig.clusters = vec![Cluster { members, centre, mass, inertia, turns: true, velocity: [0.5, 1.0], spin: 300.0 }];
    kept(rig, "with a cluster");
}

/// Spheres numbered at random, so that half of the pairs are stored from their other side and sums have another order: the same
/// motion but for rounding, which grows some thousandfold over three blows.
#[test]
fn the_order_of_spheres_does_not_matter() {
    fn alike<const D: usize>(rig: &Rig<D>, order: &[usize])
    where
        Spheres: MoveIn<D>,
    {
        let mut other = rig.clone();
        for (to, &from) in order.iter().enumerate() {
            other.sample.spheres[to] = rig.sample.spheres[from];
            (other.mass[to], other.inertia[to]) = (rig.mass[from], rig.inertia[from]);
            (other.velocity[to], other.spin[to]) = (rig.velocity[from], rig.spin[from]);
        }
        let (one, two) = (run(rig.clone(), 2e-8, 8000), run(other, 2e-8, 8000));
        assert!(one.ledger().friction > 0.0);
        for (to, &from) in order.iter().enumerate() {
            let (a, b) = (one.view(), two.view());
            for k in 0..D {
                assert!(
                    (a.velocity(from)[k] - b.velocity(to)[k]).abs() < 1e-9,
                    "{:?} {:?}",
                    a.velocity(from),
                    b.velocity(to)
                );
            }
            for k in 0..3 {
                assert!((a.spin(from)[k] - b.spin(to)[k]).abs() < 1e-9 / DIAMETER);
            }
        }
    }
    fn mix<const D: usize>(sample: &mut Sample<D>) {
        sample.materials.push(material("brass"));
        sample.spheres.iter_mut().enumerate().for_each(|(i, sphere)| sphere.material = i % 2);
    }
    let mut draw = Draw(17);
    for friction in all_frictions() {
        for kind in [LawKind::Hertz, LawKind::Thesis, LawKind::Consistent] {
            let laws = book(Law::Named(kind), friction);
            let (mut flat, mut solid) = (swarm::<2>(&mut draw, laws.clone()), swarm::<3>(&mut draw, laws));
            mix(&mut flat.sample);
            mix(&mut solid.sample);
            alike(&flat, &draw.order(16));
            alike(&solid, &draw.order(27));
        }
    }
}

/// Two spheres meet, part and meet again: the second contact begins without the first one's tangential force, and with its dent.
#[test]
fn a_contact_that_closes_again_remembers_its_dent_and_not_its_shear() {
    for (kind, plastic) in [(LawKind::Hertz, false), (LawKind::Thesis, true), (LawKind::Consistent, true)] {
        for far in [0.2, 40.0] {
            // Squeeze and shear; part, by a little or by so much that they are no more near; squeeze again, without shear.
            let corners = [[0.0, 1.0], [1.0, 1.0], [1.0, -far], [0.0, -far], [0.0, 0.999], [0.0, -far]];
            let laws = book(Law::Named(kind), Friction::mindlin(0.5));
            let mut simulation = closed_path(&corners, [40e-6, 100e-6], [100e-6, 4e-7], laws);
            simulation.advance(250, &GO).unwrap();
            let first = simulation.view().contacts().next().unwrap();
            simulation.advance(249, &GO).unwrap();
            assert!(simulation.view().contacts().next().unwrap().tangential > 0.1 * first.force);
            simulation.advance(501, &GO).unwrap();
            assert!(simulation.view().contacts().next().is_none(), "parted");
            let lost = simulation.ledger();
            assert!(lost.friction > 0.0 && lost.tangential_stored == 0.0);
            let (mut silent, mut last) = (0, None);
            for _ in 0..250 {
                simulation.advance(1, &GO).unwrap();
                last = simulation.view().contacts().next();
                silent += usize::from(last.is_some_and(|touching| touching.force == 0.0));
            }
            let again = last.unwrap();
            assert!(again.tangential < 1e-9 * again.force, "{kind} {far}: {again:?}");
            assert_eq!(silent > 0, plastic, "{kind} {far}: within the dent there is no force");
            // Up to where it was before the force is that of the first blow, but for the rate (none at 0.999 of it: unloading has none).
            if plastic {
                assert_eq!(again.force_max, first.force_max.max(again.force_max), "{kind} {far}");
                assert!((again.overlap_max / first.overlap_max - 1.0).abs() < 1e-6, "{kind} {far}");
            } else {
                assert!((again.force / first.force - 0.999_f64.powf(1.5)).abs() < 1e-6, "{kind} {far}");
            }
        }
    }
}

/// Friction without spring and without damping would do nothing: it is refused.
#[test]
fn friction_without_spring_and_damping_is_refused() {
    let friction = Friction { coefficient: 0.3, spring: Spring::None, damping: 0.0, rolling: 0.0 };
    let rig = of(vec![sphere([0.0, 0.0], 1e-3)], book(Law::Named(LawKind::Hertz), friction));
    assert!(matches!(Simulation::new(rig, 1e-8).map(|_| ()), Err(RigError::Frictionless)));
}
