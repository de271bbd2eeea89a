//! The layouts in `studies/`, against what is said about them in `docs/optimiser.md`.

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use granulens::dem::Integrator;
use granulens::design::Design;
use granulens::evaluate::{Evaluated, Evaluator, Overrides, evaluate};
use granulens::layout;
use granulens::material;
use granulens::score::Measure;
use granulens::study::Study;

/// C, G and Q as they are quoted, at 5e-8 s.
const SAID: [(&str, [f64; 3]); 6] = [
    ("studies/two-materials-found.csv", [5.025, 1.3375, 0.6496]),
    ("studies/two-materials-best.csv", [5.217, 1.327, 0.6208]),
    ("studies/two-materials-5000-best.csv", [5.2725, 1.3185, 0.6103]),
    ("studies/four-materials-best.csv", [6.306, 1.5115, 0.585]),
    ("studies/four-materials-5000-best.csv", [6.4156, 1.5255, 0.5803]),
    ("studies/four-materials-gain-best.csv", [5.531, 2.2905, 1.0107]),
];

/// C and G of `studies/four-materials-robust-best.csv` under the worst of five impacts, at 5e-8 s.
const SAID_OF_FIVE: [f64; 2] = [4.802, 1.514];

fn repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// At the step at which they are quoted, to the digits that are quoted; at half of it, to the 1 % that late pushes on
/// single spheres are worth. All layouts side by side, so that they share the vector lanes.
#[test]
fn stored_layouts_are_as_good_as_is_said() {
    let design = Design::read(repository("designs/quickstart.toml")).unwrap();
    let mut palette = vec![design.host.clone(), material::find("brass-260", &[]).unwrap()];
    let mut layouts = Vec::new();
    for (file, _) in SAID {
        let layout = layout::read(&repository(file), design.lattice, &palette, &[]).unwrap();
        // It only grows, so that the layouts before keep their meaning.
        palette = layout.palette;
        layouts.push(layout.materials);
    }
    let never = AtomicBool::new(false);
    for (step, tolerance) in [(5e-8, 1e-3), (2.5e-8, 1e-2)] {
        let overrides = Overrides { step: Some(step), window: Some(350e-6), ..Overrides::default() };
        let evaluator = Evaluator::new(&design, &[design.impact], palette.clone(), overrides, &never).unwrap();
        for ((file, said), runs) in SAID.iter().zip(evaluator.scores(&layouts, &never).unwrap()) {
            assert_eq!(runs[0].stop, None);
            let scores = &runs[0].scores;
            let found = [scores.contrast, scores.focal_gain, scores.protection];
            for (found, said) in found.into_iter().zip(said) {
                let found = found.unwrap();
                assert!((found / said - 1.0).abs() < tolerance, "{file} at {step}: {found} is not {said}");
            }
        }
    }
}

/// Under the worst of the five impacts of `four-materials-robust.toml`, each of C and G by itself.
#[test]
fn a_stored_layout_stands_five_impacts() {
    let study = Study::read(&repository("studies/four-materials-robust.toml"), None).unwrap();
    let file = repository("studies/four-materials-robust-best.csv");
    let layout = layout::read(&file, study.design.lattice, &study.palette, &[]).unwrap();
    let never = AtomicBool::new(false);
    let overrides = Overrides {
        integrator: Some(Integrator::Adams),
        step: Some(5e-8),
        window: Some(350e-6),
        ..Overrides::default()
    };
    let evaluator = Evaluator::new(&study.design, &study.cases(), layout.palette, overrides, &never).unwrap();
    let runs: Vec<Evaluated> = evaluator.scores(&[layout.materials], &never).unwrap().remove(0);
    assert_eq!(runs.len(), 5);
    assert!(runs.iter().all(|run| run.stop.is_none()));
    let worst = |measure| runs.iter().map(|run| run.scores.get(measure).unwrap()).fold(f64::MAX, f64::min);
    let found = [worst(Measure::Contrast), worst(Measure::FocalGain)];
    for (found, said) in found.into_iter().zip(SAID_OF_FIVE) {
        assert!((found / said - 1.0).abs() < 1e-3, "{found} is not {said}");
    }
}

/// `check` and `compare` say of every stored layout, under each of the five impacts, what batches say, to the last bit: also where
/// spheres meet that do not touch at rest.
#[test]
fn stored_layouts_have_the_same_scores_one_by_one() {
    let study = Study::read(&repository("studies/four-materials-robust.toml"), None).unwrap();
    let mut palette = study.palette.clone();
    let mut layouts = Vec::new();
    for file in std::fs::read_dir(repository("studies")).unwrap() {
        let path = file.unwrap().path();
        if path.extension().is_none_or(|extension| extension != "csv") {
            continue;
        }
        let layout = layout::read(&path, study.design.lattice, &palette, &[]).unwrap();
        palette = layout.palette.clone();
        layouts.push(layout);
    }
    assert!(layouts.len() >= 9);
    let never = AtomicBool::new(false);
    let overrides = Overrides { step: Some(2e-7), window: Some(350e-6), ..Overrides::default() };
    let cases = study.cases();
    let evaluator = Evaluator::new(&study.design, &cases, palette, overrides, &never).unwrap();
    let numbers: Vec<Vec<u8>> = layouts.iter().map(|layout| layout.materials.clone()).collect();
    let mut arose = 0;
    for (layout, marks) in layouts.iter().zip(evaluator.scores(&numbers, &never).unwrap()) {
        let sample = layout.sample();
        for (case, marks) in cases.iter().zip(marks) {
            let design = Design { impact: case.blow.pulse, ..study.design.clone() };
            let alone = evaluate(&design, layout, evaluator.plan(), &never).unwrap();
            let said = [alone.scores.focal_mean, alone.scores.protected_mean];
            assert_eq!([marks.scores.focal_mean, marks.scores.protected_mean], said, "{:?}", case.blow);
            let late = alone.record.contacts.iter().filter(|contact| {
                let [a, b] = contact.spheres.map(|i| sample.spheres[i].centre);
                (a[0] - b[0]).hypot(a[1] - b[1]) > 1.1 * layout.lattice.diameter()
            });
            arose += late.count();
        }
    }
    assert!(arose > 0);
}
