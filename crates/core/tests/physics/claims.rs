//! What Burgoyne 2016, section 5.3.3, says of the impact lens: what holds, what holds in part, what does not.
//!
//! The lens problem at 26 kN, 0 to 250 µs, unless a test says otherwise. Bands are the independent solutions' figures with
//! the accuracy class of the step (0.1 %), or what the claim's own words allow.

use std::sync::OnceLock;

use granulens_core::contact::LawKind;
use granulens_core::layout::{Baseline, Layout};
use granulens_core::target::Region;
use rayon::prelude::*;

use crate::problem::{DIAMETER, impact, is_lens, layout, run};
use crate::reference::difference;

/// Maximum kinetic energies of a layout under a law, a force [N] and a window [s].
fn energies(layout: &Layout, law: LawKind, force: f64, window: f64) -> Vec<f64> {
    let mut impact = impact(&layout.lattice);
    (impact.law, impact.pulse.force, impact.window) = (law, force, window);
    let record = run(&layout.sample(), &impact);
    assert_eq!(record.stop, None);
    record.max_kinetic
}

fn row(layout: &Layout, energies: &[f64], row: u32) -> Vec<f64> {
    (1..=17).map(|column| energies[layout.lattice.index(row, column).unwrap()]).collect()
}

fn mean(layout: &Layout, energies: &[f64], rows: [u32; 2], x: [f64; 2]) -> f64 {
    let inside = Region { rows, x: x.map(|x| x * DIAMETER) }.sites(&layout.lattice);
    inside.iter().map(|&i| energies[i]).sum::<f64>() / inside.len() as f64
}

fn focal(layout: &Layout, energies: &[f64]) -> f64 {
    mean(layout, energies, [30, 34], [0.0, 2.5])
}

fn protected(layout: &Layout, energies: &[f64]) -> f64 {
    mean(layout, energies, [30, 34], [12.0, 16.5])
}

fn least(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::INFINITY, f64::min)
}

fn greatest(values: &[f64]) -> f64 {
    values.iter().copied().fold(0.0, f64::max)
}

/// Place of the greatest value.
fn peak(values: &[f64]) -> usize {
    (0..values.len()).max_by(|&a, &b| values[a].total_cmp(&values[b])).unwrap()
}

/// The lens and its uniform and flat baselines, computed once.
struct Compared {
    lens: Layout,
    energies: Vec<f64>,
    baselines: Vec<(Baseline, Vec<f64>)>,
}

impl Compared {
    fn of(&self, baseline: Baseline) -> &[f64] {
        &self.baselines.iter().find(|(b, _)| *b == baseline).unwrap().1
    }
}

fn compared() -> &'static Compared {
    static COMPARED: OnceLock<Compared> = OnceLock::new();
    COMPARED.get_or_init(|| {
        let lens = layout(is_lens);
        let solve = |layout: &Layout| energies(layout, LawKind::Thesis, 26e3, 250e-6);
        // Fifty seeds of each random kind.
        let baselines =
            Baseline::set(1, 50).into_par_iter().map(|b| (b, solve(&b.layout(&lens, [5, 16], 1)))).collect();
        Compared { energies: solve(&lens), lens, baselines }
    })
}

/// All-440c 0.3655 J, all-brass 0.1497 J, strips 0.2229 and 0.2662 J, lens 0.3313 and 0.1359 J (independent solution).
#[test]
fn focal_and_protected_energies_are_those_of_the_independent_solution() {
    let all = compared();
    let close = |ours: f64, theirs: f64| assert!(difference(ours, theirs, 0.0) < 1e-3, "{ours} and {theirs}");
    close(focal(&all.lens, &all.energies), 0.331_306);
    close(protected(&all.lens, &all.energies), 0.135_892);
    for (baseline, theirs) in [
        (Baseline::AllHost, 0.365_455),
        (Baseline::AllLens, 0.149_726),
        (Baseline::FlatSameHeight, 0.222_907),
        (Baseline::FlatSameCount, 0.266_216),
    ] {
        // Uniform across the width: F and P are the same.
        close(focal(&all.lens, all.of(baseline)), theirs);
        close(protected(&all.lens, all.of(baseline)), theirs);
    }
}

/// Holds: "a very clear peak of the kinetic energy within the focal region", on the axis; ten rows before it the lens has
/// not focused yet.
#[test]
fn the_focal_row_peaks_on_the_axis_and_the_row_before_does_not() {
    let all = compared();
    let focal_row = row(&all.lens, &all.energies, 32);
    assert_eq!(peak(&focal_row), 0);
    assert!(greatest(&focal_row) > 2.5 * least(&focal_row));
    let before = row(&all.lens, &all.energies, 22);
    assert!(peak(&before) > 4, "peak of row 22 in column {}", peak(&before) + 1);
    assert!(greatest(&before) < 2.0 * least(&before));
}

/// Holds: "the minimum kinetic energy on the side opposite the focus is less than ... for any of the other particle
/// arrangements", and "almost exactly matches" the lowest random sphere: within a tenth here.
#[test]
fn the_far_side_is_quieter_than_in_any_baseline() {
    let all = compared();
    let lens = least(&row(&all.lens, &all.energies, 32)[12..]);
    for baseline in [Baseline::AllHost, Baseline::AllLens, Baseline::FlatSameHeight, Baseline::FlatSameCount] {
        assert!(lens < least(&row(&all.lens, all.of(baseline), 32)[12..]), "{baseline:?}");
    }
    let five = |seed| least(&row(&all.lens, all.of(Baseline::RandomBehind(seed)), 32));
    let lowest = least(&(1..=5).map(five).collect::<Vec<_>>());
    assert!(difference(lens, lowest, 0.0) < 0.1, "{lens} and {lowest}");
}

/// Holds: with all rows behind random, "the maximum kinetic energy of the random arrangement is nearly double the minimum"
/// over the row and five trials. It depends on the trials: over ten sets of five, the published 2 must lie
/// within the spread. With only the lens's rows random the ratio is smaller.
#[test]
fn random_arrangements_spread_by_a_factor_of_two() {
    let all = compared();
    let ratio = |kind: fn(u64) -> Baseline, first: u64| {
        let rows: Vec<f64> = (first..first + 5).flat_map(|seed| row(&all.lens, all.of(kind(seed)), 32)).collect();
        greatest(&rows) / least(&rows)
    };
    let sets = |kind: fn(u64) -> Baseline| (0..10).map(|k| ratio(kind, 5 * k + 1)).collect::<Vec<_>>();
    let (behind, lens_rows) = (sets(Baseline::RandomBehind), sets(Baseline::RandomLensRows));
    println!("behind {behind:.2?}\nlens rows {lens_rows:.2?}");
    assert!(least(&behind) < 2.0 && greatest(&behind) > 2.0, "{behind:?}");
    assert!(greatest(&lens_rows) < greatest(&behind));
    let mean = |ratios: &[f64]| ratios.iter().sum::<f64>() / 10.0;
    assert!(mean(&lens_rows) < mean(&behind));
}

/// Holds: among the plastic laws the rate-dependent one focuses most. Hertz does not follow the rays, yet its F/P is the
/// largest of all: F/P alone does not measure focusing as a lens does.
#[test]
fn the_rate_dependent_law_focuses_most_among_the_plastic_ones() {
    let lens = layout(is_lens);
    let contrast = |law| {
        let energies = energies(&lens, law, 26e3, 250e-6);
        focal(&lens, &energies) / protected(&lens, &energies)
    };
    for (law, theirs) in [
        (LawKind::Thesis, 2.44),
        (LawKind::ThesisStatic, 1.63),
        (LawKind::HertzThesis, 4.76),
        (LawKind::Linear, 1.50),
        (LawKind::LinearStatic, 1.68),
    ] {
        // Half a unit of the last digit given, and the 0.1 % class for each of F and P.
        let ours = contrast(law);
        println!("{law}: {ours}");
        assert!((ours - theirs).abs() < 0.005 + 2e-3 * theirs, "{law}: {ours} and {theirs}");
    }
}

/// Holds: with Hertz the energy does not follow the rays but the packing: "a significant drop in energy to the left of the
/// dashed line identifying a 60° interface from the corner of the lens". The corner is the rim, x = 16.5 D in row 16; the
/// line of closest packing from there runs inwards by half a diameter a row, and in every row behind the
/// steepest drop lies on it, to the column. The plastic lens knows no such line.
#[test]
fn the_elastic_lens_follows_the_packing_and_the_plastic_one_does_not() {
    let lens = layout(is_lens);
    let steepest = |energies: &[f64], number: u32| {
        let row = row(&lens, energies, number);
        (0..16).min_by(|&a, &b| (row[a + 1] / row[a]).total_cmp(&(row[b + 1] / row[b]))).unwrap()
    };
    let elastic = energies(&lens, LawKind::HertzThesis, 26e3, 250e-6);
    // Even rows: column k (from 0) lies at x = (k + 1/2) D.
    let on_line = |number: u32| (16.5 - 0.5 * f64::from(number - 16) - 0.5) as usize;
    for number in [22, 32, 42] {
        assert_eq!(steepest(&elastic, number), on_line(number), "row {number}");
    }
    let plastic = &compared().energies;
    assert!([22, 32, 42].into_iter().any(|number| steepest(plastic, number) != on_line(number)));
}

/// Holds in part: "we do not observe any major differences in the focusing ... based on the amplitude". Shapes of the focal
/// row correlate by 0.97 between 26 and 10.5 kN, but F/P falls from 2.44 to 1.82.
#[test]
fn a_weaker_impact_is_focused_alike_in_shape_but_less() {
    let all = compared();
    let weak = energies(&all.lens, LawKind::Thesis, 10.5e3, 350e-6);
    let (a, b) = (row(&all.lens, &all.energies, 32), row(&all.lens, &weak, 32));
    let mean = |v: &[f64]| v.iter().sum::<f64>() / v.len() as f64;
    let (ma, mb) = (mean(&a), mean(&b));
    let product =
        |x: &[f64], mx: f64, y: &[f64], my: f64| -> f64 { x.iter().zip(y).map(|(x, y)| (x - mx) * (y - my)).sum() };
    let correlation = product(&a, ma, &b, mb) / (product(&a, ma, &a, ma) * product(&b, mb, &b, mb)).sqrt();
    assert!((correlation - 0.97).abs() < 0.005, "{correlation}");
    let (f, p) = (focal(&all.lens, &weak), protected(&all.lens, &weak));
    assert!(difference(f, 0.053_78, 0.0) < 2e-3 && difference(p, 0.029_50, 0.0) < 2e-3, "{f} {p}");
    assert!((f / p - 1.82).abs() < 0.01);
}

/// Does not hold: the lens does not raise the focal energy above that of plain 440c (0.907 of it), and ten rows behind the
/// focus it is not "lower in most regions than for the uniform brass arrangement".
#[test]
fn two_published_claims_do_not_hold() {
    let all = compared();
    let gain = focal(&all.lens, &all.energies) / focal(&all.lens, all.of(Baseline::AllHost));
    assert!((gain - 0.907).abs() < 0.002, "{gain}");
    // The wave in brass reaches row 42 only after 250 µs.
    let brass = Baseline::AllLens.layout(&all.lens, [5, 16], 1);
    let solve = |layout: &Layout| row(layout, &energies(layout, LawKind::Thesis, 26e3, 350e-6), 42);
    let (behind, brass) = (solve(&all.lens), solve(&brass));
    let lower = behind.iter().zip(&brass).filter(|(lens, brass)| lens < brass).count();
    println!("row 42: lens {behind:.3?}, brass {brass:.3?}");
    assert!(lower <= 8, "lower in {lower} of 17 columns");
}
