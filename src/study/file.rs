//! The study file: as written, then as checked.

use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::aggregate::Aggregate;
use super::family::RayNotes;
use super::free;
use super::prices;
use super::set::{self, ImpactFile, Tolerance, ToleranceFile};
use super::source::Source;
use super::stage::{self, MOST_EVALUATIONS, Scoring, Stage, StageFile, Work};
use super::start::{self, Start};
use super::{Objective, StudyError};
use crate::design::{AnyDesign, Design, DesignRef};
use crate::document;
use crate::evaluate::{Detail, Forces, ImpactLoad, Overrides, Plan, PlanError, common_plan};
use crate::layout::{AnyLayout, Layout, LayoutCounter};
use crate::material::Material;
use crate::score::{Measure, Needs};
use crate::search::{Assignment, Method, MethodError, Rng, Space, level_set};
use crate::units::Dimension::{Fraction, Time};

/// More materials have more kinds of pairs than the evaluator's tables hold.
const MOST_MATERIALS: usize = 5;

#[derive(Deserialize)]
struct FormatOnly {
    format: u32,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct StudyFile {
    #[expect(dead_code, reason = "read by itself, before everything else")]
    format: u32,
    design: PathBuf,
    materials: Vec<String>,
    rows: Option<[u32; 2]>,
    layers: Option<[u32; 2]>,
    x: Option<[String; 2]>,
    r: Option<[String; 2]>,
    symmetry: Option<String>,
    #[serde(default, alias = "free_scored_layers")]
    free_scored_rows: bool,
    objective: toml::Table,
    budget: Option<u64>,
    #[serde(default = "one")]
    seed: u64,
    method: Option<String>,
    #[serde(default)]
    start: StartFile,
    step: Option<String>,
    window: Option<String>,
    time: Option<String>,
    forces: Option<usize>,
    band: Option<String>,
    #[serde(default)]
    over: Aggregate,
    #[serde(default)]
    impact: Vec<ImpactFile>,
    #[serde(default)]
    laws: Vec<String>,
    tolerance: Option<ToleranceFile>,
    prices: Option<toml::Table>,
    #[serde(default)]
    stage: Vec<StageFile>,
}

#[derive(Deserialize)]
#[serde(untagged, expecting = "start is text, or a list of texts")]
enum StartFile {
    One(String),
    Several(Vec<String>),
}

impl Default for StartFile {
    fn default() -> Self {
        Self::One("lens".to_owned())
    }
}

fn one() -> u64 {
    1
}

/// A checked study.
#[derive(Clone, Debug)]
pub struct Study {
    /// The file.
    pub path: PathBuf,
    /// The design whose layouts are searched, of a sheet or of a crystal in space.
    pub design: AnyDesign,
    /// Host, the material of the crystal that Q refers to, and others that may be chosen.
    pub palette: Vec<Material>,
    /// Places in the palette of the materials that may be chosen: letter k of an assignment is material `alphabet[k]`.
    pub alphabet: Vec<u8>,
    /// Indices of the sites that may change.
    pub free: Vec<usize>,
    /// The same, those that change together in a list: an assignment has a letter for each of these.
    pub groups: Vec<Vec<usize>>,
    /// Where the search begins: at the first of these; the others are known to it too.
    pub starts: Vec<Start>,
    /// Material of every site at each start, as places in the palette; sites that are not free keep that of the first.
    pub bases: Vec<Vec<u8>>,
    /// What strikes the crystal, one after the other; the design's own impact if the study names none.
    pub impacts: Vec<ImpactLoad>,
    /// How crystals that are built differ from the drawing, where that counts.
    pub tolerance: Option<Tolerance>,
    /// What is wanted.
    pub objective: Objective,
    /// What is done, one after the other.
    pub stages: Vec<Stage>,
    /// The different ways in which the stages score, which are called rungs.
    pub rungs: Vec<Scoring>,
    /// The window, where it differs from the design's.
    pub window: Option<f64>,
    /// How long one run may take (s).
    pub time: Option<f64>,
    /// Seed of everything random.
    pub seed: u64,
    /// The seed that the file says.
    pub file_seed: u64,
    /// The forces about that of each impact, over which a layout is judged.
    pub forces: Forces,
    /// Who touches whom in the lattice, and what weighs what.
    pub counter: LayoutCounter,
}

impl Study {
    /// Reads and checks a study file, the design it names, and the layout it starts from. `seed` takes the place of the file's.
    ///
    /// # Errors
    /// What is wrong with one of them, the first thing and, of the study file, the others.
    pub fn read(path: &Path, seed: Option<u64>) -> Result<Self, StudyError> {
        let text = document::text(path)?;
        let source = Source { path, text: &text }.document();
        document::expect(source, document::Kind::Study)?;
        Self::check(path, &text, seed).map_err(|error| match error {
            StudyError::File(first) if first.file == path => {
                let others = document::others(source, &first, &|text| match Self::check(path, text, seed) {
                    Err(StudyError::File(next)) if next.file == path => Some(*next),
                    // What is wrong with other files is no fault of this one.
                    _ => None,
                });
                first.with_others(others).into()
            }
            error => error,
        })
    }

    fn check(path: &Path, text: &str, seed: Option<u64>) -> Result<Self, StudyError> {
        let source = Source { path, text };
        let FormatOnly { format } = toml::from_str(text).map_err(|error| source.toml(&error))?;
        if format != 1 {
            return Err(
                source.fail("format", format!("format = {format} must be 1; a later format needs a later version."))
            );
        }
        let file: StudyFile = toml::from_str(text).map_err(|error| source.toml(&error))?;
        let beside = |named: &Path| path.parent().unwrap_or(Path::new("")).join(named);
        let mut design = AnyDesign::read(beside(&file.design))?;

        let objective = Objective::read(&source, &file.objective, file.over)?;
        let keys = free::Keys {
            rows: file.rows,
            layers: file.layers,
            x: file.x.as_ref(),
            r: file.r.as_ref(),
            symmetry: file.symmetry.as_deref(),
            free_scored: file.free_scored_rows,
        };
        let rows = free::rows(&source, &keys, (&design).into())?;
        let forces = read_forces(&source, &file)?;
        let (stages, rungs) = read_stages(&source, &file, forces)?;
        let impacts = set::read_impacts(&source, &file.impact, (&design).into())?;
        let impacts = set::under_laws(&source, &file.laws, impacts)?;
        let seed = seed.unwrap_or(file.seed);
        let tolerance = file.tolerance.as_ref().map(|file| Tolerance::read(&source, file, seed)).transpose()?;

        let mut named = Vec::new();
        for name in &file.materials {
            let material = DesignRef::from(&design)
                .material(name)
                .map_err(|error| source.fail("materials", format!("materials: {error}.")))?;
            if named.contains(&material) {
                return Err(source.fail("materials", format!("materials names {} twice.", material.name)));
            }
            named.push(material);
        }
        if named.is_empty() {
            return Err(source.fail("materials", "materials is empty; name at least one, better two.".to_owned()));
        }
        // Where the design does not say what Q refers to, it is the first of the study's materials that is not the host.
        if DesignRef::from(&design).reference().is_none() {
            let other = named.iter().find(|&material| material != DesignRef::from(&design).host()).cloned();
            design.compare_with(other);
        }
        let lent = DesignRef::from(&design);
        // Host first, then what Q refers to.
        let mut palette = vec![lent.host().clone()];
        for material in lent.reference().into_iter().chain(&named) {
            if !palette.contains(material) {
                palette.push(material.clone());
            }
        }
        let place = |material: &Material| palette.iter().position(|known| known == material).unwrap_or(0) as u8;
        let alphabet: Vec<u8> = named.iter().map(place).collect();
        let groups = free::groups(&source, &keys, lent, rows)?;
        let mut free = groups.concat();
        free.sort_unstable();
        let written = match &file.start {
            StartFile::One(start) => std::slice::from_ref(start),
            StartFile::Several(starts) => starts,
        };
        if written.is_empty() {
            return Err(source.fail("start", "start is an empty list; leave it out, or name one.".to_owned()));
        }
        let (mut starts, mut bases) = (Vec::new(), Vec::new());
        for written in written {
            let (start, base) = start::read(&source, written, lent, &mut palette, beside)?;
            starts.push(start);
            bases.push(base);
        }
        if palette.len() > MOST_MATERIALS {
            let message = format!(
                "{} different materials take part, with host and start; at most {MOST_MATERIALS} can.",
                palette.len()
            );
            return Err(source.fail("materials", message));
        }
        let time = |key: &str, text: &Option<String>| match text {
            Some(text) => source.quantity(Time, key, text, |message| source.fail(key, message)).map(Some),
            None => Ok(None),
        };
        let (window, time) = (time("window", &file.window)?, time("time", &file.time)?);
        let prices = prices::read(&source, file.prices.as_ref(), lent, &palette, &objective)?;
        let price = |material: &Material| prices.get(&material.name).copied();
        let counter = match lent {
            DesignRef::Plane(design) => LayoutCounter::new(&design.lattice, Some(&free), &palette, price),
            DesignRef::Space(design) => LayoutCounter::in_space(&design.lattice, Some(&free), &palette, price),
        };
        let mut study = Self {
            path: path.to_owned(),
            design,
            palette,
            alphabet,
            free,
            groups,
            starts,
            bases,
            impacts,
            tolerance,
            objective,
            stages,
            rungs,
            window,
            time,
            seed,
            file_seed: file.seed,
            forces,
            counter,
        };
        study.begin(&source)?;
        Ok(study)
    }

    /// Makes random starts, and finds out whether the given ones can be.
    fn begin(&mut self, source: &Source<'_>) -> Result<(), StudyError> {
        // The search itself begins with the same seed; the other bits keep the two apart.
        let mut rng = Rng::new(!self.seed);
        for k in 0..self.starts.len() {
            if self.starts[k] == Start::Random {
                let assignment = level_set(&self.space(), &mut rng);
                self.bases[k] = self.materials(&assignment);
            }
            let base = &self.bases[k];
            let site = |index: usize| free::named(self.design(), index);
            if let Some(&wrong) = self.free.iter().find(|&&i| !self.alphabet.contains(&base[i])) {
                let material = &self.palette[usize::from(base[wrong])];
                let message = format!(
                    "start: {} holds {}, which is not among materials. Name it there, or choose another start.",
                    site(wrong),
                    material.name
                );
                return Err(source.fail("start", message));
            }
            let mixed = self
                .groups
                .iter()
                .find_map(|group| Some([group[0], *group.iter().find(|&&i| base[i] != base[group[0]])?]));
            if let Some([a, b]) = mixed {
                let message = format!(
                    "start: {} and {} hold different materials, and with this symmetry they change together. Leave symmetry out, or choose another start.",
                    site(a),
                    site(b)
                );
                return Err(source.fail("start", message));
            }
        }
        if let Some(k) = (1..self.bases.len()).find(|&k| !self.differs_within_rows(k)) {
            let message =
                format!("start: number {} differs from the first outside of rows, which do not change.", k + 1);
            return Err(source.fail("start", message));
        }
        let asks = |stage: &Stage| matches!(stage.work, Work::Search(method) if method.takes_parametrisation());
        if let Some(k) = self.stages.iter().position(asks)
            && self.parametrisation(&RayNotes::default()).is_none()
        {
            let message = "methods of the lens-family need a design with a [lens] and a single focus, and its material and the host among materials.";
            return Err(source.fail_in("stage", k, "method", message.to_owned()));
        }
        if self.design().foci() < 2
            && let Some(term) = self.objective.terms.iter().find(|term| term.measure == Measure::Balance)
        {
            let name = term.measure.name();
            let message = format!(
                "objective.{name}: the design has one focus; balance compares several, each below [[target.focus]]."
            );
            return Err(source.fail(name, message));
        }
        Ok(())
    }

    /// Whether a start is like the first wherever layouts do not change.
    fn differs_within_rows(&self, k: usize) -> bool {
        let differing = (0..self.bases[k].len()).filter(|&i| self.bases[k][i] != self.bases[0][i]);
        self.starts[k] == Start::Random || differing.into_iter().all(|i| self.free.binary_search(&i).is_ok())
    }

    /// Evaluations of all stages together.
    pub fn budget(&self) -> u64 {
        self.stages.iter().map(Stage::most_evaluations).sum()
    }

    /// The study with one of its rungs' forces in place of its own.
    #[must_use]
    pub fn at(&self, rung: usize) -> Self {
        let forces = self.rungs.get(rung).and_then(|scoring| scoring.forces).unwrap_or(self.forces);
        Self { forces, ..self.clone() }
    }

    /// Integrator, step and window of one of the rungs.
    pub fn overrides(&self, rung: usize) -> Overrides {
        let Scoring { step, window, .. } = self.rungs.get(rung).copied().unwrap_or_default();
        Overrides { step, window: window.or(self.window), ..Overrides::default() }
    }

    /// Step and window of one of the rungs.
    ///
    /// # Errors
    /// A step or window with which an impact cannot be simulated.
    pub fn plan(&self, rung: usize) -> Result<Plan, PlanError> {
        let loads: Vec<ImpactLoad> = self.at(rung).cases().into_iter().map(|case| case.load).collect();
        common_plan(self.design(), &loads, self.overrides(rung), &self.palette)
    }

    /// How much has to be recorded for what is wanted.
    pub fn detail(&self) -> Detail {
        let felt = self.objective.terms.iter().any(|term| term.measure.needs() == Needs::Records);
        if felt { Detail::Everything } else { Detail::Energies }
    }

    /// Whether a measure compares layouts with the baselines, which then have to be simulated first.
    pub fn has_rivals(&self) -> bool {
        self.objective.terms.iter().any(|term| term.measure == Measure::ProtectionBest)
    }

    /// What is searched.
    pub fn space(&self) -> Space {
        free::space(self.design(), &self.groups, self.alphabet.len() as u8)
    }

    /// The design, of whichever kind.
    pub fn design(&self) -> DesignRef<'_> {
        (&self.design).into()
    }

    /// Whether some sites change together.
    pub fn is_tied(&self) -> bool {
        self.groups.len() < self.free.len()
    }

    /// How many letters an assignment has.
    pub fn variables(&self) -> usize {
        self.groups.len()
    }

    /// The letters at each start.
    pub fn first(&self) -> Vec<Assignment> {
        let place = |base: &[u8], i: usize| self.alphabet.iter().position(|&place| place == base[i]).unwrap_or(0) as u8;
        self.bases.iter().map(|base| self.groups.iter().map(|group| place(base, group[0])).collect()).collect()
    }

    /// For every site the material that an assignment stands for, a place in the palette.
    pub fn materials(&self, assignment: &[u8]) -> Vec<u8> {
        let mut materials = self.bases[0].clone();
        for (group, &letter) in self.groups.iter().zip(assignment) {
            group.iter().for_each(|&site| materials[site] = self.alphabet[usize::from(letter)]);
        }
        materials
    }

    /// The same on the sheet of a design, which is the study's own.
    pub(super) fn sheet(&self, design: &Design, assignment: &[u8]) -> Layout {
        Layout { lattice: design.lattice.clone(), palette: self.palette.clone(), materials: self.materials(assignment) }
    }

    /// The layout that an assignment stands for.
    pub fn layout(&self, assignment: &[u8]) -> AnyLayout {
        self.design().layout(self.palette.clone(), self.materials(assignment))
    }
}

/// How far forces lie from an impact's own, as a part of it.
fn read_band(source: &Source<'_>, file: &StudyFile) -> Result<f64, StudyError> {
    match &file.band {
        Some(text) => source.quantity(Fraction, "band", text, |message| source.fail("band", message)),
        None => Ok(Forces::USUAL.band()),
    }
}

/// The forces about each impact's own.
fn read_forces(source: &Source<'_>, file: &StudyFile) -> Result<Forces, StudyError> {
    let band = read_band(source, file)?;
    let Some(count) = file.forces else {
        let alone = file.band.is_some() && file.stage.iter().all(|stage| stage.forces().is_none());
        let message = "band has no use without forces, such as forces = 8.";
        return if alone { Err(source.fail("band", message.to_owned())) } else { Ok(Forces::ONE) };
    };
    Forces::new(count, band).map_err(|error| source.fail("forces", format!("forces: {error}.")))
}

/// The stages, or the one that method, budget and step at the top stand for.
fn read_stages(
    source: &Source<'_>,
    file: &StudyFile,
    forces: Forces,
) -> Result<(Vec<Stage>, Vec<Scoring>), StudyError> {
    let step = match &file.step {
        Some(text) => Some(source.quantity(Time, "step", text, |message| source.fail("step", message))?),
        None => None,
    };
    if file.stage.is_empty() {
        let name = file.method.as_deref().unwrap_or(Method::USUAL.name());
        let method = name.parse().map_err(|error: MethodError| source.fail("method", format!("{error}.")))?;
        let Some(budget) = file.budget else {
            let message = "budget is missing: how many evaluations the study may do.".to_owned();
            return Err(source.missing("budget", message));
        };
        if !(1..=MOST_EVALUATIONS).contains(&budget) {
            let message = format!("budget = {budget} must be 1 to {MOST_EVALUATIONS} evaluations.");
            return Err(source.fail("budget", message));
        }
        return Ok((vec![stage::single(method, budget)], vec![Scoring { step, ..Scoring::default() }]));
    }
    let above = [("method", file.method.is_some()), ("budget", file.budget.is_some()), ("step", step.is_some())];
    if let Some((key, _)) = above.into_iter().find(|(_, given)| *given) {
        let message =
            format!("{key} stands above [[stage]]; give it in each stage (budget as evaluations), or no stages.");
        return Err(source.fail(key, message));
    }
    stage::read(source, &file.stage, read_band(source, file)?, forces)
}
