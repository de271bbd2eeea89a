//! What the columns of tables and the keys of JSON mean that commands write.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::sync::OnceLock;

use serde::Deserialize;

use crate::score::Measure;

/// A kind of table that commands write as CSV.
#[derive(Clone, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Table {
    /// What its files are called.
    pub file: String,
    /// Which commands write it.
    pub by: String,
    /// What a line of it is.
    pub about: String,
    /// Its columns in order; `*` stands for a name or a number.
    pub columns: Vec<String>,
    /// Whether measures are among them.
    #[serde(default)]
    pub measures: bool,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Results {
    table: Vec<Table>,
    names: BTreeMap<String, String>,
}

fn results() -> &'static Results {
    static RESULTS: OnceLock<Results> = OnceLock::new();
    // A test reads it.
    RESULTS.get_or_init(|| {
        toml::from_str(include_str!("results.toml"))
            .unwrap_or_else(|_| Results { table: Vec::new(), names: BTreeMap::new() })
    })
}

/// All kinds of tables.
pub fn tables() -> &'static [Table] {
    &results().table
}

/// Whether a name is one of a pattern, in which `*` stands for one letter at least.
fn fits(pattern: &str, name: &str) -> bool {
    match pattern.split_once('*') {
        Some((before, after)) => {
            name.len() > before.len() + after.len() && name.starts_with(before) && name.ends_with(after)
        }
        None => pattern == name,
    }
}

impl Table {
    /// Whether it has a column of that name.
    pub fn has(&self, column: &str) -> bool {
        self.columns.iter().any(|known| fits(known, column)) || self.measures && measure(column).is_some()
    }
}

/// The measure that is written so, and of what: itself, its mean or its deviation over several forces.
fn measure(name: &str) -> Option<(Measure, &'static str)> {
    Measure::ALL.iter().copied().find_map(|measure| {
        let column = measure.column();
        let unit = column.strip_prefix(measure.name()).unwrap_or_default();
        if name == column {
            return Some((measure, ""));
        }
        let of = name.strip_suffix(unit)?.strip_prefix(measure.name())?;
        match of {
            "_mean" => Some((measure, " Mean over the forces.")),
            "_sd" => Some((measure, " Standard deviation over the forces.")),
            _ => None,
        }
    })
}

/// What a column of a table or a key of JSON means.
pub fn meaning(name: &str) -> Option<String> {
    let names = &results().names;
    if let Some(meaning) = names.get(name) {
        return Some(meaning.clone());
    }
    if let Some((measure, of)) = measure(name).or_else(|| Measure::find(name).map(|measure| (measure, ""))) {
        return Some(format!("{}{of}", measure.definition()));
    }
    // The longest pattern says most.
    let known = names.iter().filter(|(pattern, _)| pattern.contains('*') && fits(pattern, name));
    known.max_by_key(|(pattern, _)| pattern.len()).map(|(_, meaning)| meaning.clone())
}

/// The page docs/columns.md; a test holds the file to it.
pub fn results_page() -> String {
    let mut text = String::from(
        "# Columns and keys of results\n\nWhat commands write as tables (CSV) and as JSON. A name means the same wherever it stands, and `granulens keys NAME` tells it. SI throughout, \
         with the unit at the end of the name; what has none is a plain number, or says its unit. New columns come at the end. Measures are those of \
         [one table](measures.md), with `_mean` and `_sd` over several forces. Made by `granulens keys --results`.\n\n## Tables\n",
    );
    for table in tables() {
        let _ = write!(
            text,
            "\n### {}\n\n{} Written by `{}`.\n\n| column | meaning |\n|---|---|\n",
            table.file,
            table.about,
            table.by.replace(", ", "`, `")
        );
        for column in &table.columns {
            let _ = writeln!(text, "| `{column}` | {} |", meaning(column).unwrap_or_default());
        }
        if table.measures {
            text.push_str("| measures | All that are known, or those that the study asks for. |\n");
        }
    }
    text.push_str("\n## Keys of JSON\n\n| key | meaning |\n|---|---|\n");
    for (name, meaning) in &results().names {
        let _ = writeln!(text, "| `{name}` | {meaning} |");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_column_has_a_meaning() {
        let read: Result<Results, _> = toml::from_str(include_str!("results.toml"));
        assert!(read.is_ok(), "{:?}", read.err());
        for table in tables() {
            for column in &table.columns {
                assert!(meaning(column).is_some(), "{}: {column}", table.file);
            }
        }
        assert!(fits("layer_*_m_s", "layer_12_m_s") && !fits("layer_*_m_s", "layer_m_s"));
        assert!(meaning("focal_mean_sd_J").unwrap().contains("deviation over the forces"));
        assert_eq!(meaning("layer_3_m_s"), results().names.get("layer_*_m_s").cloned());
        assert_eq!(meaning("no_such_name"), None);
    }

    /// After a change of results.toml: `granulens keys --results > docs/columns.md`.
    #[test]
    fn the_page_in_the_book_is_this_one() {
        let stored = std::fs::read_to_string(concat!(env!("CARGO_MANIFEST_DIR"), "/docs/columns.md")).unwrap();
        assert!(stored == results_page(), "granulens keys --results > docs/columns.md");
    }
}
