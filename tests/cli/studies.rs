//! `study`: run, go on, show, export.

use crate::{Desk, SMALL};

pub const STUDY: &str = r#"format = 1
design = "small.toml"
materials = ["stainless-440c", "brass-260"]
rows = [3, 5]
objective = { contrast = { maximise = 1 } }
budget = 40
seed = 1
method = "local"
start = "random"
"#;

fn desk() -> Desk {
    assert!(SMALL.contains("rows = 12"), "rows 3 to 5 are free below");
    let desk = Desk::new();
    desk.write("study.toml", STUDY);
    desk
}

#[test]
fn a_study_runs_shows_and_exports_a_layout_that_checks() {
    let desk = desk();
    let ran = desk.run(&["study", "run", "study.toml", "--out", "s", "--json"]).ok().json();
    assert_eq!(ran["study"]["evaluations"], 40);
    let shown = desk.run(&["study", "show", "study.toml", "--out", "s"]).ok();
    assert!(shown.stdout.contains("40 evaluations"), "{}", shown.stdout);
    desk.run(&["study", "export", "study.toml", "--out", "s", "--layout", "best.csv"]).ok();
    assert_eq!(desk.read("best.csv"), desk.read("s/best.csv"));
    // A line for each evaluation, with as many cells as the header.
    desk.run(&["study", "export", "study.toml", "--out", "s", "--journal", "j.csv"]).ok();
    let table = desk.read("j.csv");
    assert!(table.starts_with("step_s,evaluation,crystal,force_N,duration_s,"), "{table}");
    assert_eq!(table.lines().count(), 41);
    assert!(table.lines().all(|line| line.split(',').count() == table.lines().next().unwrap().split(',').count()));
    let parquet = desk.run(&["study", "export", "study.toml", "--out", "s", "--journal", "j.parquet"]);
    if cfg!(feature = "parquet") {
        assert_eq!(parquet.code, 0);
    } else {
        assert!(parquet.code == 2 && parquet.stderr.contains("feature parquet"), "{}", parquet.stderr);
        assert!(!desk.names().contains(&"j.parquet".to_owned()));
    }
    // The study's contrast is that of the full simulation, at the same step.
    let checked = desk.run(&["check", "best.csv", "--design", "small.toml", "--json"]).ok().json();
    assert_eq!(checked["contrast"], ran["study"]["best"]["contrast"]);
}

#[test]
fn a_finished_study_evaluates_nothing_again() {
    let desk = desk();
    desk.run(&["study", "run", "study.toml", "--out", "s"]).ok();
    let journal = desk.read("s/journal.jsonl");
    desk.run(&["study", "run", "study.toml", "--out", "s", "--threads", "1"]).ok();
    assert_eq!(desk.read("s/journal.jsonl"), journal);
}

#[test]
fn wrong_studies_are_refused_with_their_line() {
    let desk = desk();
    desk.write("wrong.toml", STUDY.replace("budget = 40", "budget = -1"));
    let ran = desk.run(&["study", "run", "wrong.toml", "--out", "s"]);
    assert_eq!(ran.code, 2);
    assert!(ran.stderr.contains("wrong.toml:6") && ran.stderr.contains("budget"), "{}", ran.stderr);
    assert!(!desk.names().contains(&"s".to_owned()));
}

#[test]
fn events_are_lines_of_json_from_begin_to_end() {
    let desk = desk();
    let ran = desk.run(&["study", "run", "study.toml", "--out", "s", "--events"]).ok();
    let lines: Vec<serde_json::Value> = ran.stdout.lines().map(|line| serde_json::from_str(line).unwrap()).collect();
    let kinds: Vec<&str> = lines.iter().map(|line| line["event"].as_str().unwrap()).collect();
    assert_eq!((kinds[0], kinds[kinds.len() - 1]), ("begin", "end"));
    assert!(kinds[1..kinds.len() - 1].iter().all(|kind| *kind == "batch"), "{kinds:?}");
    let last = &lines[lines.len() - 2];
    assert_eq!((&last["evaluations"], &last["from_journal"]), (&40.into(), &0.into()));
    assert_eq!(last["best"]["contrast"], lines[lines.len() - 1]["study"]["best"]["contrast"]);
    assert_eq!(ran.stderr, "");
}

#[test]
fn a_study_that_misses_its_limits_says_so() {
    let desk = desk();
    desk.write("study.toml", STUDY.replace("maximise = 1 }", "maximise = 1, min = 90 }"));
    let ran = desk.run(&["study", "run", "study.toml", "--out", "s"]);
    assert_eq!(ran.code, 3);
    assert!(ran.stdout.contains("none within the limits"), "{}", ran.stdout);
    assert!(desk.read("s/nearest.csv").contains("brass-260"));
    assert!(!desk.names().contains(&"s/best.csv".to_owned()));
}

#[test]
fn studies_are_compared_from_what_they_wrote() {
    let desk = desk();
    for seed in ["1", "2"] {
        let folder = format!("s{seed}");
        desk.run(&["study", "run", "study.toml", "--out", &folder, "--seed", seed]).ok();
    }
    let compared = desk.run(&["study", "compare", "s1", "s2", "s1", "--json"]).ok().json();
    let studies = compared["studies"].as_array().unwrap();
    assert_eq!(studies.len(), 3);
    assert_eq!(studies[0], studies[2]);
    assert_eq!(studies[0]["sites_different_from_first"], 0);
    let contrast = |k: usize| studies[k]["contrast"].as_f64().unwrap();
    let best = if contrast(0) > contrast(1) { 0 } else { 1 };
    assert!(studies[best]["evaluations_to_5_percent"].as_u64().is_some_and(|count| count <= 40));
    assert_eq!(compared["contrast"]["range"][1], studies[best]["contrast"]);
    let table = desk.run(&["study", "compare", "s1", "s2"]).ok().stdout;
    assert!(table.lines().count() == 6 && table.contains("local"), "{table}");
    let refused = desk.run(&["study", "compare", "s1", "nowhere"]);
    assert!(refused.code == 2 && refused.stderr.contains("nowhere"), "{}", refused.stderr);
}

/// Strips and mixtures stand in every study's report; those that are random with an interval over seeds.
#[test]
fn baselines_are_always_there() {
    let desk = desk();
    let ran = desk.run(&["study", "run", "study.toml", "--out", "s", "--json"]).ok().json();
    let baselines = ran["study"]["baselines"].as_array().unwrap();
    let of =
        |name: &str| baselines.iter().find(|b| b["name"] == name).unwrap_or_else(|| panic!("{name}: {baselines:?}"));
    assert_eq!(of("all-host")["focal_gain"]["mean"], 1.0);
    assert_eq!(of("all-lens")["protection"]["mean"], 1.0);
    assert!(of("flat-height")["contrast"]["half_width"].is_null());
    assert!(of("random-rows")["contrast"]["half_width"].as_f64().is_some_and(|half| half > 0.0));
    assert!(of("random-behind")["seeds"].as_u64().is_some_and(|seeds| seeds > 1));
}
