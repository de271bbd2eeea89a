//! Prepared beds as files, so that settling is paid for once.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use super::{Bed, Disk};
use crate::input::{self, Unreadable};
use crate::output::{self, OutputError};

/// A file that is no bed, or could not be read or written.
#[derive(Debug, thiserror::Error)]
pub enum StoreError {
    /// Reading failed.
    #[error("{path}: {error}")]
    File {
        /// Which file.
        path: PathBuf,
        /// Why.
        error: Unreadable,
    },
    /// Writing failed.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// A line that cannot be understood.
    #[error("{path}:{line}: {reason}")]
    Line {
        /// Which file.
        path: PathBuf,
        /// Line, from 1.
        line: usize,
        /// What is wrong.
        reason: String,
    },
}

const HEADER: &str = "kind,x_d,y_d,diameter_d";

/// Writes a bed: `#` lines with width and sides and with `notes`, then a line per disk. The file appears when it is complete.
///
/// # Errors
/// See [`StoreError`].
pub fn write(path: &Path, bed: &Bed, notes: &str) -> Result<(), StoreError> {
    let mut text = String::new();
    for note in notes.lines() {
        let _ = writeln!(text, "# {note}");
    }
    let sides = if bed.periodic { "periodic" } else { "walls" };
    // `{:?}` writes the shortest number that reads back as the same.
    let _ = writeln!(text, "# width {:?} d, sides {sides}\n{HEADER}", bed.width);
    for (kind, disks) in [("grain", &bed.grains), ("wall", &bed.walls)] {
        for Disk { centre: [x, y], diameter } in disks {
            let _ = writeln!(text, "{kind},{x:?},{y:?},{diameter:?}");
        }
    }
    Ok(output::keep(path, output::marked(text).as_bytes())?)
}

/// Reads a bed.
///
/// # Errors
/// See [`StoreError`].
pub fn read(path: &Path) -> Result<Bed, StoreError> {
    let text = input::text(path).map_err(|error| StoreError::File { path: path.to_owned(), error })?;
    let wrong = |line: usize, reason: String| StoreError::Line { path: path.to_owned(), line: line + 1, reason };
    let mut bed = Bed { grains: Vec::new(), walls: Vec::new(), width: f64::NAN, periodic: false };
    let mut headed = false;
    for (n, line) in text.lines().enumerate() {
        if let Some(note) = line.strip_prefix("# width ") {
            let (width, sides) = note
                .split_once(" d, sides ")
                .ok_or_else(|| wrong(n, "the width is written like `# width 100.0 d, sides periodic`".to_owned()))?;
            bed.width = width.parse().map_err(|_| wrong(n, format!("the width {width} is no number")))?;
            bed.periodic = match sides {
                "periodic" => true,
                "walls" => false,
                _ => return Err(wrong(n, format!("sides {sides} are not known; they are periodic or walls"))),
            };
        } else if line.starts_with('#') || line.trim().is_empty() {
        } else if !headed {
            if line.trim() != HEADER {
                return Err(wrong(n, format!("the first line of the table must be {HEADER}")));
            }
            headed = true;
        } else {
            let cells: Vec<&str> = line.split(',').map(str::trim).collect();
            let [kind, x, y, diameter] = cells[..] else {
                return Err(wrong(n, format!("a disk has four values ({HEADER}), this line has {}", cells.len())));
            };
            let number = |text: &str, what: &str| {
                text.parse::<f64>()
                    .ok()
                    .filter(|x| x.is_finite())
                    .ok_or_else(|| wrong(n, format!("{what} = {text} is no finite number")))
            };
            let disk =
                Disk { centre: [number(x, "x_d")?, number(y, "y_d")?], diameter: number(diameter, "diameter_d")? };
            if disk.diameter <= 0.0 {
                return Err(wrong(n, format!("diameter_d = {diameter} must be positive")));
            }
            match kind {
                "grain" => bed.grains.push(disk),
                "wall" => bed.walls.push(disk),
                _ => return Err(wrong(n, format!("kind {kind} is not known; disks are grain or wall"))),
            }
        }
    }
    if bed.width.is_nan() || bed.width <= 0.0 {
        return Err(wrong(0, "the line `# width ... d, sides ...` is missing".to_owned()));
    }
    if bed.grains.is_empty() {
        return Err(wrong(0, "the file holds no grains".to_owned()));
    }
    Ok(bed)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bed::{Packing, Pile, Sides};

    #[test]
    fn a_bed_reads_back_as_it_was_written_and_faults_are_named() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("deep/bed.csv");
        let pile =
            Pile { packing: Packing::Random, width: 9.0, height: 3.0, spread: 0.2, seed: 1, sides: Sides::Walls };
        let bed = pile.lay().0;
        write(&path, &bed, "two\nnotes").unwrap();
        assert_eq!(read(&path).unwrap(), bed);
        for (from, to, fault) in [
            ("grain,", "stone,", ":5: kind stone is not known"),
            ("sides walls", "sides open", ":3: sides open are not known"),
            ("# width", "# breadth", "the line `# width ... d, sides ...` is missing"),
        ] {
            let text = std::fs::read_to_string(&path).unwrap().replacen(from, to, 1);
            let other = folder.path().join("other.csv");
            std::fs::write(&other, text).unwrap();
            let error = read(&other).unwrap_err().to_string();
            assert!(error.contains(fault), "{error}");
        }
    }
}
