//! `tolerance`: what a layout is worth once a workshop has made it.

use std::fmt::Write as _;

use granulens::Context;
use granulens::design::Design;
use granulens::evaluate::{
    Evaluator, Frame, ImpactLoad, Imperfection, LoadCase, Overrides, Plan, held_energies, held_spheres,
};
use granulens::layout;
use granulens::score::means;
use serde_json::Value;

use super::{Desk, shipped};

/// Row 1 alone is looked at, and the pulse is over before its spheres have pressed anything: each has then the energy J²/2m, and C is the mass of a
/// brass sphere over that of a steel one.
const TOY: &str = r#"format = 1
name = "toy"
[crystal]
packing = "hexagonal-2d"
diameter = "6 mm"
rows = 4
half_width = 4
sides = "mirror"
host = "stainless-440c"
law = "hertz"
[impact]
kind = "force-pulse"
force = "26 kN"
duration = "0.1 us"
[target]
focus = { rows = [1, 1], x = ["0 D", "1 D"] }
protect = { rows = [1, 1], x = ["3 D", "4 D"] }
[run]
window = "1 us"
[compare]
material = "brass-260"
"#;

const RATIO: f64 = 8530.0 / 7650.0;

fn toy() -> Desk {
    let desk = Desk::new();
    desk.write("toy.toml", TOY);
    let mut text = "row,column,x,z,diameter,material\n".to_owned();
    for row in 1..=4 {
        let first = if row % 2 == 1 { 0.0 } else { 0.5 };
        let columns = if row % 2 == 1 { 5 } else { 4 };
        for column in 1..=columns {
            let x = first + f64::from(column - 1);
            let material = if x < 2.0 { "stainless-440c" } else { "brass-260" };
            let z = f64::from(row - 1) * 0.75_f64.sqrt() * 6e-3;
            let _ = writeln!(text, "{row},{column},{},{z},0.006,{material}", x * 6e-3);
        }
    }
    desk.write("toy.csv", text);
    desk
}

fn asked(desk: &Desk, more: &[&str]) -> Value {
    desk.run(&[&["tolerance", "toy.csv", "--design", "toy.toml", "--json"], more].concat()).ok().json()
}

/// With densities within d of what they should be, all alike: C = C₀ (1 + u)/(1 + v). To the limits C changes by C₀ d and C₀ d/(1 − d), both straight enough; by
/// root-sum-square its deviation is C₀ √(2/3) d, but for d². A share (1 − t/2d)²/2 of pieces is above C₀ (1 + t), but for terms of d.
#[test]
fn two_materials_do_what_their_masses_say() {
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
        (found["change"].as_f64().unwrap(), found["linear"].as_bool().unwrap())
    };
    // A blow of a ten millionth of a second presses contacts by a tenth of a micrometre: a hundred thousandth of its force.
    let (brass, steel) = (change("density:brass-260"), change("density:stainless-440c"));
    assert!((brass.0.abs() / (RATIO * d) - 1.0).abs() < 1e-3 && brass.1, "{brass:?}");
    assert!((steel.0 / (RATIO * d / (1.0 - d)) - 1.0).abs() < 1e-3 && steel.1, "{steel:?}");
    // As the derivative has it, C ∝ ρ of brass over that of steel.
    for (quantity, sign) in [("density:brass-260", 1.0), ("density:stainless-440c", -1.0)] {
        let one = found(&json, quantity, "contrast");
        let by_derivative = one["by_derivative"].as_f64().unwrap();
        assert!((by_derivative / (sign * RATIO * d) - 1.0).abs() < 1e-4 && one["believed"] == "derivative", "{one}");
    }
    let built = &json["as_built"][0];
    assert_eq!((&built["score"], &built["refused"]), (&"contrast".into(), &Value::Null));
    let rss = built["rss"].as_f64().unwrap();
    // Exact but for the ten millionth of a second, since derivatives know no limits.
    assert!((rss / (RATIO * d * (2.0_f64 / 3.0).sqrt()) - 1.0).abs() < 1e-4, "{rss}");
    let [low, high] = [0, 1].map(|end| json["interval"][end].as_f64().unwrap());
    let exact = 0.5 * (1.0 - t / (2.0 * d)).powi(2);
    assert!((low..=high).contains(&exact) && high - low < 0.1, "{exact} not in {low} to {high}");
    assert_eq!((&json["samples"], &json["seed"]), (&400.into(), &1.into()));
}

fn found(json: &Value, quantity: &str, score: &str) -> Value {
    let all = json["sensitivity"].as_array().unwrap();
    let one = all.iter().find(|one| one["quantity"] == quantity && one["score"] == score);
    one.unwrap_or_else(|| panic!("{quantity}, {score}: {json}")).clone()
}

/// While a wave comes through once the change of G from limit to limit is what derivatives, summed over the spheres of a material and averaged over the
/// forces, say: to what the means over the forces are known to, and to the curvature, which over limits of a hundredth is of the order of a hundredth of
/// the change. With every quantity that has a derivative, and the load on the uniform crystals that G refers to.
#[test]
fn derivatives_and_pieces_say_the_same_while_the_wave_passes_once() {
    let desk = Desk::with_layout();
    desk.write(
        "all.toml",
        "format = 1\nsamples = 4\n[material]\ndensity = \"1 %\"\nyoungs_modulus = \"1 %\"\nyield_stress = \"1 %\"\n[impact]\nforce = \"1 %\"\n",
    );
    let asked = |window: &str| {
        let all = ["tolerance", "small.csv", "--design", "small.toml", "--tolerances", "all.toml", "--json"];
        desk.run(&[&all[..], &["--window", window]].concat()).ok().json()
    };
    let json = asked("45 us");
    let of = |one: &Value, key: &str| one[key].as_f64().unwrap();
    let half = |one: &Value| 0.5 * (one["at"][1].as_f64().unwrap() - one["at"][0].as_f64().unwrap());
    let materials = ["stainless-440c", "brass-260"];
    let kinds = ["density", "youngs_modulus", "yield_stress"];
    let names = kinds.iter().flat_map(|kind| materials.map(|material| format!("{kind}:{material}")));
    let mut squares = 0.0;
    for name in names.chain(["impact.force".to_owned()]) {
        let one = found(&json, &name, "focal_gain");
        let (derivative, half) = (of(&one, "by_derivative"), half(&one));
        let known_to = 0.5 * of(&one, "noise") + 0.05 * half.abs();
        assert!((derivative - half).abs() <= known_to, "{one}");
        assert_eq!(one["believed"], "derivative", "{one}");
        squares += derivative * derivative / 3.0;
    }
    // F follows the force by more: what G refers to is struck alike.
    let alone =
        ["sensitivity", "small.csv", "--design", "small.toml", "--of", "focal_mean", "--window", "45 us", "--json"];
    let alone = desk.run(&alone).ok().json()["sensitivities"][0]["d_force"].as_f64().unwrap();
    let force = found(&json, "impact.force", "focal_gain");
    let of_gain = of(&force, "by_derivative") / (of(&force, "change") / of(&force, "relative")) / 0.01;
    assert!(alone > of_gain.abs() + 0.5, "F by the force: {alone}, G: {of_gain}");
    let built = json["as_built"].as_array().unwrap().iter().find(|built| built["score"] == "focal_gain").unwrap();
    assert!(built["refused"].is_null() && (of(built, "rss") / squares.sqrt() - 1.0).abs() < 1e-12, "{built}");
    // What has gone to and fro many times is believed from limit to limit, and what bends is refused as before.
    let long = asked("150 us");
    let all = long["sensitivity"].as_array().unwrap();
    assert!(all.iter().any(|one| one["believed"] == "secant"), "{long}");
    // Rigs have none.
    let settled =
        desk.read("all.toml").replace("format = 1", "format = 1\nstate = \"settled\"").replace("density = \"1 %\"", "");
    desk.write("settled.toml", settled);
    let settled = ["tolerance", "small.csv", "--design", "small.toml", "--tolerances", "settled.toml", "--json"];
    let json = desk.run(&[&settled[..], &["--window", "45 us"]].concat()).ok().json();
    assert!(json["no_derivatives"].as_str().unwrap().contains("rigs"), "{json}");
    assert!(json["sensitivity"].as_array().unwrap().iter().all(|one| one["believed"] == "secant"));
}

/// 60 pieces go on from 20, to the last bit what 60 at once are, on any number of threads; other thresholds are asked of the same pieces.
#[test]
fn pieces_are_kept_and_gone_on_from() {
    let desk = toy();
    desk.write("all.toml", "format = 1\n[diameter]\ngrade = \"G200\"\n[material]\ndensity = \"1 %\"\nyoungs_modulus = \"2 %\"\n[piece]\nwrong = \"5 %\"\nvacancies = \"2 %\"\n[contact]\nfriction = [0.0, 0.2]\n[impact]\nforce = \"5 %\"\nangle = \"2 deg\"\n");
    let all = ["--tolerances", "all.toml"];
    let first = asked(&desk, &[&all[..], &["--samples", "20", "--out", "kept"]].concat());
    let short = desk.read("kept/pieces.csv");
    let more = asked(&desk, &[&all[..], &["--samples", "60", "--out", "kept"]].concat());
    let whole = asked(&desk, &[&all[..], &["--samples", "60", "--out", "once", "--threads", "1"]].concat());
    assert_eq!(
        desk.read("kept/pieces.csv").lines().skip(1).collect::<Vec<_>>(),
        desk.read("once/pieces.csv").lines().skip(1).collect::<Vec<_>>()
    );
    assert!(
        desk.read("once/pieces.csv")
            .lines()
            .skip(1)
            .collect::<Vec<_>>()
            .starts_with(&short.lines().skip(1).collect::<Vec<_>>())
    );
    for key in ["yield", "interval", "samples", "sensitivity", "seed", "distribution"] {
        assert_eq!(more[key], whole[key], "{key}");
    }
    assert_eq!((&first["samples"], &whole["samples"]), (&20.into(), &60.into()));
    assert!(desk.names().iter().all(|name| !name.starts_with(".granulens-")));
    for name in ["pieces.csv", "tolerance.json", "report.html"] {
        assert!(desk.path("kept").join(name).exists(), "{name}");
    }
    assert!(desk.read("kept/report.html").contains("<svg"));
    // Thresholds are no part of a piece.
    let pieces = desk.read("kept/pieces.csv");
    desk.write("toy.toml", format!("{TOY}[thresholds]\ncontrast = {{ min = 1e-6 }}\n"));
    let moved = asked(&desk, &[&all[..], &["--samples", "60", "--out", "kept"]].concat());
    assert_eq!(moved["yield_of"], "contrast at least 0.000001");
    assert_eq!(desk.read("kept/pieces.csv"), pieces);
    // Other pieces are not mixed with these.
    let other = desk.run(&[
        "tolerance",
        "toy.csv",
        "--design",
        "toy.toml",
        "--tolerances",
        "all.toml",
        "--seed",
        "2",
        "--out",
        "kept",
    ]);
    assert!(other.code == 2 && other.stderr.contains("holds pieces of something else"), "{}", other.stderr);
    assert_eq!(desk.read("kept/pieces.csv"), pieces);
}

/// What is assumed is said, what the yield is of too, and what is wrong with a file of tolerances is told with its line.
#[test]
fn assumptions_are_said_and_slips_are_answered() {
    let desk = toy();
    let json = asked(&desk, &["--samples", "20"]);
    let assumed = json["assumed"].to_string();
    assert!(assumed.contains("grade G100") && assumed.contains("ISO 3290-1"), "{assumed}");
    assert!(json["yield_of"].as_str().unwrap().starts_with("contrast above the best baseline's"), "{json}");
    assert!(json["interval_method"] == "Wilson score, 95 %" && json["baseline"]["contrast"].is_f64());
    let text = desk.run(&["tolerance", "toy.csv", "--design", "toy.toml", "--samples", "20"]).ok().stdout;
    assert!(text.contains("yield: ") && text.contains("contrast above the best baseline's"), "{text}");
    for (slip, line, words) in [
        ("format = 1\n[diameter]\ngrade = \"G7\"\n", 3, "is no known grade of balls"),
        ("format = 1\n[piece]\nwrong = \"70 %\"\n", 3, "must lie between 0 and 50 %"),
        ("format = 1\nstate = \"lying\"\n", 2, "is no known state of the piece"),
        ("format = 1\n[contact]\nfriction = [0.3, 0.1]\n", 3, "the smaller number first"),
        ("format = 1\n[piece]\nholes = \"1 %\"\n", 3, "is no known key"),
    ] {
        desk.write("slip.toml", slip);
        let ran = desk.run(&["tolerance", "toy.csv", "--design", "toy.toml", "--tolerances", "slip.toml", "--json"]);
        let error = ran.json_error();
        assert!(
            ran.code == 2 && error["line"] == line && error["message"].to_string().contains(words),
            "{slip}: {error}"
        );
    }
    let cost = desk.run(&["tolerance", "toy.csv", "--design", "toy.toml", "--dry-run", "--json"]).ok().json();
    assert_eq!((&cost["dry_run"], &cost["parts"][1]["count"]), (&true.into(), &500.into()));
}

/// Sites, indices, the inverse and what measuring wins are told where they are asked for.
#[test]
fn what_is_asked_for_is_told() {
    let desk = toy();
    let json =
        asked(&desk, &["--samples", "40", "--sites", "--indices", "--for", "90 %", "--rechoose", "2", "--out", "all"]);
    assert_eq!(json["sites"]["each"].as_array().unwrap().len(), 5 + 4 + 5 + 4);
    let worst = &json["sites"]["worst"];
    // Brass in the place of steel in the focus: its energy is less by the ratio of masses, on one of the two or three spheres there.
    assert!(worst["row"] == 1 && worst["change"].as_f64().unwrap() < -0.01, "{worst}");
    assert!(json["indices"].as_array().unwrap().iter().any(|one| one["quantity"] == "diameter.lot"));
    assert_eq!(json["inverse"]["found"].as_array().unwrap().len(), 3);
    assert_eq!(json["rechoose"]["pieces"], 64);
    for name in ["sites.csv", "sites.svg"] {
        assert!(desk.path("all").join(name).exists(), "{name}");
    }
}

/// Settled in the frame spheres lie otherwise, and pieces are rigs; the words say so.
#[test]
fn pieces_settle_in_their_frame() {
    let desk = toy();
    desk.write("settled.toml", "format = 1\nstate = \"settled\"\nsamples = 4\n[diameter]\ngrade = \"G100\"\n");
    let json = asked(&desk, &["--tolerances", "settled.toml"]);
    assert_eq!((&json["state"], &json["stopped"]), (&"settled".into(), &0.into()), "{json}");
    // Diameters differ by parts in a thousand at most, masses by three times that.
    let mean = json["distribution"]["contrast"]["mean"].as_f64().unwrap();
    assert!((mean / RATIO - 1.0).abs() < 0.02, "{mean}");
}

/// The scattered radii of docs/optimiser.md: radii evenly up to 0.1 % too small, both halves alike. Lanes and rigs, which find their contacts, agree on what
/// that costs; the motion behind a lens is chaotic, so that single crystals scatter by a percent and more, their median by less.
#[test]
fn fast_and_slow_ways_agree_on_scattered_radii() {
    let design = Design::read(shipped("designs/quickstart.toml")).unwrap();
    let drawn =
        layout::read(shipped("studies/four-materials-best.csv").as_ref(), &design.lattice, &design.palette(), &[])
            .unwrap();
    let going = Context::default();
    let overrides =
        Overrides { integrator: Some(granulens::dem::Integrator::Verlet), step: Some(1e-7), ..Overrides::default() };
    let plan = Plan::new(&design, overrides, &drawn.palette).unwrap();
    let sites = drawn.materials.len();
    let mut rng = granulens::search::Rng::new(20);
    let mut imperfections = vec![Imperfection::default()];
    imperfections.extend((0..6).map(|_| Imperfection {
        radii: (0..sites).map(|_| 1.0 - 1e-3 * rng.unit()).collect(),
        ..Imperfection::default()
    }));
    let load = ImpactLoad::from(design.impact);
    let cases: Vec<LoadCase> = imperfections
        .iter()
        .map(|imperfection| LoadCase { imperfection: imperfection.clone(), ..LoadCase::from(load) })
        .collect();
    let evaluator = Evaluator::new(&design, &cases, drawn.palette.clone(), overrides, &going).unwrap();
    let fast: Vec<f64> = evaluator.scores(std::slice::from_ref(&drawn.materials), &going).unwrap()[0]
        .iter()
        .map(|run| run.scores.contrast.unwrap())
        .collect();
    let slow: Vec<f64> = imperfections
        .iter()
        .map(|imperfection| {
            let mut spheres = held_spheres(&drawn);
            for sphere in &mut spheres {
                sphere.diameter *= imperfection.radii.get(sphere.site).unwrap_or(&1.0);
            }
            let held = (Frame::Mirrors, &load, None);
            let energies = held_energies((&design, &plan), &drawn.palette, spheres, held, &going).unwrap();
            let [focal, protected] = means(&energies, &design.lattice, &design.target);
            focal / protected
        })
        .collect();
    let median = |values: &[f64]| {
        let mut lost: Vec<f64> = values[1..].iter().map(|value| 1.0 - value / values[0]).collect();
        lost.sort_by(f64::total_cmp);
        0.5 * (lost[2] + lost[3])
    };
    let [fast_lost, slow_lost] = [&fast, &slow].map(|values| median(values));
    assert!((fast[0] / slow[0] - 1.0).abs() < 0.01, "as drawn: {} and {}", fast[0], slow[0]);
    assert!((fast_lost - slow_lost).abs() < 0.01, "{fast:?}\n{slow:?}");
    // As the table has it, to the spread of its crystals.
    assert!((0.10..=0.15).contains(&fast_lost), "{fast_lost}");
}

/// A plate so light that it is gone before the spheres it strikes have moved on: each sphere of row 1 gets the energy of an elastic collision with
/// its share μ of the plate, ½ m (2 μ v/(m + μ))². The collision lasts 1 us, the way to row 2 60 us; what is lost to it is below a percent.
#[test]
fn a_light_plate_gives_row_1_what_an_elastic_collision_does() {
    let desk = Desk::with_layout();
    let small = super::SMALL.replace("host = ", "law = \"hertz\"\nhost = ").replace("rows = [8, 10]", "rows = [1, 1]");
    let small = small.replace("20 us", "1 us");
    let (before, after) = (small.split("[lens]").next().unwrap(), small.split("[run]").nth(1).unwrap());
    desk.write("row.toml", format!("{before}[run]{after}"));
    // Nine spheres of row 1 between sides that repeat themselves after nine diameters.
    desk.write(
        "plate.toml",
        "format = 1\nhalves = \"alike\"\n[impact]\nprojectile_mass = \"9 mg\"\nprojectile_speed = \"1 m/s\"\n\
         [thresholds]\nfocal_mean = { min = \"1e-12 J\" }\n",
    );
    let host = desk.read("small.csv").replace("brass-260", "stainless-440c");
    desk.write("host.csv", host);
    let asked = ["tolerance", "host.csv", "--design", "row.toml", "--tolerances", "plate.toml", "--samples", "2"];
    let told = desk.run(&[&asked[..], &["--step", "1e-8 s", "--window", "6 us", "--json"]].concat()).ok().json();
    let change = told["sensitivity"].as_array().unwrap().iter().find(|change| change["score"] == "focal_mean").unwrap();
    assert_eq!(change["quantity"], "impact.projectile");
    let found = change["at"][1].as_f64().unwrap();
    let mass = 7650.0 * std::f64::consts::PI / 6.0 * 6.35e-3_f64.powi(3);
    let speed = 2.0 * 1e-6 / (mass + 1e-6);
    // Over eight speeds within 1 %, of which the mean of ln v is that of 1.
    let expected = 0.5 * mass * speed * speed;
    assert!((found / expected - 1.0).abs() < 0.01, "{found} J, expected {expected} J");
    assert!(!change["linear"].as_bool().unwrap(), "two ways to be struck are no straight line");
    desk.write("half.toml", "format = 1\n[impact]\nprojectile_mass = \"9 mg\"\n");
    let refused = desk.run(&["tolerance", "host.csv", "--design", "row.toml", "--tolerances", "half.toml"]);
    assert!(refused.code == 2 && refused.stderr.contains("projectile_speed"), "{}", refused.stderr);
}

/// The gate's lines, and what becomes of the exit code.
#[test]
fn the_gate_tells_number_limit_and_reason() {
    let desk = Desk::with_layout();
    let gate = |more: &[&str]| desk.run(&[&["check", "small.csv", "--design", "small.toml"], more].concat());
    let json = gate(&["--gate", "--json"]).ok().json();
    let lines = json["gate"]["lines"].as_array().unwrap();
    let of = |json: &Value, check: &str| {
        let lines = json["gate"]["lines"].as_array().unwrap().clone();
        lines.into_iter().find(|line| line["check"] == check).unwrap_or_else(|| panic!("{check}: {json}"))
    };
    for line in lines {
        assert!(["pass", "warn", "fail"].contains(&line["word"].as_str().unwrap()), "{line}");
        assert!(["number", "limit", "why"].iter().all(|key| !line[*key].as_str().unwrap().is_empty()), "{line}");
    }
    for check in [
        "stack under gravity",
        "diameter in stock",
        "half the step",
        "twice the window",
        "C against baselines",
        "elastic-plastic laws",
        "second blow",
        "force behind",
    ] {
        of(&json, check);
    }
    assert_eq!(of(&json, "stack under gravity")["word"], "pass");
    assert!(gate(&[]).ok().stdout.lines().all(|line| !line.starts_with("gate: ")), "without --gate there is none");
    assert!(gate(&["--gate"]).ok().stdout.contains("gate: "));
    // A frame that is too narrow by half a diameter.
    let narrow = gate(&["--strict", "--frame-width", "3 mm", "--json"]);
    assert_eq!((narrow.code, &of(&narrow.json(), "frame, width")["word"]), (3, &"fail".into()));
    let wide = gate(&["--gate", "--frame-width", "2 m", "--json"]).ok().json();
    assert_eq!(of(&wide, "frame, width")["word"], "warn");
    let built = gate(&["--gate", "--yield", "0 %", "--samples", "8", "--json"]).ok().json();
    assert_eq!(of(&built, "yield as built")["word"], "pass");
}
