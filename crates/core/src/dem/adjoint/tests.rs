//! The transposed run against the run itself: its bits, its forward mode, its differences.

use super::contact::QUANTITIES;
use super::model::{Frame, Model, Scratch, State, Turning, inverse_inertias, inverse_masses, kinds};
use super::{Fastest, Gradient, Gradients, gradient};
use crate::Context;
use crate::contact::{Constants, LawKind};
use crate::dem::impact::contacts_found;
use crate::dem::{ForcePulse, Impact, Integrator, Mirror, Record, simulate, simulate_with_friction, steps_in};
use crate::lattice::HexagonalSheet;
use crate::layout::Layout;
use crate::material::find;
use crate::real::Dual;
use crate::sample::Sample;
use crate::search::Rng;

const DIAMETER: f64 = 6.35e-3;

/// Eight rows of three metals, mixed, between two mirrors, one of which spheres lie on and the other beside.
fn sample() -> Sample<2> {
    let names = ["stainless-440c", "brass-260", "aluminium-2017"];
    let materials = names.iter().map(|name| find(name, &[]).expect("in the library")).collect();
    let lattice = HexagonalSheet::new(DIAMETER, 8, 3.5).expect("a sheet");
    let mut rng = Rng::new(7);
    let mut layout = Layout::new(lattice, materials, |_| 0);
    layout.materials.fill_with(|| rng.below(3) as u8);
    layout.sample()
}

fn impact(law: LawKind, integrator: Integrator) -> Impact {
    let lattice = HexagonalSheet::new(DIAMETER, 8, 3.5).expect("a sheet");
    let sites = lattice.sites();
    Impact {
        mirrors: vec![
            Mirror { axis: 0, position: 0.0, inward: 1.0 },
            Mirror { axis: 0, position: lattice.half_width(), inward: -1.0 },
        ],
        law,
        constants: Constants::default(),
        pulse: ForcePulse { force: 8e3, duration: 20e-6 },
        periods: Vec::new(),
        slope: 0.0,
        struck: (0..sites.len()).filter(|&i| sites[i].row == 1).collect(),
        faces: Vec::new(),
        moving: Vec::new(),
        projectile: None,
        exit: Vec::new(),
        integrator,
        step: 1.3e-7,
        window: 60e-6,
    }
}

/// The spheres of the last rows but one, unequally weighed.
fn sum(sample: &Sample<2>) -> Vec<(usize, f64)> {
    let count = sample.spheres.len();
    (count / 2..count - 6).map(|i| (i, 1.0 + 0.1 * (i % 3) as f64)).collect()
}

/// μ of the tests: none, and one at which contacts stick for a while and then slide.
const FRICTION: [Option<f64>; 2] = [None, Some(0.2)];

fn run(sample: &Sample<2>, impact: &Impact, friction: Option<f64>) -> Gradients {
    gradient(sample, impact, friction, &[sum(sample)], &Context::default()).expect("a run with derivatives")
}

fn recorded(sample: &Sample<2>, impact: &Impact, friction: Option<f64>) -> Record<2> {
    let context = Context::default();
    match friction {
        None => simulate(sample, impact, &context),
        Some(coefficient) => simulate_with_friction(sample, impact, coefficient, &context),
    }
    .expect("a sound packing")
}

fn value(sample: &Sample<2>, impact: &Impact, friction: Option<f64>) -> f64 {
    let record = recorded(sample, impact, friction);
    assert!(record.stop.is_none(), "{:?}", record.stop);
    sum(sample).iter().map(|&(i, weight)| weight * record.max_kinetic[i]).sum()
}

/// A direction in the space of all quantities, places and the load.
struct Direction {
    quantities: Vec<[f64; QUANTITIES]>,
    place: Vec<[f64; 2]>,
    load: f64,
}

fn random_direction(frame: &Frame) -> Direction {
    let mut rng = Rng::new(11);
    let mut one = || rng.unit() - 0.5;
    let quantities = frame.mobility.iter().map(|_| std::array::from_fn(|_| one())).collect();
    // What lies on a mirror stays there.
    let place = frame.mobility.iter().map(|mobility| mobility.map(|m| if m == 0.0 { 0.0 } else { DIAMETER * one() }));
    Direction { quantities, place: place.collect(), load: 0.3 }
}

fn dot(gradient: &Gradient, direction: &Direction) -> (f64, f64) {
    let mut terms = vec![gradient.load * direction.load];
    for (i, quantities) in direction.quantities.iter().enumerate() {
        let of = [gradient.density[i], gradient.youngs_modulus[i], gradient.yield_stress[i], gradient.radius[i]];
        terms.extend(of.iter().zip(quantities).map(|(a, b)| a * b));
        terms.extend(gradient.place[i].iter().zip(&direction.place[i]).map(|(a, b)| a * b));
    }
    (terms.iter().sum(), terms.iter().map(|term| term.abs()).sum())
}

/// The derivative along a direction by forward mode: the whole run in dual numbers.
fn forward(sample: &Sample<2>, impact: &Impact, friction: Option<f64>) -> (f64, Direction) {
    type One = Dual<f64, 1>;
    let (list, grains, _) = contacts_found(sample, impact, friction, &Context::default()).expect("a sound packing");
    let mut frame = Frame::new(sample, (impact, friction), &list, &grains);
    let kinds = kinds(sample, impact, &mut frame);
    let direction = random_direction(&frame);
    let along = |value: f64, slope: f64| One { value, slopes: [slope] };
    let ends = frame.ends.clone();
    let make = |c: usize| {
        let [a, b] = ends[c].map(|i| direction.quantities[i]);
        let by: Vec<f64> = a.into_iter().chain(b).collect();
        kinds[frame.kind[c]].make(&|value, slopes| along(value, slopes.iter().zip(&by).map(|(s, d)| s * d).sum()))
    };
    let makes = (0..ends.len()).map(make).collect();
    let heavier = |i: usize| direction.quantities[i][0] + 3.0 * direction.quantities[i][3];
    let inverse_mass = inverse_masses(sample);
    let inverse_mass = inverse_mass.iter().enumerate().map(|(i, &value)| along(value, -value * heavier(i)));
    // I goes as the density and the fifth power of the radius.
    let inertia = |i: usize| direction.quantities[i][0] + 5.0 * direction.quantities[i][3];
    let inverse_inertia = inverse_inertias(sample, &frame, &grains).into_iter().enumerate();
    let inverse_inertia = inverse_inertia.map(|(i, value)| along(value, -value * inertia(i))).collect();
    let model = Model::<One> { inverse_mass: inverse_mass.collect(), inverse_inertia, makes };
    frame.kind = (0..ends.len()).collect();

    let mut state = State::<One>::at_start(&frame, &impact.moving);
    for (displacement, place) in state.displacement.iter_mut().zip(&direction.place) {
        *displacement = place.map(|slope| along(0.0, slope));
    }
    let spheres = sample.spheres.len();
    let (mut scratch, mut squared, mut slope) = (Scratch::new(&frame), vec![0.0; spheres], vec![0.0; spheres]);
    for step in 0..steps_in(impact.window, impact.step) {
        let load = impact.pulse.during(step, impact.step);
        frame.advance(&model, &mut state, along(load, load * direction.load), &mut scratch);
        for (i, [x, z]) in state.velocity.iter().enumerate() {
            let square = *x * *x + *z * *z;
            if square.value > squared[i] {
                squared[i] = square.value;
                slope[i] = square.slopes[0];
            }
        }
    }
    let term = |&(i, weight): &(usize, f64)| weight * 0.5 * sample.mass(i) * (slope[i] + heavier(i) * squared[i]);
    (sum(sample).iter().map(term).sum(), direction)
}

#[test]
fn the_run_behind_a_gradient_is_the_run() {
    let sample = sample();
    for integrator in [Integrator::Adams, Integrator::Verlet] {
        for law in [LawKind::Thesis, LawKind::Consistent, LawKind::Mdr] {
            for friction in FRICTION {
                let impact = impact(law, integrator);
                let gradients = run(&sample, &impact, friction);
                let record = recorded(&sample, &impact, friction);
                assert_eq!(gradients.max_kinetic, record.max_kinetic, "{law}, {integrator}, {friction:?}");
            }
        }
    }
}

/// <J d, w> = <d, Jᵀ w> for every law and both schemes, with friction and without: what is lost of a scheme's, a law's or a spring's memory, or has a
/// wrong sign, differs.
#[test]
fn backwards_is_forwards_transposed() {
    let sample = sample();
    for integrator in [Integrator::Adams, Integrator::Verlet] {
        for &law in LawKind::ALL {
            for friction in FRICTION {
                let impact = impact(law, integrator);
                let (forward, direction) = forward(&sample, &impact, friction);
                let (backward, scale) = dot(&run(&sample, &impact, friction).of[0], &direction);
                let error = (forward - backward).abs() / scale;
                let what = format!("{law}, {integrator}, {friction:?}");
                assert!(error < 1e-11 && scale > 0.0, "{what}: {forward:e} and {backward:e}, {error:e}");
            }
        }
    }
}

/// Friction takes part: contacts stick and slide, spheres turn, and derivatives are others.
#[test]
fn friction_changes_derivatives() {
    let sample = sample();
    let impact = impact(LawKind::Thesis, Integrator::Verlet);
    let [without, with] = FRICTION.map(|friction| run(&sample, &impact, friction).of.remove(0));
    let size = without.density.iter().map(|by| by.abs()).fold(0.0, f64::max);
    let apart = without.density.iter().zip(&with.density).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(apart > 0.01 * size, "{apart:e} of {size:e}");
}

/// Contacts are smooth under Hertz's law, so that central differences are as good as their step squared: 1e-10 times what the third
/// derivative is over the first, which spheres that have collided a few times make some thousands. With friction contacts have kinks where they begin
/// to slide or to unload; these spheres' differences step over none.
#[test]
fn derivatives_are_differences_where_contacts_are_smooth() {
    for friction in FRICTION {
        derivatives_are_differences(friction);
    }
}

fn derivatives_are_differences(friction: Option<f64>) {
    let sample = sample();
    let impact = Impact { window: 40e-6, ..impact(LawKind::Hertz, Integrator::Adams) };
    let value = |sample: &Sample<2>, impact: &Impact| value(sample, impact, friction);
    let gradient = &run(&sample, &impact, friction).of[0];
    let scale = gradient.density.iter().map(|by| by.abs()).fold(0.0, f64::max);
    assert!(scale > 0.01 * gradient.value, "nothing depends on anything");
    let change = 1e-5;
    // Spheres 4 and 11 touch their images.
    for i in [0, 4, 5, 9, 11, 17, 24, 30] {
        let with = |which: usize, factor: f64| {
            let mut changed = sample.clone();
            let mut material = changed.materials[changed.spheres[i].material].clone();
            match which {
                0 => material.density *= factor,
                _ => material.youngs_modulus *= factor,
            }
            changed.spheres[i].material = changed.materials.len();
            changed.materials.push(material);
            value(&changed, &impact)
        };
        for (which, derivative) in [gradient.density[i], gradient.youngs_modulus[i]].into_iter().enumerate() {
            let span = f64::ln_1p(change) - f64::ln_1p(-change);
            let difference = (with(which, 1.0 + change) - with(which, 1.0 - change)) / span;
            let error = (difference - derivative).abs() / scale;
            assert!(error < 1e-6, "sphere {i}, quantity {which}: {derivative:e} and {difference:e}");
        }
        // Radii can only shrink, since spheres touch: a difference to one side, of second order.
        let change = 1e-6;
        let shrunk = |by: f64| {
            let mut changed = sample.clone();
            changed.spheres[i].radius *= 1.0 - by;
            value(&changed, &impact)
        };
        let difference = (3.0 * shrunk(0.0) - 4.0 * shrunk(change) + shrunk(2.0 * change)) / (2.0 * change);
        let by_radius = gradient.radius.iter().map(|by| by.abs()).fold(0.0, f64::max);
        let error = (difference - gradient.radius[i]).abs() / by_radius;
        // Gaps of a millionth of a diameter: force begins as their power 3/2, so that the error goes as their root.
        assert!(error < 5e-3, "radius of sphere {i}: {:e} and {difference:e}", gradient.radius[i]);
    }
    let harder = |factor: f64| {
        let pulse = ForcePulse { force: factor * impact.pulse.force, ..impact.pulse };
        value(&sample, &Impact { pulse, ..impact.clone() })
    };
    let difference = (harder(1.0 + change) - harder(1.0 - change)) / (f64::ln_1p(change) - f64::ln_1p(-change));
    assert!((difference / gradient.load - 1.0).abs() < 1e-6, "{:e} and {difference:e}", gradient.load);
}

/// What is left of a change after its derivative is taken off falls as the square of the change, over a run of many blocks.
#[test]
fn the_remainder_is_of_second_order_through_the_checkpoints() {
    remainder_is_of_second_order(None, [1e-3, 5e-4, 2.5e-4]);
}

/// With friction too, over changes that step over few kinks.
#[test]
fn the_remainder_with_friction_is_of_second_order_through_the_checkpoints() {
    remainder_is_of_second_order(Some(0.2), [1e-4, 5e-5, 2.5e-5]);
}

fn remainder_is_of_second_order(friction: Option<f64>, changes: [f64; 3]) {
    let sample = sample();
    let impact = impact(LawKind::Hertz, Integrator::Verlet);
    assert!(super::blocks(steps_in(impact.window, impact.step)).len() > 10, "few blocks test little");
    let gradient = &run(&sample, &impact, friction).of[0];
    let mut rng = Rng::new(3);
    let direction: Vec<f64> = sample.spheres.iter().map(|_| rng.unit() - 0.5).collect();
    let slope: f64 = gradient.density.iter().zip(&direction).map(|(by, along)| by * along).sum();
    let remainder = |change: f64| {
        let mut changed = sample.clone();
        for (i, along) in direction.iter().enumerate() {
            let mut material = changed.materials[sample.spheres[i].material].clone();
            material.density *= (change * along).exp();
            changed.spheres[i].material = changed.materials.len();
            changed.materials.push(material);
        }
        (value(&changed, &impact, friction) - gradient.value - change * slope).abs()
    };
    let remainders = changes.map(remainder);
    for pair in remainders.windows(2) {
        let order = (pair[0] / pair[1]).log2();
        assert!((order - 2.0).abs() < 0.1, "order {order}, {remainders:?}");
    }
}

#[test]
fn the_fastest_moment_is_the_first_of_its_kind() {
    let mut fastest = Fastest::new(1);
    let frame_less = |speed: f64| State {
        displacement: vec![[0.0; 2]],
        velocity: vec![[0.0, speed]],
        acceleration: [vec![[0.0; 2]], vec![[0.0; 2]], vec![[0.0; 2]]],
        history: Vec::new(),
        turning: Turning::default(),
        reached: 1,
    };
    for (step, speed) in [0.0, 1.0, 2.0, -2.0, 1.0].into_iter().enumerate() {
        fastest.look(step as u64, &frame_less(speed));
    }
    assert_eq!((fastest.squared[0], fastest.when[0]), (4.0, 2));
}

/// Densities, moduli, yield stresses and the load by one factor: the same motion, energies by that factor. So all derivatives of the
/// logarithms add up to one, whatever the law. Its numbers' slopes are differences, good to 1e-9.
#[test]
fn energies_go_as_stresses_densities_and_load_together() {
    let sample = sample();
    for (&law, friction) in LawKind::ALL.iter().flat_map(|law| FRICTION.map(|friction| (law, friction))) {
        let gradient = &run(&sample, &impact(law, Integrator::Adams), friction).of[0];
        let each = [&gradient.density, &gradient.youngs_modulus, &gradient.yield_stress];
        let sum = gradient.load + each.iter().map(|by| by.iter().sum::<f64>()).sum::<f64>();
        let size: f64 = each.iter().flat_map(|by| by.iter()).map(|by| by.abs()).sum();
        assert!((sum - gradient.value).abs() < 1e-9 * size, "{law}, {friction:?}: {sum:e} of {:e}", gradient.value);
    }
}
