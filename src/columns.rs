//! Numbers in named columns, of any program: CSV, and `dump local` of LAMMPS.
//!
//! Columns are found by their names, in any order; others are ignored. In CSV, lines that begin with `#` are comments.

use std::path::{Path, PathBuf};

use crate::input::{self, Unreadable};

/// A table that cannot be used.
#[derive(Debug, thiserror::Error)]
#[error("{}:{} {message}", .path.display(), .line.map_or(String::new(), |line| format!("{line}:")))]
pub struct TableError {
    /// The file.
    pub path: PathBuf,
    /// The line, from 1, where there is one to blame.
    pub line: Option<u64>,
    /// What is wrong, and what was expected.
    pub message: String,
    /// What to try.
    pub help: String,
}

/// A table of one moment.
#[derive(Debug)]
pub struct Table {
    path: PathBuf,
    /// Time, or the number of the step; of dumps, and of files with a comment that says it.
    pub time: Option<f64>,
    /// Whether it is of a dump.
    pub dump: bool,
    /// The period along x; of dumps of periodic boxes, and of files with a comment that says it.
    pub period: Option<f64>,
    names: Vec<String>,
    rows: Vec<csv::StringRecord>,
    lines: Vec<u64>,
}

impl Table {
    /// All tables of a file: one of CSV, as many as there are moments of a dump.
    ///
    /// # Errors
    /// See [`TableError`].
    pub fn read(path: &Path) -> Result<Vec<Self>, TableError> {
        let blame = |message: String, help: &str| TableError {
            path: path.to_owned(),
            line: None,
            message,
            help: help.to_owned(),
        };
        let text = input::text(path).map_err(|error| match error {
            Unreadable::Missing => blame("no such file.".to_owned(), "Name a file that is there."),
            Unreadable::NotText { valid, .. } => {
                blame(format!("is no UTF-8 text from byte {valid} on."), "Save it as CSV in UTF-8.")
            }
            error => blame(format!("{error}."), "Name a CSV file, or a dump of LAMMPS."),
        })?;
        let text = &text;
        match text.trim_start().starts_with("ITEM:") {
            true => dump(path, text),
            false => Ok(vec![Self::of_csv(path, text)?]),
        }
    }

    fn of_csv(path: &Path, text: &str) -> Result<Self, TableError> {
        let blame = |line: Option<u64>, message: String, help: &str| TableError {
            path: path.to_owned(),
            line,
            message,
            help: help.to_owned(),
        };
        let mut reader = csv::ReaderBuilder::new()
            .comment(Some(b'#'))
            .trim(csv::Trim::All)
            .has_headers(false)
            .from_reader(text.as_bytes());
        let mut table = Self {
            path: path.to_owned(),
            time: None,
            dump: false,
            period: None,
            names: Vec::new(),
            rows: Vec::new(),
            lines: Vec::new(),
        };
        for record in reader.records() {
            let record = record.map_err(|error| {
                let line = error.position().map(csv::Position::line);
                let message = match error.kind() {
                    csv::ErrorKind::UnequalLengths { expected_len, len, .. } => {
                        format!("the line has {len} values, and the header names {expected_len} columns.")
                    }
                    _ => format!("{error}."),
                };
                blame(line, message, "Separate the values by commas, as many in each line.")
            })?;
            if table.names.is_empty() {
                table.names = record.iter().map(str::to_owned).collect();
            } else {
                table.lines.push(record.position().map_or(0, csv::Position::line));
                table.rows.push(record);
            }
        }
        if table.names.is_empty() {
            return Err(blame(
                None,
                "holds no lines but comments.".to_owned(),
                "Begin it with the names of its columns.",
            ));
        }
        let said = |what: &str| {
            let mut comments = text.lines().take_while(|line| line.starts_with('#'));
            let value = comments.find_map(|line| line.split_once(what))?.1;
            value.split([';', ' ', ',']).next()?.parse().ok()
        };
        (table.period, table.time) = (said("period_x = "), said("time = "));
        Ok(table)
    }

    /// How many rows there are.
    pub fn len(&self) -> usize {
        self.rows.len()
    }

    /// Whether there are no rows.
    pub fn is_empty(&self) -> bool {
        self.rows.is_empty()
    }

    /// Whether there is a column of this name.
    pub fn has(&self, name: &str) -> bool {
        self.names.iter().any(|known| known == name)
    }

    /// Gives columns other names.
    ///
    /// # Errors
    /// A column that is not there.
    pub fn rename(&mut self, names: &[(String, String)]) -> Result<(), TableError> {
        let places: Vec<usize> = names.iter().map(|(_, old)| self.place(old)).collect::<Result<_, _>>()?;
        for ((new, _), place) in names.iter().zip(places) {
            self.names[place].clone_from(new);
        }
        Ok(())
    }

    fn place(&self, name: &str) -> Result<usize, TableError> {
        let mut places = (0..self.names.len()).filter(|&k| self.names[k] == name);
        let found = places.next().ok_or_else(|| {
            let help = match self.names.concat().contains([';', '\t']) {
                true => "Separate the columns by commas.".to_owned(),
                false => {
                    format!("The columns are {}. Rename one, or say which it is with --columns.", self.names.join(", "))
                }
            };
            TableError { path: self.path.clone(), line: None, message: format!("has no column {name}."), help }
        })?;
        match places.next() {
            None => Ok(found),
            Some(_) => Err(TableError {
                path: self.path.clone(),
                line: None,
                message: format!("has two columns {name}."),
                help: "Keep one of them.".to_owned(),
            }),
        }
    }

    /// The values of a column as they are written.
    ///
    /// # Errors
    /// No such column, or an empty value.
    pub fn labels(&self, name: &str) -> Result<Vec<&str>, TableError> {
        let place = self.place(name)?;
        let label = |k: usize| match &self.rows[k][place] {
            "" => Err(self.blame(k, format!("{name} is empty."), "Name a grain.")),
            label => Ok(label),
        };
        (0..self.len()).map(label).collect()
    }

    /// The numbers of a column.
    ///
    /// # Errors
    /// No such column, or what is no finite number.
    pub fn numbers(&self, name: &str) -> Result<Vec<f64>, TableError> {
        let place = self.place(name)?;
        let number = |k: usize| {
            let text = &self.rows[k][place];
            text.parse::<f64>().ok().filter(|x| x.is_finite()).ok_or_else(|| {
                self.blame(k, format!("{name} = \"{text}\" is no finite number."), "Write numbers without units.")
            })
        };
        (0..self.len()).map(number).collect()
    }

    /// A complaint about a row.
    pub fn blame(&self, row: usize, message: impl Into<String>, help: &str) -> TableError {
        let line = self.lines.get(row).copied();
        TableError { path: self.path.clone(), line, message: message.into(), help: help.to_owned() }
    }

    /// The line of a row, from 1.
    pub fn line(&self, row: usize) -> u64 {
        self.lines[row]
    }

    /// Keeps the rows that are wanted.
    pub fn retain(&mut self, wanted: &[bool]) {
        let mut flags = wanted.iter();
        self.rows.retain(|_| *flags.next().unwrap_or(&false));
        let mut flags = wanted.iter();
        self.lines.retain(|_| *flags.next().unwrap_or(&false));
    }
}

/// The moments of a dump: `ITEM: TIMESTEP`, `ITEM: NUMBER OF ENTRIES`, `ITEM: BOX BOUNDS`, `ITEM: ENTRIES` with the names.
fn dump(path: &Path, text: &str) -> Result<Vec<Table>, TableError> {
    let blame = |line: usize, message: &str| TableError {
        path: path.to_owned(),
        line: Some(line as u64 + 1),
        message: message.to_owned(),
        help: "It should be as LAMMPS writes it: dump ID all local N FILE ...".to_owned(),
    };
    let mut lines = text.lines().enumerate().peekable();
    let mut tables = Vec::new();
    let (mut time, mut period, mut count) = (None, None, None);
    while let Some((n, line)) = lines.next() {
        let item = match line.strip_prefix("ITEM: ") {
            Some(item) => item.trim(),
            None if line.trim().is_empty() => continue,
            None => return Err(blame(n, "a line that begins with ITEM: was expected.")),
        };
        let mut value = || lines.next().map(|(n, line)| (n, line.trim()));
        if item == "TIMESTEP" || item == "TIME" {
            let (n, text) = value().ok_or_else(|| blame(n, "the file ends here."))?;
            time = Some(text.parse::<f64>().map_err(|_| blame(n, "the time is no number."))?);
        } else if item == "UNITS" {
            value();
        } else if item.starts_with("NUMBER OF") {
            let (n, text) = value().ok_or_else(|| blame(n, "the file ends here."))?;
            count = Some(text.parse::<usize>().map_err(|_| blame(n, "the number of entries is no whole number."))?);
        } else if let Some(bounds) = item.strip_prefix("BOX BOUNDS") {
            if bounds.contains("xy") || bounds.contains("abc") {
                return Err(blame(n, "the box is not rectangular; only rectangular ones are read."));
            }
            let mut sides = Vec::new();
            for _ in 0..3 {
                let (n, text) = value().ok_or_else(|| blame(n, "the file ends here."))?;
                let numbers: Vec<f64> = text.split_whitespace().filter_map(|x| x.parse().ok()).collect();
                let [low, high] = numbers[..] else { return Err(blame(n, "a side of the box has two numbers.")) };
                sides.push(high - low);
            }
            period = (bounds.split_whitespace().next() == Some("pp")).then_some(sides[0]);
        } else if let Some(names) = item.strip_prefix("ENTRIES") {
            let count = count.take().ok_or_else(|| blame(n, "the number of entries was not said before."))?;
            let names: Vec<String> = names.split_whitespace().map(str::to_owned).collect();
            let (mut rows, mut at) = (Vec::new(), Vec::new());
            for _ in 0..count {
                let (n, text) =
                    value().ok_or_else(|| blame(n, "the file ends before the entries that it announces."))?;
                let row: csv::StringRecord = text.split_whitespace().collect();
                if row.len() != names.len() {
                    let message = format!("the entry has {} values, and {} columns are named.", row.len(), names.len());
                    return Err(blame(n, &message));
                }
                rows.push(row);
                at.push(n as u64 + 1);
            }
            tables.push(Table { path: path.to_owned(), time, dump: true, period, names, rows, lines: at });
        } else {
            return Err(blame(n, "is no part of a dump local."));
        }
    }
    match tables.is_empty() {
        true => Err(blame(0, "holds no entries.")),
        false => Ok(tables),
    }
}
