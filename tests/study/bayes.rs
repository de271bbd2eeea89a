//! Bayesian optimisation of lenses: refused where it is not built in; else as any other method, whatever ends a run.

use crate::{Desk, lensed};

/// A lens of four parameters in a crystal that takes milliseconds.
const LENS: &str = r#"[lens]
family = "plano-convex"
material = "brass-260"
apex_row = 3
back_row = 6
radius = "6 D"
rows = [3, 9]
"#;

const STUDY: &str = r#"format = 1
design = "curved.toml"
materials = ["stainless-440c", "brass-260"]
rows = [3, 9]
objective = { contrast = { maximise = 1 } }
seed = 1
[[stage]]
method = "lens-family-bayes"
evaluations = 24
"#;

fn desk(study: &str) -> Desk {
    let desk = Desk::new(study);
    std::fs::write(desk.path("curved.toml"), lensed("curved", LENS)).unwrap();
    desk
}

/// A build without it knows the name, says what is missing, and what does the same without.
#[cfg(not(feature = "bayes"))]
#[test]
fn a_build_without_it_says_so() {
    let single = "method = \"lens-family-bayes\"\nbudget = 24\n";
    let single = format!("{}{single}", STUDY.split("[[stage]]").next().unwrap());
    for (study, line) in [(STUDY, 8), (single.as_str(), 7)] {
        let refusal = granulens::study::Study::read(&desk(study).path("study.toml"), None).unwrap_err().to_string();
        assert!(refusal.contains(&format!("study.toml:{line}: method = \"lens-family-bayes\"")), "{refusal}");
        for word in ["without the feature bayes", "--features bayes", "method = \"lens-family\""] {
            assert!(refusal.contains(word), "{refusal}");
        }
    }
}

#[cfg(feature = "bayes")]
mod built {
    use std::process::Command;

    use granulens::search::Rng;
    use granulens::study::{Ended, Study};

    use super::{STUDY, desk};
    use crate::with_threads;

    /// What is asked follows from what was told and the seed: the same bits on any number of threads, and from any beginning of
    /// the journal.
    #[test]
    fn killed_anywhere_and_on_any_number_of_threads_it_comes_to_the_same_bits() {
        for batch in [1, 4] {
            let desk = desk(&format!("{STUDY}batch = {batch}\n"));
            let (state, told) = with_threads(1, || desk.run()).unwrap();
            let journal = desk.journal();
            assert_eq!((state.evaluations, state.ended, told.simulated), (24, Ended::Budget, 24));
            let mut rng = Rng::new(1);
            for threads in [1, 2, 3] {
                let cut = rng.below(journal.len() as u64) as usize;
                desk.put(&journal[..cut]);
                let (again, _) = with_threads(threads, || desk.run()).unwrap();
                assert_eq!(again, state, "cut at {cut}, {threads} threads");
                assert!(desk.journal() == journal, "cut at {cut}, {threads} threads");
            }
            // Another seed asks for something else.
            std::fs::write(desk.path("study.toml"), STUDY.replace("seed = 1", "seed = 2")).unwrap();
            desk.put(b"");
            assert_ne!(desk.run().unwrap().0.history, state.history);
        }
    }

    /// Nothing but the result comes to stdout, whatever the library of the process has to say.
    #[test]
    fn stdout_is_for_data() {
        let desk = desk(STUDY);
        for quiet in [&[][..], &["--quiet"]] {
            let output = Command::new(env!("CARGO_BIN_EXE_granulens"))
                .args(["study", "run", "study.toml", "--json", "--out", "s"])
                .args(quiet)
                .env("RUST_LOG", "trace")
                .env("EGOBOX_LOG", "trace")
                .current_dir(desk.path("."))
                .output()
                .unwrap();
            assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
            let told: serde_json::Value = serde_json::from_slice(&output.stdout).unwrap();
            assert_eq!((&told["study"]["evaluations"], &told["study"]["ended"]), (&24.into(), &"budget".into()));
            assert_eq!(told["study"]["stages"][0]["method"], "lens-family-bayes");
        }
    }

    /// A lens of rows 3 to 5 is one of few: when all have been asked for, there is nothing new, however many were wanted.
    #[test]
    fn it_ends_when_nothing_new_is_left() {
        let few = STUDY.replace("rows = [3, 9]", "rows = [4, 5]").replace("evaluations = 24", "evaluations = 10000");
        let desk = desk(&few);
        let (state, _) = desk.run().unwrap();
        assert_eq!(state.ended, Ended::NothingNew);
        assert!((2..1000).contains(&state.evaluations), "{}", state.evaluations);
    }

    #[test]
    fn wrong_batches_hear_their_line() {
        for (batch, method, says) in [
            ("0", "lens-family-bayes", "study.toml:10: batch = 0 must be 1 to 64"),
            ("65", "lens-family-bayes", "study.toml:10: batch = 65 must be 1 to 64"),
            ("4", "lens-family", "study.toml:10: batch belongs to stages with method = \"lens-family-bayes\""),
        ] {
            let text = format!("{STUDY}batch = {batch}\n").replace("lens-family-bayes", method);
            let refusal = Study::read(&desk(&text).path("study.toml"), None).unwrap_err().to_string();
            assert!(refusal.contains(says), "{refusal}");
        }
    }
}
