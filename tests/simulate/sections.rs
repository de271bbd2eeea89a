//! What each section does, by what moves.

use granulens::material::find;

use super::*;

/// Two spheres of a chain that hit a third: velocities of equal elastic spheres are handed on (Hertz; to the step's accuracy).
#[test]
fn moving_spheres_hand_their_velocity_on() {
    let prepared = chain(&format!(
        "{HEAD}[crystal]\npacking = \"chain\"\ndiameter = \"10 mm\"\nlayers = 2\nmaterial = \"440c\"\n[law]\nkind = \"hertz\"\n\
         [[moving]]\nlayers = 1\nvelocity = \"1 m/s\"\n[run]\nwindow = \"300 us\"\n[record]\nevery = \"1 us\"\n"
    ));
    let ran = Ran::of(&prepared);
    let series = ran.series("spheres.csv");
    let last: Vec<f64> = series.column("vz_m_s").iter().rev().take(2).rev().copied().collect();
    // 0.1 % is what the step is chosen for.
    assert!(last[0].abs() < 1e-3 && (last[1] - 1.0).abs() < 1e-3, "{last:?}");
    let steel = find("440c", &[]).unwrap();
    let energy = 0.5 * steel.sphere_mass(0.01);
    assert!((ran.summary.energies.work_in / energy - 1.0).abs() < 1e-12);
}

/// A force pulse on a free sphere gives it its impulse: peak times duration, 2/π or 1/2 of it by shape, along its direction.
#[test]
fn pulses_have_their_impulse() {
    let speed = |pulse: &str| {
        let prepared = sheet(&format!(
            "{HEAD}[crystal]\npacking = \"square\"\ndiameter = \"10 mm\"\nlayers = 1\nx = [\"0 D\", \"0 D\"]\nmaterial = \"440c\"\n\
             [[load]]\nkind = \"force\"\nlayers = 1\ndirection = [3.0, 4.0]\n{pulse}\n\
             [run]\nwindow = \"50 us\"\nstep = \"0.1 us\"\n"
        ));
        let ran = Ran::of(&prepared);
        let series = ran.series("spheres.csv");
        let last = |name: &str| *series.column(name).last().unwrap();
        [last("vx_m_s"), last("vz_m_s")]
    };
    let mass = find("440c", &[]).unwrap().sphere_mass(0.01);
    let full = 1000.0 * 20e-6 / mass;
    for (shape, part) in [("square", 1.0), ("half-sine", 2.0 / std::f64::consts::PI), ("triangle", 0.5)] {
        let pulse = format!("pulse = \"{shape}\"\npeak = \"1 kN\"\nstart = \"5 us\"\nduration = \"20 us\"");
        let [vx, vz] = speed(&pulse);
        assert!((vx / (0.6 * part * full) - 1.0).abs() < 1e-9, "{shape} {vx}");
        assert!((vz / (0.8 * part * full) - 1.0).abs() < 1e-9, "{shape} {vz}");
    }
}

/// A displacement from a table is followed point by point and between them, to the rounding of some thousand steps; then the body is free and
/// keeps its velocity.
#[test]
fn a_prescribed_displacement_is_followed() {
    let folder = tempfile::tempdir().unwrap();
    let points = [(0.0, 0.0), (10e-6, 20e-6), (20e-6, 20e-6), (30e-6, 5e-6)];
    let lines: String = points.iter().map(|(t, u)| format!("{t},{u}\n")).collect();
    std::fs::write(folder.path().join("path.csv"), format!("time_s,displacement_m\n{lines}")).unwrap();
    let text = format!(
        "{HEAD}[crystal]\npacking = \"chain\"\ndiameter = \"10 mm\"\nlayers = 1\nmaterial = \"440c\"\n\
         [[load]]\nkind = \"displacement\"\nlayers = 1\npulse = \"table\"\nfile = \"path.csv\"\n\
         [run]\nwindow = \"40 us\"\nstep = \"0.03 us\"\n[record]\nevery = \"0.3 us\"\n"
    );
    let Ok(Setup::One(prepared)) = Setup::parse(folder.path().join("rig.toml"), &text) else { panic!() };
    let series = Ran::of(&prepared).series("spheres.csv");
    let (time, moved) = (series.column("time_s"), series.column("uz_m"));
    assert!(time.len() > 100);
    for (t, u) in time.iter().zip(moved) {
        let expected = match points.windows(2).find(|p| (p[0].0..=p[1].0).contains(t)) {
            Some(p) => p[0].1 + (p[1].1 - p[0].1) * (t - p[0].0) / (p[1].0 - p[0].0),
            None => 5e-6 - 1.5 * (t - 30e-6),
        };
        assert!((u - expected).abs() < 1e-15, "{t}: {u} {expected}");
    }
}

/// A wall is a mirror: a sphere that runs into a wall feels what two equal spheres feel that meet at twice its speed.
#[test]
fn a_wall_is_an_equal_sphere() {
    let body = |layers: u32, extra: &str| {
        format!(
            "{HEAD}[crystal]\npacking = \"chain\"\ndiameter = \"10 mm\"\nlayers = {layers}\nmaterial = \"440c\"\n{extra}\
             [run]\nwindow = \"100 us\"\nstep = \"0.05 us\"\n"
        )
    };
    let wall = "[sides]\nz = [\"free\", \"wall\"]\n[[moving]]\nlayers = 1\nvelocity = \"2 m/s\"\n";
    let pair = "[[moving]]\nlayers = 1\nvelocity = \"2 m/s\"\n[[moving]]\nlayers = 2\nvelocity = \"-2 m/s\"\n";
    let rebound = |text: &str| {
        let series = Ran::of(&chain(text)).series("spheres.csv");
        let rows = series.column("sphere").len();
        (0..rows).filter(|&k| series.column("sphere")[k] == 1.0).map(|k| series.column("vz_m_s")[k]).collect::<Vec<_>>()
    };
    let (one, two) = (rebound(&body(1, wall)), rebound(&body(2, pair)));
    assert!(one.last().unwrap() < &-0.1);
    assert_eq!(one.len(), two.len());
    for (a, b) in one.iter().zip(&two) {
        assert!((a - b).abs() < 1e-9, "{a} {b}");
    }
}

/// The half crystal between mirrors is the periodic one, here seen through a file: spheres of the first layer under equal forces
/// but one that gets more.
#[test]
fn mirrors_are_the_periodic_crystal() {
    let load = |force: &str, place: &str| {
        format!("[[load]]\nkind = \"force\"\n{place}\npulse = \"square\"\npeak = \"{force}\"\nduration = \"10 us\"\n")
    };
    let text = |width: &str, sides: &str| {
        format!(
            "{HEAD}[crystal]\npacking = \"hexagonal\"\ndiameter = \"6 mm\"\nlayers = 8\n{width}\nmaterial = \"brass\"\n\
             [sides]\nx = \"{sides}\"\n{}{}[run]\nwindow = \"60 us\"\nstep = \"0.1 us\"\n",
            load("2 kN", "layers = 1"),
            load("3 kN", "layers = 1\nx = [\"0 D\", \"0 D\"]"),
        )
    };
    let half = Ran::of(&sheet(&text("x = [\"0 D\", \"3 D\"]", "mirror")));
    let whole = Ran::of(&sheet(&text("cells = [6]", "periodic")));
    let at = |ran: &Ran| {
        let (x, layer, speed) = (ran.spheres("x_m"), ran.spheres("layer"), ran.spheres("max_speed_m_s"));
        (0..x.len()).map(|i| ((x[i] / 3e-3).round() as i64, layer[i] as i64, speed[i])).collect::<Vec<_>>()
    };
    let (half, whole) = (at(&half), at(&whole));
    let largest = whole.iter().map(|s| s.2).fold(0.0, f64::max);
    for (x, layer, speed) in half {
        let same = whole.iter().find(|s| s.0 == x && s.1 == layer).unwrap();
        assert!((speed - same.2).abs() < 1e-9 * largest, "x {x}, layer {layer}: {speed} {}", same.2);
    }
}

/// Held spheres stay, others do not; a fixed side holds its spheres.
#[test]
fn held_spheres_stay() {
    let prepared = sheet(&format!(
        "{HEAD}[crystal]\npacking = \"square\"\ndiameter = \"6 mm\"\nlayers = 4\nx = [\"0 D\", \"2 D\"]\nmaterial = \"brass\"\n\
         [sides]\nz = [\"free\", \"fixed\"]\n[[edit]]\nlayers = 2\ncolumns = 2\nhold = [\"x\", \"z\"]\n\
         [[load]]\nkind = \"force\"\nlayers = 1\npulse = \"square\"\npeak = \"2 kN\"\nduration = \"10 us\"\n\
         [run]\nwindow = \"60 us\"\n"
    ));
    let ran = Ran::of(&prepared);
    let speed = ran.spheres("max_speed_m_s");
    for (site, speed) in prepared.sites.iter().zip(&speed) {
        let held = site.layer == 4 || (site.layer == 2 && site.column == 2);
        // Behind the held sphere of a square sheet nothing is pushed.
        let behind = site.layer == 3 && site.column == 2;
        assert_eq!(*speed == 0.0, held || behind, "{site:?} {speed}");
    }
}

/// A vacancy shields what lies behind it in a square sheet; a pair law and a table hold where they are named.
#[test]
fn vacancies_pairs_and_tables_hold() {
    let folder = tempfile::tempdir().unwrap();
    // A stiff straight spring of 1e8 N/m.
    std::fs::write(folder.path().join("spring.csv"), "overlap_m,force_N\n0,0\n1e-4,1e4\n1e-3,1e5\n").unwrap();
    let text = format!(
        "{HEAD}[crystal]\npacking = \"square\"\ndiameter = \"6 mm\"\nlayers = 3\nx = [\"0 D\", \"2 D\"]\nmaterial = \"brass\"\n\
         [[pattern]]\nkind = \"uniform\"\nmaterials = [\"440c\"]\nx = [\"2 D\", \"2 D\"]\n\
         [[edit]]\nlayers = 2\ncolumns = 1\nremove = true\n[[pair]]\nmaterials = [\"440c\", \"440c\"]\ntable = \"spring.csv\"\n\
         [[pair]]\nmaterials = [\"brass\", \"440c\"]\nkind = \"hertz\"\n\
         [[load]]\nkind = \"force\"\nlayers = 1\npulse = \"square\"\npeak = \"2 kN\"\nduration = \"10 us\"\n\
         [run]\nwindow = \"15 us\"\n[record]\nevery = \"0.2 us\"\ncontacts = true\n"
    );
    let Setup::Two(prepared) = Setup::parse(folder.path().join("rig.toml"), &text).unwrap() else { panic!() };
    assert_eq!(prepared.sites.len(), 8);
    let ran = Ran::of(&prepared);
    let speed = ran.spheres("max_speed_m_s");
    let at =
        |layer: u32, column: u32| prepared.sites.iter().position(|s| (s.layer, s.column) == (layer, column)).unwrap();
    assert_eq!(speed[at(3, 1)], 0.0);
    assert!(speed[at(3, 3)] > 0.1);
    let contacts = ran.series("contacts.csv");
    let steel = [at(1, 3), at(2, 3)].map(|i| (i + 1) as f64);
    let mut seen = 0;
    for k in 0..contacts.columns[0].len() {
        if [contacts.column("a")[k], contacts.column("b")[k]] == steel {
            let (overlap, force) = (contacts.column("overlap_m")[k], contacts.column("force_N")[k]);
            assert!((force - 1e8 * overlap).abs() < 1e-9 * force, "{overlap} {force}");
            seen += 1;
        }
    }
    assert!(seen > 20, "{seen}");
}

/// A flat of finite mass that falls freely: v = g t; and with a body of its own on a bar, the bar stops it exponentially:
/// v = v₀ exp(−Z t/m).
#[test]
fn flats_fall_and_bars_brake() {
    let text = |extra: &str| {
        format!(
            "{HEAD}[crystal]\npacking = \"chain\"\ndiameter = \"10 mm\"\nlayers = 1\nmaterial = \"440c\"\n\
             [[flat]]\nname = \"ram\"\npoint = [\"-1 m\"]\nnormal = [1.0]\nmass = \"2 kg\"\n{extra}\
             [run]\nwindow = \"1 ms\"\nstep = \"1 us\"\n"
        )
    };
    let last = |text: &str| {
        let series = Ran::of(&chain(text)).series("flats.csv");
        (*series.column("time_s").last().unwrap(), *series.column("ram_velocity_m_s").last().unwrap())
    };
    let (time, velocity) = last(&text("[gravity]\nacceleration = \"9.81 m/s2\"\n"));
    assert!((velocity / (9.81 * time) - 1.0).abs() < 1e-12);
    let (time, velocity) = last(&text("velocity = \"3 m/s\"\n[[bar]]\nflat = \"ram\"\nimpedance = \"4000 kg/s\"\n"));
    // h Z/m = 2e-3 a step, of second order: (2e-3)²/12 over 1000 steps of it.
    assert!((velocity / (3.0 * (-4000.0 * time / 2.0).exp()) - 1.0).abs() < 1e-6, "{velocity}");
}

/// Loads on flats: a force from a table gives the flat its impulse (here 1 kN rising and falling over 20 us: 10 mN s on 2 kg), a
/// velocity pulse its velocity while it lasts and nothing after it.
#[test]
fn loads_act_on_flats() {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("force.csv"), "time_s,force_N\n0,0\n1e-5,1000\n2e-5,0\n").unwrap();
    let velocity = |load: &str| {
        let text = format!(
            "{HEAD}[crystal]\npacking = \"chain\"\ndiameter = \"10 mm\"\nlayers = 1\nmaterial = \"440c\"\n\
             [[flat]]\nname = \"ram\"\npoint = [\"-1 m\"]\nnormal = [1.0]\nmass = \"2 kg\"\n[[load]]\nflat = \"ram\"\n{load}\n\
             [run]\nwindow = \"40 us\"\nstep = \"0.1 us\"\n[record]\nevery = \"1 us\"\n"
        );
        let Ok(Setup::One(prepared)) = Setup::parse(folder.path().join("rig.toml"), &text) else { panic!() };
        let series = Ran::of(&prepared).series("flats.csv");
        (series.column("time_s").to_vec(), series.column("ram_velocity_m_s").to_vec())
    };
    let (_, pushed) = velocity("kind = \"force\"\npulse = \"table\"\nfile = \"force.csv\"");
    assert!((pushed.last().unwrap() / (0.01 / 2.0) - 1.0).abs() < 1e-9, "{:?}", pushed.last());
    let (time, led) = velocity("kind = \"velocity\"\npulse = \"half-sine\"\npeak = \"3 m/s\"\nduration = \"20 us\"");
    for (t, v) in time.iter().zip(led) {
        // At the end the flat is free with the velocity that it has: none.
        let expected = if *t < 20e-6 { 3.0 * (std::f64::consts::PI * t / 20e-6).sin() } else { 0.0 };
        assert!((v - expected).abs() < 1e-8, "{t}: {v} {expected}");
    }
}

/// Friction needs a spin: two spheres that graze turn.
#[test]
fn friction_turns_spheres() {
    let text = |friction: &str| {
        format!(
            "{HEAD}[crystal]\npacking = \"square\"\ndiameter = \"6 mm\"\nlayers = 2\nx = [\"0 D\", \"0 D\"]\nmaterial = \"440c\"\n\
             [[moving]]\nlayers = 1\nvelocity = [\"1 m/s\", \"2 m/s\"]\n{friction}\
             [run]\nwindow = \"50 us\"\n[record]\nquantities = [\"spin\"]\n"
        )
    };
    let spin = |friction: &str| {
        Ran::of(&sheet(&text(friction))).series("spheres.csv").column("wy_rad_s").len()
            + Ran::of(&sheet(&text(friction)))
                .series("spheres.csv")
                .column("wxz_rad_s")
                .iter()
                .filter(|w| **w != 0.0)
                .count()
    };
    let samples = spin("");
    assert!(spin("[friction]\ncoefficient = 0.3\nspring = \"mindlin\"\n") > samples);
}

/// A crystal in space from a file, by outline.
#[test]
fn disks_and_hexagons_bound_layers() {
    let count = |outline: &str| {
        let prepared = solid(&format!(
            "{HEAD}[crystal]\npacking = \"fcc-111\"\ndiameter = \"6 mm\"\nlayers = 3\n{outline}\nmaterial = \"brass\"\n\
             [run]\nwindow = \"1 us\"\n"
        ));
        (1..=3).map(|layer| prepared.sites.iter().filter(|s| s.layer == layer).count()).collect::<Vec<_>>()
    };
    assert_eq!(count("hexagon = 5"), [19, 12, 12]);
    assert_eq!(count("disk = \"2 D\""), [7, 3, 3]);
}

/// Stripes that a periodic crystal cannot hold are warned about: one and two lines repeat in 15 spheres, two and two do not.
#[test]
fn a_seam_between_stripes_is_warned_about() {
    let warnings = |second: &str| {
        sheet(&format!(
            "{HEAD}[crystal]\npacking = \"hexagonal\"\ndiameter = \"6 mm\"\nlayers = 9\ncells = [15]\nmaterial = \"brass\"\n\
             [[pattern]]\nkind = \"stripes\"\nmaterials = [\"al\", \"brass\"]\nangle = \"60 deg\"\n\
             widths = [\"{second} D\", \"1.7320508075688772 D\"]\n[sides]\nx = \"periodic\"\n[law]\nkind = \"thesis\"\n\
             [run]\nwindow = \"10 us\"\n"
        ))
        .plan
        .warnings
    };
    assert_eq!(warnings("0.8660254037844386"), Vec::<String>::new());
    assert!(warnings("1.7320508075688772").concat().contains("pattern[1]: the stripes do not repeat"));
}

/// What layers dissipate is the dissipation of the ledger, part by part.
#[test]
fn layers_share_the_dissipation() {
    let text = std::fs::read_to_string(shipped("designs/striped-guide.toml")).unwrap();
    let ran = Ran::of(&sheet(&text.replace("window = \"200 us\"", "window = \"60 us\"")));
    let lost: f64 = ran.series("layers-final.csv").column("dissipated_J").iter().sum();
    assert!((lost / ran.summary.energies.dissipated - 1.0).abs() < 1e-9, "{lost}");
}

/// A flat of brass is an elastic half-space to spheres of steel: F = (4/3) E* √R d^{3/2} (the core's tests hold the blow to 1e-4); one with a stiffness
/// of its own takes π √(m/2k); friction of one flat alone turns what meets it, and not what meets the other.
#[test]
fn flats_have_a_material_a_stiffness_and_friction_of_their_own() {
    let text = |flat: &str, more: &str| {
        format!(
            "{HEAD}[crystal]\npacking = \"square\"\ndiameter = \"10 mm\"\nlayers = 1\nx = [\"0 D\", \"0 D\"]\nmaterial = \"440c\"\n\
             [law]\nkind = \"hertz\"\n[[flat]]\nname = \"floor\"\npoint = [\"0 mm\", \"5.001 mm\"]\nnormal = [0, -1]\n{flat}\
             [[moving]]\nlayers = 1\nvelocity = [\"0.3 m/s\", \"0.5 m/s\"]\n[run]\nwindow = \"400 us\"\n\
             [record]\nquantities = [\"velocity\", \"spin\"]\nevents = [\"force-peak\", \"closes\", \"opens\"]\n{more}"
        )
    };
    let [steel, brass] = ["440c", "brass"].map(|name| find(name, &[]).unwrap());
    let compliance = [&steel, &brass].map(|m| (1.0 - m.poisson_ratio * m.poisson_ratio) / m.youngs_modulus);
    let mass = steel.sphere_mass(0.01);
    let peak = |ran: &Ran| -> f64 {
        let events = std::fs::read_to_string(ran.folder.path().join("events.csv")).unwrap();
        let forces =
            events.lines().map(|line| line.split(',').collect::<Vec<_>>()).filter(|row| row[1] == "force-peak");
        forces.map(|row| row[5].parse().unwrap()).fold(0.0, f64::max)
    };
    for (flat, sum) in [("material = \"brass\"\n", compliance[0] + compliance[1]), ("", compliance[0])] {
        let k = 4.0 / 3.0 / sum * 0.005_f64.sqrt();
        let exact = k * (5.0 * mass * 0.25 / (4.0 * k)).powf(0.6);
        let ran = Ran::of(&sheet(&text(flat, "")));
        assert_eq!(ran.ending, Ending::Complete);
        assert!((peak(&ran) / exact - 1.0).abs() < 1e-3, "{flat:?}: {} {exact}", peak(&ran));
    }
    // An undamped spring: v √(k m) of the pair that the flat stands for, twice the overlap and half the mass.
    let ran = Ran::of(&sheet(&text("stiffness = \"2e6 N/m\"\nrestitution = 1\n", "")));
    let exact = 2.0 * 0.5 * (2e6 * 0.5 * mass).sqrt();
    assert!((peak(&ran) / exact - 1.0).abs() < 1e-3, "{} {exact}", peak(&ran));
    let turned =
        |flat: &str| *Ran::of(&sheet(&text(flat, ""))).series("spheres.csv").column("wy_rad_s").last().unwrap();
    assert!(turned("friction = 0.1\n").abs() > 10.0);
    assert_eq!(turned(""), 0.0);
}

/// Friction of a pair of metals alone; resistance to rolling; and a ball that comes spinning.
#[test]
fn pairs_rub_and_balls_come_spinning() {
    let text = |more: &str| {
        format!(
            "{HEAD}[crystal]\npacking = \"square\"\ndiameter = \"10 mm\"\nlayers = 1\nx = [\"0 D\", \"0 D\"]\nmaterial = \"brass\"\n\
             [law]\nkind = \"hertz\"\n[[intruder]]\nname = \"ball\"\nshape = \"ball\"\ndiameter = \"10 mm\"\nmaterial = \"440c\"\n\
             velocity = \"0.5 m/s\"\ngap = \"1 um\"\n{more}[run]\nwindow = \"200 us\"\n[record]\nquantities = [\"spin\", \"velocity\"]\n"
        )
    };
    let last = |text: &str, column: &str| *Ran::of(&sheet(text)).series("spheres.csv").column(column).last().unwrap();
    let pair = "[[pair]]\nmaterials = [\"440c\", \"brass\"]\nfriction = 0.2\n";
    // It slides throughout: the crystal's sphere takes up the couple (5/2) μ p/(m R) of the blow's impulse p = (1 + e) m̄ v.
    let [steel, brass] = ["440c", "brass"].map(|name| find(name, &[]).unwrap().sphere_mass(0.01));
    let impulse = 2.0 * 0.5 * steel * brass / (steel + brass);
    let spun = last(&text(&format!("spin = \"500 rad/s\"\n{pair}")), "wy_rad_s");
    let exact = -2.5 * 0.2 * impulse / (brass * 0.005);
    assert!((spun / exact - 1.0).abs() < 2e-3, "{spun} {exact}");
    let error = |more: &str| Setup::parse("rig.toml", &text(more)).unwrap_err();
    for (more, said) in [
        ("spin = \"500 rad/s\"\n", "friction"),
        ("spin = \"500 rad/s\"\nturns = false\n[friction]\ncoefficient = 0.2\nspring = \"mindlin\"\n", "turn"),
        ("[[pair]]\nmaterials = [\"440c\", \"brass\"]\n", "nothing of its own"),
        ("[[pair]]\nmaterials = [\"440c\", \"brass\"]\nrolling = 0.1\n", "how strongly"),
        ("[friction]\ncoefficient = 0.2\nspring = \"none\"\ndamping = \"1e4 1/s\"\nrolling = 0.1\n", "rolling"),
    ] {
        let error = error(more);
        assert!(format!("{error} {}", error.help).contains(said), "{more}: {error} {}", error.help);
    }
}
