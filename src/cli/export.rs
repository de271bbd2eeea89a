//! `granulens export`: a crystal and its motion as files for LAMMPS, OVITO and ParaView; frames that were kept also for pandas.

mod parquet;

use std::path::PathBuf;

use granulens::bed::read_frame;
use granulens::contact::LawKind;
use granulens::dem::rig::{Rig, RigError, RigStop, Simulation};
use granulens::dem::{Integrator, MoveIn, Spheres, steps_in};
use granulens::design::Design;
use granulens::evaluate::{Overrides, Plan, method};
use granulens::export;
use granulens::outcome::{COMMIT, FORMAT, Method, VERSION};
use granulens::output::Folder;
use granulens::setup::{PreparedRig, Setup, dividing_step};
use granulens::units::Dimension::Time;
use serde_json::json;

use super::compare::read_layout;
use super::console::{Count, context, emit_json, note, pretty};
use super::failure::Failure;
use super::folder::{self, probe_all, write_file, write_json};
use super::{Common, Motion, cost, propose, time};

const VERLET_ALONE: &str = "what is exported moves by Verlet";

/// Write a crystal and its motion for LAMMPS, OVITO, ParaView or pandas
///
/// Of a lens the whole crystal is written, both halves, repeating itself across the wave. For LAMMPS it has Hertz contacts, whatever
/// the design says: an input deck, and the same run by this program to compare with. The other two show a run under the design's
/// law. A rig file is written as it is; LAMMPS takes those of spheres with Hertz contacts under square pulses.
#[derive(clap::Args)]
#[command(group = clap::ArgGroup::new("what").required(true).multiple(true).args(["lammps", "xyz", "vtp", "parquet"]))]
pub struct Export {
    /// Design file, whose lens is proposed, a rig file, a layout (then with --design), or a folder of frames that impact kept
    source: PathBuf,
    /// Design file of a layout: everything but the materials
    #[arg(long, value_name = "FILE")]
    design: Option<PathBuf>,
    /// New folder for crystal.data, in.crystal and granulens.dump
    #[arg(long, value_name = "DIR")]
    lammps: Option<PathBuf>,
    /// File for frames in extended XYZ (OVITO)
    #[arg(long, value_name = "FILE")]
    xyz: Option<PathBuf>,
    /// New folder for spheres and contacts as VTP, with spheres.pvd and contacts.pvd (ParaView)
    #[arg(long, value_name = "DIR")]
    vtp: Option<PathBuf>,
    /// New folder for grains.parquet and contacts.parquet, with all moments of frames that were kept (pandas); where granulens is
    /// built with the feature parquet
    #[arg(long, value_name = "DIR")]
    parquet: Option<PathBuf>,
    /// Time between frames, such as "5 us"; without, fifty frames
    #[arg(long, value_name = "TIME", allow_hyphen_values = true, value_parser = time)]
    every: Option<f64>,
    #[command(flatten)]
    motion: Motion,
}

impl Export {
    pub fn run(self, common: &Common) -> Result<(), Failure> {
        if self.source.is_dir() {
            return self.bed(common);
        }
        if self.parquet.is_some() {
            return Err(Failure::input_with_help(
                format!("--parquet is for frames that were kept, and {} is none", self.source.display()),
                "Keep them with impact (record.every in the bed file) or simulate --frames, and name their folder.",
            ));
        }
        let is_file = self.source.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("toml"));
        let (design, layout) = match (&self.design, is_file) {
            (None, true) => {
                if let Some(setup) = Setup::read_rig(&self.source)? {
                    return match setup {
                        Setup::One(prepared) => self.rig(common, &prepared),
                        Setup::Two(prepared) => self.rig(common, &prepared),
                        Setup::Three(prepared) => self.rig(common, &prepared),
                    };
                }
                let design = Design::read(&self.source)?;
                let layout = propose(&design)?.layout();
                (design, layout)
            }
            (Some(design), false) => {
                let design = Design::read(design)?;
                let layout = read_layout(common, &design, &self.source)?;
                (design, layout)
            }
            (None, false) => {
                return Err(Failure::input_with_help(
                    format!("{} is taken for a layout, and a layout needs its design", self.source.display()),
                    "Add --design DESIGN.toml, or export a design or rig file (NAME.toml).",
                ));
            }
            (Some(_), true) => {
                return Err(Failure::input_with_help(
                    "two design files are given",
                    "Give a layout and --design, or a design alone.",
                ));
            }
        };
        if self.lammps.is_some() && design.law != LawKind::Hertz {
            note(common, &format!("LAMMPS has no law \"{}\": its deck has Hertz contacts", design.law));
        }
        if self.motion.integrator.is_some_and(|integrator| integrator != Integrator::Verlet) {
            return Err(Failure::input_with_help(VERLET_ALONE, "Leave it out."));
        }
        // What is exported moves as in the codes it is for.
        let overrides = Overrides { integrator: Some(Integrator::Verlet), ..self.motion.overrides(common) };
        self.write(common, |law| {
            let design = Design { law: law.unwrap_or(design.law), ..design.clone() };
            let plan = Plan::new(&design, overrides, &layout.palette)
                .map_err(|error| Failure::of_plan(&design, &overrides, &error))?;
            let rig = export::whole_crystal(&layout, design.impact, design.law, design.constants);
            Ok(Run { rig, steps: steps_in(plan.window, plan.step), method: method(&design, &plan) })
        })
    }

    /// Frames of an impact on a bed, as they were kept: nothing runs.
    fn bed(&self, common: &Common) -> Result<(), Failure> {
        if self.lammps.is_some() || self.design.is_some() || self.every.is_some() {
            return Err(Failure::input_with_help(
                format!("{} holds frames of a bed, which are exported as they are", self.source.display()),
                "Leave --lammps, --design and --every out; --xyz, --vtp and --parquet take them.",
            ));
        }
        if common.dry_run {
            return Err(Failure::input_with_help("frames are exported at once: nothing runs", "Leave --dry-run out."));
        }
        let frames = granulens::network::frames(&self.source)?;
        let places = || self.vtp.iter().chain(&self.parquet);
        if let Some(taken) = places().find(|folder| !common.force && folder.exists()) {
            return Err(left_alone(taken));
        }
        probe_all(common, &[self.xyz.as_ref(), common.out.as_ref()])?;
        let folder = self.vtp.as_ref().map(|place| folder::begin(common, place)).transpose()?;
        if let Some(place) = &self.parquet {
            parquet::write(common, place, &frames)?;
        }
        let mut collections = [Vec::new(), Vec::new()];
        let mut xyz = String::new();
        for (k, files) in frames.iter().enumerate() {
            let frame = read_frame(files)?;
            if let Some(folder) = &folder {
                let texts = [export::bed_bodies(&frame), export::bed_contacts(&frame)];
                for ((what, text), list) in ["bodies", "contacts"].iter().zip(texts).zip(&mut collections) {
                    let name = format!("{what}-{k:06}.vtp");
                    folder.write(&name, text.as_bytes())?;
                    list.push((frame.time, name));
                }
            }
            if self.xyz.is_some() {
                xyz += &export::bed_frame(&frame);
            }
        }
        if let Some(folder) = folder {
            for (what, list) in ["bodies", "contacts"].iter().zip(&collections) {
                folder.write(&format!("{what}.pvd"), export::collection(list).as_bytes())?;
            }
            finish(folder, json!({ "version": VERSION, "commit": COMMIT }))?;
        }
        if let Some(path) = &self.xyz {
            write_file(common, path, &xyz)?;
        }
        note(common, &format!("{} frames", frames.len()));
        self.tell(common, Vec::new())
    }

    /// A rig is run as its file says, but for the step and window of the command line.
    fn rig<const D: usize>(&self, common: &Common, prepared: &PreparedRig<D>) -> Result<(), Failure>
    where
        Spheres: MoveIn<D>,
    {
        if self.motion.integrator.unwrap_or(prepared.plan.integrator) != Integrator::Verlet {
            let help = "Leave --integrator out, or take a rig file whose run.integrator is \"verlet\".";
            return Err(Failure::input_with_help(VERLET_ALONE, help));
        }
        prepared.plan.warnings.iter().for_each(|warning| note(common, &format!("warning: {warning}")));
        let window = self.motion.window.unwrap_or(prepared.plan.window);
        self.write(common, |law| {
            let step = self.motion.step.unwrap_or_else(|| match law {
                // LAMMPS switches forces on and off between steps.
                Some(_) => dividing_step(&prepared.rig, prepared.plan.step).unwrap_or(prepared.plan.step),
                None => prepared.plan.step,
            });
            let mut method = Method { step_s: step, window_s: window, ..prepared.method() };
            if step != prepared.plan.step {
                let why = if self.motion.step.is_some() {
                    "given"
                } else {
                    "divides the pulses, between steps of which LAMMPS switches"
                };
                method.step_reason = why.to_owned();
            }
            Ok(Run { rig: prepared.rig.clone(), steps: steps_in(window, step), method })
        })
    }

    /// One run for each law that is needed, and the files that are asked for.
    fn write<const D: usize>(
        &self,
        common: &Common,
        run: impl Fn(Option<LawKind>) -> Result<Run<D>, Failure>,
    ) -> Result<(), Failure>
    where
        Spheres: MoveIn<D>,
    {
        if common.dry_run {
            let mut parts = Vec::new();
            for (asked, law, what) in [
                (self.lammps.is_some(), Some(LawKind::Hertz), "the run for LAMMPS"),
                (self.xyz.is_some() || self.vtp.is_some(), None, "the run to be shown"),
            ] {
                if asked {
                    let run = run(law)?;
                    let mut simulation = begin(run.rig, run.method.step_s)?;
                    parts.push(cost::Part::new(what, 1, Some(cost::rig(&mut simulation, run.steps))));
                }
            }
            return cost::tell(common, &parts);
        }
        let folders: Vec<&PathBuf> = self.lammps.iter().chain(&self.vtp).collect();
        if let Some(taken) = folders.iter().find(|folder| !common.force && folder.exists()) {
            return Err(left_alone(taken));
        }
        probe_all(common, &[self.xyz.as_ref(), common.out.as_ref()])?;
        let mut told = Vec::new();
        if let Some(folder) = &self.lammps {
            let mut run = run(Some(LawKind::Hertz))?;
            let every = self.every(&mut run);
            let deck = export::deck(&run.rig, run.method.step_s, run.steps, every)
                .map_err(|error| Failure::input(error.to_string()))?;
            note(common, &format!("LAMMPS: {}", run.method.words()));
            told.push(("lammps_method", run.method.clone()));
            let mut frames = String::new();
            follow(common, run, every, |simulation| frames.push_str(&export::dump_frame(simulation)))?;
            write_folder(
                common,
                folder,
                &told[0].1,
                [
                    ("crystal.data".to_owned(), deck.data),
                    ("in.crystal".to_owned(), deck.input),
                    ("granulens.dump".to_owned(), frames),
                ],
            )?;
            note(
                common,
                &format!(
                    "{0}: run it there with lmp -in in.crystal, and compare lammps.dump with granulens.dump",
                    folder.display()
                ),
            );
        }
        if self.xyz.is_none() && self.vtp.is_none() {
            return self.tell(common, told);
        }
        let mut run = run(None)?;
        note(common, &format!("frames: {}", run.method.words()));
        let method = run.method.clone();
        let every = self.every(&mut run);
        let mut xyz = String::new();
        let mut files = Vec::new();
        let (mut spheres, mut contacts) = (Vec::new(), Vec::new());
        follow(common, run, every, |simulation| {
            if self.xyz.is_some() {
                xyz.push_str(&export::frame(simulation));
            }
            if self.vtp.is_some() {
                let number = spheres.len();
                for (list, name, text) in [
                    (&mut spheres, format!("spheres-{number:04}.vtp"), export::spheres(simulation)),
                    (&mut contacts, format!("contacts-{number:04}.vtp"), export::contacts(simulation)),
                ] {
                    list.push((simulation.time(), name.clone()));
                    files.push((name, text));
                }
            }
        })?;
        if let Some(path) = &self.xyz {
            write_file(common, path, &xyz)?;
        }
        if let Some(folder) = &self.vtp {
            files.push(("spheres.pvd".to_owned(), export::collection(&spheres)));
            files.push(("contacts.pvd".to_owned(), export::collection(&contacts)));
            write_folder(common, folder, &method, files)?;
        }
        told.push(("method", method));
        self.tell(common, told)
    }

    /// What was written and how it was run, as JSON.
    fn tell(&self, common: &Common, methods: Vec<(&str, Method)>) -> Result<(), Failure> {
        let mut written = json!({
            "format": FORMAT, "source": self.source, "lammps": self.lammps, "xyz": self.xyz,
            "vtp": self.vtp, "parquet": self.parquet, "version": VERSION, "commit": COMMIT,
        });
        for (name, method) in methods {
            written[name] = json!(method);
        }
        write_json(common, &written)?;
        if common.json {
            emit_json(&written);
        }
        Ok(())
    }

    /// Steps between two frames. The run is made to end with one, less than a frame after the window.
    fn every<const D: usize>(&self, run: &mut Run<D>) -> u64 {
        let every = self
            .every
            .map_or(run.steps / 50, |every| (every / run.method.step_s).round() as u64)
            .clamp(1, run.steps.max(1));
        run.steps = run.steps.div_ceil(every) * every;
        every
    }
}

/// What is run to be written.
struct Run<const D: usize> {
    rig: Rig<D>,
    steps: u64,
    /// With what, and how.
    method: Method,
}

fn begin<const D: usize>(rig: Rig<D>, step: f64) -> Result<Simulation<D>, Failure>
where
    Spheres: MoveIn<D>,
{
    Simulation::new(rig, step).map_err(|error: RigError| Failure::input(error.to_string()))
}

/// Runs it, and hands over the state at the start and after every so many steps.
fn follow<const D: usize>(
    common: &Common,
    run: Run<D>,
    every: u64,
    mut frame: impl FnMut(&Simulation<D>),
) -> Result<(), Failure>
where
    Spheres: MoveIn<D>,
{
    let mut simulation = begin(run.rig, run.method.step_s)?;
    let context = context();
    let bar = Count::new(common, (run.steps / every) as usize, "frames");
    frame(&simulation);
    for _ in 0..run.steps / every {
        simulation.advance(every, context).map_err(|stop| match stop {
            RigStop::Interrupted { .. } => Failure::Interrupted("nothing is written".to_owned()),
            stop => Failure::Guard(vec![stop.to_string()]),
        })?;
        frame(&simulation);
        bar.finished(&Time.show(simulation.time()));
    }
    bar.done();
    Ok(())
}

fn left_alone(taken: &std::path::Path) -> Failure {
    Failure::input_with_help(
        format!("{} exists and is left alone", taken.display()),
        "Name a new folder, or replace one of granulens's own with --force.",
    )
}

/// Writes files into a new folder, which appears when it is complete, with a manifest by which it is known again.
fn write_folder(
    common: &Common,
    place: &std::path::Path,
    method: &Method,
    files: impl IntoIterator<Item = (String, String)>,
) -> Result<(), Failure> {
    let folder = folder::begin(common, place)?;
    for (name, text) in files {
        folder.write(&name, text.as_bytes())?;
    }
    finish(folder, json!(method))
}

/// Puts a folder in its place, with a manifest.
fn finish(folder: Folder, mut manifest: serde_json::Value) -> Result<(), Failure> {
    manifest["format"] = json!(FORMAT);
    manifest["made_by"] = json!("granulens export");
    folder.write("manifest.json", pretty(&manifest).as_bytes())?;
    Ok(folder.finish()?)
}
