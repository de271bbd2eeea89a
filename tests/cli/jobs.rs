//! `run`, `design` and `compare`: what they give, and that it does not depend on threads.

use std::io::Read as _;
use std::process::{Command, Stdio};

use serde_json::Value;

use super::{Desk, SMALL, keys, names};

const FILES: [&str; 14] = [
    "dissipation.svg",
    "forces.svg",
    "kinetic-lens.svg",
    "kinetic.svg",
    "layout-full.csv",
    "layout.csv",
    "layout.json",
    "layout.svg",
    "manifest.json",
    "numbers.csv",
    "numbers.json",
    "outcome.json",
    "profiles.svg",
    "report.html",
];

/// Text without its line breaks and columns.
fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

#[test]
fn run_writes_a_complete_report() {
    let desk = Desk::new();
    let ran = desk.run(&["run", "small.toml"]).ok();
    assert!(ran.stdout.starts_with("verdict over 8 forces"), "{}", ran.stdout);
    let told = one_line(&ran.stdout);
    for words in
        [" arrangement ", " random-behind ", "mixtures are of brass-260", "law thesis", "adams, step 188.679 ns"]
    {
        assert!(told.contains(words), "{words} is missing: {}", ran.stdout);
    }
    for words in [
        "speeds: ",
        "impact: ",
        "lens: rows 2 to 5",
        "piece: ",
        "rays: ",
        "step: ",
        "report: reports/small/report.html",
    ] {
        assert!(ran.stderr.contains(words), "{words} is missing: {}", ran.stderr);
        assert!(!ran.stdout.contains(words), "{words} is no data");
    }
    assert_eq!(names(&desk.path("reports")), ["small"], "nothing half-written is left");
    let files = names(&desk.path("reports/small"));
    assert!(FILES.iter().all(|name| files.iter().any(|file| file == name)), "{files:?}");
    for name in files.iter().filter(|name| name.ends_with(".json")) {
        let json = desk.json(&format!("reports/small/{name}"));
        let format = json.get("format").or_else(|| json["manifest"].get("format"));
        assert!(name == "manifest.json" || format == Some(&1.into()), "{name} has no format number");
    }
    let manifest = desk.json("reports/small/manifest.json");
    for key in [
        "name",
        "version",
        "commit",
        "design",
        "law",
        "integrator",
        "constants",
        "step_s",
        "window_s",
        "seeds",
        "threads",
        "started_unix_s",
        "seconds",
    ] {
        assert!(keys(&manifest).contains(&key), "{key}");
    }
    assert_eq!(manifest["design"], SMALL);
    assert_eq!(desk.read("reports/small/layout.csv"), desk.run(&["design", "small.toml"]).ok().stdout);
    let layout = desk.json("reports/small/layout.json");
    assert_eq!(keys(&layout["spheres"][0]), ["row", "column", "x", "z", "diameter", "material"]);
    let page = desk.read("reports/small/report.html");
    assert!(!page.contains("src=\"http") && !page.contains("href=\"http://"), "one file, no network");
}

#[test]
fn run_repeats_from_its_manifest() {
    let desk = Desk::new();
    desk.run(&["run", "small.toml", "--quiet", "--seed", "7", "--step", "5e-8 s", "--out", "first"]).ok();
    let manifest = desk.json("first/manifest.json");
    desk.write("again.toml", manifest["design"].as_str().unwrap());
    let [step, seed] = [&manifest["step_s"], &manifest["seeds"][0]].map(Value::to_string);
    let step = format!("{step} s");
    desk.run(&["run", "again.toml", "--quiet", "--seed", &seed, "--step", &step, "--out", "second"]).ok();
    assert_eq!(desk.read("first/numbers.csv"), desk.read("second/numbers.csv"));
}

#[test]
fn design_tells_what_it_proposes() {
    let desk = Desk::new();
    let ran = desk.run(&["design", "small.toml"]).ok();
    assert!(ran.stdout.contains("\nrow,column,x,z,diameter,material\n"));
    assert!(ran.stderr.contains("critical angle 36.0 deg"), "{}", ran.stderr);
    let json = desk.run(&["design", "small.toml", "--json"]).ok().json();
    for key in ["speed_ratio", "critical_angle_rad", "validity", "radius_m", "fraction", "piece", "half"] {
        assert!(!json["proposal"][key].is_null(), "{key}");
    }
    let named = desk.run(&["design", "small.toml", "--out", "small.csv"]).ok();
    assert!(named.stdout.starts_with("speeds: ") && named.stderr == "layout: small.csv\n", "{}", named.stderr);
    assert_eq!(desk.read("small.csv"), ran.stdout);
}

#[test]
fn a_focus_out_of_reach_is_explained() {
    let desk = Desk::new();
    let without_shape = SMALL.replace("apex_row = 2\nback_row = 5\nradius = \"6 D\"\n", "");
    let harder = without_shape.replace("brass-260", "tungsten-carbide").replace("\"stainless-440c\"", "\"brass-260\"");
    desk.write("spreads.toml", harder);
    desk.design_with("steep.toml", "radius = \"6 D\"", "radius = \"2 D\"");
    desk.design_with("deep.toml", "apex_row = 2", "apex_row = 9");
    let heard = ["spreads.toml", "steep.toml", "deep.toml"].map(|name| {
        let ran = desk.run(&["run", name]);
        assert_eq!((ran.code, ran.stdout.as_str()), (2, ""), "{name}");
        ran.stderr
    });
    insta::assert_snapshot!(heard.join("\n"));
    assert_eq!(desk.run(&["run", "steep.toml", "--json"]).json_error()["key"], "lens.radius");
    assert!(!desk.path("reports").exists());
}

#[test]
fn compare_scores_the_lens_and_every_baseline() {
    let desk = Desk::new();
    let json = desk.run(&["compare", "small.toml", "--json", "--out", "outcome.json"]).ok().json();
    let arrangements = json["arrangements"].as_array().unwrap();
    let listed: Vec<&str> = arrangements.iter().map(|a| a["name"].as_str().unwrap()).collect();
    let expected = [
        "lens",
        "flat-height",
        "flat-count",
        "all-host",
        "all-lens",
        "random-lens-rows-1",
        "random-lens-rows-2",
        "random-behind-1",
        "random-behind-2",
    ];
    assert_eq!(listed, expected);
    for arrangement in arrangements {
        for key in
            ["focal_mean_J", "protected_mean_J", "contrast", "focal_gain", "protection", "dissipated_J", "residual"]
        {
            assert!(arrangement["scores"][key].as_f64().is_some(), "{}: {key}", arrangement["name"]);
        }
    }
    let outcome = desk.json("outcome.json");
    assert_eq!((&outcome["format"], outcome["arrangements"].as_array().unwrap().len()), (&1.into(), 9));
    let table = desk.run(&["compare", "small.toml", "--quiet"]).ok();
    assert!(table.stdout.contains("random-lens-rows") && table.stderr.is_empty());
}

#[test]
fn compare_takes_a_layout_of_ones_own() {
    let desk = Desk::with_layout();
    let lens = desk.run(&["compare", "small.toml", "--json"]).ok().json();
    let own = desk.run(&["compare", "small.toml", "small.csv", "--json"]).ok().json();
    let scores = |json: &Value| -> Vec<Value> {
        json["arrangements"].as_array().unwrap().iter().map(|a| a["scores"].clone()).collect()
    };
    assert_eq!((scores(&lens), &own["arrangements"][0]["name"]), (scores(&own), &"small".into()));
    // Without any lens material asked for: there is nothing to propose, but layouts can be compared.
    let [begin, end] = ["[lens]", "[run]"].map(|section| SMALL.find(section).unwrap());
    desk.write("bare.toml", [&SMALL[..begin], &SMALL[end..]].concat());
    let refused = desk.run(&["compare", "bare.toml"]);
    assert_eq!(refused.code, 2);
    assert!(refused.stderr.contains("bare.toml: [lens] is missing"), "{}", refused.stderr);
    // Such a design may say what baselines are made of; if it does not, they are of the layout's first other material.
    desk.write("told.toml", desk.read("bare.toml") + "material = \"brass-260\"\n");
    let told = desk.run(&["compare", "told.toml", "small.csv", "--json"]).ok().json();
    assert_eq!(scores(&told), scores(&own));
    let bare = desk.run(&["compare", "bare.toml", "small.csv", "--json"]).ok().json();
    assert_eq!((scores(&bare), &bare["reference"]), (scores(&own), &"brass-260".into()));
    let said = desk.run(&["compare", "bare.toml", "small.csv"]).ok().stdout;
    assert!(
        said.contains("the design names no material that Q, strips and mixtures refer to; taken is brass-260"),
        "{said}"
    );
    // Strips and mixtures are made of what the design says, whatever the layout is made of.
    desk.write("steel.csv", desk.read("small.csv").replace("brass-260", "stainless-302"));
    desk.run(&["compare", "small.toml", "steel.csv", "--quiet", "--out", "steel.json"]).ok();
    let outcome = desk.json("steel.json");
    assert_eq!((&outcome["materials"][1], &outcome["reference"]), (&"brass-260".into(), &"brass-260".into()));
    assert!(outcome["arrangements"][4]["layout"].as_array().unwrap().iter().all(|material| material == 1));
    assert!(outcome["arrangements"][0]["layout"].as_array().unwrap().iter().any(|material| material == 2));
}

#[test]
fn threads_do_not_change_a_bit() {
    let desk = Desk::new();
    let compare = |threads: &str| desk.run(&["compare", "small.toml", "--json", "--threads", threads]).ok().stdout;
    assert_eq!(compare("1"), compare("2"));
    for threads in ["1", "2"] {
        desk.run(&["run", "small.toml", "--quiet", "--threads", threads, "--out", threads]).ok();
    }
    let files = names(&desk.path("1"));
    assert_eq!(files, names(&desk.path("2")));
    let without_times = |mut json: Value| {
        for manifest in ["manifest", ""] {
            let place = if manifest.is_empty() { Some(&mut json) } else { json.get_mut(manifest) };
            if let Some(manifest) = place.and_then(Value::as_object_mut) {
                for key in ["threads", "started_unix_s", "seconds"] {
                    manifest.remove(key);
                }
            }
        }
        json
    };
    for name in files.iter().filter(|name| *name != "report.html") {
        let [one, two] = ["1", "2"].map(|folder| format!("{folder}/{name}"));
        if name.ends_with(".json") {
            assert!(without_times(desk.json(&one)) == without_times(desk.json(&two)), "{name}");
        } else {
            assert!(desk.read(&one) == desk.read(&two), "{name}");
        }
    }
    for threads in ["0", "2000", "two"] {
        assert_eq!(desk.run(&["compare", "small.toml", "--threads", threads]).code, 2, "{threads}");
    }
}

#[test]
fn the_seed_changes_random_arrangements_only() {
    let desk = Desk::new();
    let arrangements = |seed: &str| {
        let json = desk.run(&["compare", "small.toml", "--json", "--seed", seed]).ok().json();
        json["arrangements"].as_array().unwrap().clone()
    };
    let [one, two] = ["1", "2"].map(arrangements);
    assert_eq!(one[..5], two[..5]);
    assert_eq!(one[6], two[5], "seed 2 is the second of the first and the first of the second");
    assert_ne!(one[5]["scores"], two[5]["scores"]);
    let last = arrangements("18446744073709551615");
    assert_eq!(last[6]["name"], "random-lens-rows-0", "seeds go round");
    assert_eq!(desk.run(&["compare", "small.toml", "--seed", "-1"]).code, 2);
}

#[test]
fn a_reader_who_has_seen_enough_ends_nothing() {
    let desk = Desk::with_layout();
    let calls: [&[&str]; 4] = [
        &["compare", "small.toml"],
        &["design", "small.toml"],
        &["run", "small.toml", "--json"],
        &["check", "small.csv", "--design", "small.toml", "--step", "3e-7 s"],
    ];
    for call in calls {
        for errors_too in [false, true] {
            let mut command = Command::new(env!("CARGO_BIN_EXE_granulens"));
            command.current_dir(desk.0.path()).args(call).stdout(Stdio::piped()).stderr(Stdio::piped());
            let mut child = command.spawn().unwrap();
            drop(child.stdout.take());
            let mut stderr = child.stderr.take().unwrap();
            if errors_too {
                drop(stderr);
            } else {
                let mut said = String::new();
                stderr.read_to_string(&mut said).unwrap();
                assert!(!said.contains("panicked"), "{call:?}: {said}");
            }
            assert_eq!(child.wait().unwrap().code(), Some(0), "{call:?}");
        }
    }
}
