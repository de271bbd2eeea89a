//! The report of a comparison in space: a section along the axis, layers, the profile across the focal layers, tables.

use std::borrow::Cow;
use std::fmt::Write as _;

use super::chart::{COLOURS, Chart, Line};
use super::colour::Scale;
use super::digits::{short, significant};
use super::files::{ReportError, numbers, numbers_csv, outcome_json};
use super::frame::{Figure, Frame, Provenance};
use super::slices::{Paint, Slices};
use super::table::{solid_words, space_section};
use super::turned::turned;
use super::verdict;
use crate::outcome::{ArrangementOutcome, SpaceOutcome, SpaceSite};
use crate::score::Measure;
use crate::target::SpaceRegion;

/// Every file of the report but the layouts: name and contents. The same outcome gives the same bytes.
///
/// # Errors
/// An outcome without arrangements, or numbers that cannot be written.
pub fn space_files(outcome: &SpaceOutcome) -> Result<Vec<(String, String)>, ReportError> {
    let pictures = draw_space(outcome)?;
    let page = page(outcome, &pictures);
    let mut files: Vec<(String, String)> = pictures.into_iter().map(|(name, svg, _)| (name.to_owned(), svg)).collect();
    files.push(("report.html".to_owned(), page));
    files.push(("numbers.csv".to_owned(), numbers_csv(outcome)?));
    files.push(("numbers.json".to_owned(), serde_json::to_string_pretty(&numbers(outcome))? + "\n"));
    files.push(("spheres.csv".to_owned(), spheres(outcome)));
    files.push(("manifest.json".to_owned(), serde_json::to_string_pretty(&outcome.manifest)? + "\n"));
    files.push(("outcome.json".to_owned(), outcome_json(outcome)?));
    Ok(files)
}

/// The pictures by their file names, each with what is seen.
///
/// # Errors
/// An outcome without arrangements.
pub fn draw_space(outcome: &SpaceOutcome) -> Result<Vec<(&'static str, String, String)>, ReportError> {
    let first = outcome.arrangements.first().ok_or(ReportError::Empty)?;
    let diameter = outcome.diameter;
    let focus = outcome.target.foci.first().map(|focus| solid_words(&focus.region, diameter)).unwrap_or_default();
    let protect = solid_words(&outcome.target.protect, diameter);
    Ok(vec![
        (
            "section.svg",
            section(outcome, first),
            format!(
                "Spheres within 0.45 D of the plane y = 0, both halves: materials, and each sphere's greatest kinetic energy, beside that of \
                 the host alone. Outlined: the focal region solid ({focus}), the protected one dashed ({protect})."
            ),
        ),
        (
            "layers.svg",
            layers(outcome, first),
            "Layers from above: what they hold, and each sphere's greatest kinetic energy.".to_owned(),
        ),
        (
            "profile.svg",
            profile(outcome),
            "Greatest kinetic energy in the focal layers, mean over rings one diameter wide.".to_owned(),
        ),
    ])
}

/// One and a half times the greatest mean over a region of any arrangement, so that the few spheres that are struck hardest do not darken all others.
fn scale(outcome: &SpaceOutcome) -> Scale {
    let scores = outcome.arrangements.iter().map(|arrangement| &arrangement.scores);
    Scale::linear(1.5 * scores.map(|scores| scores.focal_mean.max(scores.protected_mean)).fold(0.0, f64::max))
}

fn slices(outcome: &SpaceOutcome) -> Slices<'_> {
    Slices {
        name: &outcome.manifest.name,
        sites: Cow::Borrowed(&outcome.sites),
        target: &outcome.target,
        diameter: outcome.diameter,
        half_width: outcome.half_width,
    }
}

fn section(outcome: &SpaceOutcome, first: &ArrangementOutcome) -> String {
    let energy = scale(outcome);
    let host = outcome.arrangements.iter().find(|arrangement| arrangement.kind == "all-host");
    let mut panels = vec![
        (first.name.clone() + ": materials", Paint::Material(&first.layout)),
        (first.name.clone(), Paint::Energy(&first.record.max_kinetic, &energy)),
    ];
    if let Some(host) = host {
        panels.push((host.name.clone(), Paint::Energy(&host.record.max_kinetic, &energy)));
    }
    slices(outcome).section(&panels, Some(&energy))
}

/// The layers that hold anything but the host, and those of the foci.
fn layers(outcome: &SpaceOutcome, first: &ArrangementOutcome) -> String {
    let (slices, energy) = (slices(outcome), scale(outcome));
    let felt = &first.record.max_kinetic;
    let mut panels: Vec<(String, u32, Paint)> = Vec::new();
    let held = slices.holding(&first.layout, 8).into_iter();
    panels.extend(held.map(|layer| (format!("layer {layer}"), layer, Paint::Material(&first.layout))));
    let scored = slices.scored(4).into_iter();
    panels.extend(scored.map(|l| (format!("layer {l}, {}", first.name), l, Paint::Energy(felt, &energy))));
    slices.layers(&panels, Some(&energy))
}

/// The first arrangement, the host, and the flat strip of the most F.
fn profile(outcome: &SpaceOutcome) -> String {
    let diameter = outcome.diameter;
    let in_focus = |site: &&SpaceSite| {
        outcome.target.foci.iter().any(|focus| match focus.region {
            SpaceRegion::Box { layers: [a, b], .. } | SpaceRegion::Cylinder { layers: [a, b], .. } => {
                (a..=b).contains(&site.layer)
            }
            SpaceRegion::Sphere { centre, radius } => (site.z - centre[2]).abs() <= radius,
        })
    };
    let rings = (outcome.half_width / diameter).floor() as usize + 1;
    let mean = |arrangement: &ArrangementOutcome| -> Vec<[f64; 2]> {
        let mut sums = vec![[0.0; 2]; rings];
        for (site, energy) in
            outcome.sites.iter().zip(&arrangement.record.max_kinetic).filter(|(site, _)| in_focus(site))
        {
            let ring = (site.x.hypot(site.y) / diameter + 0.5 + 1e-9) as usize;
            if let Some(sum) = sums.get_mut(ring) {
                sum[0] += f64::from(site.copies) * energy;
                sum[1] += f64::from(site.copies);
            }
        }
        let points = sums.iter().enumerate().filter(|(_, sum)| sum[1] > 0.0);
        points.map(|(ring, [energy, count])| [ring as f64, energy / count]).collect()
    };
    let line = |arrangement: &ArrangementOutcome, colour: usize, dashed: bool| Line {
        name: arrangement.name.clone(),
        colour: COLOURS[colour].to_owned(),
        dashed,
        points: mean(arrangement),
    };
    let of = |kind: &str| outcome.arrangements.iter().find(|arrangement| arrangement.kind == kind);
    let flat = |a: &&ArrangementOutcome| a.kind.starts_with("flat-") || a.kind.starts_with("strip-");
    let best =
        outcome.arrangements.iter().filter(flat).max_by(|a, b| a.scores.focal_mean.total_cmp(&b.scores.focal_mean));
    let mut lines: Vec<Line> = of("all-host").map(|host| line(host, 5, true)).into_iter().collect();
    lines.extend(best.map(|best| line(best, 1, false)));
    lines.extend(outcome.arrangements.first().map(|first| line(first, 0, false)));
    let chart = Chart {
        title: format!("{}: focal layers", outcome.manifest.name),
        labels: ["distance from the axis (D)".to_owned(), "mean greatest kinetic energy (J)".to_owned()],
        lines,
    };
    chart.svg()
}

fn spheres(outcome: &SpaceOutcome) -> String {
    let mut text = String::from("arrangement,layer,column,x,y,z,material,max_kinetic_J\n");
    for arrangement in &outcome.arrangements {
        for ((site, &material), energy) in
            outcome.sites.iter().zip(&arrangement.layout).zip(&arrangement.record.max_kinetic)
        {
            let name = outcome.materials.get(usize::from(material)).map_or("", String::as_str);
            let SpaceSite { layer, column, x, y, z, .. } = site;
            let _ = writeln!(text, "{},{layer},{column},{x},{y},{z},{name},{energy}", arrangement.name);
        }
    }
    text
}

fn page(outcome: &SpaceOutcome, pictures: &[(&'static str, String, String)]) -> String {
    let mut verdict = format!("<p>Verdict over {}:</p>\n<ul>\n", super::svg::escape(&verdict::over(outcome)));
    for line in verdict::lines(outcome) {
        let _ = writeln!(verdict, "<li>{}</li>", super::svg::escape(&line));
    }
    verdict.push_str("</ul>\n");
    let of = |measure: Measure| {
        let each = outcome.arrangements.iter().filter_map(|a| Some((a, a.scores.get(measure)?)));
        each.reduce(|a, b| if measure.best(b.1, a.1) == b.1 && a.1 != b.1 { b } else { a })
    };
    if let Some((best, value)) = of(Measure::FocalGain) {
        let _ = writeln!(
            verdict,
            "<p>Of all arrangements {} has the greatest G, {}, with C {}.</p>",
            super::svg::escape(&best.name),
            significant(value, 3),
            best.scores.contrast.map_or("none".to_owned(), short)
        );
    }
    let figures = pictures.iter().map(|(file, svg, caption)| Figure {
        file,
        svg,
        caption: caption.clone(),
        numbers: Some("spheres.csv".to_owned()),
    });
    let manifest = &outcome.manifest;
    let provenance = Provenance::new(
        manifest.command.clone().unwrap_or_default(),
        manifest.design_file.clone(),
        manifest.design.clone(),
    );
    let energy = scale(outcome);
    let (view, script) = match outcome.arrangements.first() {
        Some(first) => {
            let felt = (&first.record.max_kinetic[..], &energy);
            turned(&slices(outcome), &first.layout, &outcome.materials, Some(felt))
        }
        None => (String::new(), String::new()),
    };
    let frame = Frame {
        title: &manifest.name,
        kind: "A comparison in space, simulated by granulens. Numbers are in the tables beside this page.",
        verdict,
        figures: figures.collect(),
        sections: vec![("Turned by hand", view), ("All arrangements", space_section(outcome))],
        provenance: provenance.by(&manifest.method).with("Impact", manifest.impact.clone()),
    };
    frame.html_with(&script)
}
