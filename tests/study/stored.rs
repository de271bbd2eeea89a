//! The layouts in `studies/`, against what is said about them in `docs/optimiser.md`.

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use granulens::dem::ForcePulse;
use granulens::design::Design;
use granulens::evaluate::{Evaluator, Marks, Overrides};
use granulens::layout;
use granulens::material;

fn repository(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// Scores of a stored layout, simulated at a step (s).
fn scores(file: &str, impacts: Option<&[ForcePulse]>, step: f64) -> Vec<Marks> {
    let design = Design::read(repository("designs/quickstart.toml")).unwrap();
    let brass = material::find("brass-260", &[]).unwrap();
    let palette = [design.host.clone(), brass];
    let layout = layout::read(&repository(file), design.lattice, &palette, &[]).unwrap();
    let overrides = Overrides { step: Some(step), window: Some(350e-6), ..Overrides::default() };
    let own = [design.impact];
    let never = AtomicBool::new(false);
    let evaluator = Evaluator::new(&design, impacts.unwrap_or(&own), layout.palette, overrides, &never).unwrap();
    evaluator.marks(&[layout.materials], &never).unwrap().remove(0)
}

/// At the step at which they are quoted, to the digits that are quoted; at half of it, to the 1 % that the second late pushes on
/// single spheres are worth.
#[test]
fn stored_layouts_are_as_good_as_is_said() {
    for (file, [contrast, gain, protection]) in [
        ("studies/two-materials-found.csv", [5.041, 1.338, 0.647]),
        ("studies/two-materials-best.csv", [5.221, 1.327, 0.620]),
        ("studies/four-materials-best.csv", [6.353, 1.511, 0.5805]),
        ("studies/four-materials-gain-best.csv", [5.531, 2.290, 1.010]),
    ] {
        for (step, tolerance) in [(5e-8, 1e-3), (2.5e-8, 1e-2)] {
            let marks = &scores(file, None, step)[0];
            assert_eq!(marks.stop, None);
            for (found, said) in [(marks.contrast, contrast), (marks.focal_gain, gain), (marks.protection, protection)]
            {
                let found = found.unwrap();
                assert!((found / said - 1.0).abs() < tolerance, "{file} at {step}: {found} is not {said}");
            }
        }
    }
}
