//! Plates side by side: where one ends and the next begins nothing is felt.

use super::*;

/// A sphere of 10 mm on plates: fastest the blow of case 7.
fn on_plates<const D: usize>(velocity: [f64; D], plates: Vec<Flat<D>>, friction: Option<Friction>) -> Rig<D> {
    let mut centre = [0.0; D];
    centre[D - 1] = 5e-3;
    let laws =
        LawBook::Materials { law: Law::Named(LawKind::Hertz), constants: Constants::Code, pairs: Vec::new(), friction };
    let mut rig = of(vec![sphere(centre, 5e-3)], laws);
    rig.velocity[0] = velocity;
    rig.flats = plates;
    rig
}

fn strip(name: &str, corners: Vec<[f64; 2]>) -> Flat<2> {
    Flat { face: Face::Polygon(corners.clone()), ..Flat::wall(name, corners[0], [0.0, 1.0]) }
}

fn plate(name: &str, corners: Vec<[f64; 3]>) -> Flat<3> {
    Flat { face: Face::Polygon(corners.clone()), ..Flat::wall(name, corners[0], [0.0, 0.0, 1.0]) }
}

/// Greatest force, and the velocity after the blow.
fn bounce<const D: usize>(rig: Rig<D>) -> (f64, [f64; D])
where
    Spheres: MoveIn<D>,
{
    let mut simulation = Simulation::new(rig, 5e-8).unwrap();
    let mut force = 0.0_f64;
    for _ in 0..1200 {
        simulation.advance(1, &GO).unwrap();
        force = force.max(simulation.view().net_force(0)[D - 1]);
    }
    (force, simulation.view().velocity(0))
}

/// Coplanar plates are one face: wherever the seam lies, the blow is that on one plate, without a kick (case 7: 557.3 N). So on a
/// line, on the corner of four plates in space, on plates that overlap or lie on a wall; and a ridge bears once.
#[test]
fn a_seam_is_not_felt() {
    let (whole, velocity) = bounce(on_plates([0.0, -1.0], vec![strip("a", vec![[-0.02, 0.0], [0.02, 0.0]])], None));
    // Two spheres of reduced mass m/2 at 2 v: F = k δ^{3/2} with δ^{5/2} = 5 m v²/2k; a sample each microsecond sees 557.3 N of it.
    let steel = material("440c");
    let stiffness = 4.0 / 3.0 * steel.youngs_modulus / (2.0 * (1.0 - steel.poisson_ratio.powi(2))) * 2.5e-3_f64.sqrt();
    let mass = steel.sphere_mass(10e-3);
    let exact = stiffness * (2.5 * mass / stiffness).powf(0.6);
    assert!((whole / exact - 1.0).abs() < 1e-5 && velocity[0] == 0.0, "{whole} {exact}");
    // A seam that is nearer than rounding tells (1e-12 m) may bear on its edge: 2e-10 off the normal.
    for at in [0.0, 0.2e-3, -1e-9, 1e-12, 0.04e-3] {
        for reversed in [false, true] {
            let mut plates = vec![strip("a", vec![[-0.02, 0.0], [at, 0.0]]), strip("b", vec![[at, 0.0], [0.02, 0.0]])];
            if reversed {
                plates.reverse();
            }
            let (force, velocity) = bounce(on_plates([0.0, -1.0], plates, None));
            assert!((force / whole - 1.0).abs() < 1e-12 && velocity[0].abs() < 1e-9, "{at}: {force} {velocity:?}");
        }
    }
    let square = |name, [x, y]: [f64; 2], turned: bool| {
        let mut corners = vec![[x, y, 0.0], [x + 0.02, y, 0.0], [x + 0.02, y + 0.02, 0.0], [x, y + 0.02, 0.0]];
        if turned {
            corners.reverse();
        }
        plate(name, corners)
    };
    for [x, y] in [[0.0, 0.0], [0.1e-3, -0.05e-3]] {
        let four = [[x, y], [x - 0.02, y], [x, y - 0.02], [x - 0.02, y - 0.02]];
        let mut plates: Vec<Flat<3>> = four.iter().map(|&at| square("square", at, at[0] < x)).collect();
        let (force, velocity) = bounce(on_plates([0.0, 0.0, -1.0], plates.clone(), None));
        assert!((force / whole - 1.0).abs() < 1e-12 && velocity[0].hypot(velocity[1]) < 1e-12, "{force} {velocity:?}");
        // Doubled plates, and a wall behind them.
        plates.push(square("again", [x - 0.01, y - 0.01], false));
        plates.push(Flat::wall("wall", [0.0; 3], [0.0, 0.0, 1.0]));
        let (force, velocity) = bounce(on_plates([0.0, 0.0, -1.0], plates, None));
        assert!((force / whole - 1.0).abs() < 1e-12 && velocity[0].hypot(velocity[1]) < 1e-12, "{force} {velocity:?}");
    }
    let roof = |x: f64| vec![[0.0, 0.0], [x, -0.02]];
    let sloped = |x: f64| {
        let length = f64::hypot(x, 0.02);
        Flat { normal: [0.02 * x.signum() / length, x.abs() / length], ..strip("roof", roof(x)) }
    };
    let (force, velocity) = bounce(on_plates([0.0, -1.0], vec![sloped(0.02), sloped(-0.02)], None));
    assert!((force / whole - 1.0).abs() < 1e-6 && velocity[0].abs() < 1e-6, "a ridge: {force} {velocity:?}");
}

/// A sphere that rolls and slides over seams moves as on one plate: the contact goes with it, its tangential spring and all.
#[test]
fn a_rolling_sphere_does_not_feel_seams() {
    let ride = |plates: Vec<Flat<2>>| {
        let mut rig = on_plates([0.3, 0.0], plates, Some(Friction::mindlin(0.3)));
        rig.sample.spheres[0].centre[1] -= 1e-6;
        (rig.gravity, rig.precompressed) = ([0.0, -2e4], true);
        rig.residual_limit = 1.0;
        let mut simulation = Simulation::new(rig, 2e-7).unwrap();
        let mut way = Vec::new();
        for _ in 0..50 {
            simulation.advance(600, &GO).unwrap();
            let view = simulation.view();
            way.push([view.velocity(0)[0], view.velocity(0)[1], 5e-3 * view.spin(0)[2], view.displacement(0)[0]]);
        }
        (way, simulation.ledger().friction)
    };
    let (one, lost) = ride(vec![strip("one", vec![[-0.02, 0.0], [0.02, 0.0]])]);
    assert!(one[49][3] > 1e-3 && lost > 0.0, "{:?}", one[49]);
    let ends = [-0.02, -0.001, 0.000_05, 0.000_3, 0.000_31, 0.000_7, 0.0009, 0.02];
    let many = ends.windows(2).map(|w| strip("part", vec![[w[0], 0.0], [w[1], 0.0]])).collect();
    let (other, also) = ride(many);
    for (a, b) in one.iter().zip(&other) {
        for k in 0..4 {
            assert!((a[k] - b[k]).abs() < 1e-9, "{a:?} {b:?}");
        }
    }
    assert!((also / lost - 1.0).abs() < 1e-9);
}
