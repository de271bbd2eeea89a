//! `granulens reproduce`: published numbers and claims, each with a verdict.

use granulens::outcome::FORMAT;
use granulens::reproduce::{self, Finding, Part, Row};
use serde_json::{Value, json};

use super::Common;
use super::console::{Count, emit, emit_json, note};
use super::cost;
use super::failure::Failure;
use super::folder::{probe, write_file, write_json};

/// Compute what Burgoyne 2016 says, and give a verdict on each number and claim
///
/// Rows named K are of Kondic et al. 2012. All take some minutes on two cores; name a row (5.3.3-gain), a section (5.3.2) or a chapter
/// (4, K, optimum) to run only these. Exits with 1 where a row does not come to the verdict it is expected to come to. With --out, the table is written too: as JSON if the name ends
/// in .json, else in Markdown.
#[derive(clap::Args)]
pub struct Reproduce {
    /// Rows, sections or chapters; all without
    rows: Vec<String>,
    /// List the rows, with about how long they take, and run nothing
    #[arg(long)]
    list: bool,
}

impl Reproduce {
    pub fn run(self, common: &Common) -> Result<(), Failure> {
        let rows = self.rows()?;
        if self.list {
            if common.json {
                let list: Vec<Value> = rows.iter().map(|row| described(row)).collect();
                emit_json(&json!({ "format": FORMAT, "rows": list }));
            } else {
                emit(&reproduce::list(&rows));
            }
            return Ok(());
        }
        if common.dry_run {
            let seconds = rows.iter().map(|row| row.seconds).sum();
            return cost::tell(common, &[cost::Part::new("rows", rows.len() as u64, Some(seconds))]);
        }
        probe(common, common.out.as_ref())?;
        let threads = rayon::current_num_threads();
        let all: f64 = rows.iter().map(|row| row.seconds).sum();
        let longest = rows.iter().map(|row| row.seconds).fold(0.0, f64::max);
        let expected = longest.max(all / threads as f64).ceil();
        note(common, &format!("{} rows, about {expected} s on {threads} threads", rows.len()));
        let bar = Count::new(common, rows.len(), "rows");
        let findings = reproduce::run(&rows, &bar.context());
        bar.done();
        if findings.iter().any(Finding::interrupted) {
            return Err(Failure::Interrupted("nothing is shown of rows that were not finished".to_owned()));
        }
        let numbers = json!({ "format": FORMAT, "rows": findings.iter().map(found).collect::<Vec<_>>() });
        let table = reproduce::markdown(&findings);
        match &common.out {
            Some(path) if path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("json")) => {
                write_json(common, &numbers)?;
            }
            Some(path) => write_file(common, path, &table)?,
            None => {}
        }
        if common.json {
            emit_json(&numbers);
        } else {
            emit(&table);
        }
        let deviations: Vec<String> = findings.iter().filter_map(Finding::deviates).collect();
        if deviations.is_empty() {
            note(common, &format!("all {} rows come to their expected verdicts", rows.len()));
            Ok(())
        } else {
            Err(Failure::Deviation(deviations))
        }
    }

    fn rows(&self) -> Result<Vec<&'static Row>, Failure> {
        if self.rows.is_empty() {
            return Ok(reproduce::rows());
        }
        let mut chosen = Vec::new();
        for name in &self.rows {
            let found = reproduce::select(name);
            if found.is_empty() {
                let all = reproduce::rows();
                let nearest = all
                    .iter()
                    .max_by(|a, b| strsim::jaro_winkler(name, a.id).total_cmp(&strsim::jaro_winkler(name, b.id)));
                let hint = nearest.map_or(String::new(), |row| format!("Did you mean {}? ", row.id));
                return Err(Failure::input_with_help(
                    format!("there is no row, section or chapter \"{name}\""),
                    format!("{hint}granulens reproduce --list names them all."),
                ));
            }
            chosen.extend(
                found
                    .into_iter()
                    .filter(|row| !chosen.iter().any(|known: &&Row| known.id == row.id))
                    .collect::<Vec<_>>(),
            );
        }
        Ok(chosen)
    }
}

fn described(row: &Row) -> Value {
    json!({
        "row": row.id, "claim": row.claim, "source": row.source, "tolerance_because": row.reason,
        "expected": row.expected, "seconds": row.seconds,
    })
}

fn found(finding: &Finding) -> Value {
    let part = |part: &Part| {
        json!({
            "what": part.what, "published": part.published, "ours": part.ours, "unit": part.unit, "wanted": part.wanted,
            "deviation": part.deviation(), "holds": part.holds(),
        })
    };
    let mut value = described(finding.row);
    value["seconds"] = json!(finding.seconds);
    value["verdict"] = json!(finding.verdict());
    match &finding.parts {
        Ok(parts) => value["numbers"] = parts.iter().map(part).collect(),
        Err(error) => value["error"] = json!(error.to_string()),
    }
    value["as_expected"] = json!(finding.deviates().is_none());
    value
}
