//! `granulens build`: what a workshop needs to build a layout.

use std::path::{Path, PathBuf};

use granulens::build::{
    self, BatchError, Frame, Inspected, Kind, Paper, Part, Piece, Spares, WallEffect, Yield, inspection, read_batch,
};
use granulens::dem::rig::RigStop;
use granulens::dem::{Integrator, Stop};
use granulens::design::{AnyDesign, SpaceDesign};
use granulens::evaluate::{HeldError, Overrides, Plan, Subject, evaluate_in_space, impact, method, part_in_space};
use granulens::input;
use granulens::lattice::Layered;
use granulens::layout::{Layout, write_piece, write_whole_in_space};
use granulens::outcome::{Begun, FORMAT};
use granulens::output::Folder;
use granulens::units::Dimension;
use granulens::units::Dimension::{Energy, Length, Mass};
use serde_json::json;

use super::compare::read_piece;
use super::console::{context, emit, emit_json, note, pretty};
use super::cost::{arrangement, tell};
use super::failure::Failure;
use super::folder::begin;
use super::{Common, Motion, command_line, cost};

/// Drawings, lists and a frame for the workshop that builds a layout
///
/// The folder, builds/NAME unless --out names another, holds the assembly map at 1:1 (PDF for A4, A3 and Letter, SVG, DXF), the
/// placement list, the parts list, the frame as STL and 3MF, and which spheres to measure first. Of a crystal in space it holds the map of each
/// layer, the placement list layer by layer, in the order of laying, the parts list, the tray as STL and 3MF, and which spheres to measure first.
#[derive(clap::Args)]
pub struct Build {
    /// Layout, CSV with the header row,column,x,z,diameter,material or, in space, layer,column,x,y,z,diameter,material
    layout: PathBuf,
    /// Design file: everything but the materials
    #[arg(long, value_name = "FILE")]
    design: PathBuf,
    /// Measured diameters, CSV with the columns material, diameter_mm and, where spheres have names, id: says which goes where
    #[arg(long, value_name = "FILE")]
    sorted: Option<PathBuf>,
    /// Spheres of each material to order besides, as a part of those that are built in
    #[arg(long, value_name = "PART", default_value = "5 %", allow_hyphen_values = true, value_parser = part)]
    spares: f64,
    /// What granulens tolerance found of this layout, its folder or tolerance.json: spares are then whole sets too, as many as a piece that does what is asked takes with 95 %
    #[arg(long = "yield", value_name = "FILE")]
    from_yield: Option<PathBuf>,
    /// Room between the piece and each wall of the frame
    #[arg(long, value_name = "LENGTH", default_value = "0 mm", allow_hyphen_values = true, value_parser = room)]
    clearance: f64,
    /// Thickness of the frame's walls
    #[arg(long, value_name = "LENGTH", default_value = "10 mm", allow_hyphen_values = true, value_parser = super::length)]
    wall: f64,
    /// Thickness of the frame's floor
    #[arg(long, value_name = "LENGTH", default_value = "4 mm", allow_hyphen_values = true, value_parser = super::length)]
    floor: f64,
    #[command(flatten)]
    motion: Motion,
}

fn part(text: &str) -> Result<f64, String> {
    let part = Dimension::Fraction.parse(text).map_err(|error| error.to_string())?;
    if (0.0..=10.0).contains(&part) { Ok(part) } else { Err("must lie between 0 and 1000 %".to_owned()) }
}

fn room(text: &str) -> Result<f64, String> {
    let room = Length.parse(text).map_err(|error| error.to_string())?;
    if room >= 0.0 { Ok(room) } else { Err("must not be negative".to_owned()) }
}

/// The rule of the inspection list, as it is told.
const RANKED: &str = "ranked by the greatest kinetic energy of each sphere in a simulation of the layout under the design's impact, \
                      least first: where the wave is weak, small gaps matter most";

impl Build {
    pub fn run(self, common: &Common) -> Result<(), Failure> {
        let design = match AnyDesign::read(&self.design)? {
            AnyDesign::Plane(design) => *design,
            AnyDesign::Space(design) => return self.in_space(common, &design),
        };
        super::asks_equal_spheres(&design, "build")?;
        let read = read_piece(common, &design, &self.layout)?;
        let (layout, subject) = (&read.layout, Subject::from(&read));
        let overrides = self.motion.overrides(common);
        let plan = Plan::new(&design, overrides, &layout.palette)
            .map_err(|error| Failure::of_plan(&design, &overrides, &error))?;
        // Rigs know Verlet only, which asks for a step of its own.
        let verlet = Overrides { integrator: Some(Integrator::Verlet), ..overrides };
        let rig_plan =
            Plan::new(&design, verlet, &layout.palette).map_err(|error| Failure::of_plan(&design, &verlet, &error))?;
        note(common, &format!("inspection list: {}", method(&design, &plan).words()));
        note(common, &format!("the piece in its walls: {}", method(&design, &rig_plan).words()));
        if common.dry_run {
            let alone = arrangement(&layout.sample(), &impact(&design, &plan))?;
            let parts = [
                cost::Part::new("the layout, for the inspection list", 1, Some(alone)),
                // Twice the spheres, and contacts that are searched for.
                cost::Part::new("the whole piece in its walls, a rough guess", 3, Some(12.0 * alone)),
            ];
            return tell(common, &parts);
        }
        let spares = self.spares(common, &design.name)?;
        let place = common.out.clone().unwrap_or_else(|| Path::new("builds").join(&design.name));
        let folder = begin(common, &place)?;
        let piece = Piece::new(&design.name, subject);
        let batch = match &self.sorted {
            Some(path) => Some((path, read_batch(path, &design.own_materials, piece.diameter)?)),
            None => None,
        };

        let begun = Begun::now();
        let evaluation = subject.evaluate(&design, &plan, context())?;
        if let Some(stop) = &evaluation.record.stop {
            return Err(unranked(stop));
        }
        let felt = subject.on_places(&evaluation.record.max_kinetic);
        let list = inspection(&piece, &felt, layout.materials.len());
        let walls = build::in_walls(&design, subject, &rig_plan, context())?;

        let mm = |length: f64| 1e3 * length;
        let frame = Frame::new(&piece, mm(self.clearance), mm(self.wall), mm(self.floor));
        let parts = build::parts(&piece, subject, &design, &spares);
        let mut files = files(&piece, layout, &parts, &frame, &list)?;
        if let Some((path, balls)) = &batch {
            let placing = build::placings(&piece, &list, balls, path)?;
            files.push(("sorted.csv".to_owned(), build::placings_csv(&piece, balls, &placing).into_bytes()));
        }
        let told = json!({
            "format": FORMAT,
            "design": design.name,
            "layout": self.layout.display().to_string(),
            "spheres": piece.spheres.len(),
            "parts": parts,
            "cost": build::total_cost(&parts),
            "spares": spares,
            "frame_mm": { "width": frame.width, "depth": frame.depth, "height": frame.height, "wall": frame.wall, "floor": frame.floor },
            "walls": walls,
            "walls_method": method(&design, &rig_plan),
            "inspection": RANKED,
        });
        files.push(("build.json".to_owned(), pretty(&told).into_bytes()));
        let seeds = [plan.first_seed, 0];
        let mut manifest = begun.manifest(design.file(), method(&design, &plan), design.impact_in_words(), seeds);
        manifest.command = Some(command_line());
        files.push(("manifest.json".to_owned(), pretty(&manifest).into_bytes()));
        hand_over(common, (&place, folder), &files, &told, &(words(&piece, &parts, &frame, &walls) + &spares.words()))
    }

    /// Maps and lists of the layers of a crystal in space, and its frame; the layout alone is simulated, for the inspection list.
    fn in_space(self, common: &Common, design: &SpaceDesign) -> Result<(), Failure> {
        let begun = Begun::now();
        let layout = super::space::read(design, &self.layout)?;
        let overrides = self.motion.overrides(common);
        let plan = Plan::in_space(design, overrides, &layout.palette)
            .map_err(|error| Failure::of_plan(design, &overrides, &error))?;
        note(common, &format!("inspection list: {}", method(design, &plan).words()));
        if common.dry_run {
            let (sample, impact) = part_in_space(design, &plan, &layout);
            let alone = arrangement(&sample, &impact)?;
            return tell(common, &[cost::Part::new("the layout, for the inspection list", 1, Some(alone))]);
        }
        let spares = self.spares(common, &design.name)?;
        let place = common.out.clone().unwrap_or_else(|| Path::new("builds").join(&design.name));
        let folder = begin(common, &place)?;
        let (layers, marks) = Piece::layers(&design.name, &layout);
        let batch = match &self.sorted {
            Some(path) => Some((path, read_batch(path, &design.own_materials, layers[0].diameter)?)),
            None => None,
        };
        let record = evaluate_in_space(design, &layout, &plan, context())?.record;
        if let Some(stop) = &record.stop {
            return Err(unranked(stop));
        }
        let list = build::inspection_of_layers(&layers, &record.max_kinetic);
        let mm = |length: f64| 1e3 * length;
        let block = &layout.lattice;
        let depth = mm(f64::from(block.layers() - 1) * block.layer_spacing());
        let thick = [mm(self.wall), mm(self.floor)];
        let tray = build::Tray::new((&layers, block.outline()), depth, mm(self.clearance), thick);
        let solid = tray.solid();
        let three_mf = solid.three_mf(&design.name).map_err(|error| Failure::input(format!("frame.3mf: {error}")))?;
        let parts = build::parts_in_space(&marks, &layout, |material| design.price(material), &spares);
        let mut files: Vec<(String, Vec<u8>)> = Paper::ALL
            .into_iter()
            .map(|paper| (format!("map-{}.pdf", paper.name()), build::maps_pdf(&design.name, &layers, &marks, paper)))
            .collect();
        files.extend(layers.iter().filter_map(|piece| {
            let Kind::Layer { number, .. } = piece.kind else { return None };
            Some((format!("map-layer-{number}.svg"), build::map_svg(piece).into_bytes()))
        }));
        let spheres: usize = layers.iter().map(|piece| piece.spheres.len()).sum();
        let told = json!({
            "format": FORMAT,
            "design": design.name,
            "layout": self.layout.display().to_string(),
            "spheres": spheres,
            "layers": layers.len(),
            "parts": parts,
            "cost": build::total_cost(&parts),
            "spares": spares,
            "frame_mm": { "width": tray.width, "height": tray.height, "wall": thick[0], "floor": tray.floor },
            "inspection": RANKED,
        });
        let seeds = [plan.first_seed, 0];
        let mut manifest = begun.manifest(design.file(), method(design, &plan), design.impact_in_words(), seeds);
        manifest.command = Some(command_line());
        files.extend([
            ("placement.csv".to_owned(), build::layers_csv(&layers).into_bytes()),
            ("placement.pdf".to_owned(), build::placements_pdf(&design.name, &layers, &marks)),
            ("parts.csv".to_owned(), build::parts_csv(&parts).into_bytes()),
            ("frame.stl".to_owned(), solid.stl(&design.name)),
            ("frame.3mf".to_owned(), three_mf),
            ("inspection.csv".to_owned(), build::layers_inspection_csv(&layers, &list).into_bytes()),
            ("layout-full.csv".to_owned(), write_whole_in_space(&layout).into_bytes()),
            ("build.json".to_owned(), pretty(&told).into_bytes()),
            ("manifest.json".to_owned(), pretty(&manifest).into_bytes()),
        ]);
        if let Some((path, balls)) = &batch {
            let placing = build::placings_of_layers((&layers, &marks), &list, balls, path)?;
            files.push(("sorted.csv".to_owned(), build::layers_placings_csv(&layers, balls, &placing).into_bytes()));
        }
        let diameter = layers.first().map_or(0.0, |layer| layer.diameter);
        let head = format!("{}: {spheres} spheres of {diameter} mm in {} layers", design.name, layers.len());
        let [across, along] = tray.width;
        let frame = format!(
            "\nframe: {across:.2} mm along x and {along:.2} mm along y inside, walls {:.2} mm high\n\
             \nmeasure first: the spheres of inspection.csv, {RANKED}",
            tray.height
        );
        hand_over(common, (&place, folder), &files, &told, &(listed(&head, &parts) + &frame + &spares.words()))
    }

    /// What is ordered besides.
    fn spares(&self, common: &Common, design: &str) -> Result<Spares, Failure> {
        let Some(path) = &self.from_yield else { return Ok(Spares::part(self.spares)) };
        let path = if path.is_dir() { path.join("tolerance.json") } else { path.clone() };
        let text = input::text(&path).map_err(|error| Failure::of_file(&path, None, &error.to_string()))?;
        let help = "granulens tolerance LAYOUT --design DESIGN --out FOLDER writes FOLDER/tolerance.json.";
        let from = Yield::parse(&path, &text).map_err(|message| Failure::input_with_help(message, help))?;
        let [known, layout] = &from.found_for;
        if known != design {
            let message = format!("{}: holds the yield of the design {known}, not of {design}", path.display());
            return Err(Failure::input_with_help(message, help));
        }
        if *layout != self.layout.display().to_string() {
            note(common, &format!("note: the yield was found for {layout}; make sure that it is this layout"));
        }
        Spares::of_yield(self.spares, from).map_err(|message| {
            Failure::input_with_help(message, "Take a finer grade: granulens tolerance --for \"95 %\" says which.")
        })
    }
}

/// What a layout comes to of which a guard stops the run.
fn unranked(stop: &Stop) -> Failure {
    match stop {
        Stop::Interrupted { .. } => Failure::Interrupted("nothing is written".to_owned()),
        stop => Failure::Guard(vec![format!("the layout cannot be ranked: {stop}")]),
    }
}

/// Writes what the workshop gets, and tells of it.
fn hand_over(
    common: &Common,
    (place, folder): (&Path, Folder),
    files: &[(String, Vec<u8>)],
    told: &serde_json::Value,
    words: &str,
) -> Result<(), Failure> {
    for (name, bytes) in files {
        folder.write(name, bytes)?;
    }
    folder.finish()?;
    if common.json {
        emit_json(told);
    } else {
        emit(words);
    }
    note(common, &format!("for the workshop: {}", place.display()));
    Ok(())
}

/// Everything that is drawn or listed, by the name of its file.
fn files(
    piece: &Piece,
    layout: &Layout,
    parts: &[Part],
    frame: &Frame,
    list: &[Inspected],
) -> Result<Vec<(String, Vec<u8>)>, Failure> {
    let solid = frame.solid();
    let three_mf = solid.three_mf(&piece.name).map_err(|error| Failure::input(format!("frame.3mf: {error}")))?;
    let mut files: Vec<(String, Vec<u8>)> = Paper::ALL
        .into_iter()
        .map(|paper| (format!("map-{}.pdf", paper.name()), build::map_pdf(piece, paper)))
        .collect();
    let others: [(&str, Vec<u8>); 9] = [
        ("map.svg", build::map_svg(piece).into_bytes()),
        ("map.dxf", build::dxf(piece).into_bytes()),
        ("placement.csv", build::placement_csv(piece).into_bytes()),
        ("placement.pdf", build::placement_pdf(piece)),
        ("parts.csv", build::parts_csv(parts).into_bytes()),
        ("frame.stl", solid.stl(&piece.name)),
        ("frame.3mf", three_mf),
        ("inspection.csv", build::inspection_csv(piece, list).into_bytes()),
        ("layout-full.csv", write_piece(layout, &piece.spheres).into_bytes()),
    ];
    files.extend(others.map(|(name, bytes)| (name.to_owned(), bytes)));
    Ok(files)
}

fn words(piece: &Piece, parts: &[Part], frame: &Frame, walls: &[WallEffect]) -> String {
    let (count, diameter) = (piece.spheres.len(), piece.diameter);
    let mut text = listed(&format!("{}: {count} spheres of {diameter} mm in {} rows", piece.name, piece.rows), parts);
    text += &format!(
        "\nframe: {:.2} mm between the side walls, {:.2} mm from the centres of row 1 to the end wall, walls {} mm high\n\n\
         | held by | F | P | C |\n|---|---|---|---|\n",
        frame.width, frame.depth, frame.height
    );
    for WallEffect { held, focal_mean, protected_mean, contrast } in walls {
        let contrast = contrast.map_or("-".to_owned(), |contrast| format!("{contrast:.3}"));
        text += &format!("| {held} | {} | {} | {contrast} |\n", Energy.show(*focal_mean), Energy.show(*protected_mean));
    }
    text += &format!("\nmeasure first: the spheres of inspection.csv, {RANKED}");
    text
}

/// The parts below a heading.
fn listed(head: &str, parts: &[Part]) -> String {
    let mut text = format!("{head}\n\n| | material | spheres | spares | mass |\n|---|---|---|---|---|\n");
    for part in parts {
        let Part { letter, material, count, spares, mass_kg, .. } = part;
        text += &format!("| {letter} | {material} | {count} | {spares} | {} |\n", Mass.show(*mass_kg));
    }
    if let Some(cost) = build::total_cost(parts) {
        text += &format!("\ncost with spares {cost:.2}, in the currency of [prices]\n");
    }
    text
}

impl From<BatchError> for Failure {
    fn from(error: BatchError) -> Self {
        Self::input_with_help(error.to_string(), error.help)
    }
}

impl From<HeldError> for Failure {
    fn from(error: HeldError) -> Self {
        match error {
            HeldError::Stopped(RigStop::Interrupted { .. }) => Self::Interrupted("nothing is written".to_owned()),
            HeldError::Stopped(stop) => Self::Guard(vec![format!("the piece in its walls: {stop}")]),
            HeldError::Settle(error) => Self::Guard(vec![error.to_string()]),
            HeldError::Rig(error) => Self::input(error.to_string()),
        }
    }
}
