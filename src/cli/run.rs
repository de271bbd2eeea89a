//! `granulens run`: from a design file to a report.

use std::path::{Path, PathBuf};

use granulens::design::AnyDesign;
use granulens::evaluate::{Comparison, Forces, Subject, compare, sensitivities, swaps};
use granulens::outcome::Outcome;
use granulens::output::Folder;
use granulens::report;
use granulens::score::Measure;
use granulens::{inside, layout};

use super::console::{Count, context, emit, emit_json, note};
use super::failure::Failure;
use super::folder::begin;
use super::{Band, Common, Motion, command_line, propose};

/// The whole job: propose a lens, simulate it and its baselines, score, report
///
/// The output folder, reports/NAME unless --out names another, appears when it is complete; an earlier report there is
/// replaced as a whole. Of an interrupted run the finished numbers are kept beside it.
#[derive(clap::Args)]
pub struct Run {
    /// Design file, such as designs/quickstart.toml
    design: PathBuf,
    /// Draw how F and P change with every sphere too, as granulens sensitivity tells; some ten runs and one for each sphere
    #[arg(long)]
    sensitivity: bool,
    #[command(flatten)]
    motion: Motion,
    #[command(flatten)]
    forces: Band,
}

impl Run {
    pub fn run(self, common: &Common) -> Result<(), Failure> {
        let design = match AnyDesign::read(&self.design)? {
            AnyDesign::Plane(design) => *design,
            AnyDesign::Space(design) => {
                if self.sensitivity {
                    return Err(Failure::input_with_help(
                        "--sensitivity is of sheets: the run of a crystal in space has no derivatives",
                        "Leave it out.",
                    ));
                }
                let forces = self.forces.or(Forces::USUAL)?;
                return super::space::run(common, &design, self.motion.overrides(common), forces);
            }
        };
        let lens = propose(&design)?;
        let overrides = self.motion.overrides(common);
        let comparison = Comparison::of_lens(&design, &lens, overrides)
            .map_err(|error| Failure::of_plan(&design, &overrides, &error))?
            .over(self.forces.or(Forces::USUAL)?);
        if common.dry_run {
            return super::compare::cost(common, &design, &comparison, (true, self.sensitivity));
        }
        let place = common.out.clone().unwrap_or_else(|| Path::new("reports").join(&design.name));
        let words = super::design::words(&design, &lens);
        deliver(
            common,
            &comparison,
            &place,
            Delivery { words: Some(&words), kinds: &[], sensitivity: self.sensitivity, swaps: false },
        )
    }
}

/// How a report is delivered.
pub struct Delivery<'a> {
    /// What is said first, once it is known that the folder may be written.
    pub words: Option<&'a str>,
    /// As what figures are written beside SVG: pdf, png.
    pub kinds: &'a [&'static str],
    /// Whether it is asked how scores change with every sphere.
    pub sensitivity: bool,
    /// Whether it is asked what exchanging single spheres does.
    pub swaps: bool,
}

/// Simulates a comparison and writes its report, which appears when it is complete.
pub fn deliver(
    common: &Common,
    comparison: &Comparison<'_>,
    place: &Path,
    delivery: Delivery<'_>,
) -> Result<(), Failure> {
    let folder = begin(common, place)?;
    if let Some(words) = delivery.words {
        note(common, words);
    }
    note(common, &format!("step: {}", comparison.plan.step_reason));
    for (asked, name) in [(delivery.swaps, "--swaps"), (delivery.sensitivity, "--sensitivity")] {
        if asked && comparison.left.is_some() {
            return Err(Failure::input_with_help(
                format!("{name} changes spheres in both halves alike, and the halves of this piece differ"),
                "Leave it out, or give a layout of the half x >= 0.",
            ));
        }
    }
    // First, since some runs have none.
    let derivatives = delivery
        .sensitivity
        .then(|| {
            note(common, "derivatives by every sphere, and secants ...");
            let Comparison { design, subject, plan, .. } = comparison;
            let of = [Measure::FocalMean, Measure::ProtectedMean];
            sensitivities(design, subject, plan, &of, context()).map_err(|error| super::sensitivity::failure(&error))
        })
        .transpose()?;
    let bar = Count::new(common, comparison.len(), "arrangements");
    let counted = bar.context();
    let (outcome, inside) = rayon::join(
        || compare(comparison, &counted),
        || {
            let Comparison { design, subject, rows, plan, .. } = comparison;
            // Of halves that differ there is no sheet that repeats itself.
            let is_whole = comparison.left.is_none();
            is_whole.then(|| inside::look(design, subject, *rows, plan.window, context()))
        },
    );
    let mut outcome = outcome?;
    outcome.inside = match inside {
        None => None,
        Some(Ok(inside)) => Some(inside),
        Some(Err(error)) => {
            note(common, &format!("not looked inside: {error}"));
            None
        }
    };
    outcome.manifest.command = Some(command_line());
    bar.done();

    let expected = comparison.len();
    if outcome.arrangements.len() < expected {
        let finished = outcome.arrangements.len();
        let (kept, folder) = Folder::beside(place, "interrupted")?;
        report::write_numbers(&outcome, folder.path())?;
        folder.finish()?;
        return Err(Failure::Interrupted(format!(
            "{finished} of {expected} arrangements are finished; their numbers are in {}",
            kept.display()
        )));
    }
    if delivery.swaps {
        note(common, "simulating every exchange of a sphere ...");
        outcome.swaps = Some(swaps(comparison.design, &comparison.subject, &comparison.plan, context())?);
    }
    outcome.sensitivities = derivatives.map(|found| found.of);
    fill(&folder, &outcome, comparison.piece())?;
    figures(&outcome, &folder, delivery.kinds)?;
    folder.finish()?;

    tell(common, &outcome, place);
    super::compare::unfinished(comparison, &outcome)?;
    super::compare::guard(&outcome)
}

/// Says what an outcome is, and where its report stands.
pub fn tell(common: &Common, outcome: &Outcome, place: &Path) {
    if common.json {
        emit_json(&report::numbers(outcome));
    } else {
        emit(&report::table(outcome));
    }
    note(common, &format!("report: {}", place.join("report.html").display()));
}

/// Fills a folder with a report and its layouts.
pub fn fill(folder: &Folder, outcome: &Outcome, piece: Subject<'_>) -> Result<(), Failure> {
    report::write(outcome, folder.path())?;
    let mut layouts = vec![("layout-full.csv", layout::write_piece(piece.layout, &piece.spheres()))];
    // A half says nothing of a piece whose other one differs.
    if piece.left.is_none() {
        layouts.push(("layout.csv", layout::write(piece.layout)));
        layouts.push(("layout.json", layout::write_json(piece.layout)));
    }
    for (name, text) in layouts {
        folder.write(name, text.as_bytes())?;
    }
    Ok(())
}

/// Every figure as PDF or PNG beside its SVG.
pub fn figures(outcome: &Outcome, folder: &Folder, kinds: &[&str]) -> Result<(), Failure> {
    if kinds.is_empty() {
        return Ok(());
    }
    for (name, svg) in report::pictures(outcome)? {
        for kind in kinds {
            let drawn = if *kind == "pdf" { report::pdf(&svg) } else { report::png(&svg) };
            let bytes = drawn.map_err(|error| Failure::input(format!("{name}: {error}")))?;
            folder.write(&name.replace(".svg", &format!(".{kind}")), &bytes)?;
        }
    }
    Ok(())
}
