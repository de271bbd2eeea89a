//! The files of a report, as text and on disk.

use std::path::Path;

use serde::Serialize;

use super::summary::{AGAINST, CONTRAST, DISSIPATED, FOCAL, GAIN, PROTECTED, PROTECTION, Pick, Spread, lines};
use super::{drawing, maps, page, profiles, spots};
use crate::outcome::{FORMAT, Outcome, Scores};
use crate::target::Target;

/// Why a report could not be made.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// A file could not be written.
    #[error("cannot write {path}: {source}")]
    Write {
        /// The file.
        path: String,
        /// What the system says.
        source: std::io::Error,
    },
    /// The outcome holds no arrangement to report.
    #[error("the outcome holds no arrangement; a report needs at least one")]
    Empty,
    /// The results could not be put into JSON.
    #[error("cannot write the results as JSON: {0}")]
    Json(#[from] serde_json::Error),
    /// The results could not be put into CSV.
    #[error("cannot write the numbers as CSV: {0}")]
    Csv(String),
    /// The page could not be filled in.
    #[error("cannot fill in the page: {0}")]
    Page(#[from] minijinja::Error),
}

/// The pictures of an outcome: file name and SVG text, in the order in which a page shows them.
///
/// # Errors
/// [`ReportError::Empty`].
pub fn pictures(outcome: &Outcome) -> Result<Vec<(&'static str, String)>, ReportError> {
    let lens = outcome.arrangements.first().ok_or(ReportError::Empty)?;
    let spots: Vec<_> = outcome.proposal.iter().flat_map(|proposal| &proposal.spots).collect();
    let mut pictures = vec![("layout.svg", drawing::layout(outcome, lens))];
    if !spots.is_empty() {
        pictures.push(("spots.svg", spots::spot_diagram(&outcome.manifest.name, outcome.diameter, &spots)));
    }
    pictures.extend([
        ("kinetic-lens.svg", maps::kinetic_lens(outcome, lens)),
        ("kinetic.svg", maps::kinetic(outcome)),
        ("profiles.svg", profiles::profiles(outcome)),
        ("dissipation.svg", maps::dissipation(outcome, lens)),
        ("forces.svg", maps::forces(outcome, lens)),
    ]);
    Ok(pictures)
}

/// Every file of a report: relative path and contents. The same outcome gives the same bytes.
///
/// # Errors
/// See [`ReportError`]; nothing is written.
pub fn files(outcome: &Outcome) -> Result<Vec<(String, String)>, ReportError> {
    let pictures = pictures(outcome)?;
    let page = page::page(outcome, &pictures)?;
    let mut files: Vec<(String, String)> = pictures.into_iter().map(|(name, svg)| (name.to_owned(), svg)).collect();
    files.push(("report.html".to_owned(), page));
    files.extend(number_files(outcome)?);
    Ok(files)
}

/// The files that hold numbers only: they need no lens and no complete set of arrangements.
fn number_files(outcome: &Outcome) -> Result<Vec<(String, String)>, ReportError> {
    Ok(vec![
        ("numbers.csv".to_owned(), numbers_csv(outcome)?),
        ("numbers.json".to_owned(), serde_json::to_string_pretty(&numbers(outcome))? + "\n"),
        ("manifest.json".to_owned(), serde_json::to_string_pretty(&outcome.manifest)? + "\n"),
        ("outcome.json".to_owned(), outcome_json(outcome)?),
    ])
}

/// The whole outcome as JSON.
///
/// # Errors
/// [`ReportError::Json`].
pub fn outcome_json(outcome: &Outcome) -> Result<String, ReportError> {
    Ok(serde_json::to_string(outcome)? + "\n")
}

/// Writes every file of a report into a directory, which is made if need be.
///
/// # Errors
/// See [`ReportError`].
pub fn write(outcome: &Outcome, directory: &Path) -> Result<(), ReportError> {
    write_all(&files(outcome)?, directory)
}

/// Writes only the files of numbers, for a run that was interrupted.
///
/// # Errors
/// See [`ReportError`].
pub fn write_numbers(outcome: &Outcome, directory: &Path) -> Result<(), ReportError> {
    write_all(&number_files(outcome)?, directory)
}

fn write_all(files: &[(String, String)], directory: &Path) -> Result<(), ReportError> {
    let fail = |path: &Path| {
        let path = path.display().to_string();
        move |source| ReportError::Write { path, source }
    };
    std::fs::create_dir_all(directory).map_err(fail(directory))?;
    for (name, text) in files {
        let path = directory.join(name);
        std::fs::write(&path, text).map_err(fail(&path))?;
    }
    Ok(())
}

/// Columns of `numbers.csv` after name, kind, seed and spheres; SI, as in the JSON files.
const COLUMNS: [(&str, Pick); 14] = [
    ("focal_mean_J", |s| Some(s.focal_mean)),
    ("protected_mean_J", |s| Some(s.protected_mean)),
    ("contrast", |s| s.contrast),
    ("focal_gain", |s| s.focal_gain),
    ("protection", |s| s.protection),
    ("protected_ratio", |s| s.protected_ratio),
    ("work_in_J", |s| Some(s.work_in)),
    ("kinetic_J", |s| Some(s.kinetic)),
    ("stored_J", |s| Some(s.stored)),
    ("dissipated_J", |s| Some(s.dissipated)),
    ("residual", |s| Some(s.residual)),
    ("eq_5_6_J", |s| Some(s.eq_5_6)),
    ("exit_momentum_kg_m_s", |s| Some(s.exit_momentum)),
    ("exit_force_N", |s| Some(s.exit_force)),
];

/// The scores as CSV, one line per arrangement; a ratio without a denominator is an empty cell. With several foci a column each follows for
/// F at it, and one for how evenly they are served.
///
/// # Errors
/// [`ReportError::Csv`].
pub fn numbers_csv(outcome: &Outcome) -> Result<String, ReportError> {
    let fail = |error: &dyn std::fmt::Display| ReportError::Csv(error.to_string());
    let mut writer = csv::Writer::from_writer(Vec::new());
    let foci = outcome.arrangements.iter().map(|a| a.scores.foci.len()).max().unwrap_or(0);
    let mut head: Vec<String> =
        ["name", "kind", "seed", "spheres"].into_iter().chain(COLUMNS.map(|c| c.0)).map(str::to_owned).collect();
    head.extend((1..=foci).map(|k| format!("focus_{k}_mean_J")));
    if foci > 0 {
        head.push("balance".to_owned());
    }
    writer.write_record(&head).map_err(|e| fail(&e))?;
    for arrangement in &outcome.arrangements {
        let seed = arrangement.seed.map_or(String::new(), |seed| seed.to_string());
        let mut cells = vec![arrangement.name.clone(), arrangement.kind.clone(), seed, arrangement.spheres.to_string()];
        let scores = &arrangement.scores;
        let by_focus = (0..foci).map(|k| scores.foci.get(k).copied()).chain((foci > 0).then_some(scores.balance));
        let values =
            COLUMNS.iter().map(|(_, of)| of(scores)).chain(by_focus).map(|value| value.filter(|v| v.is_finite()));
        cells.extend(values.map(|value| value.map_or(String::new(), |v| v.to_string())));
        writer.write_record(&cells).map_err(|e| fail(&e))?;
    }
    let bytes = writer.into_inner().map_err(|e| fail(&e))?;
    String::from_utf8(bytes).map_err(|e| fail(&e))
}

/// The scores without the lists per site, to be serialised.
pub fn numbers(outcome: &Outcome) -> impl Serialize + '_ {
    Numbers::of(outcome)
}

#[derive(Serialize)]
struct Numbers<'a> {
    format: u32,
    name: &'a str,
    version: &'a str,
    diameter_m: f64,
    half_width_m: f64,
    target: &'a Target,
    arrangements: Vec<Numbered<'a>>,
    /// Means and deviations of random kinds over their seeds.
    over_seeds: Vec<OverSeeds<'a>>,
    warnings: &'a [String],
}

#[derive(Serialize)]
struct Numbered<'a> {
    name: &'a str,
    kind: &'a str,
    seed: Option<u64>,
    spheres: usize,
    scores: &'a Scores,
}

#[derive(Serialize)]
struct OverSeeds<'a> {
    kind: &'a str,
    seeds: usize,
    #[serde(rename = "focal_mean_J")]
    focal_mean: Option<Spread>,
    #[serde(rename = "protected_mean_J")]
    protected_mean: Option<Spread>,
    contrast: Option<Spread>,
    focal_gain: Option<Spread>,
    protection: Option<Spread>,
    protected_ratio: Option<Spread>,
    #[serde(rename = "dissipated_J")]
    dissipated: Option<Spread>,
}

impl<'a> Numbers<'a> {
    fn of(outcome: &'a Outcome) -> Self {
        let arrangements = outcome
            .arrangements
            .iter()
            .map(|a| Numbered { name: &a.name, kind: &a.kind, seed: a.seed, spheres: a.spheres, scores: &a.scores })
            .collect();
        let over_seeds = lines(outcome)
            .iter()
            .filter(|line| line.members[0].seed.is_some())
            .map(|line| OverSeeds {
                kind: line.name,
                seeds: line.members.len(),
                focal_mean: line.spread(&FOCAL),
                protected_mean: line.spread(&PROTECTED),
                contrast: line.spread(&CONTRAST),
                focal_gain: line.spread(&GAIN),
                protection: line.spread(&PROTECTION),
                protected_ratio: line.spread(&AGAINST),
                dissipated: line.spread(&DISSIPATED),
            })
            .collect();
        Self {
            format: FORMAT,
            name: &outcome.manifest.name,
            version: &outcome.manifest.version,
            diameter_m: outcome.diameter,
            half_width_m: outcome.half_width,
            target: &outcome.target,
            arrangements,
            over_seeds,
            warnings: &outcome.warnings,
        }
    }
}
