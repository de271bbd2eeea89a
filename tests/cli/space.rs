//! Designs in space: the same commands, the same rules, and what cannot be done is refused in words.

use super::{Desk, shipped};

/// A lens of 9 layers in a crystal of 1260 spheres: a second or so.
pub const SMALL: &str = r#"format = 1
name = "small-space"
[crystal]
packing = "hcp"
diameter = "6.35 mm"
layers = 9
cells = [10, 7]
axis_layer = 2
sides = ["mirror", "period"]
host = "stainless-440c"
law = "thesis"
[impact]
kind = "force-pulse"
force = "20 kN"
duration = "20 us"
[target]
focus = { layers = [7, 8], r = ["0 D", "1.1 D"] }
protect = { layers = [7, 8], r = ["4 D", "5 D"] }
[lens]
family = "plano-convex"
material = "brass-260"
apex_layer = 2
back_layer = 5
radius = "5.5 D"
max_interface_angle = "75 deg"
[run]
window = "70 us"
[compare]
seeds = 1
[thresholds]
contrast = { min = 100 }
"#;

fn desk() -> Desk {
    let desk = Desk::new();
    desk.write("space.toml", SMALL);
    desk
}

/// `design` writes a layout that `check` and `compare` read; both say what `compare` says of the lens, to the last bit; strips of 1, 2, ... layers
/// stand among the arrangements, and the verdict is against the best of them.
#[test]
fn design_check_and_compare_agree() {
    let desk = desk();
    let ran = desk.run(&["design", "space.toml", "--out", "lens.csv"]).ok();
    assert!(ran.stdout.contains("lens: layers 2 to 5, plano-convex, revolved about the axis"), "{}", ran.stdout);
    let text = desk.read("lens.csv");
    assert!(text.lines().any(|line| line == "layer,column,x,y,z,diameter,material"), "{text:.300}");
    let lens = desk.run(&["compare", "space.toml", "--forces", "2", "--json", "--out", "all.json"]).ok().json();
    let given =
        desk.run(&["compare", "space.toml", "lens.csv", "--forces", "1", "--json", "--threads", "1"]).ok().json();
    let checked =
        desk.run(&["check", "lens.csv", "--design", "space.toml", "--json", "--spheres", "felt.csv"]).ok().json();
    let first = &lens["arrangements"][0]["scores"];
    for key in ["focal_mean_J", "protected_mean_J", "contrast", "focal_gain", "protection", "piece_mass_kg"] {
        let of = |json: &serde_json::Value| json[key].as_f64();
        assert!(of(first).is_some_and(f64::is_finite), "{key} {first}");
        assert_eq!(of(first), of(&given["arrangements"][0]["scores"]), "{key}");
        if key != "piece_mass_kg" {
            assert_eq!(of(first), of(&checked), "{key}");
        }
    }
    let names: Vec<&str> = lens["arrangements"].as_array().unwrap().iter().filter_map(|a| a["name"].as_str()).collect();
    assert!(
        ["strip-1", "strip-2", "strip-3", "flat-height", "all-host"].iter().all(|name| names.contains(name)),
        "{names:?}"
    );
    let flat =
        lens["verdict"].as_array().unwrap().iter().find(|v| v["measure"] == "focal_gain" && v["against"] == "flat");
    assert!(flat.is_some_and(|verdict| verdict["spread"].is_number()), "{}", lens["verdict"]);
    // A crystal in which all is host is that alone.
    let host = lens["arrangements"].as_array().unwrap().iter().find(|a| a["name"] == "all-host").unwrap();
    assert_eq!(host["scores"]["focal_gain"].as_f64(), Some(1.0));
    assert_eq!(desk.read("felt.csv").lines().count(), text.lines().filter(|line| !line.starts_with('#')).count());
    let json = desk.json("all.json");
    assert_eq!(json["sites"].as_array().unwrap().len(), json["arrangements"][0]["layout"].as_array().unwrap().len());
    // Thresholds are judged with --strict alone.
    let strict = desk.run(&["check", "lens.csv", "--design", "space.toml", "--strict"]);
    assert_eq!(strict.code, 3, "{}", strict.stderr);
}

/// A flat strikes in place of the pulse: the design says with which force, half of it does the work on the half, verdicts are over speeds.
#[test]
fn a_projectile_strikes_a_crystal_in_space() {
    let desk = Desk::new();
    let pulse = "kind = \"force-pulse\"\nforce = \"20 kN\"\nduration = \"20 us\"";
    let with = |impact: &str| SMALL.replace(pulse, impact);
    desk.write("thrown.toml", with("kind = \"projectile\"\nmass = \"300 g\"\nspeed = \"20 m/s\""));
    let ran = desk.run(&["design", "thrown.toml", "--out", "lens.csv"]).ok();
    assert!(ran.stdout.contains("impact: a projectile of 300 g at 20 m/s, about "), "{}", ran.stdout);
    let lens = desk.run(&["compare", "thrown.toml", "--forces", "2", "--json"]).ok().json();
    assert_eq!(lens["forces_N"], serde_json::json!([]));
    let speeds: Vec<f64> = lens["speeds_m_s"].as_array().unwrap().iter().filter_map(|v| v.as_f64()).collect();
    assert!((speeds[0] - 19.8).abs() < 1e-9 && (speeds[1] - 20.2).abs() < 1e-9, "{speeds:?}");
    let checked = desk.run(&["check", "lens.csv", "--design", "thrown.toml", "--json", "--forces", "2"]).ok().json();
    let first = &lens["arrangements"][0]["scores"];
    for key in ["focal_mean_J", "protected_mean_J", "contrast"] {
        assert!(first[key].as_f64().is_some_and(|value| value > 0.0), "{key} {first}");
        assert_eq!(first[key].as_f64(), checked[key].as_f64(), "{key}");
    }
    // 1/2 M v² of the half.
    let work = first["work_in_J"].as_f64().unwrap();
    assert!((work / 30.0 - 1.0).abs() < 1e-12, "{work}");
    assert!(first["residual"].as_f64().unwrap().abs() < 1e-3);
    for (impact, said) in [
        ("kind = \"projectile\"\nmass = \"300 g\"\nspeed = \"20 m/s\"\nforce = \"1 kN\"", "mass and speed"),
        ("kind = \"projectile\"\nmass = \"300 g\"", "impact.speed is missing"),
        ("kind = \"force-pulse\"\nforce = \"20 kN\"\nduration = \"20 us\"\nmass = \"1 g\"", "force and duration"),
    ] {
        desk.write("wrong.toml", with(impact));
        let refused = desk.run(&["design", "wrong.toml"]);
        assert!(refused.code == 2 && refused.stderr.contains(said), "{}", refused.stderr);
    }
}

/// In a sheet too, and as the rig of the same file, whose flat is a body of its own.
#[test]
fn a_projectile_strikes_a_sheet_as_it_does_a_rig() {
    let desk = Desk::new();
    let text = std::fs::read_to_string(shipped("designs/quickstart.toml")).unwrap();
    let (before, rest) = text.split_once("[impact]").unwrap();
    let (_, after) = rest.split_once("[target]").unwrap();
    let thrown = "[impact]\nkind = \"projectile\"\nmass = \"40 g\"\nspeed = \"20 m/s\"\n";
    let after = after.replace("window = \"350 us\"", "window = \"150 us\"\nstep = \"125 ns\" # 1200 in it,");
    desk.write("thrown.toml", format!("{before}{thrown}[target]{after}"));
    desk.run(&["design", "thrown.toml", "--out", "lens.csv"]).ok();
    let check = ["check", "lens.csv", "--design", "thrown.toml", "--spheres", "felt.csv", "--integrator", "verlet"];
    desk.run(&check).ok();
    desk.run(&["simulate", "thrown.toml", "--out", "rig"]).ok();
    let column = |file: &str| -> Vec<f64> {
        let text = desk.read(file);
        let mut lines = text.lines().filter(|line| !line.starts_with('#'));
        let at = lines.next().unwrap().split(',').position(|name| name == "max_kinetic_J").unwrap();
        lines.map(|line| line.split(',').nth(at).unwrap().parse().unwrap()).collect()
    };
    let (ours, rig) = (column("felt.csv"), column("rig/spheres-final.csv"));
    assert_eq!(ours.len(), rig.len());
    let most = ours.iter().copied().fold(0.0, f64::max);
    for (k, (a, b)) in ours.iter().zip(&rig).enumerate() {
        // Rounding and its growth.
        assert!((a - b).abs() < 1e-6 * b + 1e-9 * most, "sphere {k}: {a} {b}");
    }
}

/// `run` leaves a folder with page, pictures, tables and layouts; extruded along y and stacked ABCABC too.
#[test]
fn run_leaves_a_report() {
    let desk = desk();
    let changed = SMALL.replace("\"hcp\"", "\"fcc-111\"").replace("[lens]", "[lens]\nsymmetry = \"plane\"");
    desk.write("extruded.toml", changed.replace("[\"mirror\", \"period\"]", "[\"free\", \"wall\"]"));
    let ran = desk.run(&["run", "extruded.toml", "--forces", "1", "--out", "report"]).ok();
    assert!(ran.stdout.contains("flat-height") && ran.stdout.contains("layers 7-8, r 0 to 1.1 D"), "{}", ran.stdout);
    for name in [
        "report.html",
        "section.svg",
        "layers.svg",
        "profile.svg",
        "numbers.json",
        "spheres.csv",
        "layout.csv",
        "layout-full.csv",
    ] {
        assert!(!desk.read(&format!("report/{name}")).is_empty(), "{name}");
    }
    let page = desk.read("report/report.html");
    assert!(page.contains("Verdict over") && !page.contains("NaN"), "{page:.300}");
    // A view to be turned, with every sphere of both halves, and a still picture of it where no script runs.
    let data = page.split("id=\"turned-data\">").nth(1).unwrap().split("</script>").next().unwrap();
    let data: serde_json::Value = serde_json::from_str(data).unwrap();
    let spheres =
        desk.read("report/layout-full.csv").lines().filter(|l| l.starts_with(|c: char| c.is_ascii_digit())).count();
    for key in ["x", "y", "z", "material", "region", "energy"] {
        assert_eq!(data[key].as_array().map(Vec::len), Some(spheres), "{key}");
    }
    assert!(page.contains("class=\"still\"><svg") && page.contains("name=\"tilt\""), "{page:.300}");
    // Tables are tables, and warnings are no lines that run out of the page.
    assert!(page.contains("<td>flat-height</td>"), "{page:.300}");
    // All along y the same: what one site of a layer and x holds, all do.
    let layout = desk.read("report/layout.csv");
    let mut held: std::collections::BTreeMap<(String, String), String> = std::collections::BTreeMap::new();
    for line in layout.lines().filter(|line| line.starts_with(|c: char| c.is_ascii_digit())) {
        let cells: Vec<&str> = line.split(',').collect();
        let place = (cells[0].to_owned(), cells[2].to_owned());
        let known = held.entry(place).or_insert_with(|| cells[6].to_owned());
        assert_eq!(known, cells[6], "{line}");
    }
    assert!(held.values().any(|material| material == "brass-260"));
}

/// Around an outline there may be a wall; what has the crystal's symmetry is simulated in a sixth of it, says so, and comes to the same numbers in both commands.
#[test]
fn a_walled_round_lens_is_simulated_in_a_sixth() {
    let desk = Desk::new();
    for outline in ["round", "hexagon"] {
        let sides = format!("sides = \"wall\"\noutline = \"{outline}\"");
        let text = SMALL.replace("sides = [\"mirror\", \"period\"]", &sides).replace("20 kN", "8 kN");
        desk.write("walled.toml", &text);
        let ran = desk.run(&["design", "walled.toml", "--out", "lens.csv"]).ok();
        assert!(ran.stdout.contains("a sixth of it is simulated"), "{}", ran.stdout);
        let compared = desk.run(&["compare", "walled.toml", "--forces", "1", "--json"]).ok().json();
        let of = |name: &str| {
            let all = compared["arrangements"].as_array().unwrap();
            all.iter().find(|a| a["name"] == name).unwrap_or_else(|| panic!("{name}"))
        };
        let fractions = ["lens", "all-host", "strip-2"].map(|name| of(name)["simulated_fraction"].as_f64());
        assert_eq!(fractions, [Some(1.0 / 6.0); 3]);
        let checked = desk.run(&["check", "lens.csv", "--design", "walled.toml", "--json"]).ok().json();
        assert_eq!(checked["simulated_fraction"].as_f64(), Some(1.0 / 6.0));
        for key in ["focal_mean_J", "protected_mean_J", "contrast", "focal_gain", "work_in_J", "dissipation"] {
            let ours = checked[key].as_f64().unwrap();
            assert_eq!(Some(ours), of("lens")["scores"][key].as_f64(), "{key}");
        }
        // One sphere away from the axis, of host in place of brass: the half, and nearly the same numbers.
        let lens = desk.read("lens.csv");
        let line = lens.lines().rfind(|line| line.ends_with("brass-260")).unwrap();
        desk.write("broken.csv", lens.replacen(line, &line.replace("brass-260", "stainless-440c"), 1));
        let broken = desk.run(&["check", "broken.csv", "--design", "walled.toml", "--json"]).ok().json();
        assert_eq!(broken["simulated_fraction"].as_f64(), Some(0.5));
        for key in ["focal_mean_J", "work_in_J"] {
            let ratio = broken[key].as_f64().unwrap() / checked[key].as_f64().unwrap();
            assert!((ratio - 1.0).abs() < 0.1, "{key} {ratio}");
        }
        for sides in ["\"period\"", "[\"free\", \"wall\"]"] {
            desk.write("wrong.toml", text.replace("\"wall\"", sides));
            let ran = desk.run(&["design", "wrong.toml"]);
            assert!(ran.code == 2 && ran.stderr.contains("neither free nor a wall"), "{}", ran.stderr);
        }
    }
}

#[test]
fn what_is_wrong_or_cannot_be_done_is_said() {
    let desk = desk();
    desk.run(&["design", "space.toml", "--out", "lens.csv"]).ok();
    for (from, to, said) in [
        ("layers = 9", "rows = 9", "rows"),
        ("cells = [10, 7]", "cells = [10, 2]", "cells"),
        ("[\"mirror\", \"period\"]", "\"mirror\"", "mirror along y"),
        ("r = [\"0 D\", \"1.1 D\"]", "r = [\"1.1 D\", \"0 D\"]", "reversed"),
        ("r = [\"4 D\", \"5 D\"]", "r = [\"0 D\", \"5 D\"]", "shares spheres"),
        ("layers = [7, 8], r = [\"4 D\", \"5 D\"]", "centre = [\"4 D\", \"0 D\"], radius = \"1 D\"", "three lengths"),
        ("apex_layer = 2", "apex_row = 2", "apex_row"),
        ("radius = \"5.5 D\"", "raster = \"diffused\"", "raster"),
        ("packing = \"hcp\"", "packing = \"hcpp\"", "packing"),
        ("[compare]", "[[target.focus]]", "focus"),
    ] {
        assert!(SMALL.contains(from), "{from}");
        desk.write("wrong.toml", SMALL.replace(from, to));
        let ran = desk.run(&["design", "wrong.toml"]);
        assert!(ran.code == 2 && ran.stderr.contains(said), "{to}: {} {}", ran.code, ran.stderr);
    }
    for command in [
        &["trace", "space.toml"][..],
        &["simulate", "space.toml"],
        &["bench", "space.toml"],
        &["design", "space.toml", "--rank"],
        &["check", "lens.csv", "--design", "space.toml", "--gate", "--frame-depth", "1 m"],
        &["compare", "space.toml", "--laws", "all"],
    ] {
        let ran = desk.run(command);
        assert!(ran.code == 2 && ran.stderr.contains("in space"), "{command:?}: {} {}", ran.code, ran.stderr);
    }
    let text = desk.read("lens.csv");
    let line = text.lines().rfind(|line| line.ends_with("stainless-440c")).unwrap();
    for (from, to, said) in [
        (line.to_owned(), String::new(), "is missing"),
        (line.to_owned(), line.replace("stainless-440c", "stainles"), "unknown"),
        ("layer,column".to_owned(), "row,column".to_owned(), "header"),
        (line.to_owned(), format!("{line}\n{line}"), "given twice"),
        (line.to_owned(), line.replacen("9,", "99,", 1), "no site"),
    ] {
        desk.write("wrong.csv", text.replacen(&from, &to, 1));
        let ran = desk.run(&["check", "wrong.csv", "--design", "space.toml"]);
        assert!(ran.code == 2 && ran.stderr.contains(said), "{to}: {} {}", ran.code, ran.stderr);
    }
}

/// Against the independent solution: F, P, C and G of the shipped design over 150 us; tolerances of tests/data/space for another integrator.
#[test]
fn the_shipped_lens_is_that_of_the_second_code() {
    let desk = Desk::new();
    let design = shipped("designs/space/revolved-lens.toml");
    let ran = desk.run(&["design", &design, "--out", "lens.csv"]).ok();
    assert!(ran.stdout.contains("732 brass-260"), "{}", ran.stdout);
    let json = desk.run(&["check", "lens.csv", "--design", &design, "--json"]).ok().json();
    for (key, theirs) in
        [("focal_mean_J", 1.831_864), ("protected_mean_J", 0.904_705), ("contrast", 2.0248), ("focal_gain", 1.3202)]
    {
        let ours = json[key].as_f64().unwrap();
        assert!((ours / theirs - 1.0).abs() < 1e-3, "{key}: {ours} and {theirs}");
    }
}
