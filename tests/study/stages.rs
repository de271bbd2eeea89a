//! Several impacts, several steps, one after the other.

use granulens::Context;
use granulens::study::{Aggregate, Entry, Study, summary};

use crate::{Desk, STAGED, evaluator};

/// Under several impacts each is scored against uniform crystals under the same impact, as if it were the only one.
#[test]
fn several_impacts_are_scored_as_each_by_itself() {
    let desk = Desk::new(STAGED);
    let study = desk.study();
    let layouts: Vec<Vec<u8>> = study.first().iter().map(|assignment| study.materials(assignment)).collect();
    let never = Context::default();
    let together = evaluator(&study).scores(&layouts, &never).unwrap();
    for (k, impact) in study.impacts.iter().enumerate() {
        let alone = Study { impacts: vec![*impact], ..study.clone() };
        let runs = evaluator(&alone).scores(&layouts, &never).unwrap();
        for (both, one) in together.iter().zip(&runs) {
            assert_eq!((both.len(), one.len()), (2, 1));
            assert_eq!(both[k], one[0]);
        }
    }
    assert_ne!(together[0][0], together[0][1]);
    // The mean of two, and the worse of two.
    let entry = Entry::new(String::new(), String::new(), &study.by_impact(&together[0]));
    let stats = study.counter.stats(&layouts[0]);
    let contrast = |k: usize| together[0][k].scores.contrast.unwrap();
    let [mean, worst] =
        [Aggregate::Mean, Aggregate::Worst].map(|aggregate| summary(&entry, &stats, aggregate).contrast);
    assert_eq!(mean, Some((contrast(0) + contrast(1)) / 2.0));
    assert_eq!(worst, Some(contrast(0).min(contrast(1))));
}

/// A rung evaluates what was promoted to it, the best there is the study's, and steps agree about layouts.
#[test]
fn stages_promote_the_best_and_steps_are_compared() {
    let desk = Desk::new(STAGED);
    let (state, _) = desk.run().unwrap();
    let done: Vec<(&str, u64)> = state.stages.iter().map(|stage| (stage.method.as_str(), stage.evaluations)).collect();
    assert_eq!(done, [("level-set", 60), ("nsga2", 80), ("rescore", 24), ("anneal", 60), ("local-swaps", 40)]);
    assert_eq!(state.evaluations, 264);
    let [coarse, fine] = &state.rungs[..] else { panic!("{:?}", state.rungs) };
    assert_eq!((coarse.evaluations, fine.evaluations, fine.rank_correlation), (140, 124, Some(1.0)));
    // What was evaluated anew, and what the searches at the finer step came upon again.
    assert!(coarse.shared >= 24);
    // Twice the step moves scores by a percent or so, and layouts differ by much more.
    assert!(coarse.rank_correlation.unwrap() > 0.8, "{coarse:?}");
    // The best is one of the finest step, as simulated by itself.
    let (study, best) = (desk.study(), state.best.unwrap());
    let assignment = best.entry.assignment(study.free.len(), 2).unwrap();
    let mut fine = study.clone();
    fine.rungs.remove(0);
    let runs = evaluator(&fine).scores(&[study.materials(&assignment)], &Context::default()).unwrap();
    assert_eq!(best.entry.impacts[0].contrast, runs[0][0].scores.contrast);
    let stats = study.counter.stats(&study.materials(&assignment));
    assert_eq!((best.scores.half_mass, best.scores.lone), (Some(stats.half.mass), stats.lone));
}

/// Under an impact that is too strong for brass on the first row there is no Q: a study that does not ask for it goes on and
/// says so, one that does is refused.
#[test]
fn an_impact_too_strong_for_the_lens_material_leaves_no_protection() {
    let strong = STAGED.replace("12 kN", "60 kN").replace("8e-7 s", "7e-7 s");
    let desk = Desk::new(&strong);
    let (state, told) = desk.run().unwrap();
    assert!(
        told.warnings.iter().any(|warning| warning.contains("no Q") && warning.contains("brass-260")),
        "{:?}",
        told.warnings
    );
    let best = state.best.unwrap().scores;
    assert!(best.contrast.is_some() && best.focal_gain.is_some() && best.protection.is_none());
    let desk = Desk::new(&strong.replace("[objective]", "[objective]\nprotection = { max = 2 }"));
    let refusal = desk.run().map(|_| ()).unwrap_err().to_string();
    assert!(refusal.contains("brass-260 alone"), "{refusal}");
}
