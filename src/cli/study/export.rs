//! `granulens study export`: the best layout, and the journal as a table.

use std::path::{Path, PathBuf};

use serde_json::json;

use super::best_layout;
use super::show::{Known, find};
use super::table::{Table, journal};
use super::words::scores;
use crate::cli::Common;
use crate::cli::console::{emit_json, note};
use crate::cli::failure::Failure;
use crate::cli::folder::write_file;

#[derive(clap::Args)]
pub struct Export {
    /// Study file
    study: PathBuf,
    /// Where to write the best layout, as CSV
    #[arg(long, value_name = "FILE", required_unless_present = "journal")]
    layout: Option<PathBuf>,
    /// Where to write the journal: a line for each evaluation and each case it was judged by. FILE.csv, or FILE.parquet where
    /// granulens is built with the feature parquet
    #[arg(long, value_name = "FILE")]
    journal: Option<PathBuf>,
}

impl Export {
    pub fn run(self, common: &Common) -> Result<(), Failure> {
        let Known { study, rungs, best, .. } = find(&self.study, common)?;
        if let Some(path) = &self.layout {
            let best = best.ok_or_else(|| Failure::input("the journal holds no evaluation that came to its end"))?;
            write_file(path, &best_layout(&study, &best.entry)?)?;
            note(common, &format!("{}: {}", path.display(), scores(&best.summary)));
        }
        let evaluations: usize = rungs.iter().map(|(_, rung)| rung.all().len()).sum();
        if let Some(path) = &self.journal {
            write(path, &journal(&study, &rungs))?;
            note(common, &format!("{}: {evaluations} evaluations", path.display()));
        }
        if common.json {
            emit_json(&json!({
                "format": granulens::outcome::FORMAT, "layout": self.layout, "journal": self.journal,
                "evaluations": evaluations,
            }));
        }
        Ok(())
    }
}

/// As the file's name says: CSV unless it ends with .parquet.
fn write(path: &Path, table: &Table) -> Result<(), Failure> {
    if path.extension().is_none_or(|extension| !extension.eq_ignore_ascii_case("parquet")) {
        return write_file(path, &table.csv());
    }
    #[cfg(feature = "parquet")]
    {
        let bytes = table.parquet().map_err(|error| Failure::input(format!("{}: {error}", path.display())))?;
        crate::cli::folder::write_bytes(path, &bytes)
    }
    #[cfg(not(feature = "parquet"))]
    Err(Failure::input_with_help(
        format!("{}: this granulens is built without the feature parquet.", path.display()),
        "Write FILE.csv, which pandas.read_csv takes, or build with cargo build --release --features parquet.",
    ))
}
