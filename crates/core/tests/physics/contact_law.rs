//! The contact laws against tables computed independently, state by state.

use granulens_core::contact::{AnyLaw, Constants, ForceLaw, History, LawKind, NormalLaw, Pair};

use crate::reference::{Table, difference, material};

const DIAMETER: f64 = 6.35e-3;

fn pair(a: &str, b: &str) -> Pair {
    Pair::new([&material(a), &material(b)], [0.5 * DIAMETER; 2], Constants::Code)
}

/// Forces agree to 10⁻¹¹: some 20 operations of rounding, amplified up to 10³ where the overlap nears the residual one.
const ROUNDING: f64 = 1e-11;

/// Below a nanonewton, forces next to the residual overlap are differences of rounded numbers.
const FLOOR: f64 = 1e-6;

#[test]
fn the_published_law_matches_the_independent_table() {
    for (file, a, b) in [
        ("contact_law_440c-440c.csv", "440c", "440c"),
        ("contact_law_440c-brass.csv", "440c", "brass"),
        ("contact_law_brass-brass.csv", "brass", "brass"),
    ] {
        let law = AnyLaw::new(LawKind::Thesis, &pair(a, b));
        let table = Table::read(file);
        for row in 0..table.len() {
            let value = |column| table.number(row, column);
            let history = History::yielded_at(value("dmax_before"), value("Fmax_before"));
            let force = law.force(value("d"), value("v"), &history);
            let error = difference(force, value("F"), FLOOR);
            assert!(error < ROUNDING, "{file} row {row} ({}): {force} for {}", table.text(row, "path"), value("F"));
            let after = history.advanced(value("d"), force);
            assert!(difference(after.overlap_max, value("dmax_after"), 0.0) == 0.0 || value("dmax_after") == 0.0);
            assert!(difference(after.force_max, value("Fmax_after"), FLOOR) < ROUNDING);
        }
    }
}

#[test]
fn hertz_and_linear_match_the_independent_table() {
    let table = Table::read("contact_law_440c-440c_hertz_linear.csv");
    let pair = pair("440c", "440c");
    for row in 0..table.len() {
        let value = |column| table.number(row, column);
        let kind = match (table.text(row, "law"), value("rate") > 0.0) {
            ("hertz", _) => LawKind::HertzThesis,
            ("linear", true) => LawKind::Linear,
            ("linear", false) => LawKind::LinearStatic,
            other => panic!("{other:?}"),
        };
        let history = History::yielded_at(value("dmax"), value("Fmax"));
        let force = AnyLaw::new(kind, &pair).force(value("d"), value("v"), &history);
        assert!(difference(force, value("F"), FLOOR) < ROUNDING, "row {row}: {force} for {}", value("F"));
    }
}

/// The figures that text and code of the thesis quote or imply for E = 100 GPa, σ_y = 500 MPa, to the digits given.
#[test]
fn fully_plastic_force_depends_on_the_set_of_constants() {
    let mut model = material("440c");
    (model.youngs_modulus, model.yield_stress) = (100e9, 500e6);
    let force = |constants| Pair::new([&model, &model], [0.5 * DIAMETER; 2], constants).plastic_force();
    assert!((force(Constants::Code) - 577.1).abs() < 0.05);
    assert!((force(Constants::Text) - 583.3).abs() < 0.05);
    assert!((force(Constants::SixteenthInch) - 583.97).abs() < 0.005);
    let static_440c = pair("440c", "440c").plastic_force();
    assert!((static_440c - 3_061.296_819_737_445).abs() < 1e-8);
}

/// ∫F dδ along the quasistatic unloading curve, by Simpson's rule on 2000 intervals of a curve that behaves as x^{3/2} at its
/// foot: error of order (1/2000)^{5/2}.
#[test]
fn stored_energy_is_the_work_of_the_unloading_curve() {
    for kind in [LawKind::Thesis, LawKind::Linear, LawKind::Hertz, LawKind::HertzThesis] {
        let law = AnyLaw::new(kind, &pair("440c", "brass"));
        let mut history = History::default();
        for k in 1..=400 {
            let overlap = 2e-4 * f64::from(k) / 400.0;
            history = history.advanced(overlap, law.force(overlap, 3.0, &history));
        }
        let overlap = 1.8e-4;
        let intervals = 2000;
        let width = overlap / f64::from(intervals);
        let force = |k: i32| law.force(f64::from(k) * width, -1e-9, &history);
        let sum: f64 = (0..intervals / 2).map(|k| force(2 * k) + 4.0 * force(2 * k + 1) + force(2 * k + 2)).sum();
        let (numeric, stored) = (sum * width / 3.0, law.stored(overlap, &history));
        assert!(difference(numeric, stored, 0.0) < 1e-6, "{kind}: {numeric} and {stored}");
    }
}

/// The stiffness that limits the step is the slope of the unloading curve at its top.
#[test]
fn stiffness_bound_is_the_slope_at_the_start_of_unloading() {
    for kind in [LawKind::Thesis, LawKind::Linear, LawKind::Hertz] {
        let law = AnyLaw::new(kind, &pair("440c", "440c"));
        let overlap = 3e-4;
        let force = law.force(overlap, 0.0, &History::default());
        let history = History::default().advanced(overlap, force);
        let h = 1e-10;
        let slope = (force - law.force(overlap - h, -1e-9, &history)) / h;
        assert!(difference(slope, law.stiffness_max(force), 0.0) < 1e-5, "{kind}: {slope}");
    }
}
