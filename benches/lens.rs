//! The lens problem, one design at a time and in batches of eight: milliseconds per design and core. Proposals of lenses.
//!
//! `cargo bench -p granulens-benches --bench lens`. What the figures mean and what bounds them: `benches/README.md`.

#[path = "../crates/core/tests/physics/problem.rs"]
#[expect(dead_code, reason = "shared with the physics tests, which use all of it")]
mod problem;
#[path = "../crates/core/tests/physics/reference.rs"]
#[expect(dead_code, reason = "shared with the physics tests, which use all of it")]
mod reference;

use criterion::{BenchmarkId, Criterion, Throughput, criterion_group, criterion_main};
use granulens::Context;
use granulens::contact::{Constants, LawKind};
use granulens::dem::{Impact, Integrator, simulate, simulate_batch};
use granulens::layout::{Layout, random_choice};
use granulens::lens::{Family, LensRequest, propose};
use granulens::material::find;
use granulens::real::Width;
use granulens::sample::Sample;
use granulens::target::{Region, Target};

use problem::{impact, is_lens, layout};

/// Eight designs as an optimiser would ask for: the lens with about one site in sixteen of rows 5 to 25 exchanged.
fn designs() -> Vec<Sample<2>> {
    let lens = layout(is_lens);
    let start = lens.lattice.index(5, 1).unwrap_or(0);
    let change = |seed: u64| {
        let coins = random_choice(seed, 4 * 357);
        let mut layout: Layout = lens.clone();
        for k in 0..357 {
            if coins[4 * k..4 * k + 4].iter().all(|&coin| coin == 1) {
                layout.materials[start + k] ^= 1;
            }
        }
        layout.sample()
    };
    (1..=8).map(change).collect()
}

fn problem_at(law: LawKind, integrator: Integrator, step: f64, window: f64) -> Impact {
    let mut impact = impact(&layout(is_lens).lattice);
    (impact.law, impact.integrator, impact.step, impact.window) = (law, integrator, step, window);
    impact
}

fn lens(criterion: &mut Criterion) {
    let samples = designs();
    let never = Context::default();
    let cases = [
        (LawKind::Thesis, Integrator::Adams, 2e-7, 250e-6),
        (LawKind::Thesis, Integrator::Adams, 2e-7, 350e-6),
        (LawKind::Thesis, Integrator::Adams, 5e-7, 250e-6),
        (LawKind::Thesis, Integrator::Adams, 5e-7, 350e-6),
        (LawKind::Thesis, Integrator::Verlet, 1e-7, 250e-6),
        (LawKind::Consistent, Integrator::Adams, 2e-7, 250e-6),
        (LawKind::Hertz, Integrator::Adams, 2e-7, 250e-6),
    ]
    .map(|(law, integrator, step, window)| {
        let name = format!("{law} {integrator} {step:e} s {:.0} us", 1e6 * window);
        (name, problem_at(law, integrator, step, window))
    });
    let mut group = criterion.benchmark_group("lens");
    group.sample_size(10).throughput(Throughput::Elements(samples.len() as u64));
    for (name, impact) in &cases {
        for width in Width::available() {
            group.bench_with_input(
                BenchmarkId::new(name, format!("{} lanes", width.lanes())),
                impact,
                |bench, impact| {
                    bench.iter(|| simulate_batch(&samples, impact, width, &never));
                },
            );
        }
    }
    group.finish();

    let mut group = criterion.benchmark_group("full record");
    group.sample_size(10);
    group.bench_function(&cases[0].0, |bench| bench.iter(|| simulate(&samples[0], &cases[0].1, &never)));
    group.finish();
}

/// The proposal of every family for the target of the gallery.
fn proposals(criterion: &mut Criterion) {
    let lattice = layout(is_lens).lattice;
    let [Ok(steel), Ok(brass)] = ["440c", "brass"].map(|name| find(name, &[])) else { return };
    let region = |x: [f64; 2]| Region { rows: [30, 34], x: x.map(|x| x * lattice.diameter()) };
    let target = Target::one(region([0.0, 2.5]), region([12.0, 16.5]));
    let mut group = criterion.benchmark_group("proposal");
    group.sample_size(20);
    for family in Family::ALL {
        let request = LensRequest::new(family, brass.clone(), [5, 25]);
        group.bench_function(family.name(), |bench| {
            bench.iter(|| propose(&lattice, &steel, &request, &target, Constants::Code));
        });
    }
    group.finish();
}

criterion_group!(benches, lens, proposals);
criterion_main!(benches);
