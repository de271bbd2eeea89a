//! The study file: as written, then as checked.

use std::path::{Path, PathBuf};

use serde::Deserialize;

use super::{Goal, Objective, StudyError};
use crate::design::Design;
use crate::evaluate::Overrides;
use crate::layout::{self, Layout};
use crate::material::Material;
use crate::search::{Choice, Dice, Method, Space, level_set};
use crate::units::Dimension::Time;

/// More materials have more kinds of pairs than the evaluator's tables hold.
const MOST_MATERIALS: usize = 5;

/// More is taken for a slip: all evaluations are held in memory.
const MOST_EVALUATIONS: u64 = 10_000_000;

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
    rows: [u32; 2],
    objective: ObjectiveFile,
    budget: u64,
    #[serde(default = "one")]
    seed: u64,
    #[serde(default = "genetic_local")]
    method: String,
    #[serde(default = "lens")]
    start: String,
    step: Option<String>,
    window: Option<String>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct ObjectiveFile {
    maximise: Option<Goal>,
    minimise: Option<Goal>,
    min_contrast: Option<f64>,
    min_focal_gain: Option<f64>,
    max_protection: Option<f64>,
}

fn one() -> u64 {
    1
}

fn genetic_local() -> String {
    Method::GeneticLocal.name().to_owned()
}

fn lens() -> String {
    "lens".to_owned()
}

/// Where a search begins.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Start {
    /// The design's lens.
    Lens,
    /// A smooth random layout that follows from the seed.
    Random,
    /// A layout file.
    File(PathBuf),
}

/// A checked study.
#[derive(Clone, Debug)]
pub struct Study {
    /// The file.
    pub path: PathBuf,
    /// The design whose layouts are searched.
    pub design: Design,
    /// Host, the material of the crystal that Q refers to, and others that may be chosen.
    pub palette: Vec<Material>,
    /// Places in the palette of the materials that may be chosen: letter k of a choice is material `letters[k]`.
    pub letters: Vec<u8>,
    /// Indices of the sites that may change.
    pub free: Vec<usize>,
    /// Where the search begins.
    pub start: Start,
    /// Material of every site at the start, as places in the palette; sites that are not free keep it.
    pub base: Vec<u8>,
    /// What is wanted.
    pub objective: Objective,
    /// Evaluations of different layouts.
    pub budget: u64,
    /// Seed of everything random.
    pub seed: u64,
    /// How to search.
    pub method: Method,
    /// Step and window, where they differ from the design's.
    pub overrides: Overrides,
}

/// The text being checked.
struct Source<'a> {
    path: &'a Path,
    text: &'a str,
}

impl Source<'_> {
    /// A complaint about a key, which stands at the beginning of its line.
    fn fail(&self, key: &str, message: String) -> StudyError {
        let line = self.text.lines().position(|line| {
            line.trim_start().strip_prefix(key).is_some_and(|rest| rest.trim_start().starts_with('='))
        });
        StudyError::File { path: self.path.to_owned(), line: line.map(|line| line as u64 + 1), message }
    }

    fn toml(&self, error: &toml::de::Error) -> StudyError {
        let line =
            error.span().map(|span| self.text[..span.start.min(self.text.len())].matches('\n').count() as u64 + 1);
        // The reader names types as the program does; a user knows numbers, text and lists.
        let mut message = error.message().trim_end_matches('.').replace('\n', " ");
        for (type_name, words) in [
            ("u64", "a whole number from 0 up"),
            ("u32", "a whole number from 0 up"),
            ("f64", "a number"),
            ("a string", "text in quotes"),
            ("a sequence", "a list"),
            ("usize", "a whole number from 0 up"),
        ] {
            message = message.replace(&format!("expected {type_name}"), &format!("expected {words}"));
        }
        let key = error.span().and_then(|span| {
            let line = self.text.get(..span.start)?.rfind('\n').map_or(0, |end| end + 1);
            let (key, _) = self.text.get(line..)?.lines().next()?.split_once('=')?;
            Some(key.trim()).filter(|key| !message.contains(key)).map(|key| format!("{key}: "))
        });
        let message = format!("{}{message}.", key.unwrap_or_default());
        StudyError::File { path: self.path.to_owned(), line, message }
    }

    fn time(&self, key: &str, text: Option<&String>) -> Result<Option<f64>, StudyError> {
        let Some(text) = text else { return Ok(None) };
        match Time.parse(text) {
            Ok(time) if time > 0.0 => Ok(Some(time)),
            Ok(_) => Err(self.fail(key, format!("{key} = \"{text}\" must be positive."))),
            Err(error) => Err(self.fail(key, format!("{key}: {error}"))),
        }
    }
}

impl Study {
    /// Reads and checks a study file, the design it names, and the layout it starts from. `seed` takes the place of the file's.
    ///
    /// # Errors
    /// The first thing that is wrong with one of them.
    pub fn read(path: &Path, seed: Option<u64>) -> Result<Self, StudyError> {
        let text = std::fs::read_to_string(path).map_err(|error| {
            let message = match error.kind() {
                std::io::ErrorKind::NotFound => "no such file. Check the path; it is taken from here.".to_owned(),
                std::io::ErrorKind::InvalidData => "is not UTF-8 text. A study file is plain text.".to_owned(),
                _ => format!("cannot be read: {error}."),
            };
            StudyError::File { path: path.to_owned(), line: None, message }
        })?;
        let source = Source { path, text: &text };
        let FormatOnly { format } = toml::from_str(&text).map_err(|error| source.toml(&error))?;
        if format != 1 {
            return Err(
                source.fail("format", format!("format = {format} must be 1; a later format needs a later version."))
            );
        }
        let file: StudyFile = toml::from_str(&text).map_err(|error| source.toml(&error))?;
        let beside = |named: &Path| path.parent().unwrap_or(Path::new("")).join(named);
        let design = Design::read(beside(&file.design))?;

        let objective = read_objective(&source, &file.objective)?;
        let lattice = design.lattice;
        let [first, last] = file.rows;
        if first < 1 || first > last || last > lattice.rows() {
            let message = format!(
                "rows = [{first}, {last}] must be the first and the last of some of rows 1 to {}.",
                lattice.rows()
            );
            return Err(source.fail("rows", message));
        }
        if !(1..=MOST_EVALUATIONS).contains(&file.budget) {
            let message = format!("budget = {} must be 1 to {MOST_EVALUATIONS} evaluations.", file.budget);
            return Err(source.fail("budget", message));
        }
        let method = file.method.parse().map_err(|error: String| source.fail("method", format!("{error}.")))?;
        let seed = seed.unwrap_or(file.seed);

        let mut named = Vec::new();
        for name in &file.materials {
            let material =
                design.material(name).map_err(|error| source.fail("materials", format!("materials: {error}.")))?;
            if named.contains(&material) {
                return Err(source.fail("materials", format!("materials names {} twice.", material.name)));
            }
            named.push(material);
        }
        if named.is_empty() {
            return Err(source.fail("materials", "materials is empty; name at least one, better two.".to_owned()));
        }
        // Host first, then what Q refers to: the design's lens material or the first other one.
        let other = named.iter().find(|&material| *material != design.host).cloned();
        let reference = design.lens.as_ref().map(|lens| lens.material.clone()).or(other);
        let mut palette = vec![design.host.clone()];
        for material in reference.iter().chain(&named) {
            if !palette.contains(material) {
                palette.push(material.clone());
            }
        }
        let place = |material: &Material| palette.iter().position(|known| known == material).unwrap_or(0) as u8;
        let letters: Vec<u8> = named.iter().map(place).collect();
        let sites = lattice.sites();
        let free: Vec<usize> = (0..sites.len()).filter(|&i| (first..=last).contains(&sites[i].row)).collect();
        let (start, base) = read_start(&source, &file.start, &design, &mut palette, beside)?;
        if palette.len() > MOST_MATERIALS {
            let message = format!(
                "{} different materials take part, with host and start; at most {MOST_MATERIALS} can.",
                palette.len()
            );
            return Err(source.fail("materials", message));
        }
        let overrides = Overrides {
            step: source.time("step", file.step.as_ref())?,
            window: source.time("window", file.window.as_ref())?,
            ..Overrides::default()
        };
        let mut study = Self {
            path: path.to_owned(),
            design,
            palette,
            letters,
            free,
            start,
            base,
            objective,
            budget: file.budget,
            seed,
            method,
            overrides,
        };
        study.begin(&source)?;
        Ok(study)
    }

    /// Makes a random start, or finds out whether the given one can be.
    fn begin(&mut self, source: &Source<'_>) -> Result<(), StudyError> {
        if self.start == Start::Random {
            // The search itself begins with the same seed; the other bits keep the two apart.
            let choice = level_set(&self.space(), &mut Dice::new(!self.seed));
            self.base = self.layout(&choice).materials;
        }
        let wrong = self.free.iter().find(|&&i| !self.letters.contains(&self.base[i]));
        let Some(&wrong) = wrong else { return Ok(()) };
        let (site, material) = (&self.design.lattice.sites()[wrong], &self.palette[usize::from(self.base[wrong])]);
        let message = format!(
            "start: row {}, column {} holds {}, which is not among materials. Name it there, or choose another start.",
            site.row, site.column, material.name
        );
        Err(source.fail("start", message))
    }

    /// What is searched.
    pub fn space(&self) -> Space {
        let sites = self.design.lattice.sites();
        let sites = self.free.iter().map(|&i| [sites[i].row, sites[i].column]).collect();
        Space { sites, letters: self.letters.len() as u8 }
    }

    /// The letters of the free sites at the start.
    pub fn first(&self) -> Choice {
        let letter = |&i: &usize| self.letters.iter().position(|&place| place == self.base[i]).unwrap_or(0) as u8;
        self.free.iter().map(letter).collect()
    }

    /// The layout that a choice stands for.
    pub fn layout(&self, choice: &[u8]) -> Layout {
        let mut materials = self.base.clone();
        for (&i, &letter) in self.free.iter().zip(choice) {
            materials[i] = self.letters[usize::from(letter)];
        }
        Layout { lattice: self.design.lattice, palette: self.palette.clone(), materials }
    }
}

fn read_objective(source: &Source<'_>, file: &ObjectiveFile) -> Result<Objective, StudyError> {
    let goal = match (file.maximise, file.minimise) {
        (Some(goal @ (Goal::Contrast | Goal::FocalGain)), None) | (None, Some(goal @ Goal::Protection)) => goal,
        _ => {
            let message = "objective asks for one of maximise = \"contrast\", maximise = \"focal-gain\" and \
                           minimise = \"protection\"."
                .to_owned();
            return Err(source.fail("objective", message));
        }
    };
    let limits = [
        ("min_contrast", file.min_contrast),
        ("min_focal_gain", file.min_focal_gain),
        ("max_protection", file.max_protection),
    ];
    for (name, limit) in limits {
        if let Some(limit) = limit.filter(|limit| !(limit.is_normal() && *limit > 0.0)) {
            return Err(source.fail("objective", format!("objective: {name} = {limit} must be positive.")));
        }
    }
    let [min_contrast, min_focal_gain, max_protection] = limits.map(|(_, limit)| limit);
    Ok(Objective { goal, min_contrast, min_focal_gain, max_protection })
}

fn read_start(
    source: &Source<'_>,
    start: &str,
    design: &Design,
    palette: &mut Vec<Material>,
    beside: impl Fn(&Path) -> PathBuf,
) -> Result<(Start, Vec<u8>), StudyError> {
    match start {
        "random" => Ok((Start::Random, vec![0; design.lattice.len()])),
        "lens" => {
            let Some(request) = &design.lens else {
                let message = "start = \"lens\", but the design has no [lens]. Try start = \"random\".";
                return Err(source.fail("start", message.to_owned()));
            };
            let lens = crate::lens::propose(&design.lattice, &design.host, request, &design.target, design.constants)
                .map_err(|error| {
                source.fail("start", format!("start = \"lens\": {error} Try start = \"random\"."))
            })?;
            let laid = lens.layout();
            let place = |m: &u8| {
                let material = &laid.palette[usize::from(*m)];
                palette.iter().position(|known| known == material).unwrap_or(0) as u8
            };
            let base = laid.materials.iter().map(place).collect();
            Ok((Start::Lens, base))
        }
        name if name.ends_with(".csv") => {
            let path = beside(Path::new(name));
            let read = layout::read(&path, design.lattice, palette, &design.own_materials)?;
            *palette = read.palette;
            Ok((Start::File(path), read.materials))
        }
        _ => {
            let message = format!("start = \"{start}\" must be \"lens\", \"random\" or a layout file, NAME.csv.");
            Err(source.fail("start", message))
        }
    }
}
