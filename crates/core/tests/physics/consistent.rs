//! The energy-consistent law against the published one: collisions, chains and the lens. The figures are those of
//! `docs/consistent-law.md`; run with `--nocapture` to see them all.

use granulens_core::contact::{Constants, Hertz, LawKind, Pair};
use granulens_core::dem::{ForcePulse, Impact, Integrator, Record};
use granulens_core::layout::Layout;
use granulens_core::sample::{Sample, Sphere};
use rayon::prelude::*;

use crate::collision::collide;
use crate::lens::{scores, solve};
use crate::problem::{DIAMETER, is_lens, layout, run, sheet};
use crate::reference::{difference, material};

const NAMES: [&str; 4] = ["440c", "brass", "302", "al"];

fn pairs() -> impl Iterator<Item = [&'static str; 2]> {
    (0..4).flat_map(|a| (a..4).map(move |b| [NAMES[a], NAMES[b]]))
}

/// Pair constants, and the reduced mass [kg].
fn pair(names: [&str; 2]) -> (Pair, f64) {
    let [a, b] = names.map(material);
    let mass = 1.0 / (1.0 / a.sphere_mass(DIAMETER) + 1.0 / b.sphere_mass(DIAMETER));
    (Pair::new([&a, &b], [0.5 * DIAMETER; 2], Constants::Code), mass)
}

/// Followed in some 8000 steps, which leaves 10⁻⁷ in the restitution.
fn restitution(law: LawKind, names: [&str; 2], speed: f64) -> f64 {
    let (pair, mass) = pair(names);
    let elastic = 2.943_275 * (1.25 * mass * speed * speed / Hertz::new(&pair).coefficient).powf(0.4) / speed;
    let plastic = std::f64::consts::PI * (mass / pair.plastic_stiffness()).sqrt();
    let duration = elastic.max(plastic);
    let (_, record) = collide(names, speed, |i| {
        (i.law, i.integrator) = (law, Integrator::Verlet);
        (i.step, i.window) = (duration / 8000.0, 1.5 * duration);
    });
    (record.velocity[1][0] - record.velocity[0][0]) / speed
}

/// Speed at which two spheres just reach F_y: ½ m* v² = (2/5) F_y δ_y.
fn yield_speed(names: [&str; 2]) -> f64 {
    let (pair, mass) = pair(names);
    let regions = pair.regions(1.0);
    (0.8 * regions.yield_force * regions.yield_overlap / mass).sqrt()
}

/// From 0.01 to 50 m/s, all pairs of four metals: elastic below yield, then falling with speed and never above one. The
/// published law returns up to 4 % more speed than came just above yield, and loses up to 37 % of it below.
#[test]
fn restitution_is_one_below_yield_and_falls_above() {
    for names in pairs() {
        let limit = yield_speed(names);
        println!("{names:?}: yields from {limit:.4} m/s");
        let mut before = f64::INFINITY;
        let mut published_above_one = false;
        for speed in [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0] {
            let ours = restitution(LawKind::Consistent, names, speed);
            let published = restitution(LawKind::Thesis, names, speed);
            println!("{speed} m/s: thesis {published:.4} consistent {ours:.4}");
            assert!(ours <= 1.0 + 1e-6);
            if speed < limit {
                assert!((ours - 1.0).abs() < 1e-6, "{ours}");
            } else {
                assert!(ours < before, "{ours} after {before}");
            }
            before = ours;
            published_above_one |= published > 1.001;
        }
        assert!(published_above_one);
    }
}

/// The laws approach each other as region III takes over: (consistent − thesis) in restitution at 5 and 20 m/s. 440c needs
/// more speed: at 5 m/s its greatest force is a fifth of F_p, in the middle of region II.
#[test]
fn restitution_approaches_that_of_the_published_law() {
    for names in pairs() {
        let away = |speed| restitution(LawKind::Consistent, names, speed) - restitution(LawKind::Thesis, names, speed);
        let (five, twenty) = (away(5.0), away(20.0));
        println!("{names:?}: {five:+.4} at 5 m/s, {twenty:+.4} at 20 m/s");
        assert!(five.abs() < if names == ["440c"; 2] { 0.036 } else { 0.012 });
        assert!(twenty.abs() < 0.005);
    }
}

/// While a contact is being loaded Verlet is of second order with this law too: errors fall by 4 a halving (6 µs after 440c met
/// 440c at 5 m/s). Two µs later it keeps its force as the spheres slow down; from then on errors depend on where
/// in a step that began, and fall by 4 only on the average.
#[test]
fn halving_the_step_quarters_the_error() {
    let velocity = |integrator: Integrator, step: f64, window: f64| {
        let (_, record) = collide(["440c", "440c"], 5.0, |i| {
            (i.law, i.integrator, i.step, i.window) = (LawKind::Consistent, integrator, step, window);
        });
        record.velocity[1][0]
    };
    let fall = |window: f64, steps: [f64; 2]| {
        let exact = velocity(Integrator::Rk4, 1e-9, window);
        let [coarse, fine] = steps.map(|step| (velocity(Integrator::Verlet, step, window) - exact).abs());
        coarse / fine
    };
    let smooth = fall(6e-6, [4e-8, 2e-8]);
    assert!((3.9..4.1).contains(&smooth), "{smooth}");
    let whole = fall(40e-6, [8e-8, 1e-8]);
    assert!(whole > 30.0, "{whole}");
}

/// Fifty spheres pushed with 2 F_p for 100 µs.
fn chain(names: [&str; 2], law: LawKind, step: f64) -> Record<1> {
    let radius = 0.5 * DIAMETER;
    let sphere = |i: usize| Sphere { centre: [i as f64 * DIAMETER], radius, material: i % 2 };
    let sample = Sample { materials: names.map(material).to_vec(), spheres: (0..50).map(sphere).collect() };
    let impact = Impact {
        mirrors: Vec::new(),
        law,
        constants: Constants::Code,
        pulse: ForcePulse { force: 2.0 * pair(names).0.plastic_force(), duration: 100e-6 },
        periods: Vec::new(),
        slope: 0.0,
        struck: vec![0],
        faces: Vec::new(),
        moving: Vec::new(),
        projectile: None,
        exit: vec![49],
        integrator: Integrator::Verlet,
        step,
        window: 700e-6,
    };
    let record = run(&sample, &impact);
    assert_eq!(record.stop, None);
    record
}

/// Mean speed of the front over spheres 10 to 40.
fn front(record: &Record<1>) -> f64 {
    30.0 * DIAMETER / (record.arrival[39].unwrap() - record.arrival[9].unwrap())
}

/// The front runs through regions I and II first, where the consistent law is softer, and so is slower by a percent.
#[test]
fn a_chains_front_is_slightly_slower_and_loses_as_much() {
    for (names, slower) in [(["440c", "440c"], 0.0084), (["brass", "440c"], 0.0097), (["brass", "brass"], 0.0109)] {
        let (published, ours) = (chain(names, LawKind::Thesis, 5e-8), chain(names, LawKind::Consistent, 5e-8));
        let change = front(&ours) / front(&published) - 1.0;
        let lost = ours.ledger.dissipated / published.ledger.dissipated - 1.0;
        println!("{names:?}: {:.1} to {:.1} m/s, {change:+.4}; lost {lost:+.4}", front(&published), front(&ours));
        assert!((change + slower).abs() < 5e-4, "{change}");
        assert!(lost.abs() < 0.013, "{lost}");
        let fine = front(&chain(names, LawKind::Consistent, 1e-8));
        assert!(difference(front(&ours), fine, 0.0) < 1e-4);
    }
}

/// F and P against those of the finest step, and the root mean square of all spheres' changes, over 0..250 µs at 26 kN and 0..350 µs at
/// 10.5 kN.
#[test]
fn the_lens_converges_with_the_step() {
    let layout = layout(is_lens);
    let classes = [(26e3, 250e-6), (10.5e3, 350e-6)];
    let steps = [4e-7, 2e-7, 1e-7, 2e-8];
    let runs: Vec<_> = classes.into_iter().flat_map(|class| steps.map(|step| (class, step))).collect();
    let records: Vec<_> = runs
        .into_par_iter()
        .map(|((force, window), step)| {
            let record = solve(&layout, |i| {
                (i.law, i.step, i.window, i.pulse.force) = (LawKind::Consistent, step, window, force);
            });
            assert_eq!(record.stop, None);
            record
        })
        .collect();
    for of_class in records.chunks(steps.len()) {
        let fine = &of_class[steps.len() - 1];
        let exact = scores(fine, &layout);
        let mut spread = Vec::new();
        for (record, step) in of_class.iter().zip(steps) {
            let away: [f64; 2] = std::array::from_fn(|k| scores(record, &layout)[k] / exact[k] - 1.0);
            let spheres = record.max_kinetic.iter().zip(&fine.max_kinetic);
            spread.push(
                (spheres.map(|(a, b)| (a / b - 1.0).powi(2)).sum::<f64>() / fine.max_kinetic.len() as f64).sqrt(),
            );
            let [f, p] = scores(record, &layout);
            println!(
                "{step:.0e} s: F {f:.6} P {p:.6} F/P {:.4}, away {away:.5?}, spheres {:.1e}",
                f / p,
                spread.last().unwrap()
            );
            let class = if step > 1e-7 { 1e-2 } else { 1e-3 };
            assert!(away.iter().all(|away| away.abs() < class), "step {step}: {away:?}");
        }
        // Second order: a sixteenth from 4e-7 to 1e-7 s, give or take where in a step contacts yield and part.
        assert!((10.0..25.0).contains(&(spread[0] / spread[2])), "{spread:?}");
    }
}

/// The classes of Runge-Kutta, against the finest step of Verlet.
#[test]
fn runge_kutta_reaches_its_classes_too() {
    let layout = layout(is_lens);
    for (step, class) in [(5e-7, 1e-2), (1e-7, 1e-3)] {
        let record = solve(&layout, |i| (i.law, i.integrator, i.step) = (LawKind::Consistent, Integrator::Rk4, step));
        for (ours, exact) in scores(&record, &layout).into_iter().zip([0.342_515, 0.145_587]) {
            println!("{step}: {ours:.6} for {exact}");
            assert!(difference(ours, exact, 0.0) < class, "{step}: {ours} and {exact}");
        }
    }
}

/// Greatest contact force over what a struck sphere hands to each of its two contacts: the plan takes 1.2.
#[test]
fn contact_forces_overshoot_like_those_of_the_published_law() {
    let sheets: [(&str, Layout); 3] =
        [("lens", layout(is_lens)), ("440c", layout(|_| false)), ("brass", layout(|_| true))];
    for (name, layout) in &sheets {
        for force in [26e3, 10.5e3] {
            let record = solve(layout, |i| (i.law, i.pulse.force, i.step) = (LawKind::Consistent, force, 2e-7));
            let greatest = record.max_contact_force.iter().copied().fold(0.0, f64::max);
            let over = greatest * 3_f64.sqrt() / force;
            println!("{name} {force} N: {over:.3}");
            assert!((1.0..1.3).contains(&over), "{over}");
        }
    }
}

/// A case of the uncertainty table.
struct Case {
    name: String,
    law: LawKind,
    constants: Constants,
    poisson_ratio: f64,
    rate: f64,
}

impl Case {
    fn scores(&self) -> [f64; 3] {
        let materials = ["440c", "brass"].map(|name| {
            let mut made = material(name);
            made.poisson_ratio = self.poisson_ratio;
            made.rate_constant *= self.rate;
            made
        });
        let layout = Layout::new(sheet(50, 16.5), materials.to_vec(), |site| u8::from(is_lens(site)));
        let record = solve(&layout, |i| (i.law, i.constants) = (self.law, self.constants));
        let [f, p] = scores(&record, &layout);
        [f, p, f / p]
    }
}

/// How far F, P and F/P of the lens (26 kN, 0..250 µs, Verlet at 1e-7 s) move with what is not known. The figures are this
/// crate's own, recorded for the docs; 0.2 % allows for the step class twice. `thesis-static` is `thesis` with C = 0.
#[test]
fn how_far_the_lens_moves_with_what_is_not_known() {
    // Name, constants, nu, factor of C, and F and P under either law.
    let table = [
        ("base", Constants::Code, 0.3, 1.0, [[0.3312, 0.1358], [0.3425, 0.1456]]),
        ("nu 0.25", Constants::Code, 0.25, 1.0, [[0.3322, 0.1406], [0.3500, 0.1467]]),
        ("nu 0.35", Constants::Code, 0.35, 1.0, [[0.3155, 0.1357], [0.3233, 0.1439]]),
        ("C - 20 %", Constants::Code, 0.3, 0.8, [[0.3045, 0.1341], [0.3134, 0.1441]]),
        ("C + 20 %", Constants::Code, 0.3, 1.2, [[0.3349, 0.1360], [0.3419, 0.1435]]),
        ("C = 0", Constants::Code, 0.3, 0.0, [[0.2349, 0.1440], [0.2391, 0.1540]]),
        ("text", Constants::Text, 0.3, 1.0, [[0.3293, 0.1361], [0.3416, 0.1458]]),
        ("sixteenth-inch", Constants::SixteenthInch, 0.3, 1.0, [[0.3291, 0.1360], [0.3415, 0.1459]]),
    ];
    let mut cases = Vec::new();
    for (which, law) in [LawKind::Thesis, LawKind::Consistent].into_iter().enumerate() {
        for (name, constants, poisson_ratio, rate, recorded) in table {
            let name = format!("{law}, {name}");
            cases.push((Case { name, law, constants, poisson_ratio, rate }, recorded[which]));
        }
    }
    let found: Vec<[f64; 3]> = cases.par_iter().map(|(case, _)| case.scores()).collect();
    for ((case, recorded), [f, p, contrast]) in cases.iter().zip(found) {
        println!("{}: F {f:.4} P {p:.4} F/P {contrast:.3}", case.name);
        assert!(
            difference(f, recorded[0], 0.0) < 2e-3 && difference(p, recorded[1], 0.0) < 2e-3,
            "{}: {f} {p}",
            case.name
        );
    }
}

/// Either law puts the arrangements in the same order: plain 440c, lens, strips of the same count and of the same height,
/// brass. Per cent by which the focal energy is higher with the consistent law: 7.0, 3.4, 4.9, 2.1, 1.5.
#[test]
fn the_order_of_arrangements_does_not_depend_on_the_law() {
    use granulens_core::layout::Baseline;
    let lens = layout(is_lens);
    let others = [Baseline::AllHost, Baseline::FlatSameCount, Baseline::FlatSameHeight, Baseline::AllLens];
    let mut arrangements: Vec<Layout> = others.into_iter().map(|baseline| baseline.layout(&lens, [5, 16], 1)).collect();
    arrangements.insert(1, lens);
    let focal = |law| -> Vec<f64> {
        arrangements.par_iter().map(|layout| scores(&solve(layout, |i| i.law = law), layout)[0]).collect()
    };
    let (published, ours) = (focal(LawKind::Thesis), focal(LawKind::Consistent));
    assert!(published.is_sorted_by(|a, b| a > b) && ours.is_sorted_by(|a, b| a > b), "{published:?} {ours:?}");
    for ((ours, published), percent) in ours.iter().zip(&published).zip([7.0, 3.4, 4.9, 2.1, 1.5]) {
        let change = 100.0 * (ours / published - 1.0);
        println!("{published:.4} {ours:.4} {change:+.2} %");
        assert!((change - percent).abs() < 0.3, "{change}");
    }
}
