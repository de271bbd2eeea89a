//! Each guard, triggered once.

use std::sync::Arc;

use granulens_core::Context;
use granulens_core::contact::{Constants, LawKind, Tabulated};
use granulens_core::dem::rig::{Bar, Body, Curve, Flat, Law, LawBook, Load, LoadKind, RigError, RigStop, Simulation};
use granulens_core::dem::{MoveIn, Spheres};

use crate::rigs::{DIAMETER, GO, rig};

fn stopped<const D: usize>(rig: granulens_core::dem::rig::Rig<D>, step: f64) -> RigStop
where
    Spheres: MoveIn<D>,
{
    Simulation::new(rig, step).unwrap().advance(20_000, &GO).unwrap_err()
}

#[test]
fn a_blow_beyond_the_law_is_stopped() {
    let mut rig = rig(&[[0.0, 0.0], [0.0, 1.0]], LawKind::Thesis);
    rig.velocity[0] = [0.0, 900.0];
    let stop = stopped(rig, 2e-8);
    assert!(matches!(stop, RigStop::Overlap { bodies: [Body::Sphere(0), Body::Sphere(1)], ratio, .. } if ratio > 0.25));
    assert!(stop.to_string().contains("sphere 1 and sphere 2 overlap by"), "{stop}");
}

/// Laws that are made for large overlaps, or under which nothing piles up, go further: to where the contact is as wide as at 25 % under the others.
#[test]
fn each_law_has_its_own_limit() {
    for (law, limit) in [(LawKind::Hertz, 0.25), (LawKind::MdrStatic, 1.0 - 0.5_f64.sqrt()), (LawKind::Thornton, 0.5)] {
        let mut rig = rig(&[[0.0, 0.0], [0.0, 1.0]], law);
        (rig.velocity[0], rig.residual_limit) = ([0.0, 4000.0], f64::INFINITY);
        let RigStop::Overlap { limit: found, ratio, .. } = stopped(rig.clone(), 5e-9) else { panic!("another guard") };
        assert!((found - limit).abs() < 1e-12 && ratio > limit, "{law}: {found} {ratio}");
        rig.overlap_limit = Some(0.1);
        let RigStop::Overlap { limit: found, .. } = stopped(rig, 5e-9) else { panic!("another guard") };
        assert_eq!(found, 0.1);
    }
}

#[test]
fn a_table_is_not_extrapolated() {
    let mut rig = rig(&[[0.0, 0.0], [0.0, 1.0]], LawKind::Hertz);
    let table = Tabulated::new(&[(0.0, 0.0), (1e-5, 1e3), (3e-5, 5e3)]).unwrap();
    rig.laws = LawBook::Materials {
        law: Law::Tabulated(Arc::new(table)),
        constants: Constants::Code,
        pairs: Vec::new(),
        friction: None,
    };
    rig.velocity[0] = [0.0, 30.0];
    let RigStop::Overlap { limit, ratio, .. } = stopped(rig, 2e-8) else { panic!("another guard") };
    assert!((limit - 3e-5 / DIAMETER).abs() < 1e-12 && ratio > limit);
}

#[test]
fn a_step_too_large_for_a_contact_that_arises_is_stopped() {
    let mut rig = rig(&[[0.0, 0.0], [0.0, 1.0]], LawKind::Thesis);
    rig.velocity[0] = [0.0, 10.0];
    let stop = stopped(rig, 6e-6);
    assert!(matches!(stop, RigStop::Step { limit, .. } if limit < 6e-6), "{stop}");
}

#[test]
fn energy_out_of_nothing_is_stopped() {
    let mut rig = rig(&[[0.0, 0.0], [0.0, 1.0]], LawKind::Hertz);
    rig.velocity[0] = [0.0, 5.0];
    rig.residual_limit = 1e-9;
    let RigStop::Residual { residual, limit, .. } = stopped(rig, 5e-7) else { panic!("another guard") };
    assert!(residual.abs() > limit);
}

#[test]
fn a_number_that_is_none_is_stopped() {
    let mut rig = rig(&[[0.0, 0.0], [0.0, 1.0]], LawKind::Hertz);
    rig.loads = vec![Load {
        bodies: vec![Body::Sphere(1)],
        direction: [0.0, 1.0],
        kind: LoadKind::Force,
        curve: Curve::Square { peak: f64::MAX, start: 0.0, duration: 1.0 },
    }];
    assert!(matches!(stopped(rig, 1e-6), RigStop::NotFinite { body: Body::Sphere(1), .. }));
}

#[test]
fn a_sphere_that_leaves_the_domain_is_named() {
    let mut rig = rig(&[[0.0, 0.0], [3.0, 0.0]], LawKind::Hertz);
    rig.velocity[1] = [10.0, 0.0];
    rig.domain = Some([[-DIAMETER, -DIAMETER], [5.0 * DIAMETER, DIAMETER]]);
    let RigStop::Escaped { body, time } = stopped(rig, 1e-6) else { panic!("another guard") };
    assert_eq!(body, Body::Sphere(1));
    assert!((time * 10.0 / (2.0 * DIAMETER) - 1.0).abs() < 0.1);
}

#[test]
fn a_request_to_stop_is_heard_and_nothing_is_lost() {
    let mut rig = rig(&[[0.0, 0.0]], LawKind::Hertz);
    rig.velocity[0] = [1.0, 0.0];
    let mut simulation = Simulation::new(rig, 1e-6).unwrap();
    let stopped = Context::default();
    stopped.stop();
    assert!(matches!(simulation.advance(1000, &stopped), Err(RigStop::Interrupted { .. })));
    assert!((simulation.view().displacement(0)[0] - simulation.time()).abs() < 1e-15);
}

#[test]
fn rigs_that_make_no_sense_are_refused() {
    let two = || rig(&[[0.0, 0.0], [0.9, 0.0]], LawKind::Hertz);
    let refused = |rig| Simulation::new(rig, 1e-7).err().unwrap();
    assert!(matches!(refused(two()), RigError::Overlap { bodies: [Body::Sphere(0), Body::Sphere(1)], .. }));
    let mut sunk = rig(&[[0.0, 0.0]], LawKind::Hertz);
    sunk.flats = vec![Flat::wall("floor", [0.0, 0.4 * DIAMETER], [0.0, -1.0])];
    assert!(matches!(refused(sunk), RigError::Overlap { bodies: [Body::Flat(0), Body::Sphere(0)], .. }));
    let mut narrow = rig(&[[0.0, 0.0]], LawKind::Hertz);
    narrow.periods[0] = Some(1.5 * DIAMETER);
    assert!(matches!(refused(narrow), RigError::Period { .. }));
    let mut heavy = rig(&[[0.0, 0.0]], LawKind::Hertz);
    heavy.mass[0] = f64::NAN;
    assert!(matches!(refused(heavy), RigError::Value { what: "the mass", .. }));
    let mut bound = rig(&[[0.0, 0.0]], LawKind::Hertz);
    bound.bars = vec![Bar { body: Body::Sphere(0), axis: 0, impedance: 1.0, incident: None }];
    bound.loads = vec![Load {
        bodies: vec![Body::Sphere(0)],
        direction: [1.0, 0.0],
        kind: LoadKind::Velocity,
        curve: Curve::Square { peak: 1.0, start: 0.0, duration: 1.0 },
    }];
    assert_eq!(refused(bound), RigError::Bound(Body::Sphere(0)));
    let mut missing = rig(&[[0.0, 0.0]], LawKind::Hertz);
    missing.bars = vec![Bar { body: Body::Sphere(7), axis: 0, impedance: 1.0, incident: None }];
    assert!(matches!(refused(missing), RigError::Missing { count: 1, .. }));
    assert!(matches!(Simulation::new(rig(&[[0.0]], LawKind::Hertz), -1.0), Err(RigError::Step { .. })));
}
