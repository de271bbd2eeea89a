//! `granulens study compare`: studies that have been run, side by side.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use granulens::input;
use granulens::report::{ComparedStudy, Provenance, compared_page};
use granulens::study::{Report, Spread};
use granulens::units::Dimension::Time;
use serde_json::json;

use crate::cli::console::{emit, emit_json, note};
use crate::cli::failure::Failure;
use crate::cli::folder::write_file;
use crate::cli::{Common, command_line};

#[derive(clap::Args)]
pub struct Compare {
    /// Folders of studies that have been run, each with its study.json
    #[arg(required = true, num_args = 2.., value_name = "FOLDER")]
    folders: Vec<PathBuf>,
}

/// How near to the best of all counts as there: a part of the objective's goal, as the loss is a logarithm.
const NEAR: f64 = 0.05;

/// One study's line.
struct Row {
    name: String,
    report: Report,
    /// Evaluations after which the loss was within 5 % of the best of all studies, at the same step.
    soon: Option<u64>,
    /// Sites on which its best layout differs from that of the first study, where both choose on the same sites.
    differs: Option<usize>,
}

impl Compare {
    pub fn run(self, common: &Common) -> Result<(), Failure> {
        let Compared { rows, alike, same_step } = compared(&self.folders)?;
        if common.json {
            emit_json(&told(&rows, alike));
        } else {
            emit(&table(&rows, alike, same_step));
        }
        if let Some(path) = &common.out {
            let words = table(&rows, alike, same_step);
            let studies: Vec<ComparedStudy<'_>> = rows
                .iter()
                .map(|row| ComparedStudy { name: &row.name, report: &row.report, soon: row.soon, differs: row.differs })
                .collect();
            write_file(common, path, &compared_page(&studies, alike, &words, provenance(&rows)))?;
            note(common, &format!("page: {}", path.display()));
        }
        Ok(())
    }
}

/// What repeats the page: the studies' own commands are on their pages.
fn provenance(rows: &[Row]) -> Provenance {
    let mut provenance = Provenance::new(command_line(), String::new(), String::new())
        .with("granulens", format!("{}, commit {}", granulens::outcome::VERSION, granulens::outcome::COMMIT));
    for row in rows {
        let report = &row.report;
        let step =
            report.method.as_ref().map_or(String::new(), |method| format!(", step {}", Time.show(method.step_s)));
        let problem = report.problem.clone().unwrap_or_else(|| "unknown".to_owned());
        let facts = format!("{}, seed {}{step}, problem {problem}", report.study, report.seed);
        provenance = provenance.with(&row.name, facts);
    }
    provenance
}

/// Studies side by side.
struct Compared {
    rows: Vec<Row>,
    /// Whether all ask the same.
    alike: bool,
    /// Whether their finest steps are the same too.
    same_step: bool,
}

/// Studies side by side, as an object, and as a table.
pub fn side_by_side(folders: &[PathBuf]) -> Result<(serde_json::Value, String), Failure> {
    let Compared { rows, alike, same_step } = compared(folders)?;
    Ok((told(&rows, alike), table(&rows, alike, same_step)))
}

fn told(rows: &[Row], alike: bool) -> serde_json::Value {
    json!({
        "format": granulens::outcome::FORMAT,
        "studies": rows.iter().map(Row::json).collect::<Vec<_>>(),
        "same_problem": alike,
        "contrast": spread(rows, |row| row.best()?.0).filter(|_| alike),
        "focal_gain": spread(rows, |row| row.best()?.1).filter(|_| alike),
        "protection": spread(rows, |row| row.best()?.2).filter(|_| alike),
    })
}

fn compared(folders: &[PathBuf]) -> Result<Compared, Failure> {
    let reports = folders.iter().map(|folder| read(folder)).collect::<Result<Vec<_>, _>>()?;
    let finest = |report: &Report| report.state.history.last().map(|last| last.step);
    // Only numbers that answer the same question can be set beside each other.
    let alike = reports.windows(2).all(|two| same_problem(&two[0], &two[1]));
    let same_step = alike && reports.windows(2).all(|two| finest(&two[0]) == finest(&two[1]));
    let least = reports.iter().filter_map(|report| Some(report.state.best.as_ref()?.loss)).reduce(f64::min);
    let reference = reports.first().and_then(layout);
    let rows: Vec<Row> = folders
        .iter()
        .zip(reports)
        .map(|(folder, report)| {
            let near = |loss: f64| least.is_some_and(|least| loss <= least + NEAR);
            let at = finest(&report);
            let mut there =
                report.state.history.iter().filter(|h| h.within_limits && Some(h.step) == at && near(h.loss));
            let soon = if same_step { there.next().map(|h| h.evaluations) } else { None };
            let differs = reference.as_ref().filter(|_| alike).zip(layout(&report)).and_then(|(a, b)| differing(a, &b));
            Row { name: folder.display().to_string(), report, soon, differs }
        })
        .collect();
    Ok(Compared { rows, alike, same_step })
}

type Ratios = (Option<f64>, Option<f64>, Option<f64>);

impl Row {
    /// C, G and Q of the best layout.
    fn best(&self) -> Option<Ratios> {
        let scores = &self.report.state.best.as_ref()?.scores;
        Some((scores.contrast, scores.focal_gain, scores.protection))
    }

    fn methods(&self) -> String {
        let names: Vec<&str> = self.report.state.stages.iter().map(|stage| stage.method.as_str()).collect();
        names.join(" > ")
    }

    fn json(&self) -> serde_json::Value {
        let (contrast, gain, protection) = self.best().unwrap_or((None, None, None));
        json!({
            "folder": self.name, "methods": self.methods(), "seed": self.report.seed,
            "evaluations": self.report.state.evaluations, "contrast": contrast, "focal_gain": gain, "protection": protection,
            "within_limits": self.report.state.best.is_some(), "evaluations_to_5_percent": self.soon,
            "sites_different_from_first": self.differs,
        })
    }
}

pub fn read(folder: &Path) -> Result<Report, Failure> {
    let path = folder.join("study.json");
    let text = input::text(&path).map_err(|error| {
        let message = format!("{}: {error}", path.display());
        Failure::input_with_help(message, "Run the study first, with granulens study run; name its folder here.")
    })?;
    serde_json::from_str(&text).map_err(|error| {
        Failure::input_with_help(
            format!("{}: is no report of a study: {error}", path.display()),
            "It may be of another version; granulens study run writes it anew from the journal.",
        )
    })
}

/// Whether two studies ask the same. Of results of 0.1, which do not say, as far as can be told.
fn same_problem(a: &Report, b: &Report) -> bool {
    match (&a.problem, &b.problem) {
        (Some(a), Some(b)) => a == b,
        _ => (a.sites, &a.materials) == (b.sites, &b.materials),
    }
}

/// The best layout, its materials by name.
fn layout(report: &Report) -> Option<Vec<String>> {
    let best = report.state.best.as_ref()?;
    let alphabet = best.entry.assignment(report.sites, report.materials.len() as u8)?;
    alphabet.into_iter().map(|letter| report.materials.get(usize::from(letter)).cloned()).collect()
}

fn differing(a: &[String], b: &[String]) -> Option<usize> {
    (a.len() == b.len()).then(|| a.iter().zip(b).filter(|(a, b)| a != b).count())
}

fn spread(rows: &[Row], score: impl Fn(&Row) -> Option<f64>) -> Option<Spread> {
    Spread::of(&rows.iter().filter_map(score).collect::<Vec<_>>())
}

fn table(rows: &[Row], alike: bool, same_step: bool) -> String {
    let width = rows.iter().map(|row| row.name.chars().count()).max().unwrap_or(0).max(5);
    let mut text = format!(
        "{:width$}  {:>4}  {:>11}  {:>7}  {:>7}  {:>7}  {:>6}  {:>7}  methods\n",
        "study", "seed", "evaluations", "C", "G", "Q", "to 5 %", "differs"
    );
    for row in rows {
        let show = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), |value| format!("{value:.4}"));
        let count = |value: Option<u64>| value.map_or_else(|| "-".to_owned(), |value| value.to_string());
        let (contrast, gain, protection) = row.best().unwrap_or((None, None, None));
        let _ = writeln!(
            text,
            "{:width$}  {:>4}  {:>11}  {:>7}  {:>7}  {:>7}  {:>6}  {:>7}  {}",
            row.name,
            row.report.seed,
            row.report.state.evaluations,
            show(contrast),
            show(gain),
            show(protection),
            count(row.soon),
            count(row.differs.map(|count| count as u64)),
            row.methods()
        );
    }
    for (name, spread) in [
        ("C", spread(rows, |row| row.best()?.0)),
        ("G", spread(rows, |row| row.best()?.1)),
        ("Q", spread(rows, |row| row.best()?.2)),
    ] {
        if let Some(Spread { mean, half_width: Some(half_width), range: [least, most] }) = spread.filter(|_| alike) {
            let _ = writeln!(text, "{name}: {least:.4} to {most:.4}, mean {mean:.4}±{half_width:.4} (95 %)");
        }
    }
    if rows.iter().any(|row| row.best().is_none()) {
        text.push_str("- in C, G and Q: no layout keeps that study's limits\n");
    }
    if !alike {
        text.push_str(
            "these are different problems (design, materials, sites, impacts, tolerances or objective differ): each stands by itself\n",
        );
    } else if !same_step {
        text.push_str("their finest steps differ, so speeds are not compared\n");
    }
    text
}
