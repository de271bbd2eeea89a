//! What spheres cost.

use std::collections::BTreeMap;

use toml::Table;

use super::source::Source;
use super::{Objective, StudyError};
use crate::design::{DesignRef, add_price};
use crate::material::Material;
use crate::score::Measure;

/// The price of a sphere of each material of the palette by its name, in whatever currency: the study's, and where it has none the
/// design's; all of them where a cost is asked for.
pub(super) fn read(
    source: &Source<'_>,
    table: Option<&Table>,
    design: DesignRef<'_>,
    palette: &[Material],
    objective: &Objective,
) -> Result<BTreeMap<String, f64>, StudyError> {
    let asked = objective.terms.iter().any(|term| matches!(term.measure, Measure::HalfCost | Measure::PieceCost));
    let mut own = BTreeMap::new();
    for (name, price) in table.into_iter().flatten() {
        let fail = |message: String| source.fail("prices", format!("prices.{name} = {price} {message}"));
        let number = match price {
            toml::Value::Integer(price) => *price as f64,
            toml::Value::Float(price) => *price,
            _ => return Err(fail("must be a number: the price of one sphere, in any currency.".to_owned())),
        };
        add_price(&mut own, (name, number), design.own_materials())
            .map_err(|wrong| fail(format!("{}. {}", wrong.rule, wrong.help)))?;
    }
    // Two prices of one material are no doubt two currencies, or one is out of date.
    let two = own.iter().find_map(|(name, price)| {
        let known = design.prices().get(name)?;
        (known != price).then_some((name, price, known))
    });
    if let Some((name, price, known)) = two {
        let message = format!(
            "prices: {name} = {price} here, and {known} in the design. Leave out one of the two, or make them alike."
        );
        return Err(source.fail("prices", message));
    }
    let price = |material: &Material| own.get(&material.name).or_else(|| design.prices().get(&material.name)).copied();
    if let Some(unpriced) = palette.iter().find(|material| price(material).is_none()).filter(|_| asked) {
        let name = &unpriced.name;
        let message = format!(
            "cost is asked for, but [prices] of neither study nor design says that of {name}. Add {name} = 0.35, for one sphere."
        );
        return Err(source.fail("cost", message));
    }
    let known = palette.iter().filter_map(|material| Some((material.name.clone(), price(material)?)));
    Ok(known.collect())
}
