//! A design of either kind: of a sheet, or of a crystal in space.

use std::collections::BTreeMap;
use std::path::Path;

use super::{Accuracy, Design, DesignError, SpaceDesign, Threshold, space};
use crate::contact::{Constants, LawKind};
use crate::dem::Strike;
use crate::document;
use crate::layout::{self, AnyLayout, Layout, LayoutFileError};
use crate::lens::LensRequest;
use crate::material::{Material, UnknownMaterial};

/// A design file of either kind.
#[derive(Clone, Debug, PartialEq)]
pub enum AnyDesign {
    /// Of a sheet.
    Plane(Box<Design>),
    /// Of a crystal in space.
    Space(Box<SpaceDesign>),
}

/// The same, lent.
#[derive(Clone, Copy, Debug)]
pub enum DesignRef<'a> {
    /// Of a sheet.
    Plane(&'a Design),
    /// Of a crystal in space.
    Space(&'a SpaceDesign),
}

/// The same of both kinds.
macro_rules! each {
    ($any:expr, $design:ident => $value:expr) => {
        match $any {
            DesignRef::Plane($design) => $value,
            DesignRef::Space($design) => $value,
        }
    };
}

impl<'a> From<&'a Design> for DesignRef<'a> {
    fn from(design: &'a Design) -> Self {
        Self::Plane(design)
    }
}

impl<'a> From<&'a SpaceDesign> for DesignRef<'a> {
    fn from(design: &'a SpaceDesign) -> Self {
        Self::Space(design)
    }
}

impl<'a> From<&'a AnyDesign> for DesignRef<'a> {
    fn from(design: &'a AnyDesign) -> Self {
        match design {
            AnyDesign::Plane(design) => Self::Plane(design),
            AnyDesign::Space(design) => Self::Space(design),
        }
    }
}

impl AnyDesign {
    /// Reads and checks a design file of either kind.
    ///
    /// # Errors
    /// The file cannot be read, or what is wrong with it, the first thing and the others.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, DesignError> {
        let path = path.as_ref();
        let text = document::text(path)?;
        if space::is_in_space(&text) {
            SpaceDesign::parse_in_space(path, &text).map(|design| Self::Space(Box::new(design)))
        } else {
            Design::parse(path, &text).map(|design| Self::Plane(Box::new(design)))
        }
    }

    /// The design of a sheet, if it is one.
    pub fn plane(&self) -> Option<&Design> {
        match self {
            Self::Plane(design) => Some(design),
            Self::Space(_) => None,
        }
    }

    /// With what Q refers to, where the design does not say it.
    pub fn compare_with(&mut self, material: Option<Material>) {
        match self {
            Self::Plane(design) => design.compared_with = material,
            Self::Space(design) => design.compared_with = material,
        }
    }
}

impl<'a> DesignRef<'a> {
    /// Name, fit for files and folders.
    pub fn name(self) -> &'a str {
        each!(self, design => &design.name)
    }

    /// The file, as it was named.
    pub fn path(self) -> &'a Path {
        each!(self, design => &design.path)
    }

    /// The file's text, as read.
    pub fn text(self) -> &'a str {
        each!(self, design => &design.text)
    }

    /// Sites that are simulated.
    pub fn sites(self) -> usize {
        match self {
            Self::Plane(design) => design.lattice.len(),
            Self::Space(design) => design.lattice.sites().len(),
        }
    }

    /// Of its spheres (m)
    pub fn diameter(self) -> f64 {
        each!(self, design => design.lattice.diameter())
    }

    /// Material of the crystal outside the lens.
    pub fn host(self) -> &'a Material {
        each!(self, design => &design.host)
    }

    /// Which lens is asked for.
    pub fn lens(self) -> Option<&'a LensRequest> {
        each!(self, design => design.lens.as_ref())
    }

    /// Contact law.
    pub fn law(self) -> LawKind {
        each!(self, design => design.law)
    }

    /// What strikes the crystal.
    pub fn impact(self) -> Strike {
        each!(self, design => design.impact)
    }

    /// How many focal regions there are.
    pub fn foci(self) -> usize {
        each!(self, design => design.target.foci.len())
    }

    /// Seed of the first random layout of each kind, and how many there are.
    pub fn seeds(self) -> [u64; 2] {
        each!(self, design => [design.first_seed, design.seeds])
    }

    /// Materials described in the file itself.
    pub fn own_materials(self) -> &'a [Material] {
        each!(self, design => &design.own_materials)
    }

    /// See [`Design::reference`].
    pub fn reference(self) -> Option<&'a Material> {
        each!(self, design => design.reference())
    }

    /// Prices of one sphere by the name of its material.
    pub fn prices(self) -> &'a BTreeMap<String, f64> {
        each!(self, design => &design.prices)
    }

    /// What the step is chosen for where it is not given.
    pub fn accuracy(self) -> Accuracy {
        each!(self, design => design.accuracy)
    }

    /// Set of fitted constants of the law.
    pub fn constants(self) -> Constants {
        each!(self, design => design.constants)
    }

    /// What `check --strict` asks of the scores.
    pub fn thresholds(self) -> &'a [Threshold] {
        each!(self, design => &design.thresholds)
    }

    /// See [`Design::material`].
    ///
    /// # Errors
    /// `UnknownMaterial`, with the nearest known name.
    pub fn material(self, name: &str) -> Result<Material, UnknownMaterial> {
        each!(self, design => design.material(name))
    }

    /// The layout of the design with these materials, one for each of its sites.
    pub fn layout(self, palette: Vec<Material>, materials: Vec<u8>) -> AnyLayout {
        match self {
            Self::Plane(design) => AnyLayout::Plane(Layout { lattice: design.lattice.clone(), palette, materials }),
            Self::Space(design) => AnyLayout::Space(Layout { lattice: design.lattice.clone(), palette, materials }),
        }
    }

    /// Reads a layout of the design, whose palette begins with `palette`.
    ///
    /// # Errors
    /// Every way in which the file can differ from the design.
    pub fn read_layout(self, path: &Path, palette: &[Material]) -> Result<AnyLayout, LayoutFileError> {
        match self {
            Self::Plane(design) => {
                layout::read(path, &design.lattice, palette, &design.own_materials).map(AnyLayout::Plane)
            }
            Self::Space(design) => {
                layout::read_in_space(path, &design.lattice, palette, &design.own_materials).map(AnyLayout::Space)
            }
        }
    }

    /// See [`Design::blame`].
    pub fn blame(self, key: &str, message: String, help: String) -> DesignError {
        each!(self, design => design.blame(key, message, help))
    }
}
