//! The section [prices]: what materials cost, for costs of proposals and for who looks for the cheapest.

use std::collections::BTreeMap;

use toml::Spanned;

use super::DesignError;
use crate::document::{Scope, Written};
use crate::material::{self, Material};

/// Prices by the name of the material, as written.
pub(super) type PricesFile = BTreeMap<Spanned<String>, Written>;

/// Prices of one sphere of the design's diameter by the canonical name of the material, in one currency that the file does not name.
pub(super) fn read(
    (scope, file): &(Scope, &PricesFile),
    own: &[Material],
) -> Result<BTreeMap<String, f64>, DesignError> {
    let mut prices = BTreeMap::new();
    for (name, written) in *file {
        let Some(entry) = scope.optional(name.get_ref(), written) else { continue };
        let material = material::find(name.get_ref(), own).map_err(|unknown| {
            let known = unknown.known.join(", ");
            entry.fail(
                "is the price of no known material",
                &format!("Known are {known}; add others as [materials.NAME]."),
            )
        })?;
        let price = entry.number()?;
        if !(price >= 0.0 && price.is_finite()) {
            let help = format!("Write the price of one sphere, like {} = 0.35.", material.name);
            return Err(entry.fail("must not be negative", &help));
        }
        if prices.insert(material.name, price).is_some() {
            return Err(entry.fail("is the second price of this material", "Name each material once."));
        }
    }
    Ok(prices)
}
