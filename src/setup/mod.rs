//! The rig file: what a lab builds, strikes and measures, from TOML to a rig that can be run.
//!
//! In: a file with `kind = "rig"`, or a lens design, whose proposed lens is then set up under its impact. Out: a [`Setup`], which
//! holds the rig with its step, window and what is recorded; or a [`DocumentError`] that names file, line, key, value, the rule
//! broken and the way out. Every key is described in `docs/simulate.md`.
//!
//! - `file`: as written; `read`: as checked, section by section with the others
//! - `crystal`: what stands where; `place`: spheres and directions as files write them
//! - `listed`: layouts of lenses as patterns
//! - `acts`: what holds and what strikes; `intruder`: rigid bodies before the crystal; `pulse`: quantities over time; `laws`: contact laws and friction
//! - `preload`: what is squeezed to rest first
//! - `plan`: step and window, `step`: the step that a rig needs, `handed`: the force in its contacts; `record`: what is written and drawn
//! - `lens`: a lens design as a rig

mod acts;
mod crystal;
mod file;
mod handed;
mod intruder;
mod laws;
mod lens;
mod listed;
mod place;
mod plan;
mod preload;
mod pulse;
mod read;
mod record;
mod step;

use std::path::{Path, PathBuf};

pub(crate) use file::EXAMPLES;
pub use intruder::Intruder;
pub use lens::SetupError;
pub use place::spin_about_y;
pub use plan::RunPlan;
pub use preload::Preload;
pub use record::{Contacts, Event, Picture, Quantity, RecordPlan, Region, SPACE};
pub use step::dividing_step;

use crate::dem::rig::{Body, Law, LawBook, PairRule, Rig, RigError, Simulation};
use crate::dem::{MoveIn, Spheres};
use crate::design::Design;
use crate::document::{self, DocumentError};
use crate::layout::Layout;
use crate::outcome::{COMMIT, Method, VERSION};

/// A rig in one, two or three dimensions.
#[derive(Clone, Debug)]
pub enum Setup {
    /// A chain.
    One(PreparedRig<1>),
    /// A sheet.
    Two(PreparedRig<2>),
    /// A crystal in space.
    Three(PreparedRig<3>),
}

/// A rig, how it is run and what is recorded of it.
#[derive(Clone, Debug)]
pub struct PreparedRig<const D: usize> {
    /// Name, fit for files and folders.
    pub name: String,
    /// The file, as it was named.
    pub path: PathBuf,
    /// The file's text, as read.
    pub text: String,
    /// What is simulated.
    pub rig: Rig<D>,
    /// Rigid bodies that strike the crystal; their spheres are the last ones of the rig.
    pub intruders: Vec<Intruder>,
    /// Layer and column of each sphere of the crystal.
    pub sites: Vec<SphereSite>,
    /// Number of layers.
    pub layers: u32,
    /// Distance of neighbouring sites (m).
    pub diameter: f64,
    /// How the crystal was squeezed, if it was.
    pub preload: Option<Preload>,
    /// Seeds of what is drawn by chance, in the order of the file.
    pub seeds: Vec<u64>,
    /// Step and window.
    pub plan: RunPlan,
    /// What is written and drawn.
    pub record: RecordPlan,
}

/// What is said of a seed where there is no pattern by chance.
const NO_CHANCE: &str = "a seed is given, and nothing in this file is drawn by chance";

/// Where in its crystal a sphere sits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SphereSite {
    /// From 1, struck first.
    pub layer: u32,
    /// Within the layer, from 1.
    pub column: u32,
}

impl<const D: usize> PreparedRig<D> {
    /// A body as the file's author knows it: a sphere with its layer and column, a flat by its name.
    pub fn name_of(&self, body: Body) -> String {
        match body {
            Body::Sphere(i) => match self.sites.get(i) {
                Some(SphereSite { layer, column }) => format!("sphere {} (layer {layer}, column {column})", i + 1),
                None => match self.intruder_of(i) {
                    Some(intruder) => format!("intruder {}", intruder.name),
                    None => body.to_string(),
                },
            },
            Body::Flat(k) => match self.rig.flats.get(k) {
                Some(flat) => format!("flat {}", flat.name),
                None => body.to_string(),
            },
        }
    }
}

impl<const D: usize> PreparedRig<D> {
    /// The contact law by name, with friction where there is some; `several` where pairs have laws of their own.
    pub fn law_name(&self) -> String {
        let (name, friction) = match &self.rig.laws {
            LawBook::Materials { pairs, .. } if self.has_several_laws(pairs) => ("several".to_owned(), None),
            LawBook::Materials { law: Law::Named(law), friction, .. } => (law.to_string(), friction.as_ref()),
            LawBook::Materials { law: Law::Tabulated(_), friction, .. } => ("tabulated".to_owned(), friction.as_ref()),
            LawBook::Materials { friction, .. } => ("spring-dashpot".to_owned(), friction.as_ref()),
            LawBook::Dashpot { .. } => ("dashpot".to_owned(), None),
        };
        if friction.is_some() || self.rig.has_friction() { format!("{name}, with friction") } else { name }
    }

    fn has_several_laws(&self, pairs: &[PairRule]) -> bool {
        pairs.iter().any(|rule| rule.law.is_some()) || self.rig.flats.iter().any(|flat| flat.contact.law.is_some())
    }

    /// The set of fitted constants, where the law is one of those that have one.
    pub fn constants_name(&self) -> Option<String> {
        match &self.rig.laws {
            LawBook::Materials { law: Law::Named(_), constants, .. } => Some(constants.to_string()),
            _ => None,
        }
    }

    /// The rig at its start, to be run by the plan's scheme and step.
    ///
    /// # Errors
    /// See [`RigError`].
    pub fn simulation(&self) -> Result<Simulation<D>, RigError>
    where
        Spheres: MoveIn<D>,
    {
        Simulation::by(self.plan.integrator, self.rig.clone(), self.plan.step)
    }

    /// With what, and how, it is run.
    pub fn method(&self) -> Method {
        Method {
            version: VERSION.to_owned(),
            commit: COMMIT.to_owned(),
            law: self.law_name(),
            constants: self.constants_name(),
            integrator: self.plan.integrator.to_string(),
            step_s: self.plan.step,
            step_reason: self.plan.step_reason.clone(),
            window_s: self.plan.window,
            window_reason: self.plan.window_reason.clone(),
        }
    }

    /// The intruder to which a sphere belongs.
    pub fn intruder_of(&self, sphere: usize) -> Option<&Intruder> {
        self.intruders.iter().find(|intruder| intruder.members.contains(&sphere))
    }

    /// What tables call bodies.
    pub fn labels(&self) -> Labels {
        let sphere =
            |i: usize| self.intruder_of(i).map_or_else(|| (i + 1).to_string(), |intruder| intruder.name.clone());
        let spheres = self.rig.sample.spheres.len();
        let flats = self.rig.flats.iter().map(|flat| flat.name.clone());
        Labels { names: (0..spheres).map(sphere).chain(flats).collect(), spheres }
    }
}

/// What tables call bodies: the crystal's spheres by their number from 1, intruders and flats by their names.
#[derive(Clone, Debug)]
pub struct Labels {
    names: Vec<String>,
    spheres: usize,
}

impl Labels {
    /// All of them, first those of the spheres, then those of the flats.
    pub fn names(&self) -> &[String] {
        &self.names
    }

    /// Where a body stands among them.
    pub fn place(&self, body: Body) -> usize {
        match body {
            Body::Sphere(i) => i,
            Body::Flat(k) => self.spheres + k,
        }
    }

    /// The label of a body.
    pub fn of(&self, body: Body) -> &str {
        &self.names[self.place(body)]
    }
}

impl Setup {
    /// Reads a rig file or a lens design.
    ///
    /// # Errors
    /// The first thing that is wrong with the file; a lens that cannot be solved.
    pub fn read(path: impl AsRef<Path>) -> Result<Self, SetupError> {
        Self::read_seeded(path, None)
    }

    /// The same, with a first seed in place of the file's: its k-th pattern by chance then has the seed `first_seed` + k, from
    /// k = 0 on. Without one the file's seeds hold.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn read_seeded(path: impl AsRef<Path>, first_seed: Option<u64>) -> Result<Self, SetupError> {
        let path = path.as_ref();
        match Self::rig(path, first_seed)? {
            Some(setup) => Ok(setup),
            None => lens::setup(&Design::read(path)?, first_seed),
        }
    }

    /// A layout of a design under the design's impact.
    ///
    /// # Errors
    /// The step or window of the design cannot be.
    pub fn of_layout(design: &Design, layout: &Layout) -> Result<Self, SetupError> {
        lens::of_layout(design, layout, None)
    }

    /// Reads a rig file; none if the file is no rig file, but a lens design or nothing known.
    ///
    /// # Errors
    /// A file that cannot be read; the first thing that is wrong with a rig file.
    pub fn read_rig(path: impl AsRef<Path>) -> Result<Option<Self>, DocumentError> {
        Self::rig(path.as_ref(), None)
    }

    fn rig(path: &Path, first_seed: Option<u64>) -> Result<Option<Self>, DocumentError> {
        let text = document::text(path)?;
        read::is_rig(path, &text).then(|| read::setup(path, &text, first_seed)).transpose()
    }

    /// Checks the text of a rig file; `path` is named in messages, and tables are looked for beside it.
    ///
    /// # Errors
    /// The first thing that is wrong with it.
    pub fn parse(path: impl AsRef<Path>, text: &str) -> Result<Self, DocumentError> {
        read::setup(path.as_ref(), text, None)
    }
}
