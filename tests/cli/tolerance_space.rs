//! `tolerance` of crystals in space: the same notions as in a sheet.

use std::fmt::Write as _;

use granulens::Context;
use granulens::dem::rig::simulate_as_rig;
use granulens::dem::{ForcePulse, Projectile, Strike, simulate, simulate_batch_under};
use granulens::design::SpaceDesign;
use granulens::evaluate::{Evaluated, Evaluator, ImpactLoad, Imperfection, LoadCase, Overrides, Plan, impact_in_space};
use granulens::layout::Layout;
use granulens::real::Width;
use granulens::search::Rng;
use serde_json::Value;

use super::Desk;
use super::space::SMALL;

/// Layer 1 alone is looked at, and the pulse is over before its spheres have pressed anything: each has then the energy J²/2m, and C is the mass of a
/// brass sphere over that of a steel one. Seven spheres of the whole crystal are the focus: one on the axis, three on each side.
const TOY: &str = r#"format = 1
name = "toy-space"
[crystal]
packing = "hcp"
diameter = "6 mm"
layers = 3
cells = [8, 5]
axis_layer = 1
sides = "period"
host = "stainless-440c"
law = "hertz"
[impact]
kind = "force-pulse"
force = "26 kN"
duration = "0.1 us"
[target]
focus = { layers = [1, 1], r = ["0 D", "1.1 D"] }
protect = { layers = [1, 1], r = ["2.9 D", "3.2 D"] }
[run]
window = "1 us"
[compare]
material = "brass-260"
"#;

const RATIO: f64 = 8530.0 / 7650.0;

fn design(text: &str) -> SpaceDesign {
    SpaceDesign::parse_in_space("space.toml", text).unwrap()
}

/// Steel about the axis, brass beyond two diameters.
fn toy_layout(design: &SpaceDesign) -> Vec<u8> {
    let far = |centre: &[f64; 3]| centre[0].hypot(centre[1]) > 2.0 * design.lattice.diameter();
    design.lattice.sites().iter().map(|site| u8::from(far(&site.centre))).collect()
}

fn toy() -> Desk {
    let desk = Desk::new();
    desk.write("toy.toml", TOY);
    let design = design(TOY);
    let mut text = "layer,column,x,y,z,diameter,material\n".to_owned();
    for (site, material) in design.lattice.sites().iter().zip(toy_layout(&design)) {
        let [x, y, z] = site.centre;
        let name = ["stainless-440c", "brass-260"][usize::from(material)];
        let _ = writeln!(text, "{},{},{x},{y},{z},0.006,{name}", site.layer, site.column);
    }
    desk.write("toy.csv", text);
    desk
}

fn asked(desk: &Desk, more: &[&str]) -> Value {
    desk.run(&[&["tolerance", "toy.csv", "--design", "toy.toml", "--json"], more].concat()).ok().json()
}

fn runs(design: &SpaceDesign, cases: &[LoadCase], materials: &[u8], overrides: Overrides) -> Vec<Evaluated> {
    let never = Context::default();
    let evaluator = Evaluator::new(design, cases, design.palette(), overrides, &never).unwrap();
    let runs = evaluator.scores(&[materials.to_vec()], &never).unwrap().concat();
    assert!(runs.iter().all(|run| run.stop.is_none()), "{runs:?}");
    runs
}

/// Limits and yield by densities as in a sheet: to the limits C changes by C₀ d and C₀ d/(1 − d), both straight enough; a share (1 − t/2d)²/2 of pieces is
/// above C₀ (1 + t), but for terms of d.
#[test]
fn two_materials_do_what_their_masses_say_in_space() {
    let desk = toy();
    let d = 0.01;
    let t = 0.5 * d;
    desk.write(
        "density.toml",
        format!(
            "format = 1\nsamples = 400\n[material]\ndensity = \"1 %\"\n[thresholds]\ncontrast = {{ min = {} }}\n",
            RATIO * (1.0 + t)
        ),
    );
    let json = asked(&desk, &["--tolerances", "density.toml"]);
    let change = |quantity: &str| {
        let all = json["sensitivity"].as_array().unwrap();
        let found = all.iter().find(|one| one["quantity"] == quantity && one["score"] == "contrast");
        let found = found.unwrap_or_else(|| panic!("{quantity}: {json}"));
        assert_eq!((&found["believed"], &found["by_derivative"]), (&"secant".into(), &Value::Null));
        (found["change"].as_f64().unwrap(), found["linear"].as_bool().unwrap())
    };
    // A blow of a ten millionth of a second presses contacts by a tenth of a micrometre: a hundred thousandth of its force.
    let (brass, steel) = (change("density:brass-260"), change("density:stainless-440c"));
    assert!((brass.0.abs() / (RATIO * d) - 1.0).abs() < 1e-3 && brass.1, "{brass:?}");
    assert!((steel.0 / (RATIO * d / (1.0 - d)) - 1.0).abs() < 1e-3 && steel.1, "{steel:?}");
    assert!(json["no_derivatives"].as_str().unwrap().contains("sheets"), "{json}");
    let [low, high] = [0, 1].map(|end| json["interval"][end].as_f64().unwrap());
    let exact = 0.5 * (1.0 - t / (2.0 * d)).powi(2);
    assert!((low..=high).contains(&exact) && high - low < 0.1, "{exact} not in {low} to {high}");
    assert_eq!((&json["samples"], &json["seed"]), (&400.into(), &1.into()));
}

/// One sphere of the seven of the focus is missing, or of brass: on the axis, beside it on this side, or on the other. F is the mean of what is there, to the
/// hundred thousandth of the force that contacts press.
#[test]
fn single_spheres_count_once_on_either_side() {
    let design = design(TOY);
    let materials = toy_layout(&design);
    let sites = design.lattice.sites();
    let diameter = design.lattice.diameter();
    let at = |x: f64| {
        let is_there = |site: &granulens::lattice::CrystalSite<3>| {
            let [dx, y, _] = site.centre;
            site.layer == 1 && (dx / diameter - x).abs() < 1e-9 && y.abs() < 1e-9 * diameter
        };
        sites.iter().position(is_there).unwrap()
    };
    let (axis, beside) = (at(0.0), at(1.0));
    let n = sites.len();
    let load = ImpactLoad::from(design.impact);
    let case = |imperfection: Imperfection| LoadCase { imperfection, ..LoadCase::from(load) };
    let mut cases = vec![case(Imperfection::default())];
    for place in [axis, beside, n + beside] {
        let mut radii = vec![1.0; 2 * n];
        radii[place] = 0.0;
        cases.push(case(Imperfection { radii, ..Imperfection::default() }));
        let wrong = Imperfection {
            alphabet: vec![0, 1],
            wrong: vec![(place, 1)],
            radii: vec![1.0; 2 * n],
            ..Imperfection::default()
        };
        cases.push(case(wrong));
    }
    let runs = runs(&design, &cases, &materials, Overrides::default());
    let drawn = runs[0].scores.focal_mean;
    for pair in runs[1..].chunks(2) {
        let [missing, wrong] = [&pair[0], &pair[1]].map(|run| 7.0 * run.scores.focal_mean / drawn);
        assert!((missing - 6.0).abs() < 1e-3, "{missing}");
        assert!((wrong - (6.0 + 1.0 / RATIO)).abs() < 1e-3, "{wrong}");
    }
    // Of pieces with holes alone every contrast is that of so many spheres less.
    let desk = toy();
    desk.write("holes.toml", "format = 1\nsamples = 40\n[piece]\nvacancies = \"10 %\"\n");
    asked(&desk, &["--tolerances", "holes.toml", "--out", "holes"]);
    let there = sites.iter().zip(design.lattice.copies());
    let protected = there.filter(|(site, _)| {
        let r = site.centre[0].hypot(site.centre[1]) / diameter;
        site.layer == 1 && (2.9..3.2).contains(&r)
    });
    let protected: u32 = protected.map(|(_, &copies)| u32::from(copies)).sum();
    let pieces = desk.read("holes/pieces.csv");
    let mut lines = pieces.lines().skip(1);
    let column = lines.next().unwrap().split(',').position(|name| name == "contrast").unwrap();
    let mut seen = std::collections::BTreeSet::new();
    for line in lines {
        let contrast: f64 = line.split(',').nth(column).unwrap().parse().unwrap();
        let of = |a: u32, b: u32| RATIO * (f64::from(a) / 7.0) / (f64::from(b) / f64::from(protected));
        let found = (0..=7).flat_map(|a| (1..=protected).map(move |b| (a, b)));
        let nearest =
            found.map(|(a, b)| ((of(a, b) - contrast).abs(), (a, b))).reduce(|a, b| if b.0 < a.0 { b } else { a });
        let (off, count) = nearest.unwrap();
        assert!(off < 1e-3, "{contrast}: {off} off {count:?} of 7 and {protected}");
        seen.insert(count);
    }
    assert!(seen.len() > 5, "{seen:?}");
}

/// A crystal simulated whole says what its half does, whatever ends it, struck by a pulse or a flat: to rounding, which grows over 70 us as it does between
/// the half and a second code (10⁻⁸). A piece and its mirror image score alike.
#[test]
fn the_whole_says_what_the_half_does_in_space() {
    let cases = [
        ("hcp", "[\"mirror\", \"period\"]"),
        ("fcc-111", "\"period\""),
        ("hcp", "[\"wall\", \"free\"]"),
        ("fcc-111", "[\"free\", \"wall\"]"),
    ];
    for (packing, sides) in cases {
        let text = SMALL.replace("\"hcp\"", &format!("\"{packing}\"")).replace("[\"mirror\", \"period\"]", sides);
        let design = design(&text);
        let (_, materials) = design.propose_in_space().unwrap();
        let n = materials.len();
        let thrown = Strike::Projectile(Projectile { mass: 0.3, speed: 20.0, front: None });
        let mut all = Vec::new();
        for strike in [design.impact, thrown] {
            let half = LoadCase::from(strike);
            all.extend([half.clone(), LoadCase { halves_differ: true, ..half }]);
        }
        let mut rng = Rng::new(3);
        let own: Vec<f64> = (0..2 * n).map(|_| 1.0 - 1e-3 * rng.unit()).collect();
        // A sphere on a plane of symmetry is its own image.
        let mut image = own.clone();
        for (site, &copies) in design.lattice.copies().iter().enumerate() {
            if copies == 2 {
                image.swap(site, n + site);
            }
        }
        for radii in [own, image] {
            let imperfection = Imperfection { radii, ..Imperfection::default() };
            all.push(LoadCase { imperfection, ..LoadCase::from(design.impact) });
        }
        let runs = runs(&design, &all, &materials, Overrides { step: Some(1e-7), ..Overrides::default() });
        for pair in runs.chunks(2) {
            let [a, b] = [&pair[0].scores, &pair[1].scores];
            for (a, b) in [(a.focal_mean, b.focal_mean), (a.protected_mean, b.protected_mean)] {
                assert!((a / b - 1.0).abs() < 1e-8, "{packing} {sides}: {a} {b}");
            }
            assert_eq!(pair[0].scores.focal_gain.is_some(), pair[1].scores.focal_gain.is_some());
        }
        assert!(
            (runs[4].scores.focal_mean / runs[0].scores.focal_mean - 1.0).abs() > 1e-3,
            "scattered radii change nothing"
        );
    }
}

/// Under a law without rates all follows from similarity: twice the diameter, under four times the force, is twice as slow and has eight times the energy; four times
/// the density is twice as slow and has the same. To rounding, which 600 steps let grow by no more than four digits.
#[test]
fn pieces_in_space_obey_similarity() {
    let small = SMALL.replace("\"thesis\"", "\"thornton\"");
    let first = design(&small);
    let large = design(&small.replace("6.35 mm", "12.7 mm"));
    let (_, materials) = first.propose_in_space().unwrap();
    let n = materials.len();
    let mut rng = Rng::new(5);
    let mut radii: Vec<f64> = (0..2 * n).map(|_| 1.0 - 1e-3 * rng.unit()).collect();
    (radii[n / 3], radii[n + n / 2]) = (0.0, 0.0);
    let imperfection = Imperfection {
        alphabet: vec![0, 1],
        wrong: vec![(n / 4, 1), (n + n / 4, 1)],
        radii,
        ..Imperfection::default()
    };
    let dense: Vec<_> = first
        .palette()
        .into_iter()
        .map(|mut material| {
            material.density *= 4.0;
            material
        })
        .collect();
    let case = |force: f64, duration: f64, imperfection: Imperfection| {
        let strike = Strike::Pulse(ForcePulse { force, duration });
        LoadCase { imperfection, ..LoadCase::from(strike) }
    };
    let given = |by: f64| Overrides { step: Some(by * 1e-7), window: Some(by * 60e-6), ..Overrides::default() };
    let drawn = runs(&first, &[case(20e3, 20e-6, imperfection.clone())], &materials, given(1.0));
    let larger = runs(&large, &[case(80e3, 40e-6, imperfection.clone())], &materials, given(2.0));
    let imperfection = Imperfection { materials: dense, ..imperfection };
    let slower = runs(&first, &[case(20e3, 40e-6, imperfection)], &materials, given(2.0));
    let of = |runs: &[Evaluated]| [runs[0].scores.focal_mean, runs[0].scores.protected_mean];
    for (found, factor) in [(&larger, 8.0), (&slower, 1.0)] {
        for (found, drawn) in of(found).into_iter().zip(of(&drawn)) {
            assert!((found / (factor * drawn) - 1.0).abs() < 1e-12, "{factor}: {found} {drawn}");
        }
    }
    assert!(of(&drawn).iter().all(|&energy| energy > 1e-3), "{drawn:?}");
}

/// Scattered spheres side by side have the bits of a single run, at every width.
#[test]
fn scattered_spheres_in_space_have_the_bits_of_single_runs() {
    let design = design(SMALL);
    let (_, materials) = design.propose_in_space().unwrap();
    let layout = Layout { lattice: design.lattice.clone(), palette: design.palette(), materials };
    let plan =
        Plan::in_space(&design, Overrides { step: Some(2e-7), ..Overrides::default() }, &layout.palette).unwrap();
    let impact = impact_in_space(&design, &plan);
    let mut rng = Rng::new(9);
    let samples: Vec<_> = (0..3)
        .map(|k| {
            let mut sample = layout.sample_in_space();
            for (i, sphere) in sample.spheres.iter_mut().enumerate().filter(|_| k > 0) {
                sphere.radius *= if i % 89 == k { 0.0 } else { 1.0 - 1e-3 * rng.unit() };
            }
            sample
        })
        .collect();
    let never = Context::default();
    let strikes = vec![impact.strike(); samples.len()];
    let single: Vec<_> = samples.iter().map(|sample| simulate(sample, &impact, &never).unwrap()).collect();
    for width in Width::available() {
        let batch = simulate_batch_under(&samples, &impact, &strikes, None, None, width, &never).unwrap();
        for (one, record) in batch.iter().zip(&single) {
            assert_eq!((&one.stop, &record.stop), (&None, &None));
            assert!(one.max_kinetic == record.max_kinetic, "{width:?}");
        }
    }
}

/// A scattered piece is followed alike by the machine of lanes and by rigs, which look for contacts by themselves: to rounding, which behind gaps grows by some more digits.
#[test]
fn scattered_spheres_in_space_move_as_in_a_rig() {
    let design = design(&SMALL.replace("\"period\"]", "\"free\"]"));
    let (_, materials) = design.propose_in_space().unwrap();
    let layout = Layout { lattice: design.lattice.clone(), palette: design.palette(), materials };
    let given = Overrides { step: Some(1e-7), ..Overrides::default() };
    let plan = Plan::in_space(&design, given, &layout.palette).unwrap();
    let impact = impact_in_space(&design, &plan);
    let mut sample = layout.sample_in_space();
    let mut rng = Rng::new(11);
    for sphere in &mut sample.spheres {
        sphere.radius *= 1.0 - 1e-3 * rng.unit();
    }
    let never = Context::default();
    let ours = simulate(&sample, &impact, &never).unwrap();
    let rig = simulate_as_rig(&sample, &impact, None, &never).unwrap();
    assert_eq!((&ours.stop, &rig.stop), (&None, &None));
    let most = ours.max_kinetic.iter().copied().fold(0.0, f64::max);
    for (k, (a, b)) in ours.max_kinetic.iter().zip(&rig.max_kinetic).enumerate() {
        assert!((a - b).abs() < 1e-6 * most, "sphere {k}: {a} {b}");
    }
}

/// Of nothing that turns out otherwise every piece is the layout as drawn, with the scores of `check` to the bit; so under a projectile.
#[test]
fn pieces_in_space_are_the_layout_of_check() {
    let desk = Desk::new();
    desk.write("space.toml", SMALL);
    let pulse = "kind = \"force-pulse\"\nforce = \"20 kN\"\nduration = \"20 us\"";
    desk.write("thrown.toml", SMALL.replace(pulse, "kind = \"projectile\"\nmass = \"300 g\"\nspeed = \"20 m/s\""));
    desk.run(&["design", "space.toml", "--out", "lens.csv"]).ok();
    desk.write("drawn.toml", "format = 1\nsamples = 2\n");
    for file in ["space.toml", "thrown.toml"] {
        let checked = desk.run(&["check", "lens.csv", "--design", file, "--json"]).ok().json();
        let out = file.replace(".toml", "");
        desk.run(&["tolerance", "lens.csv", "--design", file, "--tolerances", "drawn.toml", "--out", &out]).ok();
        let pieces = desk.read(&format!("{out}/pieces.csv"));
        let mut lines = pieces.lines().skip(1);
        let names: Vec<&str> = lines.next().unwrap().split(',').collect();
        assert_eq!(pieces.lines().count(), 4);
        for line in lines {
            for key in ["focal_mean_J", "protected_mean_J", "contrast", "focal_gain", "protection"] {
                let column = names.iter().position(|name| *name == key).unwrap_or_else(|| panic!("{key}: {names:?}"));
                let value: f64 = line.split(',').nth(column).unwrap().parse().unwrap();
                assert_eq!(Some(value), checked[key].as_f64(), "{file} {key}");
            }
        }
    }
}

/// Pieces go on, to the same bits for any number of threads, and are struck by a flat in place of the pulse where the file says so; what else may turn out otherwise
/// moves no value.
#[test]
fn pieces_in_space_are_kept_and_gone_on_from() {
    let desk = toy();
    desk.write(
        "all.toml",
        "format = 1\n[diameter]\ngrade = \"G200\"\n[material]\ndensity = \"1 %\"\nyoungs_modulus = \"2 %\"\n[piece]\nwrong = \"5 %\"\nvacancies = \"2 %\"\n[impact]\nforce = \"5 %\"\nduration = \"5 %\"\n\
         projectile_mass = \"80 mg\"\nprojectile_speed = \"1 m/s\"\n",
    );
    let all = |more: &[&str]| asked(&desk, &[&["--tolerances", "all.toml"], more].concat());
    all(&["--samples", "3", "--out", "kept"]);
    let short = desk.read("kept/pieces.csv");
    let more = all(&["--samples", "7", "--out", "kept"]);
    let once = all(&["--samples", "7", "--out", "once", "--threads", "1"]);
    let rest = |text: &str| text.lines().skip(1).map(str::to_owned).collect::<Vec<_>>();
    assert_eq!(rest(&desk.read("kept/pieces.csv")), rest(&desk.read("once/pieces.csv")));
    assert!(rest(&desk.read("once/pieces.csv")).starts_with(&rest(&short)));
    for key in ["yield", "interval", "sensitivity", "distribution"] {
        assert_eq!(more[key], once[key], "{key}");
    }
    let names: Vec<&str> = more["quantities"].as_array().unwrap().iter().filter_map(|q| q["name"].as_str()).collect();
    assert!(["diameter.lot", "wrong", "impact.projectile"].iter().all(|name| names.contains(name)), "{names:?}");
    assert!(desk.read("kept/report.html").contains("<svg"));
    let column = |text: &str, name: &str| -> Vec<String> {
        let mut lines = text.lines().skip(1);
        let at = lines.next().unwrap().split(',').position(|known| known == name).unwrap();
        lines.map(|line| line.split(',').nth(at).unwrap().to_owned()).collect()
    };
    desk.write("all.toml", "format = 1\n[material]\ndensity = \"1 %\"\n");
    all(&["--samples", "3", "--out", "alone"]);
    let (few, many) = (desk.read("alone/pieces.csv"), short);
    assert_eq!(column(&few, "density:brass-260"), column(&many, "density:brass-260"));
}

/// A plate so light that it is gone before the spheres it strikes have moved on: each sphere of layer 1 gets the energy of an elastic collision with its share μ of
/// the plate, ½ m (2 μ v/(m + μ))², as in a sheet; what is lost to layer 2 meanwhile is below a percent.
#[test]
fn a_light_plate_gives_layer_1_what_an_elastic_collision_does() {
    let desk = toy();
    desk.write("steel.csv", desk.read("toy.csv").replace("brass-260", "stainless-440c"));
    let spheres = 8.0 * 10.0;
    desk.write(
        "plate.toml",
        format!(
            "format = 1\n[impact]\nprojectile_mass = \"{spheres} mg\"\nprojectile_speed = \"1 m/s\"\n\
             [thresholds]\nfocal_mean = {{ min = \"1e-12 J\" }}\n"
        ),
    );
    let given = ["tolerance", "steel.csv", "--design", "toy.toml", "--tolerances", "plate.toml", "--samples", "2"];
    let told = desk.run(&[&given[..], &["--step", "1e-8 s", "--window", "6 us", "--json"]].concat()).ok().json();
    let change = told["sensitivity"].as_array().unwrap().iter().find(|change| change["score"] == "focal_mean").unwrap();
    assert_eq!(change["quantity"], "impact.projectile");
    let found = change["at"][1].as_f64().unwrap();
    let mass = 7650.0 * std::f64::consts::PI / 6.0 * 6e-3_f64.powi(3);
    let speed = 2.0 * 1e-6 / (mass + 1e-6);
    let expected = 0.5 * mass * speed * speed;
    assert!((found / expected - 1.0).abs() < 0.01, "{found} J, expected {expected} J");
}

/// Of 12 pieces of 12 Wilson's interval begins at 75.7 %, so that three sets are ordered, as of a sheet.
#[test]
fn spares_of_a_crystal_follow_from_its_yield() {
    let desk = toy();
    desk.write(
        "asked.toml",
        "format = 1\nsamples = 12\n[diameter]\ngrade = \"G100\"\n[thresholds]\ncontrast = { min = 1e-3 }\n",
    );
    asked(&desk, &["--tolerances", "asked.toml", "--out", "easy"]);
    let given = ["build", "toy.csv", "--design", "toy.toml", "--out", "shop", "--yield", "easy", "--json"];
    let told = desk.run(&given).ok().json();
    assert_eq!(told["spares"]["sets"], 3, "{told}");
    for part in told["parts"].as_array().unwrap() {
        let count = part["count"].as_u64().unwrap();
        assert_eq!(part["spares"], count.div_ceil(20) + 2 * count);
    }
}

/// What is of sheets is refused, with the line where it stands.
#[test]
fn what_is_of_sheets_is_refused_in_space() {
    let desk = toy();
    for (slip, line, words) in [
        ("format = 1\nstate = \"settled\"\n", 2, "nominal-sites"),
        ("format = 1\n[frame]\nside_gap = \"1 um\"\n", 3, "on their sites"),
        ("format = 1\n[contact]\nfriction = 0.1\n", 3, "on their sites"),
        ("format = 1\n[impact]\nangle = \"1 deg\"\n", 3, "straight"),
        ("format = 1\n[impact]\noff_centre = \"1 D\"\n", 3, "straight"),
    ] {
        desk.write("slip.toml", slip);
        let ran = desk.run(&["tolerance", "toy.csv", "--design", "toy.toml", "--tolerances", "slip.toml", "--json"]);
        let error = ran.json_error();
        assert!(ran.code == 2 && error["line"] == line, "{slip}: {error}");
        assert!(error["help"].to_string().contains(words), "{slip}: {error}");
    }
    let ran = desk.run(&["tolerance", "toy.csv", "--design", "toy.toml", "--sites"]);
    assert!(ran.code == 2 && ran.stderr.contains("--sites is for sheets"), "{}", ran.stderr);
    // The rest is as in a sheet; friction has no rungs.
    let json = asked(&desk, &["--samples", "20", "--indices", "--for", "90 %", "--rechoose", "2"]);
    let of: Vec<&str> =
        json["inverse"]["found"].as_array().unwrap().iter().filter_map(|one| one["quantity"].as_str()).collect();
    assert_eq!(of, ["diameter.grade", "wrong"]);
    assert!(json["indices"].as_array().unwrap().iter().any(|one| one["quantity"] == "diameter.lot"));
    assert_eq!(json["rechoose"]["pieces"], 64);
    assert!(json["yield_of"].as_str().unwrap().starts_with("contrast above the best baseline's"), "{json}");
    let cost = desk.run(&["tolerance", "toy.csv", "--design", "toy.toml", "--dry-run", "--json"]).ok().json();
    assert_eq!((&cost["dry_run"], &cost["parts"][1]["count"]), (&true.into(), &500.into()));
}

/// The gate has its lines in space but for frame, stack and interfaces, with the numbers of `check`; under another law a layout scores as a design under that law does.
#[test]
fn the_gate_and_laws_in_space() {
    let desk = Desk::new();
    desk.write("space.toml", SMALL);
    desk.write("mdr.toml", SMALL.replace("\"thesis\"", "\"mdr-static\""));
    desk.run(&["design", "space.toml", "--out", "lens.csv"]).ok();
    let check = |more: &[&str]| desk.run(&[&["check", "lens.csv", "--design", "space.toml", "--json"], more].concat());
    let json = check(&["--gate", "--laws", "mdr-static", "--yield", "60 %", "--samples", "4"]).ok().json();
    let lines = json["gate"]["lines"].as_array().unwrap();
    let names: Vec<&str> = lines.iter().filter_map(|line| line["check"].as_str()).collect();
    for check in [
        "diameter in stock",
        "materials in stock",
        "half the step",
        "twice the window",
        "threshold contrast",
        "yield as built",
        "impact on brass-260",
        "overlaps",
        "C against baselines",
        "elastic-plastic laws",
        "force behind",
        "impulse behind",
        "second blow",
    ] {
        assert!(names.contains(&check), "{check}: {names:?}");
    }
    assert!(!names.iter().any(|name| name.contains("frame") || name.contains("gravity") || name.contains("angles")));
    let of = |check: &str| lines.iter().find(|line| line["check"] == check).unwrap();
    // What the design asks is missed, and so the gate fails; the window is far too short for what comes later.
    assert_eq!((&of("threshold contrast")["word"], &json["gate"]["word"]), (&"fail".into(), &"fail".into()));
    assert_eq!(of("half the step")["word"], "pass", "{}", of("half the step"));
    // What is missed as drawn is missed by all four, of which at most 49 % of all pieces can be believed (Wilson).
    assert_eq!(of("yield as built")["word"], "fail", "{}", of("yield as built"));
    // The whole crystal is two halves.
    let far = granulens::units::Dimension::Force.show(2.0 * json["far_force_N"].as_f64().unwrap());
    let number = of("force behind")["number"].as_str().unwrap();
    assert_eq!(number, format!("{far} on the last layer of the whole piece"));
    let compared = desk.run(&["compare", "space.toml", "lens.csv", "--json"]).ok().json();
    let verdict = compared["verdict"].as_array().unwrap().iter().find(|v| v["measure"] == "contrast").unwrap();
    let value = format!("{:.4}", verdict["value"].as_f64().unwrap());
    assert!(of("C against baselines")["number"].as_str().unwrap().starts_with(&value), "{verdict}");
    let mdr = desk.run(&["check", "lens.csv", "--design", "mdr.toml", "--json"]).ok().json();
    let under = &json["laws"]["each"][0];
    for key in ["contrast", "focal_gain", "protection"] {
        assert!(under[key].is_number() && under[key] == mdr[key], "{key}: {under} {mdr}");
    }
    let frame = check(&["--gate", "--frame-width", "1 m"]);
    assert!(frame.code == 2 && frame.stderr.contains("frame") && frame.stderr.contains("in space"), "{}", frame.stderr);
    assert_eq!(check(&["--strict"]).code, 3);
}
