//! Section 5.3.3: the impact lens.

use super::Wanted::{Above, Below, Within};
use super::crystals::{DIAMETER, material};
use super::{Part, Row, RowError, Verdict};
use crate::Context;
use crate::contact::{Constants, LawKind};
use crate::dem::{ForcePulse, Impact, Integrator, Mirror, simulate};
use crate::lattice::{HexagonalSheet, Site};
use crate::layout::{Baseline, Layout};
use crate::target::Region;

pub(super) const ROWS: &[Row] = &[
    Row {
        id: "5.3.3-peak",
        claim: "the focal row has a very clear peak, on the axis; ten rows before it there is none yet",
        source: "figs 5.20c, 5.21c; 5.21b",
        reason: "places by column; \"very clear\": twice the row's least",
        formula: false,
        expected: Verdict::Holds,
        seconds: 0.5,
        measure: peak,
    },
    Row {
        id: "5.3.3-far-side",
        claim: "opposite the focus the least energy is below that of any flat or uniform arrangement",
        source: "fig. 5.21c",
        reason: "a direction",
        formula: false,
        expected: Verdict::Holds,
        seconds: 2.0,
        measure: far_side,
    },
    Row {
        id: "5.3.3-random-least",
        claim: "the least energy of five random arrangements almost exactly matches that opposite the lens's focus",
        source: "fig. 5.22c, red",
        reason: "10 %: the least of five trials varies by as much from five to five",
        formula: false,
        expected: Verdict::Holds,
        seconds: 2.0,
        measure: random_least,
    },
    Row {
        id: "5.3.3-random-spread",
        claim: "the greatest energy of five random arrangements is nearly double the least",
        source: "fig. 5.22c, red",
        reason: "over ten sets of five trials the published 2 must lie within the spread",
        formula: false,
        expected: Verdict::Holds,
        seconds: 15.0,
        measure: random_spread,
    },
    Row {
        id: "5.3.3-random-beyond",
        claim: "ten rows behind the focus random arrangements let less through than the lens",
        source: "fig. 5.22d",
        reason: "a direction, of row means; five trials",
        formula: false,
        expected: Verdict::Holds,
        seconds: 3.0,
        measure: random_beyond,
    },
    Row {
        id: "5.3.3-rate",
        claim: "laws with rate direct more energy to the focus and away from the far side than those without",
        source: "fig. 5.20c",
        reason: "a direction, of F/P",
        formula: false,
        expected: Verdict::HoldsInPart,
        seconds: 1.5,
        measure: rate,
    },
    Row {
        id: "5.3.3-elastic",
        claim: "with Hertzian contacts the energy follows the packing, a drop along 60° from the rim, and not the rays",
        source: "fig. 5.19c",
        reason: "the steepest drop of the row lies on that line to the column",
        formula: false,
        expected: Verdict::Holds,
        seconds: 1.0,
        measure: elastic,
    },
    Row {
        id: "5.3.3-elastic-contrast",
        claim: "with Hertzian contacts the lens does not focus by the focal row: F/P is below that of the plastic law",
        source: "fig. 5.20c, green",
        reason: "a direction. F/P alone does not measure focusing: the far side lies in the shadow of the packing",
        formula: false,
        expected: Verdict::DoesNotHold,
        seconds: 1.0,
        measure: elastic_contrast,
    },
    Row {
        id: "5.3.3-amplitude",
        claim: "no major differences in the focusing at 10.5 kN in place of 26 kN",
        source: "fig. 5.16b",
        reason: "shapes of the focal row correlate above 0.95; F/P to 10 %",
        formula: false,
        expected: Verdict::HoldsInPart,
        seconds: 1.0,
        measure: amplitude,
    },
    Row {
        id: "5.3.3-gain",
        claim: "the lens concentrates energy in the focal region: more than without a lens",
        source: "figs 5.16a, 5.21c",
        reason: "a direction, of F",
        formula: false,
        expected: Verdict::DoesNotHold,
        seconds: 1.0,
        measure: gain,
    },
    Row {
        id: "5.3.3-beyond",
        claim: "beyond the focus energy is lower in most regions than with uniform brass",
        source: "fig. 5.21d",
        reason: "in more than half of the columns of row 42",
        formula: false,
        expected: Verdict::DoesNotHold,
        seconds: 1.0,
        measure: beyond,
    },
    Row {
        id: "5.3.3-total",
        claim: "more energy is dissipated in all than in the uniform arrangements",
        source: "section 5.3.3, on fig. 5.21",
        reason: "a direction",
        formula: false,
        expected: Verdict::DoesNotHold,
        seconds: 1.0,
        measure: total,
    },
    Row {
        id: "5.3.3-estimate",
        claim: "½ δ_max F_max summed over contacts approximates the energy dissipated",
        source: "eq. 5.6",
        reason: "10 %: a contact gives little back and its curve is nearly straight, but it starts at an overlap above zero",
        formula: false,
        expected: Verdict::DoesNotHold,
        seconds: 0.5,
        measure: estimate,
    },
];

/// What a run gave: greatest kinetic energies (J), work dissipated and its estimate by eq. 5.6 (J).
struct Response {
    layout: Layout,
    energies: Vec<f64>,
    dissipated: f64,
    estimate: f64,
}

/// The published lens: rows 5 to 16, a front face of radius 16.5 D/sin 60°, a flat back.
pub(super) fn lens() -> Result<Layout, RowError> {
    let radius = 16.5 / 60_f64.to_radians().sin();
    let inside = |site: &Site| {
        let x = site.x / DIAMETER;
        let depth = (f64::from(site.row) - 5.0) * 0.75_f64.sqrt();
        site.row <= LENS_ROWS[1] && depth >= radius - (radius * radius - x * x).sqrt() - 1e-9
    };
    let sheet = HexagonalSheet::new(DIAMETER, 50, 16.5)?;
    Ok(Layout::new(sheet, ["440c", "brass"].map(material).to_vec(), |site| u8::from(inside(site))))
}

const LENS_ROWS: [u32; 2] = [5, 16];
const FOCAL_ROW: u32 = 32;
const BEYOND_ROW: u32 = 42;

/// The published impact: 26 kN for 20 µs on every sphere of row 1.
const FORCE: f64 = 26e3;
/// The first wave has passed the focal rows by then (s); the weaker impact and what lies behind take longer.
const WINDOW: f64 = 250e-6;
const LONG: f64 = 350e-6;

fn felt(layout: Layout, law: LawKind, force: f64, window: f64, context: &Context) -> Result<Response, RowError> {
    let impact = Impact {
        pulse: ForcePulse { force, duration: 20e-6 },
        ..struck(&layout.lattice, law, Integrator::Verlet, 1e-7, window)
    };
    let record = simulate(&layout.sample(), &impact, context)?;
    if let Some(stop) = record.stop {
        return Err(stop.into());
    }
    let estimate = record.contacts.iter().map(|c| 0.5 * c.weight * c.overlap_max * c.force_max).sum();
    Ok(Response { layout, energies: record.max_kinetic, dissipated: record.ledger.dissipated, estimate })
}

/// The published impact on a layout.
pub(super) fn struck(sheet: &HexagonalSheet, law: LawKind, integrator: Integrator, step: f64, window: f64) -> Impact {
    Impact {
        mirrors: vec![
            Mirror { axis: 0, position: 0.0, inward: 1.0 },
            Mirror { axis: 0, position: sheet.half_width(), inward: -1.0 },
        ],
        law,
        constants: Constants::Code,
        pulse: ForcePulse { force: FORCE, duration: 20e-6 },
        periods: Vec::new(),
        slope: 0.0,
        struck: (0..sheet.columns(1) as usize).collect(),
        faces: Vec::new(),
        moving: Vec::new(),
        projectile: None,
        exit: Vec::new(),
        integrator,
        step,
        window,
    }
}

/// The published case, 0 to 250 µs.
fn published(layout: Layout, context: &Context) -> Result<Response, RowError> {
    felt(layout, LawKind::Thesis, FORCE, WINDOW, context)
}

fn baseline(baseline: Baseline) -> Result<Layout, RowError> {
    Ok(baseline.layout(&lens()?, LENS_ROWS, 1))
}

impl Response {
    fn row(&self, row: u32) -> Vec<f64> {
        let sheet = &self.layout.lattice;
        (1..=sheet.columns(row)).filter_map(|column| Some(self.energies[sheet.index(row, column)?])).collect()
    }

    /// Mean over rows 30 to 34 between two distances from the axis, in diameters.
    fn mean(&self, x: [f64; 2]) -> f64 {
        let sites = Region { rows: [30, 34], x: x.map(|x| x * DIAMETER) }.sites(&self.layout.lattice);
        sites.iter().map(|&k| self.energies[k]).sum::<f64>() / sites.len() as f64
    }

    /// F (J)
    fn focal(&self) -> f64 {
        self.mean([0.0, 2.5])
    }

    /// F/P
    fn contrast(&self) -> f64 {
        self.focal() / self.mean([12.0, 16.5])
    }

    /// Least energy (J) of the focal row opposite the focus, x ≥ 12.5 D.
    fn far(&self) -> f64 {
        least(&self.row(FOCAL_ROW)[12..])
    }
}

fn least(values: &[f64]) -> f64 {
    values.iter().copied().fold(f64::INFINITY, f64::min)
}

fn greatest(values: &[f64]) -> f64 {
    values.iter().copied().fold(0.0, f64::max)
}

fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Column, from 1, of the greatest value.
fn column_of_peak(values: &[f64]) -> f64 {
    (0..values.len()).max_by(|&a, &b| values[a].total_cmp(&values[b])).map_or(0.0, |k| (k + 1) as f64)
}

fn peak(context: &Context) -> Result<Vec<Part>, RowError> {
    let lens = published(lens()?, context)?;
    let (focal, before) = (lens.row(FOCAL_ROW), lens.row(22));
    Ok(vec![
        Part::words("row 32: column of the peak, of 17", "on the axis", column_of_peak(&focal), "", Below(1.5)),
        Part::words("row 32: greatest over least", "very clear", greatest(&focal) / least(&focal), "", Above(2.0)),
        Part::words("row 22: column of the peak", "not yet", column_of_peak(&before), "", Above(4.5)),
    ])
}

fn far_side(context: &Context) -> Result<Vec<Part>, RowError> {
    let far = published(lens()?, context)?.far();
    let kinds = [Baseline::FlatSameHeight, Baseline::FlatSameCount, Baseline::AllHost, Baseline::AllLens];
    let part = |kind: Baseline| {
        let other = published(baseline(kind)?, context)?.far();
        Ok(Part::words(format!("lens over {}", kind.name()), "less", far / other, "", Below(1.0)))
    };
    kinds.into_iter().map(part).collect()
}

fn random_least(context: &Context) -> Result<Vec<Part>, RowError> {
    let far = published(lens()?, context)?.far();
    let one = |seed| Ok(least(&published(baseline(Baseline::RandomBehind(seed))?, context)?.row(FOCAL_ROW)));
    let lowest = least(&(1..=5).map(one).collect::<Result<Vec<_>, RowError>>()?);
    let wanted = Within { value: 1.0, absolute: 0.1 };
    Ok(vec![Part::words("lens over lowest random sphere", "almost exactly matches", far / lowest, "", wanted)])
}

fn random_spread(context: &Context) -> Result<Vec<Part>, RowError> {
    let set = |first: u64| {
        let row = |seed| Ok(published(baseline(Baseline::RandomBehind(seed))?, context)?.row(FOCAL_ROW));
        let rows = (first..first + 5).map(row).collect::<Result<Vec<_>, RowError>>()?.concat();
        Ok::<_, RowError>(greatest(&rows) / least(&rows))
    };
    let ratios = (0..10).map(|k| set(5 * k + 1)).collect::<Result<Vec<_>, _>>()?;
    Ok(vec![
        Part::words("least of ten sets of five", "nearly double", least(&ratios), "", Below(2.0)),
        Part::words("greatest of ten sets of five", "nearly double", greatest(&ratios), "", Above(2.0)),
    ])
}

fn random_beyond(context: &Context) -> Result<Vec<Part>, RowError> {
    let row =
        |layout: Layout| Ok::<_, RowError>(mean(&felt(layout, LawKind::Thesis, FORCE, LONG, context)?.row(BEYOND_ROW)));
    let random = (1..=5).map(|seed| row(baseline(Baseline::RandomBehind(seed))?)).collect::<Result<Vec<_>, _>>()?;
    let ours = mean(&random) / row(lens()?)?;
    Ok(vec![Part::words("row 42: mean of random over lens", "less", ours, "", Below(1.0))])
}

fn of_law(law: LawKind, context: &Context) -> Result<Response, RowError> {
    felt(lens()?, law, FORCE, WINDOW, context)
}

fn rate(context: &Context) -> Result<Vec<Part>, RowError> {
    let part = |with: LawKind, without: LawKind| {
        let (with, without, what) = (of_law(with, context)?, of_law(without, context)?, with.name());
        let what = format!("{what}: F/P with rate over that without");
        Ok(Part::words(what, "more", with.contrast() / without.contrast(), "", Above(1.0)))
    };
    [(LawKind::Thesis, LawKind::ThesisStatic), (LawKind::Linear, LawKind::LinearStatic)]
        .into_iter()
        .map(|(with, without)| part(with, without))
        .collect()
}

fn elastic(context: &Context) -> Result<Vec<Part>, RowError> {
    let elastic = of_law(LawKind::HertzThesis, context)?;
    let part = |row: u32| {
        let energies = elastic.row(row);
        let drop = |k: usize| energies[k + 1] / energies[k];
        let steepest = (0..16).min_by(|&a, &b| drop(a).total_cmp(&drop(b))).unwrap_or(0);
        // Columns k = 0, 1, ... of even rows lie at x = (k + 1/2) D; the line leaves x = 16.5 D in row 16, half a diameter a
        // row.
        let line = 16.5 - 0.5 * f64::from(row - LENS_ROWS[1]);
        let ours = steepest as f64 + 0.5;
        Part::words(
            format!("row {row}: x/D of the steepest drop"),
            "60° line",
            ours,
            "",
            Within { value: line, absolute: 0.25 },
        )
    };
    Ok([22, FOCAL_ROW, BEYOND_ROW].map(part).to_vec())
}

fn elastic_contrast(context: &Context) -> Result<Vec<Part>, RowError> {
    let ratio = of_law(LawKind::HertzThesis, context)?.contrast() / of_law(LawKind::Thesis, context)?.contrast();
    Ok(vec![Part::words("F/P with Hertz over that with plasticity", "less", ratio, "", Below(1.0))])
}

fn amplitude(context: &Context) -> Result<Vec<Part>, RowError> {
    let strong = published(lens()?, context)?;
    let weak = felt(lens()?, LawKind::Thesis, 10.5e3, LONG, context)?;
    let (a, b) = (strong.row(FOCAL_ROW), weak.row(FOCAL_ROW));
    let product = |x: &[f64], y: &[f64]| {
        let (mx, my) = (mean(x), mean(y));
        x.iter().zip(y).map(|(x, y)| (x - mx) * (y - my)).sum::<f64>()
    };
    let correlation = product(&a, &b) / (product(&a, &a) * product(&b, &b)).sqrt();
    let ratio = weak.contrast() / strong.contrast();
    Ok(vec![
        Part::words("row 32: correlation of the two", "alike", correlation, "", Above(0.95)),
        Part::words("F/P over that at 26 kN", "alike", ratio, "", Within { value: 1.0, absolute: 0.1 }),
    ])
}

fn gain(context: &Context) -> Result<Vec<Part>, RowError> {
    let (lens, host) = (published(lens()?, context)?, published(baseline(Baseline::AllHost)?, context)?);
    Ok(vec![Part::words("F over that of plain 440c", "more", lens.focal() / host.focal(), "", Above(1.0))])
}

fn beyond(context: &Context) -> Result<Vec<Part>, RowError> {
    let row = |layout| Ok::<_, RowError>(felt(layout, LawKind::Thesis, FORCE, LONG, context)?.row(BEYOND_ROW));
    let (lens, brass) = (row(lens()?)?, row(baseline(Baseline::AllLens)?)?);
    let lower = lens.iter().zip(&brass).filter(|(lens, brass)| lens < brass).count();
    Ok(vec![Part::words(
        "row 42: columns, of 17, in which the lens is below brass",
        "most",
        lower as f64,
        "",
        Above(8.5),
    )])
}

fn total(context: &Context) -> Result<Vec<Part>, RowError> {
    let dissipated = |layout| Ok::<_, RowError>(published(layout, context)?.dissipated);
    let lens = dissipated(lens()?)?;
    let part = |kind: Baseline| {
        let ours = lens / dissipated(baseline(kind)?)?;
        Ok(Part::words(format!("lens over {}", kind.name()), "more", ours, "", Above(1.0)))
    };
    [Baseline::AllHost, Baseline::AllLens].into_iter().map(part).collect()
}

fn estimate(context: &Context) -> Result<Vec<Part>, RowError> {
    let lens = published(lens()?, context)?;
    let what = "lens: dissipated by the ledger, against the estimate";
    Ok(vec![Part::near(what, (10.0 * lens.estimate).round() / 10.0, lens.dissipated, "J", 0.1)])
}
