//! Measured histories as CSV: `time_s` and one column for each record.

use std::path::{Path, PathBuf};

/// What was measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Data {
    /// Times (s), increasing.
    pub times: Vec<f64>,
    /// The records, in the order of the file.
    pub records: Vec<Record>,
}

/// One column.
#[derive(Clone, Debug, PartialEq)]
pub struct Record {
    /// Its name, as `simulate` names it.
    pub name: String,
    /// A value for each time; NaN where a cell is empty.
    pub values: Vec<f64>,
}

/// What is wrong with a file of measurements.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{}:{} {message}", .path.display(), .line.map_or(String::new(), |line| format!("{line}:")))]
pub struct DataError {
    /// The file.
    pub path: PathBuf,
    /// The line, from 1, where there is one to blame.
    pub line: Option<u64>,
    /// What was wrong, and what was expected.
    pub message: String,
    /// What to try.
    pub help: &'static str,
}

/// Fewest samples of a record: less can be compared, but tells nothing.
const FEWEST: usize = 8;

impl Data {
    /// Reads a file.
    ///
    /// # Errors
    /// See [`DataError`].
    pub fn read(path: &Path) -> Result<Self, DataError> {
        let fail = |line, message: String, help| DataError { path: path.to_owned(), line, message, help };
        const HEAD: &str =
            "Begin the file with the line time_s,NAME,...; names are those of the records of granulens simulate.";
        let mut reader = csv::ReaderBuilder::new()
            .comment(Some(b'#'))
            .trim(csv::Trim::All)
            .from_path(path)
            .map_err(|error| fail(None, format!("cannot be read: {error}."), HEAD))?;
        let header = reader.headers().map_err(|error| fail(None, format!("cannot be read: {error}."), HEAD))?.clone();
        let mut names = header.iter().map(|name| name.trim_start_matches('\u{feff}'));
        if names.next() != Some("time_s") {
            let message = format!("the first column is \"{}\", expected \"time_s\".", &header[0]);
            return Err(fail(Some(1), message, HEAD));
        }
        let mut records: Vec<Record> = names.map(|name| Record { name: name.to_owned(), values: Vec::new() }).collect();
        if records.is_empty() {
            return Err(fail(Some(1), "there is no column behind time_s.".to_owned(), HEAD));
        }
        if let Some(k) = (1..records.len()).find(|&k| records[..k].iter().any(|record| record.name == records[k].name))
        {
            let message = format!("the column \"{}\" is there twice.", records[k].name);
            return Err(fail(Some(1), message, "Keep one of them."));
        }
        let mut times: Vec<f64> = Vec::new();
        for row in reader.records() {
            let row = row.map_err(|error| {
                let line = error.position().map(csv::Position::line);
                fail(line, format!("{error}."), "Give every line as many cells as the header has; they may be empty.")
            })?;
            let line = row.position().map(csv::Position::line);
            let number = |cell: &str, name: &str| {
                let number = cell.parse::<f64>().ok().filter(|number| number.is_finite());
                number.ok_or_else(|| {
                    let message = format!("{name} = \"{cell}\" is not a number.");
                    fail(
                        line,
                        message,
                        "Write SI numbers without units; leave a cell empty where nothing was measured.",
                    )
                })
            };
            let time = number(&row[0], "time_s")?;
            if times.last().is_some_and(|last| time <= *last) {
                return Err(fail(
                    line,
                    format!("time_s = {time} is not after the time before it."),
                    "Sort the lines by time.",
                ));
            }
            times.push(time);
            for (k, record) in records.iter_mut().enumerate() {
                let cell = &row[k + 1];
                record.values.push(if cell.is_empty() { f64::NAN } else { number(cell, &record.name)? });
            }
        }
        for record in &records {
            let there = record.values.iter().filter(|value| value.is_finite());
            let (count, flat) = (there.clone().count(), there.clone().all(|value| *value == 0.0));
            if count < FEWEST {
                let message = format!("{} has {count} values; {FEWEST} are the fewest to compare.", record.name);
                return Err(fail(None, message, "Leave the column out, or give more samples."));
            }
            if flat {
                return Err(fail(None, format!("{} is zero throughout.", record.name), "Leave the column out."));
            }
        }
        Ok(Self { times, records })
    }
}
