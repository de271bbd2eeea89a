//! `--dry-run`: everything is read and checked, the cost is said, nothing is done.

use super::{Desk, names};

const STUDY: &str = "format = 1\ndesign = \"small.toml\"\nmaterials = [\"stainless-440c\", \"brass-260\"]\nrows = [3, 5]\n\
                     objective = { contrast = { maximise = 1 } }\nseed = 1\n[[stage]]\nmethod = \"local\"\nevaluations = 300\n\
                     step = \"4e-7 s\"\n[[stage]]\nmethod = \"rescore\"\npromote = 10\nstep = \"1e-7 s\"\n";

const BED: &str = "format = 1\nkind = \"bed\"\nname = \"bed\"\n[bed]\nwidth = 20\nheight = 10\n\
                   [intruder]\nshape = \"disk\"\ndiameter = 4\nspeed = 0.5\n";

#[test]
fn nothing_is_written_and_every_part_has_its_cost() {
    let desk = Desk::new();
    desk.write("study.toml", STUDY);
    desk.write("bed.toml", BED);
    let layout = desk.run(&["design", "small.toml"]).ok().stdout;
    desk.write("layout.csv", &layout);
    let before = names(&desk.path("."));
    // Counts: the lens, four baselines that are certain and two by chance for each of two seeds, and of run the look inside; a layout; one run; the stages' evaluations; two rows; a bed that has to settle.
    for (command, counts) in [
        (&["run", "small.toml"][..], &[9, 72, 1][..]),
        (&["compare", "small.toml", "layout.csv"], &[9, 72]),
        (&["check", "layout.csv", "--design", "small.toml", "--spheres", "spheres.csv"], &[3]),
        (&["simulate", "small.toml"], &[1]),
        (&["export", "small.toml", "--xyz", "frames.xyz", "--lammps", "deck"], &[1, 1]),
        (&["study", "run", "study.toml"], &[300, 10]),
        (&["reproduce", "5.3.2-amplitude", "5.3.3-gain"], &[2]),
        (&["impact", "bed.toml"], &[1, 1]),
    ] {
        let ran = desk.run(&[command, &["--dry-run", "--json", "--threads", "2"]].concat()).ok();
        let told: serde_json::Value = serde_json::from_str(&ran.stdout).unwrap();
        let parts = told["parts"].as_array().unwrap();
        assert_eq!(told["dry_run"], true);
        let found: Vec<u64> = parts.iter().map(|part| part["count"].as_u64().unwrap()).collect();
        assert_eq!(found, counts, "{command:?}");
        let known = parts.iter().all(|part| part["core_seconds"].as_f64().is_some_and(|seconds| seconds > 0.0));
        assert_eq!(known, command[0] != "impact", "{command:?}: {told}");
        assert_eq!(told["seconds"].is_f64(), known);
        assert_eq!(names(&desk.path(".")), before, "{command:?}");
    }
    let words = desk.run(&["study", "run", "study.toml", "--dry-run"]).ok().stdout;
    assert!(words.contains("| evaluations of local, step 400 ns | 300 |"), "{words}");
}

#[test]
fn wrong_input_is_found_and_quick_commands_have_none() {
    let desk = Desk::new();
    desk.write("wrong.toml", "format = 1\n");
    assert_eq!(desk.run(&["run", "wrong.toml", "--dry-run"]).code, 2);
    let ran = desk.run(&["design", "small.toml", "--dry-run"]);
    assert_eq!(ran.code, 2);
    assert!(ran.stderr.contains("--dry-run is for commands that simulate"), "{}", ran.stderr);
}
