//! `study`: run, go on, show, export.

use crate::{Desk, SMALL};

const STUDY: &str = r#"format = 1
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
    // The study's contrast is that of the full simulation, at the same step.
    let checked = desk.run(&["check", "best.csv", "--design", "small.toml", "--json"]).ok().json();
    assert_eq!(checked["contrast"], ran["study"]["best"]["C"]);
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
