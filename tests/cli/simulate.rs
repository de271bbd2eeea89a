//! `granulens simulate`: a rig and a lens, interruption, what is refused.

use super::{Desk, names, shipped};

const RIG: &str = r#"format = 1
kind = "rig"
name = "small"
[crystal]
packing = "hexagonal"
diameter = "6.35 mm"
layers = 6
x = ["0 D", "5 D"]
material = "brass-260"
[[flat]]
name = "bar"
at = "front"
mass = "20 g"
velocity = "5 m/s"
[run]
window = "100 us"
"#;

const FILES: [&str; 14] = [
    "arrivals.svg",
    "contacts-ever.csv",
    "contacts-final.csv",
    "energies.csv",
    "energies.svg",
    "flats.csv",
    "flats.svg",
    "layers-final.csv",
    "layers.csv",
    "report.html",
    "rig.toml",
    "spheres-final.csv",
    "spheres.csv",
    "trial.json",
];

#[test]
fn a_rig_leaves_records_pictures_and_a_table() {
    let desk = Desk::new();
    desk.write("rig.toml", RIG);
    let ran = desk.run(&["simulate", "rig.toml"]).ok();
    assert!(ran.stdout.contains("| put in | 2.5000e-1 |") && ran.stdout.contains("| bar |"), "{}", ran.stdout);
    let left = names(&desk.path("simulations/small"));
    assert_eq!(left, [&FILES[..], &["velocities.svg", "x-t.svg"]].concat());
    // The same again: a finished run is replaced; the same bytes.
    let before = desk.read("simulations/small/spheres.csv");
    let json = desk.run(&["simulate", "rig.toml", "--json", "--quiet"]).ok().json();
    assert_eq!((&json["spheres"], &json["finished"]), (&33.into(), &true.into()));
    assert!(json["residual"].as_f64().unwrap().abs() < 1e-4);
    assert!(desk.read("simulations/small/spheres.csv") == before);
}

#[test]
fn a_lens_design_is_a_rig_too() {
    let desk = Desk::new();
    let ran = desk.run(&["simulate", "small.toml", "--out", "lens", "--json"]).ok();
    assert_eq!(ran.json()["spheres"], 60);
    assert!(desk.path("lens/x-t.svg").exists());
}

/// `--seed` reaches patterns by chance, one after the other, and stands in the manifest.
#[test]
fn a_seed_reaches_mixes_and_is_recorded() {
    let desk = Desk::new();
    let mix = |seed: u32, layers: &str| {
        format!(
            "[[pattern]]\nkind = \"mix\"\nmaterials = [\"brass-260\", \"440c\"]\nfractions = [0.5, 0.5]\nseed = {seed}\n\
             layers = {layers}\n"
        )
    };
    let text = RIG.replace("100 us", "5 us");
    desk.write("rig.toml", format!("{text}{}{}", mix(7, "[1, 3]"), mix(7, "[4, 6]")));
    desk.write("twin.toml", format!("{text}{}{}", mix(20, "[1, 3]"), mix(21, "[4, 6]")));
    let run = |call: &[&str]| desk.run(&[&["simulate"], call, &["--json", "--quiet"]].concat()).ok().json();
    assert_eq!(run(&["rig.toml", "--out", "a"])["seeds"], serde_json::json!([7, 7]));
    assert_eq!(run(&["rig.toml", "--out", "b", "--seed", "20"])["seeds"], serde_json::json!([20, 21]));
    assert_eq!(run(&["twin.toml", "--out", "c"])["seeds"], serde_json::json!([20, 21]));
    let spheres = |folder: &str| desk.read(&format!("{folder}/spheres-final.csv"));
    assert!(spheres("b") == spheres("c") && spheres("a") != spheres("b"));
    // Where nothing is drawn by chance a seed is not passed over in silence.
    desk.write("plain.toml", text);
    let ran = desk.run(&["simulate", "plain.toml", "--seed", "5"]).ok();
    assert!(ran.stderr.contains("nothing in this file is drawn by chance"), "{}", ran.stderr);
    let ran = desk.run(&["simulate", "small.toml", "--out", "lens", "--seed", "5"]).ok();
    assert!(ran.stderr.contains("nothing in this file is drawn by chance"), "{}", ran.stderr);
}

#[test]
fn what_cannot_be_run_is_refused() {
    let desk = Desk::new();
    desk.write("rig.toml", RIG);
    desk.write("wrong.toml", RIG.replace("layers = 6", "layers = 6.5"));
    desk.write("overlap.toml", format!("{RIG}[[edit]]\nlayers = 2\ncolumns = 1\nmove = [\"0 mm\", \"-1 mm\"]\n"));
    std::fs::create_dir(desk.path("here")).unwrap();
    desk.write("here/mine.txt", "mine");
    let heard = |call: &[&str]| {
        let ran = desk.run(call);
        assert_eq!(ran.code, 2, "{call:?}: {}", ran.stderr);
        format!("$ granulens {}\n{}\n", call.join(" "), ran.stderr)
    };
    let answers: String = [
        &["simulate", "wrong.toml"][..],
        &["simulate", "overlap.toml", "--quiet"],
        &["simulate", "none.toml"],
        &["simulate", "rig.toml", "--quiet", "--out", "here"],
        &["simulate", "rig.toml", "--quiet", "--resume"],
        &["run", "rig.toml"],
    ]
    .map(heard)
    .concat();
    insta::assert_snapshot!(answers);
}

/// A guard: exit code 1, and the records stay.
#[test]
fn a_guard_stops_with_its_reason() {
    let desk = Desk::new();
    desk.write("rig.toml", RIG.replace("5 m/s", "900 m/s"));
    let ran = desk.run(&["simulate", "rig.toml"]);
    assert_eq!(ran.code, 1, "{}", ran.stderr);
    assert!(ran.stderr.contains("failed: ") && ran.stderr.contains("overlap by"), "{}", ran.stderr);
    assert!(desk.path("simulations/small/spheres-final.csv").exists());
}

/// SIGINT: exit code 130, and --resume ends with the bytes of an undisturbed run.
#[cfg(unix)]
#[test]
fn an_interrupted_run_is_taken_up() {
    let desk = Desk::new();
    // Some hundred thousand steps: a second or more.
    desk.write("rig.toml", RIG.replace("100 us", "4 ms\"\nstep = \"20 ns"));
    let mut child = std::process::Command::new(env!("CARGO_BIN_EXE_granulens"))
        .current_dir(desk.path("."))
        .args(["simulate", "rig.toml", "--quiet", "--out", "broken"])
        .spawn()
        .unwrap();
    while !desk.path("broken/checkpoint").exists() {
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    std::process::Command::new("kill").args(["-INT", &child.id().to_string()]).status().unwrap();
    assert_eq!(child.wait().unwrap().code(), Some(130));
    let refused = desk.run(&["simulate", "rig.toml", "--quiet", "--out", "broken"]);
    assert_eq!(refused.code, 2);
    assert!(refused.stderr.contains("--resume"), "{}", refused.stderr);
    desk.run(&["simulate", "rig.toml", "--quiet", "--out", "broken", "--resume"]).ok();
    desk.run(&["simulate", "rig.toml", "--quiet", "--out", "whole"]).ok();
    for name in ["spheres.csv", "energies.csv", "spheres-final.csv", "trial.json"] {
        assert!(desk.read(&format!("broken/{name}")) == desk.read(&format!("whole/{name}")), "{name}");
    }
}

#[test]
fn shipped_rigs_are_said_to_be_rigs() {
    let desk = Desk::new();
    let ran = desk.run(&["design", &shipped("designs/sliding-rig.toml")]);
    assert_eq!(ran.code, 2);
    assert!(ran.stderr.contains("granulens simulate"), "{}", ran.stderr);
}
