//! What a wrong study file hears, and the repository's own.

use std::path::Path;

use granulens::study::Study;

use crate::{Desk, STAGED, STUDY};

#[test]
fn wrong_study_files_hear_their_line() {
    for (old, new, says) in [
        ("format = 1", "format = 2", "study.toml:1: format = 2 must be 1"),
        ("tiny.toml", "none.toml", "none.toml: no such file"),
        ("brass-260", "bras-260", "study.toml:3: materials: unknown material \"bras-260\" (did you mean"),
        ("rows = [3, 5]", "rows = [5, 3]", "study.toml:4: rows = [5, 3] must be"),
        ("rows = [3, 5]", "rows = [3, 9]", "of rows 1 to 8"),
        ("rows = [3, 5]", "rows = [3, 7]", "study.toml:4: rows = [3, 7] hold row 7 of a scored region"),
        ("rows = [3, 5]", "rows = [3, 5]\nx = [\"2 D\", \"1 D\"]", "study.toml:5: x holds no sphere of these rows"),
        ("rows = [3, 5]", "rows = [3, 5]\nx = [\"2\", \"1 D\"]", "study.toml:5: x:"),
        ("maximise", "minimize", "study.toml:5: objective.contrast: unknown field `minimize`"),
        ("maximise = 1", "max = 9", "study.toml:5: objective asks for nothing"),
        (
            "maximise = 1",
            "maximise = 1, minimise = 1",
            "study.toml:5: objective.contrast: asks for none or for several",
        ),
        ("maximise = 1", "maximise = 0", "study.toml:5: objective.contrast: a weight of 0 must be positive"),
        (
            "contrast",
            "colour",
            "study.toml:5: objective: unknown measure colour; known are focal_mean, protected_mean, contrast, focal_gain",
        ),
        ("0.8", "-0.8", "study.toml:5: objective.focal-gain: min = -0.8 must be positive"),
        ("min = 0.8", "min = 2, max = 1", "study.toml:5: objective.focal-gain: min = 2 is above max = 1"),
        ("budget = 600", "budget = 0", "study.toml:6: budget = 0 must be 1"),
        ("budget = 600", "budget = -1", "study.toml:6: budget: invalid value: integer `-1`, expected a whole number"),
        ("budget", "budged", "study.toml:6: unknown field `budged`"),
        ("genetic+local", "magic", "study.toml:8: unknown method \"magic\"; known are genetic, local, local-swaps"),
        ("random", "lens", "study.toml:9: start = \"lens\", but the design has no [lens]"),
        ("random", "elsewhere", "study.toml:9: start = \"elsewhere\" must be"),
        ("random", "none.csv", "none.csv"),
        ("seed = 1", "step = \"1 m\"", "study.toml:7: step"),
    ] {
        assert!(STUDY.contains(old), "{old}");
        let desk = Desk::new(&STUDY.replacen(old, new, 1));
        let refusal = Study::read(&desk.path("study.toml"), None).unwrap_err().to_string();
        assert!(refusal.contains(says), "{refusal}");
    }
    for (old, new, says) in [
        ("force = \"12 kN\"", "force = \"12 mm\"", "study.toml:16: force"),
        (
            "force = \"12 kN\"\nduration = \"16 us\"",
            "force = \"16 kN\"\nduration = \"20 us\"",
            "study.toml:16: the impact is given twice",
        ),
        ("duration = \"16 us\"", "", "missing field `duration`"),
        ("evaluations = 80\n", "", "study.toml:22: evaluations is missing"),
        ("evaluations = 80", "evaluations = 0", "study.toml:24: evaluations = 0 must be 1"),
        ("nsga2", "nsga3", "study.toml:23: unknown method \"nsga3\"; known are"),
        ("nsga2", "lens-family", "study.toml:23: methods of the lens-family need a design with a [lens]"),
        ("level-set", "rescore", "study.toml:19: method = \"rescore\" has nothing"),
        ("evaluations = 80", "evaluations = 80\nsample = 3", "study.toml:25: sample belongs"),
        ("evaluations = 80", "evaluations = 80\norder = 4", "study.toml:25: order belongs"),
        ("evaluations = 80", "evaluations = 80\nscreen = \"8e-7 s\"", "study.toml:25: screen belongs"),
        ("evaluations = 80", "evaluations = 80\nscreen_window = \"60 us\"", "study.toml:25: screen_window belongs"),
        ("nsga2", "climb", "study.toml:23: a climb needs a screen"),
        ("evaluations = 60", "evaluations = 60\norder = 1", "study.toml:21: order = 1 must be 2 to 12"),
        ("promote = 12", "evaluations = 12", "study.toml:28: a rescore evaluates promote and sample"),
        ("seed = 1", "method = \"local\"", "study.toml:5: method stands above [[stage]]"),
        ("[\"random\", \"random\"]", "[]", "study.toml:6: start is an empty list"),
        ("\"mean\"", "\"median\"", "study.toml:7: over: unknown variant `median`"),
        ("\"mean\"", "\"mean\"\ntime = \"0 s\"", "study.toml:8: time = \"0 s\" must be positive"),
    ] {
        assert!(STAGED.contains(old), "{old}");
        let desk = Desk::new(&STAGED.replacen(old, new, 1));
        let refusal = Study::read(&desk.path("study.toml"), None).unwrap_err().to_string();
        assert!(refusal.contains(says), "{refusal}");
    }
}

/// Rows 3 and 5 have spheres at 0, 1, 2 and 3 D, row 4 at 0.5, 1.5, 2.5 and 3.5 D.
#[test]
fn what_may_change_can_be_limited_in_both_directions() {
    let desk = Desk::new(&STUDY.replace("rows = [3, 5]", "rows = [3, 5]\nx = [\"1 D\", \"2.5 D\"]"));
    let study = desk.study();
    let sites = study.design.plane().unwrap().lattice.sites();
    let free: Vec<[u32; 2]> = study.free.iter().map(|&i| [sites[i].row, sites[i].column]).collect();
    assert_eq!(free, [[3, 2], [3, 3], [4, 2], [4, 3], [5, 2], [5, 3]]);
}

/// Each names layouts that are there, and begins where it says. The 357 sites of rows 5 to 25, or the 425 of rows 5 to 29, may change; in space
/// the 12 x 120 of the half's layers 2 to 13.
#[test]
fn the_studies_of_the_repository_are_sound() {
    for (folder, free) in [("studies", &[357][..]), ("designs/optimum", &[357, 425]), ("designs/space", &[1440])] {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
        let mut count = 0;
        for path in std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()) {
            // Designs and studies of lenses in space stand side by side.
            let names_design = || std::fs::read_to_string(&path).unwrap().contains("\ndesign = ");
            if path.extension().is_some_and(|extension| extension == "toml") && names_design() {
                let study = Study::read(&path, None).unwrap();
                assert!(free.contains(&study.free.len()), "{}", path.display());
                assert_eq!(study.materials(&study.first()[0]), study.bases[0]);
                count += 1;
            }
        }
        assert!(count > 0);
    }
}
