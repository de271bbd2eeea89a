//! The sections [materials.NAME]: materials of the file's own, and the choice among all that are known.

use std::collections::BTreeMap;

use toml::Spanned;

use super::error::{DocumentError, Source, did_you_mean};
use super::keys::{Keys, Written, section};
use super::value::{Entry, Scope, is_plain_name, name_error};
use crate::material::{self, Material};
use crate::units::Dimension;

/// The sections below [materials].
pub(crate) type OwnMaterials = BTreeMap<Spanned<String>, Spanned<Keys<MaterialFile>>>;

section!(MaterialFile: Written { density, youngs_modulus, poisson_ratio, yield_stress, rate_constant, source });

/// How their keys are written; `*` stands for the name of a material.
pub(super) const EXAMPLES: &[&str] = &[
    "materials.*.density = \"7800 kg/m3\"",
    "materials.*.youngs_modulus = \"200 GPa\"",
    "materials.*.poisson_ratio = 0.3",
    "materials.*.yield_stress = \"900 MPa\"",
    "materials.*.rate_constant = 0.02",
    "materials.*.source = \"own measurement, 2026\"",
];

pub(crate) fn materials(source: Source, sections: &OwnMaterials) -> Result<Vec<Material>, DocumentError> {
    sections.iter().map(|(name, section)| material(source, name, section)).collect()
}

fn material(
    source: Source,
    name: &Spanned<String>,
    section: &Spanned<Keys<MaterialFile>>,
) -> Result<Material, DocumentError> {
    let refused = |rule: &str, help: &str| Err(name_error(source, name, "materials", rule, help));
    if !is_plain_name(name.get_ref()) {
        let help = "Layout files and tables hold this name. Write it like [materials.my-steel].";
        return refused("must be named with 1 to 100 letters (a to z), digits, - and _", help);
    }
    if let Some(canonical) = material::canonical(name.get_ref()) {
        let rule = if canonical == name.get_ref() {
            "has the name of a library material".to_owned()
        } else {
            format!("has another name of the library's {canonical}")
        };
        return refused(&rule, "Choose a name of your own, so that a name means the same in every design.");
    }
    let scope = Scope::new(source, format!("materials.{}", name.get_ref()), section.span());
    let file = &section.get_ref().0;
    let density = scope.required("density", &file.density)?;
    let youngs_modulus = scope.required("youngs_modulus", &file.youngs_modulus)?;
    let poisson_ratio = scope.required("poisson_ratio", &file.poisson_ratio)?;
    let yield_stress = scope.required("yield_stress", &file.yield_stress)?;
    let rate_constant = scope.required("rate_constant", &file.rate_constant)?;
    let origin = scope.required("source", &file.source)?;
    if origin.text()?.trim().is_empty() {
        return Err(origin.fail("must say where the values come from", &origin.write_it_like()));
    }
    let material = Material {
        name: name.get_ref().clone(),
        density: density.quantity(Dimension::Density)?,
        youngs_modulus: youngs_modulus.quantity(Dimension::Pressure)?,
        poisson_ratio: poisson_ratio.number()?,
        yield_stress: yield_stress.quantity(Dimension::Pressure)?,
        rate_constant: rate_constant.number()?,
        source: origin.text()?.to_owned(),
    };
    material.check().map_err(|error| {
        let entry = match error.key {
            "density" => &density,
            "youngs_modulus" => &youngs_modulus,
            "poisson_ratio" => &poisson_ratio,
            "yield_stress" => &yield_stress,
            _ => &rate_constant,
        };
        // The rule begins with the unit of the SI value; here the value is shown as it was written.
        let rule = error.rule.find("must").map_or(error.rule, |at| &error.rule[at..]);
        entry.fail(rule, &entry.write_it_like())
    })?;
    Ok(material)
}

/// The material that a key names.
pub(crate) fn chosen(entry: &Entry, own: &[Material]) -> Result<Material, DocumentError> {
    material::find(entry.text()?, own).map_err(|unknown| {
        let near = unknown.nearest.map(|near| format!("\"{near}\""));
        let known = unknown.known.join(", ");
        let help = format!("{}Known are {known}; add others as [materials.NAME].", did_you_mean(near.as_deref()));
        entry.fail("is no known material", &help)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Messages rely on it.
    #[test]
    fn every_key_of_a_material_has_an_example_that_is_toml() {
        for key in MaterialFile::KEYS {
            let example = super::super::example(&[], &format!("materials.my-steel.{key}")).expect(key);
            toml::de::DeTable::parse(&example).expect(&example);
        }
    }
}
