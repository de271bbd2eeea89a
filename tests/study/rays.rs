//! Rays as a surrogate of what a lens is worth: from the lenses that a study asks for to what it says of them.

use std::collections::HashMap;
use std::process::Command;

use granulens::lens::{LensRequest, propose};
use granulens::search::rank_correlation;
use granulens::study::{Journal, Study};

use crate::{Desk, lensed};

/// A prism has neither curvature nor axis, so that first and last row say which of 21 it is.
const PRISM: &str = r#"[lens]
family = "prism"
material = "brass-260"
rows = [3, 9]
"#;

const STUDY: &str = r#"format = 1
design = "prism.toml"
materials = ["stainless-440c", "brass-260"]
rows = [3, 9]
objective = { contrast = { maximise = 1 } }
budget = 12
seed = 1
method = "lens-family"
"#;

/// What rays say of every prism within the rows, by the letters of its layout; of none at all they say nothing.
fn prisms(study: &Study) -> HashMap<Vec<u8>, f64> {
    let design = study.design.plane().unwrap();
    let mut said = HashMap::from([(vec![0; study.free.len()], 0.0)]);
    let mut laid = 0;
    for (first, last) in (3..9).flat_map(|first| (first + 1..=9).map(move |last| (first, last))) {
        let rows = LensRequest { apex_row: Some(first), back_row: Some(last), ..design.lens.clone().unwrap() };
        let lens = propose(&design.lattice, &design.host, &rows, &design.target, design.constants);
        let Ok(lens) = lens else { continue };
        let more = lens.fraction / lens.fraction_without - lens.protected[0] / lens.protected[1];
        let letters = study.free.iter().map(|&i| lens.materials[i]).collect();
        assert_eq!(said.insert(letters, more), None, "two prisms with the same spheres");
        laid += 1;
    }
    assert!(laid >= 15, "{laid}");
    said
}

/// The correlation that a study prints is that of the evaluations in its journal with rays traced here.
#[test]
fn what_rays_are_worth_is_told_at_the_end() {
    let desk = Desk::new(STUDY);
    std::fs::write(desk.path("prism.toml"), lensed("prism", PRISM)).unwrap();
    let run = |form: &[&str]| {
        let output = Command::new(env!("CARGO_BIN_EXE_granulens"))
            .args(["study", "run", "study.toml", "--out", "s"])
            .args(form)
            .current_dir(desk.path("."))
            .output()
            .unwrap();
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        String::from_utf8(output.stdout).unwrap()
    };
    let told: serde_json::Value = serde_json::from_str(&run(&["--json"])).unwrap();
    let glances = told["study"]["glances"].as_array().unwrap();
    let of_rays: Vec<_> = glances.iter().filter(|surrogate| surrogate["name"] == "rays").collect();
    let [rays] = of_rays[..] else { panic!("{glances:?}") };

    let study = desk.study();
    let said = prisms(&study);
    let entries = Journal::read(&desk.path("s/journal.jsonl")).unwrap().entries;
    assert_eq!((entries.len(), &rays["shared"]), (12, &12.into()));
    let assignments = entries.iter().map(|entry| entry.assignment(study.free.len(), 2).unwrap());
    let gathered: Vec<f64> = assignments.map(|assignment| said[&assignment]).collect();
    let contrast: Vec<f64> = entries.iter().map(|entry| entry.impacts[0].contrast.unwrap()).collect();
    let correlation = rank_correlation(&gathered, &contrast).unwrap();
    // More contrast is less loss: ranks from the other end, with the same differences.
    assert!((rays["rank_correlation"].as_f64().unwrap() - correlation).abs() < 1e-12, "{rays} {correlation}");
    // Something that a study without rays would not have said.
    assert!(correlation.abs() > 0.05 && correlation < 1.0, "{correlation}");

    let line =
        format!("rays, without a simulation: rank correlation with the finest {correlation:.3}, over 12 layouts");
    let words = run(&[]);
    assert!(words.contains(&line), "{words}");
}
