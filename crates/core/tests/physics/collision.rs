//! Two spheres meet head-on.

use granulens_core::contact::{Constants, Hertz, History, LawKind, NormalLaw as _, Pair};
use granulens_core::dem::{ForcePulse, Impact, Integrator, Mirror, Record};
use granulens_core::sample::{Sample, Sphere};

use crate::problem::{DIAMETER, run};
use crate::reference::{Table, difference, material};

/// The first sphere moves at `speed` onto the second, which it touches.
pub fn collide(names: [&str; 2], speed: f64, change: impl Fn(&mut Impact)) -> (Sample<1>, Record<1>) {
    let radius = 0.5 * DIAMETER;
    let sample = Sample {
        materials: names.map(material).to_vec(),
        spheres: vec![
            Sphere { centre: [0.0], radius, material: 0 },
            Sphere { centre: [DIAMETER], radius, material: 1 },
        ],
    };
    let mut impact = Impact {
        mirrors: Vec::new(),
        law: LawKind::Thesis,
        constants: Constants::Code,
        pulse: ForcePulse { force: 0.0, duration: 1e-6 },
        periods: Vec::new(),
        slope: 0.0,
        struck: Vec::new(),
        faces: Vec::new(),
        moving: vec![(0, speed)],
        projectile: None,
        exit: vec![1],
        integrator: Integrator::Rk4,
        step: 5e-8,
        window: 150e-6,
    };
    change(&mut impact);
    let record = run(&sample, &impact);
    (sample, record)
}

/// The same algorithm at the same step: rounding only.
#[test]
fn elastic_plastic_collisions_repeat_the_independent_ones() {
    let table = Table::read("collisions_5.csv");
    for row in 0..table.len() {
        let names: Vec<&str> = table.text(row, "pair").split('-').collect();
        let step = table.number(row, "dt");
        let (_, record) = collide([names[0], names[1]], table.number(row, "V"), |i| i.step = step);
        let contact = record.contacts[0];
        for (ours, column) in [
            (contact.force_max, "Fmax"),
            (contact.overlap_max, "dmax"),
            (record.velocity[0][0], "v1_end"),
            (record.velocity[1][0], "v2_end"),
            ((record.velocity[1][0] - record.velocity[0][0]) / table.number(row, "V"), "restitution"),
        ] {
            let theirs = table.number(row, column);
            assert!(difference(ours, theirs, 0.0) < 1e-9, "row {row} {column}: {ours} and {theirs}");
        }
    }
}

/// A free sphere under a force at an angle: m v = F t in each direction, and the work is its kinetic energy. The same as a rig.
#[test]
fn a_load_at_an_angle_gives_its_impulse_in_both_directions() {
    let sample = Sample::<2> {
        materials: vec![material("440c")],
        spheres: vec![Sphere { centre: [0.0; 2], radius: 0.5 * DIAMETER, material: 0 }],
    };
    for integrator in [Integrator::Verlet, Integrator::Rk4] {
        let impact = Impact {
            mirrors: Vec::new(),
            law: LawKind::Thesis,
            constants: Constants::Code,
            pulse: ForcePulse { force: 100.0, duration: 20e-6 },
            periods: Vec::new(),
            slope: -0.75,
            struck: vec![0],
            faces: Vec::new(),
            moving: Vec::new(),
            projectile: None,
            exit: vec![0],
            integrator,
            step: 3e-7,
            window: 50e-6,
        };
        let never = granulens_core::Context::default();
        let as_rig = granulens_core::dem::rig::simulate_as_rig(&sample, &impact, None, &never).unwrap();
        for record in [run(&sample, &impact), as_rig] {
            let wanted = 100.0 * 20e-6 / sample.mass(0);
            let [x, z] = record.velocity[0];
            // Rounding of some seventy steps.
            assert!((z / wanted - 1.0).abs() < 1e-12 && (x / (-0.75 * wanted) - 1.0).abs() < 1e-12, "{x} {z}");
            let kinetic = 0.5 * sample.mass(0) * (x * x + z * z);
            assert!((record.ledger.work_in / kinetic - 1.0).abs() < 1e-12);
        }
    }
}

/// At closest approach ½ m* v² = (2/5) k δ^{5/2}, so δ_max = (5 m* v²/4k)^{2/5} (Johnson 1985, section 11.4).
fn closest_approach(sample: &Sample<1>, speed: f64) -> f64 {
    let materials = [&sample.materials[0], &sample.materials[1]];
    let k = Hertz::new(&Pair::new(materials, [0.5 * DIAMETER; 2], Constants::Code)).coefficient;
    let reduced = sample.mass(0) * sample.mass(1) / (sample.mass(0) + sample.mass(1));
    (5.0 * reduced * speed * speed / (4.0 * k)).powf(0.4)
}

/// The contact lasts 2.943275 δ_max/v. The greatest overlap at a step is below the true one by at most the curvature's
/// part, so the error is that of the sampling and falls with the square of the step, as Verlet's own does.
#[test]
fn hertz_collision_reaches_the_closed_form_overlap() {
    let speed = 2.0;
    let error = |steps: f64| {
        let (sample, _) = collide(["440c", "440c"], speed, |_| ());
        let exact = closest_approach(&sample, speed);
        let duration = 2.943_275 * exact / speed;
        let (_, record) = collide(["440c", "440c"], speed, |i| {
            (i.law, i.integrator, i.step, i.window) =
                (LawKind::Hertz, Integrator::Verlet, duration / steps, 1.5 * duration);
        });
        // An elastic collision of equal spheres passes the velocity on.
        assert!(record.velocity[0][0].abs() < 20.0 / (steps * steps) * speed, "{:?}", record.velocity);
        (record.contacts[0].overlap_max / exact - 1.0).abs()
    };
    // Half the sampling error (π/steps)²/8 of a half sine, and Verlet's own of the same size.
    assert!(error(400.0) < 3e-5, "{}", error(400.0));
}

/// Spheres that lie apart at rest, one of them flying, meet with the same overlap and swap their velocities; so does a sphere that
/// flies towards a mirror, and meets its image at twice its speed. Neither is a contact before it comes near.
#[test]
fn spheres_that_lie_apart_meet_when_they_come_together() {
    let speed = 2.0;
    let (mut sample, _) = collide(["440c", "440c"], speed, |_| ());
    sample.spheres[1].centre[0] += 0.37 * DIAMETER;
    let exact = closest_approach(&sample, speed);
    let impact = Impact {
        mirrors: Vec::new(),
        law: LawKind::Hertz,
        constants: Constants::Code,
        pulse: ForcePulse { force: 0.0, duration: 0.0 },
        periods: Vec::new(),
        slope: 0.0,
        struck: Vec::new(),
        faces: Vec::new(),
        moving: vec![(0, speed)],
        projectile: None,
        exit: vec![1],
        integrator: Integrator::Verlet,
        step: 2.5e-8,
        window: 2e-3,
    };
    let record = run(&sample, &impact);
    // The contact lasts some 17 µs, 680 steps; see the closed form above.
    assert!((record.contacts[0].overlap_max / exact - 1.0).abs() < 3e-5);
    assert!((record.velocity[1][0] / speed - 1.0).abs() < 1e-4 && record.velocity[0][0].abs() < 1e-4 * speed);

    sample.spheres.pop();
    let mirror = Mirror { axis: 0, position: sample.spheres[0].centre[0] + 0.9 * DIAMETER, inward: -1.0 };
    let record = run(&sample, &Impact { mirrors: vec![mirror], exit: vec![0], ..impact });
    let contact = record.contacts[0];
    let closest = exact * 2_f64.powf(0.8);
    assert_eq!(contact.spheres, [0, 0]);
    assert!((contact.overlap_max / closest - 1.0).abs() < 1e-4, "{} {closest}", contact.overlap_max);
    assert!((record.velocity[0][0] / -speed - 1.0).abs() < 1e-4);
}

/// Velocity while the contact is being loaded (8 µs after 440c met 440c at 5 m/s, region II, rate on), against a fine
/// Runge-Kutta solution. Verlet is of second order although the force depends on velocity, since that is predicted to the
/// end of the step; the ratio tends to 4. Momentum is kept to rounding whatever the step.
#[test]
fn halving_the_step_quarters_the_error() {
    let speed = 5.0;
    let velocity = |integrator: Integrator, step: f64| {
        let (sample, record) = collide(["440c", "440c"], speed, |i| {
            (i.integrator, i.step, i.window) = (integrator, step, 8e-6);
        });
        let momentum = record.velocity[0][0] + record.velocity[1][0];
        assert!(difference(sample.mass(0) * momentum, sample.mass(0) * speed, 0.0) < 1e-12);
        record.velocity[1][0]
    };
    let exact = velocity(Integrator::Rk4, 1e-9);
    let error = |integrator, step| (velocity(integrator, step) - exact).abs();
    let verlet = error(Integrator::Verlet, 4e-8) / error(Integrator::Verlet, 2e-8);
    assert!((3.5..4.5).contains(&verlet), "{verlet}");
}

/// Between two moments of one elastic collision (Hertz, 440c on 440c at 5 m/s, 4 and 12 µs after they met; it lasts some 25 µs) the
/// energy ½ m* v² + (2/5) k δ^{5/2} is the same but for what the scheme makes of it: of fourth order by the multistep scheme, which
/// halving the step tends to divide by 16 (whatever it did to the first, kinked steps), of second order by Verlet.
#[test]
fn the_multistep_scheme_is_of_fourth_order_in_smooth_motion() {
    let steel = material("440c");
    let pair = Pair::new([&steel, &steel], [0.5 * DIAMETER; 2], Constants::Code);
    let law = Hertz::new(&pair);
    let error = |integrator: Integrator, step: f64| {
        let energy = |window: f64| {
            let (sample, record) = collide(["440c", "440c"], 5.0, |i| {
                (i.law, i.integrator, i.step, i.window) = (LawKind::Hertz, integrator, step, window);
            });
            let overlap = record.displacement[0][0] - record.displacement[1][0];
            let speed = record.velocity[0][0] - record.velocity[1][0];
            0.25 * sample.mass(0) * speed * speed + law.stored(overlap, &History::new())
        };
        (energy(12e-6) / energy(4e-6) - 1.0).abs()
    };
    let ratio = |integrator| error(integrator, 1e-7) / error(integrator, 5e-8);
    let (adams, verlet) = (ratio(Integrator::Adams), ratio(Integrator::Verlet));
    assert!((13.0..17.0).contains(&adams), "{adams}");
    assert!((3.8..4.2).contains(&verlet), "{verlet}");
    assert!(error(Integrator::Adams, 2e-7) < 0.01 * error(Integrator::Verlet, 2e-7));
}

/// What the law is known to get wrong (two 440c spheres): at 1 m/s it returns more than it took, e = 1.015; far below
/// yield it is not elastic, e = 0.84 at 0.05 m/s.
#[test]
fn the_published_law_has_its_known_defects() {
    let restitution = |speed: f64| {
        let (_, record) = collide(["440c", "440c"], speed, |i| (i.step, i.window) = (1e-8, 400e-6));
        (record.velocity[1][0] - record.velocity[0][0]) / speed
    };
    assert!((restitution(1.0) - 1.015).abs() < 0.0005, "{}", restitution(1.0));
    assert!((restitution(0.05) - 0.84).abs() < 0.005, "{}", restitution(0.05));
}
