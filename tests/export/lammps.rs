//! The same crystal in LAMMPS.

use std::fs;
use std::path::PathBuf;
use std::process::Command;

use granulens::contact::LawKind;
use granulens::dem::Mirror;
use granulens::dem::rig::{Cluster, Rig, Simulation};
use granulens::export::{DeckError, deck, dump_frame};
use granulens::setup::dividing_step;
use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::{Rng, SeedableRng};

use crate::{GO, rig, run};

/// LAMMPS with the package GRANULAR: the program named by the variable LAMMPS, or `lmp`.
fn program() -> Option<PathBuf> {
    let name = std::env::var_os("LAMMPS").map_or_else(|| PathBuf::from("lmp"), PathBuf::from);
    let help = Command::new(&name).arg("-h").output().ok()?;
    String::from_utf8_lossy(&help.stdout).contains("GRANULAR").then_some(name)
}

/// Frames of a dump: step, and for each sphere in order of number its type, place and velocity.
fn frames(text: &str) -> Vec<(u64, Vec<Vec<f64>>)> {
    let mut found = Vec::new();
    for frame in text.split("ITEM: TIMESTEP\n").skip(1) {
        let (step, rest) = frame.split_once('\n').unwrap();
        let (_, rows) = rest.split_once("ITEM: ATOMS id type xu yu zu vx vy vz").unwrap();
        let numbers = |line: &str| line.split_whitespace().map(|word| word.parse().unwrap()).collect::<Vec<f64>>();
        let mut rows: Vec<Vec<f64>> = rows.lines().map(numbers).filter(|row| !row.is_empty()).collect();
        rows.sort_by(|a, b| a[0].total_cmp(&b[0]));
        found.push((step.trim().parse().unwrap(), rows));
    }
    found
}

/// Greatest differences of place (m) and velocity (m/s).
fn apart(a: &[Vec<f64>], b: &[Vec<f64>]) -> [f64; 2] {
    assert_eq!(a.len(), b.len());
    let mut greatest = [0.0; 2];
    for (a, b) in a.iter().zip(b) {
        assert_eq!(a[..2], b[..2], "number and type");
        for k in 2..8 {
            let kind = usize::from(k >= 5);
            greatest[kind] = f64::max(greatest[kind], (a[k] - b[k]).abs());
        }
    }
    greatest
}

/// Runs a rig and gives its frames.
fn followed(rig: Rig<2>, step: f64, steps: u64, every: u64) -> Vec<(u64, Vec<Vec<f64>>)> {
    let mut simulation = Simulation::new(rig, step).unwrap();
    let mut text = dump_frame(&simulation);
    for _ in 0..steps / every {
        simulation.advance(every, &GO).unwrap();
        text += &dump_frame(&simulation);
    }
    frames(&text)
}

/// LAMMPS holds places, each rounded at every step to half of 2⁻⁵² of the crystal's size; we hold displacements, which are
/// rounded far less. Roundings that all had the same sign would act as a drift of one such rounding a step. A drift of
/// that size and of random direction is given to every sphere, and how far the run then goes astray is what rounding can
/// do at the most; ten such runs' worth is allowed, since the directions are one draw.
#[test]
fn lammps_follows_the_same_trajectories() {
    let Some(program) = program() else {
        println!("skipped: no LAMMPS with the package GRANULAR; put lmp into the path, or its name into LAMMPS");
        return;
    };
    let (step, steps, every) = (1e-7, 1000, 100);
    let exact = rig(LawKind::Hertz);
    let folder = tempfile::tempdir().unwrap();
    let deck = deck(&exact, step, steps, every).unwrap();
    fs::write(folder.path().join("crystal.data"), deck.data).unwrap();
    fs::write(folder.path().join("in.crystal"), deck.input).unwrap();
    let output = Command::new(program).args(["-in", "in.crystal"]).current_dir(folder.path()).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stdout));
    let theirs = frames(&fs::read_to_string(folder.path().join("lammps.dump")).unwrap());

    let size = exact.sample.spheres.iter().flat_map(|s| s.centre).fold(0.0, f64::max);
    let drift = 0.5 * f64::EPSILON * size / step;
    let mut disturbed = exact.clone();
    let mut chance = Xoshiro256PlusPlus::seed_from_u64(1);
    for velocity in &mut disturbed.velocity {
        *velocity = [0; 2].map(|_: i32| if chance.next_u64() >> 63 == 0 { drift } else { -drift });
    }
    let ours = followed(exact, step, steps, every);
    let astray = followed(disturbed, step, steps, every);
    assert_eq!(theirs.len(), ours.len());
    let fastest = ours.iter().flat_map(|(_, rows)| rows).map(|row| row[6].abs()).fold(0.0, f64::max);
    assert!(fastest > 1.0, "nothing moves: {fastest} m/s");
    for ((ours, theirs), astray) in ours.iter().zip(&theirs).zip(&astray) {
        assert_eq!(ours.0, theirs.0);
        let (found, allowed) = (apart(&ours.1, &theirs.1), apart(&ours.1, &astray.1));
        println!(
            "step {}: places {:.1e} m of {:.1e}, velocities {:.1e} m/s of {:.1e}",
            ours.0,
            found[0],
            10.0 * allowed[0],
            found[1],
            10.0 * allowed[1]
        );
        // At the start both hold the same decimal numbers.
        assert!(found[0] <= 10.0 * allowed[0] + f64::EPSILON * size, "step {}: {found:?}, {allowed:?}", ours.0);
        assert!(found[1] <= 10.0 * allowed[1], "step {}: {found:?}, {allowed:?}", ours.0);
    }
}

#[test]
fn what_lammps_cannot_have_is_refused() {
    let good = rig(LawKind::Hertz);
    assert!(deck(&good, 1e-7, 100, 10).is_ok());
    assert_eq!(deck(&rig(LawKind::Thesis), 1e-7, 100, 10), Err(DeckError::Law("thesis".to_owned())));
    assert!(matches!(deck(&good, 3e-7, 100, 10), Err(DeckError::Pulse { .. })));
    assert!(matches!(deck(&good, 1e-7, 0, 10), Err(DeckError::Steps { .. })));
    let part = |change: fn(&mut Rig<2>)| {
        let mut rig = rig(LawKind::Hertz);
        change(&mut rig);
        match deck(&rig, 1e-7, 100, 10) {
            Err(DeckError::Part(what)) => what,
            other => panic!("{other:?}"),
        }
    };
    assert_eq!(part(|rig| rig.mirrors.push(Mirror { axis: 0, position: 0.0, inward: 1.0 })), "mirrors");
    let bound = |rig: &mut Rig<2>| {
        let members = vec![0, 1];
        let (centre, velocity) = (rig.sample.spheres[0].centre, [0.0; 2]);
        rig.clusters.push(Cluster { members, centre, mass: 1.0, inertia: 1.0, turns: false, velocity, spin: 0.0 });
    };
    assert_eq!(part(bound), "rigid bodies of several spheres");
    assert_eq!(part(|rig| rig.held[3][1] = true), "spheres that are held");
    assert_eq!(part(|rig| rig.gravity[1] = 9.81), "gravity");
    assert_eq!(part(|rig| rig.drag = 1.0), "drag");
}

/// What the deck says of masses, and of contacts between unlike spheres.
#[test]
fn the_deck_holds_the_rigs_masses_and_stiffnesses() {
    let rig = rig(LawKind::Hertz);
    let deck = deck(&rig, 1e-7, 1000, 100).unwrap();
    let atoms = deck.data.split("Atoms # sphere").nth(1).unwrap();
    for (line, mass) in atoms.lines().filter(|line| !line.is_empty()).zip(&rig.mass) {
        let words: Vec<f64> = line.split(' ').map(|word| word.parse().unwrap()).collect();
        let theirs = 4.0 / 3.0 * std::f64::consts::PI * (0.5 * words[2]).powi(3) * words[3];
        assert!((theirs / mass - 1.0).abs() < 1e-14);
    }
    // 1/E* = (1 − 0.3²)(1/200 + 1/110) /GPa
    let modulus = 1e9 / (0.91 * (1.0 / 200.0 + 1.0 / 110.0));
    let line = deck.input.lines().find(|line| line.starts_with("pair_coeff 1 2 hertz")).unwrap();
    let theirs: f64 = line.split(' ').nth(4).unwrap().parse().unwrap();
    assert!((theirs / (4.0 / 3.0 * modulus) - 1.0).abs() < 1e-12);
    // 20 µs are 200 steps with the push, 800 without.
    assert!(deck.input.contains("run 200\nunfix push1\nrun 800\n"), "{}", deck.input);
}

/// The whole crystal moves as the half between its mirrors.
#[test]
fn the_whole_crystal_is_the_half_between_mirrors() {
    let layout = crate::layout();
    let whole = run(rig(LawKind::Thesis), 1e-7, 600);
    let mut half = Rig::new(layout.sample(), whole.rig().laws.clone());
    half.mirrors = vec![
        Mirror { axis: 0, position: 0.0, inward: 1.0 },
        Mirror { axis: 0, position: layout.lattice.half_width(), inward: -1.0 },
    ];
    half.loads = whole.rig().loads.clone();
    let first_row = layout.lattice.columns(1) as usize;
    half.loads[0].bodies = (0..first_row).map(granulens::dem::rig::Body::Sphere).collect();
    let half = run(half, 1e-7, 600);
    let spheres = &whole.rig().sample.spheres;
    let (mut images, mut fastest) = (0, 0.0_f64);
    for (k, site) in layout.lattice.sites().iter().enumerate() {
        let ours = half.view().velocity(k);
        fastest = fastest.max(ours[1].abs());
        for (j, sphere) in spheres.iter().enumerate() {
            if sphere.centre[1] == site.z && sphere.centre[0].abs() == site.x {
                let image = whole.view().velocity(j);
                let sign = if sphere.centre[0] < 0.0 { -1.0 } else { 1.0 };
                // Other orders of sums: rounding and its growth.
                assert!((image[0] - sign * ours[0]).abs() < 1e-9 && (image[1] - ours[1]).abs() < 1e-9);
                images += 1;
            }
        }
    }
    assert_eq!(images, spheres.len());
    assert!(fastest > 1.0);
}

/// Without a step of the user's the deck has one of which the pulse is a whole number, no longer than the run would have; several pulses are
/// divided by one step, and where none does, the deck says so.
#[test]
fn the_step_of_a_deck_divides_its_pulses() {
    let folder = tempfile::tempdir().unwrap();
    let pulse = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/cases/16-mixed-sizes/pulse.toml");
    let mut command = assert_cmd::Command::cargo_bin("granulens").unwrap();
    let output = command.current_dir(folder.path()).args(["export", pulse, "--lammps", "deck"]).output().unwrap();
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let text = fs::read_to_string(folder.path().join("deck/in.crystal")).unwrap();
    let step: f64 = text.lines().find_map(|line| line.strip_prefix("timestep ")).unwrap().parse().unwrap();
    let steps = 20e-6 / step;
    assert!((steps - steps.round()).abs() < 1e-9 && steps > 20.0, "{steps}");

    let mut rig = rig(LawKind::Hertz);
    let mut second = rig.loads[0].clone();
    let pulse = |duration| granulens::dem::rig::Curve::Square { peak: 1.0, start: 0.0, duration };
    (rig.loads[0].curve, second.curve) = (pulse(20e-6), pulse(30e-6));
    rig.loads.push(second.clone());
    // The greatest part of 20 and 30 us below 3 us is 2.5.
    assert!((dividing_step(&rig, 3e-6).unwrap() - 2.5e-6).abs() < 1e-15);
    second.curve = pulse(20e-6 * std::f64::consts::SQRT_2);
    rig.loads[1] = second;
    assert_eq!(dividing_step(&rig, 3e-6), None);
}
