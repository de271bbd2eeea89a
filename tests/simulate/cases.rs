//! Small rigs that other programs' users have tripped over, run as the files say, with the values that are right.

use super::*;

/// A case's file, in the plane.
fn case(path: &str) -> PreparedRig<2> {
    match Setup::read(shipped("tests/data/cases").join(path)) {
        Ok(Setup::Two(prepared)) => prepared,
        other => panic!("{path}: {other:?}"),
    }
}

fn last(series: &Series, column: &str) -> f64 {
    *series.column(column).last().unwrap()
}

/// An oxide sphere strikes a wall obliquely (Chung and Ooi 2011, test 4). Tangential restitution and spin are those of an integration
/// of the same equations (`tests/rig/contacts.rs` of the physics); of two spheres, whose normal turns by 2 u_t t/D meanwhile, to that.
/// In a sheet a sphere that strikes the floor while it moves along +x comes to turn about −y, as in space.
#[test]
fn an_oblique_blow_on_a_wall_is_that_on_an_equal_sphere() {
    let expected = [
        (5, 0.339_907_397, 0.863_849, 46.126),
        (10, 0.677_227_893, 0.709_725, 195.989),
        (20, 1.333_878_559, 0.618_049, 508.066),
    ];
    for (angle, speed, restitution, spin) in expected {
        let of = |kind: &str| {
            let ran = Ran::of(&case(&format!("01-wall-friction/{kind}-{angle}.toml")));
            let series = ran.series("spheres.csv");
            let (sphere, velocity) = (series.column("sphere").to_vec(), series.column("vx_m_s").to_vec());
            let at = sphere.iter().rposition(|&sphere| sphere == 1.0).unwrap();
            assert_eq!(series.column("wx_rad_s")[at], 0.0);
            assert_eq!(series.column("wxz_rad_s")[at], -series.column("wy_rad_s")[at]);
            [velocity[at] / speed, series.column("wy_rad_s")[at]]
        };
        let ([wall, turning], [pair, also]) = (of("wall"), of("pair"));
        assert!((wall - restitution).abs() < 5e-5, "{angle}: {wall}");
        assert!((turning + spin).abs() < 0.05, "{angle}: {turning}");
        // The turned normal gives a part 2 v_n t/D, 0.03 at most, of its impulse to the tangential speed.
        assert!((pair - wall).abs() < 0.03 && (also / turning - 1.0).abs() < 0.25, "{angle}: {pair} {also}");
    }
}

/// Squeeze, shear, squeeze harder, shear back, open: the force stays while the contact is pressed harder, and friction's entry never
/// falls.
#[test]
fn a_shear_cycle_takes_energy() {
    let ran = Ran::of(&case("02-shear-cycle/cycle.toml"));
    let contacts = ran.series("contacts.csv");
    let (times, force) = (contacts.column("time_s"), contacts.column("tangential_N"));
    let during: Vec<f64> =
        (times.iter().zip(force)).filter(|(t, _)| (0.00201..0.002_99).contains(*t)).map(|(_, force)| *force).collect();
    assert!(during.len() > 20 && during[0] > 1.0);
    assert!(during.iter().all(|force| (force / during[0] - 1.0).abs() < 1e-9), "{during:?}");
    let energies = ran.series("energies.csv");
    let (friction, stored) = (energies.column("friction_J"), energies.column("tangential_stored_J"));
    let most = stored.iter().fold(0.0_f64, |most, &stored| stored.max(most));
    assert!(friction.windows(2).all(|pair| pair[1] >= pair[0] - 1e-12 * most), "{friction:?}");
    assert!(last(&energies, "friction_J") > 0.1 * most && last(&energies, "tangential_stored_J") == 0.0);
}

/// Two coplanar plates are one: 557.3 N at most as sampled, and no sideways kick.
#[test]
fn a_seam_of_plates_is_not_felt() {
    for file in ["one", "two", "two-off"] {
        let ran = Ran::of(&case(&format!("07-seam/{file}.toml")));
        let flats = ran.series("flats.csv");
        let force = |name: &str| flats.column(&format!("{name}_force_N")).to_vec();
        let b = if file == "one" { vec![0.0; force("a").len()] } else { force("b") };
        let most = force("a").iter().zip(b).map(|(a, b)| a + b).fold(0.0, f64::max);
        assert!((most - 557.3).abs() < 0.1, "{file}: {most}");
        assert!(last(&ran.series("spheres.csv"), "vx_m_s").abs() < 1e-12, "{file}");
    }
}

/// A ball that strikes another obliquely with friction: the pair keeps its angular momentum to rounding.
#[test]
fn a_pair_keeps_its_angular_momentum() {
    for file in ["hertz", "oblique"] {
        let ran = Ran::of(&case(&format!("08-lever-arm/{file}.toml")));
        let series = ran.series("spheres.csv");
        let [x, z, vx, vz, turn] =
            ["x_m", "z_m", "vx_m_s", "vz_m_s", "wxz_rad_s"].map(|column| series.column(column).to_vec());
        let momentum = |i: usize| x[i] * vz[i] - z[i] * vx[i] + 0.4 * 0.005 * 0.005 * turn[i];
        let end = x.len();
        let (before, after) = (momentum(0) + momentum(1), momentum(end - 2) + momentum(end - 1));
        let spins = 0.4 * 0.005 * 0.005 * (turn[end - 2].abs() + turn[end - 1].abs());
        assert!(spins > 1e-4 && (after - before).abs() < 1e-11 * spins, "{file}: {before} {after} of {spins}");
    }
}

/// A ball that slides on a floor comes to roll at 5/7 of its speed; a blow that grazes never leaves with more than it had; friction
/// that could do nothing is refused.
#[test]
fn sliding_comes_to_roll_and_grazing_gains_nothing() {
    let friction = last(&Ran::of(&case("13-grazing-rolling/roll.toml")).series("spheres.csv"), "vx_m_s");
    assert!((friction - 0.5 / 7.0).abs() < 5e-4, "{friction}");
    for angle in [30, 76, 85] {
        let series = Ran::of(&case(&format!("13-grazing-rolling/grazing-{angle}.toml"))).series("spheres.csv");
        let [vx, vz, turn] = ["vx_m_s", "vz_m_s", "wy_rad_s"].map(|column| last(&series, column));
        let left = vx * vx + vz * vz + 0.4 * 0.005 * 0.005 * turn * turn;
        assert!(left <= 1.0 + 1e-6, "{angle}: {left}");
    }
    let error = Setup::read(shipped("tests/data/cases/13-grazing-rolling/roll-no-spring.toml")).unwrap_err();
    let (words, help) = (error.to_string(), error.help().unwrap());
    assert!(words.contains("spring") && words.contains("damping"), "{words}");
    assert!(help.contains("mindlin") && help.contains("damping"), "{help}");
}

/// Spins are read as they are written: about y in a sheet.
#[test]
fn a_spin_in_a_sheet_is_about_y() {
    let text = format!(
        "{HEAD}[crystal]\npacking = \"square\"\ndiameter = \"6 mm\"\nlayers = 1\nx = [\"0 D\", \"0 D\"]\nmaterial = \"440c\"\n\
         [friction]\ncoefficient = 0.3\nspring = \"mindlin\"\n[[moving]]\nlayers = 1\nspin = \"50 rad/s\"\n\
         [run]\nwindow = \"1 us\"\nstep = \"10 ns\"\n[record]\nquantities = [\"spin\"]\n"
    );
    let series = Ran::of(&sheet(&text)).series("spheres.csv");
    assert_eq!((last(&series, "wx_rad_s"), last(&series, "wy_rad_s"), last(&series, "wxz_rad_s")), (0.0, 50.0, -50.0));
}
