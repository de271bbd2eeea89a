//! `granulens export`: a crystal and its motion as files for LAMMPS, OVITO and ParaView.

use std::fs;
use std::path::PathBuf;

use granulens::contact::LawKind;
use granulens::dem::rig::{RigError, RigStop, Simulation};
use granulens::dem::steps_in;
use granulens::design::Design;
use granulens::evaluate::Plan;
use granulens::export;
use granulens::units::Dimension::Time;

use super::compare::read_layout;
use super::console::{Count, interrupt, note};
use super::failure::Failure;
use super::folder::{probe, write_file};
use super::{Common, Motion, propose, time};

/// Write a crystal and its motion for LAMMPS, OVITO or ParaView
///
/// The whole crystal is written, both halves, repeating itself across the wave. For LAMMPS it has Hertz contacts, whatever the
/// design says: an input deck, and the same run by this program to compare with. The other two show a run under the design's law.
#[derive(clap::Args)]
#[command(group = clap::ArgGroup::new("what").required(true).multiple(true).args(["lammps", "xyz", "vtp"]))]
pub struct Export {
    /// Design file, whose lens is proposed, or a layout (then with --design)
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
    /// Time between frames, such as "5 us"; without, fifty frames
    #[arg(long, value_name = "TIME", allow_hyphen_values = true, value_parser = time)]
    every: Option<f64>,
    #[command(flatten)]
    motion: Motion,
}

impl Export {
    pub fn run(self, common: &Common) -> Result<(), Failure> {
        let is_design = self.source.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("toml"));
        let (design, layout) = match (&self.design, is_design) {
            (None, true) => {
                let design = Design::read(&self.source)?;
                let layout = propose(&design)?.layout();
                (design, layout)
            }
            (Some(design), false) => {
                let design = Design::read(design)?;
                let layout = read_layout(&design, &self.source)?;
                (design, layout)
            }
            (None, false) => {
                return Err(Failure::input_with_help(
                    format!("{} is taken for a layout, and a layout needs its design", self.source.display()),
                    "Add --design DESIGN.toml, or export a design file (NAME.toml).",
                ));
            }
            (Some(_), true) => {
                return Err(Failure::input_with_help(
                    "two design files are given",
                    "Give a layout and --design, or a design alone.",
                ));
            }
        };
        let folders: Vec<&PathBuf> = self.lammps.iter().chain(&self.vtp).collect();
        if let Some(taken) = folders.iter().find(|folder| folder.exists()) {
            return Err(Failure::input_with_help(
                format!("{} exists and is left alone", taken.display()),
                "Name a new folder.",
            ));
        }
        probe(self.xyz.as_ref())?;
        if self.lammps.is_some() && design.law != LawKind::Hertz {
            note(common, &format!("LAMMPS has no law \"{}\": its deck has Hertz contacts", design.law));
        }
        // One run for each law that is needed.
        if let Some(folder) = &self.lammps {
            let hertz = Design { law: LawKind::Hertz, ..design.clone() };
            let (mut simulation, [steps, every]) = self.begin(common, &hertz, &layout)?;
            let deck = export::deck(simulation.rig(), simulation.step(), steps, every)
                .map_err(|error| Failure::input(error.to_string()))?;
            let mut frames = String::new();
            self.follow(common, &mut simulation, [steps, every], |simulation| {
                frames.push_str(&export::dump_frame(simulation));
            })?;
            write_folder(
                folder,
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
            return Ok(());
        }
        let (mut simulation, run) = self.begin(common, &design, &layout)?;
        let mut xyz = String::new();
        let mut files = Vec::new();
        let (mut spheres, mut contacts) = (Vec::new(), Vec::new());
        self.follow(common, &mut simulation, run, |simulation| {
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
            write_file(path, &xyz)?;
        }
        if let Some(folder) = &self.vtp {
            files.push(("spheres.pvd".to_owned(), export::collection(&spheres)));
            files.push(("contacts.pvd".to_owned(), export::collection(&contacts)));
            write_folder(folder, files)?;
        }
        Ok(())
    }

    /// The crystal at rest, with the steps of its run and those between two frames.
    fn begin(
        &self,
        common: &Common,
        design: &Design,
        layout: &granulens::layout::Layout,
    ) -> Result<(Simulation<2>, [u64; 2]), Failure> {
        let overrides = self.motion.overrides(common);
        let plan = Plan::new(design, overrides, &layout.palette)
            .map_err(|error| Failure::of_plan(design, &overrides, &error))?;
        let rig = export::whole_crystal(layout, design.impact, design.law, design.constants);
        let simulation =
            Simulation::new(rig, plan.step).map_err(|error: RigError| Failure::input(error.to_string()))?;
        let steps = steps_in(plan.window, plan.step);
        let every = self.every.map_or(steps / 50, |every| (every / plan.step).round() as u64).max(1);
        Ok((simulation, [steps, every]))
    }

    /// Runs it, and hands over the state at the start and after every so many steps.
    fn follow(
        &self,
        common: &Common,
        simulation: &mut Simulation<2>,
        [steps, every]: [u64; 2],
        mut frame: impl FnMut(&Simulation<2>),
    ) -> Result<(), Failure> {
        let interrupt = interrupt();
        let bar = Count::new(common, (steps / every) as usize, "frames");
        frame(simulation);
        for _ in 0..steps / every {
            simulation.advance(every, interrupt).map_err(|stop| match stop {
                RigStop::Interrupted { .. } => Failure::Interrupted("nothing is written".to_owned()),
                stop => Failure::Guard(vec![stop.to_string()]),
            })?;
            frame(simulation);
            bar.finished(&Time.show(simulation.time()));
        }
        bar.done();
        Ok(())
    }
}

/// Writes files into a new folder, which appears when it is complete.
fn write_folder(place: &std::path::Path, files: impl IntoIterator<Item = (String, String)>) -> Result<(), Failure> {
    let folder = super::folder::Folder::begin(place)?;
    for (name, text) in files {
        let path = folder.path().join(name);
        fs::write(&path, text).map_err(|error| Failure::write(&path, &error))?;
    }
    folder.finish()
}
