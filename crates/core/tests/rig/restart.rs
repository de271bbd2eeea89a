//! Stored and taken up again: the same bits.

use granulens_core::contact::LawKind;
use granulens_core::dem::rig::{Arrival, Body, Curve, Flat, Load, LoadKind, Rig, Simulation};
use granulens_core::dem::{CheckpointError, Integrator};

use crate::rigs::{DIAMETER, GO, hexagonal, rig};

/// A sheet of two materials on a wall, struck by a plate while one sphere is pushed; spheres part and meet anew.
fn busy() -> Rig<2> {
    let mut rig = rig(&hexagonal(7, 6), LawKind::Thesis);
    rig.flats = vec![
        Flat::wall("floor", [0.0, (6.0 * 0.75_f64.sqrt() + 0.5) * DIAMETER], [0.0, -1.0]),
        Flat {
            mass: 0.02,
            velocity: [0.0, 20.0],
            held: [true, false],
            ..Flat::wall("hammer", [0.0, -0.5 * DIAMETER], [0.0, 1.0])
        },
    ];
    rig.loads = vec![Load {
        bodies: vec![Body::Sphere(8), Body::Sphere(9)],
        direction: [1.0, 0.0],
        kind: LoadKind::Force,
        curve: Curve::HalfSine { peak: 8e3, start: 5e-6, duration: 30e-6 },
    }];
    rig
}

fn arrivals() -> Vec<Arrival> {
    vec![Arrival::OwnMaximum(0.01), Arrival::Displacement(50e-6), Arrival::FirstSphere(0.01)]
}

fn start() -> Simulation<2> {
    Simulation::new(busy(), 2e-7).unwrap().recording(arrivals())
}

#[test]
fn a_run_taken_up_at_any_step_ends_in_the_same_bits() {
    taken_up(start);
}

/// Adams's scheme remembers accelerations, of flats too.
#[test]
fn by_adams_too() {
    taken_up(|| Simulation::by(Integrator::Adams, busy(), 2e-7).unwrap().recording(arrivals()));
    let mut first = start();
    first.advance(100, &GO).unwrap();
    let mut other = Simulation::by(Integrator::Adams, busy(), 2e-7).unwrap().recording(arrivals());
    assert_eq!(other.restore(&first.checkpoint()), Err(CheckpointError::Other("scheme")));
    // Spins and a cluster.
    let mut rig = crate::bed::bed(0.7, 0.8);
    rig.drag = 0.01;
    let start = || Simulation::by(Integrator::Adams, rig.clone(), 0.02).unwrap();
    let mut whole = start();
    whole.advance(300, &GO).unwrap();
    let middle = whole.checkpoint();
    whole.advance(300, &GO).unwrap();
    let mut second = start();
    second.restore(&middle).unwrap();
    second.advance(300, &GO).unwrap();
    assert!(second.checkpoint() == whole.checkpoint());
}

fn taken_up(start: impl Fn() -> Simulation<2>) {
    let mut whole = start();
    whole.advance(2000, &GO).unwrap();
    let end = whole.checkpoint();
    let mut state = 12345_u64;
    for _ in 0..20 {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
        let at = 1 + (state >> 33) % 1999;
        let mut first = start();
        first.advance(at, &GO).unwrap();
        let bytes = first.checkpoint();
        let mut second = start();
        second.restore(&bytes).unwrap();
        assert_eq!(second.checkpoint(), bytes, "what is taken up is what was stored");
        second.advance(2000 - at, &GO).unwrap();
        assert!(second.checkpoint() == end, "taken up at step {at}");
    }
    assert_eq!(whole.arrivals(1).iter().filter(|arrival| arrival.is_some()).count(), 42);
}

/// With friction: the springs' stretch is part of the state.
#[test]
fn friction_is_taken_up_too() {
    let start = || Simulation::new(crate::bed::bed(0.7, 0.8), 0.02).unwrap();
    let mut whole = start();
    whole.advance(300, &GO).unwrap();
    let middle = whole.checkpoint();
    whole.advance(300, &GO).unwrap();
    let mut second = start();
    second.restore(&middle).unwrap();
    second.advance(300, &GO).unwrap();
    assert!(second.checkpoint() == whole.checkpoint());
}

#[test]
fn what_is_no_checkpoint_of_this_rig_is_refused_with_the_reason() {
    let mut first = start();
    first.advance(100, &GO).unwrap();
    let bytes = first.checkpoint();
    let refusal = |bytes: &[u8]| start().restore(bytes).unwrap_err();
    assert_eq!(refusal(b"hello"), CheckpointError::Foreign);
    let mut version = bytes.clone();
    version[20] = 9;
    assert_eq!(refusal(&version), CheckpointError::Version { of: 9, read: 8 });
    for cut in [21, 27, 40, bytes.len() - 1] {
        assert_eq!(refusal(&bytes[..cut]), CheckpointError::Damaged);
    }
    for flipped in (24..bytes.len()).step_by(bytes.len() / 50) {
        let mut damaged = bytes.clone();
        damaged[flipped] ^= 4;
        assert_eq!(refusal(&damaged), CheckpointError::Damaged);
    }
    let mut other = busy();
    other.velocity[3] = [1e-9, 0.0];
    let mut other = Simulation::new(other, 2e-7).unwrap().recording(arrivals());
    assert_eq!(other.restore(&bytes), Err(CheckpointError::Other("rig")));
    let mut other = Simulation::new(busy(), 1e-7).unwrap().recording(arrivals());
    assert_eq!(other.restore(&bytes), Err(CheckpointError::Other("step")));
    // Speeds below the least part that is asked for are not kept: other parts cannot be answered.
    let others = [Arrival::OwnMaximum(0.001), Arrival::Displacement(50e-6), Arrival::FirstSphere(0.01)];
    let mut other = Simulation::new(busy(), 2e-7).unwrap().recording(others.to_vec());
    assert_eq!(other.restore(&bytes), Err(CheckpointError::Other("set of arrivals")));
    let mut other = Simulation::new(busy(), 2e-7).unwrap();
    assert_eq!(other.restore(&bytes), Err(CheckpointError::Other("set of arrivals")));
}

/// A run's state does not grow with time: a ball that bounces on a plate for a hundred thousand steps.
#[test]
fn the_state_does_not_grow_with_time() {
    let mut rig = rig(&[[0.0, 0.0], [1.0, 0.3]], LawKind::Hertz);
    rig.gravity = [0.0, 1e4];
    rig.flats = vec![Flat::wall("floor", [0.0, 2.0 * DIAMETER], [0.0, -1.0])];
    let mut simulation = Simulation::new(rig, 2e-7).unwrap().recording(vec![Arrival::OwnMaximum(0.01)]);
    simulation.advance(20_000, &GO).unwrap();
    let early = simulation.checkpoint().len();
    simulation.advance(180_000, &GO).unwrap();
    assert!(simulation.checkpoint().len() <= early + 200, "{early} {}", simulation.checkpoint().len());
}
