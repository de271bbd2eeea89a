//! Layouts in space as CSV: header `layer,column,x,y,z,diameter,material`; SI; lines that start with `#` are comments.
//!
//! Layer 1 is struck, columns count the spheres of a layer's half x ≥ 0 from 1 in order of y, then x; x = y = 0 is the axis of the lens.

use std::fmt::Write as _;
use std::path::Path;

use super::Layout;
use super::error::{LayoutFileError, Source};
use super::read::{EXACT, ROUNDED, START};
use crate::input;
use crate::lattice::{Block, Layered, Outline};
use crate::material::{self, Material};
use crate::output::marked;

const COLUMNS: [&str; 7] = ["layer", "column", "x", "y", "z", "diameter", "material"];

/// The simulated half as CSV text.
pub fn write_in_space(layout: &Layout<Block>) -> String {
    let block = &layout.lattice;
    let [wide, high] = block.cells();
    let mut text = String::from("# granulens layout, format 1; simulated half, x >= 0; lengths in metres\n");
    let _ = writeln!(
        text,
        "# {}, diameter {} m, {} layers of {wide} by {high} cells{}, axis through a sphere of layer {}; layer 1 is struck",
        block.cell().name(),
        block.diameter(),
        block.layers(),
        match block.outline() {
            Outline::All => "",
            Outline::Disk(_) => ", round",
            Outline::Hexagon(_) => ", a hexagon",
        },
        block.axis_layer()
    );
    let _ = writeln!(text, "{}", COLUMNS.join(","));
    for (site, &material) in block.sites().iter().zip(&layout.materials) {
        let ([x, y, z], name) = (site.centre, &layout.palette[usize::from(material)].name);
        let _ = writeln!(text, "{},{},{x},{y},{z},{},{name}", site.layer, site.column, block.diameter());
    }
    marked(text)
}

/// Every sphere of the whole crystal as CSV text: the half and its image; columns are left out, as the half alone has them.
pub fn write_whole_in_space(layout: &Layout<Block>) -> String {
    let block = &layout.lattice;
    let mut text =
        String::from("# granulens layout, format 1; whole crystal; lengths in metres\nlayer,x,y,z,diameter,material\n");
    for ((site, &copies), &material) in block.sites().iter().zip(block.copies()).zip(&layout.materials) {
        let ([x, y, z], name) = (site.centre, &layout.palette[usize::from(material)].name);
        for x in [x, -x].into_iter().take(usize::from(copies)) {
            let _ = writeln!(text, "{},{x},{y},{z},{},{name}", site.layer, block.diameter());
        }
    }
    marked(text)
}

/// Reads the layout of a block's half. Materials are found by name or alias among `own`, then in the library; the palette starts with
/// `palette`, so that host and lens material keep their places.
///
/// # Errors
/// Every way in which the file can differ from the block: missing, double or strange spheres, positions off by more than a thousandth of
/// the diameter, other diameters, unknown materials.
pub fn read_in_space(
    path: &Path,
    block: &Block,
    palette: &[Material],
    own: &[Material],
) -> Result<Layout<Block>, LayoutFileError> {
    let text = input::text(path).map_err(|error| LayoutFileError::of_file(path, format!("{error}."), START))?;
    let source = Source { path, text: &text };
    let mut reader = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .has_headers(false)
        .flexible(true)
        .from_reader(text.as_bytes());
    let mut records = reader.records();
    let begin_of_error = |error: &csv::Error| source.begin(error.position());
    let header = match records.next() {
        Some(record) => record.map_err(|error| source.error(begin_of_error(&error), None, error.to_string()))?,
        None => return Err(LayoutFileError::of_file(path, "holds no lines but comments.".to_owned(), START)),
    };
    if header != COLUMNS[..] {
        let found: Vec<&str> = header.iter().collect();
        let message = format!("the header is \"{}\", expected \"{}\".", found.join(","), COLUMNS.join(","));
        let help = match found.first() {
            Some(&"row") => "That is a layout of a sheet, and the design is a crystal in space.",
            _ => "Name the seven columns in this order; lengths are in metres.",
        };
        return Err(source.error(source.begin(header.position()), None, message).trying(help));
    }
    let mut palette = palette.to_vec();
    let mut given: Vec<Option<(u8, usize)>> = vec![None; block.sites().len()];
    for record in records {
        let record = record.map_err(|error| source.error(begin_of_error(&error), None, error.to_string()))?;
        let at = source.begin(record.position());
        let fail = |key: Option<usize>, message: String| {
            let mut error = source.error(at, None, message);
            error.key = key.map(|key| COLUMNS[key]);
            error
        };
        if record.len() != COLUMNS.len() {
            let message =
                format!("the line has {} values, expected {}: {}.", record.len(), COLUMNS.len(), COLUMNS.join(","));
            return Err(fail(None, message));
        }
        let whole = |k: usize| {
            let message = || format!("{} = \"{}\" is not a whole number from 1 on.", COLUMNS[k], &record[k]);
            record[k].parse::<u32>().map_err(|_| fail(Some(k), message()))
        };
        let (layer, column) = (whole(0)?, whole(1)?);
        let Some(index) = block.index(layer, column) else {
            let extent = match (1..=block.layers()).contains(&layer) {
                true => format!("layer {layer} has columns 1 to {}", block.layer(layer).len()),
                false => format!("there are layers 1 to {}", block.layers()),
            };
            let message = format!("layer {layer}, column {column} is no site of the design's crystal: {extent}.");
            return Err(
                fail(Some(1), message).trying("The file holds the simulated half, x >= 0, of the design's crystal.")
            );
        };
        let [x, y, z] = block.sites()[index].centre;
        for (k, expected) in (2..).zip([x, y, z, block.diameter()]) {
            let value: f64 = record[k].parse().ok().filter(|value: &f64| value.is_finite()).ok_or_else(|| {
                fail(Some(k), format!("{} = \"{}\" is not a number.", COLUMNS[k], &record[k]))
                    .trying("Write lengths in metres, without a unit: 0.00635.")
            })?;
            let allowed = if k == 5 { EXACT } else { ROUNDED };
            if (value - expected).abs() > allowed * block.diameter() {
                let what = if k == 5 { "spheres of" } else { "this site at" };
                let message = format!("{} = {value} m, but the design has {what} {expected} m.", COLUMNS[k]);
                let help = "Positions follow from layer and column, in metres, to 1e-3 D; only the materials are free.";
                return Err(fail(Some(k), message).trying(help));
            }
        }
        let material = material::find(&record[6], own).map_err(|unknown| {
            let near = unknown.nearest.as_ref().map_or(String::new(), |near| format!("Did you mean {near}? "));
            let help =
                format!("{near}Known are {}; own ones are described in the design file.", unknown.known.join(", "));
            fail(Some(6), format!("material = \"{}\" is unknown.", unknown.name)).trying(help)
        })?;
        if let Some((_, earlier)) = given[index] {
            let message =
                format!("layer {layer}, column {column} is given twice, first in line {}.", source.line(earlier));
            return Err(fail(None, message).trying("Keep one of the two lines."));
        }
        let place = palette.iter().position(|m| m.name == material.name).unwrap_or_else(|| {
            palette.push(material);
            palette.len() - 1
        });
        let place =
            u8::try_from(place).map_err(|_| fail(Some(6), "the file names more than 256 materials.".to_owned()))?;
        given[index] = Some((place, at));
    }
    if let Some(first) = given.iter().position(Option::is_none) {
        let count = given.iter().filter(|given| given.is_none()).count();
        let (site, [x, y, z]) = (&block.sites()[first], block.sites()[first].centre);
        let others = if count > 1 { format!(", and {} others", count - 1) } else { String::new() };
        let message = format!("layer {}, column {} is missing{others}.", site.layer, site.column);
        let help = format!("Add {},{},{x},{y},{z},{},MATERIAL.", site.layer, site.column, block.diameter());
        return Err(source.error(source.begin(header.position()), None, message).trying(help));
    }
    let materials = given.into_iter().flatten().map(|(material, _)| material).collect();
    Ok(Layout { lattice: block.clone(), palette, materials })
}
