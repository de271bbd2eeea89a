//! Materials: elastic, plastic, rate and density values, each with its source, and the library of named ones.
//!
//! Values are those of Burgoyne 2016, table 2.1, except where a material's `source` says otherwise. Poisson's ratio is
//! never stated there; 0.3 is taken for its metals.

use serde::{Deserialize, Serialize};

/// What a sphere is made of.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Material {
    /// Canonical name, such as `stainless-440c`.
    pub name: String,
    /// ρ (kg/m³)
    pub density: f64,
    /// Young's modulus E (Pa)
    pub youngs_modulus: f64,
    /// Poisson's ratio ν
    pub poisson_ratio: f64,
    /// Quasistatic yield stress σ_y (Pa)
    pub yield_stress: f64,
    /// Johnson-Cook rate constant C in σ = σ_y (1 + C ln(ε̇/ε̇₀)), ε̇₀ = 0.001 /s (Burgoyne 2016, eq. 3.7, sign corrected)
    pub rate_constant: f64,
    /// Where the values come from.
    pub source: String,
}

/// The value of a material that cannot be.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{key} = {value} {rule}")]
pub struct MaterialError {
    /// Which property, by its name in files.
    pub key: &'static str,
    /// The offending value in SI.
    pub value: f64,
    /// What it must be.
    pub rule: &'static str,
}

impl Material {
    /// Checks every value against the range in which the contact laws have a meaning.
    ///
    /// # Errors
    /// The first property that is not finite or out of its range.
    pub fn check(&self) -> Result<(), MaterialError> {
        let rule = |key, value: f64, ok: bool, rule| {
            if ok && value.is_finite() { Ok(()) } else { Err(MaterialError { key, value, rule }) }
        };
        rule("density", self.density, self.density > 0.0, "kg/m3 must be positive")?;
        rule("youngs_modulus", self.youngs_modulus, self.youngs_modulus > 0.0, "Pa must be positive")?;
        rule(
            "poisson_ratio",
            self.poisson_ratio,
            (0.0..=0.5).contains(&self.poisson_ratio),
            "must lie between 0 and 0.5",
        )?;
        rule("yield_stress", self.yield_stress, self.yield_stress > 0.0, "Pa must be positive")?;
        // c₁ = 6.304 − 6.76 (E*/σ_y)^−0.137 of the contact law falls to zero near E*/σ_y = 1.7 and was fitted from 20 upwards.
        rule(
            "yield_stress",
            self.yield_stress,
            self.yield_stress < self.youngs_modulus / 10.0,
            "Pa must be below a tenth of youngs_modulus, where the contact law's fit ends",
        )?;
        rule(
            "rate_constant",
            self.rate_constant,
            (0.0..=0.2).contains(&self.rate_constant),
            "must lie between 0 and 0.2",
        )
    }

    /// Mass of a solid sphere of diameter `diameter` (m), in kg.
    pub fn sphere_mass(&self, diameter: f64) -> f64 {
        self.density * std::f64::consts::PI / 6.0 * diameter.powi(3)
    }
}

/// A library entry: canonical name, aliases, and the values (ρ, E, ν, σ_y, C) in kg/m³, GPa, -, MPa, -.
struct Entry {
    name: &'static str,
    aliases: &'static [&'static str],
    values: [f64; 5],
    source: &'static str,
}

const TABLE: &str = "density, E, yield stress: Burgoyne 2016, table 2.1; nu 0.3 assumed";

const LIBRARY: &[Entry] = &[
    Entry {
        name: "stainless-440c",
        aliases: &["440c"],
        values: [7650.0, 200.0, 0.3, 1900.0, 0.035],
        source: "density, E, yield stress: Burgoyne 2016, table 2.1; C: ch. 4 (0.04 in ch. 3); nu 0.3 assumed",
    },
    Entry {
        name: "stainless-302",
        aliases: &["302", "304", "stainless-304"],
        values: [7860.0, 200.0, 0.3, 600.0, 0.025],
        source: "density, E, yield stress: Burgoyne 2016, table 2.1; C: ch. 4; nu 0.3 assumed",
    },
    Entry {
        name: "aluminium-2017",
        aliases: &["al", "aluminum-2017", "aluminium", "aluminum"],
        values: [2700.0, 75.0, 0.3, 400.0, 0.0],
        source: TABLE,
    },
    Entry { name: "brass-260", aliases: &["brass"], values: [8530.0, 110.0, 0.3, 670.0, 0.0], source: TABLE },
    Entry {
        name: "tungsten-carbide",
        aliases: &["wc"],
        values: [15450.0, 610.0, 0.24, 3500.0, 0.0],
        source: "values with which Burgoyne 2016, section 4.3 (629 and 3011 m/s) is reproduced; not printed there",
    },
];

/// All materials of the library, in the order in which they are listed to users.
pub fn library() -> Vec<Material> {
    LIBRARY.iter().map(Entry::material).collect()
}

/// The aliases of a library material; empty for others.
pub fn aliases(name: &str) -> &'static [&'static str] {
    LIBRARY.iter().find(|entry| entry.name == name).map_or(&[], |entry| entry.aliases)
}

/// The canonical name of a library material given by name or alias.
pub fn canonical(name: &str) -> Option<&'static str> {
    LIBRARY.iter().find(|entry| entry.name == name || entry.aliases.contains(&name)).map(|entry| entry.name)
}

/// No material of that name.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("unknown material \"{name}\"{}; known are {}", suggestion(.nearest), .known.join(", "))]
pub struct UnknownMaterial {
    /// The name as given.
    pub name: String,
    /// The most similar known name, where one is near enough to have been meant.
    pub nearest: Option<String>,
    /// All canonical names.
    pub known: Vec<String>,
}

fn suggestion(nearest: &Option<String>) -> String {
    nearest.as_ref().map_or(String::new(), |near| format!(" (did you mean \"{near}\"?)"))
}

/// Finds a material by canonical name or alias, first among `own`, then in the library.
///
/// # Errors
/// `UnknownMaterial`, with the nearest known name.
///
/// ```
/// let brass = granulens_core::material::find("brass", &[]).unwrap();
/// assert_eq!(brass.name, "brass-260");
/// assert_eq!(granulens_core::material::find("bras", &[]).unwrap_err().nearest.as_deref(), Some("brass"));
/// ```
pub fn find(name: &str, own: &[Material]) -> Result<Material, UnknownMaterial> {
    if let Some(material) = own.iter().find(|material| material.name == name) {
        return Ok(material.clone());
    }
    if let Some(entry) = LIBRARY.iter().find(|entry| entry.name == name || entry.aliases.contains(&name)) {
        return Ok(entry.material());
    }
    let known: Vec<String> =
        own.iter().map(|m| m.name.clone()).chain(LIBRARY.iter().map(|entry| entry.name.to_owned())).collect();
    let every = known.iter().map(String::as_str).chain(LIBRARY.iter().flat_map(|entry| entry.aliases.iter().copied()));
    let nearest = every
        .map(|candidate| (strsim::jaro_winkler(&name.to_lowercase(), candidate), candidate))
        .filter(|(similarity, _)| *similarity > 0.75)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, candidate)| candidate.to_owned());
    Err(UnknownMaterial { name: name.to_owned(), nearest, known })
}

impl Entry {
    fn material(&self) -> Material {
        let [density, youngs, poisson_ratio, yield_stress, rate_constant] = self.values;
        Material {
            name: self.name.to_owned(),
            density,
            youngs_modulus: youngs * 1e9,
            poisson_ratio,
            yield_stress: yield_stress * 1e6,
            rate_constant,
            source: self.source.to_owned(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_library_material_is_sound_and_found_by_every_alias() {
        for material in library() {
            material.check().unwrap();
            for alias in aliases(&material.name) {
                assert_eq!(find(alias, &[]).unwrap(), material);
            }
        }
    }

    #[test]
    fn own_materials_come_before_the_library() {
        let mut own = find("brass-260", &[]).unwrap();
        own.density = 8400.0;
        assert_eq!(find("brass-260", std::slice::from_ref(&own)).unwrap().density, 8400.0);
    }
}
