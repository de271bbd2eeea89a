//! Quantities over time, and tables in CSV files.

use std::path::Path;

use super::file::PulseKeys;
use crate::dem::rig::Curve;
use crate::document::{DocumentError, Scope};
use crate::units::Dimension;

/// A pulse of force or velocity; `column` is what its table calls the value.
pub(super) fn pulse(
    scope: &Scope,
    keys: PulseKeys,
    dimension: Dimension,
    column: &str,
) -> Result<Curve, DocumentError> {
    #[derive(Clone, Copy, PartialEq)]
    enum Shape {
        Square,
        HalfSine,
        Triangle,
        Table,
    }
    let known = [
        ("square", Shape::Square),
        ("half-sine", Shape::HalfSine),
        ("triangle", Shape::Triangle),
        ("table", Shape::Table),
    ];
    let entry = scope.required("pulse", keys.pulse)?;
    let shape = entry.choice("shape of a pulse", &known)?;
    if shape == Shape::Table {
        for (name, written) in [("peak", keys.peak), ("start", keys.start), ("duration", keys.duration)] {
            if let Some(entry) = scope.optional(name, written) {
                return Err(entry.fail("has no meaning for pulse = \"table\"", "The file says all; leave it out."));
            }
        }
        let file = scope.required("file", keys.file)?;
        let path = file.path()?;
        let points = table(&path, ["time_s", column])?;
        return Curve::table(&points).map_err(|error| of_table(&path, &error.to_string()));
    }
    if let Some(entry) = scope.optional("file", keys.file) {
        return Err(entry.fail("has no meaning for this shape", "Write pulse = \"table\", or leave it out."));
    }
    let peak = scope.required("peak", keys.peak)?.quantity(dimension)?;
    let start = match scope.optional("start", keys.start) {
        Some(entry) => match entry.quantity(Dimension::Time)? {
            start if start < 0.0 => return Err(entry.refuse("must not lie before the run begins")),
            start => start,
        },
        None => 0.0,
    };
    let duration = scope.required("duration", keys.duration)?.positive(Dimension::Time)?;
    Ok(match shape {
        Shape::Square => Curve::Square { peak, start, duration },
        Shape::HalfSine => Curve::HalfSine { peak, start, duration },
        _ => Curve::Triangle { peak, start, duration },
    })
}

/// A complaint about a table as a whole.
pub(super) fn of_table(path: &Path, message: &str) -> DocumentError {
    DocumentError::of_file(path, format!("{message}."), "See docs/simulate.md for how tables are written.".to_owned())
}

/// Two columns of numbers below a header that names them; lines that begin with # are comments.
pub(super) fn table(path: &Path, columns: [&str; 2]) -> Result<Vec<(f64, f64)>, DocumentError> {
    let text = crate::document::text(path)?;
    let header = columns.join(",");
    let fail = |line: usize, message: String| {
        let help = format!("The file begins with the line {header}; numbers are in these units.");
        let mut error = DocumentError::of_file(path, message, help);
        error.line = Some(line);
        error
    };
    let mut lines =
        (1..).zip(text.lines()).map(|(number, line)| (number, line.trim())).filter(|(_, line)| !is_comment(line));
    match lines.next() {
        Some((_, first)) if first.replace(' ', "") == header => {}
        Some((line, first)) => return Err(fail(line, format!("\"{first}\" is not the header {header}."))),
        None => return Err(fail(1, "holds no lines.".to_owned())),
    }
    lines
        .map(|(line, text)| {
            let cells: Vec<&str> = text.split(',').map(str::trim).collect();
            let [a, b] = cells.as_slice() else {
                return Err(fail(line, format!("has {} values, expected 2.", cells.len())));
            };
            let number = |cell: &str, column: &str| {
                let value = cell.parse().ok().filter(|value: &f64| value.is_finite());
                value.ok_or_else(|| fail(line, format!("{column} = \"{cell}\" is not a finite number.")))
            };
            Ok((number(a, columns[0])?, number(b, columns[1])?))
        })
        .collect()
}

/// A displacement over time, from a table, as the velocity that it prescribes.
pub(super) fn path(scope: &Scope, keys: PulseKeys) -> Result<Curve, DocumentError> {
    let entry = scope.required("pulse", keys.pulse)?;
    entry.choice("way to prescribe a displacement", &[("table", ())])?;
    for (name, written) in [("peak", keys.peak), ("start", keys.start), ("duration", keys.duration)] {
        if let Some(entry) = scope.optional(name, written) {
            return Err(entry.fail("has no meaning for pulse = \"table\"", "The file says all; leave it out."));
        }
    }
    let path = scope.required("file", keys.file)?.path()?;
    let points = table(&path, ["time_s", "displacement_m"])?;
    Curve::path(&points).map_err(|error| of_table(&path, &error.to_string()))
}

fn is_comment(line: &str) -> bool {
    line.is_empty() || line.starts_with('#')
}
