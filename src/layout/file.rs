//! Layouts as CSV: one line per sphere, enough to build the piece.
//!
//! Header `row,column,x,z,diameter,material`; SI; lines that start with `#` are comments. Row 1 is struck, columns count
//! from 1 in order of x, x = 0 is the lens axis, z = 0 is row 1.

use std::fmt::{self, Write as _};
use std::io::ErrorKind;
use std::ops::Range;
use std::path::{Path, PathBuf};

use miette::{LabeledSpan, NamedSource, SourceCode};
use serde_json::json;

use super::Layout;
use crate::lattice::{HexagonalSheet, Site};
use crate::material::{self, Material};

const HEADER: [&str; 6] = ["row", "column", "x", "z", "diameter", "material"];

/// The layout's format number, written in the first comment line.
const FORMAT: u32 = 1;

/// Why a layout file was refused. Shown in one line, as `FILE:LINE: WHAT`; what to try is in `help`.
#[derive(Debug, thiserror::Error)]
#[error("{}:{} {message}", .path.display(), .line.map_or(String::new(), |line| format!("{line}:")))]
pub struct LayoutFileError {
    /// The file.
    pub path: PathBuf,
    /// The line, from 1, where there is one to blame.
    pub line: Option<u64>,
    /// The column of the table, where there is one to blame.
    pub key: Option<&'static str>,
    /// What was wrong, and what was expected.
    pub message: String,
    /// What to try.
    pub help: Option<String>,
    excerpt: Option<Box<Excerpt>>,
}

/// The text with the line in it.
#[derive(Debug)]
struct Excerpt {
    text: NamedSource<String>,
    place: Range<usize>,
}

impl miette::Diagnostic for LayoutFileError {
    fn help(&self) -> Option<Box<dyn fmt::Display + '_>> {
        self.help.as_ref().map(|help| Box::new(help) as Box<dyn fmt::Display>)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.excerpt.as_ref().map(|excerpt| &excerpt.text as &dyn SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let place = self.excerpt.as_ref()?.place.clone();
        Some(Box::new(std::iter::once(LabeledSpan::new(Some("here".to_owned()), place.start, place.len()))))
    }
}

impl LayoutFileError {
    fn of_file(path: &Path, message: String, help: &str) -> Self {
        Self { path: path.to_owned(), line: None, key: None, message, help: Some(help.to_owned()), excerpt: None }
    }

    fn trying(self, help: impl Into<String>) -> Self {
        Self { help: Some(help.into()), ..self }
    }
}

/// The text that a layout is read from: what every complaint points into.
#[derive(Clone, Copy)]
struct Source<'a> {
    path: &'a Path,
    text: &'a str,
}

impl Source<'_> {
    /// A complaint about the line that holds the byte `at`, or about one of its columns.
    fn error(&self, at: usize, key: Option<usize>, message: String) -> LayoutFileError {
        let line = self.text[at..].lines().next().unwrap_or_default().trim_end();
        // The cell, where commas separate cells only.
        let mut cells = line.split(',').scan(at, |begin, cell| {
            let place = *begin..*begin + cell.len();
            *begin = place.end + 1;
            Some(place)
        });
        let place = key.and_then(|key| cells.nth(key)).filter(|cell| !cell.is_empty());
        LayoutFileError {
            path: self.path.to_owned(),
            line: Some(self.line(at)),
            key: key.map(|key| HEADER[key]),
            message,
            help: None,
            excerpt: Some(Box::new(Excerpt {
                text: NamedSource::new(self.path.display().to_string(), self.text.to_owned()),
                place: place.unwrap_or(at..at + line.len()),
            })),
        }
    }

    /// The line, from 1, of the byte `at`.
    fn line(&self, at: usize) -> u64 {
        self.text[..at].bytes().filter(|&byte| byte == b'\n').count() as u64 + 1
    }

    /// Where a record begins: the reader gives the place behind the record before, which may be a comment or blank.
    fn begin(&self, position: Option<&csv::Position>) -> usize {
        let mut at = position.map_or(0, |position| position.byte() as usize).min(self.text.len());
        for line in self.text[at..].split_inclusive('\n') {
            if !line.starts_with('#') && !line.trim().is_empty() {
                break;
            }
            at += line.len();
        }
        at
    }
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
    let bytes = std::fs::read(path).map_err(|error| match error.kind() {
        ErrorKind::NotFound => LayoutFileError::of_file(path, "no such file.".to_owned(), START),
        _ => LayoutFileError::of_file(path, format!("cannot be read: {error}."), START),
    })?;
    let text = String::from_utf8(bytes).map_err(|error| {
        let message = format!("is no UTF-8 text from byte {} on.", error.utf8_error().valid_up_to());
        LayoutFileError::of_file(path, message, "Save it as CSV in UTF-8.")
    })?;
    // Some spreadsheets begin UTF-8 text with a byte order mark.
    let text = text.strip_prefix('\u{feff}').unwrap_or(&text);
    let source = Source { path, text };
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
    if header != HEADER[..] {
        let found: Vec<&str> = header.iter().collect();
        let message = format!("the header is \"{}\", expected \"{}\".", found.join(","), HEADER.join(","));
        let help = if found.concat().contains(';') || found.concat().contains('\t') {
            "Separate the columns by commas."
        } else {
            "Name the six columns in this order; lengths are in metres."
        };
        return Err(source.error(source.begin(header.position()), None, message).trying(help));
    }

    let sites = lattice.sites();
    let mut palette = palette.to_vec();
    // The material of each site, and where in the text its line begins.
    let mut given: Vec<Option<(u8, usize)>> = vec![None; sites.len()];
    for record in records {
        let record = record.map_err(|error| source.error(begin_of_error(&error), None, error.to_string()))?;
        let at = source.begin(record.position());
        let (index, material) = sphere(&record, lattice, &sites, own, |key, message| source.error(at, key, message))?;
        if let Some((_, earlier)) = given[index] {
            let Site { row, column, .. } = sites[index];
            let message = format!("row {row}, column {column} is given twice, first in line {}.", source.line(earlier));
            return Err(source.error(at, None, message).trying("Keep one of the two lines."));
        }
        let place = palette.iter().position(|m| m.name == material.name).unwrap_or_else(|| {
            palette.push(material);
            palette.len() - 1
        });
        let place = u8::try_from(place)
            .map_err(|_| source.error(at, Some(5), "the file names more than 256 materials.".to_owned()))?;
        given[index] = Some((place, at));
    }
    if let Some(missing) = given.iter().position(Option::is_none) {
        let Site { row, column, .. } = sites[missing];
        let others = match given.iter().filter(|m| m.is_none()).count() - 1 {
            0 => String::new(),
            1 => ", and one other".to_owned(),
            others => format!(", and {others} others"),
        };
        let before = given[..missing].iter().rev().flatten().next();
        let at = before.map_or(source.begin(header.position()), |&(_, at)| at);
        let message = format!("row {row}, column {column} is missing{others}; it belongs behind this line.");
        let site = &sites[missing];
        let help = format!("Add {row},{column},{},{},{},MATERIAL.", site.x, site.z, lattice.diameter());
        return Err(source.error(at, None, message).trying(help));
    }
    Ok(Layout { lattice, palette, materials: given.into_iter().flatten().map(|(material, _)| material).collect() })
}

/// How to come by a layout to begin with.
const START: &str = "Begin with a proposed layout: granulens design DESIGN.toml --out LAYOUT.csv.";

/// Reads one line: the index of its site in the lattice's order, and its material.
fn sphere(
    record: &csv::StringRecord,
    lattice: HexagonalSheet,
    sites: &[Site],
    own: &[Material],
    fail: impl Fn(Option<usize>, String) -> LayoutFileError,
) -> Result<(usize, Material), LayoutFileError> {
    if record.len() != HEADER.len() {
        let values = if record.len() == 1 { "1 value".to_owned() } else { format!("{} values", record.len()) };
        return Err(fail(None, format!("the line has {values}, expected {}: {}.", HEADER.len(), HEADER.join(","))));
    }
    let whole = |k: usize| {
        record[k]
            .parse::<u32>()
            .map_err(|_| fail(Some(k), format!("{} = \"{}\" is not a whole number from 1 on.", HEADER[k], &record[k])))
    };
    let length = |k: usize| {
        record[k].parse().ok().filter(|value: &f64| value.is_finite()).ok_or_else(|| {
            fail(Some(k), format!("{} = \"{}\" is not a number.", HEADER[k], &record[k]))
                .trying("Write lengths in metres, without a unit: 0.00635.")
        })
    };
    let (row, column) = (whole(0)?, whole(1)?);
    let lengths = [length(2)?, length(3)?, length(4)?];
    let simulated_half =
        "The file holds the simulated half, x >= 0, not the whole piece (granulens design without --full).";
    let index = lattice.index(row, column).ok_or_else(|| {
        let (key, extent) = if (1..=lattice.rows()).contains(&row) {
            (1, format!("row {row} has columns 1 to {}", lattice.columns(row)))
        } else {
            (0, format!("there are rows 1 to {}", lattice.rows()))
        };
        let message = format!("row {row}, column {column} is no site of the design's lattice: {extent}.");
        fail(Some(key), message).trying(simulated_half)
    })?;
    let site = sites[index];
    for (k, (value, expected)) in (2..).zip(lengths.into_iter().zip([site.x, site.z, lattice.diameter()])) {
        if (value - expected).abs() > 1e-6 * lattice.diameter() {
            let what = if k == 4 { "spheres of" } else { "this site at" };
            let message = format!("{} = {value} m, but the design has {what} {expected} m.", HEADER[k]);
            let help = match k {
                2 if value < 0.0 => simulated_half,
                4 => "One crystal has one diameter, crystal.diameter of the design file, to 1e-6 of it.",
                _ => "Positions follow from row and column, in metres, to 1e-6 D; only the materials are free.",
            };
            return Err(fail(Some(k), message).trying(help));
        }
    }
    let material = material::find(&record[5], own).map_err(|unknown| {
        let near = unknown.nearest.as_ref().map_or(String::new(), |near| format!("Did you mean {near}? "));
        let help = format!(
            "{near}Known are {}; own ones are described in the design file, as [materials.NAME].",
            unknown.known.join(", ")
        );
        fail(Some(5), format!("material = \"{}\" is unknown.", unknown.name)).trying(help)
    })?;
    Ok((index, material))
}
