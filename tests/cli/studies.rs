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

/// What of a folder a refused run must leave as it is.
fn kept(desk: &Desk, folder: &str) -> [String; 3] {
    ["study.json", "best.csv", "settings.json"].map(|name| desk.read(&format!("{folder}/{name}")))
}

/// A folder holds one study: another seed, other settings or another problem are refused with words, and nothing of it is mixed.
#[test]
fn seeds_settings_and_problems_are_kept_apart() {
    let desk = desk();
    desk.run(&["study", "run", "study.toml", "--out", "s"]).ok();
    let before = kept(&desk, "s");
    desk.write("settings.toml", STUDY.replace("\"local\"", "\"genetic\""));
    desk.write("problem.toml", STUDY.replace("rows = [3, 5]", "rows = [3, 6]"));
    let others: [(&[&str], &str); 3] = [
        (&["study.toml", "--seed", "2"], "holds the study with seed 1, and this is seed 2"),
        (&["settings.toml"], "holds a study with other settings"),
        (&["problem.toml"], "holds a study of another problem"),
    ];
    for (call, words) in others {
        // What a journal holds is shown for whatever study, and said to be another one's.
        for (job, code) in [("run", 2), ("show", 0)] {
            let ran = desk.run(&[&["study", job], call, &["--out", "s"]].concat());
            assert!(ran.code == code && ran.stderr.contains(words), "{job} {call:?}: {}", ran.stderr);
            assert_eq!(kept(&desk, "s"), before, "{job} {call:?}");
        }
    }
    // Without --out each seed has a folder of its own.
    desk.run(&["study", "run", "study.toml"]).ok();
    desk.run(&["study", "run", "study.toml", "--seed", "2"]).ok();
    let [one, two] = ["study", "study-seed-2"].map(|name| kept(&desk, &format!("reports/{name}")));
    assert_eq!(one[0], before[0]);
    assert_ne!(one[0], two[0]);
    let shown = desk.run(&["study", "show", "study.toml", "--seed", "2", "--json"]).ok().json();
    let written: serde_json::Value = serde_json::from_str(&two[0]).unwrap();
    assert_eq!(shown["best"]["contrast"], written["best"]["contrast"]);
    // By force the results are replaced; the journal keeps what it knows.
    let journal = desk.read("s/journal.jsonl");
    desk.run(&["study", "run", "study.toml", "--seed", "2", "--out", "s", "--force"]).ok();
    assert!(desk.read("s/journal.jsonl").starts_with(&journal));
    let [forced, own]: [serde_json::Value; 2] =
        [desk.read("s/study.json"), two[0].clone()].map(|text| serde_json::from_str(&text).unwrap());
    assert_eq!((&forced["seed"], &forced["best"]["contrast"]), (&own["seed"], &own["best"]["contrast"]));
}

/// Studies that ask different things are set side by side, said to be different, and not averaged.
#[test]
fn studies_of_different_problems_are_not_averaged() {
    let desk = desk();
    desk.write("other.toml", STUDY.replace("contrast = { maximise", "focal_gain = { maximise"));
    desk.run(&["study", "run", "study.toml", "--out", "a"]).ok();
    desk.run(&["study", "run", "other.toml", "--out", "b"]).ok();
    let compared = desk.run(&["study", "compare", "a", "b", "--json"]).ok().json();
    assert_eq!(compared["same_problem"], false);
    for name in ["contrast", "focal_gain", "protection"] {
        assert!(compared[name].is_null(), "{name}: {compared}");
    }
    for study in compared["studies"].as_array().unwrap() {
        assert!(study["contrast"].is_f64() && study["sites_different_from_first"].is_null(), "{study}");
        assert!(study["evaluations_to_5_percent"].is_null(), "{study}");
    }
    let table = desk.run(&["study", "compare", "a", "b"]).ok().stdout;
    assert!(table.contains("these are different problems") && !table.contains("mean "), "{table}");
}

/// Run again, a finished study says that nothing was to be done, and ends with the code of its first run.
#[test]
fn what_is_finished_says_so_and_ends_as_it_did() {
    let desk = desk();
    desk.write("missed.toml", STUDY.replace("maximise = 1 }", "maximise = 1, min = 90 }"));
    for (study, code) in [("study.toml", 0), ("missed.toml", 3)] {
        let call = ["study", "run", study, "--out", &format!("of-{study}")];
        let first = desk.run(&call);
        assert!(first.code == code && first.stderr.contains(" simulated in "), "{study}: {}", first.stderr);
        let again = desk.run(&call);
        assert_eq!((again.code, &again.stdout), (code, &first.stdout), "{study}");
        assert!(again.stderr.contains("nothing was to be done"), "{study}: {}", again.stderr);
        let json = desk.run(&[&call[..], &["--json"]].concat());
        assert_eq!(json.json()["run"]["nothing_to_do"], true);
    }
}
