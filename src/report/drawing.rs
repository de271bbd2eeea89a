//! The lens as it would be built: every sphere in true proportion, with colour, letter and hatching of its material.

use super::colour::{material, round_up};
use super::crystal::{Crystal, Extent};
use super::svg::{Anchor, Shapes, Svg};
use crate::outcome::{ArrangementOutcome, Outcome};
use crate::page::{Hatch, Ink, ink};

/// Room for the crystal (px).
const ROOM: [f64; 2] = [620.0, 900.0];

/// Width that the legend needs (px).
const LEGEND: f64 = 620.0;

/// Margins around the crystal: left (row numbers), top (impact), right, bottom (legend) (px).
const MARGIN: [f64; 4] = [52.0, 78.0, 24.0, 132.0];

/// Line of the ideal lens faces.
const FACE: &str = r##"stroke="#1f4e9c" stroke-width="3" stroke-linecap="round""##;
/// Line of the rays.
const RAY: &str = r##"stroke="#c0202a" stroke-width="1.1" stroke-opacity="0.85""##;

/// The arrangement of an outcome's first entry, the lens: both halves, with the impact, the ideal faces, rays, regions,
/// row numbers, a legend and a scale bar.
pub fn layout(outcome: &Outcome, arrangement: &ArrangementOutcome) -> String {
    let crystal = Crystal::new(outcome, Extent::Both, [MARGIN[0], MARGIN[1]], ROOM);
    let [width, height] = crystal.size();
    let (full_width, full_height) = (MARGIN[0] + width.max(LEGEND) + MARGIN[2], MARGIN[1] + height + MARGIN[3]);
    let title = format!("{}: layout of {}", outcome.manifest.name, arrangement.name);
    let mut svg = Svg::new(full_width, full_height, &title);

    impact(&mut svg, &crystal, &outcome.manifest.impact);
    spheres(&mut svg, &crystal, outcome.materials.len(), &arrangement.layout);
    axis(&mut svg, &crystal);
    if let Some(proposal) = &outcome.proposal {
        crystal.rays(&mut svg, proposal, RAY);
        crystal.faces(&mut svg, proposal, r##"stroke="#fff" stroke-width="5" stroke-linecap="round""##);
        crystal.faces(&mut svg, proposal, FACE);
    }
    crystal.regions(&mut svg, 2.0);
    crystal.name_regions(&mut svg, 13.0);
    crystal.row_numbers(&mut svg, 11.0);
    svg.text_upwards([14.0, MARGIN[1] + height / 2.0], 12.0, "", "row, counted along the wave (depth z)");
    legend(&mut svg, outcome, arrangement, MARGIN[1] + height + 40.0);
    scale_bar(&mut svg, &crystal, outcome, [MARGIN[0] + width.max(LEGEND), MARGIN[1] + height + 40.0]);
    svg.finish()
}

/// Arrows on row 1: every sphere of it is struck.
pub(super) fn impact(svg: &mut Svg, crystal: &Crystal, words: &str) {
    let ([left, top], [width, _]) = (crystal.corner(), crystal.size());
    let text = format!("impact: {words}");
    svg.text([left + width / 2.0, 24.0], 13.0, Anchor::Middle, r#"font-weight="bold""#, &text);
    let count = (width / 46.0).floor().max(1.0) as usize;
    for k in 0..count {
        let x = left + width * (k as f64 + 0.5) / count as f64;
        svg.line([x, 36.0], [x, top - 12.0], r##"stroke="#222" stroke-width="2""##);
        svg.polygon(&[[x - 5.0, top - 14.0], [x + 5.0, top - 14.0], [x, top - 3.0]], r##"fill="#222""##);
    }
}

/// One group per material, so that a thousand circles share one colour.
pub(super) fn spheres(svg: &mut Svg, crystal: &Crystal, materials: usize, layout: &[u8]) {
    let radius = crystal.diameter() / 2.0 - 0.4;
    for index in 0..materials {
        let style = format!(r##"fill="{}" stroke="#444" stroke-width="0.5""##, material(index));
        svg.group(&style, |svg| {
            for (site, _) in layout.iter().enumerate().filter(|&(_, &m)| usize::from(m) == index) {
                for place in crystal.places(site, layout.len()) {
                    svg.circle(place, radius, "");
                }
            }
        });
        let places = (0..layout.len()).filter(|&site| usize::from(layout[site]) == index);
        let places: Vec<[f64; 2]> =
            places.flat_map(|site| crystal.places(site, layout.len()).collect::<Vec<_>>()).collect();
        mark(svg, index, &places, radius);
    }
}

/// Smaller spheres (px) bear no letters, which nobody could read.
const LEGIBLE: f64 = 5.0;

/// Hatching and letter of a material on its spheres, by which it is known without its colour; the host, of which most are, is the one without.
fn mark(svg: &mut Svg, index: usize, places: &[[f64; 2]], radius: f64) {
    let Ink { text, letter, .. } = ink(index);
    let mut lines = Shapes::default();
    // Lines that would cross the letter are left out.
    let chords = Hatch::of(index).chords(radius).into_iter();
    let chords: Vec<_> =
        chords.filter(|[a, b]| (0.5 * (a[0] + b[0])).hypot(0.5 * (a[1] + b[1])) > 0.3 * radius).collect();
    for [x, y] in places {
        for [a, b] in &chords {
            lines.segment([x + a[0], y + a[1]], [x + b[0], y + b[1]]);
        }
    }
    svg.path(lines.data(), &format!(r#"fill="none" stroke="{text}" stroke-opacity="0.4" stroke-width="0.8""#));
    // Where most are of the host, a letter on each would hide the others; the legend names it.
    if radius >= LEGIBLE && (index > 0 || places.len() == 1) {
        svg.letters(letter, places, radius, text);
    }
}

/// A sphere of a material, for legends.
pub(super) fn swatch(svg: &mut Svg, at: [f64; 2], index: usize) {
    const RADIUS: f64 = 8.0;
    svg.circle(at, RADIUS, &format!(r##"fill="{}" stroke="#444" stroke-width="0.5""##, material(index)));
    mark(svg, index, &[at], RADIUS);
}

pub(super) fn axis(svg: &mut Svg, crystal: &Crystal) {
    let (x, top, height) = (crystal.place([0.0, 0.0])[0], crystal.corner()[1], crystal.size()[1]);
    svg.line([x, top], [x, top + height + 8.0], r##"stroke="#222" stroke-width="1" stroke-dasharray="9 3 2 3""##);
    svg.text([x, top + height + 20.0], 11.0, Anchor::Middle, "", "crystal axis, x = 0");
}

/// Materials with the number of spheres in the whole piece, then what the lines are.
fn legend(svg: &mut Svg, outcome: &Outcome, arrangement: &ArrangementOutcome, top: f64) {
    let left = MARGIN[0] + 8.0;
    let mut y = top;
    for (index, name) in outcome.materials.iter().enumerate() {
        let (layout, sites) = (&arrangement.layout, outcome.sites.len());
        let beside = |k: usize| outcome.sites[k % sites].x > 1e-9 * outcome.diameter;
        let spheres = |k: usize| match (layout.len() > sites, beside(k)) {
            (false, true) => 2,
            (false, false) => 1,
            // Of halves that differ each place is one sphere, but for the images of those on the axis.
            (true, beside) => u32::from(beside || k < sites),
        };
        let of = (0..layout.len()).filter(|&k| usize::from(layout[k]) == index);
        let whole: u32 = of.map(spheres).sum();
        if whole == 0 {
            continue;
        }
        let role = super::page::role(outcome, index);
        swatch(svg, [left, y], index);
        svg.text([left + 16.0, y + 4.0], 12.0, Anchor::Start, "", &format!("{name}{role}, {whole} spheres"));
        y += 21.0;
    }
    let lines = left + 275.0;
    let mut y = top;
    if outcome.proposal.is_some() {
        svg.line([lines, y], [lines + 28.0, y], FACE);
        svg.text([lines + 36.0, y + 4.0], 12.0, Anchor::Start, "", "ideal lens faces");
        svg.line([lines, y + 21.0], [lines + 28.0, y + 21.0], RAY);
        svg.text([lines + 36.0, y + 25.0], 12.0, Anchor::Start, "", "rays by Snell's law");
        y += 42.0;
    }
    for (name, dash) in [("focal region", ""), ("protected region", r#"stroke-dasharray="5 3""#)] {
        svg.line([lines, y], [lines + 28.0, y], r##"stroke="#222" stroke-width="3.6""##);
        svg.line([lines, y], [lines + 28.0, y], &format!(r##"stroke="#fff" stroke-width="2" {dash}"##));
        svg.text([lines + 36.0, y + 4.0], 12.0, Anchor::Start, "", name);
        y += 21.0;
    }
}

/// A bar of a round length, about a quarter of the width, ending at `right`.
fn scale_bar(svg: &mut Svg, crystal: &Crystal, outcome: &Outcome, [right, y]: [f64; 2]) {
    let quarter = outcome.half_width / 2.0;
    let length =
        [round_up(quarter) / 2.0, round_up(quarter)].into_iter().rfind(|&l| l < 1.3 * quarter).unwrap_or(quarter);
    let pixels = length * crystal.diameter() / outcome.diameter;
    let ends = [right - 8.0 - pixels, right - 8.0];
    svg.line([ends[0], y], [ends[1], y], r##"stroke="#222" stroke-width="2""##);
    for x in ends {
        svg.line([x, y - 5.0], [x, y + 5.0], r##"stroke="#222" stroke-width="2""##);
    }
    let middle = (ends[0] + ends[1]) / 2.0;
    let text = crate::units::Dimension::Length.show(length);
    svg.text([middle, y + 20.0], 12.0, Anchor::Middle, "", &text);
    let diameter = format!("sphere {}", crate::units::Dimension::Length.show(outcome.diameter));
    svg.text([middle, y + 37.0], 12.0, Anchor::Middle, "", &diameter);
}
