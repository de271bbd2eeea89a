//! x
use std::sync::atomic::AtomicBool;
use std::time::Instant;
#[path = "../tests/physics/problem.rs"]
mod problem;
#[path = "../tests/physics/reference.rs"]
mod reference;
use granulens::contact::LawKind;
use granulens::dem::{simulate, simulate_batch};
use granulens::layout::Baseline;
use granulens::real::Width;
fn main() {
    let lens = problem::layout(problem::is_lens);
    let mut samples: Vec<_> = Baseline::set(1, 2).into_iter().map(|b| b.layout(&lens, [5, 16]).sample()).collect();
    samples[2] = lens.sample();
    let never = AtomicBool::new(false);
    for (step, window) in [(1e-7, 250e-6), (4e-7, 250e-6)] {
        for law in [LawKind::Thesis, LawKind::HertzThesis, LawKind::Hertz] {
            let mut impact = problem::impact(&lens.lattice);
            impact.law = law;
            (impact.step, impact.window) = (step, window);
            let t = Instant::now();
            for s in &samples {
                simulate(s, &impact, &never).unwrap();
            }
            println!("{law} {step} full scalar {:.1} ms/design", t.elapsed().as_secs_f64() * 1e3 / 8.0);
            for width in Width::available() {
                let mut best = f64::INFINITY;
                for _ in 0..3 {
                    let t = Instant::now();
                    simulate_batch(&samples, &impact, width, &never).unwrap();
                    best = best.min(t.elapsed().as_secs_f64() * 1e3 / 8.0);
                }
                println!("{law} {step} {width:?} {best:.1} ms/design");
            }
        }
    }
}
