//! An impact on a granular bed as pictures: depth, force and energies over time, the bed at the hardest moment.

use super::chart::{COLOURS, Chart, Line};
use super::colour::Scale;
use super::frame::{Figure, Frame, Provenance, prose};
use super::svg::{Anchor, Svg};
use crate::bed::{Bed, BedImpact, Course, Disk, Measures, Moment, Sound};

/// The pictures of an impact by their file names, and a page with all of them.
pub struct BedPictures {
    /// File name and SVG.
    pub pictures: Vec<(&'static str, String)>,
    /// The page, complete in itself.
    pub page: String,
}

/// All that is known of an impact.
#[derive(Clone, Copy, Debug)]
pub struct BedRecord<'a> {
    /// What was wanted.
    pub impact: &'a BedImpact,
    /// The bed before.
    pub bed: &'a Bed,
    /// How it was packed.
    pub measures: &'a Measures,
    /// How sound runs through it, if that was measured.
    pub sound: Option<&'a Sound>,
    /// What the intruder did.
    pub course: &'a Course,
}

/// Draws an impact; `words` stand on the page above the pictures, `provenance` below.
pub fn draw_bed(name: &str, record: &BedRecord<'_>, words: &str, provenance: Provenance) -> BedPictures {
    let &BedRecord { impact, bed, measures, sound: heard, course } = record;
    let speed = impact.intruder.speed;
    let mut pictures = vec![
        ("depth.svg", depth(name, speed, course)),
        ("force.svg", force(name, speed, course)),
        ("energy.svg", energy(name, course)),
        ("bed.svg", snapshot(name, bed, course)),
        ("pair-correlation.svg", correlation(name, measures)),
    ];
    pictures.extend(heard.map(|heard| ("sound.svg", sound(name, heard))));
    let verdict = prose(words);
    let figures = pictures.iter().map(|(file, svg)| {
        let (caption, numbers) = match *file {
            "depth.svg" => ("Depth of the intruder's lowest point below the surface before the impact.", "impact.csv"),
            "force.svg" => ("Force of the grains on the intruder.", "impact.csv"),
            "energy.svg" => ("Where the energy of grains and intruder is and went.", "impact.csv"),
            "bed.svg" => ("The bed at the hardest moment.", "grains.csv"),
            "sound.svg" => ("What reached the bottom of a push on the top.", "sound.csv"),
            _ => ("Pair correlation of the bed before the impact.", "pair-correlation.csv"),
        };
        Figure { file, svg, caption: caption.to_owned(), numbers: Some(numbers.to_owned()) }
    });
    let units = "<p>Lengths in mean grain diameters d, times in collision times τ_c, masses in that of a grain of diameter d \
                 (Kondic et al. 2012).</p>\n";
    let page = Frame {
        title: name,
        kind: "An impact on a granular bed, simulated by granulens. Numbers are in impact.json and the tables beside this page.",
        verdict,
        figures: figures.collect(),
        sections: vec![("Units", units.to_owned())],
        provenance,
    };
    let page = page.html();
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
        ("stored, against start", |m| m.energy.stored + m.energy.tangential_stored),
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

/// What reached the bottom of a push on the top, and when it counts as arrived.
fn sound(name: &str, sound: &Sound) -> String {
    let most = sound.bottom.iter().map(|[_, change]| *change).fold(0.0, f64::max);
    let arrival = Line {
        dashed: true,
        ..line(
            &format!("5 %, at {:.1} τ_c", sound.arrival),
            1,
            [[sound.arrival, 0.0], [sound.arrival, most]].into_iter(),
        )
    };
    let chart = Chart {
        title: format!("{name}: a push on the top as the bottom feels it; speed {:.2} d/τ_c", sound.speed),
        labels: ["time from the push (τ_c)".to_owned(), "change of the force (m d/τ_c²)".to_owned()],
        lines: vec![arrival, line("on the bottom", 0, sound.bottom.iter().copied())],
    };
    chart.svg()
}

/// Side of a diameter (px).
const GRAIN: f64 = 7.0;

/// How much of a wide bed a picture shows (d).
const SHOWN: f64 = 200.0;

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
    // Of a wide bed what is around the intruder.
    let shown = bed.width.min(SHOWN);
    let middle = match shot.intruder.first() {
        Some(disk) if shown < bed.width => disk.centre[0],
        _ => 0.5 * bed.width,
    };
    let (width, height) = (shown * GRAIN, (top + 1.0) * GRAIN);
    let mut svg = Svg::new(left + width + 120.0, upper + height + 20.0, name);
    let title = format!("{name}: normal forces at {:.1} τ_c, when the force on the intruder is greatest", shot.time);
    let title = if shown < bed.width { format!("{title}; {SHOWN} of {} d", bed.width) } else { title };
    svg.text([left, 24.0], 14.0, Anchor::Start, r#"font-weight="bold""#, &title);
    // From the middle of what is shown; of grains the image that is nearest to it.
    let nearest = |x: f64| match bed.periodic {
        true => (x - middle + 0.5 * bed.width).rem_euclid(bed.width) - 0.5 * bed.width,
        false => x - middle,
    };
    let place = |[x, y]: [f64; 2]| [left + (0.5 * shown + x) * GRAIN, upper + (top - y) * GRAIN];
    let is_shown = |x: f64, disk: &Disk| nearest(x).abs() < 0.5 * (shown + disk.diameter);
    // Nine in ten grains of the upper part of the distribution fit into the scale.
    let mut sorted = shot.force.clone();
    sorted.sort_by(f64::total_cmp);
    let most = sorted[(sorted.len() * 995 / 1000).min(sorted.len() - 1)].max(f64::MIN_POSITIVE);
    let scale = Scale::linear(most);
    svg.clipped([left, upper], [width, height], |svg| {
        for disk in bed.walls.iter().filter(|disk| is_shown(disk.centre[0], disk)) {
            let [x, y] = disk.centre;
            svg.circle(place([nearest(x), y]), 0.5 * disk.diameter * GRAIN, r##"fill="#777""##);
        }
        for ((disk, [x, y]), force) in bed.grains.iter().zip(&shot.centres).zip(&shot.force) {
            if is_shown(*x, disk) {
                let fill = super::colour::level(scale.level(*force));
                let attributes = format!(r##"fill="{fill}" stroke="#666" stroke-width="0.25""##);
                svg.circle(place([nearest(*x), *y]), 0.5 * disk.diameter * GRAIN, &attributes);
            }
        }
        let middled = |[x, y]: [f64; 2]| place([x - middle, y]);
        if let [a, b] = shot.intruder.as_slice()
            && a.diameter == 0.0
        {
            svg.line(middled(a.centre), middled(b.centre), r##"stroke="#222" stroke-width="4""##);
        }
        for disk in shot.intruder.iter().filter(|disk| disk.diameter > 0.0) {
            let attributes = r##"fill="#dfe6ee" stroke="#223" stroke-width="1""##;
            svg.circle(middled(disk.centre), 0.5 * disk.diameter * GRAIN, attributes);
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
