//! Evaluations inside a study against the bare batch: what asking, judging, writing down and telling cost.
//!
//! `cargo bench -p granulens-benches --bench study`. What the figures mean: `benches/README.md`.

use std::path::Path;
use std::time::{Duration, Instant};

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use granulens::Context;
use granulens::evaluate::Evaluator;
use granulens::search::Rng;
use granulens::study::{Scoring, State, Study, Watch, Work, run};

/// Evaluations of one measurement.
const EVALUATIONS: u64 = 320;

/// From before the first batch to after the last: without the uniform crystals and baselines, which a study of thousands of
/// evaluations simulates once.
struct Clock {
    begun: Option<Instant>,
    evaluations: u64,
    took: Duration,
}

impl Watch for Clock {
    fn warning(&mut self, _: &str) {}
    fn batch(&mut self, state: &State, _: usize) {
        match self.begun {
            // The first batch is the start alone in some methods; the clock runs from its end.
            None => (self.begun, self.evaluations) = (Some(Instant::now()), state.evaluations),
            Some(begun) => {
                self.took =
                    begun.elapsed().mul_f64(EVALUATIONS as f64 / (state.evaluations - self.evaluations).max(1) as f64)
            }
        }
    }
}

fn repository() -> Study {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../studies/two-materials.toml");
    let mut study = Study::read(&path, None).unwrap();
    study.stages.truncate(1);
    study.stages[0].evaluations = EVALUATIONS;
    study.stages[0].rung = 0;
    study.rungs = vec![Scoring { step: Some(4e-7), ..Scoring::default() }];
    study
}

fn studies(criterion: &mut Criterion) {
    let never = Context::default();
    let study = repository();
    let mut group = criterion.benchmark_group("study");
    group.sample_size(10).throughput(Throughput::Elements(EVALUATIONS));

    let evaluator =
        Evaluator::new(&study.design, &study.impacts, study.palette.clone(), study.overrides(0), &never).unwrap();
    let mut rng = Rng::new(1);
    let space = study.space();
    let layouts: Vec<Vec<u8>> = (0..16).map(|_| study.materials(&space.random(&mut rng))).collect();
    group.bench_function("bare batches of 16", |bench| {
        bench.iter(|| {
            for _ in 0..EVALUATIONS / 16 {
                evaluator.scores(&layouts, &never).unwrap();
            }
        });
    });
    for method in ["genetic", "level-set", "local", "anneal"] {
        let mut study = study.clone();
        study.stages[0].work = Work::Search(method.parse().unwrap());
        group.bench_function(method, |bench| {
            bench.iter_custom(|rounds| {
                (0..rounds)
                    .map(|_| {
                        let folder = tempfile::tempdir().unwrap();
                        let mut clock = Clock { begun: None, evaluations: 0, took: Duration::ZERO };
                        run(&study, &folder.path().join("journal.jsonl"), &never, &mut clock).unwrap();
                        clock.took
                    })
                    .sum()
            });
        });
    }
    group.finish();
}

criterion_group!(benches, studies);
criterion_main!(benches);
