//! Studies: the optimum of a crystal that can be enumerated; the same bits whatever kills a run and on any number of threads;
//! journals that are torn, damaged or foreign.

use std::path::{Path, PathBuf};
use std::sync::atomic::AtomicBool;

use granulens::evaluate::Evaluator;
use granulens::search::{Dice, front};
use granulens::study::{Ended, Entry, Journal, Key, Over, Rung, State, Study, StudyError, Summary, Watch, Work, run};

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
objective = { contrast = { maximise = 1 }, focal-gain = { min = 0.8 } }
budget = 600
seed = 1
method = "genetic+local"
start = "random"
"#;

/// Everything at once: stages at two steps, several impacts, measures that are traded, a limit.
const STAGED: &str = r#"format = 1
design = "tiny.toml"
materials = ["stainless-440c", "brass-260"]
rows = [3, 5]
seed = 1
start = ["random", "random"]
over = "mean"
[objective]
contrast = { maximise = 1 }
mass = { minimise = 0.5 }
focal-gain = { min = 0.7 }
[[impact]]
force = "16 kN"
duration = "20 us"
[[impact]]
force = "12 kN"
duration = "16 us"
[[stage]]
method = "level-set"
evaluations = 60
step = "8e-7 s"
[[stage]]
method = "nsga2"
evaluations = 80
step = "8e-7 s"
[[stage]]
method = "rescore"
promote = 12
sample = 12
step = "4e-7 s"
[[stage]]
method = "anneal"
evaluations = 60
step = "4e-7 s"
[[stage]]
method = "local-swaps"
evaluations = 40
step = "4e-7 s"
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

/// All 4096 choices, by brute force.
fn enumerated(study: &Study) -> Rung {
    let evaluator = evaluator(study);
    let key = Key::new(study, evaluator.plan());
    let choices: Vec<Vec<u8>> = (0..1_u32 << study.free.len())
        .map(|bits| (0..study.free.len()).map(|k| (bits >> k & 1) as u8).collect::<Vec<_>>())
        .collect();
    let layouts: Vec<Vec<u8>> = choices.iter().map(|choice| study.layout(choice).materials).collect();
    let marks = evaluator.marks(&layouts, &AtomicBool::new(false)).unwrap();
    let mut rung = Rung::default();
    for ((choice, layout), marks) in choices.iter().zip(&layouts).zip(&marks) {
        rung.add(study, choice, Entry::new(key.of(layout), String::new(), marks));
    }
    rung
}

fn evaluator(study: &Study) -> Evaluator<'_> {
    let never = AtomicBool::new(false);
    Evaluator::new(&study.design, &study.impacts, study.palette.clone(), study.overrides(0), &never).unwrap()
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
        let state = run(&study, &journal, &AtomicBool::new(false), &mut ()).unwrap();
        assert_eq!(state.nearest, None);
        let best = state.best.unwrap();
        assert!(best.within_limits);
        assert_eq!(best.entry.key, optimum.entry.key, "{method}");
    }
}

/// The front of two measures, against all choices; its knee and its volume are those of the true one.
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
    assert_eq!(found.measures, ["contrast", "mass"]);
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
    assert!(best.within_limits && best.summary.fabric.lone == 0 && best.summary.fabric.spheres <= 5);
}

/// Under several impacts each is scored against uniform crystals under the same impact, as if it were the only one.
#[test]
fn several_impacts_are_scored_as_each_by_itself() {
    let desk = Desk::new(STAGED);
    let study = desk.study();
    let layouts: Vec<Vec<u8>> = study.first().iter().map(|choice| study.layout(choice).materials).collect();
    let never = AtomicBool::new(false);
    let together = evaluator(&study).marks(&layouts, &never).unwrap();
    for (k, impact) in study.impacts.iter().enumerate() {
        let alone = Study { impacts: vec![*impact], ..study.clone() };
        let marks = evaluator(&alone).marks(&layouts, &never).unwrap();
        for (both, one) in together.iter().zip(&marks) {
            assert_eq!((both.len(), one.len()), (2, 1));
            assert_eq!(both[k], one[0]);
        }
    }
    assert_ne!(together[0][0], together[0][1]);
    // The mean of two, and the worse of two.
    let entry = Entry::new(String::new(), String::new(), &together[0]);
    let fabric = study.loom.fabric(&layouts[0]);
    let contrast = |k: usize| together[0][k].contrast.unwrap();
    assert_eq!(Summary::new(&study, &entry, fabric).contrast, Some((contrast(0) + contrast(1)) / 2.0));
    let mut worst = study.clone();
    worst.objective.over = Over::Worst;
    assert_eq!(Summary::new(&worst, &entry, fabric).contrast, Some(contrast(0).min(contrast(1))));
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
    let choice = best.entry.choice(study.free.len(), 2).unwrap();
    let mut fine = study.clone();
    fine.rungs.remove(0);
    let marks = evaluator(&fine).marks(&[study.layout(&choice).materials], &AtomicBool::new(false)).unwrap();
    assert_eq!(best.entry.impacts[0].contrast, marks[0][0].contrast);
    assert_eq!(best.summary.fabric, study.loom.fabric(&study.layout(&choice).materials));
}

/// What a kill leaves is a beginning of the journal, of any length.
#[test]
fn a_study_killed_anywhere_comes_to_the_same_bits() {
    for (text, evaluations) in [(STUDY, 600), (STAGED, 264)] {
        let desk = Desk::new(text);
        let (state, told) = desk.run().unwrap();
        let journal = desk.journal();
        assert_eq!((state.evaluations, state.ended, told.simulated), (evaluations as u64, Ended::Budget, evaluations));
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
    let state = run(&hurried, &desk.path("journal.jsonl"), &AtomicBool::new(false), &mut ()).unwrap();
    assert_eq!((state.ended, state.evaluations), (Ended::Time, 0));
    hurried.time = Some(1e6);
    assert_eq!(run(&hurried, &desk.path("journal.jsonl"), &AtomicBool::new(false), &mut ()).unwrap(), whole);
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
    for text in [STUDY, STAGED] {
        let [one, two] = [1, 2].map(|threads| {
            let desk = Desk::new(text);
            let state = with_threads(threads, || desk.run().unwrap().0);
            (state, desk.journal())
        });
        assert!(one == two);
    }
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
    let later = b"{\"journal\":\"granulens-study\",\"format\":3,\"version\":\"9.9.9\",\"crc\":\"CRC\"}\n";
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
        ("maximise", "minimize", "study.toml:5: objective.contrast: unknown field `minimize`"),
        ("maximise = 1", "max = 9", "study.toml:5: objective asks for nothing"),
        (
            "maximise = 1",
            "maximise = 1, minimise = 1",
            "study.toml:5: objective.contrast: asks for none or for several",
        ),
        ("maximise = 1", "maximise = 0", "study.toml:5: objective.contrast: a weight of 0 must be positive"),
        ("contrast", "colour", "study.toml:5: objective: unknown measure colour; known are contrast, focal-gain"),
        ("0.8", "-0.8", "study.toml:5: objective.focal-gain: min = -0.8 must be positive"),
        ("min = 0.8", "min = 2, max = 1", "study.toml:5: objective.focal-gain: min = 2 is above max = 1"),
        ("budget = 600", "budget = 0", "study.toml:6: budget = 0 must be 1"),
        ("budget = 600", "budget = -1", "study.toml:6: budget: invalid value: integer `-1`, expected a whole number"),
        ("budget", "budged", "study.toml:6: unknown field `budged`"),
        ("genetic+local", "magic", "study.toml:8: unknown method \"magic\"; known are genetic, local, local-swaps"),
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
    for (old, new, says) in [
        ("force = \"12 kN\"", "force = \"12 mm\"", "study.toml:16: force"),
        (
            "force = \"12 kN\"\nduration = \"16 us\"",
            "force = \"16 kN\"\nduration = \"20 us\"",
            "study.toml:16: the impact is given twice",
        ),
        ("duration = \"16 us\"", "", "missing field `duration`"),
        ("evaluations = 80\n", "", "study.toml:22: evaluations is missing"),
        ("evaluations = 80", "evaluations = 0", "study.toml:24: evaluations = 0 must be 1"),
        ("nsga2", "nsga3", "study.toml:23: unknown method \"nsga3\"; known are"),
        ("nsga2", "lens-family", "study.toml:23: method = \"lens-family\" needs a design with a [lens]"),
        ("level-set", "rescore", "study.toml:19: method = \"rescore\" has nothing"),
        ("evaluations = 80", "evaluations = 80\nsample = 3", "study.toml:25: sample belongs"),
        ("promote = 12", "evaluations = 12", "study.toml:28: a rescore evaluates promote and sample"),
        ("seed = 1", "method = \"local\"", "study.toml:5: method stands above [[stage]]"),
        ("[\"random\", \"random\"]", "[]", "study.toml:6: start is an empty list"),
        ("\"mean\"", "\"median\"", "study.toml:7: over: unknown variant `median`"),
        ("\"mean\"", "\"mean\"\ntime = \"0 s\"", "study.toml:8: time = \"0 s\" must be positive"),
    ] {
        assert!(STAGED.contains(old), "{old}");
        let desk = Desk::new(&STAGED.replacen(old, new, 1));
        let refusal = Study::read(&desk.path("study.toml"), None).unwrap_err().to_string();
        assert!(refusal.contains(says), "{refusal}");
    }
}

#[test]
fn the_study_of_the_repository_is_sound() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("studies/two-materials.toml");
    let study = Study::read(&path, None).unwrap();
    assert_eq!((study.free.len(), study.letters.as_slice()), (357, &[0, 1][..]));
    assert_eq!(study.layout(&study.first()[0]).materials, study.bases[0]);
}
