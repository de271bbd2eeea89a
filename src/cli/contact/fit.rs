//! A law's constants from a measured curve.

use std::path::Path;

use granulens::contact::{Fit, LawKind, Measured, Pair, fit};
use serde_json::{Value, json};

use super::states::cells;
use crate::cli::failure::Failure;

/// Reads a measurement, by its two columns, and fits the law to it.
pub fn of_file(path: &Path, law: LawKind, pair: &Pair) -> Result<Fit, Failure> {
    fit(law, pair, &measured(path)?)
        .map_err(|error| Failure::of_file(path, None, &format!("does not determine the law: {error}")))
}

fn measured(path: &Path) -> Result<Measured, Failure> {
    let text = granulens::input::text(path).map_err(|error| Failure::of_file(path, None, &error.to_string()))?;
    let mut lines = (1..).zip(text.lines()).filter(|(_, line)| !line.starts_with('#') && !line.trim().is_empty());
    let (line, header) = lines.next().unwrap_or((1, ""));
    let names = cells(header);
    let place = |name: &str| names.iter().position(|&column| column == name);
    let (x, y, is_curve) = match (place("overlap_m"), place("force_N"), place("speed_m_s"), place("restitution")) {
        (Some(x), Some(y), None, None) => (x, y, true),
        (None, None, Some(x), Some(y)) => (x, y, false),
        _ => {
            let message = "expected the columns overlap_m,force_N, or speed_m_s,restitution";
            return Err(Failure::of_file(path, Some(line), message));
        }
    };
    let mut points = Vec::new();
    for (line, text) in lines {
        let cells = cells(text);
        let number = |place: usize| {
            let cell = cells.get(place).copied().unwrap_or_default();
            cell.parse().ok().filter(|value: &f64| value.is_finite()).ok_or_else(|| {
                Failure::of_file(path, Some(line), &format!("{} = \"{cell}\" is not a finite number", names[place]))
            })
        };
        points.push([number(x)?, number(y)?]);
    }
    Ok(if is_curve { Measured::Curve(points) } else { Measured::Restitution(points) })
}

/// In words, a line for each constant.
pub fn words(fit: &Fit, law: LawKind) -> String {
    let mut text = format!("{law}, deviation {:.3e} (root of the mean square)\n", fit.deviation);
    for estimate in &fit.estimates {
        let interval = match estimate.interval {
            Some([low, high]) => format!("{low:.5e} to {high:.5e} (95 %)"),
            None => "not determined by these points".to_owned(),
        };
        text += &format!("{:<26}{:.5e}   {interval}\n", estimate.constant.name(), estimate.value);
    }
    text.trim_end().to_owned()
}

pub fn json(fit: &Fit, law: LawKind) -> Value {
    let constants: serde_json::Map<String, Value> = fit
        .estimates
        .iter()
        .map(|estimate| {
            let value = json!({ "value": estimate.value, "interval_95": estimate.interval });
            (estimate.constant.name().to_owned(), value)
        })
        .collect();
    json!({
        "format": granulens::outcome::FORMAT, "law": law.name(), "deviation": fit.deviation, "constants": constants,
    })
}
