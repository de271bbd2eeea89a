//! Which sphere of a measured batch goes where.
//!
//! The rule: of each material, the spheres nearest to the nominal diameter go first, in the order of the inspection list, which begins where
//! a deviation matters most; what is left over is farthest from it. How much that wins is measured in `docs/build.md`.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use super::inspection::Inspected;
use super::piece::{Mark, Piece};
use crate::material::{self, Material};

/// A sphere that was measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Ball {
    /// What the workshop calls it; its line in the file where it has no name.
    pub id: String,
    /// Canonical name of its material.
    pub material: String,
    /// Diameter (mm).
    pub diameter: f64,
}

/// What is wrong with a file of measured spheres.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{}:{} {message}", .path.display(), .line.map_or(String::new(), |line| format!("{line}:")))]
pub struct BatchError {
    /// The file.
    pub path: PathBuf,
    /// The line, from 1, where there is one to blame.
    pub line: Option<u64>,
    /// What was wrong, and what was expected.
    pub message: String,
    /// What to try.
    pub help: &'static str,
}

/// Deviation from the nominal diameter beyond which a measurement is taken for a mistake.
const STRANGE: f64 = 0.05;

/// Reads a batch: CSV with the columns `material` and `diameter_mm`, and `id` where spheres have names.
///
/// # Errors
/// See [`BatchError`].
pub fn read_batch(path: &Path, own: &[Material], nominal: f64) -> Result<Vec<Ball>, BatchError> {
    let fail = |line: Option<u64>, message: String, help: &'static str| BatchError {
        path: path.to_owned(),
        line,
        message,
        help,
    };
    const HEAD: &str = "Begin the file with the line id,material,diameter_mm; id may be left out.";
    let mut reader =
        csv::ReaderBuilder::new().comment(Some(b'#')).trim(csv::Trim::All).flexible(true).from_path(path).map_err(
            |error| fail(None, format!("cannot be read: {error}."), "Name a CSV file of measured diameters."),
        )?;
    let header = reader.headers().map_err(|error| fail(None, format!("cannot be read: {error}."), HEAD))?.clone();
    let column = |name: &str| header.iter().position(|head| head.trim_start_matches('\u{feff}') == name);
    let (Some(of_material), Some(of_diameter)) = (column("material"), column("diameter_mm")) else {
        let found = header.iter().collect::<Vec<_>>().join(",");
        return Err(fail(Some(1), format!("the header is \"{found}\", expected material and diameter_mm."), HEAD));
    };
    let of_id = column("id");
    let mut balls: Vec<Ball> = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|error| fail(None, format!("cannot be read: {error}."), HEAD))?;
        let line = record.position().map(csv::Position::line);
        let cell = |k: usize| record.get(k).unwrap_or_default();
        let name = cell(of_material);
        let material = material::find(name, own).map_err(|unknown| {
            let near = unknown.nearest.map_or(String::new(), |near| format!(" Did you mean {near}?"));
            let help = "Name materials as granulens materials lists them, or as [materials.NAME] of the design file.";
            fail(line, format!("material = \"{name}\" is unknown.{near}"), help)
        })?;
        let diameter = cell(of_diameter).parse::<f64>().ok().filter(|d| d.is_finite()).ok_or_else(|| {
            let message = format!("diameter_mm = \"{}\" is not a number.", cell(of_diameter));
            fail(line, message, "Write millimetres without a unit, such as 6.3497.")
        })?;
        if (diameter / nominal - 1.0).abs() > STRANGE {
            let message = format!("diameter_mm = {diameter} is not within 5 % of the design's {nominal} mm.");
            return Err(fail(line, message, "Write millimetres; leave out what belongs to another piece."));
        }
        let id = of_id.map(cell).filter(|id| !id.is_empty());
        let id = id.map_or_else(|| format!("line {}", line.unwrap_or_default()), str::to_owned);
        if balls.iter().any(|ball| ball.id == id) {
            return Err(fail(line, format!("id = \"{id}\" is given twice."), "Give each sphere a name of its own."));
        }
        balls.push(Ball { id, material: material.name, diameter });
    }
    Ok(balls)
}

/// What goes where.
#[derive(Clone, Debug, PartialEq)]
pub struct Placing {
    /// For each sphere of the piece the index of a ball of the batch.
    pub balls: Vec<usize>,
    /// Balls that are not needed.
    pub left: Vec<usize>,
}

/// Places a batch; `path` is only named in messages.
///
/// # Errors
/// The batch has too few spheres of a material.
pub fn placings(piece: &Piece, list: &[Inspected], balls: &[Ball], path: &Path) -> Result<Placing, BatchError> {
    let mut placed = vec![None; piece.spheres.len()];
    let mut left = Vec::new();
    let off = |k: &usize| (balls[*k].diameter - piece.diameter).abs();
    let mut missing = Vec::new();
    for (m, mark) in piece.marks.iter().enumerate() {
        let mut batch: Vec<usize> = (0..balls.len()).filter(|&k| balls[k].material == mark.material).collect();
        batch.sort_by(|a, b| off(a).total_cmp(&off(b)));
        let sites = list.iter().filter(|inspected| usize::from(piece.spheres[inspected.sphere].material) == m);
        if batch.len() < mark.count {
            missing.push(format!("{} of {} {}", mark.count - batch.len(), mark.count, mark.material));
            continue;
        }
        for (inspected, ball) in sites.zip(&batch) {
            placed[inspected.sphere] = Some(*ball);
        }
        left.extend(&batch[mark.count..]);
    }
    if !missing.is_empty() {
        return Err(BatchError {
            path: path.to_owned(),
            line: None,
            message: format!("the piece needs more spheres than were measured: missing are {}.", missing.join(", ")),
            help: "Measure as many of each material as parts.csv counts.",
        });
    }
    let strangers = (0..balls.len()).filter(|&k| piece.marks.iter().all(|mark| mark.material != balls[k].material));
    left.extend(strangers);
    left.sort_unstable();
    Ok(Placing { balls: placed.into_iter().flatten().collect(), left })
}

/// The same of the layers of a crystal in space, whose materials are drawn as `marks`: one list of balls for all of them, layer after layer.
///
/// # Errors
/// As [`placings`].
pub fn placings_of_layers(
    (layers, marks): (&[Piece], &[Mark]),
    list: &[(usize, Inspected)],
    balls: &[Ball],
    path: &Path,
) -> Result<Placing, BatchError> {
    let Some(first) = layers.first() else { return Ok(Placing { balls: Vec::new(), left: Vec::new() }) };
    let mut begins = vec![0];
    for layer in layers {
        begins.push(begins[begins.len() - 1] + layer.spheres.len());
    }
    let spheres = layers.iter().flat_map(|layer| layer.spheres.iter().copied()).collect();
    let whole = Piece { spheres, marks: marks.to_vec(), ..first.clone() };
    let of = |(layer, one): &(usize, Inspected)| Inspected { sphere: begins[*layer] + one.sphere, ..*one };
    placings(&whole, &list.iter().map(of).collect::<Vec<_>>(), balls, path)
}

/// The same as a table, layer after layer as they are laid; then what is left over.
pub fn layers_placings_csv(layers: &[Piece], balls: &[Ball], placing: &Placing) -> String {
    let mut text = "layer,row,column,letter,material,id,diameter_mm,deviation_um\n".to_owned();
    let nominal = layers.first().map_or(0.0, |layer| layer.diameter);
    let off = |ball: &Ball| 1e3 * (ball.diameter - nominal);
    let spheres = layers.iter().flat_map(|layer| layer.spheres.iter().map(move |sphere| (layer, sphere)));
    for ((layer, sphere), ball) in spheres.zip(&placing.balls) {
        let (mark, ball, number) = (layer.mark(sphere), &balls[*ball], layer.number());
        let (row, column, Ball { id, diameter, .. }) = (sphere.row, sphere.column, ball);
        let (letter, material) = (&mark.letter, &mark.material);
        let _ = writeln!(text, "{number},{row},{column},{letter},{material},{id},{diameter},{:.2}", off(ball));
    }
    for ball in placing.left.iter().map(|k| &balls[*k]) {
        let _ = writeln!(text, "left,,,,{},{},{},{:.2}", ball.material, ball.id, ball.diameter, off(ball));
    }
    text
}

/// Every sphere of the piece with its ball, row by row; then what is left over.
pub fn placings_csv(piece: &Piece, balls: &[Ball], placing: &Placing) -> String {
    let mut text = "row,column,letter,material,id,diameter_mm,deviation_um\n".to_owned();
    let off = |ball: &Ball| 1e3 * (ball.diameter - piece.diameter);
    for (sphere, ball) in piece.spheres.iter().zip(&placing.balls) {
        let (mark, ball) = (piece.mark(sphere), &balls[*ball]);
        let (row, column, Ball { id, diameter, .. }) = (sphere.row, sphere.column, ball);
        let _ = writeln!(text, "{row},{column},{},{},{id},{diameter},{:.2}", mark.letter, mark.material, off(ball));
    }
    for ball in placing.left.iter().map(|k| &balls[*k]) {
        let _ = writeln!(text, "left,,,{},{},{},{:.2}", ball.material, ball.id, ball.diameter, off(ball));
    }
    text
}
