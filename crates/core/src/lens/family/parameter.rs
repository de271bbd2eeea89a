//! A number that a family has of its own.

use std::collections::BTreeMap;

use super::Family;
use crate::lens::LensError;

/// In what a parameter is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// A whole number.
    Count,
    /// A plain number.
    Number,
    /// A length (m); files and ranges have it in diameters of spheres.
    Length,
}

impl Quantity {
    /// What a value of one, as ranges have it, is in SI, in a crystal of spheres of this diameter (m).
    pub fn unit(self, diameter: f64) -> f64 {
        match self {
            Self::Count | Self::Number => 1.0,
            Self::Length => diameter,
        }
    }
}

/// A number that a family has beside first row, last row and radius: given, sought, or as it usually is.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Parameter {
    /// As design files write it, below `lens.parameters`.
    pub name: &'static str,
    /// What it is, in a line.
    pub about: &'static str,
    /// In what it is measured.
    pub quantity: Quantity,
    /// Its least and its greatest value; lengths in diameters of spheres.
    pub range: [f64; 2],
    /// Its value where it is neither given nor sought, likewise.
    pub usual: f64,
    /// Whether it is sought where it is not given.
    pub is_sought: bool,
}

impl Parameter {
    /// With the unit at the end, as results call it: `sag_4_m`.
    pub fn key(&self) -> String {
        match self.quantity {
            Quantity::Length => format!("{}_m", self.name),
            Quantity::Count | Quantity::Number => self.name.to_owned(),
        }
    }
}

impl Family {
    /// Values of its parameters, by the names that results have, in words: `, conic -0.5, sag_4 0.20 D`; empty where there are none.
    pub fn words(self, values: &BTreeMap<String, f64>, diameter: f64) -> String {
        let of = |parameter: &Parameter| {
            let value = values.get(&parameter.key())? / parameter.quantity.unit(diameter);
            Some(match parameter.quantity {
                Quantity::Count => format!(", {} {value}", parameter.name),
                Quantity::Number => format!(", {} {value:.3}", parameter.name),
                Quantity::Length => format!(", {} {value:.2} D", parameter.name),
            })
        };
        self.parameters().iter().filter_map(of).collect()
    }

    /// The values (SI) of its parameters: as given by name, or as they usually are.
    ///
    /// # Errors
    /// [`LensError::Parameter`] of a name that it does not have, or a value outside of its range.
    pub fn values(self, given: &BTreeMap<String, f64>, diameter: f64) -> Result<Vec<f64>, LensError> {
        let fail = |name: &str, rule: String| LensError::Parameter { family: self.name(), name: name.to_owned(), rule };
        let known = self.parameters();
        if let Some(stray) = given.keys().find(|name| known.iter().all(|parameter| parameter.name != **name)) {
            let names: Vec<&str> = known.iter().map(|parameter| parameter.name).collect();
            let has = if names.is_empty() { "none".to_owned() } else { names.join(", ") };
            return Err(fail(stray, format!("is none of its parameters; it has {has}")));
        }
        known
            .iter()
            .map(|parameter| {
                let unit = parameter.quantity.unit(diameter);
                let value = given.get(parameter.name).copied().unwrap_or(parameter.usual * unit);
                let [least, most] = parameter.range;
                // Lengths in other units are rounded.
                let slack = 1e-9 * (most - least);
                let within = (least - slack..=most + slack).contains(&(value / unit));
                if within && (parameter.quantity != Quantity::Count || value.fract() == 0.0) {
                    return Ok(value);
                }
                let what = match parameter.quantity {
                    Quantity::Count => "be a whole number",
                    Quantity::Number => "lie",
                    Quantity::Length => "lie, in diameters of spheres,",
                };
                Err(fail(parameter.name, format!("= {} must {what} from {least} to {most}", value / unit)))
            })
            .collect()
    }
}
