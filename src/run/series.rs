//! Records read back, thinned out to what a picture can show.

use std::fs::File;
use std::io::{BufRead as _, BufReader};
use std::path::{Path, PathBuf};

/// Columns of numbers over the lines of a file.
#[derive(Clone, Debug, PartialEq)]
pub struct Series {
    /// Names of the columns.
    pub names: Vec<String>,
    /// Values, column by column.
    pub columns: Vec<Vec<f64>>,
}

/// A file that is no record.
#[derive(Debug, thiserror::Error)]
#[error("{}:{line}: {reason}", .path.display())]
pub struct SeriesError {
    /// Which.
    pub path: PathBuf,
    /// Line, from 1; 0 for the file as a whole.
    pub line: usize,
    /// What is wrong.
    pub reason: String,
}

impl Series {
    /// Reads a record of numbers, of its `lines` beyond `most` only every second, third, ... and the last. Cells that hold
    /// no number become NaN.
    ///
    /// # Errors
    /// The file cannot be read, or a line is shorter than its header.
    pub fn read(path: &Path, most: usize) -> Result<Self, SeriesError> {
        let fail = |line: usize, reason: String| SeriesError { path: path.to_owned(), line, reason };
        let count = BufReader::new(File::open(path).map_err(|error| fail(0, error.to_string()))?).lines().count();
        let stride = count.saturating_sub(1).div_ceil(most.max(1)).max(1);
        let mut columns = Vec::new();
        let mut line = 1;
        let names = scan(path, |values| {
            line += 1;
            if (line - 2) % stride == 0 || line == count {
                columns.resize(values.len(), Vec::new());
                columns.iter_mut().zip(values).for_each(|(column, value)| column.push(*value));
            }
        })?;
        columns.resize(names.len(), Vec::new());
        Ok(Self { names, columns })
    }

    /// A column by its name; empty where there is none.
    pub fn column(&self, name: &str) -> &[f64] {
        self.names.iter().position(|known| known == name).map_or(&[], |k| &self.columns[k])
    }
}

/// Reads a record line by line, its header first, as text.
pub(super) fn lines(path: &Path, mut visit: impl FnMut(&str)) -> Result<(), SeriesError> {
    let fail = |line: usize, reason: String| SeriesError { path: path.to_owned(), line, reason };
    let file = File::open(path).map_err(|error| fail(0, error.to_string()))?;
    for (line, text) in (1..).zip(BufReader::new(file).lines()) {
        visit(&text.map_err(|error| fail(line, error.to_string()))?);
    }
    Ok(())
}

/// Reads a record line by line and gives the names of its columns. Cells that hold no number are NaN.
pub(super) fn scan(path: &Path, mut visit: impl FnMut(&[f64])) -> Result<Vec<String>, SeriesError> {
    let fail = |line: usize, reason: String| SeriesError { path: path.to_owned(), line, reason };
    let file = File::open(path).map_err(|error| fail(0, error.to_string()))?;
    let mut names: Vec<String> = Vec::new();
    for (line, text) in (1..).zip(BufReader::new(file).lines()) {
        let text = text.map_err(|error| fail(line, error.to_string()))?;
        if line == 1 {
            names = text.split(',').map(str::to_owned).collect();
            continue;
        }
        let values: Vec<f64> = text.split(',').map(|cell| cell.parse().unwrap_or(f64::NAN)).collect();
        if values.len() != names.len() {
            return Err(fail(line, format!("has {} values, expected {}", values.len(), names.len())));
        }
        visit(&values);
    }
    if names.is_empty() { Err(fail(1, "holds no header".to_owned())) } else { Ok(names) }
}
