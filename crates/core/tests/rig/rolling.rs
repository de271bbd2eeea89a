//! Resistance to rolling, against the closed form of a sphere that comes to rest.

use granulens_core::contact::{Constants, LawKind};
use granulens_core::dem::rig::{Flat, Friction, Law, LawBook, Rig, RigError, Simulation, Spring};
use granulens_core::sample::{Sample, Sphere};

use crate::reference::material;
use crate::rigs::{DIAMETER, GO};

/// A sphere of 440c that rolls at a speed (m/s) on a flat under gravity (m/s²), as deep in it as it lies there.
fn rolling(friction: Friction, speed: f64, gravity: f64) -> Rig<2> {
    let laws = LawBook::Materials {
        law: Law::Named(LawKind::Hertz),
        constants: Constants::Code,
        pairs: Vec::new(),
        friction: Some(friction),
    };
    let radius = 0.5 * DIAMETER;
    let mut rig = Rig::new(
        Sample {
            materials: vec![material("440c")],
            spheres: vec![Sphere { centre: [0.0, radius], radius, material: 0 }],
        },
        laws,
    );
    let steel = material("440c");
    let pair = granulens_core::contact::Pair::new([&steel, &steel], [radius; 2], Constants::Code);
    // Two equal spheres at twice the depth.
    let depth = 0.5 * (rig.mass[0] * gravity / pair.hertz_coefficient()).powf(2.0 / 3.0);
    rig.sample.spheres[0].centre[1] -= depth;
    rig.flats = vec![Flat::wall("floor", [0.0, 0.0], [0.0, 1.0])];
    (rig.gravity, rig.precompressed) = ([0.0, -gravity], true);
    rig.velocity[0] = [speed, 0.0];
    rig.spin[0] = [0.0, 0.0, -speed / (radius - depth)];
    rig
}

/// A couple μ_r R m g slows a sphere that rolls by (5/7) μ_r g: it stops after (7/5) v²/(2 μ_r g), and all its energy is with friction. The springs
/// of the contact give by some 1e-8 m, of 9 mm; then it rocks on them.
#[test]
fn a_rolling_sphere_stops_where_the_closed_form_says() {
    let (speed, gravity) = (0.08, 9.81);
    for spring in [Spring::Mindlin, Spring::CattaneoMindlin, Spring::Constant(2e6)] {
        let friction = Friction { rolling: 0.05, spring, ..Friction::mindlin(0.4) };
        let mut simulation = Simulation::new(rolling(friction, speed, gravity), 4e-6).unwrap();
        let lasts = speed / (5.0 / 7.0 * 0.05 * gravity);
        // Half way it still rolls, slowed evenly.
        simulation.advance((0.5 * lasts / 4e-6) as u64, &GO).unwrap();
        let view = simulation.view();
        assert!((view.velocity(0)[0] / (0.5 * speed) - 1.0).abs() < 1e-3, "{spring:?}: {:?}", view.velocity(0));
        assert!((view.velocity(0)[0] + 0.5 * DIAMETER * view.spin(0)[2]).abs() < 1e-3 * speed, "{spring:?}: it slides");
        simulation.advance((0.6 * lasts / 4e-6) as u64, &GO).unwrap();
        let exact = 1.4 * speed * speed / (2.0 * 0.05 * gravity);
        let view = simulation.view();
        assert!((view.displacement(0)[0] / exact - 1.0).abs() < 1e-3, "{spring:?}: {:?} {exact}", view.displacement(0));
        assert!(view.velocity(0)[0].abs() < 1e-2 * speed, "{spring:?}: {:?}", view.velocity(0));
        let ledger = simulation.ledger();
        let rolled = 0.7 * simulation.rig().mass[0] * speed * speed;
        assert!((ledger.friction / rolled - 1.0).abs() < 1e-2, "{spring:?}: {ledger:?} of {rolled:e}");
    }
    // Without it nothing stops it.
    let simulation = {
        let mut simulation = Simulation::new(rolling(Friction::mindlin(0.4), speed, gravity), 4e-6).unwrap();
        simulation.advance(50_000, &GO).unwrap();
        simulation
    };
    assert!((simulation.view().velocity(0)[0] / speed - 1.0).abs() < 1e-6);
}

/// Taken up again, a rolling sphere goes on to the same bits, with what its contact remembers of rolling and of its row of springs.
#[test]
fn a_rolling_sphere_is_taken_up_to_the_bit() {
    let friction = Friction { rolling: 0.05, spring: Spring::CattaneoMindlin, ..Friction::mindlin(0.4) };
    let begin = || Simulation::new(rolling(friction, 0.08, 9.81), 4e-6).unwrap();
    let mut through = begin();
    through.advance(4000, &GO).unwrap();
    let mut first = begin();
    first.advance(1500, &GO).unwrap();
    let mut second = begin();
    second.restore(&first.checkpoint()).unwrap();
    second.advance(2500, &GO).unwrap();
    assert_eq!(second.checkpoint(), through.checkpoint());
}

/// Nothing would resist rolling without a spring.
#[test]
fn resistance_to_rolling_needs_a_spring() {
    let friction = Friction { coefficient: 0.3, spring: Spring::None, damping: 1e4, rolling: 0.1 };
    assert_eq!(Simulation::new(rolling(friction, 0.1, 9.81), 1e-6).err(), Some(RigError::Frictionless));
}
