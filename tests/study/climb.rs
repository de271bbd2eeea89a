//! Annealing at low temperature, screened at a coarse step; and the figures that a study ends with.

use granulens::Context;
use granulens::dem::ForcePulse;
use granulens::evaluate::{Evaluator, Forces, Overrides, Plan, beside_uniform};
use granulens::layout::Layout;
use granulens::score::Measure;
use granulens::search::Rng;
use granulens::study::{Ended, Journal, Key, State, Watch, run};

use crate::{Desk, STUDY, with_threads};

/// A stage of level sets, then a climb from the two best of them that are not alike; judged over three forces.
fn climbing(evaluations: usize) -> String {
    STUDY
        .replace("budget = 600\n", "")
        .replace("method = \"genetic+local\"\n", "")
        .replace("focal-gain = { min = 0.8 }", "focal-gain = { min = 0.95 }")
        + &format!(
            "[[stage]]\nmethod = \"level-set\"\nevaluations = 40\nstep = \"8e-7 s\"\n\
             [[stage]]\nmethod = \"climb\"\nevaluations = {evaluations}\nscreen = \"8e-7 s\"\nstep = \"4e-7 s\"\nforces = 3\n\
             temperature = [0.01, 0.001]\npromote = 2\n"
        )
}

/// The best of all 4096 layouts over the same forces.
#[test]
fn a_climb_finds_the_optimum_of_a_crystal_that_can_be_enumerated() {
    let desk = Desk::new(&climbing(4000));
    let study = desk.study();
    let state = desk.run().unwrap().0;
    assert_eq!(state.ended, Ended::Budget);
    let judge = study.at(1);
    assert_eq!((judge.forces.count(), study.at(0).forces.count()), (3, 1));
    let never = Context::default();
    let evaluator =
        Evaluator::new(&judge.design, &judge.cases(), judge.palette.clone(), judge.overrides(1), &never).unwrap();
    let assignments: Vec<Vec<u8>> =
        (0..4096_u32).map(|bits| (0..12).map(|k| (bits >> k & 1) as u8).collect()).collect();
    let layouts: Vec<Vec<u8>> = assignments.iter().map(|assignment| study.materials(assignment)).collect();
    let key = Key::new(&judge, evaluator.plan());
    let mut rung = granulens::study::Rung::default();
    for ((assignment, layout), runs) in
        assignments.iter().zip(&layouts).zip(evaluator.scores(&layouts, &never).unwrap())
    {
        let entry = granulens::study::Entry::new(key.of(layout), String::new(), &judge.by_impact(&runs));
        rung.add(&judge, assignment, entry);
    }
    let optimum = rung.ranked()[0];
    let best = state.best.unwrap();
    assert_eq!(best.loss, optimum.loss.total);
    assert_eq!(best.entry.impacts, optimum.entry.impacts);
    // It has screened most of what it looked at, and judged little of that.
    let climb = &state.stages[1];
    assert!(climb.judged > 0 && climb.judged * 4 < climb.evaluations, "{climb:?}");
    assert_eq!((state.rungs[0].forces, state.rungs[1].forces), (1, 3));
}

/// Whatever ends a run, and on any number of threads; runs that were cut short are journalled as such, and what they say is a bound.
#[test]
fn a_climb_comes_to_the_same_bits() {
    // Looked at for less long than it is judged.
    let text = climbing(480).replace("screen = ", "screen_window = \"72 us\"\nscreen = ");
    let desk = Desk::new(&text);
    let (state, told) = desk.run().unwrap();
    let journal = desk.journal();
    let mut rng = Rng::new(1);
    let mut cuts: Vec<usize> = (0..12).map(|_| rng.below(journal.len() as u64) as usize).collect();
    cuts.push(journal.len());
    for cut in cuts {
        desk.put(&journal[..cut]);
        let kept = journal[..cut].iter().filter(|&&byte| byte == b'\n').count().saturating_sub(1);
        let (again, told_again) = desk.run().unwrap();
        assert_eq!(again, state, "cut at {cut}");
        assert!(desk.journal() == journal, "cut at {cut}");
        assert_eq!(told_again.simulated, told.simulated - kept);
    }
    let [one, two] = [1, 2].map(|threads| {
        let desk = Desk::new(&text);
        (with_threads(threads, || desk.run().unwrap().0), desk.journal())
    });
    assert!(one == two && one.0 == state && one.1 == journal);

    let study = desk.study();
    let loaded = Journal::read(&desk.path("journal.jsonl")).unwrap();
    let cut: Vec<_> = loaded.entries.iter().filter(|entry| entry.cut).collect();
    assert!(!cut.is_empty() && loaded.entries.iter().any(|entry| !entry.cut));
    let never = Context::default();
    let screen =
        Evaluator::new(&study.design, &study.cases(), study.palette.clone(), study.overrides(1), &never).unwrap();
    assert_eq!([0, 1, 2].map(|rung| study.plan(rung).unwrap().window), [80e-6, 72e-6, 80e-6]);
    let layouts: Vec<Vec<u8>> = cut.iter().map(|entry| study.materials(&entry.assignment(12, 2).unwrap())).collect();
    for (entry, whole) in cut.iter().zip(screen.scores(&layouts, &never).unwrap()) {
        assert!(entry.stop.as_ref().unwrap().contains("cannot be reached"), "{:?}", entry.stop);
        assert!(entry.impacts[0].protected_mean <= whole[0].scores.protected_mean);
    }
}

#[test]
fn an_interrupted_climb_goes_on_where_it_was() {
    let desk = Desk::new(&climbing(160));
    let (whole, _) = desk.run().unwrap();
    let journal = desk.journal();
    desk.put(b"");
    struct Press<'a>(&'a Context, usize);
    impl Watch for Press<'_> {
        fn warning(&mut self, _: &str) {}
        fn batch(&mut self, _: &State, simulated: usize) {
            self.1 += simulated;
            if self.1 > 20 {
                self.0.stop();
            }
        }
    }
    for _ in 0..100 {
        let context = Context::default();
        let state = run(&desk.study(), &desk.path("journal.jsonl"), &context, &mut Press(&context, 0)).unwrap();
        if state.ended != Ended::Interrupted {
            assert_eq!(state, whole);
            assert!(desk.journal() == journal);
            return;
        }
    }
    panic!("it never ends");
}

/// Figures at the end are those of `check`, at the study's step and at half of it, to the last bit.
#[test]
fn final_figures_are_those_of_check() {
    let desk = Desk::new(&STUDY.replace("600", "80"));
    let state = desk.run().unwrap().0;
    let study = desk.study();
    let found = state.best.unwrap();
    let (design, palette) = (study.design.plane().unwrap(), study.palette.clone());
    let materials = study.materials(&found.entry.assignment(12, 2).unwrap());
    let layout = Layout { lattice: design.lattice.clone(), palette, materials };
    assert_eq!(state.finals.iter().map(|of| of.step).collect::<Vec<_>>(), [4e-7, 2e-7]);
    assert_eq!(state.finals[0].exact.contrast, found.scores.contrast);
    for figures in &state.finals {
        let overrides = Overrides { step: Some(figures.step), ..study.overrides(0) };
        let plan = Plan::new(design, overrides, &study.palette).unwrap();
        let beside = beside_uniform(design, &layout, &plan, Forces::USUAL, &Context::default()).unwrap();
        let (mean, spreads) = beside.over_forces.unwrap();
        for measure in [Measure::Contrast, Measure::FocalGain, Measure::FocalMean, Measure::ProtectedMean] {
            assert_eq!(figures.exact.get(measure), beside.evaluation.scores.get(measure), "{measure:?}");
            assert_eq!(figures.smoothed.get(measure), mean.get(measure), "{measure:?}");
        }
        assert_eq!(figures.scatter[0], spreads.deviation(Measure::Contrast));
    }
}

/// Pulses that differ stand side by side in the lanes, and each layout has the bits of a run by itself.
#[test]
fn forces_and_durations_side_by_side_have_the_bits_of_runs_alone() {
    let desk = Desk::new(STUDY);
    let study = desk.study();
    let never = Context::default();
    let pulse = |force: f64, duration: f64| ForcePulse { force, duration };
    let pulses = [pulse(16e3, 20e-6), pulse(15.9e3, 20e-6), pulse(8e3, 33e-6), pulse(20e3, 7.3e-6), pulse(16e3, 1e-6)];
    let scores = |pulses: &[ForcePulse]| {
        let overrides = study.overrides(0);
        let evaluator = Evaluator::new(&study.design, pulses, study.palette.clone(), overrides, &never).unwrap();
        let layouts: Vec<Vec<u8>> =
            (0..3).map(|k| study.materials(&std::array::from_fn::<u8, 12, _>(|i| u8::from(i % 3 == k)))).collect();
        evaluator.scores(&layouts, &never).unwrap()
    };
    let together = scores(&pulses);
    for (case, pulse) in pulses.iter().enumerate() {
        for (layout, alone) in scores(std::slice::from_ref(pulse)).into_iter().enumerate() {
            assert_eq!(together[layout][case], alone[0], "{pulse:?}");
        }
    }
}
