//! `granulens report`: pages of layouts, and of results that are there already.

use std::path::{Path, PathBuf};

use granulens::design::Design;
use granulens::evaluate::{Comparison, Forces};
use granulens::input;
use granulens::outcome::Outcome;
use granulens::report;

use super::compare::read_piece;
use super::console::note;
use super::failure::Failure;
use super::folder::begin;
use super::run::{Delivery, deliver};
use super::{Band, Common, Motion, propose};

/// Draw a report: of a layout under a design's impact, or of results that are there
///
/// DESIGN LAYOUT simulates a layout, edited or optimised, beside all baselines, and draws what granulens run draws of a lens: maps,
/// profiles, tables, on one page. A folder of granulens run, simulate or study, or an outcome.json, is drawn anew from its numbers alone:
/// that of a rig or study where it stands, that of a run in a new folder. The folder is reports/DESIGN-LAYOUT unless --out names another.
#[derive(clap::Args)]
pub struct Report {
    /// Design file, or results: a folder or an outcome.json
    source: PathBuf,
    /// Layout, CSV with the header row,column,x,z,diameter,material; left out: the design's lens
    layout: Option<PathBuf>,
    /// Draw what exchanging each sphere does to C too; simulates every sphere for each other material, some seconds to minutes
    #[arg(long)]
    swaps: bool,
    /// Draw how F and P change with every sphere too, as granulens sensitivity tells; some ten runs and one for each sphere
    #[arg(long)]
    sensitivity: bool,
    /// Write every figure as PDF too, for a paper
    #[arg(long)]
    pdf: bool,
    /// Write every figure as PNG too, for slides
    #[arg(long)]
    png: bool,
    #[command(flatten)]
    motion: Motion,
    #[command(flatten)]
    forces: Band,
}

impl Report {
    /// Whether it can take long.
    pub fn simulates(&self) -> bool {
        self.of_results().is_none()
    }

    /// What of a folder or file of results is drawn anew.
    fn of_results(&self) -> Option<Results> {
        let holds = |name: &str| self.source.join(name).is_file();
        if self.source.is_dir() {
            return Some(match () {
                () if holds("outcome.json") => Results::Run(self.source.join("outcome.json")),
                () if holds("trial.json") => Results::Rig,
                () if holds("study.json") => Results::Study,
                () => Results::Unknown,
            });
        }
        let is_json = self.source.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("json"));
        is_json.then(|| Results::Run(self.source.clone()))
    }

    pub fn run(self, common: &Common) -> Result<(), Failure> {
        let stem = |path: &Path| path.file_stem().map(|stem| stem.to_string_lossy().into_owned()).unwrap_or_default();
        if let Some(results) = self.of_results() {
            if let Some(layout) = &self.layout {
                return Err(Failure::input_with_help(
                    format!("{}: results are drawn as they are, without {}", self.source.display(), layout.display()),
                    "Name a design file to draw a layout under its impact.",
                ));
            }
            return self.redraw(common, &results);
        }
        let design = Design::read(&self.source)?;
        let overrides = self.motion.overrides(common);
        let (comparison, name) = match &self.layout {
            None => (Comparison::of_lens(&design, &propose(&design)?, overrides), design.name.clone()),
            Some(path) => {
                let read = read_piece(common, &design, path)?;
                let name = format!("{}-{}", design.name, stem(path));
                (Comparison::of_layout(&design, stem(path), &read, overrides), name)
            }
        };
        let comparison = comparison
            .map_err(|error| Failure::of_plan(&design, &overrides, &error))?
            .over(self.forces.or(Forces::USUAL)?);
        if common.dry_run {
            return super::compare::cost(common, &design, &comparison, (true, self.sensitivity));
        }
        let place = common.out.clone().unwrap_or_else(|| Path::new("reports").join(name));
        deliver(
            common,
            &comparison,
            &place,
            Delivery { words: None, kinds: &self.kinds(), sensitivity: self.sensitivity, swaps: self.swaps },
        )
    }

    /// As what figures are written beside SVG.
    fn kinds(&self) -> Vec<&'static str> {
        [(self.pdf, "pdf"), (self.png, "png")].into_iter().filter_map(|(wanted, kind)| wanted.then_some(kind)).collect()
    }

    /// Draws results anew; nothing is simulated.
    fn redraw(&self, common: &Common, results: &Results) -> Result<(), Failure> {
        let given = self.forces.forces.is_some() || self.motion.step.is_some() || self.motion.window.is_some();
        let simulates = self.swaps || self.sensitivity;
        if given || simulates || self.motion.integrator.is_some() || common.seed.is_some() {
            return Err(Failure::input_with_help(
                "results are drawn as they are: nothing is simulated",
                "Leave out --step, --window, --integrator, --forces, --seed, --swaps and --sensitivity, or name a design file.",
            ));
        }
        match results {
            Results::Run(path) => {
                let text = input::text(path).map_err(|error| Failure::of_file(path, None, &error.to_string()))?;
                let outcome: Outcome = serde_json::from_str(&text).map_err(|error| {
                    Failure::input_with_help(
                        format!("{}: is no outcome of a run or comparison: {error}", path.display()),
                        "granulens run writes outcome.json, and granulens compare --out FILE.json.",
                    )
                })?;
                let beside = |folder: &Path| PathBuf::from(format!("{}-drawn", folder.display()));
                let folder = if self.source.is_dir() { self.source.clone() } else { path.with_extension("") };
                let place = common.out.clone().unwrap_or_else(|| beside(&folder));
                let folder = begin(common, &place)?;
                report::write(&outcome, folder.path())?;
                super::run::figures(&outcome, &folder, &self.kinds())?;
                folder.finish()?;
                super::run::tell(common, &outcome, &place);
            }
            Results::Rig | Results::Study if common.out.is_some() => {
                return Err(Failure::input_with_help(
                    format!("{}: is drawn where its records stand", self.source.display()),
                    "Leave out --out, or copy the folder first.",
                ));
            }
            Results::Rig => {
                granulens::output::check_folder(&self.source, common.force)?;
                let pictures = report::draw_run(&self.source)?;
                granulens::output::seal_folder(&self.source)?;
                note(common, &format!("{} pictures: {}", pictures.len(), self.source.join("report.html").display()));
            }
            Results::Study => super::study::draw(common, &self.source)?,
            Results::Unknown => {
                return Err(Failure::input_with_help(
                    format!(
                        "{}: holds no results: neither outcome.json nor trial.json nor study.json",
                        self.source.display()
                    ),
                    "Name a folder of granulens run, simulate or study, or a design file.",
                ));
            }
        }
        Ok(())
    }
}

/// Results that can be drawn anew.
enum Results {
    /// An outcome, by its file.
    Run(PathBuf),
    /// Records of a rig.
    Rig,
    /// A study.
    Study,
    /// A folder of something else.
    Unknown,
}
