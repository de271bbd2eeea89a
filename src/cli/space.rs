//! Designs in space: what `design`, `run`, `compare` and `check` do with them.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::time::Instant;

use granulens::dem::Stop;
use granulens::design::SpaceDesign;
use granulens::evaluate::{
    Drawing, Evaluation, EvaluatorError, Forces, Overrides, SpaceComparison, compare_in_space, evaluate_in_space,
    method, part_in_space, parted, simulated_fraction, stops, struck_force,
};
use granulens::gate;
use granulens::lattice::{Block, Layered};
use granulens::layout::{self, Layout};
use granulens::lens::{Body, LensRequest, Symmetry};
use granulens::outcome::{Checked, FORMAT, SpaceOutcome};
use granulens::output::Folder;
use granulens::report;
use granulens::score::Scores;
use granulens::units::Dimension::{Force, Length, Mass};
use granulens::wave::Dimension;
use serde_json::json;

use super::Common;
use super::command_line;
use super::console::{Count, context, emit, emit_json, note};
use super::cost::{Part, arrangement, tell};
use super::design::about;
use super::failure::Failure;
use super::folder::{begin, probe, probe_all, write_file, write_json};
use super::over_laws::UnderLaws;

/// The design's lens and what it lays on the crystal.
fn lens(design: &SpaceDesign) -> Result<(Body, &LensRequest, Vec<u8>), Failure> {
    let (body, materials) = design.propose_in_space()?;
    let request = design.lens.as_ref().ok_or_else(|| Failure::input("the design asks for no lens"))?;
    Ok((body, request, materials))
}

/// `design` of a design in space.
pub fn propose(common: &Common, design: &SpaceDesign, full: bool) -> Result<(), Failure> {
    let (body, request, materials) = lens(design)?;
    let comparison = comparison(design, Overrides::default(), (&body, request, materials))?;
    let laid = &comparison.subject;
    let text = if full { layout::write_whole_in_space(laid) } else { layout::write_in_space(laid) };
    if let Some(path) = &common.out {
        write_file(common, path, &text)?;
        note(common, &format!("layout: {}", path.display()));
    }
    if common.json {
        emit_json(&json!({ "format": FORMAT, "name": design.name, "proposal": comparison.proposal }));
    } else if common.out.is_none() {
        note(common, &words(design, &body, request, laid));
        emit(&text);
    } else {
        emit(&words(design, &body, request, laid));
    }
    Ok(())
}

fn comparison<'a>(
    design: &'a SpaceDesign,
    overrides: Overrides,
    (body, request, materials): (&Body, &LensRequest, Vec<u8>),
) -> Result<SpaceComparison<'a>, Failure> {
    SpaceComparison::of_lens(design, (body, request, materials), overrides)
        .map_err(|error| Failure::of_plan(design, &overrides, &error))
}

/// What is proposed, for a person.
fn words(design: &SpaceDesign, body: &Body, request: &LensRequest, layout: &Layout<Block>) -> String {
    let block = &design.lattice;
    let in_diameters = |length: f64| format!("{:.2} D", length / block.diameter());
    let percent = |fraction: f64| format!("{:.1} %", 100.0 * fraction);
    let piece = layout.piece_in_space(|material| design.price(material));
    let counts: Vec<String> = layout
        .palette
        .iter()
        .zip(&piece.counts)
        .map(|(material, count)| format!("{count} {}", material.name))
        .collect();
    let [wide, high] = block.cells();
    let sites = block.sites().len();
    let simulated = match block.sixth().filter(|_| simulated_fraction(layout) < 0.5) {
        Some(sixth) => format!("a sixth of it is simulated, {} of {sites} sites of the half", sixth.sites.len()),
        None => format!("half of it is simulated, {sites} sites"),
    };
    let radius = match (request.family.radius(), body.radius) {
        (Some(name), Some(radius)) => format!(", {name} {} ({})", in_diameters(radius), Length.show(radius)),
        _ => String::new(),
    } + &request.family.words(&body.parameters, block.diameter());
    let (going, struck) = match request.symmetry {
        Symmetry::Axis => ("revolved about the axis", "disc of the same area as the struck layer"),
        Symmetry::Plane => ("the same all along y", "struck width"),
    };
    let force = struck_force(design, Dimension::Three, &design.host, block.diameter());
    let mut words = format!(
        "crystal: {}, {} layers of {wide} by {high} cells, {} spheres; {simulated}\n\
         speeds: {} {:.0} m/s, {} {:.0} m/s (bound, 3D), ratio {:.3}\n\
         impact: {}{} per sphere, {} per contact\n\
         lens: layers {} to {}, {}, {going}{radius}, steepest {:.1} deg\n\
         piece: {}; {}\n\
         rays: {} of the {struck} reach the focus, {} without the lens; {} pass the protected region, {} without",
        block.cell().name(),
        block.layers(),
        block.spheres(),
        design.host.name,
        body.speeds[0],
        request.material.name,
        body.speeds[1],
        body.speeds[0] / body.speeds[1],
        about(design.impact),
        Force.show(force),
        Force.show(Dimension::Three.contact_force(force)),
        body.apex_row,
        body.back_row,
        request.family.name(),
        body.steepest.to_degrees(),
        counts.join(", "),
        Mass.show(piece.amount.mass),
        percent(body.fraction),
        percent(body.fraction_without),
        percent(body.protected[0]),
        percent(body.protected[1]),
    );
    if let Some(cost) = piece.amount.cost {
        let _ = write!(words, "\ncost: {cost:.2} for all spheres of the piece, in the currency of [prices]");
    }
    words
}

/// `run` of a design in space.
pub fn run(common: &Common, design: &SpaceDesign, overrides: Overrides, forces: Forces) -> Result<(), Failure> {
    let (body, request, materials) = lens(design)?;
    let comparison = comparison(design, overrides, (&body, request, materials))?.over(forces);
    if common.dry_run {
        return cost(common, &comparison);
    }
    let place = common.out.clone().unwrap_or_else(|| Path::new("reports").join(&design.name));
    let folder = begin(common, &place)?;
    note(common, &words(design, &body, request, &comparison.subject));
    note(common, &format!("step: {}", comparison.plan.step_reason));
    let outcome = simulated(common, &comparison)?;
    fill(&folder, &outcome, &comparison.subject)?;
    folder.finish()?;
    tell_outcome(common, &outcome);
    note(common, &format!("report: {}", place.join("report.html").display()));
    guard(&outcome)
}

fn fill(folder: &Folder, outcome: &SpaceOutcome, subject: &Layout<Block>) -> Result<(), Failure> {
    for (name, text) in report::space_files(outcome)? {
        folder.write(&name, text.as_bytes())?;
    }
    folder.write("layout.csv", layout::write_in_space(subject).as_bytes())?;
    folder.write("layout-full.csv", layout::write_whole_in_space(subject).as_bytes())?;
    Ok(())
}

fn simulated(common: &Common, comparison: &SpaceComparison) -> Result<SpaceOutcome, Failure> {
    let bar = Count::new(common, comparison.len(), "arrangements");
    let mut outcome = compare_in_space(comparison, &bar.context())?;
    outcome.manifest.command = Some(command_line());
    bar.done();
    Ok(outcome)
}

fn tell_outcome(common: &Common, outcome: &SpaceOutcome) {
    if common.json {
        emit_json(&report::numbers(outcome));
    } else {
        emit(&report::space_table(outcome));
    }
}

fn guard(outcome: &SpaceOutcome) -> Result<(), Failure> {
    let stopped = stops(&outcome.arrangements);
    if stopped.is_empty() { Ok(()) } else { Err(Failure::Guard(stopped)) }
}

/// `compare` of a design in space, with its lens or a given layout.
pub fn compare(
    common: &Common,
    design: &SpaceDesign,
    given: Option<&Path>,
    overrides: Overrides,
    forces: Forces,
) -> Result<(), Failure> {
    let comparison = match given {
        None => {
            let (body, request, materials) = lens(design)?;
            comparison(design, overrides, (&body, request, materials))?
        }
        Some(path) => {
            let name = path.file_stem().map_or_else(|| "layout".to_owned(), |stem| stem.to_string_lossy().into_owned());
            SpaceComparison::of_layout(design, name, read(design, path)?, overrides)
                .map_err(|error| Failure::of_plan(design, &overrides, &error))?
        }
    }
    .over(forces);
    if common.dry_run {
        return cost(common, &comparison);
    }
    probe(common, common.out.as_ref())?;
    let outcome = simulated(common, &comparison)?;
    if let Some(path) = &common.out {
        write_file(common, path, &report::outcome_json(&outcome)?)?;
    }
    tell_outcome(common, &outcome);
    guard(&outcome)
}

/// A layout of a design in space.
pub fn read(design: &SpaceDesign, path: &Path) -> Result<Layout<Block>, Failure> {
    Ok(layout::read_in_space(path, &design.lattice, &design.palette(), &design.own_materials)?)
}

fn cost(common: &Common, comparison: &SpaceComparison) -> Result<(), Failure> {
    let (sample, impact) = part_in_space(comparison.design, &comparison.plan, &comparison.subject);
    let alone = arrangement(&sample, &impact)?;
    let each = 1 + if comparison.forces.is_one() { 0 } else { comparison.forces.count() as u64 };
    // Under its own force the lens is followed with records alone.
    let runs = comparison.len() as u64 * each - 1;
    // A run in a half takes three times one in a sixth, and in lanes without records about a fifth of one with them.
    let fractions = comparison.fractions();
    let all = fractions.iter().sum::<f64>() / fractions[0] * each as f64 - 1.0;
    let in_lanes = format!("runs in lanes, {} arrangements under {each} forces", comparison.len());
    let parts =
        [Part::new("the lens, with full records", 1, Some(alone)), Part::new(in_lanes, runs, Some(alone / 5.0 * all))];
    tell(common, &parts)
}

/// What is asked of `check`.
pub struct Asked<'a> {
    pub forces: Forces,
    pub spheres: Option<&'a PathBuf>,
    pub gate: Option<&'a gate::Asked>,
    pub under: &'a UnderLaws,
}

/// `check` of a layout in space.
pub fn check(
    common: &Common,
    design: &SpaceDesign,
    (path, layout): (&Path, &Layout<Block>),
    overrides: Overrides,
    asked: &Asked<'_>,
) -> Result<Checked, Failure> {
    let Asked { forces, spheres, .. } = *asked;
    let drawing = Drawing::Space(design, layout);
    let plan = drawing.plan(overrides).map_err(|error| Failure::of_plan(design, &overrides, &error))?;
    probe_all(common, &[spheres, common.out.as_ref()])?;
    let begun = Instant::now();
    let Evaluation { mut scores, record, doubts } = evaluate_in_space(design, layout, &plan, context())?;
    let beside = granulens::evaluate::beside_in_space(design, layout, &plan, forces, context());
    let mut stop = record.stop.clone();
    let mut warnings: Vec<String> = plan.warnings.clone();
    let (reference, over, spreads) = match beside {
        Ok(beside) => {
            if beside.over_forces.is_none() && !beside.forces.is_empty() {
                warnings.push(super::check::STOPPED_BESIDE.to_owned());
            }
            if let (None, Some(material)) = (design.reference(), &beside.reference) {
                warnings.push(granulens::evaluate::unnamed(material));
            }
            scores.relate(beside.uniform[0], beside.uniform[1]);
            warnings.extend(beside.stopped.iter().map(|(name, stop)| format!("FAILED: {name}: {stop}")));
            (beside.reference, beside.forces, beside.over_forces)
        }
        Err(EvaluatorError::Interrupted) => {
            stop = stop.or(Some(Stop::Interrupted { time_s: 0.0 }));
            (None, Vec::new(), None)
        }
        Err(error) => return Err(error.into()),
    };
    if let Some(path) = spheres {
        write_file(common, path, &felt(layout, &record))?;
    }
    let evaluation = Evaluation { scores, record, doubts };
    let (gate, laws) = match stop {
        None => {
            let seen = gate::Seen::of(&evaluation, spreads.as_ref().map(|(scores, _)| scores));
            let gate = asked.gate.map(|gated| gate::gate(drawing, &plan, seen, gated, context())).transpose()?;
            (gate, asked.under.scores(drawing, overrides)?)
        }
        Some(_) => (None, None),
    };
    warnings.extend(evaluation.warnings("this layout"));
    let Evaluation { scores, record, .. } = evaluation;
    let (mean, spreads): (Scores, _) = spreads.unwrap_or_default();
    let judged = if over.is_empty() { &scores } else { &mean };
    let over = parted(design.impact, over);
    let checked = Checked {
        format: FORMAT,
        design: design.name.clone(),
        layout: path.display().to_string(),
        thresholds: design.thresholds.iter().map(|threshold| super::check::asked(threshold, judged)).collect(),
        scores,
        over_forces: spreads,
        forces: over.0,
        speeds: over.1,
        materials: layout.palette.iter().map(|material| material.name.clone()).collect(),
        reference,
        piece: layout.piece_in_space(|material| design.price(material)),
        half: None,
        method: method(design, &plan),
        simulated_fraction: Some(simulated_fraction(layout)),
        steps: record.steps,
        seconds: begun.elapsed().as_secs_f64(),
        warnings,
        laws,
        gate,
        stop,
    };
    write_json(common, &checked)?;
    Ok(checked)
}

/// What each sphere of the half felt, as CSV; SI.
fn felt(layout: &Layout<Block>, record: &granulens::dem::Record<3>) -> String {
    let mut text = String::from(
        "layer,column,x,y,z,material,max_kinetic_J,max_net_force_N,max_contact_force_N,arrival_s,dissipated_J\n",
    );
    for (i, (site, &material)) in layout.lattice.sites().iter().zip(&layout.materials).enumerate() {
        let ([x, y, z], name) = (site.centre, &layout.palette[usize::from(material)].name);
        let arrival = record.arrival[i].map_or_else(String::new, |time| time.to_string());
        let _ = writeln!(
            text,
            "{},{},{x},{y},{z},{name},{},{},{},{arrival},{}",
            site.layer,
            site.column,
            record.max_kinetic[i],
            record.max_net_force[i],
            record.max_contact_force[i],
            record.dissipated[i],
        );
    }
    text
}

/// What a command cannot do in space.
pub fn refuse(what: &str) -> Failure {
    Failure::input_with_help(
        format!("{what} is for sheets; this design is a crystal in space"),
        "Leave it out. In space there are design, run, compare, check, tolerance, study and build, with --forces and --spheres.",
    )
}
