//! The design file: which crystal, what strikes it, where energy is wanted and where not, and which lens is asked for.
//!
//! In: a TOML file. Out: a [`Design`], or a [`DesignError`] that names file, line, key, value, the rule broken and the way
//! out. Whatever can be wrong with a file by itself is found here, in one step; after that nothing re-checks. What only
//! physics can tell (a lens that cannot reach its focus, a step above the stability limit) is found by those who know it.
//!
//! - `file`: as written; `check`: as checked, with `region`, `lens`, `prices`, `threshold` and `tuning` for their parts
//! - `shelf`: own materials and prices without a design
//! - `either`: a design of a sheet or of a crystal in space; `any`: the best of several materials; `blame`: what only physics can tell, as a complaint about the file
//! - `published`: whether it is the published one
//! - `space`: what differs of crystals in space

mod any;
mod blame;
mod check;
mod either;
mod file;
mod lens;
mod prices;
mod published;
mod region;
mod shelf;
mod space;
mod threshold;
mod tuning;

use std::collections::BTreeMap;
use std::fmt;
use std::path::{Path, PathBuf};

pub use crate::document::DocumentError as DesignError;
pub(crate) use check::NO_LAW;
pub use either::{AnyDesign, DesignRef};
pub(crate) use file::EXAMPLES;
pub(crate) use file::ThresholdsFile;
pub(crate) use prices::add as add_price;
pub use shelf::Shelf;
pub use threshold::Threshold;
pub(crate) use threshold::{THRESHOLDS, read as thresholds};
pub(crate) use tuning::tuning;

use crate::contact::{Constants, LawKind};
use crate::dem::{Integrator, Strike};
use crate::document::{self, Source};
use crate::lattice::{Block, HexagonalSheet};
use crate::lens::LensRequest;
use crate::material::{self, Material, UnknownMaterial};
use crate::target::{Region, SpaceRegion, Target};

/// A checked design: of a sheet or, as [`SpaceDesign`], of a crystal in space. Everything in SI; what the file left out holds its default.
#[derive(Clone, Debug, PartialEq)]
pub struct Design<L = HexagonalSheet, R = Region> {
    /// Name, fit for files and folders.
    pub name: String,
    /// The file, as it was named.
    pub path: PathBuf,
    /// The file's text, as read.
    pub text: String,
    /// The crystal's sites.
    pub lattice: L,
    /// Material of the crystal outside the lens.
    pub host: Material,
    /// Materials described in the file itself, in order of name. None has the name or alias of a library material.
    pub own_materials: Vec<Material>,
    /// Prices of one sphere by the name of its material, in one currency that the file does not name.
    pub prices: BTreeMap<String, f64>,
    /// What the user should know about what the file leaves out.
    pub notes: Vec<String>,
    /// Contact law.
    pub law: LawKind,
    /// Set of fitted constants of the law.
    pub constants: Constants,
    /// Coefficient of friction at every contact, with Mindlin's tangential spring; none, as in Burgoyne 2016, unless given.
    pub friction: Option<f64>,
    /// What strikes the crystal.
    pub impact: Strike,
    /// Where energy is wanted and where it is not. Both regions hold spheres and share none.
    pub target: Target<R>,
    /// Which lens is asked for; a design that is only checked with given layouts has none.
    pub lens: Option<LensRequest>,
    /// How motion is advanced.
    pub integrator: Integrator,
    /// Step (s), where given; it then takes the place of `accuracy`.
    pub step: Option<f64>,
    /// What the step is chosen for where it is not given.
    pub accuracy: Accuracy,
    /// Window (s), where given.
    pub window: Option<f64>,
    /// Material of flat strips, random mixtures and the uniform crystal that Q refers to, where it is not that of the lens.
    pub compared_with: Option<Material>,
    /// Seed of the first random layout of each kind.
    pub first_seed: u64,
    /// Number of random layouts of each kind.
    pub seeds: u64,
    /// What `check --strict` asks of the scores.
    pub thresholds: Vec<Threshold>,
}

/// A design in space: `crystal.packing = "hcp"` or `"fcc-111"`.
pub type SpaceDesign = Design<Block, SpaceRegion>;

impl SpaceDesign {
    /// Checks the text of a design file of a crystal in space; `path` is only named in messages.
    ///
    /// # Errors
    /// What is wrong with it, the first thing and the others.
    pub fn parse_in_space(path: impl AsRef<Path>, text: &str) -> Result<Self, DesignError> {
        let path = path.as_ref();
        let source = Source { path, text, examples: file::EXAMPLES };
        document::all(source, |text| space::design(path, text))
    }

    /// What strikes the crystal: `37.5 kN for 20 us on every sphere of layer 1`.
    pub fn impact_in_words(&self) -> String {
        self.struck("layer")
    }
}

/// How exact a run has to be: what its step is chosen for.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Accuracy {
    /// A tenth of a percent. The default.
    #[default]
    TenthPercent,
    /// One percent, with longer steps.
    OnePercent,
}

impl Accuracy {
    /// As a fraction.
    pub const fn fraction(self) -> f64 {
        match self {
            Self::TenthPercent => 1e-3,
            Self::OnePercent => 1e-2,
        }
    }
}

impl fmt::Display for Accuracy {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::TenthPercent => "0.1 %",
            Self::OnePercent => "1 %",
        })
    }
}

impl Design {
    /// Reads and checks a design file.
    ///
    /// # Errors
    /// The file cannot be read, or what is wrong with it, the first thing and the others.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, DesignError> {
        let path = path.as_ref();
        let text = crate::document::text(path)?;
        Self::parse(path, &text)
    }

    /// Checks the text of a design file; `path` is only named in messages.
    ///
    /// # Errors
    /// What is wrong with it, the first thing and the others.
    pub fn parse(path: impl AsRef<Path>, text: &str) -> Result<Self, DesignError> {
        let path = path.as_ref();
        let source = Source { path, text, examples: file::EXAMPLES };
        document::all(source, |text| check::design(path, text))
    }

    /// What strikes the crystal: `26 kN for 20 us on every sphere of row 1`.
    pub fn impact_in_words(&self) -> String {
        self.struck("row")
    }
}

impl<L, R> Design<L, R> {
    /// Its name, where its file stands, and the file's text.
    pub fn file(&self) -> (&str, &Path, &str) {
        (&self.name, &self.path, &self.text)
    }

    /// What strikes the crystal: `26 kN for 20 us on every sphere of row 1`; `row` is the crystal's word for what is struck.
    fn struck(&self, row: &str) -> String {
        match self.impact {
            Strike::Pulse(_) => format!("{} on every sphere of {row} 1", self.impact),
            Strike::Projectile(_) => format!("{} on {row} 1", self.impact),
        }
    }

    /// The contact law, with friction where there is some.
    pub fn law_name(&self) -> String {
        match self.friction {
            Some(mu) => format!("{}, friction {mu}", self.law),
            None => self.law.to_string(),
        }
    }

    /// What flat strips, random mixtures and the uniform crystal that Q refers to are made of, whatever layout is judged: the material of
    /// `compare.material`, or of the lens. None where the design names neither; commands then take the first material that is not the
    /// host, of the layout or of the study, and say so.
    pub fn reference(&self) -> Option<&Material> {
        self.compared_with.as_ref().or(self.lens.as_ref().map(|lens| &lens.material))
    }

    /// The materials that the design names: host, that of the baselines, that of the lens, further ones of the lens.
    pub fn palette(&self) -> Vec<Material> {
        let lens = self.lens.iter().flat_map(|lens| std::iter::once(&lens.material).chain(&lens.others));
        let mut palette = vec![self.host.clone()];
        for material in self.reference().into_iter().chain(lens) {
            if !palette.contains(material) {
                palette.push(material.clone());
            }
        }
        palette
    }

    /// Price of one sphere of a material, where the design says it.
    pub fn price(&self, material: &Material) -> Option<f64> {
        self.prices.get(&material.name).copied()
    }

    /// A complaint of those who know the physics about `key`, such as `run.step`: it points to where the key stands in the
    /// file, or, where it is left out, to its section.
    pub fn blame(&self, key: &str, message: String, help: String) -> DesignError {
        let source = Source { path: &self.path, text: &self.text, examples: file::EXAMPLES };
        source.error(document::place(source, key), Some(key), message, help)
    }

    /// Finds a material by name or alias, among those of the file and in the library.
    ///
    /// # Errors
    /// `UnknownMaterial`, with the nearest known name.
    pub fn material(&self, name: &str) -> Result<Material, UnknownMaterial> {
        material::find(name, &self.own_materials)
    }
}
