//! The rig file: what a lab builds, strikes and measures, from TOML to a rig that can be run.
//!
//! In: a file with `kind = "rig"`, or a lens design, whose proposed lens is then set up under its impact. Out: a [`Setup`], which
//! holds the rig with its step, window and what is recorded; or a [`DocumentError`] that names file, line, key, value, the rule
//! broken and the way out. Every key is described in `docs/simulate.md`.
//!
//! - `file`: as written; `read`: as checked, section by section with the others
//! - `crystal`: what stands where; `place`: spheres and directions as files write them
//! - `acts`: what holds and what strikes; `pulse`: quantities over time; `laws`: contact laws and friction
//! - `plan`: step and window; `record`: what is written and drawn
//! - `lens`: a lens design as a rig

mod acts;
mod crystal;
mod file;
mod laws;
mod lens;
mod place;
mod plan;
mod pulse;
mod read;
mod record;

use std::path::{Path, PathBuf};

pub use lens::SetupError;
pub use plan::RunPlan;
pub use record::{Picture, Quantity, RecordPlan};

use crate::dem::rig::Rig;
use crate::design::Design;
use crate::document::{self, DocumentError};

/// A rig in one, two or three dimensions.
#[derive(Clone, Debug)]
pub enum Setup {
    /// A chain.
    One(Bench<1>),
    /// A sheet.
    Two(Bench<2>),
    /// A crystal in space.
    Three(Bench<3>),
}

/// A rig, how it is run and what is recorded of it.
#[derive(Clone, Debug)]
pub struct Bench<const D: usize> {
    /// Name, fit for files and folders.
    pub name: String,
    /// The file, as it was named.
    pub path: PathBuf,
    /// The file's text, as read.
    pub text: String,
    /// What is simulated.
    pub rig: Rig<D>,
    /// Layer and column of each sphere.
    pub sites: Vec<SphereSite>,
    /// Number of layers.
    pub layers: u32,
    /// Distance of neighbouring sites (m).
    pub diameter: f64,
    /// Step and window.
    pub plan: RunPlan,
    /// What is written and drawn.
    pub record: RecordPlan,
}

/// Where in its crystal a sphere sits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SphereSite {
    /// From 1, struck first.
    pub layer: u32,
    /// Within the layer, from 1.
    pub column: u32,
}

impl Setup {
    /// Reads a rig file or a lens design.
    ///
    /// # Errors
    /// The first thing that is wrong with the file; a lens that cannot be solved.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, SetupError> {
        let path = path.as_ref();
        match Self::read_rig(path)? {
            Some(setup) => Ok(setup),
            None => lens::setup(&Design::read(path)?),
        }
    }

    /// Reads a rig file; none if the file is no rig file, but a lens design or nothing known.
    ///
    /// # Errors
    /// A file that cannot be read; the first thing that is wrong with a rig file.
    pub fn read_rig(path: impl AsRef<Path>) -> Result<Option<Self>, DocumentError> {
        let path = path.as_ref();
        let text = document::text(path)?;
        read::is_rig(path, &text).then(|| read::setup(path, &text)).transpose()
    }

    /// Checks the text of a rig file; `path` is named in messages, and tables are looked for beside it.
    ///
    /// # Errors
    /// The first thing that is wrong with it.
    pub fn parse(path: impl AsRef<Path>, text: &str) -> Result<Self, DocumentError> {
        read::setup(path.as_ref(), text)
    }
}
