//! The lattice that a layout file was written for, found from its lines: for who compares files without a design.

use std::path::Path;

use super::LayoutFileError;
use super::read::HEADER;
use crate::lattice::{HexagonalSheet, SheetPacking};

/// The smallest lattice that holds every line of a layout file of the simulated half; [`read`](super::read) then checks the file
/// against it, line by line.
///
/// # Errors
/// A file that cannot be read, or whose numbers are those of no lattice.
pub fn lattice_of(path: &Path) -> Result<HexagonalSheet, LayoutFileError> {
    let fail = |message: String| {
        let help = "Begin with a layout that granulens wrote, or name the design with --design DESIGN.toml.";
        LayoutFileError::of_file(path, message, help)
    };
    let mut reader = csv::ReaderBuilder::new()
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .has_headers(false)
        .flexible(true)
        .from_path(path)
        .map_err(|error| fail(format!("cannot be read: {error}.")))?;
    let (mut rows, mut far, mut diameter) = (0_u32, 0.0_f64, None);
    // In square packing the second row begins on the axis too.
    let mut packing = SheetPacking::Hexagonal;
    for record in reader.records().skip(1) {
        let record = record.map_err(|error| fail(format!("cannot be read: {error}.")))?;
        let number = |k: usize| record.get(k).and_then(|cell| cell.parse::<f64>().ok()).filter(|x| x.is_finite());
        let (Some(row), Some(x), Some(d)) = (number(0), number(2), number(4)) else {
            let line = record.position().map_or(0, csv::Position::line);
            let wanted = HEADER.join(",");
            return Err(fail(format!("line {line} is not {wanted} in numbers and metres.")));
        };
        // As exact as layouts are read.
        if (d / *diameter.get_or_insert(d) - 1.0).abs() > 1e-6 {
            return Err(fail("has rows of several diameters, which only a design can lay.".to_owned()));
        }
        if row == 2.0 && x.abs() < 0.25 * d {
            packing = SheetPacking::Square;
        }
        rows = rows.max(row as u32);
        far = far.max(x);
    }
    let diameter = diameter.ok_or_else(|| fail("holds no spheres.".to_owned()))?;
    // Mirror lines lie at whole or half diameters, and the outermost sphere of one of two rows on the far one.
    let half_width = (2.0 * far / diameter).round() / 2.0;
    HexagonalSheet::packed(packing, diameter, rows, half_width)
        .map_err(|error| fail(format!("its lines are those of no sheet: {error}.")))
}
