//! The table of a layout file, whatever its columns mean: its lines and cells, and what a wrong one hears.

use std::path::Path;

use super::error::{LayoutFileError, Source};
use crate::input::{self, Unreadable};
use crate::material::{self, Material};

/// How to come by a layout to begin with.
pub(super) const START: &str = "Begin with a proposed layout: granulens design DESIGN.toml --out LAYOUT.csv.";

/// The text of a file.
pub(super) fn text(path: &Path) -> Result<String, LayoutFileError> {
    input::text(path).map_err(|error| {
        let (message, help) = match error {
            Unreadable::NotText { valid, .. } => {
                (format!("is no UTF-8 text from byte {valid} on."), "Save it as CSV in UTF-8.")
            }
            Unreadable::Folder => ("cannot be read: Is a directory (os error 21).".to_owned(), START),
            error => (format!("{error}."), START),
        };
        LayoutFileError::of_file(path, message, help)
    })
}

/// The lines below a header.
pub(super) struct Table<'a> {
    source: Source<'a>,
    /// Where in the text the header is.
    pub header: usize,
    records: Vec<csv::StringRecord>,
}

impl<'a> Table<'a> {
    /// Of a text; `help` says what to try where the header is another.
    pub fn of(source: Source<'a>, help: impl Fn(&[&str]) -> &'static str) -> Result<Self, LayoutFileError> {
        let mut reader = csv::ReaderBuilder::new()
            .comment(Some(b'#'))
            .trim(csv::Trim::All)
            .has_headers(false)
            .flexible(true)
            .from_reader(source.text.as_bytes());
        let mut records = reader.records().map(|record| {
            record.map_err(|error| source.error(source.begin(error.position()), None, error.to_string()))
        });
        let Some(header) = records.next().transpose()? else {
            return Err(LayoutFileError::of_file(source.path, "holds no lines but comments.".to_owned(), START));
        };
        let at = source.begin(header.position());
        if header != *source.columns {
            let found: Vec<&str> = header.iter().collect();
            let message = format!("the header is \"{}\", expected \"{}\".", found.join(","), source.columns.join(","));
            return Err(source.error(at, None, message).trying(help(&found)));
        }
        Ok(Self { source, header: at, records: records.collect::<Result<_, _>>()? })
    }

    pub fn rows(&self) -> impl Iterator<Item = Row<'_>> {
        let source = self.source;
        self.records.iter().map(move |record| Row { source, at: source.begin(record.position()), record })
    }
}

/// A line.
pub(super) struct Row<'a> {
    source: Source<'a>,
    /// Where in the text it begins.
    pub at: usize,
    record: &'a csv::StringRecord,
}

impl Row<'_> {
    /// A complaint about it, or about one of its cells.
    pub fn fail(&self, column: Option<usize>, message: String) -> LayoutFileError {
        self.source.error(self.at, column, message)
    }

    /// That it has a cell for each column.
    pub fn check(&self) -> Result<(), LayoutFileError> {
        let (found, columns) = (self.record.len(), self.source.columns);
        if found == columns.len() {
            return Ok(());
        }
        let values = if found == 1 { "1 value".to_owned() } else { format!("{found} values") };
        Err(self.fail(None, format!("the line has {values}, expected {}: {}.", columns.len(), columns.join(","))))
    }

    /// A number of a cell that may not be there, or hold none.
    pub fn number(&self, column: usize) -> Option<f64> {
        self.record.get(column)?.parse().ok().filter(|value: &f64| value.is_finite())
    }

    /// A whole number; of 0 who asks complains.
    pub fn whole(&self, column: usize) -> Result<u32, LayoutFileError> {
        let (name, cell) = (self.source.columns[column], &self.record[column]);
        let message = || format!("{name} = \"{cell}\" is not a whole number from 1 on.");
        cell.parse().map_err(|_| self.fail(Some(column), message()))
    }

    /// A length (m).
    pub fn length(&self, column: usize) -> Result<f64, LayoutFileError> {
        self.number(column).ok_or_else(|| {
            let (name, cell) = (self.source.columns[column], &self.record[column]);
            self.fail(Some(column), format!("{name} = \"{cell}\" is not a number."))
                .trying("Write lengths in metres, without a unit: 0.00635.")
        })
    }

    /// How far off a length is from what the design has (m): up to a part of the diameter, else what the design's is called, and what to try.
    pub fn off(
        &self,
        column: usize,
        (value, expected): (f64, f64),
        allowed: f64,
        (what, help): (&str, &str),
    ) -> Result<f64, LayoutFileError> {
        let off = (value - expected).abs();
        if off > allowed {
            let name = self.source.columns[column];
            let message = format!("{name} = {value} m, but the design has {what} {expected} m.");
            return Err(self.fail(Some(column), message).trying(help));
        }
        Ok(off)
    }

    /// A material by its name, among own ones and in the library.
    pub fn material(&self, column: usize, own: &[Material]) -> Result<Material, LayoutFileError> {
        material::find(&self.record[column], own).map_err(|unknown| {
            let near = unknown.nearest.as_ref().map_or(String::new(), |near| format!("Did you mean {near}? "));
            let help = format!(
                "{near}Known are {}; own ones are described in the design file, as [materials.NAME].",
                unknown.known.join(", ")
            );
            self.fail(Some(column), format!("material = \"{}\" is unknown.", unknown.name)).trying(help)
        })
    }

    /// That nothing has been said yet of this site, or where it was.
    pub fn is_first(&self, earlier: Option<(u8, usize)>, site: impl Fn() -> String) -> Result<(), LayoutFileError> {
        let Some((_, earlier)) = earlier else { return Ok(()) };
        let message = format!("{} is given twice, first in line {}.", site(), self.source.line(earlier));
        Err(self.fail(None, message).trying("Keep one of the two lines."))
    }

    /// The place of a material in the palette, which grows by what is new.
    pub fn place(&self, column: usize, material: Material, palette: &mut Vec<Material>) -> Result<u8, LayoutFileError> {
        let place = palette.iter().position(|known| known.name == material.name).unwrap_or_else(|| {
            palette.push(material);
            palette.len() - 1
        });
        u8::try_from(place).map_err(|_| self.fail(Some(column), "the file names more than 256 materials.".to_owned()))
    }
}
