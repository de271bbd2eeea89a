//! Shards: evaluated apart, folded in any order, killed, damaged; the same bits as one machine.

use std::collections::BTreeSet;
use std::path::PathBuf;

use granulens::Context;
use granulens::search::{Assignment, Rng};
use granulens::study::{
    Asking, Ended, Engine, Entry, Local, Shard, State, Study, StudyError, evaluate_shard, merge, run, run_with,
};

use crate::{DESIGN, Desk, STAGED, STUDY};

impl Desk {
    /// Goes on with the search as far as the journal carries, and asks for more.
    fn ask(&self) -> (State, usize) {
        let study = self.study();
        let (mut asking, warnings) = Asking::open(&study, self.0.path()).unwrap();
        assert_eq!(warnings, Vec::<String>::new());
        let state = run_with(&study, &self.path("journal.jsonl"), &mut asking, &Context::default(), &mut ()).unwrap();
        (state, asking.asked)
    }

    fn shard(&self, shard: Shard) -> usize {
        let study = self.study();
        evaluate_shard(&study, self.0.path(), shard, &Context::default(), |_| ()).unwrap().evaluated
    }

    /// Asks for so many different layouts.
    fn random(&self, count: usize) {
        let study = self.study();
        let mut rng = Rng::new(5);
        let mut assignments: Vec<Assignment> = Vec::new();
        while assignments.len() < count {
            let assignment = study.space().random(&mut rng);
            if !assignments.contains(&assignment) {
                assignments.push(assignment);
            }
        }
        let (mut asking, _) = Asking::open(&study, self.0.path()).unwrap();
        asking.ask(0, &assignments.iter().collect::<Vec<_>>()).unwrap();
    }

    fn lines(&self) -> BTreeSet<String> {
        String::from_utf8(self.journal()).unwrap().lines().map(str::to_owned).collect()
    }
}

fn shuffled<T>(mut items: Vec<T>, rng: &mut Rng) -> Vec<T> {
    (0..items.len()).map(|_| items.swap_remove(rng.below(items.len() as u64) as usize)).collect()
}

/// Generations that depend on each other: a driver that forgets everything between two rounds, and three evaluators in any order.
#[test]
fn a_study_in_shards_comes_to_the_bits_of_one_machine() {
    for text in [&STUDY.replace("600", "200"), STAGED] {
        let desk = Desk::new(text);
        let (whole, _) = desk.run().unwrap();
        let journal = desk.journal();
        let desk = Desk::new(text);
        let mut rng = Rng::new(3);
        let mut rounds = 0;
        loop {
            let (state, asked) = desk.ask();
            if asked == 0 {
                assert_eq!(state, whole);
                break;
            }
            assert_eq!(state.ended, Ended::Asked);
            // To ask again without an answer asks for nothing new.
            assert_eq!(desk.ask(), (state, 0));
            let evaluated: usize =
                shuffled(Shard::all(3).collect(), &mut rng).into_iter().map(|shard| desk.shard(shard)).sum();
            assert_eq!(evaluated, asked);
            let merged = merge(desk.0.path()).unwrap();
            assert!(merged.is_whole() && merged.folded == asked, "{merged:?}");
            rounds += 1;
        }
        assert!(rounds > 1, "generations depend on each other");
        assert!(desk.journal() == journal);
    }
}

/// In any order, twice, by another number of shards too: every layout counts once, and its scores have the same bits.
#[test]
fn shards_fold_in_any_order_and_as_often_as_wanted() {
    let desk = Desk::new(STUDY);
    desk.random(60);
    desk.shard("1/1".parse().unwrap());
    merge(desk.0.path()).unwrap();
    let (journal, lines) = (desk.journal(), desk.lines());
    assert_eq!(lines.len(), 61);
    let mut rng = Rng::new(11);
    for folds in 0..4 {
        let desk = Desk::new(STUDY);
        desk.random(60);
        for shard in shuffled(Shard::all(4).collect(), &mut rng) {
            desk.shard(shard);
            if folds > 0 {
                merge(desk.0.path()).unwrap();
            }
        }
        for _ in 0..=folds {
            merge(desk.0.path()).unwrap();
        }
        assert!(folds > 0 || desk.journal() == journal);
        assert_eq!(desk.lines(), lines);
        // What is known is not evaluated again, by whatever shard.
        assert_eq!(Shard::all(7).map(|shard| desk.shard(shard)).sum::<usize>(), 0);
        let merged = merge(desk.0.path()).unwrap();
        assert_eq!((merged.folded, merged.repeated, merged.conflicts.len()), (0, 60, 0));
    }
    // Evaluated twice, as by two machines that did not know of each other.
    let twin = Desk::new(STUDY);
    twin.random(60);
    twin.shard("2/2".parse().unwrap());
    std::fs::copy(twin.path("shards/2-of-2.jsonl"), desk.path("shards/2-of-2.jsonl")).unwrap();
    let merged = merge(desk.0.path()).unwrap();
    assert!(merged.folded == 0 && merged.repeated > 0 && merged.conflicts.is_empty(), "{merged:?}");
    assert!(desk.journal() == journal);
}

/// A kill leaves a beginning, a bad disk a flipped bit, a slip another file: what is damaged is named, and all else counts.
#[test]
fn damaged_shards_are_named_and_the_rest_kept() {
    let desk = Desk::new(STUDY);
    desk.random(64);
    Shard::all(4).for_each(|shard| {
        desk.shard(shard);
    });
    let path = |k: u32| -> PathBuf { desk.path(&format!("shards/{k}-of-4.jsonl")) };
    let whole: Vec<Vec<u8>> = (1..=4).map(|k| std::fs::read(path(k)).unwrap()).collect();
    std::fs::write(path(1), &whole[0][..whole[0].len() / 2]).unwrap();
    let mut flipped = whole[1].clone();
    let middle = flipped.len() / 2;
    flipped[middle] ^= 4;
    std::fs::write(path(2), flipped).unwrap();
    std::fs::write(path(3), "dear diary\n").unwrap();
    let merged = merge(desk.0.path()).unwrap();
    let lost = whole[0].iter().filter(|&&b| b == b'\n').count()
        - whole[0][..whole[0].len() / 2].iter().filter(|&&b| b == b'\n').count();
    assert_eq!(merged.shards.iter().map(|shard| shard.missing).collect::<Vec<_>>(), [lost, 1, 16, 0]);
    let said: Vec<String> = merged.shards.iter().map(|shard| shard.damage.join("; ")).collect();
    assert!(said[0].contains("1-of-4.jsonl") && said[0].contains("torn"), "{said:?}");
    assert!(said[1].contains("2-of-4.jsonl") && said[1].contains("checksum"), "{said:?}");
    assert!(said[2].contains("3-of-4.jsonl") && said[2].contains("first line"), "{said:?}");
    assert_eq!((merged.answered, said[3].as_str()), (64 - lost - 17, ""));
    assert!(!merged.is_whole());
    // A shard that is no journal is left alone; its part is evaluated by others.
    assert!(std::fs::read(path(3)).unwrap() == b"dear diary\n");
    let refused = evaluate_shard(&desk.study(), desk.0.path(), "3/4".parse().unwrap(), &Context::default(), |_| ());
    assert!(refused.unwrap_err().to_string().contains("left alone"));
    assert_eq!(desk.shard("1/1".parse().unwrap()), lost + 17);
    let merged = merge(desk.0.path()).unwrap();
    assert!(merged.is_whole() && merged.conflicts.is_empty());
    let other = Desk::new(STUDY);
    other.random(64);
    other.shard("1/1".parse().unwrap());
    merge(other.0.path()).unwrap();
    assert_eq!(other.lines(), desk.lines());
}

/// Scores with other bits, as of a machine that computes otherwise: named, and what was known first counts.
#[test]
fn shards_that_disagree_are_named() {
    let desk = Desk::new(STUDY);
    desk.random(8);
    desk.shard("1/1".parse().unwrap());
    merge(desk.0.path()).unwrap();
    let lines = desk.lines();
    let path = desk.path("shards/1-of-1.jsonl");
    let mut entries = granulens::study::Journal::read(&path).unwrap().entries;
    entries[3].impacts[0].focal_mean *= 1.0 + f64::EPSILON;
    std::fs::remove_file(&path).unwrap();
    granulens::study::Journal::open(&path).unwrap().0.append(&entries).unwrap();
    let merged = merge(desk.0.path()).unwrap();
    assert_eq!((merged.folded, merged.repeated, merged.conflicts.len()), (0, 7, 1));
    assert!(merged.conflicts[0].contains("1-of-1.jsonl") && merged.conflicts[0].contains("layout 4"));
    assert_eq!(desk.lines(), lines);
}

/// What was interrupted goes on; what a guard stopped is an answer, what a kill left out is not.
#[test]
fn an_interrupted_shard_goes_on() {
    let desk = Desk::new(STUDY);
    desk.random(100);
    let study = desk.study();
    let shard: Shard = "1/1".parse().unwrap();
    let mut runs = 0;
    let mut evaluated = 0;
    loop {
        let context = Context::default();
        let done = evaluate_shard(&study, desk.0.path(), shard, &context, |_| {
            context.stop();
        })
        .unwrap();
        assert_eq!(done.known, evaluated);
        evaluated += done.evaluated;
        runs += 1;
        if done.is_whole() {
            break;
        }
    }
    assert!(runs > 2 && evaluated == 100, "{runs} runs, {evaluated}");
    assert!(merge(desk.0.path()).unwrap().is_whole());
}

/// An engine that answers late, or by another granulens.
struct Elsewhere<'a> {
    study: &'a Study,
    local: Local,
    left: usize,
    wrong: bool,
}

impl Engine for Elsewhere<'_> {
    fn entries(&mut self, rung: usize, assignments: &[&Assignment]) -> Result<Vec<Entry>, StudyError> {
        let some = assignments.len().min(self.left);
        self.left -= some;
        let mut entries = self.local.entries(self.study, rung, &assignments[..some], &Context::default())?;
        if self.wrong {
            entries.reverse();
        }
        Ok(entries)
    }
}

/// Whatever the engine, and wherever the driver ends: the same journal and the same state, which one machine goes on with too.
#[test]
fn a_driver_that_ends_anywhere_goes_on_to_the_same_bits() {
    let text = STUDY.replace("600", "200");
    let desk = Desk::new(&text);
    let (whole, _) = desk.run().unwrap();
    let journal = desk.journal();
    let never = Context::default();
    let drive = |desk: &Desk, study: &Study, left: usize, wrong: bool| {
        let mut engine = Elsewhere { study, local: Local::new(study, &never).unwrap(), left, wrong };
        run_with(study, &desk.path("journal.jsonl"), &mut engine, &never, &mut ())
    };
    let desk = Desk::new(&text);
    let study = desk.study();
    for left in [0, 7, 50] {
        assert_eq!(drive(&desk, &study, left, false).unwrap().ended, Ended::Asked);
    }
    let torn = desk.journal();
    desk.put(&torn[..torn.len() - 40]);
    let refused = drive(&desk, &study, 50, true).unwrap_err().to_string();
    assert!(refused.contains("other layouts than it was asked for"), "{refused}");
    assert_eq!(drive(&desk, &study, usize::MAX, false).unwrap(), whole);
    assert!(desk.journal() == journal);
    assert_eq!(run(&study, &desk.path("journal.jsonl"), &never, &mut ()).unwrap(), whole);
}

/// Each evaluation of the journal is explained: used, or which setting differs, and how many of its layouts were evaluated anew.
#[test]
fn why_names_the_setting_that_differs() {
    let text = STUDY.replace("600", "100");
    let desk = Desk::new(&text);
    desk.run().unwrap();
    let why = || granulens::study::why(&desk.study(), &desk.path("journal.jsonl")).unwrap();
    let kinds = why();
    assert_eq!((kinds.len(), kinds[0].evaluations, kinds[0].used), (1, 100, true));
    std::fs::write(desk.path("tiny.toml"), DESIGN.replace("16 kN", "12 kN")).unwrap();
    let kinds = why();
    assert_eq!((kinds.len(), kinds[0].used, kinds[0].anew), (1, false, 0));
    let named = |k: usize| -> Vec<String> {
        why()[k]
            .differences
            .as_ref()
            .unwrap()
            .iter()
            .map(|d| format!("{}: {:?} {:?}", d.setting, d.then, d.now))
            .collect()
    };
    let said = named(0).join("; ");
    assert!(said.contains("design.impact.force") && said.contains("16 kN") && said.contains("12 kN"), "{said}");
    // What follows from the force differs too, and nothing else.
    assert!(named(0).iter().all(|d| ["design.impact.force", "impact 1"].iter().any(|of| d.starts_with(of))), "{said}");
    desk.run().unwrap();
    let kinds = why();
    assert_eq!((kinds[0].evaluations, kinds[0].used, kinds[1].evaluations, kinds[1].used), (100, true, 100, false));
    // The start at least was evaluated under both.
    assert!(kinds[1].anew > 0);
    // Other rows: no setting differs, but the sites that may change do.
    std::fs::write(desk.path("study.toml"), text.replace("rows = [3, 5]", "rows = [4, 5]")).unwrap();
    let kinds = why();
    assert!(kinds.iter().all(|why| !why.used), "{kinds:?}");
    assert!(named(0).iter().any(|d| d.starts_with("which sites may change")), "{:?}", named(0));
    std::fs::write(desk.path("study.toml"), &text).unwrap();
    // Without the list of settings nobody can tell; a lone journal of 0.1 is such.
    std::fs::remove_file(desk.path("settings-history.jsonl")).unwrap();
    let kinds = why();
    assert_eq!(kinds.iter().map(|why| why.evaluations).sum::<usize>(), 200);
    assert!(kinds.iter().any(|why| !why.used && why.differences.is_none()));
}
