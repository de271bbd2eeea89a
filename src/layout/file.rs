//! Layouts as CSV: one line per sphere, enough to build the piece.
//!
//! Header `row,column,x,z,diameter,material`; SI; lines that start with `#` are comments. Row 1 is struck, columns count
//! from 1 in order of x, x = 0 is the lens axis, z = 0 is row 1.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use serde_json::json;

use super::Layout;
use crate::lattice::HexagonalSheet;
use crate::material::{self, Material};

const HEADER: [&str; 6] = ["row", "column", "x", "z", "diameter", "material"];

/// The layout's format number, written in the first comment line.
const FORMAT: u32 = 1;

/// Why a layout file was refused.
#[derive(Debug, thiserror::Error)]
#[error("{}{}: {message}", .path.display(), .line.map_or(String::new(), |line| format!(":{line}")))]
pub struct LayoutFileError {
    /// The file.
    pub path: PathBuf,
    /// The line, from 1, where there is one to blame.
    pub line: Option<u64>,
    /// What was wrong, what was expected, and what to try.
    pub message: String,
}

/// The simulated half as CSV text.
pub fn write(layout: &Layout) -> String {
    let mut text = preamble(layout, "simulated half, x >= 0");
    for (site, &material) in layout.lattice.sites().iter().zip(&layout.materials) {
        line(&mut text, [site.row, site.column], site.x, site.z, layout, material);
    }
    text
}

/// The whole piece as CSV text: the simulated half and its mirror image about the axis, columns counted anew from the left.
pub fn write_full(layout: &Layout) -> String {
    let mut text = preamble(layout, "whole piece, both halves");
    let sites = layout.lattice.sites();
    for row in 1..=layout.lattice.rows() {
        let half: Vec<_> = sites.iter().zip(&layout.materials).filter(|(site, _)| site.row == row).collect();
        let mirrored = half.iter().rev().filter(|(site, _)| site.x > 0.0).map(|&(site, &m)| (-site.x, site.z, m));
        let whole = mirrored.chain(half.iter().map(|&(site, &m)| (site.x, site.z, m)));
        for (column, (x, z, material)) in (1..).zip(whole) {
            line(&mut text, [row, column], x, z, layout, material);
        }
    }
    text
}

fn preamble(layout: &Layout, extent: &str) -> String {
    let lattice = layout.lattice;
    let mut text = format!("# granulens layout, format {FORMAT}; {extent}; lengths in metres\n");
    let _ = writeln!(
        text,
        "# hexagonal-2d, diameter {} m, {} rows, half width {} m; row 1 is struck, x = 0 is the lens axis",
        lattice.diameter(),
        lattice.rows(),
        lattice.half_width()
    );
    text.push_str(&HEADER.join(","));
    text.push('\n');
    text
}

fn line(text: &mut String, [row, column]: [u32; 2], x: f64, z: f64, layout: &Layout, material: u8) {
    let name = &layout.palette[usize::from(material)].name;
    let _ = writeln!(text, "{row},{column},{x},{z},{},{name}", layout.lattice.diameter());
}

/// The simulated half as JSON text: the same columns as the CSV.
pub fn write_json(layout: &Layout) -> String {
    let lattice = layout.lattice;
    let spheres = lattice.sites().into_iter().zip(&layout.materials).map(|(site, &material)| {
        json!({
            "row": site.row, "column": site.column, "x": site.x, "z": site.z,
            "diameter": lattice.diameter(), "material": layout.palette[usize::from(material)].name,
        })
    });
    let layout = json!({
        "format": FORMAT, "packing": "hexagonal-2d", "diameter_m": lattice.diameter(), "rows": lattice.rows(),
        "half_width_m": lattice.half_width(), "spheres": spheres.collect::<Vec<_>>(),
    });
    format!("{layout:#}\n")
}

/// Reads a layout of the simulated half for the given lattice. Materials are found among `own`, then in the library; the
/// palette starts with `palette`, so that host and lens material keep their places.
///
/// # Errors
/// Every way in which the file can differ from the lattice: missing, double or strange rows, positions or diameters off by
/// more than 10⁻⁶ D, unknown materials.
pub fn read(
    path: &Path,
    lattice: HexagonalSheet,
    palette: &[Material],
    own: &[Material],
) -> Result<Layout, LayoutFileError> {
    let fail = |line: Option<u64>, message: String| LayoutFileError { path: path.to_owned(), line, message };
    let bytes = std::fs::read(path).map_err(|error| fail(None, format!("cannot be read: {error}")))?;
    let text = String::from_utf8(bytes).map_err(|error| {
        fail(None, format!("is not UTF-8 text after byte {}; a layout is CSV", error.utf8_error().valid_up_to()))
    })?;
    let mut reader = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .has_headers(false)
        .flexible(true)
        .from_reader(text.as_bytes());
    let mut records = reader.records();
    let found: Vec<String> = match records.next() {
        Some(Ok(record)) => record.iter().map(str::to_owned).collect(),
        Some(Err(error)) => return Err(fail(None, error.to_string())),
        None => return Err(fail(None, format!("holds no lines; expected the header {}", HEADER.join(",")))),
    };
    if found != HEADER {
        return Err(fail(None, format!("header is \"{}\", expected \"{}\"", found.join(","), HEADER.join(","))));
    }

    let sites = lattice.sites();
    let mut palette = palette.to_vec();
    let mut materials: Vec<Option<(u8, u64)>> = vec![None; sites.len()];
    for record in records {
        let record = record.map_err(|error| fail(error.position().map(csv::Position::line), error.to_string()))?;
        let at = record.position().map(csv::Position::line);
        if record.len() != HEADER.len() {
            return Err(fail(
                at,
                format!("has {} values, expected {} ({})", record.len(), HEADER.len(), HEADER.join(",")),
            ));
        }
        let whole = |k: usize| {
            record[k]
                .parse::<u32>()
                .map_err(|_| fail(at, format!("{} = \"{}\" is not a whole number", HEADER[k], &record[k])))
        };
        let (row, column) = (whole(0)?, whole(1)?);
        let index = lattice.index(row, column).ok_or_else(|| {
            let extent = if (1..=lattice.rows()).contains(&row) {
                format!("row {row} has columns 1 to {}", lattice.columns(row))
            } else {
                format!("the design has rows 1 to {}", lattice.rows())
            };
            fail(
                at,
                format!("row {row}, column {column} is no site of the design's lattice: {extent} (simulated half)"),
            )
        })?;
        let site = sites[index];
        for (k, expected) in [(2, site.x), (3, site.z), (4, lattice.diameter())] {
            let value: f64 = record[k]
                .parse()
                .map_err(|_| fail(at, format!("{} = \"{}\" is not a number in metres", HEADER[k], &record[k])))?;
            let off = (value - expected).abs();
            if off.is_nan() || off > 1e-6 * lattice.diameter() {
                return Err(fail(
                    at,
                    format!(
                        "{} = {value} m, but the design's lattice has {expected} m there (they may differ by 1e-6 D)",
                        HEADER[k]
                    ),
                ));
            }
        }
        if let Some((_, earlier)) = materials[index] {
            return Err(fail(at, format!("row {row}, column {column} is given twice, first in line {earlier}")));
        }
        let material = material::find(&record[5], own).map_err(|error| fail(at, error.to_string()))?;
        let place = palette.iter().position(|m| m.name == material.name).unwrap_or_else(|| {
            palette.push(material);
            palette.len() - 1
        });
        let place = u8::try_from(place).map_err(|_| fail(at, "names more than 256 materials".to_owned()))?;
        materials[index] = Some((place, at.unwrap_or(0)));
    }
    if let Some(missing) = materials.iter().position(Option::is_none) {
        let left = materials.iter().filter(|m| m.is_none()).count();
        let site = sites[missing];
        return Err(fail(
            None,
            format!("row {}, column {} is missing ({left} of {} sites are)", site.row, site.column, sites.len()),
        ));
    }
    Ok(Layout { lattice, palette, materials: materials.into_iter().flatten().map(|(material, _)| material).collect() })
}
