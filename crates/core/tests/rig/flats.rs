//! Flats of a material of their own, and friction of single flats and pairs of materials, against closed forms.

use granulens_core::contact::{Constants, LawKind, Pair};
use granulens_core::dem::rig::{Flat, FlatContact, Friction, Law, LawBook, Loss, PairRule, Rig, SpringDashpot};
use granulens_core::sample::{Sample, Sphere};

use crate::reference::material;
use crate::rigs::{DIAMETER, run};

/// Spheres of 440c (0) and brass (1), under Hertz's law.
fn two_metals(spheres: Vec<Sphere<2>>, pairs: Vec<PairRule>) -> Rig<2> {
    let laws =
        LawBook::Materials { law: Law::Named(LawKind::Hertz), constants: Constants::Code, pairs, friction: None };
    Rig::new(Sample { materials: vec![material("440c"), material("brass")], spheres }, laws)
}

/// A sphere of 440c that comes down on a flat.
fn drop_on(contact: FlatContact, velocity: [f64; 2]) -> Rig<2> {
    let radius = 0.5 * DIAMETER;
    let mut rig = two_metals(vec![Sphere { centre: [0.0, radius], radius, material: 0 }], Vec::new());
    rig.flats = vec![Flat { contact, ..Flat::wall("floor", [0.0, 0.0], [0.0, 1.0]) }];
    rig.velocity[0] = velocity;
    rig
}

/// On an elastic half-space F = (4/3) E* √R d^{3/2} with E* of both materials: d_max = (5 m v²/4k)^{2/5}, and it leaves as fast as it came (Johnson
/// 1985, §11.4). The record shows depth and force of the sphere; on brass it is softer than on a rigid face by E_rigid*/E*.
#[test]
fn a_flat_of_brass_is_an_elastic_half_space() {
    let [steel, brass] = ["440c", "brass"].map(material);
    let contact = FlatContact { material: Some(1), ..FlatContact::default() };
    let rig = drop_on(contact, [0.0, -1.0]);
    let (mass, radius) = (rig.mass[0], 0.5 * DIAMETER);
    let compliance = [&steel, &brass].map(|m| (1.0 - m.poisson_ratio * m.poisson_ratio) / m.youngs_modulus);
    let k = 4.0 / 3.0 / (compliance[0] + compliance[1]) * radius.sqrt();
    let deepest = (5.0 * mass / (4.0 * k)).powf(0.4);
    let lasts = 2.943_275_2 * deepest;
    let step = lasts / 2000.0;
    let simulation = run(rig.clone(), step, 1000);
    let touching = simulation.view().contacts().next().unwrap();
    assert!((touching.overlap / deepest - 1.0).abs() < 1e-4, "{} {deepest}", touching.overlap);
    assert!((touching.force / (k * deepest.powf(1.5)) - 1.0).abs() < 2e-4, "{}", touching.force);
    assert!((touching.stored / (0.5 * mass) - 1.0).abs() < 1e-3, "{}", touching.stored);
    let simulation = run(rig, step, 2100);
    assert!((simulation.view().velocity(0)[1] - 1.0).abs() < 1e-5, "{:?}", simulation.view().velocity(0));
    // A half-space is a sphere without curvature, under every law.
    let pair = Pair::new([&steel, &brass], [radius, f64::INFINITY], Constants::Code);
    assert!((pair.hertz_coefficient() / k - 1.0).abs() < 1e-12);
    assert_eq!((pair.radius, pair.radii_sum), (radius, DIAMETER));
}

/// A stiffness and a restitution of the flat alone: π √(m/k) and e (the flat stands for an equal sphere: twice the overlap, half the mass).
#[test]
fn a_flat_has_a_spring_of_its_own() {
    let (stiffness, restitution) = (1e6, 0.6);
    let law = Law::SpringDashpot(SpringDashpot::with_restitution(stiffness, restitution, true));
    let rig = drop_on(FlatContact { law: Some(law), ..FlatContact::default() }, [0.0, -0.5]);
    let lasts = std::f64::consts::PI * (0.5 * rig.mass[0] / stiffness).sqrt();
    let step = lasts / 2000.0;
    let simulation = run(Rig { residual_limit: 0.1, ..rig }, step, 4000);
    let left = simulation.view().velocity(0)[1] / 0.5;
    assert!((left / restitution - 1.0).abs() < 1e-4, "{left}");
    assert_eq!(SpringDashpot { stiffness, loss: Loss::with_restitution(restitution, true), cut: true }.stiffness, 1e6);
}

/// Friction of a flat, or of a pair of metals, alone: what slides throughout keeps e_t = 1 − μ (1 + e)/tan θ, at 1e-6 m/s, where the normal does
/// not turn; a pair without friction of its own slides freely.
#[test]
fn friction_is_that_of_the_flat_or_of_the_pair() {
    let (speed, mu, angle) = (1e-6, 0.1, 60_f64);
    let (sin, cos) = angle.to_radians().sin_cos();
    let exact = 1.0 - 2.0 * mu / angle.to_radians().tan();
    let on = |friction| {
        let contact = FlatContact { friction, ..FlatContact::default() };
        let simulation = run(drop_on(contact, [speed * sin, -speed * cos]), 2e-7, 4000);
        assert!(simulation.view().contacts().next().is_none());
        simulation.view().velocity(0)[0] / (speed * sin)
    };
    assert!((on(Some(Friction::mindlin(mu))) - exact).abs() < 1e-5, "{} {exact}", on(Some(Friction::mindlin(mu))));
    assert!((on(None) - 1.0).abs() < 1e-12);
    let between = |materials: [usize; 2]| {
        let radius = 0.5 * DIAMETER;
        let rule = PairRule { materials: [1, 0], law: None, friction: Some(Friction::mindlin(mu)) };
        let [a, b] = materials;
        let spheres = vec![
            Sphere { centre: [0.0, radius], radius, material: a },
            Sphere { centre: [0.0, -radius], radius, material: b },
        ];
        let mut rig = two_metals(spheres, vec![rule]);
        rig.velocity[0] = [speed * sin, -speed * cos];
        rig.held[1] = [true; 2];
        let simulation = run(rig, 2e-7, 4000);
        assert!(simulation.view().contacts().next().is_none());
        simulation.view().velocity(0)[0] / (speed * sin)
    };
    for materials in [[0, 1], [1, 0]] {
        assert!((between(materials) - exact).abs() < 1e-5, "{materials:?}: {} {exact}", between(materials));
    }
    assert!((between([0, 0]) - 1.0).abs() < 1e-6);
}
