//! `granulens study export`: the best layout, and the journal as a table.

use std::path::{Path, PathBuf};

use granulens::export::Columns;
use granulens::score::Measure;
use granulens::study::{Found, Front, front_of};
use serde_json::{Map, Value, json};

use super::best_layout;
use super::show::{Known, find};
use super::table::journal;
use super::words::of;
use crate::cli::console::{emit_json, note};
use crate::cli::failure::Failure;
use crate::cli::folder::write_file;
use crate::cli::{Band, Common};

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
    /// Write the layout at this place on the front in place of the best one: from 1 in the order of the first traded measure, best
    /// first; only of studies that trade several
    #[arg(long, value_name = "PLACE", requires = "layout")]
    place: Option<usize>,
    #[command(flatten)]
    forces: Band,
}

impl Export {
    pub fn run(self, common: &Common) -> Result<(), Failure> {
        let Known { study, rungs, best, .. } = find(&self.study, &self.forces, common)?;
        let front = rungs
            .iter()
            .filter(|(_, rung)| !rung.ranked().is_empty())
            .min_by(|a, b| a.0.total_cmp(&b.0))
            .and_then(|(_, rung)| front_of(&study, rung, None));
        if let Some(path) = &self.layout {
            let found = match self.place {
                None => best.ok_or_else(|| Failure::input("the journal holds no evaluation that came to its end"))?,
                Some(place) => at(front.as_ref(), place)?,
            };
            write_file(common, path, &best_layout(&study, &found.entry)?)?;
            note(common, &format!("{}: {}", path.display(), of(&found)));
        }
        let evaluations: usize = rungs.iter().map(|(_, rung)| rung.all().len()).sum();
        if let Some(path) = &self.journal {
            write(common, path, &journal(&study, &rungs))?;
            note(common, &format!("{}: {evaluations} evaluations", path.display()));
        }
        if common.json {
            let front = front.map(|front| {
                let each = |(k, found): (usize, &Found)| {
                    let traded = front.measures.iter().filter_map(|name| Measure::find(name));
                    let values: Map<String, Value> =
                        traded.map(|m| (m.column().to_owned(), json!(found.scores.get(m)))).collect();
                    json!({ "place": k + 1, "evaluation": found.evaluation, "traded": values })
                };
                let layouts: Vec<Value> = front.layouts.iter().enumerate().map(each).collect();
                json!({ "measures": front.measures, "layouts": layouts })
            });
            emit_json(&json!({
                "format": granulens::outcome::FORMAT, "layout": self.layout, "journal": self.journal,
                "evaluations": evaluations, "place": self.place, "front": front,
            }));
        }
        Ok(())
    }
}

/// The layout at a place on the front.
fn at(front: Option<&Front>, place: usize) -> Result<Found, Failure> {
    let Some(front) = front else {
        return Err(Failure::input_with_help(
            "--place: the study trades no measures, so that there is no front".to_owned(),
            "Leave it out to export the best layout.",
        ));
    };
    front.layouts.get(place.wrapping_sub(1)).cloned().ok_or_else(|| {
        let count = front.layouts.len();
        Failure::input_with_help(
            format!("--place {place}: the front has {count} layouts"),
            format!("Choose 1 to {count}."),
        )
    })
}

/// As the file's name says: CSV unless it ends with .parquet.
fn write(common: &Common, path: &Path, table: &Columns) -> Result<(), Failure> {
    if path.extension().is_none_or(|extension| !extension.eq_ignore_ascii_case("parquet")) {
        return write_file(common, path, &table.csv());
    }
    #[cfg(feature = "parquet")]
    {
        let bytes = table.parquet("journal").map_err(|error| Failure::input(format!("{}: {error}", path.display())))?;
        crate::cli::folder::write_bytes(common, path, &bytes)
    }
    #[cfg(not(feature = "parquet"))]
    Err(Failure::input_with_help(
        format!("{}: this granulens is built without the feature parquet.", path.display()),
        "Write FILE.csv, which pandas.read_csv takes, or build with cargo build --release --features parquet.",
    ))
}
