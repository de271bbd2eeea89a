//! Studies: the optimum of a crystal that can be enumerated; the same bits whatever kills a run and on any number of threads;
//! journals that are torn, damaged or foreign.

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use granulens::evaluate::Evaluator;
use granulens::search::Dice;
use granulens::study::{Ended, Entry, Journal, Key, State, Study, StudyError, Watch, run};

/// A crystal of 32 spheres, of which 12 may change: what is quickest to simulate.
const DESIGN: &str = r#"format = 1
name = "tiny"
[crystal]
packing = "hexagonal-2d"
diameter = "6.35 mm"
rows = 8
half_width = 3.5
sides = "mirror"
host = "stainless-440c"
[impact]
kind = "force-pulse"
force = "16 kN"
duration = "20 us"
[target]
focus = { rows = [7, 8], x = ["0 D", "1 D"] }
protect = { rows = [7, 8], x = ["2.5 D", "3.5 D"] }
[run]
step = "4e-7 s"
window = "80 us"
"#;

const STUDY: &str = r#"format = 1
design = "tiny.toml"
materials = ["stainless-440c", "brass-260"]
rows = [3, 5]
objective = { maximise = "contrast", min_focal_gain = 0.8 }
budget = 600
seed = 1
method = "genetic+local"
start = "random"
"#;

struct Desk(tempfile::TempDir);

impl Desk {
    fn new(study: &str) -> Self {
        let desk = Self(tempfile::tempdir().unwrap());
        std::fs::write(desk.path("tiny.toml"), DESIGN).unwrap();
        std::fs::write(desk.path("study.toml"), study).unwrap();
        desk
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn study(&self) -> Study {
        Study::read(&self.path("study.toml"), None).unwrap()
    }

    fn run(&self) -> Result<(State, Told), StudyError> {
        let mut told = Told::default();
        let state = run(&self.study(), &self.path("journal.jsonl"), &AtomicBool::new(false), &mut told)?;
        Ok((state, told))
    }

    fn journal(&self) -> Vec<u8> {
        std::fs::read(self.path("journal.jsonl")).unwrap()
    }

    fn put(&self, journal: &[u8]) {
        std::fs::write(self.path("journal.jsonl"), journal).unwrap();
    }
}

#[derive(Default)]
struct Told {
    warnings: Vec<String>,
    simulated: usize,
}

impl Watch for Told {
    fn warning(&mut self, text: &str) {
        self.warnings.push(text.to_owned());
    }
    fn batch(&mut self, _: &State, simulated: usize) {
        self.simulated += simulated;
    }
}

fn with_threads<T: Send>(threads: usize, job: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap().install(job)
}

/// The journal's entries for all 4096 choices, by brute force.
fn enumerated(study: &Study) -> Vec<Entry> {
    let evaluator =
        Evaluator::new(&study.design, study.palette.clone(), study.overrides, &AtomicBool::new(false)).unwrap();
    let key = Key::new(study, evaluator.plan());
    let layouts: Vec<Vec<u8>> = (0..1_u32 << study.free.len())
        .map(|bits| study.layout(&(0..study.free.len()).map(|k| (bits >> k & 1) as u8).collect::<Vec<_>>()).materials)
        .collect();
    let marks = evaluator.marks(&layouts, &AtomicBool::new(false)).unwrap();
    layouts.iter().zip(&marks).map(|(layout, marks)| Entry::new(key.of(layout), String::new(), marks)).collect()
}

#[test]
fn every_method_finds_the_optimum_of_a_crystal_that_can_be_enumerated() {
    let desk = Desk::new(&STUDY.replace("600", "4096"));
    let study = desk.study();
    let free = study.free.len();
    assert_eq!(free, 12);
    let entries = enumerated(&study);
    let met = entries.iter().filter(|entry| study.objective.is_met(entry)).count();
    assert!(met > 0 && met < entries.len(), "the limit must bind somewhere: {met}");
    let (optimum, least) = entries
        .iter()
        .filter(|entry| study.objective.is_met(entry))
        .map(|entry| (entry, study.objective.loss(entry)))
        .min_by(|a, b| a.1.total_cmp(&b.1))
        .unwrap();
    for method in ["genetic", "local", "genetic+local"] {
        let mut study = study.clone();
        study.method = method.parse().unwrap();
        let journal = desk.path(&format!("{method}.jsonl"));
        let state = run(&study, &journal, &AtomicBool::new(false), &mut ()).unwrap();
        let best = state.best.unwrap();
        assert!(best.within_limits);
        assert_eq!(study.objective.loss(&best.entry), least, "{method}");
        assert_eq!(best.entry.key, optimum.key, "{method}");
    }
}

/// What a kill leaves is a beginning of the journal, of any length.
#[test]
fn a_study_killed_anywhere_comes_to_the_same_bits() {
    let desk = Desk::new(STUDY);
    let (state, told) = desk.run().unwrap();
    let journal = desk.journal();
    assert_eq!((state.evaluations, state.ended, told.simulated), (600, Ended::Budget, 600));
    assert!(told.warnings.is_empty());
    let mut dice = Dice::new(1);
    let mut cuts: Vec<usize> = (0..20).map(|_| dice.below(journal.len() as u64) as usize).collect();
    // Nothing, within the first line, and the whole.
    cuts.extend([0, 5, journal.len()]);
    for cut in cuts {
        desk.put(&journal[..cut]);
        let kept = journal[..cut].iter().filter(|&&byte| byte == b'\n').count().saturating_sub(1);
        let (again, told) = desk.run().unwrap();
        assert_eq!(again, state, "cut at {cut}");
        assert!(desk.journal() == journal, "cut at {cut}");
        assert_eq!(told.simulated, 600 - kept);
        let torn = cut > 0 && journal[cut - 1] != b'\n';
        assert_eq!(told.warnings.iter().filter(|w| w.contains("torn")).count(), usize::from(torn), "{cut}");
    }
}

/// Ctrl-C between any two batches, again and again.
#[test]
fn an_interrupted_study_goes_on_where_it_was() {
    let desk = Desk::new(&STUDY.replace("600", "400"));
    let (whole, _) = desk.run().unwrap();
    let journal = desk.journal();
    desk.put(b"");
    struct Press<'a>(&'a AtomicBool, usize);
    impl Watch for Press<'_> {
        fn warning(&mut self, _: &str) {}
        fn batch(&mut self, _: &State, simulated: usize) {
            self.1 += simulated;
            self.0.store(self.1 > 40, std::sync::atomic::Ordering::Relaxed);
        }
    }
    for _ in 0..100 {
        let interrupt = AtomicBool::new(false);
        let state = run(&desk.study(), &desk.path("journal.jsonl"), &interrupt, &mut Press(&interrupt, 0)).unwrap();
        if state.ended != Ended::Interrupted {
            assert_eq!(state, whole);
            assert!(desk.journal() == journal);
            return;
        }
    }
    panic!("it never ends");
}

#[test]
fn one_and_two_threads_give_the_same_bits() {
    let [one, two] = [1, 2].map(|threads| {
        let desk = Desk::new(STUDY);
        let state = with_threads(threads, || desk.run().unwrap().0);
        (state, desk.journal())
    });
    assert!(one == two);
}

#[test]
fn a_flipped_bit_is_found_and_its_evaluation_done_anew() {
    let desk = Desk::new(STUDY);
    let (state, _) = desk.run().unwrap();
    let journal = desk.journal();
    let header = journal.iter().position(|&byte| byte == b'\n').unwrap() + 1;
    let mut dice = Dice::new(2);
    for _ in 0..20 {
        let mut flipped = journal.clone();
        let at = header + dice.below((journal.len() - header) as u64) as usize;
        flipped[at] ^= 1 << dice.below(8);
        // A flip that ends the last line's end makes it a torn one.
        desk.put(&flipped);
        let (again, told) = desk.run().unwrap();
        assert_eq!(again, state, "byte {at}");
        assert!((1..=2).contains(&told.simulated), "byte {at}: {}", told.simulated);
        assert!(!told.warnings.is_empty());
    }
    let mut flipped = journal.clone();
    flipped[header / 2] ^= 1;
    desk.put(&flipped);
    let refusal = desk.run().map(|_| ()).unwrap_err().to_string();
    assert!(refusal.contains("no whole first line") && refusal.contains("left alone"), "{refusal}");
    assert!(desk.journal() == flipped);
}

#[test]
fn foreign_files_are_refused_and_left_alone() {
    let desk = Desk::new(STUDY);
    // A header as a later version would write it, with its right checksum.
    let later = b"{\"journal\":\"granulens-study\",\"format\":2,\"version\":\"9.9.9\",\"crc\":\"CRC\"}\n";
    for (text, says) in [(&later[..], "first line"), (b"dear diary\n", "first line"), (b"dear diary", "no journal")] {
        desk.put(text);
        let refusal = desk.run().map(|_| ()).unwrap_err().to_string();
        assert!(refusal.contains(says), "{refusal}");
        assert!(desk.journal() == text);
    }
}

#[test]
fn a_second_run_waits_for_the_first() {
    let desk = Desk::new(STUDY);
    let held = Journal::open(&desk.path("journal.jsonl")).unwrap();
    let refusal = desk.run().map(|_| ()).unwrap_err().to_string();
    assert!(refusal.contains("another run is writing"), "{refusal}");
    drop(held);
}

#[test]
fn evaluations_of_other_settings_are_not_used() {
    let desk = Desk::new(&STUDY.replace("600", "200"));
    desk.run().unwrap();
    std::fs::write(desk.path("tiny.toml"), DESIGN.replace("16 kN", "12 kN")).unwrap();
    let (_, told) = desk.run().unwrap();
    assert_eq!(told.simulated, 200);
    assert!(told.warnings[0].contains("200 evaluations of the journal belong to other settings"));
}

#[test]
fn wrong_study_files_hear_their_line() {
    for (old, new, says) in [
        ("format = 1", "format = 2", "study.toml:1: format = 2 must be 1"),
        ("tiny.toml", "none.toml", "none.toml: no such file"),
        ("brass-260", "bras-260", "study.toml:3: materials: unknown material \"bras-260\" (did you mean"),
        ("rows = [3, 5]", "rows = [5, 3]", "study.toml:4: rows = [5, 3] must be"),
        ("rows = [3, 5]", "rows = [3, 9]", "of rows 1 to 8"),
        ("maximise", "minimise", "study.toml:5: objective asks for one of"),
        ("\"contrast\"", "\"colour\"", "study.toml:5: objective: unknown variant `colour`"),
        ("0.8", "-0.8", "study.toml:5: objective: min_focal_gain = -0.8 must be positive"),
        ("budget = 600", "budget = 0", "study.toml:6: budget = 0 must be 1"),
        ("budget = 600", "budget = -1", "study.toml:6: budget: invalid value: integer `-1`, expected a whole number"),
        ("budget", "budged", "study.toml:6: unknown field `budged`"),
        ("genetic+local", "magic", "study.toml:8: unknown method \"magic\"; known are genetic, local"),
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
}

#[test]
fn the_study_of_the_repository_is_sound() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("studies/two-materials.toml");
    let study = Study::read(&path, None).unwrap();
    assert_eq!((study.free.len(), study.letters.as_slice()), (357, &[0, 1][..]));
    assert_eq!(study.layout(&study.first()).materials, study.base);
}
