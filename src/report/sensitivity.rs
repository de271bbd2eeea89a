//! How scores change with every sphere: maps of derivatives, and their table.

use std::fmt::Write as _;

use super::colour::Scale;
use super::crystal::Extent;
use super::maps::{Marks, Panel, Values, at, panels_of};
use crate::evaluate::Derivatives;
use crate::lattice::Site;
use crate::outcome::{ArrangementOutcome, Outcome};
use crate::score::Measure;

/// Columns of the table.
const HEADER: &str =
    "row,column,x,z,material,measure,d_density,d_youngs_modulus,d_yield_stress,d_radius,secant_density,linear";

/// The measures of which maps are drawn, with the files of these: G has the derivatives of F, and Q those of P.
pub(super) const MAPS: [(Measure, &str, &str); 2] = [
    (Measure::FocalMean, "sensitivity-focal.svg", "F and G"),
    (Measure::ProtectedMean, "sensitivity-protected.svg", "P and Q"),
];

/// A line for each sphere and measure; `material` names that of a site.
pub fn sensitivity_csv<'a>(sites: &[Site], material: impl Fn(usize) -> &'a str, of: &[Derivatives]) -> String {
    let mut text = format!("{HEADER}\n");
    for one in of {
        for (i, site) in sites.iter().enumerate() {
            let numbers =
                [one.density[i], one.youngs_modulus[i], one.yield_stress[i], one.radius[i], one.secant_density[i]];
            let numbers = numbers.map(|number| format!("{number:e}")).join(",");
            let (material, measure, linear) = (material(i), one.measure.name(), one.linear[i]);
            let _ = writeln!(
                text,
                "{},{},{},{},{material},{measure},{numbers},{linear}",
                site.row, site.column, site.x, site.z
            );
        }
    }
    text
}

/// The end of a scale about zero: all but one in a hundred values lie within.
fn end(values: &[f64]) -> f64 {
    let mut sizes: Vec<f64> = values.iter().map(|value| value.abs()).filter(|size| size.is_finite()).collect();
    sizes.sort_by(f64::total_cmp);
    sizes.get((sizes.len() * 99) / 100).copied().unwrap_or(0.0)
}

/// The map of a measure's derivatives, the half, white at zero. Where they are known to mislead, of P, that by density stands alone beside its
/// secant; of F those by Young's modulus and radius too.
pub(super) fn map(outcome: &Outcome, lens: &ArrangementOutcome, of: &Derivatives, names: &str) -> String {
    // By density as far as its secants reach: beyond that derivatives say what nobody finds.
    let by_density = end(&of.secant_density);
    let more: [(&str, &[f64], f64); 4] = [
        ("for more density: derivative", &of.density, by_density),
        ("over 1 % of density: secant", &of.secant_density, by_density),
        ("for a greater Young's modulus", &of.youngs_modulus, end(&of.youngs_modulus)),
        ("for a greater radius", &of.radius, end(&of.radius)),
    ];
    let count = if of.measure == Measure::ProtectedMean { 2 } else { 4 };
    let label = format!("change of {names} (% for 1 % more at this sphere)");
    let title = format!("{}: how {names} change with every sphere", outcome.manifest.name);
    let shown = more.iter().take(count).map(|&(heading, values, end)| {
        let scale = Scale::diverging(-end, end);
        let panel = Panel { heading, scale, label: &label, unit: 1.0, arrangement: lens, with_rays: false };
        let beyond = [values.iter().any(|&value| value > end), values.iter().any(|&value| value < -end)];
        (panel, Box::new(move |index| at(values, index)) as Values, beyond)
    });
    let other: Vec<bool> = of.linear.iter().map(|linear| !linear).collect();
    let words = [
        "not linear: by density derivative and secant differ by more than a tenth",
        &format!("{names}: {}", of.trust()),
    ];
    panels_of(outcome, &title, (Extent::Half, [190.0, 520.0]), shown, Some(Marks { on: &other, words }))
}
