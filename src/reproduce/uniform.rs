//! Section 5.2: waves in uniform and layered sheets and close packings.

use super::Wanted::{Below, Within};
use super::crystals::{DIAMETER, Loading, Stack, exponent, material, model, spread};
use super::{Part, Row, RowError, Verdict};
use crate::Context;
use crate::contact::{Constants, LawKind};
use crate::dem::{MoveIn, Spheres};
use crate::lattice::Cell;
use crate::material::Material;
use crate::wave::{Dimension, bound};

pub(super) const ROWS: &[Row] = &[
    Row {
        id: "5.2-factors",
        claim: "waves in a sheet and a close packing are 3/(2√2) and 2/√3 times as fast as in a chain",
        source: "eqs 5.1, 5.3; fig. 5.9",
        reason: "2 %: \"nearly indistinguishable\". The factors are those of small overlaps; at 2 F_p contacts turn by up to a \
                 degree",
        formula: false,
        expected: Verdict::Holds,
        seconds: 5.0,
        measure: factors,
    },
    Row {
        id: "5.2-density",
        claim: "in sheets and close packings too speed falls with the square root of density",
        source: "fig. 5.9a",
        reason: "0.05, as for chains; four densities",
        formula: false,
        expected: Verdict::Holds,
        seconds: 10.0,
        measure: density,
    },
    Row {
        id: "5.2-stiffness",
        claim: "in sheets and close packings too speed grows with the square root of the stiffness (σ_y varied)",
        source: "fig. 5.9b",
        reason: "0.05, as for chains; four yield stresses",
        formula: false,
        expected: Verdict::Holds,
        seconds: 10.0,
        measure: stiffness,
    },
    Row {
        id: "5.2-collapse",
        claim: "speeds over the bound fall on one curve for four materials in one, two and three dimensions",
        source: "fig. 5.10b",
        reason: "greatest over least in layers 5 to 15: 5 %, as the 5 points of 4.2-ninety. The bound knows no rate: hardening \
                 takes 302 above aluminium and brass; across the dimensions each material does collapse",
        formula: false,
        expected: Verdict::HoldsInPart,
        seconds: 10.0,
        measure: collapse,
    },
    Row {
        id: "5.2-layers",
        claim: "sheets and close packings of two materials in alternate layers run at a slightly different normalised speed",
        source: "section 5.2, fig. 5.10b",
        reason: "\"slightly\": within 10 % of the same dimers as chains",
        formula: false,
        expected: Verdict::Holds,
        seconds: 10.0,
        measure: layers,
    },
];

/// Speed of a wave that puts 2 F_p on each contact below the first layer for 100 µs, by dimension.
fn speed(
    dimension: Dimension,
    materials: &[Material],
    law: LawKind,
    between: [u32; 2],
    context: &Context,
) -> Result<f64, RowError> {
    fn of<const D: usize>(stack: &Stack<D>, between: [u32; 2], context: &Context) -> Result<f64, RowError>
    where
        Spheres: MoveIn<D>,
    {
        stack.speed(Loading::Force(2.0 * stack.pair().plastic_force(), 100e-6), between, context)
    }
    let materials = materials.to_vec();
    match dimension {
        Dimension::One => of(&Stack { cell: Cell::<1>::ALL[0], materials, law }, between, context),
        Dimension::Two => of(&Stack { cell: hexagonal(), materials, law }, between, context),
        Dimension::Three => of(&Stack { cell: close_packed(), materials, law }, between, context),
    }
}

fn hexagonal() -> Cell<2> {
    Cell::<2>::named("hexagonal").unwrap_or(Cell::<2>::ALL[0])
}

fn close_packed() -> Cell<3> {
    Cell::<3>::named("hcp").unwrap_or(Cell::<3>::ALL[0])
}

/// The twenty layers over which the source averages; it does not say which.
const TWENTY: [u32; 2] = [10, 30];

const HIGHER: [Dimension; 2] = [Dimension::Two, Dimension::Three];

fn factors(context: &Context) -> Result<Vec<Part>, RowError> {
    let mut parts = Vec::new();
    for (name, material, law) in
        [("model material", model(5000.0, 500e6), LawKind::ThesisStatic), ("440c", material("440c"), LawKind::Thesis)]
    {
        let of = |dimension| speed(dimension, std::slice::from_ref(&material), law, TWENTY, context);
        let chain = of(Dimension::One)?;
        for (dimension, words) in HIGHER.into_iter().zip(["3/(2√2)", "2/√3"]) {
            let value = dimension.factor();
            let what = format!("{name}, {}D over 1D", dimension.number());
            let wanted = Within { value, absolute: 0.02 * value };
            parts.push(Part::words(what, words, of(dimension)? / chain, "", wanted));
        }
    }
    Ok(parts)
}

fn density(context: &Context) -> Result<Vec<Part>, RowError> {
    let fit = |dimension: Dimension| {
        let of = |density: f64| {
            let speed = speed(dimension, &[model(density, 500e6)], LawKind::ThesisStatic, TWENTY, context)?;
            Ok::<_, RowError>((density, speed))
        };
        let points = spread(2000.0, 16000.0, 4).into_iter().map(of).collect::<Result<Vec<_>, _>>()?;
        let wanted = Within { value: -0.5, absolute: 0.05 };
        Ok(Part::words(format!("{}D: exponent", dimension.number()), "-1/2", exponent(&points), "", wanted))
    };
    HIGHER.into_iter().map(fit).collect()
}

fn stiffness(context: &Context) -> Result<Vec<Part>, RowError> {
    let fit = |dimension: Dimension| {
        let of = |stress: f64| {
            let material = [model(5000.0, stress)];
            let bound = bound(dimension, [&material[0], &material[0]], DIAMETER, Constants::Code);
            let speed = speed(dimension, &material, LawKind::ThesisStatic, TWENTY, context)?;
            Ok::<_, RowError>((bound.stiffness, speed))
        };
        let points = spread(100e6, 2500e6, 4).into_iter().map(of).collect::<Result<Vec<_>, _>>()?;
        let wanted = Within { value: 0.5, absolute: 0.05 };
        Ok(Part::words(format!("{}D: exponent", dimension.number()), "1/2", exponent(&points), "", wanted))
    };
    HIGHER.into_iter().map(fit).collect()
}

/// Speed over the bound in layers 5 to 15.
fn normalised(dimension: Dimension, materials: &[Material], context: &Context) -> Result<f64, RowError> {
    let bound = bound(dimension, [&materials[0], &materials[materials.len() - 1]], DIAMETER, Constants::Equation47);
    Ok(speed(dimension, materials, LawKind::Thesis, [5, 15], context)? / bound.speed)
}

fn collapse(context: &Context) -> Result<Vec<Part>, RowError> {
    let names = ["al", "brass", "302", "440c"];
    let of = |name: &str| -> Result<Vec<f64>, RowError> {
        Dimension::ALL.iter().map(|&dimension| normalised(dimension, &[material(name)], context)).collect()
    };
    let speeds = names.into_iter().map(of).collect::<Result<Vec<_>, _>>()?;
    let collapses = |what: String, values: &[f64]| Part::words(what, "one curve", ratio(values), "", Below(1.05));
    let mut parts: Vec<Part> = names
        .iter()
        .zip(&speeds)
        .map(|(name, speeds)| collapses(format!("{name}: greatest over least of 1D, 2D, 3D"), speeds))
        .collect();
    parts.push(collapses("all four in 1D, 2D, 3D".to_owned(), &speeds.concat()));
    Ok(parts)
}

fn ratio(values: &[f64]) -> f64 {
    values.iter().copied().fold(0.0, f64::max) / values.iter().copied().fold(f64::INFINITY, f64::min)
}

fn layers(context: &Context) -> Result<Vec<Part>, RowError> {
    let mut parts = Vec::new();
    for names in [["al", "302"], ["brass", "440c"]] {
        let materials = names.map(material);
        let chain = normalised(Dimension::One, &materials, context)?;
        for dimension in HIGHER {
            let ours = normalised(dimension, &materials, context)? / chain;
            let what = format!("{}, {}D over 1D", names.join(" + "), dimension.number());
            parts.push(Part::words(what, "slightly different", ours, "", Within { value: 1.0, absolute: 0.1 }));
        }
    }
    Ok(parts)
}
