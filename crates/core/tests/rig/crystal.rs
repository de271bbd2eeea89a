//! Crystals as rigs: against the fixed-list simulator, the independent solutions, and symmetric and periodic equivalents.

use granulens_core::contact::LawKind;
use granulens_core::dem::rig::{
    Arrival, Body, Curve, Friction, Law, LawBook, Load, LoadKind, Rig, RigError, Simulation, simulate_as_rig,
};
use granulens_core::dem::{Face, ForcePulse, Impact, Integrator, Mirror, Period, simulate};

use crate::reference::{Table, difference};
use crate::rigs::{DIAMETER, GO, hexagonal, rig, run};

fn push<const D: usize>(rig: &mut Rig<D>, struck: Vec<usize>, force: f64, duration: f64) {
    let mut direction = [0.0; D];
    direction[D - 1] = 1.0;
    let curve = Curve::Square { peak: force, start: 0.0, duration };
    let bodies = struck.into_iter().map(Body::Sphere).collect();
    rig.loads.push(Load { bodies, direction, kind: LoadKind::Force, curve });
}

/// The same sheet between mirrors in both simulators, by either scheme: the same table of coefficients, other orders of sums, so rounding and its growth.
#[test]
fn a_crystal_moves_as_in_the_fixed_list_simulator() {
    let schemes = [Integrator::Verlet, Integrator::Adams];
    for (law, integrator) in [LawKind::Thesis, LawKind::Hertz].into_iter().flat_map(|law| schemes.map(|s| (law, s))) {
        let mut rig = rig(&hexagonal(12, 6), law);
        push(&mut rig, (0..6).collect(), 26e3, 20e-6);
        rig.mirrors = vec![
            Mirror { axis: 0, position: 0.0, inward: 1.0 },
            Mirror { axis: 0, position: 5.5 * DIAMETER, inward: -1.0 },
        ];
        let impact = Impact {
            mirrors: rig.mirrors.clone(),
            law,
            constants: Default::default(),
            pulse: ForcePulse { force: 26e3, duration: 20e-6 },
            periods: Vec::new(),
            slope: 0.0,
            struck: (0..6).collect(),
            faces: Vec::new(),
            moving: Vec::new(),
            projectile: None,
            exit: (66..72).collect(),
            integrator,
            step: 1e-7,
            window: 100e-6,
        };
        let record = simulate(&rig.sample, &impact, &GO).unwrap();
        let again = simulate_as_rig(&rig.sample, &impact, None, &GO).unwrap();
        assert!(difference(again.exit_momentum, record.exit_momentum, 0.0) < 1e-9);
        for i in 0..rig.mass.len() {
            for (a, b) in [
                (again.max_kinetic[i], record.max_kinetic[i]),
                (again.max_net_force[i], record.max_net_force[i]),
                (again.max_contact_force[i], record.max_contact_force[i]),
            ] {
                assert!(difference(a, b, 1e-6) < 1e-8, "{law} {integrator} sphere {i}: {a} {b}");
            }
        }
        assert!(difference(again.ledger.estimate, record.ledger.estimate, 0.0) < 1e-10);
        let mut simulation = Simulation::by(integrator, rig, 1e-7).unwrap().recording(vec![Arrival::OwnMaximum(0.01)]);
        simulation.advance(1000, &GO).unwrap();
        let arrivals = simulation.arrivals(0);
        for (i, speed) in simulation.greatest_speed().into_iter().enumerate() {
            let energy = 0.5 * simulation.rig().mass[i] * speed * speed;
            assert!(difference(energy, record.max_kinetic[i], 1e-6) < 1e-9, "{law} {integrator} sphere {i}");
            assert!(
                difference(arrivals[i].unwrap(), record.arrival[i].unwrap(), 0.0) < 1e-8,
                "{law} {integrator} sphere {i}"
            );
            assert!(
                difference(simulation.dissipated()[i], record.dissipated[i], 1e-6) < 1e-7,
                "{law} {integrator} sphere {i}"
            );
        }
        let (ours, theirs) = (simulation.ledger(), record.ledger);
        let lost: f64 = simulation.contacts_ever().iter().map(|c| c.weight * (c.work - c.stored)).sum();
        assert!(difference(lost, ours.dissipated, 0.0) < 1e-10, "{law} {integrator}: {lost}");
        for (a, b) in
            [(ours.work_in, theirs.work_in), (ours.dissipated, theirs.dissipated), (ours.kinetic, theirs.kinetic)]
        {
            assert!(difference(a, b, 0.0) < 1e-10, "{law} {integrator}: {a} {b}");
        }
    }
}

/// Periods of an impact are those of the rig; faces across no axis are refused.
#[test]
fn an_impact_on_what_repeats_itself_is_one_on_such_a_rig() {
    let sample = rig(&hexagonal(8, 6), LawKind::Thesis).sample;
    let impact = Impact {
        mirrors: Vec::new(),
        law: LawKind::Thesis,
        constants: Default::default(),
        pulse: ForcePulse { force: 26e3, duration: 20e-6 },
        periods: vec![Period { axis: 0, length: 6.0 * DIAMETER }],
        slope: 0.0,
        // One alone, so that what runs round the period counts.
        struck: vec![0],
        faces: Vec::new(),
        moving: Vec::new(),
        projectile: None,
        exit: Vec::new(),
        integrator: Integrator::Verlet,
        step: 1e-7,
        window: 60e-6,
    };
    let record = simulate(&sample, &impact, &GO).unwrap();
    let again = simulate_as_rig(&sample, &impact, None, &GO).unwrap();
    for (i, (a, b)) in again.max_kinetic.iter().zip(&record.max_kinetic).enumerate() {
        assert!(difference(*a, *b, 1e-6) < 1e-8, "sphere {i}: {a} {b}");
    }
    let open = simulate(&sample, &Impact { periods: Vec::new(), ..impact.clone() }, &GO).unwrap();
    assert!(difference(open.max_kinetic[5], record.max_kinetic[5], 1e-6) > 0.1);
    let walled = Impact { faces: vec![Face::Cylinder { radius: 1.0 }], ..impact };
    assert!(matches!(simulate_as_rig(&sample, &walled, None, &GO), Err(RigError::Faces)));
}

/// A crystal half as wide between mirrors is the crystal of twice the width that repeats itself.
#[test]
fn mirrors_and_a_period_are_the_same_crystal() {
    // Columns 0 to 4.5 between mirrors at 0 and 4.5; all around: 9 diameters. One sphere in the half is heavier.
    let half = hexagonal(8, 5);
    let whole = hexagonal(8, 9);
    let marked = |at: &[f64; 2], mirror: f64| {
        let mirrored = [mirror - at[0], at[1]];
        [at, &mirrored].iter().any(|p| (p[0] - 2.0).abs() < 1e-9 && (p[1] - 2.0 * 0.75_f64.sqrt()).abs() < 1e-9)
    };
    let build = |centres: &[[f64; 2]], columns: usize, friction: Option<Friction>| {
        let mut rig = rig(centres, LawKind::Thesis);
        rig.laws = LawBook::Materials {
            law: Law::Named(LawKind::Thesis),
            constants: Default::default(),
            pairs: Vec::new(),
            friction,
        };
        push(&mut rig, (0..columns).collect(), 20e3, 20e-6);
        for (i, at) in centres.iter().enumerate() {
            if marked(at, 9.0) {
                rig.mass[i] *= 3.0;
            }
        }
        rig
    };
    for friction in [None, Some(Friction::mindlin(0.3))] {
        let mut mirrored = build(&half, 5, friction);
        mirrored.mirrors = vec![
            Mirror { axis: 0, position: 0.0, inward: 1.0 },
            Mirror { axis: 0, position: 4.5 * DIAMETER, inward: -1.0 },
        ];
        let mut periodic = build(&whole, 9, friction);
        periodic.periods = [Some(9.0 * DIAMETER), None];
        let (mirrored, periodic) = (run(mirrored, 1e-7, 700), run(periodic, 1e-7, 700));
        let mut spins = 0.0_f64;
        for (i, at) in half.iter().enumerate() {
            let j = whole.iter().position(|p| (p[0] - at[0]).abs() + (p[1] - at[1]).abs() < 1e-9).unwrap();
            let (a, b) = (mirrored.view().velocity(i), periodic.view().velocity(j));
            assert!((0..2).all(|k| (a[k] - b[k]).abs() < 1e-9), "{friction:?}, {at:?}: {a:?} {b:?}");
            let (a, b) = (mirrored.view().spin(i)[2], periodic.view().spin(j)[2]);
            assert!((a - b).abs() < 1e-5, "{friction:?}, {at:?}: {a} {b}");
            spins = spins.max(a.abs());
        }
        assert_eq!(spins > 1.0, friction.is_some(), "{spins}");
        let (a, b) = (mirrored.ledger(), periodic.ledger());
        assert!(difference(2.0 * a.dissipated, b.dissipated, 0.0) < 1e-10);
        assert!(difference(2.0 * a.friction, b.friction, 1e-6) < 1e-9);
    }
}

/// A plane wave in 440c, 5 spheres a row and periodic, against the independent solution (Runge-Kutta at the same step). A
/// row's arrival and greatest speed agree to the error of the two schemes at this step: 1e-3 (physics: within 0.1 % at
/// 1e-7 s).
#[test]
fn a_plane_wave_between_periodic_sides_is_the_independent_one() {
    let mut rig = rig(&hexagonal(50, 5), LawKind::Thesis);
    rig.periods = [Some(5.0 * DIAMETER), None];
    push(&mut rig, (0..5).collect(), 10604.643257668553, 100e-6);
    let mut simulation = Simulation::new(rig, 5e-8).unwrap().recording(vec![Arrival::OwnMaximum(0.01)]);
    simulation.advance(9000, &GO).unwrap();
    let (arrivals, speeds) = (simulation.arrivals(0), simulation.greatest_speed());
    let table = Table::read("planar_2D_440c.csv");
    for row in 0..table.len() {
        let first = 5 * (table.number(row, "layer") as usize - 1);
        let (arrival, speed) = (table.number(row, "arrival"), table.number(row, "max_v"));
        assert!(difference(arrivals[first].unwrap(), arrival, 1e-6) < 1e-3, "row {row}");
        assert!(difference(speeds[first], speed, 0.0) < 1e-3, "row {row}: {} {speed}", speeds[first]);
    }
}

/// Small waves in a squeezed chain: ω = 2 √(K/m) |sin(q a/2)| with K = dF/dδ at the squeeze. A standing wave of 8 spheres
/// around a period comes back after its period; amplitude 1e-6 of the squeeze keeps it linear.
#[test]
fn a_squeezed_chain_has_its_dispersion() {
    let count = 40;
    let precompress = 1e-3;
    let centres: Vec<[f64; 1]> = (0..count).map(|k| [f64::from(k) * (1.0 - precompress)]).collect();
    for waves in [2.0, 5.0, 10.0, 20.0] {
        let mut rig = rig(&centres, LawKind::Hertz);
        let period = f64::from(count) * (1.0 - precompress) * DIAMETER;
        (rig.periods, rig.precompressed) = ([Some(period)], true);
        let q = 2.0 * std::f64::consts::PI * waves / f64::from(count);
        for (k, velocity) in rig.velocity.iter_mut().enumerate() {
            velocity[0] = 1e-5 * (q * k as f64).cos();
        }
        let m = &rig.sample.materials[0];
        let modulus = 0.5 * m.youngs_modulus / (1.0 - m.poisson_ratio * m.poisson_ratio);
        let stiffness = 2.0 * modulus * (0.25 * DIAMETER * precompress * DIAMETER).sqrt();
        let omega = 2.0 * (stiffness / rig.mass[0]).sqrt() * (0.5 * q).sin().abs();
        let step = 2.0 * std::f64::consts::PI / omega / 1000.0;
        let simulation = run(rig, step, 1000);
        // After one period the velocities are back; a phase error would show as its square, so look at a quarter's force
        // instead: displacements vanish to the phase error times their amplitude.
        let amplitude = 1e-5 / omega;
        let displaced = (0..count as usize).map(|i| simulation.view().displacement(i)[0].abs()).fold(0.0, f64::max);
        // Verlet's phase error is (ωh)²/24 · 2π = 1e-5; the anharmonic part is of the order of amplitude/squeeze.
        assert!(displaced / amplitude < 1e-4, "{waves}: {}", displaced / amplitude);
    }
}

/// Nesterenko's solitary wave: in an unsqueezed Hertz chain the crest's speed grows as the force to the power 1/6,
/// V = 0.6802 (2R) (E*... ) in closed form: V_s = (16/25)^{1/5} (2E/(a^{3/2} ρ (1−ν²)))^{2/5} a... checked through the
/// scaling alone: doubling the striker's speed multiplies the wave's by 2^{1/5}.
#[test]
fn a_solitary_wave_runs_faster_the_harder_the_blow() {
    let centres: Vec<[f64; 1]> = (0..80).map(|k| [f64::from(k)]).collect();
    let speed = |blow: f64| {
        let mut rig = rig(&centres, LawKind::Hertz);
        rig.velocity[0] = [blow];
        let mut simulation = Simulation::new(rig, 1e-7).unwrap().recording(vec![Arrival::OwnMaximum(0.5)]);
        simulation.advance(6000, &GO).unwrap();
        let arrivals = simulation.arrivals(0);
        let speed = 30.0 * DIAMETER / (arrivals[60].unwrap() - arrivals[30].unwrap());
        (speed, simulation.greatest_speed()[45])
    };
    let ((slow, particle), (fast, _)) = (speed(1.0), speed(2.0));
    // Time scales as v^{-1/5} exactly; arrivals are interpolated within a step of 1e-7 s over 40 µs: 1e-4.
    assert!((fast / slow / 2.0_f64.powf(0.2) - 1.0).abs() < 1e-4, "{slow} {fast}");
    // Nesterenko (2001), eq. 1.33: V = (16/25)^{1/5} (2E/(ρ... (1−ν²)))^{2/5} u^{1/5} for the long-wave limit, whose crest
    // the discrete chain follows within a few percent: wave speed against greatest particle speed u.
    let material = crate::reference::material("440c");
    let modulus = material.youngs_modulus / (1.0 - material.poisson_ratio.powi(2));
    let c = (2.0 * modulus / (std::f64::consts::PI * material.density)).sqrt();
    let long_wave = (16.0_f64 / 25.0).powf(0.2) * c.powf(0.8) * particle.powf(0.2);
    assert!((slow / long_wave - 1.0).abs() < 0.03, "{slow} {long_wave}");
}

/// Spheres that do not touch meet, and those that touched part: a blow through three spaced Hertz spheres in line hands the
/// velocity on to the last, and every meeting is found however far it lies. A contact of 20 µs has 400 steps: (ωh)²/24 = 3e-6.
#[test]
fn a_blow_is_handed_over_gaps() {
    let mut rig = rig(&[[0.0, 0.0], [3.0, 0.0], [9.0, 0.0]], LawKind::Hertz);
    rig.velocity[0] = [10.0, 0.0];
    let simulation = run(rig, 5e-8, 160_000);
    let view = simulation.view();
    let speeds = [0, 1, 2].map(|i| view.velocity(i)[0]);
    assert!(speeds[0].abs() < 3e-5 && speeds[1].abs() < 3e-5 && (speeds[2] / 10.0 - 1.0).abs() < 3e-6, "{speeds:?}");
    assert!(simulation.ledger().residual().unwrap().abs() < 1e-6);
}

/// Turning, mirroring or shifting a crystal turns, mirrors or shifts what it does; renumbering its spheres renumbers it. To
/// rounding and its growth.
#[test]
fn only_the_crystal_matters_not_how_it_is_written() {
    let centres = hexagonal(6, 5);
    let struck: Vec<usize> = vec![1, 2];
    let base = || {
        let mut rig = rig(&centres, LawKind::Thesis);
        rig.velocity[struck[0]] = [3.0, 20.0];
        rig.velocity[struck[1]] = [0.0, 15.0];
        rig.mass[7] *= 2.0;
        rig
    };
    let reference = run(base(), 1e-7, 800);
    let turn = |[x, z]: [f64; 2]| [0.6 * x - 0.8 * z + 3.0 * DIAMETER, 0.8 * x + 0.6 * z - DIAMETER];
    let turn_velocity = |[x, z]: [f64; 2]| [0.6 * x - 0.8 * z, 0.8 * x + 0.6 * z];
    let mut turned = base();
    for i in 0..centres.len() {
        turned.sample.spheres[i].centre = turn(turned.sample.spheres[i].centre);
        turned.velocity[i] = turn_velocity(turned.velocity[i]);
    }
    let turned = run(turned, 1e-7, 800);
    let mut mirrored = base();
    for i in 0..centres.len() {
        mirrored.sample.spheres[i].centre[0] *= -1.0;
        mirrored.velocity[i][0] *= -1.0;
    }
    let mirrored = run(mirrored, 1e-7, 800);
    let count = centres.len();
    let place = |i: usize| (7 * i + 3) % count;
    let mut renumbered = base();
    for i in 0..count {
        renumbered.sample.spheres[place(i)] = base().sample.spheres[i];
        renumbered.velocity[place(i)] = base().velocity[i];
        renumbered.mass[place(i)] = base().mass[i];
    }
    let renumbered = run(renumbered, 1e-7, 800);
    for i in 0..count {
        let [x, z] = reference.view().velocity(i);
        let near = |a: [f64; 2], b: [f64; 2]| (a[0] - b[0]).abs() + (a[1] - b[1]).abs() < 1e-8;
        assert!(near(turned.view().velocity(i), turn_velocity([x, z])), "turned, sphere {i}");
        assert!(near(mirrored.view().velocity(i), [-x, z]), "mirrored, sphere {i}");
        assert!(near(renumbered.view().velocity(place(i)), [x, z]), "renumbered, sphere {i}");
    }
}

/// The same bits for any number of threads, with drag and without, and after being taken up: loops over spheres are shared out from
/// 20 000 on (so many are here), sums over contacts from 50 000 on (here 59 401 touch). All fly so fast that near pairs are looked
/// for anew.
#[test]
fn threads_change_no_bit() {
    let built = |drag: f64| {
        let mut rig = rig(&hexagonal(100, 200), LawKind::Hertz);
        rig.laws = LawBook::Materials {
            law: Law::Named(LawKind::Hertz),
            constants: Default::default(),
            pairs: Vec::new(),
            friction: Some(Friction::mindlin(0.3)),
        };
        rig.drag = drag;
        for (i, velocity) in rig.velocity.iter_mut().enumerate() {
            *velocity = [200.0 + (i as f64 * 0.7).sin(), (i as f64 * 1.3).cos()];
        }
        rig
    };
    let with = |threads: usize, drag: f64| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| run(built(drag), 2e-7, 100).checkpoint())
    };
    for drag in [0.0, 1.0] {
        let one = with(1, drag);
        assert!(one == with(2, drag) && one == with(3, drag));
        let mut taken_up = Simulation::new(built(drag), 2e-7).unwrap();
        taken_up.restore(&run(built(drag), 2e-7, 30).checkpoint()).unwrap();
        taken_up.advance(70, &GO).unwrap();
        assert!(one == taken_up.checkpoint());
    }
}

/// From whatever gap two spheres, or a sphere and a plate, come together, they meet as they would from any other: their contact is looked for in time. Under
/// Hertz's law F = k δ^{3/2} with δ = (5 m v²/4k)^{2/5} for the reduced mass m and the closing speed v (Johnson 1985, section 11.4), and the spheres
/// exchange their velocities; 1000 steps a contact leave 10⁻⁵.
#[test]
fn no_gap_hides_a_contact() {
    let steel = crate::reference::material("440c");
    let pair = granulens_core::contact::Pair::new([&steel, &steel], [0.5 * DIAMETER; 2], Default::default());
    let (k, speed, step) = (pair.hertz_coefficient(), 20.0, 5e-8);
    for n in 1..60 {
        let gap = 0.053 * f64::from(n) * DIAMETER;
        let mut two = rig(&[[0.0, 0.0], [0.0, 1.0 + gap / DIAMETER]], LawKind::Hertz);
        two.velocity = vec![[0.0, speed], [0.0, -speed]];
        let mass = two.mass[0];
        let steps = ((gap / (2.0 * speed) + 40e-6) / step) as u64;
        let mut simulation = Simulation::new(two, step).unwrap().recording(Vec::new());
        simulation.advance(steps, &GO).unwrap();
        let strongest = k * (5.0 * 0.5 * mass * (2.0 * speed).powi(2) / (4.0 * k)).powf(0.6);
        let force = simulation.greatest_force()[0];
        assert!(difference(force, strongest, 0.0) < 1e-4, "two spheres from {n}: {force} {strongest}");
        let view = simulation.view();
        assert!(difference(view.velocity(1)[1], speed, 0.0) < 1e-4, "{n}: {:?}", view.velocity(1));
        // A plate that comes as fast is as an equal sphere that does.
        let mut one = rig(&[[0.0, 0.0]], LawKind::Hertz);
        one.velocity = vec![[0.0, speed]];
        // The plate's hand does work that no balance knows.
        one.residual_limit = f64::INFINITY;
        one.flats = vec![granulens_core::dem::rig::Flat {
            velocity: [0.0, -speed],
            ..granulens_core::dem::rig::Flat::wall("plate", [0.0, 0.5 * DIAMETER + gap], [0.0, -1.0])
        }];
        let mut simulation = Simulation::new(one, step).unwrap().recording(Vec::new());
        simulation.advance(steps, &GO).unwrap();
        // In the frame of the plate the sphere comes at 2 v and meets its image at 4 v.
        let strongest = k * (5.0 * 0.5 * mass * (4.0 * speed).powi(2) / (4.0 * k)).powf(0.6);
        let force = simulation.greatest_force()[0];
        assert!(difference(force, strongest, 0.0) < 1e-4, "a plate from {n}: {force} {strongest}");
    }
}
