//! Pictures of one simulated rig, from the records in its folder; nothing here simulates.
//!
//! - `maps`: the wave over depth and time, arrivals
//! - `spectrum`: the wave over wave number and frequency
//! - `inside`: from frames, the force network when the focus is loaded most, and how spheres moved past each other

mod inside;
mod maps;
mod spectrum;

use std::path::Path;

use super::chart::{COLOURS, Chart, Line};
use super::frame::{self, Figure, Frame, Provenance};
use super::svg::escape;
use crate::run::{RIG, SUMMARY, Series, Summary};
use crate::units::Dimension::{Force, Length, Speed, Time};

/// Points of a line, at most.
const POINTS: usize = 2000;

/// Lines of one chart, at most.
const LINES: usize = 8;

/// A record that cannot be drawn.
#[derive(Debug, thiserror::Error)]
pub enum RunReportError {
    /// A record that cannot be read.
    #[error(transparent)]
    Series(#[from] crate::run::SeriesError),
    /// A frame that cannot be read.
    #[error(transparent)]
    Frame(#[from] crate::columns::TableError),
    /// The summary or table of spheres cannot be read, or a picture not written.
    #[error("{path}: {reason}")]
    File {
        /// Which.
        path: String,
        /// Why.
        reason: String,
    },
}

/// One line of the table of spheres.
struct Sphere {
    layer: u32,
    centre: Vec<f64>,
    diameter: f64,
    first_material: bool,
}

/// First arrivals by one threshold (s), NaN where there was none.
struct Times {
    dimension: usize,
    values: Vec<f64>,
}

/// Draws what the record of a finished run asks for, into its folder, with a page that holds all of it. Gives the names of the
/// pictures.
///
/// # Errors
/// A file that cannot be read or written.
pub fn draw_run(folder: &Path) -> Result<Vec<String>, RunReportError> {
    let fail =
        |name: &str, reason: String| RunReportError::File { path: folder.join(name).display().to_string(), reason };
    let text = std::fs::read_to_string(folder.join(SUMMARY)).map_err(|error| fail(SUMMARY, error.to_string()))?;
    let summary: Summary = serde_json::from_str(&text).map_err(|error| fail(SUMMARY, error.to_string()))?;
    let mut pictures: Vec<(String, String)> = Vec::new();
    for picture in &summary.pictures {
        match picture.as_str() {
            "x-t" => {
                let record = Series::read(&folder.join("layers.csv"), POINTS)?;
                let (times, layers) = record.columns.split_first().unwrap_or((&EMPTY, &[]));
                if !layers.is_empty() {
                    let title = format!("{}: mean velocity of each layer", summary.name);
                    pictures.push(("x-t.svg".to_owned(), maps::x_t(&title, times, layers)));
                }
            }
            "spectrum" => {
                let record = Series::read(&folder.join("layers.csv"), POINTS)?;
                let (times, layers) = record.columns.split_first().unwrap_or((&EMPTY, &[]));
                let title = format!("{}: spectrum of the layers' mean velocities", summary.name);
                let drawn = spectrum::spectrum(&title, times, layers);
                pictures.extend(drawn.map(|svg| ("spectrum.svg".to_owned(), svg)));
            }
            "velocities" if folder.join("spheres.csv").exists() => {
                let record = Series::read(&folder.join("spheres.csv"), POINTS * summary.recorded.len())?;
                if !record.column("vz_m_s").is_empty() {
                    pictures.push(("velocities.svg".to_owned(), velocities(&summary, &record).svg()));
                }
            }
            "flats" if !summary.flats.is_empty() || !summary.intruders.is_empty() => {
                let read =
                    |name: &str, wanted: bool| wanted.then(|| Series::read(&folder.join(name), POINTS)).transpose();
                let flats = read("flats.csv", !summary.flats.is_empty())?;
                let intruders = read("intruders.csv", !summary.intruders.is_empty())?;
                pictures.push(("flats.svg".to_owned(), pressed(&summary, flats.as_ref(), intruders.as_ref()).svg()));
            }
            "energies" => {
                let record = Series::read(&folder.join("energies.csv"), POINTS)?;
                pictures.push(("energies.svg".to_owned(), energies(&summary, &record).svg()));
            }
            "arrivals" if summary.dimension > 1 => {
                let name = "spheres-final.csv";
                let text = std::fs::read_to_string(folder.join(name)).map_err(|error| fail(name, error.to_string()))?;
                for (k, column) in summary.arrivals.iter().enumerate() {
                    let (spheres, times) = table(&text, summary.dimension, column)
                        .ok_or_else(|| fail(name, format!("is no table of spheres with the column {column}")))?;
                    let title = format!("{}: arrival of the wave", summary.name);
                    let file = if k == 0 { "arrivals.svg".to_owned() } else { format!("arrivals-{}.svg", k + 1) };
                    pictures.push((file, maps::arrivals(&title, &threshold(column), &times, &spheres)));
                }
            }
            _ => {}
        }
    }
    pictures.extend(inside::pictures(folder, &summary)?);
    for (name, svg) in &pictures {
        write(folder, name, svg)?;
    }
    if !pictures.is_empty() {
        // The file as it was run; of old folders it may be missing.
        let text = std::fs::read_to_string(folder.join(RIG)).unwrap_or_default();
        write(folder, "report.html", &page(&summary, &pictures, text))?;
    }
    Ok(pictures.into_iter().map(|(name, _)| name).collect())
}

static EMPTY: Vec<f64> = Vec::new();

fn write(folder: &Path, name: &str, text: &str) -> Result<(), RunReportError> {
    let path = folder.join(name);
    std::fs::write(&path, text)
        .map_err(|error| RunReportError::File { path: path.display().to_string(), reason: error.to_string() })
}

/// Points over microseconds.
fn over_time(times: &[f64], values: &[f64]) -> Vec<[f64; 2]> {
    times.iter().zip(values).map(|(t, v)| [t * 1e6, *v]).collect()
}

/// A few of the recorded spheres, evenly chosen, the first and the last among them.
fn velocities(summary: &Summary, record: &Series) -> Chart {
    let count = summary.recorded.len();
    let chosen: Vec<usize> =
        if count <= LINES { (0..count).collect() } else { (0..LINES).map(|k| k * (count - 1) / (LINES - 1)).collect() };
    let (times, spheres, speeds) = (record.column("time_s"), record.column("sphere"), record.column("vz_m_s"));
    let lines = chosen.iter().enumerate().map(|(k, &which)| {
        let recorded = summary.recorded[which];
        let rows: Vec<usize> = (0..spheres.len()).filter(|&row| spheres[row] == recorded.sphere as f64).collect();
        let name = if summary.dimension == 1 {
            format!("sphere {}", recorded.layer)
        } else {
            format!("layer {}, column {}", recorded.layer, recorded.column)
        };
        Line {
            name,
            colour: COLOURS[k % COLOURS.len()].to_owned(),
            dashed: k >= COLOURS.len(),
            points: rows.iter().map(|&row| [times[row] * 1e6, speeds[row]]).collect(),
        }
    });
    Chart {
        title: format!("{}: velocity along the wave", summary.name),
        labels: ["time (µs)".to_owned(), "velocity (m/s)".to_owned()],
        lines: lines.collect(),
    }
}

/// Forces on flats, along their normals, and on intruders, against the wave.
fn pressed(summary: &Summary, flats: Option<&Series>, intruders: Option<&Series>) -> Chart {
    let of = |record: Option<&Series>, column: String, sign: f64| -> Vec<[f64; 2]> {
        let Some(record) = record else { return Vec::new() };
        let points = over_time(record.column("time_s"), record.column(&column));
        points.into_iter().map(|[t, force]| [t, sign * force * 1e-3]).collect()
    };
    let on_flats = summary.flats.iter().map(|flat| (&flat.name, of(flats, format!("{}_force_N", flat.name), 1.0)));
    let against = summary.intruders.iter().map(|body| (&body.name, of(intruders, format!("{}_Fz_N", body.name), -1.0)));
    let lines = against.chain(on_flats).take(LINES).enumerate().map(|(k, (name, points))| Line {
        name: name.clone(),
        colour: COLOURS[k % COLOURS.len()].to_owned(),
        dashed: k >= COLOURS.len(),
        points,
    });
    let words = match (summary.flats.is_empty(), summary.intruders.is_empty()) {
        (false, true) => "forces that press on flats",
        (true, _) => "forces on intruders, against the wave",
        (false, false) => "forces on flats, and on intruders against the wave",
    };
    Chart {
        title: format!("{}: {words}", summary.name),
        labels: ["time (µs)".to_owned(), "force (kN)".to_owned()],
        lines: lines.collect(),
    }
}

fn energies(summary: &Summary, record: &Series) -> Chart {
    let time = record.column("time_s");
    let known = [
        ("put in", "work_in_J"),
        ("kinetic", "kinetic_J"),
        ("stored in contacts", "stored_J"),
        ("dissipated in contacts", "dissipated_J"),
        ("friction", "friction_J"),
        ("into bars, drag", "absorbed_J"),
        ("potential", "potential_J"),
    ];
    let lines = known.iter().zip(COLOURS).filter_map(|((name, column), colour)| {
        let points = over_time(time, record.column(column));
        let used = points.iter().any(|p| p[1] != 0.0);
        used.then(|| Line { name: (*name).to_owned(), colour: colour.to_owned(), dashed: *name == "put in", points })
    });
    Chart {
        title: format!("{}: where the energy is and went", summary.name),
        labels: ["time (µs)".to_owned(), "energy (J)".to_owned()],
        lines: lines.collect(),
    }
}

/// Reads the table of spheres with one column of arrivals.
fn table(text: &str, dimension: usize, column: &str) -> Option<(Vec<Sphere>, Times)> {
    let mut lines = text.lines();
    let names: Vec<&str> = lines.next()?.split(',').collect();
    let at = |name: &str| names.iter().position(|known| *known == name);
    let (layer, diameter, material, arrival) = (at("layer")?, at("diameter_m")?, at("material")?, at(column)?);
    let axes = [&["z_m"][..], &["x_m", "z_m"], &["x_m", "y_m", "z_m"]][dimension - 1];
    let axes: Vec<usize> = axes.iter().map(|axis| at(axis)).collect::<Option<_>>()?;
    let mut spheres = Vec::new();
    let mut values = Vec::new();
    let mut first = None;
    for line in lines {
        let cells: Vec<&str> = line.split(',').collect();
        let number = |k: usize| cells.get(k).and_then(|cell| cell.parse::<f64>().ok());
        let name = *cells.get(material)?;
        let first_material = *first.get_or_insert(name) == name;
        spheres.push(Sphere {
            layer: number(layer)? as u32,
            centre: axes.iter().map(|&k| number(k)).collect::<Option<_>>()?,
            diameter: number(diameter)?,
            first_material,
        });
        values.push(number(arrival).unwrap_or(f64::NAN));
    }
    Some((spheres, Times { dimension, values }))
}

/// A column's threshold in words.
fn threshold(column: &str) -> String {
    let text = column.strip_prefix("arrival_").and_then(|rest| rest.strip_suffix("_s")).unwrap_or(column);
    let number = |ending: &str| text.strip_suffix(ending).and_then(|number| number.parse::<f64>().ok());
    if let Some(part) = number("_of_own") {
        format!("{} % of the sphere's greatest speed", part * 100.0)
    } else if let Some(part) = number("_of_first") {
        format!("{} % of the first sphere's greatest speed", part * 100.0)
    } else if let Some(speed) = number("_m_s") {
        format!("speed of {}", Speed.show(speed))
    } else {
        number("_m").map_or(text.to_owned(), |distance| format!("moved by {}", Length.show(distance)))
    }
}

/// All pictures on one page that needs no network; `text` is the rig file's.
fn page(summary: &Summary, pictures: &[(String, String)], text: String) -> String {
    let stop = summary
        .stop
        .as_ref()
        .map_or(String::new(), |stop| format!("<p class=\"failure\"><b>Stopped:</b> {}</p>\n", escape(stop)));
    let warned: String = summary
        .warnings
        .iter()
        .map(|warning| format!("<p class=\"warning\"><b>Note.</b> {}</p>\n", escape(warning)))
        .collect();
    let residual =
        summary.residual.map_or(String::new(), |residual| format!(" The energy ledger closes to {residual:.1e}."));
    let verdict = format!(
        "<p>{} spheres in {} layers; {} of {} simulated.{residual}</p>\n{stop}{warned}",
        summary.spheres,
        summary.layers,
        Time.show(summary.time_s),
        Time.show(summary.method.window_s),
    );
    let figures = pictures.iter().map(|(file, svg)| {
        let (caption, numbers) = caption(file);
        Figure { file, svg, caption: caption.to_owned(), numbers: Some(numbers.to_owned()) }
    });
    let energies = summary.energy_rows();
    let energies: Vec<_> =
        energies.into_iter().map(|(name, value)| vec![name.to_owned(), format!("{value:.4e}")]).collect();
    let mut sections = vec![("Where the energy went", frame::table(&["energy", "J"], &energies))];
    let bodies = summary.flats.iter().chain(&summary.intruders).filter(|body| body.peak_force_n > 0.0);
    let bodies: Vec<_> = bodies
        .map(|body| {
            let peak = [Force.show(body.peak_force_n), Time.show(body.peak_time_s)];
            let [force, time] = peak;
            vec![body.name.clone(), force, time, format!("{:.4}", body.velocity_m_s)]
        })
        .collect();
    if !bodies.is_empty() {
        let headings = ["body", "greatest force", "at", "velocity at the end (m/s)"];
        sections.push(("What pressed on bodies", frame::table(&headings, &bodies)));
    }
    let file = if summary.file.is_empty() { "rig.toml" } else { &summary.file };
    let seeds: Vec<String> = summary.seeds.iter().map(u64::to_string).collect();
    // The first takes the place of the file's.
    let seed = summary.seeds.first().map_or(String::new(), |seed| format!(" --seed {seed}"));
    let provenance = Provenance::new(format!("granulens simulate {file}{seed}"), file.to_owned(), text)
        .by(&summary.method)
        .with("Random seeds", if seeds.is_empty() { "none".to_owned() } else { seeds.join(", ") });
    let page = Frame {
        title: &summary.name,
        kind: "One rig, simulated by granulens. Numbers are in trial.json and the tables beside this page.",
        verdict,
        figures: figures.collect(),
        sections,
        provenance,
    };
    page.html()
}

/// What a picture shows, and the table that holds its numbers.
fn caption(file: &str) -> (&'static str, &'static str) {
    match file {
        "x-t.svg" => ("Mean velocity of each layer along the wave, over time.", "layers.csv"),
        "velocities.svg" => ("Velocities of some of the recorded spheres.", "spheres.csv"),
        "flats.svg" => ("Forces on flats and intruders over time.", "flats.csv"),
        "energies.svg" => ("Where the energy is and went, over time.", "energies.csv"),
        _ => ("When the wave came to each sphere; white where it did not.", "spheres-final.csv"),
    }
}
