//! The files of a report, as text and on disk.

use std::collections::BTreeMap;
use std::path::Path;

use serde::Serialize;

use super::summary::{Spread, lines};
use super::{drawing, inside, maps, page, profiles, sensitivity, spots};
use crate::outcome::{FORMAT, Inside, Method, Outcome, PartOfNetwork, Scores, Touch, Verdict};
use crate::score::{Measure, Spreads};
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
    let within = outcome.inside.as_ref().and_then(|within| inside::draw_lens(outcome, within));
    pictures.extend(within.map(|svg| ("inside.svg", svg)));
    pictures.extend(outcome.swaps.as_ref().map(|swaps| ("swaps.svg", maps::swaps(outcome, lens, swaps))));
    let derivatives = outcome.sensitivities.iter().flatten();
    pictures.extend(derivatives.flat_map(|of| {
        let own = sensitivity::MAPS.into_iter().filter(|(measure, ..)| *measure == of.measure);
        own.map(|(_, file, names)| (file, sensitivity::map(outcome, lens, of, names)))
    }));
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
    if let Some(within) = &outcome.inside {
        files.push(("contacts.csv".to_owned(), contacts_csv(within)));
        files.push(("damage.csv".to_owned(), damage_csv(outcome, within)));
    }
    if let (Some(of), Some(lens)) = (&outcome.sensitivities, outcome.arrangements.first()) {
        let material = |site: usize| &outcome.materials[usize::from(lens.layout[site])][..];
        files.push(("sensitivity.csv".to_owned(), sensitivity::sensitivity_csv(&outcome.sites, material, of)));
    }
    Ok(files)
}

/// The contacts of the whole sheet at the moment of focus, as `granulens network` reads them; SI.
fn contacts_csv(inside: &Inside) -> String {
    let mut text = format!("# time = {:?} s; period_x = {:?}\n", inside.moment, inside.period);
    text += "i,j,x_i,z_i,x_j,z_j,normal_N,tangential_N\n";
    for Touch(i, k, normal, tangential) in &inside.contacts {
        let [[xi, zi], [xk, zk]] = [i, k].map(|&i| inside.places[i as usize]);
        text += &format!("{},{},{xi},{zi},{xk},{zk},{normal},{tangential}\n", i + 1, k + 1);
    }
    text
}

/// D²_min of every site of the half, empty where there is none; SI.
fn damage_csv(outcome: &Outcome, inside: &Inside) -> String {
    let mut text = "row,column,x,z,d2min\n".to_owned();
    for (site, d2min) in outcome.sites.iter().zip(&inside.d2min) {
        let shown = d2min.map_or(String::new(), |d2min| d2min.to_string());
        text += &format!("{},{},{},{},{shown}\n", site.row, site.column, site.x, site.z);
    }
    text
}

/// The files that hold numbers only: they need no lens and no complete set of arrangements.
fn number_files(outcome: &Outcome) -> Result<Vec<(String, String)>, ReportError> {
    Ok(vec![
        ("numbers.csv".to_owned(), numbers_csv(outcome)?),
        ("numbers.json".to_owned(), serde_json::to_string_pretty(&numbers(outcome))? + "\n"),
        ("spheres.csv".to_owned(), spheres_csv(outcome)),
        ("manifest.json".to_owned(), serde_json::to_string_pretty(&outcome.manifest)? + "\n"),
        ("outcome.json".to_owned(), outcome_json(outcome)?),
    ])
}

/// The whole outcome as JSON.
///
/// # Errors
/// [`ReportError::Json`].
pub fn outcome_json(outcome: &impl Serialize) -> Result<String, ReportError> {
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

/// The scores as CSV, one line per arrangement; a ratio without a denominator is an empty cell. With several foci a column each follows for
/// F at it, and one for how evenly they are served.
///
/// # Errors
/// [`ReportError::Csv`].
pub fn numbers_csv<S, R, P>(outcome: &Outcome<S, R, P>) -> Result<String, ReportError> {
    let fail = |error: &dyn std::fmt::Display| ReportError::Csv(error.to_string());
    let mut writer = csv::Writer::from_writer(Vec::new());
    let foci = outcome.arrangements.iter().map(|a| a.scores.foci.len()).max().unwrap_or(0);
    // Balance stands with the foci, and what no arrangement has is left out.
    let known = |measure: &Measure| outcome.arrangements.iter().any(|a| a.scores.get(*measure).is_some());
    let always = [Measure::Contrast, Measure::FocalGain, Measure::Protection];
    let columns: Vec<Measure> = Measure::ALL
        .iter()
        .copied()
        .filter(|measure| *measure != Measure::Balance && (always.contains(measure) || known(measure)))
        .collect();
    let mut head: Vec<String> = ["name", "kind", "seed"].map(str::to_owned).to_vec();
    head.extend(columns.iter().map(|measure| measure.column().to_owned()));
    head.extend((1..=foci).map(|k| format!("focus_{k}_mean_J")));
    if foci > 0 {
        head.push("balance".to_owned());
    }
    writer.write_record(&head).map_err(|e| fail(&e))?;
    for arrangement in &outcome.arrangements {
        let seed = arrangement.seed.map_or(String::new(), |seed| seed.to_string());
        let mut cells = vec![arrangement.name.clone(), arrangement.kind.clone(), seed];
        let scores = &arrangement.scores;
        let by_focus = (0..foci).map(|k| scores.foci.get(k).copied()).chain((foci > 0).then_some(scores.balance));
        let values = columns
            .iter()
            .map(|&measure| scores.get(measure))
            .chain(by_focus)
            .map(|value| value.filter(|v| v.is_finite()));
        cells.extend(values.map(|value| value.map_or(String::new(), |v| v.to_string())));
        writer.write_record(&cells).map_err(|e| fail(&e))?;
    }
    let bytes = writer.into_inner().map_err(|e| fail(&e))?;
    String::from_utf8(bytes).map_err(|e| fail(&e))
}

/// What every sphere of the simulated half felt in every arrangement, as CSV; SI. The numbers of maps and profiles. Of a piece whose halves
/// differ those of the other half follow, at negative x, with the columns of their images.
pub fn spheres_csv(outcome: &Outcome) -> String {
    let mut text = String::from("arrangement,row,column,x,z,material,max_kinetic_J,max_net_force_N,dissipated_J\n");
    for arrangement in &outcome.arrangements {
        let record = &arrangement.record;
        let sites = outcome.sites.len();
        for index in 0..sites.max(arrangement.layout.len()) {
            let site = &outcome.sites[index % sites];
            let x = if index < sites { site.x } else { -site.x };
            if index >= sites && site.x == 0.0 {
                continue;
            }
            let value = |list: &[f64]| maps::at(list, index).map_or(String::new(), |value| value.to_string());
            let place = arrangement.layout.get(index).copied().map_or(usize::MAX, usize::from);
            let material = outcome.materials.get(place).map_or("", String::as_str);
            text += &format!(
                "{},{},{},{},{},{material},{},{},{}\n",
                arrangement.name,
                site.row,
                site.column,
                x,
                site.z,
                value(&record.max_kinetic),
                value(&record.max_net_force),
                value(&record.dissipated)
            );
        }
    }
    text
}

/// The scores without the lists per site, to be serialised.
pub fn numbers<S, R: Serialize, P: Serialize>(outcome: &Outcome<S, R, P>) -> impl Serialize + '_ {
    Numbers::of(outcome)
}

#[derive(Serialize)]
struct Numbers<'a, R> {
    format: u32,
    name: &'a str,
    #[serde(flatten)]
    method: &'a Method,
    /// The first arrangement against the best flat, uniform and random one, over these forces.
    verdict: &'a [Verdict],
    #[serde(rename = "forces_N")]
    forces: &'a [f64],
    #[serde(rename = "speeds_m_s", skip_serializing_if = "<[f64]>::is_empty")]
    speeds: &'a [f64],
    /// Names of the materials, the host first, and of that of all-lens, strips and mixtures, to which Q refers.
    materials: &'a [String],
    reference: Option<&'a str>,
    proposal: Option<serde_json::Value>,
    diameter_m: f64,
    half_width_m: f64,
    target: &'a Target<R>,
    arrangements: Vec<Numbered<'a>>,
    /// Means and deviations of random kinds over their seeds.
    over_seeds: Vec<OverSeeds<'a>>,
    /// The force network of the first at the moment of focus, part by part.
    #[serde(skip_serializing_if = "Option::is_none")]
    inside: Option<Within<'a>>,
    warnings: &'a [String],
}

#[derive(Serialize)]
struct Numbered<'a> {
    name: &'a str,
    kind: &'a str,
    seed: Option<u64>,
    scores: &'a Scores,
    #[serde(skip_serializing_if = "Option::is_none")]
    over_forces: Option<&'a Spreads>,
    #[serde(skip_serializing_if = "Option::is_none")]
    simulated: Option<&'a (String, f64)>,
    #[serde(skip_serializing_if = "Option::is_none")]
    simulated_fraction: Option<f64>,
}

#[derive(Serialize)]
struct OverSeeds<'a> {
    kind: &'a str,
    seeds: usize,
    /// Below the column of each measure.
    #[serde(flatten)]
    measures: BTreeMap<&'static str, Spread>,
}

#[derive(Serialize)]
struct Within<'a> {
    moment_s: f64,
    parts: &'a [PartOfNetwork],
}

/// A proposal in numbers, without what is only drawn.
fn without_lines(proposal: &impl Serialize) -> Option<serde_json::Value> {
    let mut value = serde_json::to_value(proposal).ok()?;
    let numbers = value.as_object_mut()?;
    for key in ["faces_m", "rays_m", "spots"] {
        numbers.remove(key);
    }
    Some(value)
}

impl<'a, R> Numbers<'a, R> {
    fn of<S, P: Serialize>(outcome: &'a Outcome<S, R, P>) -> Self {
        let arrangements = outcome
            .arrangements
            .iter()
            .map(|a| Numbered {
                name: &a.name,
                kind: &a.kind,
                seed: a.seed,
                scores: &a.scores,
                over_forces: a.over_forces.as_ref(),
                simulated: a.simulated.as_ref(),
                simulated_fraction: a.simulated_fraction,
            })
            .collect();
        let over_seeds = lines(outcome)
            .iter()
            .filter(|line| line.members[0].seed.is_some())
            .map(|line| OverSeeds {
                kind: line.name,
                seeds: line.members.len(),
                measures: Measure::ALL
                    .iter()
                    .filter_map(|&measure| Some((measure.column(), line.spread(measure)?)))
                    .collect(),
            })
            .collect();
        Self {
            format: FORMAT,
            name: &outcome.manifest.name,
            method: &outcome.manifest.method,
            verdict: &outcome.verdict,
            forces: &outcome.forces,
            speeds: &outcome.speeds,
            materials: &outcome.materials,
            reference: outcome.reference.as_deref(),
            proposal: outcome.proposal.as_ref().and_then(without_lines),
            diameter_m: outcome.diameter,
            half_width_m: outcome.half_width,
            target: &outcome.target,
            arrangements,
            over_seeds,
            inside: outcome.inside.as_ref().map(|inside| Within { moment_s: inside.moment, parts: &inside.parts }),
            warnings: &outcome.warnings,
        }
    }
}
