//! The design file as written: which keys there are and where each value stands, nothing about their meaning.
//!
//! Every key is optional here and every value may be anything, so that what is missing or of the wrong type is reported
//! by the check, in the same words as everything else. Only unknown keys and values in the place of sections are found here.

use std::collections::BTreeMap;
use std::fmt;
use std::marker::PhantomData;
use std::ops::Range;

use serde::de::value::MapAccessDeserializer;
use serde::de::{Deserialize, Deserializer, MapAccess, Visitor};
use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::error::{DesignError, Source, did_you_mean, nearest};

/// A value and where it stands, if it was written.
pub(super) type Written = Option<Spanned<toml::Value>>;
/// A section (or inline table) and where its header stands, if it was written.
pub(super) type Section<T> = Option<Spanned<Keys<T>>>;

/// Declares the keys of a section.
macro_rules! section {
    ($name:ident: $type:ty { $($key:ident),* }) => {
        #[derive(serde::Deserialize)]
        #[serde(deny_unknown_fields)]
        pub(super) struct $name { $(pub $key: $type),* }
        impl $name {
            #[cfg(test)]
            const KEYS: &[&str] = &[$(stringify!($key)),*];
        }
    };
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct DesignFile {
    #[expect(dead_code, reason = "the format has been read before all else; here it only is a known key")]
    pub format: Written,
    pub name: Written,
    pub crystal: Section<CrystalFile>,
    pub impact: Section<ImpactFile>,
    pub target: Section<TargetFile>,
    pub lens: Section<LensFile>,
    pub run: Section<RunFile>,
    pub compare: Section<CompareFile>,
    pub thresholds: Section<ThresholdsFile>,
    pub materials: Section<BTreeMap<Spanned<String>, Spanned<Keys<MaterialFile>>>>,
}

section!(CrystalFile: Written { packing, diameter, rows, half_width, sides, host, law, constants });
section!(ImpactFile: Written { kind, force, duration });
section!(TargetFile: Section<RegionFile> { focus, protect });
section!(RegionFile: Written { rows, x });
section!(LensFile: Written { family, material, apex_row, back_row, radius, max_interface_angle, rows });
section!(RunFile: Written { integrator, step, accuracy, window });
section!(CompareFile: Written { seeds, first_seed });
section!(ThresholdsFile: Section<BoundsFile> {
    contrast, focal_gain, protection, focal_mean, protected_mean, dissipated, residual
});
section!(BoundsFile: Written { min, max });
section!(MaterialFile: Written { density, youngs_modulus, poisson_ratio, yield_stress, rate_constant, source });

/// How each key is written, for messages; `*` stands for the name of a material.
const EXAMPLES: &[&str] = &[
    "format = 1",
    "name = \"thesis-lens\"",
    "crystal.packing = \"hexagonal-2d\"",
    "crystal.diameter = \"6.35 mm\"",
    "crystal.rows = 50",
    "crystal.half_width = 16.5",
    "crystal.sides = \"mirror\"",
    "crystal.host = \"stainless-440c\"",
    "crystal.law = \"thesis\"",
    "crystal.constants = \"code\"",
    "impact.kind = \"force-pulse\"",
    "impact.force = \"26 kN\"",
    "impact.duration = \"20 us\"",
    "target.focus = { rows = [30, 34], x = [\"0 D\", \"2.5 D\"] }",
    "target.focus.rows = [30, 34]",
    "target.focus.x = [\"0 D\", \"2.5 D\"]",
    "target.protect = { rows = [30, 34], x = [\"12 D\", \"16.5 D\"] }",
    "target.protect.rows = [30, 34]",
    "target.protect.x = [\"12 D\", \"16.5 D\"]",
    "lens.family = \"plano-convex\"",
    "lens.material = \"brass-260\"",
    "lens.apex_row = 5",
    "lens.back_row = 16",
    "lens.radius = \"19 D\"",
    "lens.max_interface_angle = \"60 deg\"",
    "lens.rows = [2, 29]",
    "run.integrator = \"verlet\"",
    "run.step = \"1e-7 s\"",
    "run.accuracy = \"0.1 %\"",
    "run.window = \"350 us\"",
    "compare.seeds = 5",
    "compare.first_seed = 1",
    "thresholds.contrast = { min = 2.0 }",
    "thresholds.focal_gain = { min = 1.5 }",
    "thresholds.protection = { max = 0.8 }",
    "thresholds.focal_mean = { min = \"0.3 J\" }",
    "thresholds.protected_mean = { max = \"0.1 J\" }",
    "thresholds.dissipated = { max = \"40 J\" }",
    "thresholds.residual = { min = -0.01, max = 0.01 }",
    "materials.*.density = \"7800 kg/m3\"",
    "materials.*.youngs_modulus = \"200 GPa\"",
    "materials.*.poisson_ratio = 0.3",
    "materials.*.yield_stress = \"900 MPa\"",
    "materials.*.rate_constant = 0.02",
    "materials.*.source = \"own measurement, 2026\"",
];

/// How a key, given with its sections, is written below the header of its section.
pub(super) fn example(key: &str) -> Option<String> {
    let pattern = match key.strip_prefix("materials.").and_then(|rest| rest.rsplit_once('.')) {
        Some((_, property)) => format!("materials.*.{property}"),
        None => key.to_owned(),
    };
    // The bounds of a threshold are shown with their braces.
    let pattern = match pattern.strip_suffix(".min").or(pattern.strip_suffix(".max")) {
        Some(threshold) => threshold.to_owned(),
        None => pattern,
    };
    let line = EXAMPLES.iter().find(|line| line.split(" = ").next() == Some(&pattern))?;
    let section = pattern.rfind('.').map_or(0, |dot| dot + 1);
    Some(line[section..].to_owned())
}

/// The keys of a section: reads only from a table, where a derived reader would also take a list.
pub(super) struct Keys<T>(pub T);

const NOT_A_TABLE: &str = "a section with keys";

impl<'de, T: Deserialize<'de>> Deserialize<'de> for Keys<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct TableOnly<T>(PhantomData<T>);
        impl<'de, T: Deserialize<'de>> Visitor<'de> for TableOnly<T> {
            type Value = T;
            fn expecting(&self, f: &mut fmt::Formatter) -> fmt::Result {
                f.write_str(NOT_A_TABLE)
            }
            fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<T, A::Error> {
                T::deserialize(MapAccessDeserializer::new(map))
            }
        }
        deserializer.deserialize_map(TableOnly(PhantomData)).map(Keys)
    }
}

/// Reads the keys of `T` from a parsed text; unknown ones are refused if `T` does so.
pub(super) fn read<'a, T: Deserialize<'a>>(source: Source<'a>, root: &Spanned<DeTable<'a>>) -> Result<T, DesignError> {
    T::deserialize(toml::Deserializer::from(root.clone())).map_err(|error| {
        let place = error.span().unwrap_or(0..0);
        let found = find(root.get_ref(), &place, "");
        let key = found.as_ref().map_or(String::new(), |(key, _)| key.clone());
        let is_table = found.is_some_and(|(_, is_table)| is_table);
        let (section, name) = key.rsplit_once('.').unwrap_or(("", &key));
        let (what, expected) = error.message().rsplit_once("expected ").unwrap_or((error.message(), ""));
        let (message, help) = if what.starts_with("unknown field") {
            // What follows lists the known keys between backticks.
            unknown_key(section, name, is_table, expected.split('`').skip(1).step_by(2).collect())
        } else if expected.starts_with(NOT_A_TABLE) {
            not_a_section(&key, &source.written(place.clone()))
        } else {
            // Of what TOML can hold, only whole numbers beyond 64 bits reach this.
            let help = example(&key).map_or(String::new(), |example| format!("Write it like {example}."));
            (format!("{key} = {} is out of range.", source.written(place.clone())), help)
        };
        source.error(Some(place), Some(&key), message, help)
    })
}

fn unknown_key(section: &str, name: &str, is_table: bool, known: Vec<&str>) -> (String, String) {
    if !section.is_empty() {
        let near = did_you_mean(nearest(name, known.iter().copied()));
        return (
            format!("{section}.{name} is no known key."),
            format!("{near}Known in {section} are {}.", known.join(", ")),
        );
    }
    let (keys, sections): (Vec<&str>, Vec<&str>) = known.into_iter().partition(|key| ["format", "name"].contains(key));
    if is_table {
        let sections: Vec<String> = sections.iter().map(|section| format!("[{section}]")).collect();
        let near = did_you_mean(nearest(&format!("[{name}]"), sections.iter().map(String::as_str)));
        (format!("[{name}] is no known section."), format!("{near}Known are {}.", sections.join(", ")))
    } else {
        let near = did_you_mean(nearest(name, keys.iter().copied()));
        let help = format!("{near}Only {} stand before the first section.", keys.join(" and "));
        (format!("{name} is no known key."), help)
    }
}

fn not_a_section(key: &str, written: &str) -> (String, String) {
    if let Some(example) = example(key) {
        return (format!("{key} = {written} must be keys in braces."), format!("Write it like {example}."));
    }
    let help = match key.strip_prefix("materials.") {
        Some(_) => {
            "Below [materials] stand only sections, each named after a material, like [materials.my-steel].".to_owned()
        }
        None => format!("Write [{key}] on a line of its own and its keys below."),
    };
    let shown = if written.starts_with("[[") { written.to_owned() } else { format!("{key} = {written}") };
    (format!("{shown} must be a section."), help)
}

/// The key (with its sections) that stands, or whose value stands, at `place`, and whether it is a section.
fn find(table: &DeTable, place: &Range<usize>, above: &str) -> Option<(String, bool)> {
    table.iter().find_map(|(name, value)| {
        let key = if above.is_empty() { name.get_ref().to_string() } else { format!("{above}.{}", name.get_ref()) };
        let (inside, is_table) = match value.get_ref() {
            DeValue::Table(inner) => (find(inner, place, &key), true),
            _ => (None, false),
        };
        let here = [name.span(), value.span()].iter().any(|span| span.contains(&place.start));
        inside.or(here.then_some((key, is_table)))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Messages rely on it.
    #[test]
    fn every_key_has_an_example_that_is_toml() {
        let sections = [
            ("crystal", CrystalFile::KEYS),
            ("impact", ImpactFile::KEYS),
            ("target", TargetFile::KEYS),
            ("target.focus", RegionFile::KEYS),
            ("target.protect", RegionFile::KEYS),
            ("lens", LensFile::KEYS),
            ("run", RunFile::KEYS),
            ("compare", CompareFile::KEYS),
            ("thresholds", ThresholdsFile::KEYS),
            ("thresholds.residual", BoundsFile::KEYS),
            ("materials.my-steel", MaterialFile::KEYS),
        ];
        for (section, keys) in sections {
            for key in keys {
                let example = example(&format!("{section}.{key}")).expect(key);
                DeTable::parse(&example).expect(&example);
            }
        }
        assert_eq!(example("format").as_deref(), Some("format = 1"));
    }
}
