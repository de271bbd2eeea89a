//! Spot diagrams: where rays pass the middle row of a focal region, by where they start.

use super::chart::ticks;
use super::digits::{short, significant};
use super::svg::{Anchor, Shapes, Svg};
use crate::outcome::SpotDiagram;
use crate::units::Dimension::{Length, Time};

/// Room of one panel (px), and around it: left, top, right, bottom.
const ROOM: [f64; 2] = [360.0, 260.0];
const MARGIN: [f64; 4] = [64.0, 78.0, 24.0, 86.0];

/// Height of the ticks below a panel (px).
const RUG: f64 = 26.0;

/// Of it the part that the ticks take; the rms spot is below.
const TICKS: f64 = 15.0;

/// Room between the panel's edge and its outermost ray or edge, over the range.
const AIR: f64 = 0.12;

/// A panel for each focal region, beside each other.
pub fn spot_diagram(name: &str, diameter: f64, spots: &[&SpotDiagram]) -> String {
    let cell = MARGIN[0] + ROOM[0] + MARGIN[2];
    let height = MARGIN[1] + ROOM[1] + MARGIN[3];
    let mut svg = Svg::new(cell * spots.len() as f64, height, &format!("{name}: spot diagram"));
    for (k, spot) in spots.iter().enumerate() {
        let number = if spots.len() > 1 { format!(" {}", k + 1) } else { String::new() };
        panel(&mut svg, spot, diameter, &number, MARGIN[0] + cell * k as f64);
    }
    svg.finish()
}

fn panel(svg: &mut Svg, diagram: &SpotDiagram, diameter: f64, number: &str, left: f64) {
    let (top, bottom) = (MARGIN[1], MARGIN[1] + ROOM[1]);
    let row = diagram.depth / (0.75_f64.sqrt() * diameter) + 1.0;
    let heading = format!("focal region{number}: row {}", short(row));
    svg.text([left, 20.0], 14.0, Anchor::Start, r#"font-weight="bold""#, &heading);
    for (line, words) in words(diagram, diameter).iter().enumerate() {
        svg.text([left, 40.0 + 16.0 * line as f64], 12.0, Anchor::Start, "", words);
    }
    // The region and all rays, in diameters.
    let places = diagram.passages.iter().map(|[_, x, _]| *x).chain(diagram.x);
    let [low, high] = places.fold([f64::INFINITY, f64::NEG_INFINITY], |[a, b], x| [a.min(x), b.max(x)]);
    let air = AIR * (high - low).max(diameter);
    let [low, high] = [(low - air) / diameter, (high + air) / diameter];
    let [first, last] = diagram.strip.map(|x| x / diameter);
    let across = |x: f64| left + (x / diameter - low) / (high - low) * ROOM[0];
    let upwards = |x: f64| bottom - (x / diameter - first) / (last - first) * ROOM[1];
    let [from, to] = diagram.x.map(across);
    let frame = ROOM[1] + RUG;
    svg.rectangle([from, top], [to - from, frame], r##"fill="#cfe3f5""##);
    for edge in [from, to] {
        svg.line([edge, top], [edge, top + frame], r##"stroke="#1f4e9c" stroke-width="1.2""##);
    }
    svg.text([0.5 * (from + to), top - 6.0], 11.0, Anchor::Middle, r##"fill="#1f4e9c""##, "region");
    for tick in ticks(first, last, 6) {
        let y = upwards(tick * diameter);
        svg.line([left - 4.0, y], [left, y], r##"stroke="#555""##);
        svg.text([left - 8.0, y + 4.0], 11.0, Anchor::End, "", &short(tick));
    }
    for tick in ticks(low, high, 7) {
        let x = across(tick * diameter);
        svg.line([x, bottom + RUG], [x, bottom + RUG + 4.0], r##"stroke="#555""##);
        svg.text([x, bottom + RUG + 18.0], 11.0, Anchor::Middle, "", &short(tick));
    }
    if let Some(spot) = &diagram.spot {
        // About a mirror line only the half that the rays are in.
        let reach =
            diagram.passages.iter().map(|[_, x, _]| *x).fold([spot.centre; 2], |[a, b], x| [a.min(x), b.max(x)]);
        let sides = [(spot.centre - spot.radius).max(reach[0]), (spot.centre + spot.radius).min(reach[1])];
        let [from, to] = sides.map(|x| across(x).clamp(left, left + ROOM[0]));
        let y = bottom + 0.5 * (TICKS + RUG);
        svg.line(
            [across(spot.centre), top],
            [across(spot.centre), bottom],
            r##"stroke="#555" stroke-dasharray="4 3""##,
        );
        svg.line([from, y], [to, y], r##"stroke="#e07b00" stroke-width="6""##);
    }
    let mut rug = Shapes::default();
    for [start, x, _] in &diagram.passages {
        svg.circle([across(*x), upwards(*start)], 2.0, r##"fill="#c0202a""##);
        rug.segment([across(*x), bottom + 2.0], [across(*x), bottom + TICKS]);
    }
    svg.path(rug.data(), r##"fill="none" stroke="#c0202a" stroke-width="0.8""##);
    svg.rectangle([left, top], [ROOM[0], frame], r##"fill="none" stroke="#555""##);
    svg.line([left, bottom], [left + ROOM[0], bottom], r##"stroke="#999""##);
    let middle = left + ROOM[0] / 2.0;
    let label = format!("where the ray passes row {}, x/D (D = {})", short(row), Length.show(diameter));
    svg.text([middle, bottom + RUG + 38.0], 12.0, Anchor::Middle, "", &label);
    let orange = r##"fill="#a85c00""##;
    svg.text([middle, bottom + RUG + 56.0], 11.0, Anchor::Middle, orange, "orange: rms spot about its centre (dashed)");
    svg.text_upwards([left - 44.0, top + ROOM[1] / 2.0], 12.0, "", "where it starts in row 1, x/D");
}

/// The numbers of a diagram.
fn words(diagram: &SpotDiagram, diameter: f64) -> [String; 2] {
    let rays = diagram.passages.len();
    let Some(spot) = &diagram.spot else { return ["no ray comes here".to_owned(), String::new()] };
    // Round-off of a perfect focus is no length.
    let radius = if spot.radius < 1e-6 * diameter { 0.0 } else { spot.radius };
    let times = diagram.passages.iter().map(|[_, _, time]| *time);
    let [early, late] = times.fold([f64::INFINITY, 0.0_f64], |[a, b], time| [a.min(time), b.max(time)]);
    let percent = significant(100.0 * diagram.inside() as f64 / rays.max(1) as f64, 3);
    let rms = format!("{} D = {}", significant(radius / diameter, 3), Length.show(radius));
    [
        format!("rms spot {rms} about x = {} D", short(spot.centre / diameter)),
        format!("{percent} % of {rays} rays inside, from {} to {}", Time.show(early), Time.show(late)),
    ]
}
