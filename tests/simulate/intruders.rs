//! Intruders, layouts as patterns, springs and dashpots.

use granulens::contact::Dashpot;
use granulens::material::find;

use super::*;

fn last(series: &Series, column: &str) -> f64 {
    *series.column(column).last().unwrap()
}

/// A ball that is the first sphere of a chain in all but name: the same motion, to rounding (the crystal's first sphere lies at
/// z = 0 in one and a diameter deep in the other).
#[test]
fn a_ball_strikes_as_a_sphere_does() {
    let text = |layers: u32, striker: &str| {
        format!(
            "{HEAD}[crystal]\npacking = \"chain\"\ndiameter = \"10 mm\"\nlayers = {layers}\nmaterial = \"440c\"\n{striker}\
             [run]\nwindow = \"150 us\"\nstep = \"0.1 us\"\n[record]\nevery = \"1 us\"\n"
        )
    };
    let ball = "[[intruder]]\nname = \"ball\"\nshape = \"ball\"\nmaterial = \"440c\"\ndiameter = \"10 mm\"\nvelocity = \"8 m/s\"\n";
    let ran = Ran::of(&chain(&text(3, ball)));
    let twin = Ran::of(&chain(&text(4, "[[moving]]\nlayers = 1\nvelocity = \"8 m/s\"\n")));
    let (ball, spheres) = (ran.series("intruders.csv"), twin.series("spheres.csv"));
    let first = |column: &str| -> Vec<f64> {
        let rows = spheres.column("sphere").iter().zip(spheres.column(column));
        rows.filter(|(sphere, _)| **sphere == 1.0).map(|(_, value)| *value).collect()
    };
    for (k, v) in first("vz_m_s").iter().enumerate() {
        assert!((ball.column("ball_vz_m_s")[k] - v).abs() < 1e-9 * 8.0, "{k}");
    }
    let [struck] = &ran.summary.intruders[..] else { panic!() };
    assert_eq!((struck.name.as_str(), struck.velocity_m_s), ("ball", last(&ball, "ball_vz_m_s")));
    // The table names it, and the crystal is the crystal alone.
    assert_eq!(ran.spheres("sphere"), [1.0, 2.0, 3.0]);
    let ever = std::fs::read_to_string(ran.folder.path().join("contacts-ever.csv")).unwrap();
    assert!(ever.lines().any(|line| line.starts_with("1,ball,")), "{ever}");
}

/// A ball on the axis of a half crystal is a ball on the whole one: greatest speeds to 1e-9 of the largest, and the force is that
/// on the whole ball.
#[test]
fn a_ball_on_a_mirror_is_a_whole_ball() {
    let text = |x: &str, sides: &str| {
        format!(
            "{HEAD}[crystal]\npacking = \"hexagonal\"\ndiameter = \"6 mm\"\nlayers = 8\nx = {x}\nmaterial = \"brass\"\n{sides}\
             [[intruder]]\nname = \"ball\"\nshape = \"ball\"\nmaterial = \"440c\"\ndiameter = \"30 mm\"\nx = \"0 D\"\n\
             velocity = \"10 m/s\"\n[run]\nwindow = \"80 us\"\nstep = \"0.1 us\"\n"
        )
    };
    let half = Ran::of(&sheet(&text("[\"0 D\", \"4 D\"]", "[sides]\nx = [\"mirror\", \"free\"]\n")));
    let whole = Ran::of(&sheet(&text("[\"-4 D\", \"4 D\"]", "")));
    let (a, b) = (half.series("intruders.csv"), whole.series("intruders.csv"));
    let largest = b.column("ball_Fz_N").iter().fold(0.0, |most: f64, f| most.max(f.abs()));
    assert!(largest > 100.0);
    for (f, g) in a.column("ball_Fz_N").iter().zip(b.column("ball_Fz_N")) {
        assert!((f - g).abs() < 1e-9 * largest, "{f} {g}");
    }
    let at = |ran: &Ran| {
        let (x, layer, speed) = (ran.spheres("x_m"), ran.spheres("layer"), ran.spheres("max_speed_m_s"));
        (0..x.len()).map(|i| ((x[i] / 3e-3).round() as i64, layer[i] as i64, speed[i])).collect::<Vec<_>>()
    };
    let whole = at(&whole);
    let fastest = whole.iter().map(|s| s.2).fold(0.0, f64::max);
    for (x, layer, speed) in at(&half) {
        let same = whole.iter().find(|s| s.0 == x && s.1 == layer).unwrap();
        assert!((speed - same.2).abs() < 1e-9 * fastest, "x {x}, layer {layer}: {speed} {}", same.2);
    }
}

/// An ogive on a free sheet: momentum goes from one to the other without loss (rounding of some thousand steps: 1e-10), along the
/// wave and, as it strikes beside the middle, across it; what it turns by is recorded.
#[test]
fn an_ogive_hands_over_its_momentum() {
    let prepared = sheet(&format!(
        "{HEAD}[crystal]\npacking = \"hexagonal\"\ndiameter = \"6 mm\"\nlayers = 6\nx = [\"-4 D\", \"4 D\"]\nmaterial = \"brass\"\n\
         [[intruder]]\nname = \"ogive\"\nshape = \"ogive\"\nmaterial = \"440c\"\nhalf_width = \"2 D\"\nhalf_height = \"4 D\"\n\
         mass = \"50 g\"\nx = \"0.7 D\"\nvelocity = \"10 m/s\"\nturns = true\n\
         [run]\nwindow = \"100 us\"\n[record]\nlayers = [1, 6]\n"
    ));
    let ran = Ran::of(&prepared);
    assert_eq!(ran.ending, Ending::Complete);
    let (ogive, spheres) = (ran.series("intruders.csv"), ran.series("spheres.csv"));
    let mass = find("brass", &[]).unwrap().sphere_mass(6e-3);
    let count = prepared.sites.len();
    for (axis, start) in [("x", 0.0), ("z", 0.5)] {
        let velocities = spheres.column(&format!("v{axis}_m_s"));
        let crystal: f64 = velocities[velocities.len() - count..].iter().map(|v| mass * v).sum();
        let left = 0.05 * last(&ogive, &format!("ogive_v{axis}_m_s"));
        assert!((crystal + left - start).abs() < 1e-10, "{axis}: {crystal} {left}");
        assert!(crystal.abs() > 1e-3, "{axis}: {crystal}");
    }
    assert!(last(&ogive, "ogive_angle_rad") != 0.0);
    assert!(ran.summary.residual.unwrap().abs() < 1e-4);
    // m dv/dt is the recorded force: over each sample by trapezoids, of a force that jumps as spheres meet, to some percent.
    let (time, force, v) = (ogive.column("time_s"), ogive.column("ogive_Fz_N"), ogive.column("ogive_vz_m_s"));
    let impulse: f64 = (1..time.len()).map(|k| 0.5 * (force[k] + force[k - 1]) * (time[k] - time[k - 1])).sum();
    assert!((impulse / (0.05 * (last(&ogive, "ogive_vz_m_s") - v[0])) - 1.0).abs() < 0.02, "{impulse}");
}

/// An upright outline on the axis of a symmetric sheet moves straight, and both halves of the sheet alike: to rounding, which the
/// crystal multiplies by less than a thousand in this time.
#[test]
fn an_outline_on_the_axis_moves_straight() {
    let prepared = sheet(&format!(
        "{HEAD}[crystal]\npacking = \"hexagonal\"\ndiameter = \"6 mm\"\nlayers = 8\nx = [\"-4 D\", \"4 D\"]\nmaterial = \"brass\"\n\
         [[intruder]]\nname = \"ogive\"\nshape = \"ogive\"\nmaterial = \"440c\"\nhalf_width = \"2 D\"\nhalf_height = \"4 D\"\n\
         mass = \"50 g\"\nx = \"0 D\"\nvelocity = \"10 m/s\"\nturns = true\n[run]\nwindow = \"80 us\"\n"
    ));
    let ran = Ran::of(&prepared);
    let ogive = ran.series("intruders.csv");
    assert!(last(&ogive, "ogive_vz_m_s") < 9.9);
    assert!(ogive.column("ogive_vx_m_s").iter().all(|v| v.abs() < 1e-9));
    let (x, layer, speed) = (ran.spheres("x_m"), ran.spheres("layer"), ran.spheres("max_speed_m_s"));
    for i in 0..x.len() {
        let image = (0..x.len()).find(|&j| layer[j] == layer[i] && (x[j] + x[i]).abs() < 1e-9).unwrap();
        assert!((speed[i] - speed[image]).abs() < 1e-9, "{i}: {} {}", speed[i], speed[image]);
    }
}

/// A layout's file in a rig is the lens of its design, half and whole.
#[test]
fn a_layout_is_a_pattern() {
    let text = |x: &str| {
        format!(
            "{HEAD}[crystal]\npacking = \"hexagonal\"\ndiameter = \"6.35 mm\"\nlayers = 50\nx = {x}\nmaterial = \"stainless-440c\"\n\
             [[pattern]]\nkind = \"layout\"\nfile = \"thesis-lens.csv\"\n[run]\nwindow = \"1 us\"\n"
        )
    };
    let read = |x: &str| match Setup::parse(shipped("designs/rig.toml"), &text(x)).unwrap() {
        Setup::Two(prepared) => prepared.rig.sample,
        other => panic!("{other:?}"),
    };
    let Setup::Two(lens) = Setup::read(shipped("designs/thesis-lens.toml")).unwrap() else { panic!() };
    let lens = lens.rig.sample;
    let half = read("[\"0 D\", \"16.5 D\"]");
    let name =
        |sample: &granulens::sample::Sample<2>, i: usize| sample.materials[sample.spheres[i].material].name.clone();
    assert_eq!(half.spheres.len(), lens.spheres.len());
    for i in 0..half.spheres.len() {
        assert_eq!(name(&half, i), name(&lens, i), "sphere {}", i + 1);
        let apart = (0..2).map(|k| (half.spheres[i].centre[k] - lens.spheres[i].centre[k]).abs()).fold(0.0, f64::max);
        assert!(apart < 1e-12 && half.spheres[i].radius == lens.spheres[i].radius);
    }
    // The other half is the mirror image: brass off the axis counts twice.
    let brass = |sample: &granulens::sample::Sample<2>, least: f64| {
        (0..sample.spheres.len())
            .filter(|&i| name(sample, i) == "brass-260" && sample.spheres[i].centre[0] > least)
            .count()
    };
    let whole = read("[\"-16.5 D\", \"16.5 D\"]");
    assert_eq!(brass(&half, -1.0), 139);
    assert_eq!(brass(&whole, -1.0), 139 + brass(&half, 1e-6));
}

/// The restitution asked for is had: of two spheres, of a sphere on a wall (which counts as an equal one at twice the overlap), of
/// two that a pair's law names; with a force that is cut at zero and one that pulls. The step cuts the contact into some
/// 600; where the force begins with a jump that is met half a step late, which costs γ h/2 of the speed, 0.25 % at most.
#[test]
fn springs_and_dashpots_have_their_restitution() {
    let law = |e: f64, pull: bool| {
        format!("kind = \"spring-dashpot\"\nstiffness = \"2e7 N/m\"\nrestitution = {e}\npull = {pull}\n")
    };
    let run = |body: &str| {
        let ran = Ran::of(&chain(&format!("{HEAD}{body}[run]\nwindow = \"400 us\"\nstep = \"0.05 us\"\n")));
        assert_eq!(ran.ending, Ending::Complete);
        let series = ran.series("spheres.csv");
        let velocities = series.column("vz_m_s");
        velocities[velocities.len() - bench_size(body)..].to_vec()
    };
    fn bench_size(body: &str) -> usize {
        if body.contains("layers = 2") { 2 } else { 1 }
    }
    let crystal = |layers: u32| {
        format!("[crystal]\npacking = \"chain\"\ndiameter = \"10 mm\"\nlayers = {layers}\nmaterial = \"440c\"\n")
    };
    let moving = "[[moving]]\nlayers = 1\nvelocity = \"1 m/s\"\n";
    for (e, pull) in [(0.9, false), (0.5, false), (0.5, true), (0.2, false)] {
        let v = run(&format!("{}{moving}[law]\n{}", crystal(2), law(e, pull)));
        assert!((v[1] - v[0] - e).abs() < 0.005, "{e} {pull}: {v:?}");
        let v = run(&format!("{}{moving}[sides]\nz = [\"free\", \"wall\"]\n[law]\n{}", crystal(1), law(e, pull)));
        assert!((v[0] + e).abs() < 0.005, "wall, {e} {pull}: {v:?}");
        let pair = format!("[law]\nkind = \"hertz\"\n[[pair]]\nmaterials = [\"440c\", \"440c\"]\n{}", law(e, pull));
        let v = run(&format!("{}{moving}{pair}", crystal(2)));
        assert!((v[1] - v[0] - e).abs() < 0.005, "pair, {e} {pull}: {v:?}");
    }
    // Damping is per reduced mass: the closed form of the restitution that follows.
    let half = 0.5 * find("440c", &[]).unwrap().sphere_mass(0.01);
    let exact = Dashpot { stiffness: 2e7, damping: 3e4 * half, cut: true }.restitution(half);
    let keys = "kind = \"spring-dashpot\"\nstiffness = \"2e7 N/m\"\ndamping = \"3e4 1/s\"\n";
    let v = run(&format!("{}{moving}[law]\n{keys}", crystal(2)));
    assert!((v[1] - v[0] - exact).abs() < 0.005 && (0.3..0.8).contains(&exact), "{exact}: {v:?}");
}
