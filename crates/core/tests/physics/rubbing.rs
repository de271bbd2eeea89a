//! Friction and rotation in crystals: closed forms of one contact, the ledger, and rigs, which follow their contacts by other code.

use granulens_core::contact::{Constants, LawKind};
use granulens_core::dem::rig::{Friction, simulate_as_rig};
use granulens_core::dem::{ForcePulse, Impact, Integrator, Record, simulate, simulate_with_friction};
use granulens_core::sample::{Sample, Sphere};

use crate::problem::DIAMETER;
use crate::reference::material;

static GO: std::sync::LazyLock<granulens_core::Context> = std::sync::LazyLock::new(granulens_core::Context::default);

fn impact(moving: Vec<(usize, f64)>, window: f64) -> Impact {
    Impact {
        mirrors: Vec::new(),
        law: LawKind::Hertz,
        constants: Constants::Code,
        pulse: ForcePulse { force: 0.0, duration: 0.0 },
        periods: Vec::new(),
        slope: 0.0,
        struck: Vec::new(),
        faces: Vec::new(),
        moving,
        projectile: None,
        exit: Vec::new(),
        integrator: Integrator::Adams,
        step: 2e-8,
        window,
    }
}

/// Two 440c spheres whose line of centres stands at an angle to the flight of the first.
fn glancing(angle: f64, speed: f64, friction: f64) -> (Sample<2>, Record<2>) {
    let sphere = |centre| Sphere { centre, radius: 0.5 * DIAMETER, material: 0 };
    let second = [DIAMETER * angle.sin(), DIAMETER * angle.cos()];
    let sample = Sample { materials: vec![material("440c")], spheres: vec![sphere([0.0; 2]), sphere(second)] };
    let record = simulate_with_friction(&sample, &impact(vec![(0, speed)], 60e-6), friction, &GO).unwrap();
    (sample, record)
}

/// A glancing collision in which the surfaces slide to the end, tan θ > (7/2) μ (1 + e): the tangential impulse is μ times the
/// normal one, and so the second sphere, which had been at rest, leaves with v cos θ (n + μ t) (Maw, Barber and Fawcett 1976, gross
/// slip; e = 1). The work of friction is the loss of kinetic energy, rotation included. The line of centres turns by 3e-4 while they
/// touch, and lever arms are shorter by δ/2r = 1e-4.
#[test]
fn a_glancing_collision_slides_by_coulombs_law() {
    let (angle, speed, mu) = (1.2_f64, 0.05, 0.1);
    let (sample, record) = glancing(angle, speed, mu);
    let (sine, cosine) = angle.sin_cos();
    let wanted = [cosine * (sine - mu * cosine), cosine * (cosine + mu * sine)].map(|share| share * speed);
    for k in 0..2 {
        assert!(
            (record.velocity[1][k] - wanted[k]).abs() < 1e-3 * speed * cosine,
            "{:?} {wanted:?}",
            record.velocity[1]
        );
    }
    // Both spheres turn alike: r J_t = I ω, and lose what friction took.
    let mass = sample.mass(0);
    let impulse = mu * mass * speed * cosine;
    let slide = speed * sine;
    // ∫T u dt with u falling evenly in the impulse, at (2/m + 2 r²/I) = 7/m a unit of it.
    let lost = impulse * slide - 0.5 * impulse * impulse * 7.0 / mass;
    let ledger = record.ledger;
    assert!((ledger.dissipated / lost - 1.0).abs() < 2e-3, "{} {lost}", ledger.dissipated);
    assert!(ledger.residual().unwrap().abs() < 1e-5, "{:?}", ledger.residual());
    // Momentum is kept to rounding.
    let momentum = [0, 1].map(|k| record.velocity[0][k] + record.velocity[1][k]);
    assert!(momentum[0].abs() < 1e-12 * speed && (momentum[1] / speed - 1.0).abs() < 1e-12, "{momentum:?}");
}

/// Where part of the contact sticks, the spring's stiffness decides what becomes of the motion along it: as in a rig, whose friction is other code (and is held to an
/// integration of its own, `rig::contacts`). Half the stiffness would move the second sphere's velocity by percents.
#[test]
fn a_sticking_collision_is_the_rigs() {
    for (angle, mu) in [(0.2, 0.3), (0.4, 0.3), (0.6, 0.5)] {
        let (sample, record) = glancing(angle, 0.5, mu);
        let rig = simulate_as_rig(&sample, &impact(vec![(0, 0.5)], 60e-6), Some(Friction::mindlin(mu)), &GO).unwrap();
        for k in 0..2 {
            let (ours, theirs) = (record.velocity[1][k], rig.velocity[1][k]);
            assert!((ours - theirs).abs() < 2e-4 * 0.5, "{angle} {mu}: {ours} {theirs}");
        }
        assert!(record.velocity[1][1] > 0.3 && record.stop.is_none() && rig.stop.is_none());
    }
}

/// A steep collision sticks: spring and slip at the rim give back part of the tangential motion, and nothing is gained. With μ so
/// large that nothing slips nothing is lost: Mindlin's spring is elastic where the overlap grows, and softens as it falls.
#[test]
fn friction_never_gives_energy() {
    for (angle, mu) in [(0.2, 0.3), (0.5, 0.3), (0.5, 10.0), (0.9, 0.5), (1.2, 0.02)] {
        let (_, record) = glancing(angle, 0.5, mu);
        let ledger = record.ledger;
        assert!(ledger.residual().unwrap().abs() < 1e-4, "{angle} {mu}: {:?}", ledger.residual());
        assert!(ledger.dissipated > 0.0 && ledger.dissipated < ledger.work_in, "{angle} {mu}: {ledger:?}");
    }
    assert!(glancing(0.5, 0.5, 0.0).1.ledger.dissipated.abs() < 1e-6 * glancing(0.5, 0.5, 0.3).1.ledger.work_in);
}

/// A sheet struck at an angle, against the same as a rig: other code for contacts and another scheme, of second order.
#[test]
fn a_crystal_with_friction_moves_as_a_rig() {
    let spheres = (0..60)
        .map(|i| {
            let (row, column) = (i / 6, i % 6);
            let x = column as f64 + if row % 2 == 1 { 0.5 } else { 0.0 };
            Sphere {
                centre: [x * DIAMETER, row as f64 * 0.75_f64.sqrt() * DIAMETER],
                radius: 0.5 * DIAMETER,
                material: 0,
            }
        })
        .collect();
    let sample = Sample { materials: vec![material("440c")], spheres };
    let mut impact = impact(Vec::new(), 30e-6);
    (impact.pulse, impact.slope) = (ForcePulse { force: 4e3, duration: 10e-6 }, 0.4);
    (impact.struck, impact.law) = ((0..6).collect(), LawKind::Thesis);
    let total = |record: &Record<2>| record.max_kinetic.iter().sum::<f64>();
    let smooth = simulate(&sample, &impact, &GO).unwrap();
    let ours = simulate_with_friction(&sample, &impact, 0.3, &GO).unwrap();
    let rig = simulate_as_rig(&sample, &impact, Some(Friction::mindlin(0.3)), &GO).unwrap();
    assert!(ours.stop.is_none() && ours.ledger.residual().unwrap().abs() < 1e-4, "{:?}", ours.ledger.residual());
    let apart = (total(&ours) / total(&rig) - 1.0).abs();
    let effect = (total(&smooth) / total(&rig) - 1.0).abs();
    assert!(apart < 2e-3 && effect > 20.0 * apart, "{apart} {effect}");
    let strongest = rig.max_kinetic.iter().copied().fold(0.0, f64::max);
    for (i, (a, b)) in ours.max_kinetic.iter().zip(&rig.max_kinetic).enumerate() {
        assert!((a - b).abs() < 5e-3 * strongest, "sphere {i}: {a} {b}");
    }
    // Every scheme comes to the same.
    for integrator in [Integrator::Verlet, Integrator::Rk4] {
        impact.integrator = integrator;
        let other = simulate_with_friction(&sample, &impact, 0.3, &GO).unwrap();
        assert!((total(&other) / total(&ours) - 1.0).abs() < 1e-3, "{integrator}");
    }
}
