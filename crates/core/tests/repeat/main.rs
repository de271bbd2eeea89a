//! Same input, same bits: whatever the number of threads, the width of the registers, and which designs stand together; and the
//! same work (`instructions`).

mod instructions;
#[path = "../physics/problem.rs"]
#[expect(dead_code, reason = "shared with the physics tests, which use all of it")]
mod problem;
#[path = "../physics/reference.rs"]
#[expect(dead_code, reason = "shared with the physics tests, which use all of it")]
mod reference;

use std::sync::atomic::AtomicBool;

use granulens_core::contact::LawKind;
use granulens_core::dem::{Integrator, simulate, simulate_batch};
use granulens_core::layout::{Baseline, Layout};
use granulens_core::real::Width;
use granulens_core::sample::Sample;

use problem::{impact, is_lens, layout};
use reference::material;

fn designs() -> Vec<Sample<2>> {
    let lens = layout(is_lens);
    let mut layouts: Vec<Layout> = Baseline::set(1, 3).into_iter().map(|b| b.layout(&lens, [5, 16], 1)).collect();
    layouts.insert(0, lens);
    // A third material, so that tables and palettes differ between the designs of a group.
    let mut aluminium = layouts[3].clone();
    aluminium.palette[1] = material("al");
    aluminium.materials.iter_mut().step_by(3).for_each(|m| *m = 1);
    layouts.push(aluminium);
    layouts.iter().map(Layout::sample).collect()
}

/// Twelve designs in groups of one, four and eight, in two orders, under every law, against one by one.
#[test]
fn a_batch_has_the_bits_of_single_runs_at_every_width_and_in_every_order() {
    let samples = designs();
    let never = AtomicBool::new(false);
    for &law in LawKind::ALL {
        let mut impact = impact(&layout(is_lens).lattice);
        (impact.law, impact.step, impact.window) = (law, 2e-7, 60e-6);
        impact.pulse.force = 8e3;
        if law == LawKind::LinearStatic {
            impact.integrator = Integrator::Rk4;
        }
        let single: Vec<Vec<f64>> = samples.iter().map(|s| simulate(s, &impact, &never).unwrap().max_kinetic).collect();
        let mut reversed = samples.clone();
        reversed.reverse();
        for width in Width::available() {
            let batch = simulate_batch(&samples, &impact, width, &never).unwrap();
            let backwards = simulate_batch(&reversed, &impact, width, &never).unwrap();
            for (k, expected) in single.iter().enumerate() {
                assert_eq!(batch[k].stop, None);
                assert!(batch[k].max_kinetic == *expected, "{law}, {width:?}, design {k}");
                assert!(
                    backwards[samples.len() - 1 - k].max_kinetic == *expected,
                    "{law}, {width:?}, design {k} reversed"
                );
            }
        }
    }
}
