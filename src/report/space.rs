//! The report of a comparison in space: a section along the axis, layers, the profile across the focal layers, tables.

use std::fmt::Write as _;

use super::chart::{COLOURS, Chart, Line};
use super::colour::Scale;
use super::digits::{short, significant};
use super::files::{ReportError, numbers, numbers_csv, outcome_json};
use super::frame::{Figure, Frame, Provenance, escape_lines};
use super::svg::{Anchor, Svg};
use super::table::{solid_words, space_table};
use super::verdict;
use crate::outcome::{ArrangementOutcome, SpaceOutcome, SpaceSite};
use crate::page::ink;
use crate::score::Measure;
use crate::target::Solid;

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
                 the host alone. Outlined: the focal ({focus}) and the protected region ({protect})."
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

/// What a sphere is painted by.
enum Paint<'a> {
    Material(&'a [u8]),
    Energy(&'a [f64], &'a Scale),
}

impl Paint<'_> {
    fn of(&self, index: usize) -> String {
        match self {
            Self::Material(layout) => ink(layout.get(index).copied().map_or(0, usize::from)).fill.to_owned(),
            Self::Energy(energies, scale) => scale.colour(scale.level(energies.get(index).copied().unwrap_or(0.0))),
        }
    }
}

/// Spheres of both halves, with where a place (m) along and across lies (px).
fn spheres_of<'a>(
    outcome: &'a SpaceOutcome,
    wanted: impl Fn(&SpaceSite) -> bool + 'a,
) -> impl Iterator<Item = (usize, f64, &'a SpaceSite)> {
    let sites = outcome.sites.iter().enumerate().filter(move |(_, site)| wanted(site));
    sites.flat_map(|(index, site)| {
        let sides: &[f64] = if site.x < 1e-9 { &[1.0] } else { &[1.0, -1.0] };
        sides.iter().map(move |side| (index, side * site.x, site))
    })
}

fn outlined(outcome: &SpaceOutcome, site: &SpaceSite) -> Option<&'static str> {
    let as_site =
        crate::lattice::CrystalSite { layer: site.layer, column: site.column, centre: [site.x, site.y, site.z] };
    let holds = |solid: &Solid| solid.contains(&as_site, outcome.diameter);
    if outcome.target.foci.iter().any(|focus| holds(&focus.region)) {
        Some("#d00000")
    } else if holds(&outcome.target.protect) {
        Some("#0050d0")
    } else {
        None
    }
}

fn circle(svg: &mut Svg, centre: [f64; 2], radius: f64, fill: &str, outline: Option<&str>) {
    let stroke = outline.map_or(String::new(), |colour| format!(r#" stroke="{colour}" stroke-width="1.4""#));
    svg.circle(centre, radius, &format!(r#"fill="{fill}"{stroke}"#));
}

/// One and a half times the greatest mean over a region of any arrangement, so that the few spheres that are struck hardest do not darken all others.
fn scale(outcome: &SpaceOutcome) -> Scale {
    let scores = outcome.arrangements.iter().map(|arrangement| &arrangement.scores);
    Scale::linear(1.5 * scores.map(|scores| scores.focal_mean.max(scores.protected_mean)).fold(0.0, f64::max))
}

fn section(outcome: &SpaceOutcome, first: &ArrangementOutcome) -> String {
    let diameter = outcome.diameter;
    let pixel = (300.0 / (2.0 * outcome.half_width / diameter + 1.0)).min(14.0);
    let deepest = outcome.sites.iter().map(|site| site.z).fold(0.0, f64::max) / diameter;
    let (wide, high) = (2.0 * outcome.half_width / diameter * pixel, deepest * pixel);
    let energy = scale(outcome);
    let host = outcome.arrangements.iter().find(|arrangement| arrangement.kind == "all-host");
    let mut panels = vec![
        (first.name.clone() + ": materials", Paint::Material(&first.layout)),
        (first.name.clone(), Paint::Energy(&first.record.max_kinetic, &energy)),
    ];
    if let Some(host) = host {
        panels.push((host.name.clone(), Paint::Energy(&host.record.max_kinetic, &energy)));
    }
    let (left, top, gap) = (30.0, 54.0, 36.0);
    let width = left + panels.len() as f64 * (wide + pixel + gap) + 100.0;
    let mut svg = Svg::new(width, top + high + 2.0 * pixel + 20.0, &outcome.manifest.name);
    svg.text(
        [left, 22.0],
        14.0,
        Anchor::Start,
        r#"font-weight="bold""#,
        &format!("{}: section along the axis, |y| < 0.45 D", outcome.manifest.name),
    );
    let count = panels.len();
    for (k, (name, paint)) in panels.into_iter().enumerate() {
        let middle = left + k as f64 * (wide + pixel + gap) + 0.5 * (wide + pixel);
        svg.text([middle, 42.0], 12.0, Anchor::Middle, "", &name);
        for (index, x, site) in spheres_of(outcome, |site| site.y.abs() < 0.45 * diameter) {
            let at = [middle + x / diameter * pixel, top + 0.5 * pixel + site.z / diameter * pixel];
            circle(&mut svg, at, 0.5 * pixel, &paint.of(index), outlined(outcome, site));
        }
    }
    let bar = [left + count as f64 * (wide + pixel + gap), top + 10.0];
    energy.bar(&mut svg, bar, (high - 20.0).max(60.0), "greatest kinetic energy (J)", 1.0, [true, false]);
    svg.finish()
}

/// The layers that hold anything but the host, those of the foci, and one behind.
fn layers(outcome: &SpaceOutcome, first: &ArrangementOutcome) -> String {
    let diameter = outcome.diameter;
    let last = outcome.sites.iter().map(|site| site.layer).max().unwrap_or(1);
    let held = |layer: u32| {
        outcome.sites.iter().zip(&first.layout).any(|(site, &material)| site.layer == layer && material != 0)
    };
    let focal = |layer: u32| outcome.sites.iter().any(|site| site.layer == layer && outlined(outcome, site).is_some());
    let some = |wanted: &dyn Fn(u32) -> bool, most: usize| -> Vec<u32> {
        let all: Vec<u32> = (1..=last).filter(|&layer| wanted(layer)).collect();
        let stride = all.len().div_ceil(most).max(1);
        all.into_iter().step_by(stride).collect()
    };
    let energy = scale(outcome);
    let mut panels: Vec<(String, u32, Paint)> = Vec::new();
    panels.extend(
        some(&held, 8).into_iter().map(|layer| (format!("layer {layer}"), layer, Paint::Material(&first.layout))),
    );
    let felt = &first.record.max_kinetic;
    panels.extend(
        some(&focal, 4).into_iter().map(|l| (format!("layer {l}, {}", first.name), l, Paint::Energy(felt, &energy))),
    );
    let [low, high] = outcome.sites.iter().fold([0.0_f64; 2], |[a, b], site| [a.min(site.y), b.max(site.y)]);
    let pixel = (150.0 / (2.0 * outcome.half_width / diameter + 1.0)).min(10.0);
    let (wide, tall) = ((2.0 * outcome.half_width / diameter + 1.0) * pixel, ((high - low) / diameter + 1.0) * pixel);
    let (left, top, gap, columns) = (20.0, 40.0, 18.0, 4);
    let rows = panels.len().div_ceil(columns).max(1);
    let size = [left + columns as f64 * (wide + gap) + 100.0, top + rows as f64 * (tall + 36.0) + 10.0];
    let mut svg = Svg::new(size[0], size[1], &outcome.manifest.name);
    svg.text(
        [left, 22.0],
        14.0,
        Anchor::Start,
        r#"font-weight="bold""#,
        &format!("{}: layers from above", outcome.manifest.name),
    );
    for (k, (name, layer, paint)) in panels.iter().enumerate() {
        let corner = [left + (k % columns) as f64 * (wide + gap), top + (k / columns) as f64 * (tall + 36.0) + 20.0];
        svg.text([corner[0] + 0.5 * wide, corner[1] - 6.0], 11.0, Anchor::Middle, "", name);
        for (index, x, site) in spheres_of(outcome, |site| site.layer == *layer) {
            let across = corner[0] + (x / diameter) * pixel + 0.5 * wide;
            let at = [across, corner[1] + ((high - site.y) / diameter + 0.5) * pixel];
            circle(&mut svg, at, 0.5 * pixel, &paint.of(index), outlined(outcome, site));
        }
    }
    let bar = [left + columns as f64 * (wide + gap) + 10.0, top + 20.0];
    energy.bar(
        &mut svg,
        bar,
        (size[1] - top - 60.0).clamp(80.0, 260.0),
        "greatest kinetic energy (J)",
        1.0,
        [true, false],
    );
    svg.finish()
}

/// The first arrangement, the host, and the flat strip of the most F.
fn profile(outcome: &SpaceOutcome) -> String {
    let diameter = outcome.diameter;
    let in_focus = |site: &&SpaceSite| {
        outcome.target.foci.iter().any(|focus| match focus.region {
            Solid::Box { layers: [a, b], .. } | Solid::Cylinder { layers: [a, b], .. } => (a..=b).contains(&site.layer),
            Solid::Sphere { centre, radius } => (site.z - centre[2]).abs() <= radius,
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
    let frame = Frame {
        title: &manifest.name,
        kind: "A comparison in space, simulated by granulens. Numbers are in the tables beside this page.",
        verdict,
        figures: figures.collect(),
        sections: vec![("All arrangements", format!("<pre>{}</pre>\n", escape_lines(&space_table(outcome))))],
        provenance: provenance.by(&manifest.method).with("Impact", manifest.impact.clone()),
    };
    frame.html()
}
