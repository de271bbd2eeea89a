//! The comparison: one line per arrangement, random ones of a kind folded to mean ± standard deviation over seeds.

use serde::Serialize;

use super::digits::{NONE, decimals, significant};
use super::profiles::random_kinds;
use crate::chance::Mean;
use crate::outcome::{ArrangementOutcome, Outcome, Scores};

/// How many digits a quantity is shown with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Digits {
    /// So many significant ones.
    Significant(usize),
    /// So many behind the point.
    Decimals(usize),
}

/// Picks a number from the scores; none where a ratio has no denominator.
pub type Pick = fn(&Scores) -> Option<f64>;

/// A column of the comparison.
pub struct Quantity {
    /// Short name with its unit, for a terminal.
    pub head: &'static str,
    /// Symbol or name, for a page.
    pub name: &'static str,
    /// Unit; empty for ratios.
    pub unit: &'static str,
    /// What one unit is in SI.
    pub scale: f64,
    /// How it is shown.
    pub digits: Digits,
    /// Where it comes from.
    pub of: Pick,
}

const fn energy(head: &'static str, name: &'static str, digits: usize, of: Pick) -> Quantity {
    Quantity { head, name, unit: "J", scale: 1.0, digits: Digits::Significant(digits), of }
}

const fn ratio(name: &'static str, of: Pick) -> Quantity {
    Quantity { head: name, name, unit: "", scale: 1.0, digits: Digits::Decimals(2), of }
}

/// F, mean over the focal region.
pub const FOCAL: Quantity = energy("F [J]", "F", 3, |s| Some(s.focal_mean));
/// P, mean over the protected region.
pub const PROTECTED: Quantity = energy("P [J]", "P", 3, |s| Some(s.protected_mean));
/// C = F/P.
pub const CONTRAST: Quantity = ratio("C", |s| s.contrast);
/// G = F/F of the host alone.
pub const GAIN: Quantity = ratio("G", |s| s.focal_gain);
/// Q = P/P of the lens material alone.
pub const PROTECTION: Quantity = ratio("Q", |s| s.protection);
/// P of the lens over P of the arrangement.
pub const AGAINST: Quantity = ratio("Plens/P", |s| s.protected_ratio);
/// Dissipated energy.
pub const DISSIPATED: Quantity = energy("lost [J]", "dissipated", 4, |s| Some(s.dissipated));
/// The published estimate of the dissipated energy.
pub const EQ_5_6: Quantity = energy("eq 5.6 [J]", "eq. 5.6", 4, |s| Some(s.eq_5_6));
/// Greatest momentum of the last row.
pub const EXIT_MOMENTUM: Quantity = Quantity {
    head: "exit p [kg m/s]",
    name: "exit momentum",
    unit: "kg m/s",
    scale: 1.0,
    digits: Digits::Significant(3),
    of: |s| Some(s.exit_momentum),
};
/// Greatest force on the last row.
pub const EXIT_FORCE: Quantity = Quantity {
    head: "exit [kN]",
    name: "exit peak force",
    unit: "kN",
    scale: 1e3,
    digits: Digits::Significant(3),
    of: |s| Some(s.exit_force),
};
/// What the energy ledger leaves open, as a fraction of the work of the load.
pub const RESIDUAL: Quantity = Quantity {
    head: "residual",
    name: "residual",
    unit: "",
    scale: 1.0,
    digits: Digits::Significant(2),
    of: |s| Some(s.residual),
};

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
    /// A quantity over the members, in its unit.
    pub fn spread(&self, quantity: &Quantity) -> Option<Spread> {
        Spread::of(self.members.iter().filter_map(|m| (quantity.of)(&m.scores)).map(|v| v / quantity.scale))
    }

    /// A quantity as it is shown: `0.331`, `0.264±0.026` or a dash.
    pub fn show(&self, quantity: &Quantity) -> String {
        self.spread(quantity).map_or(NONE.to_owned(), |spread| show(spread, quantity.digits))
    }

    /// The number of spheres that are not of the host; a mean over seeds.
    pub fn spheres(&self) -> String {
        let spread = Spread::of(self.members.iter().map(|m| m.spheres as f64));
        spread.map_or(NONE.to_owned(), |s| show(s, Digits::Decimals(0)))
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
pub fn lines(outcome: &Outcome) -> Vec<Line<'_>> {
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
pub fn worst_residual(outcome: &Outcome) -> Option<f64> {
    let residuals = outcome.arrangements.iter().map(|a| a.scores.residual.abs()).filter(|r| r.is_finite());
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
