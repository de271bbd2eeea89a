//! `granulens compare`: a lens, or given layouts, against the baselines.

use std::path::PathBuf;

use granulens::dem::rig::Simulation;
use granulens::dem::steps_in;
use granulens::design::{AnyDesign, Design};
use granulens::evaluate::{Comparison, Drawing, Forces, compare, impact, stops};
use granulens::inside;
use granulens::layout::{self, Layout, ReadLayout};
use granulens::outcome::Outcome;
use granulens::report;

use super::console::{Count, emit, emit_json, note};
use super::cost::{Part, tell};
use super::failure::Failure;
use super::folder::{probe, write_file};
use super::over_laws::UnderLaws;
use super::{Band, Common, Motion, command_line, propose};

/// Simulate the lens, or a given layout, and all baselines; print the table
///
/// With --out, the whole outcome is written as JSON too, sphere by sphere.
#[derive(clap::Args)]
pub struct Compare {
    /// Design file
    design: PathBuf,
    /// Layout to compare in place of the proposed lens
    layout: Option<PathBuf>,
    #[command(flatten)]
    motion: Motion,
    #[command(flatten)]
    under: UnderLaws,
    #[command(flatten)]
    forces: Band,
}

impl Compare {
    pub fn run(self, common: &Common) -> Result<(), Failure> {
        let design = match AnyDesign::read(&self.design)? {
            AnyDesign::Plane(design) => *design,
            AnyDesign::Space(_) if self.under.is_asked() => return Err(super::space::refuse("--laws")),
            AnyDesign::Space(design) => {
                let (overrides, forces) = (self.motion.overrides(common), self.forces.or(Forces::USUAL)?);
                return super::space::compare(common, &design, self.layout.as_deref(), overrides, forces);
            }
        };
        let overrides = self.motion.overrides(common);
        let comparison = match &self.layout {
            None => Comparison::of_lens(&design, &propose(&design)?, overrides),
            Some(path) => {
                let name =
                    path.file_stem().map_or_else(|| "layout".to_owned(), |stem| stem.to_string_lossy().into_owned());
                let read = read_piece(common, &design, path)?;
                Comparison::of_layout(&design, name, &read, overrides)
            }
        }
        .map_err(|error| Failure::of_plan(&design, &overrides, &error))?
        .over(self.forces.or(Forces::USUAL)?);
        if common.dry_run {
            return cost(common, &design, &comparison, (false, false));
        }
        self.under.chosen(&design)?;
        probe(common, common.out.as_ref())?;
        let bar = Count::new(common, comparison.len(), "arrangements");
        let mut outcome = compare(&comparison, &bar.context())?;
        outcome.manifest.command = Some(command_line());
        bar.done();
        if let Some(path) = &common.out {
            write_file(common, path, &report::outcome_json(&outcome)?)?;
        }
        let whole = outcome.arrangements.len() == comparison.len();
        let laws =
            if whole { self.under.scores(Drawing::Plane(&design, comparison.piece()), overrides)? } else { None };
        if common.json {
            let mut numbers = serde_json::json!(report::numbers(&outcome));
            if let Some(laws) = &laws {
                numbers["laws"] = serde_json::json!(laws);
            }
            emit_json(&numbers);
        } else {
            emit(&report::table(&outcome));
            laws.iter().for_each(|laws| emit(&laws.table()));
        }
        if outcome.arrangements.len() < comparison.len() {
            let (finished, all) = (outcome.arrangements.len(), comparison.len());
            return Err(Failure::Interrupted(format!("{finished} of {all} arrangements are finished and shown")));
        }
        unfinished(&comparison, &outcome)?;
        guard(&outcome)
    }
}

/// Fails where all arrangements were simulated, but the verdict was interrupted.
pub fn unfinished(comparison: &Comparison, outcome: &Outcome) -> Result<(), Failure> {
    let judged =
        !outcome.forces.is_empty() || !outcome.speeds.is_empty() || outcome.arrangements.len() < comparison.len();
    if judged {
        Ok(())
    } else {
        Err(Failure::Interrupted("all arrangements are finished, the verdict is not".to_owned()))
    }
}

/// What the arrangements of a comparison will cost, and a look inside the first, and its sensitivities, where these are asked for.
pub fn cost(
    common: &Common,
    design: &Design,
    comparison: &Comparison,
    (looks_inside, sensitivity): (bool, bool),
) -> Result<(), Failure> {
    let alone = super::cost::arrangement(&comparison.subject.sample(), &impact(design, &comparison.plan))?;
    let count = comparison.len() as u64;
    let forces = comparison.forces.count() as u64;
    let mut parts = vec![Part::new("arrangements, with full records", count, Some(alone * count as f64))];
    if forces > 1 {
        // In lanes without records a run takes about a fifth of one with them.
        let each = alone / 5.0;
        let runs = count * forces;
        parts.push(Part::new(format!("runs for the verdict, {forces} forces"), runs, Some(each * runs as f64)));
    }
    if looks_inside && comparison.left.is_none() {
        let failed = |error: &dyn std::fmt::Display| Failure::input(error.to_string());
        let (rig, step) = inside::rig(design, &comparison.subject).map_err(|error| failed(&error))?;
        let steps = steps_in(comparison.plan.window, step);
        let mut simulation = Simulation::new(rig, step).map_err(|error| failed(&error))?;
        let seconds = super::cost::rig(&mut simulation, steps);
        parts.push(Part::new("look inside the first, both halves", 1, Some(seconds)));
    }
    if sensitivity {
        parts.extend(super::sensitivity::cost(alone, comparison.subject.materials.len()));
    }
    tell(common, &parts)
}

/// Reads a layout, or a piece whose halves differ, on the design's lattice; what the design names keeps the first places of the palette.
pub fn read_piece(common: &Common, design: &Design, path: &std::path::Path) -> Result<ReadLayout, Failure> {
    let read = layout::read_piece(path, &design.lattice, &design.palette(), &design.own_materials)?;
    read.notes.iter().for_each(|text| note(common, &format!("note: {text}")));
    if read.left.is_some() {
        note(common, "note: the halves of the piece differ: it is simulated whole, between walls at both far sides");
    }
    Ok(read)
}

/// Reads a layout that stands for both halves on the design's lattice; what the design names keeps the first places of the palette.
pub fn read_layout(common: &Common, design: &Design, path: &std::path::Path) -> Result<Layout, Failure> {
    let read = layout::read_noted(path, &design.lattice, &design.palette(), &design.own_materials)?;
    read.notes.iter().for_each(|text| note(common, &format!("note: {text}")));
    Ok(read.layout)
}

/// Fails where a guard stopped an arrangement.
pub fn guard(outcome: &Outcome) -> Result<(), Failure> {
    let stopped = stops(&outcome.arrangements);
    if stopped.is_empty() { Ok(()) } else { Err(Failure::Guard(stopped)) }
}
