//! What spheres cost.

use toml::Table;

use super::source::Source;
use super::{Measure, Objective, StudyError};
use crate::design::Design;
use crate::material::Material;

/// The price of a sphere of each material of the palette, in whatever currency; 0 for all where no cost is asked for.
pub(super) fn read(
    source: &Source<'_>,
    table: Option<&Table>,
    design: &Design,
    palette: &[Material],
    objective: &Objective,
) -> Result<Vec<f64>, StudyError> {
    let asked = objective.wishes.iter().any(|wish| wish.measure == Measure::Cost);
    let mut prices = vec![None; palette.len()];
    for (name, price) in table.into_iter().flatten() {
        let fail = |message: String| source.fail("prices", format!("prices.{name}: {message}"));
        let material = design.material(name).map_err(|error| fail(format!("{error}.")))?;
        let price = match price {
            toml::Value::Integer(price) => *price as f64,
            toml::Value::Float(price) => *price,
            other => return Err(fail(format!("{other} is no number; the price of one sphere is, in any currency."))),
        };
        if !(price.is_finite() && price >= 0.0) {
            return Err(fail(format!("a price of {price} must not be negative.")));
        }
        if let Some(place) = palette.iter().position(|known| *known == material) {
            prices[place] = Some(price);
        }
    }
    if let Some(place) = prices.iter().position(Option::is_none).filter(|_| asked) {
        let name = &palette[place].name;
        let message =
            format!("cost is asked for, but [prices] does not say that of {name}. Add {name} = 0.35, for one sphere.");
        return Err(source.fail("cost", message));
    }
    Ok(prices.into_iter().map(Option::unwrap_or_default).collect())
}
