//! Chapter 3: the contact law.

use super::Wanted::{Above, Below};
use super::crystals::{DIAMETER, material, model};
use super::{Part, Row, RowError, Verdict};
use crate::Context;
use crate::contact::{AnyLaw, Constants, ForceLaw as _, History, LawKind, Pair};
use crate::dem::{ForcePulse, Impact, Integrator, simulate};
use crate::material::Material;
use crate::sample::{Sample, Sphere};

pub(super) const ROWS: &[Row] = &[
    Row {
        id: "3-plastic-force",
        claim: "F_p of spheres with E 100 GPa and σ_y 500 MPa, by each set of constants",
        source: "section 4.2.2; eqs 3.5, 3.9, 4.7, appendix A.2.1",
        reason: "half a unit of the last digit printed; the sets differ in a length of 1.59, 1.6129 or 1.5875 mm and in c₁",
        formula: true,
        expected: Verdict::HoldsInPart,
        seconds: 0.0,
        measure: plastic_force,
    },
    Row {
        id: "3-stiffness",
        claim: "range of the plastic stiffness K_1D for σ_y from 100 to 2500 MPa at E 100 GPa",
        source: "section 5.2, eq. 5.2",
        reason: "half a unit of the last digit printed",
        formula: true,
        expected: Verdict::Holds,
        seconds: 0.0,
        measure: stiffness,
    },
    Row {
        id: "3-rate-collapse",
        claim: "curves at constant rates from 0.001 to 10⁴ /s fall on one when taken in F_p and δ_p",
        source: "fig. 3.3a, inset",
        reason: "a curve's line in the figure is about 2 % of its height thick; C 0.04 as there",
        formula: false,
        expected: Verdict::Holds,
        seconds: 0.0,
        measure: rate_collapse,
    },
    Row {
        id: "3-collisions",
        claim: "in collisions of two 440c spheres the rate makes contacts stiffer: more force at less overlap",
        source: "fig. 3.3b",
        reason: "a direction, at every speed; the figure's values cannot be read from the text. At 1 m/s contacts hardly yield, and \
                 without rate region II, which lies above Hertz, is the stiffer",
        formula: false,
        expected: Verdict::HoldsInPart,
        seconds: 0.1,
        measure: collisions,
    },
    Row {
        id: "3-force-per-sphere",
        claim: "5 F_p and 2 F_p of 440c are approximately 26 and 10.5 kN per sphere of a hexagonal sheet",
        source: "section 5.3.3",
        reason: "\"approximately\": 5 % tells the reading meant, F_p at each of two contacts (a factor √3), from F_p per sphere",
        formula: true,
        expected: Verdict::Holds,
        seconds: 0.0,
        measure: force_per_sphere,
    },
];

fn alike(material: &Material, constants: Constants) -> Pair {
    Pair::new([material, material], [0.5 * DIAMETER; 2], constants)
}

fn plastic_force(_: &Context) -> Result<Vec<Part>, RowError> {
    let material = model(5000.0, 500e6);
    let part = |&set: &Constants| {
        Part::near(format!("set {set}"), 584.0, alike(&material, set).plastic_force(), "N", 0.5 / 584.0)
    };
    Ok(Constants::ALL.iter().map(part).collect())
}

fn stiffness(_: &Context) -> Result<Vec<Part>, RowError> {
    let part = |stress: f64, published: f64| {
        let ours = alike(&model(5000.0, stress * 1e6), Constants::Equation47).plastic_stiffness() / 1e6;
        let last_digit = if published < 10.0 { 0.1 } else { 1.0 };
        Part::near(format!("σ_y {stress} MPa"), published, ours, "MN/m", 0.5 * last_digit / published)
    };
    Ok(vec![part(100.0, 3.5), part(2500.0, 48.0)])
}

fn rate_collapse(_: &Context) -> Result<Vec<Part>, RowError> {
    let steel = Material { rate_constant: 0.04, ..material("440c") };
    let pair = alike(&steel, Constants::Code);
    let law = AnyLaw::new(LawKind::Thesis, &pair);
    // Force over F_p at an overlap of x δ_p, both those of the rate.
    let curve = |rate: f64, x: f64| {
        let factor = 1.0 + steel.rate_constant * (rate / 0.001).ln();
        let regions = pair.regions(factor);
        let speed = rate * pair.radii_sum;
        law.force(x * regions.plastic_overlap, speed, &History::new()) / regions.plastic_force
    };
    let places: Vec<f64> = (1..=40).map(|k| 0.05 * f64::from(k)).collect();
    let top = curve(0.001, 2.0);
    let apart = |rate: f64| places.iter().map(|&x| (curve(rate, x) - curve(0.001, x)).abs() / top).fold(0.0, f64::max);
    let parts = [1.0, 1e2, 1e4].map(|rate| {
        let what = format!("{rate} /s against 0.001 /s, up to 2 δ_p, in parts of the greatest force");
        Part::words(what, "overlapping", apart(rate), "", Below(0.02))
    });
    Ok(parts.to_vec())
}

fn collisions(context: &Context) -> Result<Vec<Part>, RowError> {
    let radius = 0.5 * DIAMETER;
    let sphere = |centre: f64| Sphere { centre: [centre], radius, material: 0 };
    let steel = Material { rate_constant: 0.04, ..material("440c") };
    let sample = Sample { materials: vec![steel], spheres: vec![sphere(0.0), sphere(DIAMETER)] };
    let mut parts = Vec::new();
    for speed in [1.0, 5.0, 10.0, 20.0] {
        let collide = |law: LawKind| -> Result<[f64; 2], RowError> {
            let impact = Impact {
                mirrors: Vec::new(),
                law,
                constants: Constants::Code,
                pulse: ForcePulse { force: 0.0, duration: 1e-6 },
                periods: Vec::new(),
                slope: 0.0,
                struck: Vec::new(),
                faces: Vec::new(),
                moving: vec![(0, speed)],
                projectile: None,
                exit: Vec::new(),
                integrator: Integrator::Rk4,
                step: 5e-8,
                window: 100e-6,
            };
            let record = simulate(&sample, &impact, context)?;
            match record.stop {
                Some(stop) => Err(stop.into()),
                None => Ok([record.contacts[0].force_max, record.contacts[0].overlap_max]),
            }
        };
        let ([force, overlap], [static_force, static_overlap]) =
            (collide(LawKind::Thesis)?, collide(LawKind::ThesisStatic)?);
        let ratio = force / static_force;
        parts.push(Part::words(
            format!("greatest force over that without rate, {speed} m/s"),
            "more",
            ratio,
            "",
            Above(1.0),
        ));
        let ratio = overlap / static_overlap;
        parts.push(Part::words(format!("greatest overlap, {speed} m/s"), "less", ratio, "", Below(1.0)));
    }
    Ok(parts)
}

fn force_per_sphere(_: &Context) -> Result<Vec<Part>, RowError> {
    let force = alike(&material("440c"), Constants::Code).plastic_force() / 1e3;
    let part = |factor: f64, published: f64| {
        Part::near(format!("√3 · {factor} F_p"), published, 3.0_f64.sqrt() * factor * force, "kN", 0.05)
    };
    Ok(vec![part(5.0, 26.0), part(2.0, 10.5)])
}
