//! The speeds that were published of chains, dimers and engineered spheres, against ours.

use granulens_core::contact::Constants;
use granulens_core::material::library;
use granulens_core::wave::{Dimension, Medium};

use crate::problem::DIAMETER;

fn speed(label: &str, constants: Constants) -> f64 {
    let mut media = Medium::all(&library());
    media.extend(Medium::published_engineered(&library()));
    let medium = media.iter().find(|m| m.label == label).unwrap_or_else(|| panic!("{label}"));
    medium.bound(Dimension::One, DIAMETER, constants).speed
}

/// Burgoyne 2016, section 4.3, whose equation 4.7 and code differ in the fitted constants. What is printed follows to 1 m/s
/// from one set or lies between the two, but for two numbers:
///
/// - brass, 833 m/s, does not follow from table 2.1 with either set (791.1, 797.7 m/s). E in place of E* gives 832.8 m/s
///   and would make 440c run at 1427 m/s, which is not printed.
/// - aluminium of five times its density, 489 m/s, comes out at 491.9 m/s.
///
/// Tungsten carbide is not in table 2.1: its values here are those with which 629 and 3011 m/s follow, so that these two
/// are no independent confirmation.
#[test]
fn published_speeds_follow_but_for_brass_and_the_heavy_core() {
    for (label, published, code, equation, agrees) in [
        ("440c", 1347.0, 1344.7, Some(1356.5), true),
        ("brass", 833.0, 791.1, Some(797.7), false),
        ("al+wc", 629.0, 629.0, None, true),
        ("wc core in al, ρ×5", 489.0, 491.9, None, false),
        ("hollow wc, ρ×0.2", 3011.0, 3011.0, None, true),
    ] {
        let ours = speed(label, Constants::Code);
        let other = speed(label, Constants::Equation47);
        // Half a unit of the last digit with which our own numbers are recorded.
        assert!((ours - code).abs() < if code > 3000.0 { 0.5 } else { 0.06 }, "{label}: {ours}");
        assert!(equation.is_none_or(|equation| (other - equation).abs() < 0.06), "{label}: {other}");
        let between = (ours.min(other) - 1.0..=ours.max(other) + 1.0).contains(&published);
        assert_eq!(between, agrees, "{label}: {ours} and {other} m/s, published {published}");
    }
    // The order that was printed holds: brass is the slowest material, the dimer slower, the two engineered ones outermost.
    let of = |label| speed(label, Constants::Code);
    assert!(
        library()
            .iter()
            .all(|m| Medium::uniform(m).bound(Dimension::One, DIAMETER, Constants::Code).speed >= of("brass"))
    );
    assert!(of("wc core in al, ρ×5") < of("al+wc") && of("al+wc") < of("brass"));
}

/// "By using alternating dimers, the design space of wave speeds has been expanded": 440c over al+wc is 2.14, and "a factor
/// of 6.2 between the fastest and slowest" with engineered spheres (3011/489 = 6.16).
#[test]
fn the_published_spans_of_the_design_space_hold() {
    let ratio = |a, b| speed(a, Constants::Code) / speed(b, Constants::Code);
    assert!((ratio("440c", "al+wc") - 2.14).abs() < 0.005);
    assert!((ratio("hollow wc, ρ×0.2", "wc core in al, ρ×5") - 6.2).abs() < 0.1);
}

/// K of every diameter, the dimer's mean density, and both orders of its materials: V is one number.
#[test]
fn no_medium_has_a_speed_that_depends_on_its_size() {
    for medium in Medium::all(&library()) {
        let at = |diameter| medium.bound(Dimension::Two, diameter, Constants::Code).speed;
        assert!((at(1e-4) / at(0.1) - 1.0).abs() < 1e-12, "{}", medium.name);
    }
}
