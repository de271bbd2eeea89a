//! A law at given states, as CSV.

use std::fmt::Write as _;
use std::path::Path;

use granulens::contact::{AnyLaw, ForceLaw as _, History};

use crate::cli::failure::Failure;

/// States, forces, and what contacts remember after a step accepted there.
pub struct States {
    pub columns: Vec<String>,
    pub rows: Vec<Vec<f64>>,
}

/// The columns of all laws: the state, the force, and the history after a step accepted there.
const COLUMNS: [&str; 7] = ["d", "v", "dmax", "Fmax", "F", "dmax_after", "Fmax_after"];

impl States {
    /// The law at every state of a CSV file with the columns d,v,dmax,Fmax; what the law remembers besides is read from a column of its own where
    /// there is one, and follows from dmax and Fmax where not.
    pub fn read(path: &Path, law: &AnyLaw) -> Result<Self, Failure> {
        let text = granulens::input::text(path).map_err(|error| Failure::of_file(path, None, &error.to_string()))?;
        let own = law.kind().own_memory();
        // Counted here: the reader takes the place behind the record before for a record's place, comments and all.
        let mut lines = (1..).zip(text.lines()).filter(|(_, line)| !line.starts_with('#') && !line.trim().is_empty());
        let Some((line, header)) = lines.next() else {
            return Err(Failure::of_file(
                path,
                None,
                "holds no lines but comments; expected the columns d,v,dmax,Fmax",
            ));
        };
        let names: Vec<&str> = cells(header);
        let mut places = Vec::new();
        for name in &COLUMNS[..4] {
            places.push(names.iter().position(|column| column == name).ok_or_else(|| {
                Failure::of_file(path, Some(line), &format!("has no column \"{name}\"; expected d,v,dmax,Fmax"))
            })?);
        }
        places.extend(own.and_then(|own| names.iter().position(|&column| column == own)));
        let mut rows = Vec::new();
        for (line, text) in lines {
            let cells = cells(text);
            let mut values = Vec::new();
            for &place in &places {
                let fail = |message: String| Failure::of_file(path, Some(line), &format!("{}{message}", names[place]));
                let cell = cells.get(place).ok_or_else(|| fail(" is missing in this line".to_owned()))?;
                let value = cell.parse().ok().filter(|value: &f64| value.is_finite());
                values.push(value.ok_or_else(|| fail(format!(" = \"{cell}\" is not a finite number")))?);
            }
            let (d, v, overlap_max, force_max) = (values[0], values[1], values[2], values[3]);
            let history = match values.get(4) {
                Some(&own) => History { overlap_max, force_max, own },
                None => law.recalled(overlap_max, force_max),
            };
            let (force, after) = law.respond(d.max(0.0), v, &history);
            let mut row = vec![d, v, overlap_max, force_max, force, after.overlap_max, after.force_max];
            if own.is_some() {
                row.extend([history.own, after.own]);
            }
            rows.push(row);
        }
        let mut columns = COLUMNS.map(str::to_owned).to_vec();
        columns.extend(own.into_iter().flat_map(|own| [own.to_owned(), format!("{own}_after")]));
        Ok(Self { columns, rows })
    }

    pub fn csv(&self) -> String {
        let mut text = self.columns.join(",") + "\n";
        for row in &self.rows {
            let cells: Vec<String> = row.iter().map(f64::to_string).collect();
            let _ = writeln!(text, "{}", cells.join(","));
        }
        text
    }

    /// Each state as a JSON object.
    pub fn json(&self) -> Vec<serde_json::Map<String, serde_json::Value>> {
        let object = |row: &Vec<f64>| {
            self.columns.iter().cloned().zip(row.iter().map(|&value| serde_json::Value::from(value))).collect()
        };
        self.rows.iter().map(object).collect()
    }
}

pub fn cells(line: &str) -> Vec<&str> {
    line.split(',').map(|cell| cell.trim().trim_matches('"')).collect()
}
