//! An impact on a granular bed as pictures: depth, force and energies over time, the bed at the hardest moment.

use super::chart::{COLOURS, Chart, Line};
use super::colour::Scale;
use super::plain_page::plain_page;
use super::svg::{Anchor, Svg, escape};
use crate::bed::{Bed, BedImpact, Course, Measures, Moment};

/// The pictures of an impact by their file names, and a page with all of them.
pub struct BedPictures {
    /// File name and SVG.
    pub pictures: Vec<(&'static str, String)>,
    /// The page, complete in itself.
    pub page: String,
}

/// Draws an impact; `words` stand on the page above the pictures.
pub fn draw_bed(
    name: &str,
    impact: &BedImpact,
    bed: &Bed,
    measures: &Measures,
    course: &Course,
    words: &str,
) -> BedPictures {
    let speed = impact.intruder.speed;
    let pictures = vec![
        ("depth.svg", depth(name, speed, course)),
        ("force.svg", force(name, speed, course)),
        ("energy.svg", energy(name, course)),
        ("bed.svg", snapshot(name, bed, course)),
        ("pair-correlation.svg", correlation(name, measures)),
    ];
    let words = words.lines().map(escape).collect::<Vec<_>>().join("\n");
    let above = format!(
        "<pre>{words}</pre>\n<p>Lengths in mean grain diameters d, times in collision times τ_c, masses in that of a grain of \
         diameter d (Kondic et al. 2012).</p>\n"
    );
    let page = plain_page(name, &above, pictures.iter().map(|(_, svg)| svg.as_str()));
    BedPictures { pictures, page }
}

fn line(name: &str, colour: usize, points: impl Iterator<Item = [f64; 2]>) -> Line {
    Line { name: name.to_owned(), colour: COLOURS[colour].to_owned(), dashed: false, points: points.collect() }
}

fn depth(name: &str, speed: f64, course: &Course) -> String {
    let end = course.moments.last().map_or(0.0, |m| m.time);
    let rest = Line {
        dashed: true,
        ..line("where it stays", 1, [[0.0, course.final_depth], [end, course.final_depth]].into_iter())
    };
    let chart = Chart {
        title: format!("{name}: depth of the intruder, struck at {speed} d/τ_c"),
        labels: ["time (τ_c)".to_owned(), "depth below the surface (d)".to_owned()],
        lines: vec![rest, line("depth D", 0, course.moments.iter().map(|m| [m.time, m.depth]))],
    };
    chart.svg()
}

fn force(name: &str, speed: f64, course: &Course) -> String {
    let of = |k: usize| course.moments.iter().map(move |m| [m.time, m.force[k]]);
    let chart = Chart {
        title: format!("{name}: force of the grains on the intruder, struck at {speed} d/τ_c"),
        labels: ["time (τ_c)".to_owned(), "force (m d/τ_c²)".to_owned()],
        lines: vec![line("sideways", 6, of(0)), line("upwards", 0, of(1))],
    };
    chart.svg()
}

fn energy(name: &str, course: &Course) -> String {
    type Part = (&'static str, fn(&Moment) -> f64);
    let base = course.moments.first().map_or(0.0, |m| m.energy.stored);
    let parts: [Part; 5] = [
        ("kinetic", |m| m.energy.kinetic),
        ("stored, against start", |m| m.energy.stored + m.energy.wound),
        ("potential, against start", |m| m.energy.potential),
        ("lost along normals", |m| m.energy.dissipated),
        ("lost by friction", |m| m.energy.friction),
    ];
    let lines = parts.into_iter().enumerate().map(|(k, (name, of))| {
        let offset = if k == 1 { base } else { 0.0 };
        line(name, k, course.moments.iter().map(move |m| [m.time, of(m) - offset]))
    });
    let chart = Chart {
        title: format!("{name}: where the energy of grains and intruder is and went"),
        labels: ["time (τ_c)".to_owned(), "energy (m d²/τ_c²)".to_owned()],
        lines: lines.collect(),
    };
    chart.svg()
}

fn correlation(name: &str, measures: &Measures) -> String {
    let chart = Chart {
        title: format!("{name}: pair correlation of the bed before the impact"),
        labels: ["distance of centres (d)".to_owned(), "g(r)".to_owned()],
        lines: vec![line("g(r)", 0, measures.pair_correlation.iter().copied())],
    };
    chart.svg()
}

/// Side of a diameter (px).
const GRAIN: f64 = 7.0;

/// Grains coloured by the force they feel when that on the intruder is greatest.
fn snapshot(name: &str, bed: &Bed, course: &Course) -> String {
    let shot = &course.snapshot;
    if shot.centres.is_empty() {
        let mut svg = Svg::new(500.0, 60.0, "no impact");
        svg.text([20.0, 36.0], 13.0, Anchor::Start, "", "The intruder has not met the bed in the time followed.");
        return svg.finish();
    }
    let high = shot.intruder.iter().map(|d| d.centre[1] + 0.5 * d.diameter);
    let top = shot.centres.iter().map(|c| c[1]).chain(high).fold(0.0, f64::max) + 2.0;
    let [left, upper] = [20.0, 44.0];
    let (width, height) = (bed.width * GRAIN, (top + 1.0) * GRAIN);
    let mut svg = Svg::new(left + width + 120.0, upper + height + 20.0, name);
    let title = format!("{name}: normal forces at {:.1} τ_c, when the force on the intruder is greatest", shot.time);
    svg.text([left, 24.0], 14.0, Anchor::Start, r#"font-weight="bold""#, &title);
    let place = |[x, y]: [f64; 2]| [left + x * GRAIN, upper + (top - y) * GRAIN];
    // Nine in ten grains of the upper part of the distribution fit into the scale.
    let mut sorted = shot.force.clone();
    sorted.sort_by(f64::total_cmp);
    let most = sorted[(sorted.len() * 995 / 1000).min(sorted.len() - 1)].max(f64::MIN_POSITIVE);
    let scale = Scale::linear(most);
    svg.clipped([left, upper], [width, height], |svg| {
        for disk in &bed.walls {
            svg.circle(place(disk.centre), 0.5 * disk.diameter * GRAIN, r##"fill="#777""##);
        }
        for ((disk, centre), force) in bed.grains.iter().zip(&shot.centres).zip(&shot.force) {
            let x = if bed.periodic { centre[0].rem_euclid(bed.width) } else { centre[0] };
            let fill = super::colour::level(scale.level(*force));
            let attributes = format!(r##"fill="{fill}" stroke="#666" stroke-width="0.25""##);
            svg.circle(place([x, centre[1]]), 0.5 * disk.diameter * GRAIN, &attributes);
        }
        if let [a, b] = shot.intruder.as_slice()
            && a.diameter == 0.0
        {
            svg.line(place(a.centre), place(b.centre), r##"stroke="#222" stroke-width="4""##);
        }
        for disk in shot.intruder.iter().filter(|disk| disk.diameter > 0.0) {
            let attributes = r##"fill="#dfe6ee" stroke="#223" stroke-width="1""##;
            svg.circle(place(disk.centre), 0.5 * disk.diameter * GRAIN, attributes);
        }
    });
    svg.rectangle([left, upper], [width, height], r##"fill="none" stroke="#555""##);
    scale.bar(
        &mut svg,
        [left + width + 24.0, upper + 14.0],
        height.min(300.0) - 14.0,
        "force (m d/τ_c²)",
        1.0,
        [true, false],
    );
    svg.finish()
}
