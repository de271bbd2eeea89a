//! Every method finds what brute force finds, within the limits.

use granulens::Context;
use granulens::search::front;
use granulens::study::{Entry, Key, Rung, Study, Work, run};

use crate::{Desk, STUDY, evaluator};

/// All 4096 assignments, by brute force.
fn enumerated(study: &Study) -> Rung {
    let evaluator = evaluator(study);
    let key = Key::new(study, evaluator.plan());
    let assignments: Vec<Vec<u8>> = (0..1_u32 << study.free.len())
        .map(|bits| (0..study.free.len()).map(|k| (bits >> k & 1) as u8).collect::<Vec<_>>())
        .collect();
    let layouts: Vec<Vec<u8>> = assignments.iter().map(|assignment| study.materials(assignment)).collect();
    let runs = evaluator.scores(&layouts, &Context::default()).unwrap();
    let mut rung = Rung::default();
    for ((assignment, layout), runs) in assignments.iter().zip(&layouts).zip(&runs) {
        rung.add(study, assignment, Entry::new(key.of(layout), String::new(), &study.by_impact(runs)));
    }
    rung
}

#[test]
fn every_method_finds_the_optimum_of_a_crystal_that_can_be_enumerated() {
    let desk = Desk::new(&STUDY.replace("600", "4096"));
    let study = desk.study();
    assert_eq!(study.free.len(), 12);
    let rung = enumerated(&study);
    let met = rung.all().iter().filter(|judged| judged.loss.miss == 0.0).count();
    assert!(met > 0 && met < rung.all().len(), "the limit must bind somewhere: {met}");
    let optimum = rung.ranked()[0];
    for method in ["genetic", "local", "local-swaps", "genetic+local", "anneal", "level-set", "nsga2"] {
        let mut study = study.clone();
        study.stages[0].work = Work::Search(method.parse().unwrap());
        let journal = desk.path(&format!("{method}.jsonl"));
        let state = run(&study, &journal, &Context::default(), &mut ()).unwrap();
        assert_eq!(state.nearest, None);
        let best = state.best.unwrap();
        assert!(best.within_limits);
        assert_eq!(best.entry.key, optimum.entry.key, "{method}");
    }
}

/// The front of two measures, against all assignments; its knee and its volume are those of the true one.
#[test]
fn nsga_finds_the_front_of_a_crystal_that_can_be_enumerated() {
    let traded = "objective = { contrast = { maximise = 1 }, mass = { minimise = 1 }, focal-gain = { min = 0.8 } }\n";
    let objective = STUDY.lines().find(|line| line.starts_with("objective")).unwrap();
    let desk =
        Desk::new(&STUDY.replace("600", "2500").replace(objective, traded.trim()).replace("genetic+local", "nsga2"));
    let study = desk.study();
    let rung = enumerated(&study);
    let losses: Vec<_> = rung.all().iter().map(|judged| judged.loss.clone()).collect();
    let mut truth: Vec<&str> = front(&losses).into_iter().map(|k| rung.all()[k].entry.key.as_str()).collect();
    let found = desk.run().unwrap().0.front.unwrap();
    assert_eq!(found.measures, ["contrast", "half_mass"]);
    let mut keys: Vec<&str> = found.layouts.iter().map(|layout| layout.entry.key.as_str()).collect();
    truth.sort_unstable();
    keys.sort_unstable();
    assert!(truth.len() > 3);
    assert_eq!(keys, truth);
    assert!(found.layouts.iter().all(|layout| layout.within_limits));
    assert!(found.hypervolume.unwrap() > 0.0 && found.knee.is_some());
}

/// A limit that no layout keeps: what is returned says so, and is not called the best.
#[test]
fn limits_are_never_missed_by_what_is_called_the_best() {
    let desk = Desk::new(&STUDY.replace("min = 0.8", "min = 8"));
    let state = desk.run().unwrap().0;
    assert_eq!(state.best, None);
    assert!(state.nearest.is_some_and(|nearest| !nearest.within_limits));
    let limits = "objective = { contrast = { maximise = 1 }, lone = { max = 0 }, spheres = { max = 5 } }";
    let objective = STUDY.lines().find(|line| line.starts_with("objective")).unwrap();
    let desk = Desk::new(&STUDY.replace(objective, limits));
    let best = desk.run().unwrap().0.best.unwrap();
    assert!(best.within_limits && best.scores.lone == Some(0) && best.scores.half_spheres <= Some(5));
}
