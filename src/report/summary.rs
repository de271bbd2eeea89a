//! The comparison: one line per arrangement, random ones of a kind folded to mean ± standard deviation over seeds.

use serde::Serialize;

use super::digits::{NONE, decimals, significant};
use super::profiles::random_kinds;
use crate::outcome::{ArrangementOutcome, Outcome};
use crate::score::Measure;
use crate::stats::Mean;

/// How many digits a quantity is shown with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Digits {
    /// So many significant ones.
    Significant(usize),
    /// So many behind the point.
    Decimals(usize),
}

/// How a measure is shown: name, symbol and unit are the table's.
#[derive(Clone, Copy, Debug)]
pub struct Column {
    /// What is shown.
    pub measure: Measure,
    /// With how many digits.
    pub digits: Digits,
}

const fn column(measure: Measure, digits: Digits) -> Column {
    Column { measure, digits }
}

/// F.
pub const FOCAL: Column = column(Measure::FocalMean, Digits::Significant(3));
/// P.
pub const PROTECTED: Column = column(Measure::ProtectedMean, Digits::Significant(3));
/// C.
pub const CONTRAST: Column = column(Measure::Contrast, Digits::Decimals(2));
/// G.
pub const GAIN: Column = column(Measure::FocalGain, Digits::Decimals(2));
/// Q.
pub const PROTECTION: Column = column(Measure::Protection, Digits::Decimals(2));
/// P of the lens over P of the arrangement.
pub const AGAINST: Column = column(Measure::ProtectedRatio, Digits::Decimals(2));
/// Dissipated energy.
pub const DISSIPATED: Column = column(Measure::Dissipated, Digits::Significant(4));
/// The published estimate of the dissipated energy.
pub const EQ_5_6: Column = column(Measure::Estimate, Digits::Significant(4));
/// Greatest momentum of the last row.
pub const FAR_MOMENTUM: Column = column(Measure::FarMomentum, Digits::Significant(3));
/// Greatest force on the last row.
pub const FAR_FORCE: Column = column(Measure::FarForce, Digits::Significant(3));
/// What the energy ledger leaves open.
pub const RESIDUAL: Column = column(Measure::Residual, Digits::Significant(2));
/// Spheres of the piece that are not of the host.
pub const PIECE: Column = column(Measure::PieceSpheres, Digits::Decimals(0));

impl Column {
    /// Symbol with unit: `F [J]`.
    pub fn heading(&self) -> String {
        let (symbol, unit) = (self.measure.symbol(), self.measure.unit().name());
        if unit.is_empty() { symbol.to_owned() } else { format!("{symbol} [{unit}]") }
    }
}

/// What symbols mean, for below a table: `F: mean over ...`; in the words of the table of measures.
pub fn definitions(columns: &[&Column]) -> Vec<String> {
    let of = |column: &&Column| format!("{}: {}", column.measure.symbol(), column.measure.definition());
    columns.iter().map(of).collect()
}

/// A mean with its standard deviation, where several values gave it.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Spread {
    /// Mean of the values that there are.
    pub mean: f64,
    /// Sample standard deviation, from two values on.
    pub deviation: Option<f64>,
}

impl Spread {
    /// Of the finite values; none if there are none.
    pub fn of(values: impl IntoIterator<Item = f64>) -> Option<Self> {
        let values: Vec<f64> = values.into_iter().filter(|v| v.is_finite()).collect();
        if values.is_empty() {
            return None;
        }
        let Mean { mean, deviation, .. } = Mean::of(&values);
        Some(Self { mean, deviation })
    }
}

/// One line of the comparison.
pub struct Line<'a> {
    /// The arrangement's name, or the kind of the random ones.
    pub name: &'a str,
    /// One arrangement, or all seeds of a kind.
    pub members: Vec<&'a ArrangementOutcome>,
}

impl Line<'_> {
    /// A measure over the members.
    pub fn spread(&self, measure: Measure) -> Option<Spread> {
        Spread::of(self.members.iter().filter_map(|member| member.scores.get(measure)))
    }

    /// A measure as it is shown: `0.331`, `0.264±0.026` or a dash.
    pub fn show(&self, column: &Column) -> String {
        self.spread(column.measure).map_or(NONE.to_owned(), |spread| show(spread, column.digits))
    }
}

/// The deviation takes the decimals of the mean.
fn show(spread: Spread, digits: Digits) -> String {
    let places = match digits {
        Digits::Decimals(places) => places,
        Digits::Significant(count) => {
            let shown = significant(spread.mean, count);
            if shown.contains('e') || spread.deviation.is_none() {
                return spread.deviation.map_or(shown.clone(), |d| format!("{shown}±{}", significant(d, 2)));
            }
            decimals(spread.mean, count)
        }
    };
    let mean = format!("{:.places$}", spread.mean);
    spread.deviation.map_or(mean.clone(), |deviation| format!("{mean}±{deviation:.places$}"))
}

/// All lines, in the outcome's order; a random kind stands where its first seed does.
pub fn lines<S, R, P>(outcome: &Outcome<S, R, P>) -> Vec<Line<'_>> {
    let mut random = random_kinds(outcome).into_iter();
    let mut seen: Vec<&str> = Vec::new();
    let mut lines = Vec::new();
    for arrangement in &outcome.arrangements {
        if arrangement.seed.is_none() {
            lines.push(Line { name: &arrangement.name, members: vec![arrangement] });
        } else if !seen.contains(&arrangement.kind.as_str()) {
            seen.push(&arrangement.kind);
            // Kinds come in the same order of first appearance.
            lines.extend(random.next().map(|(name, members)| Line { name, members }));
        }
    }
    lines
}

/// The greatest residual of the energy ledger over all arrangements, without its sign.
pub fn worst_residual<S, R, P>(outcome: &Outcome<S, R, P>) -> Option<f64> {
    let residuals =
        outcome.arrangements.iter().filter_map(|a| Some(a.scores.residual?.abs())).filter(|r| r.is_finite());
    residuals.max_by(f64::total_cmp)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn deviations_take_the_decimals_of_the_mean() {
        let spread = Spread::of([0.25, 0.26, 0.28]).unwrap();
        assert_eq!(show(spread, Digits::Significant(3)), "0.263±0.015");
        assert_eq!(show(Spread::of([0.331_306]).unwrap(), Digits::Significant(3)), "0.331");
        assert_eq!(show(Spread::of([2.438]).unwrap(), Digits::Decimals(2)), "2.44");
        assert_eq!(show(Spread::of([-1.23e-5]).unwrap(), Digits::Significant(2)), "-1.2e-5");
        assert_eq!(Spread::of([f64::NAN]), None);
    }
}
