//! The section [prices]: what materials cost, for costs of proposals and for who looks for the cheapest.

use std::collections::BTreeMap;

use toml::Spanned;

use super::DesignError;
use crate::document::{Scope, Written};
use crate::material::{self, Material};

/// Prices by the name of the material, as written.
pub(super) type PricesFile = BTreeMap<Spanned<String>, Written>;

/// What is wrong with a price.
pub(crate) struct WrongPrice {
    /// The rule that it breaks, to stand behind the key and its value.
    pub rule: &'static str,
    /// What to try.
    pub help: String,
}

/// Takes down the price of one sphere of a material; a design's prices and a study's are checked here.
pub(crate) fn add(
    prices: &mut BTreeMap<String, f64>,
    (name, price): (&str, f64),
    own: &[Material],
) -> Result<(), WrongPrice> {
    let material = material::find(name, own).map_err(|unknown| WrongPrice {
        rule: "is the price of no known material",
        help: format!("Known are {}; add others as [materials.NAME].", unknown.known.join(", ")),
    })?;
    if !(price >= 0.0 && price.is_finite()) {
        let help = format!("Write the price of one sphere, like {} = 0.35.", material.name);
        return Err(WrongPrice { rule: "must not be negative", help });
    }
    if prices.insert(material.name, price).is_some() {
        let help = "Name each material once.".to_owned();
        return Err(WrongPrice { rule: "is the second price of this material", help });
    }
    Ok(())
}

/// Prices of one sphere of the design's diameter by the canonical name of the material, in one currency that the file does not name.
pub(super) fn read(
    (scope, file): &(Scope, &PricesFile),
    own: &[Material],
) -> Result<BTreeMap<String, f64>, DesignError> {
    let mut prices = BTreeMap::new();
    for (name, written) in *file {
        let Some(entry) = scope.optional(name.get_ref(), written) else { continue };
        add(&mut prices, (name.get_ref(), entry.number()?), own)
            .map_err(|wrong| entry.fail(wrong.rule, &wrong.help))?;
    }
    Ok(prices)
}
