//! Same input, same bits: whatever the number of threads, the width of the registers, and which designs stand together; and the
//! same work (`instructions`).

mod instructions;
#[path = "../physics/problem.rs"]
#[expect(dead_code, reason = "shared with the physics tests, which use all of it")]
mod problem;
#[path = "../physics/reference.rs"]
#[expect(dead_code, reason = "shared with the physics tests, which use all of it")]
mod reference;

use granulens_core::Context;
use granulens_core::contact::LawKind;
use granulens_core::dem::{
    ForcePulse, Integrator, screen_batch, simulate, simulate_batch, simulate_batch_under, simulate_batch_with_friction,
    simulate_with_friction,
};
use granulens_core::layout::{Baseline, Layout};
use granulens_core::real::Width;
use granulens_core::sample::{Sample, Sphere};

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
    let never = Context::default();
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

/// Pulses of different force and duration side by side, against each alone.
#[test]
fn a_pulse_for_each_sample_is_that_of_single_runs() {
    let samples = designs();
    let never = Context::default();
    let mut impact = impact(&layout(is_lens).lattice);
    (impact.step, impact.window) = (2e-7, 60e-6);
    let pulse = |k: usize| ForcePulse { force: 6e3 + 250.0 * k as f64, duration: 20e-6 - 0.3e-6 * (k % 5) as f64 };
    let pulses: Vec<ForcePulse> = (0..samples.len()).map(pulse).collect();
    let alone: Vec<Vec<f64>> = (samples.iter().zip(&pulses))
        .map(|(sample, &pulse)| {
            impact.pulse = pulse;
            simulate(sample, &impact, &never).unwrap().max_kinetic
        })
        .collect();
    for width in Width::available() {
        let batch = simulate_batch_under(&samples, &impact, &pulses, None, None, width, &never).unwrap();
        for (k, peaks) in batch.into_iter().enumerate() {
            assert_eq!(peaks.stop, None);
            assert!(peaks.max_kinetic == alone[k], "{width:?}, design {k}");
        }
    }
}

/// Until spheres move chaotically single precision differs by its rounding: 6·10⁻⁸ a step, over 300 steps, as a random walk a part in
/// a million and at worst two in 10⁵, of energies twice as much.
#[test]
fn screened_designs_are_those_of_double_precision_to_its_rounding() {
    let samples = designs();
    let never = Context::default();
    for law in [LawKind::Thesis, LawKind::Consistent, LawKind::Hertz] {
        let mut impact = impact(&layout(is_lens).lattice);
        (impact.law, impact.step, impact.window) = (law, 2e-7, 60e-6);
        impact.pulse.force = 8e3;
        let double = simulate_batch(&samples, &impact, Width::widest(), &never).unwrap();
        let single = screen_batch(&samples, &impact, None, &never).unwrap();
        for (k, (double, single)) in double.iter().zip(&single).enumerate() {
            assert_eq!(single.stop, None);
            let most = double.max_kinetic.iter().copied().fold(0.0, f64::max);
            let off = double.max_kinetic.iter().zip(&single.max_kinetic).map(|(a, b)| (a - b).abs() / most);
            let off = off.fold(0.0, f64::max);
            assert!(off < 4e-5, "{law}, design {k}: {off:e}");
        }
    }
}

/// Whether two spheres of a sample lie more than a tenth of a diameter apart at rest.
fn lie_apart(sample: &Sample<2>, [i, j]: [usize; 2]) -> bool {
    let Sphere { centre: a, radius, .. } = sample.spheres[i];
    let b = sample.spheres[j].centre;
    i != j && (a[0] - b[0]).hypot(a[1] - b[1]) > 2.2 * radius
}

/// Under a strong and long impact spheres meet that did not touch at rest. When their contacts are taken up depends on the
/// fastest sphere of all designs side by side, what comes of it on none of the others: so none is taken up too late.
#[test]
fn contacts_that_arise_later_are_the_same_in_every_company() {
    let samples = designs();
    let never = Context::default();
    let mut impact = impact(&layout(is_lens).lattice);
    (impact.step, impact.window) = (2e-7, 350e-6);
    (impact.pulse.force, impact.pulse.duration) = (52e3, 20e-6);
    let records: Vec<_> = samples.iter().map(|sample| simulate(sample, &impact, &never).unwrap()).collect();
    let arose = |k: usize| records[k].contacts.iter().filter(|c| lie_apart(&samples[k], c.spheres)).count();
    let arose: Vec<usize> = (0..samples.len()).map(arose).collect();
    assert!(arose.iter().any(|&count| count > 0), "{arose:?}");
    let order: Vec<usize> = (0..samples.len()).map(|k| 5 * k % samples.len()).collect();
    let shuffled: Vec<Sample<2>> = order.iter().map(|&k| samples[k].clone()).collect();
    for (order, samples) in [((0..samples.len()).collect(), &samples), (order, &shuffled)] {
        let batch = simulate_batch(samples, &impact, Width::widest(), &never).unwrap();
        for (k, peaks) in order.into_iter().zip(batch) {
            assert_eq!(peaks.stop, records[k].stop, "design {k}");
            assert!(peaks.max_kinetic == records[k].max_kinetic, "design {k}, {arose:?}");
        }
    }
}

/// Crystals of unequal spheres, with empty sites and gaps, beside perfect ones.
#[test]
fn imperfect_crystals_have_the_bits_of_single_runs() {
    let mut samples = designs();
    for (k, sample) in samples.iter_mut().enumerate().filter(|(k, _)| k % 4 != 0) {
        for (i, sphere) in sample.spheres.iter_mut().enumerate() {
            // Spread without a pattern; the second of four is of two sizes only.
            let share = ((i * 7919 + k * 104_729) % 1009) as f64 / 1009.0;
            sphere.radius *= if k % 4 == 1 && share < 0.5 { 1.0 } else { 1.0 - 2e-3 * share };
            if k % 4 == 3 && i % 97 == k {
                sphere.radius = 0.0;
            }
        }
    }
    let never = Context::default();
    for &law in LawKind::ALL {
        let mut impact = impact(&layout(is_lens).lattice);
        (impact.law, impact.step, impact.window) = (law, 2e-7, 60e-6);
        impact.pulse.force = 8e3;
        let single: Vec<_> = samples.iter().map(|s| simulate(s, &impact, &never).unwrap()).collect();
        for record in &single {
            // Ledgers close, or a guard would say otherwise.
            assert_eq!(record.stop, None, "{law}");
        }
        for width in Width::available() {
            let batch = simulate_batch(&samples, &impact, width, &never).unwrap();
            for (k, record) in single.iter().enumerate() {
                assert_eq!(batch[k].stop, None);
                assert!(batch[k].max_kinetic == record.max_kinetic, "{law}, {width:?}, design {k}");
            }
        }
    }
    // And with friction.
    let mut rubbing = impact(&layout(is_lens).lattice);
    (rubbing.step, rubbing.window, rubbing.pulse.force) = (2e-7, 60e-6, 8e3);
    let single: Vec<_> = samples.iter().map(|s| simulate_with_friction(s, &rubbing, 0.2, &never).unwrap()).collect();
    for width in Width::available() {
        let batch = simulate_batch_with_friction(&samples, &rubbing, 0.2, None, width, &never).unwrap();
        for (k, record) in single.iter().enumerate() {
            assert_eq!(record.stop, None);
            assert!(batch[k].max_kinetic == record.max_kinetic, "friction, {width:?}, design {k}");
        }
    }
    // An empty site feels nothing.
    let record = &single[3];
    assert!(record.max_kinetic[3] == 0.0 && record.max_kinetic[100] == 0.0 && record.max_kinetic[101] > 0.0);
}
