//! The same bits whatever ends a run, and on any number of threads.

use std::time::Instant;

use granulens::Context;
use granulens::evaluate::EvaluatorError;
use granulens::search::Rng;
use granulens::study::{Ended, State, StudyError, Watch, run};

use crate::{Desk, STAGED, STUDY, with_threads};

/// What a kill leaves is a beginning of the journal, of any length.
#[test]
fn a_study_killed_anywhere_comes_to_the_same_bits() {
    for (text, evaluations) in [(STUDY, 600), (STAGED, 264)] {
        let desk = Desk::new(text);
        let (state, told) = desk.run().unwrap();
        let journal = desk.journal();
        assert_eq!((state.evaluations, state.ended, told.simulated), (evaluations as u64, Ended::Budget, evaluations));
        assert!(told.warnings.is_empty());
        let mut rng = Rng::new(1);
        let mut cuts: Vec<usize> = (0..20).map(|_| rng.below(journal.len() as u64) as usize).collect();
        // Nothing, within the first line, and the whole.
        cuts.extend([0, 5, journal.len()]);
        for cut in cuts {
            desk.put(&journal[..cut]);
            let kept = journal[..cut].iter().filter(|&&byte| byte == b'\n').count().saturating_sub(1);
            let (again, told) = desk.run().unwrap();
            assert_eq!(again, state, "cut at {cut}");
            assert!(desk.journal() == journal, "cut at {cut}");
            assert_eq!(told.simulated, evaluations - kept);
            let torn = cut > 0 && journal[cut - 1] != b'\n';
            assert_eq!(told.warnings.iter().filter(|w| w.contains("torn")).count(), usize::from(torn), "{cut}");
        }
    }
}

/// A run whose time is over goes on where it was, as one that is interrupted does.
#[test]
fn a_study_out_of_time_goes_on() {
    let desk = Desk::new(STAGED);
    let whole = desk.run().unwrap().0;
    let desk = Desk::new(STAGED);
    let mut hurried = desk.study();
    hurried.time = Some(1e-9);
    let state = run(&hurried, &desk.path("journal.jsonl"), &Context::default(), &mut ()).unwrap();
    assert_eq!((state.ended, state.evaluations), (Ended::Time, 0));
    hurried.time = Some(1e6);
    assert_eq!(run(&hurried, &desk.path("journal.jsonl"), &Context::default(), &mut ()).unwrap(), whole);
}

/// Ctrl-C between any two batches, again and again.
#[test]
fn an_interrupted_study_goes_on_where_it_was() {
    let desk = Desk::new(&STUDY.replace("600", "400"));
    let (whole, _) = desk.run().unwrap();
    let journal = desk.journal();
    desk.put(b"");
    struct Press<'a>(&'a Context, usize);
    impl Watch for Press<'_> {
        fn warning(&mut self, _: &str) {}
        fn batch(&mut self, _: &State, simulated: usize) {
            self.1 += simulated;
            if self.1 > 40 {
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

/// Ctrl-C at any moment of what follows the last batch, where the best layout's figures are worked out: the study is interrupted, not faulty.
#[test]
fn a_study_interrupted_at_its_end_goes_on() {
    struct Batches(usize);
    impl Watch for Batches {
        fn warning(&mut self, _: &str) {}
        fn batch(&mut self, _: &State, _: usize) {
            self.0 += 1;
        }
    }
    let desk = Desk::new(&STUDY.replace("600", "100"));
    let whole = desk.run().unwrap().0;
    let begun = Instant::now();
    desk.run().unwrap();
    let length = begun.elapsed();
    let mut interrupted = 0;
    for part in 0..60 {
        let context = Context::default();
        let asked = context.clone();
        let mut batches = Batches(0);
        let state = std::thread::scope(|scope| {
            scope.spawn(move || {
                std::thread::sleep(length * part / 60);
                asked.stop();
            });
            run(&desk.study(), &desk.path("journal.jsonl"), &context, &mut batches)
        });
        match state {
            Ok(state) if state.ended == Ended::Interrupted => interrupted += 1,
            Ok(state) => assert_eq!(state, whole),
            // Before its host is known nothing of a study can be told.
            Err(StudyError::Evaluator(EvaluatorError::Interrupted)) if batches.0 == 0 => {}
            Err(error) => panic!("moment {part} of 60: {error}"),
        }
    }
    assert!(interrupted > 0);
}

#[test]
fn one_and_two_threads_give_the_same_bits() {
    for text in [STUDY, STAGED] {
        let [one, two] = [1, 2].map(|threads| {
            let desk = Desk::new(text);
            let state = with_threads(threads, || desk.run().unwrap().0);
            (state, desk.journal())
        });
        assert!(one == two);
    }
}
