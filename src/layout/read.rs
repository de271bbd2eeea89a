//! Reading layouts: the simulated half or the whole piece, as CSV, or the half as JSON.

use std::path::Path;

use serde_json::Value;

use super::Layout;
use super::error::{LayoutFileError, Source};
use super::table::{self, Row, START, Table};
use crate::lattice::{HexagonalSheet, Site};
use crate::material::Material;
use crate::units::Dimension::Length;

pub(super) const HEADER: [&str; 6] = ["row", "column", "x", "z", "diameter", "material"];

/// How far a position may lie off its site without a word (diameters): digits that are lost in writing.
pub(super) const EXACT: f64 = 1e-6;
/// How far at most: what spreadsheets lose that show few digits. No two sites lie nearer to each other than half a diameter.
pub(super) const ROUNDED: f64 = 1e-3;

/// A layout that was read, and what should be known of it.
#[derive(Clone, Debug)]
pub struct ReadLayout {
    /// The layout; of a piece of two halves the right one.
    pub layout: Layout,
    /// Where the halves of a whole piece differ the material of every site's image, left of the axis.
    pub left: Option<Vec<u8>>,
    /// Where what was written is not quite what was taken.
    pub notes: Vec<String>,
}

/// One line of the file.
struct Line {
    site: Site,
    /// The index of its site in the simulated half.
    index: usize,
    /// How far off its site it was written (m).
    off: f64,
    material: Material,
}

/// Reads a layout for the given lattice: the simulated half, x >= 0, or the whole piece, whose two halves must be alike. Materials
/// are found by name or alias among `own`, then in the library; the palette starts with `palette`, so that host and lens material
/// keep their places.
///
/// # Errors
/// Every way in which the file can differ from the lattice: missing, double or strange rows, positions off by more than a
/// thousandth of the diameter, other diameters, unknown materials, halves that differ.
pub fn read(
    path: &Path,
    lattice: &HexagonalSheet,
    palette: &[Material],
    own: &[Material],
) -> Result<Layout, LayoutFileError> {
    read_noted(path, lattice, palette, own).map(|read| read.layout)
}

/// The same, with what should be known of it.
///
/// # Errors
/// As [`read`].
pub fn read_noted(
    path: &Path,
    lattice: &HexagonalSheet,
    palette: &[Material],
    own: &[Material],
) -> Result<ReadLayout, LayoutFileError> {
    match find(path, lattice, palette, own)? {
        (_, Some(uneven)) => Err(uneven),
        (read, None) => Ok(read),
    }
}

/// The same of a piece whose halves may differ.
///
/// # Errors
/// As [`read`], but for halves that differ.
pub fn read_piece(
    path: &Path,
    lattice: &HexagonalSheet,
    palette: &[Material],
    own: &[Material],
) -> Result<ReadLayout, LayoutFileError> {
    find(path, lattice, palette, own).map(|(read, _)| read)
}

/// A layout, and what is to be said where only symmetric ones are taken and this one is not.
fn find(
    path: &Path,
    lattice: &HexagonalSheet,
    palette: &[Material],
    own: &[Material],
) -> Result<(ReadLayout, Option<LayoutFileError>), LayoutFileError> {
    let text = table::text(path)?;
    if text.trim_start().starts_with('{') {
        let rows = of_json(&text).map_err(|message| {
            LayoutFileError::of_file(path, message, "A layout as JSON is layout.json of granulens run, or like it.")
        })?;
        // The lines are none of the user's.
        return parse(path, &rows, lattice, palette, own).map_err(|error| {
            LayoutFileError::of_file(path, error.message.clone(), error.help.as_deref().unwrap_or(START))
        });
    }
    parse(path, &text, lattice, palette, own)
}

/// The spheres of a layout in JSON as lines of CSV.
fn of_json(text: &str) -> Result<String, String> {
    let layout: Value = serde_json::from_str(text).map_err(|error| format!("is no JSON: {error}."))?;
    let spheres = layout.get("spheres").and_then(Value::as_array).ok_or("is JSON, but holds no spheres.")?;
    let mut rows = HEADER.join(",") + "\n";
    for (k, sphere) in spheres.iter().enumerate() {
        let cell = |key: &&str| match sphere.get(*key) {
            Some(Value::String(text)) => Ok(text.replace(['\n', '\r', ','], " ")),
            Some(Value::Number(number)) => Ok(number.to_string()),
            _ => Err(format!("spheres[{k}].{key} is missing, or neither number nor text.")),
        };
        rows += &(HEADER.iter().map(cell).collect::<Result<Vec<_>, _>>()?.join(",") + "\n");
    }
    Ok(rows)
}

fn parse(
    path: &Path,
    text: &str,
    lattice: &HexagonalSheet,
    palette: &[Material],
    own: &[Material],
) -> Result<(ReadLayout, Option<LayoutFileError>), LayoutFileError> {
    let source = Source { path, text, columns: &HEADER };
    let table = Table::of(source, |found| {
        if found.concat().contains(';') || found.concat().contains('\t') {
            "Separate the columns by commas."
        } else {
            "Name the six columns in this order; lengths are in metres."
        }
    })?;
    // A sphere clearly left of the axis is in no simulated half.
    let left = |row: Row| row.number(2).is_some_and(|x| x < -0.25 * lattice.diameter());
    let whole = table.rows().any(left);
    let sites = lattice.sites();
    let mut palette = palette.to_vec();
    // The material of each site of the half, and of its image, and where in the text its line begins.
    let mut given: Vec<[Option<(u8, usize)>; 2]> = vec![[None; 2]; sites.len()];
    let (mut snapped, mut farthest) = (0, 0.0);
    for row in table.rows() {
        let Line { site, index, off, material } = line(&row, lattice, &sites, whole, own)?;
        if off > EXACT * lattice.diameter() {
            snapped += 1;
            farthest = f64::max(farthest, off);
        }
        let given = &mut given[index][usize::from(whole && site.x < 0.0)];
        row.is_first(*given, || format!("row {}, column {}", site.row, site.column))?;
        *given = Some((row.place(5, material, &mut palette)?, row.at));
    }
    let header = table.header;
    let halves: &[usize] = if whole { &[0, 1] } else { &[0] };
    for &side in halves {
        // A sphere on the axis has no image.
        let missing = |i: &usize| given[*i][side].is_none() && (side == 0 || sites[*i].x > 0.0);
        let count = (0..sites.len()).filter(missing).count();
        let Some(first) = (0..sites.len()).find(missing) else { continue };
        let Site { row, column, x, z } = sites[first];
        let others = match count - 1 {
            0 => String::new(),
            1 => ", and one other".to_owned(),
            others => format!(", and {others} others"),
        };
        if whole {
            let x = if side == 1 { -x } else { x };
            let message = format!("row {row}, the sphere at x = {x} m is missing{others}.");
            let help = format!(
                "Add {row},COLUMN,{x},{z},{},MATERIAL, or check the simulated half.",
                lattice.row_diameter(row)
            );
            return Err(source.error(header, None, message).trying(help));
        }
        let before = given[..first].iter().rev().find_map(|halves| halves[0]);
        let at = before.map_or(header, |(_, at)| at);
        let message = format!("row {row}, column {column} is missing{others}; it belongs behind this line.");
        let help = format!("Add {row},{column},{x},{z},{},MATERIAL.", lattice.row_diameter(row));
        return Err(source.error(at, None, message).trying(help));
    }
    // A sphere on the axis is its own image.
    let image = |halves: &[Option<(u8, usize)>; 2]| halves[1].or(halves[0]);
    let differs = |halves: &[Option<(u8, usize)>; 2]| {
        image(halves).map(|(material, _)| material) != halves[0].map(|(material, _)| material)
    };
    let differing = given.iter().position(differs);
    let left = differing.map(|_| given.iter().filter_map(image).map(|(material, _)| material).collect());
    let uneven = differing.and_then(|k| {
        let [(right, _), (left, at)] = [given[k][0]?, given[k][1]?];
        let [left, right] = [left, right].map(|place| palette[usize::from(place)].name.clone());
        let site = &sites[k];
        let message = format!(
            "row {}: {left} at x = {} m and {right} at {} m; the halves of the piece are not each other's images.",
            site.row, -site.x, site.x
        );
        let help = "granulens check, compare, diff, report, build and tolerance take such a piece whole; this command takes the half x >= 0 for both: \
                    make them alike.";
        Some(source.error(at, Some(5), message).trying(help))
    });
    let materials = given.into_iter().filter_map(|halves| halves[0]).map(|(material, _)| material).collect();
    let mut notes = Vec::new();
    if snapped > 0 {
        let (spheres, lie) = if snapped == 1 { ("sphere", "lies") } else { ("spheres", "lie") };
        notes.push(format!(
            "{}: {snapped} {spheres} {lie} up to {} ({:.1e} D) off, as rounding makes them, and are taken for those of the sites",
            path.display(),
            Length.show(farthest),
            farthest / lattice.diameter(),
        ));
    }
    Ok((ReadLayout { layout: Layout { lattice: lattice.clone(), palette, materials }, left, notes }, uneven))
}

/// Where in the simulated half the sphere of a row and column of the whole piece is, and whether it is left of the axis there.
fn folded(lattice: &HexagonalSheet, sites: &[Site], row: u32, column: u32) -> Option<(usize, bool)> {
    let first = lattice.index(row, 1)?;
    let half = lattice.columns(row);
    let on_axis = sites[first].x == 0.0;
    let left = if on_axis { half - 1 } else { half };
    let (column, is_left) = if column > left { (column - left, false) } else { (left + 1 - column, true) };
    let column = column + u32::from(on_axis && is_left);
    Some((lattice.index(row, column)?, is_left))
}

/// Reads one line.
fn line(
    row: &Row<'_>,
    lattice: &HexagonalSheet,
    sites: &[Site],
    is_whole: bool,
    own: &[Material],
) -> Result<Line, LayoutFileError> {
    row.check()?;
    let (number, column) = (row.whole(0)?, row.whole(1)?);
    let lengths = [row.length(2)?, row.length(3)?, row.length(4)?];
    let extent_help = match is_whole {
        true => {
            "The file holds the whole piece, both halves, as it has spheres left of the axis; columns count from the left."
        }
        false => "The file holds the simulated half, x >= 0, not the whole piece (granulens design without --full).",
    };
    let known = if is_whole {
        folded(lattice, sites, number, column)
    } else {
        lattice.index(number, column).map(|index| (index, false))
    };
    let (index, is_left) = known.ok_or_else(|| {
        let (key, extent) = if (1..=lattice.rows()).contains(&number) {
            let half = lattice.columns(number);
            let on_axis = lattice.index(number, 1).is_some_and(|first| sites[first].x == 0.0);
            let columns = if is_whole { 2 * half - u32::from(on_axis) } else { half };
            (1, format!("row {number} has columns 1 to {columns}"))
        } else {
            (0, format!("there are rows 1 to {}", lattice.rows()))
        };
        let message = format!("row {number}, column {column} is no site of the design's lattice: {extent}.");
        row.fail(Some(key), message).trying(extent_help)
    })?;
    let mut site = sites[index];
    if is_left {
        site.x = -site.x;
    }
    site.column = column;
    let mut off: f64 = 0.0;
    for (k, (value, expected)) in (2..).zip(lengths.into_iter().zip([site.x, site.z, lattice.row_diameter(number)])) {
        let (part, what) = if k == 4 { (EXACT, "spheres of") } else { (ROUNDED, "this site at") };
        let help = match k {
            2 if value < 0.0 => extent_help,
            4 => "Diameters are those of the design file, crystal.diameter or crystal.diameters, to 1e-6.",
            _ => "Positions follow from row and column, in metres, to 1e-3 D; only the materials are free.",
        };
        off = off.max(row.off(k, (value, expected), part * lattice.diameter(), (what, help))?);
    }
    Ok(Line { site, index, off, material: row.material(5, own)? })
}
