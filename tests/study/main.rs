//! Studies of a small crystal.
//!
//! - `bayes`: Bayesian optimisation, and a build without it
//! - `optimum`: every method finds what brute force finds, within the limits
//! - `climb`: annealing screened at a coarse step; the figures a study ends with
//! - `stages`: several impacts, several steps, one after the other
//! - `resume`: the same bits whatever ends a run and on any number of threads
//! - `kill`: the program itself, killed while it writes
//! - `journal`: torn, damaged, foreign, of other settings
//! - `files`: what a wrong study file hears, and the repository's own
//! - `set`: impacts at an angle and off the axis, crystals that are not built as drawn, measures beyond energies
//! - `shards`: parts of the work evaluated apart and folded, engines other than this process, and which settings differ
//! - `rays`: what is said of them as a guess
//! - `stored`: the layouts in `studies/`, against what is said about them

mod bayes;
mod climb;
mod files;
mod journal;
mod kill;
mod optimum;
mod rays;
mod resume;
mod set;
mod shards;
mod stages;
mod stored;

use std::path::PathBuf;

use granulens::Context;
use granulens::evaluate::Evaluator;
use granulens::study::{State, Study, StudyError, Watch, run};

/// A crystal of 32 spheres, of which 12 may change: what is quickest to simulate.
const DESIGN: &str = include_str!("../tiny.toml");

/// A crystal with room for a lens that still takes milliseconds; `lens` is its section.
fn lensed(name: &str, lens: &str) -> String {
    format!(
        r#"format = 1
name = "{name}"
[crystal]
packing = "hexagonal-2d"
diameter = "6.35 mm"
rows = 16
half_width = 5.5
sides = "mirror"
host = "stainless-440c"
[impact]
kind = "force-pulse"
force = "16 kN"
duration = "20 us"
[target]
focus = {{ rows = [12, 15], x = ["0 D", "1.5 D"] }}
protect = {{ rows = [12, 15], x = ["4 D", "5.5 D"] }}
{lens}[run]
step = "4e-7 s"
window = "120 us"
"#
    )
}

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
        let state = run(&self.study(), &self.path("journal.jsonl"), &Context::default(), &mut told)?;
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

fn evaluator(study: &Study) -> Evaluator {
    let never = Context::default();
    Evaluator::new(&study.design, &study.cases(), study.palette.clone(), study.overrides(0), &never).unwrap()
}
