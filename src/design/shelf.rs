//! Materials of a user's own and their prices, without a design around them.

use std::collections::BTreeMap;
use std::path::Path;

use super::file::EXAMPLES;
use super::prices::{self, PricesFile};
use super::{Design, DesignError};
use crate::document::{self, OwnMaterials, Scope, Section, Source, Written, is_plain_name};
use crate::material::{self, Material, UnknownMaterial};

/// Materials beside the library's, and what spheres of materials cost.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Shelf {
    /// The user's own.
    pub own: Vec<Material>,
    /// Of one sphere, by the material's name.
    pub prices: BTreeMap<String, f64>,
}

#[derive(serde::Deserialize)]
#[serde(deny_unknown_fields)]
struct ShelfFile {
    format: Written,
    name: Written,
    materials: Section<OwnMaterials>,
    prices: Section<PricesFile>,
}

/// The sections by which a design is known from a file of materials alone.
#[derive(serde::Deserialize)]
struct Opening {
    crystal: Option<toml::Value>,
    target: Option<toml::Value>,
    impact: Option<toml::Value>,
}

impl Shelf {
    /// Reads a file of `[materials.NAME]` and `[prices]`, or those of a design file.
    ///
    /// # Errors
    /// The file cannot be read, or what is wrong with it, the first thing and the others.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, DesignError> {
        let path = path.as_ref();
        let text = document::text(path)?;
        let opening: Option<Opening> = toml::from_str(&text).ok();
        if opening.is_some_and(|Opening { crystal, target, impact }| crystal.or(target).or(impact).is_some()) {
            let design = Design::parse(path, &text)?;
            return Ok(Self { own: design.own_materials, prices: design.prices });
        }
        document::all(Source { path, text: &text, examples: EXAMPLES }, |text| Self::check(path, text))
    }

    fn check(path: &Path, text: &str) -> Result<Self, DesignError> {
        let source = Source { path, text, examples: EXAMPLES };
        let root = document::parse(source)?;
        let file: ShelfFile = document::read(source, &root)?;
        let top = Scope::root(source);
        if let Some(format) = top.optional("format", &file.format)
            && format.whole(0..=u32::MAX)? != 1
        {
            return Err(format.fail("must be 1", "A file of a later format needs a later version of granulens."));
        }
        if let Some(name) = top.optional("name", &file.name)
            && !is_plain_name(name.text()?)
        {
            return Err(name.fail("must be 1 to 100 letters (a to z), digits, - and _", &name.write_it_like()));
        }
        let own = match top.section("materials", &file.materials) {
            Some((_, sections)) => document::materials(source, sections)?,
            None => Vec::new(),
        };
        let prices = match top.section("prices", &file.prices) {
            Some(section) => prices::read(&section, &own)?,
            None => BTreeMap::new(),
        };
        Ok(Self { own, prices })
    }

    /// Finds a material by name or alias, among the user's own and in the library.
    ///
    /// # Errors
    /// `UnknownMaterial`, with the nearest known name.
    pub fn find(&self, name: &str) -> Result<Material, UnknownMaterial> {
        material::find(name, &self.own)
    }
}
