//! Profiles across rows before, in and behind the focus (Burgoyne 2016, figs 5.21 and 5.22): the lens against plain
//! baselines on the left and against random ones on the right.

use super::colour::{round_up, ticks};
use super::digits::significant;
use super::maps::mean_at;
use super::svg::{Anchor, Svg};
use crate::outcome::{ArrangementOutcome, Outcome};
use crate::target::Region;

/// Rows from one panel to the next: the published figures show rows 22, 32 and 42.
const APART: u32 = 10;

/// Width and height of a panel (px).
const PANEL: [f64; 2] = [372.0, 196.0];
/// Space left of, above, right of and below a panel: axis, heading, names of lines, axis (px).
const SPACE: [f64; 4] = [62.0, 30.0, 134.0, 30.0];
/// Space above the panels for the columns' headings, and below them for the legend (px).
const HEAD: f64 = 26.0;
const FOOT: f64 = 44.0;

/// How a line is told from the others, without colour too.
struct Style {
    colour: &'static str,
    dash: &'static str,
    marker: Marker,
    width: f64,
}

#[derive(Clone, Copy)]
enum Marker {
    Circle,
    Square,
    Triangle,
    Diamond,
    Cross,
}

/// Colours from Okabe & Ito (2008), chosen to differ for every kind of colour vision.
const LENS: Style = Style { colour: "#0072b2", dash: "", marker: Marker::Circle, width: 2.6 };
const PLAIN: [Style; 5] = [
    Style { colour: "#d55e00", dash: "7 3", marker: Marker::Square, width: 1.7 },
    Style { colour: "#b98a00", dash: "2 3", marker: Marker::Triangle, width: 1.7 },
    Style { colour: "#444444", dash: "11 3 2 3", marker: Marker::Diamond, width: 1.7 },
    Style { colour: "#008f68", dash: "4 2", marker: Marker::Cross, width: 1.7 },
    Style { colour: "#a0528a", dash: "1 2", marker: Marker::Square, width: 1.7 },
];
const RANDOM: [Style; 2] = [
    Style { colour: "#008f68", dash: "7 3", marker: Marker::Square, width: 1.9 },
    Style { colour: "#c2487f", dash: "2 3", marker: Marker::Triangle, width: 1.9 },
];

/// A line of a panel: values over x/D, and the least and greatest over seeds where there are several.
struct Curve<'a> {
    name: String,
    style: &'a Style,
    mean: Vec<[f64; 2]>,
    band: Option<[Vec<[f64; 2]>; 2]>,
}

/// The rows shown for one of the foci: before, in and behind it, kept within the crystal.
pub fn rows(outcome: &Outcome, focus: usize) -> [u32; 3] {
    let last = outcome.sites.iter().map(|s| s.row).max().unwrap_or(1);
    let middle = (outcome.target.foci[focus].region.mid_row().floor() as u32).clamp(1, last);
    [middle.saturating_sub(APART).max(1), middle, (middle + APART).min(last)]
}

/// Indices of a row's sites in order of x.
pub fn sites_of(outcome: &Outcome, row: u32) -> Vec<usize> {
    (0..outcome.sites.len()).filter(|&index| outcome.sites[index].row == row).collect()
}

/// Kinds of random arrangement with their members, in order of appearance.
pub fn random_kinds<S, R, P>(outcome: &Outcome<S, R, P>) -> Vec<(&str, Vec<&ArrangementOutcome>)> {
    let mut kinds: Vec<(&str, Vec<&ArrangementOutcome>)> = Vec::new();
    for arrangement in outcome.arrangements.iter().filter(|a| a.seed.is_some()) {
        match kinds.iter_mut().find(|(kind, _)| *kind == arrangement.kind) {
            Some((_, members)) => members.push(arrangement),
            None => kinds.push((&arrangement.kind, vec![arrangement])),
        }
    }
    kinds
}

/// The figure.
pub fn profiles(outcome: &Outcome) -> String {
    let cell = [SPACE[0] + PANEL[0] + SPACE[2], SPACE[1] + PANEL[1] + SPACE[3]];
    let foci = outcome.target.foci.len();
    let lines = (3 * foci) as f64;
    let count = if foci > 1 { format!("three rows about each of {foci} foci") } else { "three rows".to_owned() };
    let title = format!("{}: greatest kinetic energy across {count}", outcome.manifest.name);
    let random = random_kinds(outcome);
    let columns = if random.is_empty() { 1 } else { 2 };
    let mut svg = Svg::new(cell[0] * columns as f64, HEAD + cell[1] * lines + FOOT, &title);
    let first = outcome.arrangements.first().map_or("piece", |first| first.name.as_str());
    let headings = [format!("{first}, flat strips, one material"), format!("{first} and random mixtures")];
    for (k, heading) in headings.iter().take(columns).enumerate() {
        let middle = cell[0] * k as f64 + SPACE[0] + PANEL[0] / 2.0;
        svg.text([middle, 18.0], 14.0, Anchor::Middle, r#"font-weight="bold""#, heading);
    }
    let shown = (0..foci).flat_map(|focus| rows(outcome, focus).into_iter().zip(["before", "in", "behind"]));
    for (line, (row, place)) in shown.enumerate() {
        let curves = [plain_curves(outcome, row), random_curves(outcome, &random, row)];
        let tops = curves.iter().flatten().flat_map(|c| c.mean.iter().chain(c.band.iter().flat_map(|b| &b[1])));
        // Room above the highest value for the regions' names; one range for both columns of a row.
        let high = tops.map(|p| p[1]).fold(0.0, f64::max) * 1.12;
        let high = if high > 0.0 { (high / round_up(high / 20.0)).ceil() * round_up(high / 20.0) } else { 1.0 };
        for (k, curves) in curves.iter().take(columns).enumerate() {
            let corner = [cell[0] * k as f64 + SPACE[0], HEAD + cell[1] * line as f64 + SPACE[1]];
            let number = if foci > 1 { format!(" {}", line / 3 + 1) } else { String::new() };
            let what = match (place, foci) {
                ("in", 1) => "the focal region",
                ("in", _) => "focal region",
                (_, 1) => "the focus",
                _ => "focus",
            };
            let heading = format!("row {row}, {place} {what}{number}");
            panel(&mut svg, outcome, corner, high, &heading, curves);
        }
    }
    let foot = HEAD + cell[1] * lines + 12.0;
    for k in 0..columns {
        let middle = cell[0] * k as f64 + SPACE[0] + PANEL[0] / 2.0;
        svg.text([middle, foot], 12.0, Anchor::Middle, "", "distance from the axis, x/D");
    }
    if columns == 2 {
        let note = "line with markers: mean over seeds; shaded band: least to greatest over seeds at that place";
        svg.text([cell[0] + SPACE[0] + PANEL[0] / 2.0, foot + 22.0], 11.0, Anchor::Middle, "", note);
    }
    svg.finish()
}

fn values(outcome: &Outcome, arrangement: &ArrangementOutcome, row: u32) -> Vec<[f64; 2]> {
    let list = &arrangement.record.max_kinetic;
    let sites = sites_of(outcome, row).into_iter();
    sites
        .filter_map(|index| {
            Some([outcome.sites[index].x / outcome.diameter, mean_at(list, index, outcome.sites.len())?])
        })
        .collect()
}

fn plain_curves(outcome: &Outcome, row: u32) -> Vec<Curve<'static>> {
    let plain = outcome.arrangements.iter().filter(|a| a.seed.is_none());
    let styles = std::iter::once(&LENS).chain(&PLAIN);
    plain
        .zip(styles)
        .map(|(a, style)| Curve { name: a.name.clone(), style, mean: values(outcome, a, row), band: None })
        .collect()
}

fn random_curves(outcome: &Outcome, kinds: &[(&str, Vec<&ArrangementOutcome>)], row: u32) -> Vec<Curve<'static>> {
    let lens = plain_curves(outcome, row).into_iter().take(1);
    let random = kinds.iter().zip(&RANDOM).map(|((kind, members), style)| {
        let all: Vec<_> = members.iter().map(|member| values(outcome, member, row)).collect();
        let fold = |start: f64, with: fn(f64, f64) -> f64| -> Vec<[f64; 2]> {
            let shortest = all.iter().map(Vec::len).min().unwrap_or(0);
            (0..shortest).map(|k| [all[0][k][0], all.iter().map(|v| v[k][1]).fold(start, with)]).collect()
        };
        let mean = fold(0.0, |a, b| a + b).into_iter().map(|[x, sum]| [x, sum / all.len() as f64]).collect();
        let band = [fold(f64::MAX, f64::min), fold(0.0, f64::max)];
        Curve { name: (*kind).to_owned(), style, mean, band: Some(band) }
    });
    lens.chain(random).collect()
}

fn panel(svg: &mut Svg, outcome: &Outcome, [left, top]: [f64; 2], high: f64, heading: &str, curves: &[Curve]) {
    let (width, height) = (PANEL[0], PANEL[1]);
    let most = outcome.half_width / outcome.diameter;
    let place = |[x, y]: [f64; 2]| [left + x / most * width, top + height * (1.0 - y / high)];
    svg.text([left, top - 9.0], 12.0, Anchor::Start, r#"font-weight="bold""#, heading);
    let target = &outcome.target;
    for (region, name) in target.named_foci().into_iter().chain([(&target.protect, "protected".to_owned())]) {
        shade(svg, outcome, region, &name, [left, top], most);
    }
    for tick in ticks(high, 6) {
        let [_, y] = place([0.0, tick]);
        svg.line([left, y], [left + width, y], r##"stroke="#ddd" stroke-width="0.7""##);
        svg.text([left - 6.0, y + 4.0], 11.0, Anchor::End, "", &significant(tick, 2));
    }
    for tick in ticks(most, 10) {
        let [x, y] = place([tick, 0.0]);
        svg.line([x, y], [x, y + 4.0], r##"stroke="#555""##);
        svg.text([x, y + 16.0], 11.0, Anchor::Middle, "", &significant(tick, 2));
    }
    svg.text_upwards([left - 44.0, top + height / 2.0], 12.0, "", "max. kinetic energy (J)");
    for curve in curves {
        if let Some([low, up]) = &curve.band {
            let outline: Vec<_> = low.iter().chain(up.iter().rev()).map(|&p| place(p)).collect();
            svg.polygon(&outline, &format!(r#"fill="{}" fill-opacity="0.16""#, curve.style.colour));
            let edge = format!(r#"stroke="{}" stroke-width="0.6" stroke-opacity="0.8""#, curve.style.colour);
            for side in [low, up] {
                svg.polyline(&side.iter().map(|&p| place(p)).collect::<Vec<_>>(), &edge);
            }
        }
    }
    // The lens, first in the list, is painted last, over the others.
    for curve in curves.iter().rev() {
        let points: Vec<_> = curve.mean.iter().map(|&p| place(p)).collect();
        let Style { colour, dash, marker, width } = curve.style;
        svg.polyline(&points, &format!(r#"stroke="{colour}" stroke-width="{width}" stroke-dasharray="{dash}""#));
        for &point in &points {
            mark(svg, *marker, point, colour);
        }
    }
    svg.rectangle([left, top], [width, height], r##"fill="none" stroke="#555" stroke-width="1""##);
    name_lines(svg, curves, place, [left + width, top]);
}

/// Shades a region's range of x; where it is named the reader need not look it up.
fn shade(svg: &mut Svg, outcome: &Outcome, region: &Region, name: &str, [left, top]: [f64; 2], most: f64) {
    let x = |metres: f64| left + (metres / outcome.diameter / most).clamp(0.0, 1.0) * PANEL[0];
    let (from, to) = (x(region.x[0]), x(region.x[1]));
    let fill = if name.starts_with("focal") { "#f4ead2" } else { "#e4ecf4" };
    svg.rectangle([from, top], [to - from, PANEL[1]], &format!(r#"fill="{fill}""#));
    svg.text([(from + to) / 2.0, top + 14.0], 11.0, Anchor::Middle, r##"fill="#555""##, name);
}

/// Names beside the ends of the lines, moved apart where they would overlap, each joined to its line.
fn name_lines(svg: &mut Svg, curves: &[Curve], place: impl Fn([f64; 2]) -> [f64; 2], [right, top]: [f64; 2]) {
    const APART: f64 = 15.0;
    let mut names: Vec<(f64, f64, &Curve)> =
        curves.iter().filter_map(|curve| curve.mean.last().map(|&end| (place(end)[1], place(end)[1], curve))).collect();
    names.sort_by(|a, b| a.0.total_cmp(&b.0));
    for k in 1..names.len() {
        names[k].1 = names[k].1.max(names[k - 1].1 + APART);
    }
    // What was pushed below the panel moves up again, and pushes its neighbours.
    let mut limit = top + PANEL[1] + 2.0;
    for name in names.iter_mut().rev() {
        name.1 = name.1.min(limit);
        limit = name.1 - APART;
    }
    for (end, at, curve) in names {
        let joint = format!(r#"stroke="{}" stroke-width="0.8""#, curve.style.colour);
        svg.polyline(&[[right, end], [right + 6.0, end], [right + 14.0, at]], &joint);
        mark(svg, curve.style.marker, [right + 18.0, at], curve.style.colour);
        let fill = format!(r#"fill="{}" font-weight="bold""#, curve.style.colour);
        svg.text([right + 25.0, at + 4.0], 11.0, Anchor::Start, &fill, &curve.name);
    }
}

fn mark(svg: &mut Svg, marker: Marker, [x, y]: [f64; 2], colour: &str) {
    const R: f64 = 2.7;
    let fill = format!(r##"fill="{colour}" stroke="#fff" stroke-width="0.5""##);
    match marker {
        Marker::Circle => svg.circle([x, y], R, &fill),
        Marker::Square => svg.rectangle([x - R, y - R], [2.0 * R, 2.0 * R], &fill),
        Marker::Triangle => svg.polygon(&[[x - R, y + R], [x + R, y + R], [x, y - R]], &fill),
        Marker::Diamond => {
            svg.polygon(&[[x, y - 1.3 * R], [x + 1.3 * R, y], [x, y + 1.3 * R], [x - 1.3 * R, y]], &fill)
        }
        Marker::Cross => {
            let stroke = format!(r#"stroke="{colour}" stroke-width="1.6""#);
            svg.line([x - R, y - R], [x + R, y + R], &stroke);
            svg.line([x - R, y + R], [x + R, y - R], &stroke);
        }
    }
}
