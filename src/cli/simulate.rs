//! `granulens simulate`: one rig or lens, run to records and pictures.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::time::Duration;

use granulens::Progress;
use granulens::dem::{MoveIn, Spheres};
use granulens::design::Design;
use granulens::output;
use granulens::report;
use granulens::run::{self, Ending, Keeping, RunError, Summary};
use granulens::setup::{PreparedRig, SPACE, Setup};
use granulens::units::Dimension::{Force, Time};
use indicatif::{ProgressBar, ProgressStyle};

use super::compare::read_layout;
use super::console::{context, emit, emit_json, note};
use super::failure::Failure;
use super::{Common, cost};

/// Simulate a rig file or the lens of a design, with records, checkpoints and pictures
///
/// The folder, simulations/NAME unless --out names another, fills as the run goes: samples over time as CSV, a checkpoint now and
/// then, tables and pictures at the end. A run that was killed or interrupted goes on with --resume to the same bytes.
#[derive(clap::Args)]
pub struct Simulate {
    /// Rig file or design file, such as designs/drop-tower-hcp.toml, or a layout (then with --design)
    file: PathBuf,
    /// Design file of a layout: everything but the materials
    #[arg(long, value_name = "FILE")]
    design: Option<PathBuf>,
    /// Go on with the run in the folder, where it was left
    #[arg(long)]
    resume: bool,
    /// Time between checkpoints, such as "5 s"; zero keeps one at every sample
    #[arg(long, value_name = "TIME", default_value = "60 s", value_parser = interval)]
    checkpoint_every: f64,
    /// Keep every body and contact at every sample, in FOLDER/frames, for network, motion and export; as record.frames = true
    #[arg(long)]
    frames: bool,
}

fn interval(text: &str) -> Result<f64, String> {
    let time = Time.parse(text).map_err(|error| error.to_string())?;
    if (0.0..1e9).contains(&time) { Ok(time) } else { Err("must not be negative".to_owned()) }
}

impl Simulate {
    pub fn run(self, common: &Common) -> Result<(), Failure> {
        let setup = match &self.design {
            None => Setup::read_seeded(&self.file, common.seed)?,
            Some(design) => {
                let design = Design::read(design)?;
                let layout = read_layout(common, &design, &self.file)?;
                let mut setup = Setup::of_layout(&design, &layout)?;
                if let Setup::Two(prepared) = &mut setup {
                    // The text is what a run is known by: another layout is another run.
                    let materials = crc32fast::hash(&layout.materials);
                    prepared.text += &format!("\n# of the layout {}, crc {materials:08x}\n", self.file.display());
                    if let Some(stem) = self.file.file_stem() {
                        prepared.name = stem.to_string_lossy().into_owned();
                    }
                }
                setup
            }
        };
        match setup {
            Setup::One(prepared) => self.prepared(&prepared, common),
            Setup::Two(prepared) => self.prepared(&prepared, common),
            Setup::Three(prepared) => self.prepared(&prepared, common),
        }
    }

    /// Whether a folder holds the run of this very file.
    fn is_of<const D: usize>(&self, prepared: &PreparedRig<D>, folder: &Path) -> bool {
        let text = std::fs::read_to_string(folder.join(run::RIG));
        text.is_ok_and(|text| text == prepared.text)
            && Summary::read(folder).is_ok_and(|kept| kept.seeds == prepared.seeds)
    }

    fn prepared<const D: usize>(&self, prepared: &PreparedRig<D>, common: &Common) -> Result<(), Failure>
    where
        Spheres: MoveIn<D>,
    {
        if self.frames && D == 3 {
            let message = "--frames: frames are kept of chains and sheets, and this crystal is in space";
            return Err(Failure::input_with_help(message, SPACE));
        }
        let mut prepared = prepared.clone();
        prepared.record.frames |= self.frames;
        let prepared = &prepared;
        let folder = common.out.clone().unwrap_or_else(|| Path::new("simulations").join(&prepared.name));
        let keeping = Keeping { resume: self.resume, every: Duration::from_secs_f64(self.checkpoint_every) };
        note(common, &format!("{} spheres; {}", prepared.sites.len(), prepared.method().words()));
        if run::is_large(prepared) {
            let threads = rayon::current_num_threads();
            note(common, &format!("a large crystal, followed by its rows on {threads} threads; no tables of contacts"));
        }
        if let Some(preload) = &prepared.preload {
            note(common, &preload.to_string());
        }
        prepared.plan.warnings.iter().for_each(|warning| note(common, &format!("warning: {warning}")));
        if common.dry_run {
            let mut simulation = prepared.simulation().map_err(|error| failure(prepared, &RunError::Rig(error)))?;
            let seconds = cost::rig(&mut simulation, prepared.plan.steps());
            let what = format!("{} steps of {} spheres, without records", prepared.plan.steps(), prepared.sites.len());
            return cost::tell(common, &[cost::Part::new(what, 1, Some(seconds))]);
        }
        if !self.resume {
            output::check_folder(&folder, common.force)?;
        }
        let bar = if common.quiet { ProgressBar::hidden() } else { ProgressBar::new(prepared.plan.steps()) };
        if let Ok(style) = ProgressStyle::with_template("{bar:30} {pos}/{len} steps, {elapsed} ({eta} left)") {
            bar.set_style(style);
        }
        let shown = bar.clone();
        let context = context().telling(move |progress| {
            if let Progress::Steps { done, of } = *progress {
                shown.set_length(of);
                shown.set_position(done);
            }
        });
        let result = run::run(prepared, &folder, keeping, &context);
        bar.finish_and_clear();
        let is_known = matches!(result, Err(RunError::Finished(_)));
        let (summary, ending) = match result {
            // What is finished is told again, and ends as it did.
            Err(RunError::Finished(_)) if self.is_of(prepared, &folder) => {
                note(common, &format!("nothing was to be done: the run in {} is finished", folder.display()));
                (Summary::read(&folder).map_err(|error| failure(prepared, &error))?, Ending::Complete)
            }
            result => result.map_err(|error| failure(prepared, &error))?,
        };
        if let Ending::Interrupted { time } = ending {
            return Err(Failure::Interrupted(format!(
                "at {}; go on with granulens simulate {}{} --resume{}{}",
                Time.show(time),
                self.file.display(),
                self.design.as_ref().map_or(String::new(), |design| format!(" --design {}", design.display())),
                common.seed.map_or(String::new(), |seed| format!(" --seed {seed}")),
                common.out.as_ref().map_or(String::new(), |out| format!(" --out {}", out.display()))
            )));
        }
        if summary.method.step_s != prepared.plan.step {
            note(common, &format!("step {}: {}", Time.show(summary.method.step_s), summary.method.step_reason));
        }
        let foreseen = &prepared.plan.warnings;
        for warning in summary.warnings.iter().filter(|warning| !foreseen.contains(warning)) {
            note(common, &format!("warning: {warning}"));
        }
        let pictures = if is_known { Vec::new() } else { report::draw_run(&folder)? };
        if !is_known {
            output::seal_folder(&folder)?;
        }
        if common.json {
            emit_json(&summary);
        } else {
            emit(&table(&summary));
        }
        note(common, &format!("records: {}", folder.display()));
        if !pictures.is_empty() {
            note(common, &format!("pictures: {}", folder.join("report.html").display()));
        }
        match summary.stop {
            Some(stop) => Err(Failure::Guard(vec![stop])),
            None => Ok(()),
        }
    }
}

/// A rig that cannot be is blamed on its file; the rest on the folder.
fn failure<const D: usize>(prepared: &PreparedRig<D>, error: &RunError) -> Failure {
    match error {
        RunError::Rig(rig) => {
            let message = format!("{}: {}", prepared.path.display(), rig.words(&|body| prepared.name_of(body)));
            Failure::input_with_help(message, error.help())
        }
        _ => Failure::input_with_help(error.to_string(), error.help()),
    }
}

/// The run in words and numbers.
fn table(summary: &Summary) -> String {
    let mut text = format!(
        "{}: {} spheres in {} layers, {} in {} steps of {}\n\n",
        summary.name,
        summary.spheres,
        summary.layers,
        Time.show(summary.time_s),
        summary.steps,
        Time.show(summary.method.step_s)
    );
    text += "| energy | J |\n|---|---|\n";
    for (name, value) in summary.energy_rows() {
        let _ = writeln!(text, "| {name} | {value:.4e} |");
    }
    if let Some(residual) = summary.residual {
        let _ =
            writeln!(text, "\nThe ledger closes to {residual:.1e}. Greatest speed {:.4} m/s.", summary.max_speed_m_s);
    }
    let pressed = summary.flats.iter().chain(&summary.intruders);
    let felt: Vec<_> = pressed.filter(|body| body.peak_force_n > 0.0).collect();
    if !felt.is_empty() {
        text += "\n| body | greatest force | at | velocity at the end (m/s) |\n|---|---|---|---|\n";
        for body in felt {
            let _ = writeln!(
                text,
                "| {} | {} | {} | {:.4} |",
                body.name,
                Force.show(body.peak_force_n),
                Time.show(body.peak_time_s),
                body.velocity_m_s
            );
        }
    }
    text
}
