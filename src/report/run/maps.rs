//! The wave over depth and time, and when it arrives at each sphere.

use super::super::chart::ticks;
use super::super::colour::{LEVELS, MISSING, Scale, level};
use super::super::digits::short;
use super::super::svg::{Anchor, Shapes, Svg};
use super::{Sphere, Times};

/// Room for an x-t diagram (px), and around it: left, top, right (bar), bottom.
pub const ROOM: [f64; 2] = [640.0, 420.0];
pub const MARGIN: [f64; 4] = [64.0, 40.0, 100.0, 52.0];

/// Cells of an x-t diagram along each axis, at most.
const CELLS: [usize; 2] = [320, 210];

/// Paints the room cell by cell, of columns and rows from its upper left corner on, by the value of each.
pub fn paint(svg: &mut Svg, scale: &Scale, [columns, rows]: [usize; 2], value: impl Fn(usize, usize) -> f64) {
    let [left, top, ..] = MARGIN;
    let mut shapes = vec![Shapes::default(); LEVELS];
    let [width, height] = [ROOM[0] / columns as f64, ROOM[1] / rows as f64];
    for row in 0..rows {
        for column in 0..columns {
            let corner = [left + column as f64 * width, top + row as f64 * height];
            shapes[scale.level(value(column, row))].closed(corner, &[[width, 0.0], [0.0, height], [-width, 0.0]]);
        }
    }
    for (k, shapes) in shapes.iter().enumerate() {
        // Crisp edges leave no seams between cells.
        svg.path(shapes.data(), &format!(r#"fill="{}" shape-rendering="crispEdges""#, scale.colour(k)));
    }
}

/// Mean velocity along the wave (m/s) over time (s), layer by layer: `layers[l][k]` at `times[k]`.
pub fn x_t(title: &str, times: &[f64], layers: &[Vec<f64>]) -> String {
    let [left, top, right, bottom] = MARGIN;
    let mut svg = Svg::new(left + ROOM[0] + right, top + ROOM[1] + bottom, title);
    svg.text([left, 22.0], 14.0, Anchor::Start, r#"font-weight="bold""#, title);
    let known = || layers.iter().flatten().copied().filter(|v| v.is_finite());
    let scale = Scale::diverging(known().fold(0.0, f64::min), known().fold(0.0, f64::max));
    let end = times.last().copied().filter(|&t| t > 0.0).unwrap_or(1.0);
    let [columns, rows] = [times.len().min(CELLS[0]).max(1), layers.len().min(CELLS[1]).max(1)];
    paint(&mut svg, &scale, [columns, rows], |column, row| {
        let within = row * layers.len() / rows..((row + 1) * layers.len() / rows).max(row * layers.len() / rows + 1);
        // Samples are equally far apart, up to the last.
        let at = (column as f64 + 0.5) / columns as f64 * end;
        let k = times.partition_point(|&t| t < at).min(times.len().saturating_sub(1));
        // The fastest of the layers of a cell, either way: a thin front must not vanish.
        let faster = |a: f64, b: f64| if b.abs() > a.abs() { b } else { a };
        layers[within].iter().map(|layer| layer[k]).fold(0.0, faster)
    });
    for tick in ticks(0.0, end * 1e6, 8) {
        let at = left + tick / (end * 1e6) * ROOM[0];
        svg.line([at, top + ROOM[1]], [at, top + ROOM[1] + 5.0], r##"stroke="#555""##);
        svg.text([at, top + ROOM[1] + 19.0], 11.0, Anchor::Middle, "", &short(tick));
    }
    let step = ticks(0.0, layers.len() as f64, 10).get(1).map_or(1, |step| step.max(1.0) as usize);
    for layer in std::iter::once(1).chain((1..=layers.len() / step).map(|k| k * step).filter(|&k| k > 1)) {
        let at = top + (layer as f64 - 0.5) / layers.len() as f64 * ROOM[1];
        svg.line([left - 5.0, at], [left, at], r##"stroke="#555""##);
        svg.text([left - 9.0, at + 4.0], 11.0, Anchor::End, "", &layer.to_string());
    }
    svg.rectangle([left, top], ROOM, r##"fill="none" stroke="#555""##);
    svg.text([left + ROOM[0] / 2.0, top + ROOM[1] + 40.0], 12.0, Anchor::Middle, "", "time (µs)");
    svg.text_upwards([18.0, top + ROOM[1] / 2.0], 12.0, "", "layer, counted along the wave");
    let words = "mean velocity along the wave (m/s); blue: back";
    scale.bar(&mut svg, [left + ROOM[0] + 18.0, top], ROOM[1], words, 1.0, [false; 2]);
    svg.finish()
}

/// Room for the crystal in a map of arrivals (px).
const MAP: [f64; 2] = [760.0, 620.0];

/// Layers of a crystal in space that are shown, each seen along the wave.
const PANELS: usize = 4;

/// When the wave arrives at each sphere, with lines of equal time: a sheet as it lies, the wave running down; a crystal in
/// space by its first layers, seen along the wave.
pub fn arrivals(title: &str, threshold: &str, times: &Times, spheres: &[Sphere]) -> String {
    let across = times.dimension == 3;
    let mut layers: Vec<u32> = spheres.iter().map(|sphere| sphere.layer).collect();
    layers.dedup();
    layers.truncate(PANELS);
    let panels: Vec<Vec<usize>> = if across {
        layers.iter().map(|layer| (0..spheres.len()).filter(|&i| spheres[i].layer == *layer).collect()).collect()
    } else {
        vec![(0..spheres.len()).collect()]
    };
    let shown = || panels.iter().flatten();
    // On paper: x to the right; in a sheet z downwards, in a layer y upwards.
    let flat = |i: usize| {
        let centre = &spheres[i].centre;
        if across { [centre[0], -centre[1]] } else { [centre[0], centre[centre.len() - 1]] }
    };
    let radius = spheres.iter().map(|sphere| 0.5 * sphere.diameter).fold(0.0, f64::max);
    let mut low = [f64::INFINITY; 2];
    let mut high = [f64::NEG_INFINITY; 2];
    for &i in shown() {
        for k in 0..2 {
            low[k] = low[k].min(flat(i)[k] - radius);
            high[k] = high[k].max(flat(i)[k] + radius);
        }
    }
    let [width, height] = [high[0] - low[0], high[1] - low[1]];
    let columns = panels.len().min(2) as f64;
    let rows = (panels.len() as f64 / columns).ceil();
    let scale = (MAP[0] / (columns * width)).min(MAP[1] / (rows * height));
    let [wide, tall] = [width * scale, height * scale];
    let [left, top] = [30.0, 64.0];
    let head = if across { 22.0 } else { 0.0 };
    let room = [columns * (wide + 20.0), rows * (tall + head + 12.0)];
    let mut svg = Svg::new((left + room[0] + 100.0).max(560.0), top + room[1] + 20.0, title);
    svg.text([left, 22.0], 14.0, Anchor::Start, r#"font-weight="bold""#, title);
    let seen = if across { "layers seen along the wave" } else { "the wave runs down" };
    let words = format!("arrival: {threshold}; {seen}; white where it did not come");
    svg.text([left, 42.0], 12.0, Anchor::Start, "", &words);

    let mut known: Vec<f64> = times.values.iter().copied().filter(|t| t.is_finite()).collect();
    known.sort_by(f64::total_cmp);
    // A few spheres that are reached much later than the others do not set the scale.
    let most = known.get(known.len() * 19 / 20).or(known.last()).copied().unwrap_or(0.0);
    let late = known.last().is_some_and(|&last| last > 1.3 * most);
    let latest = if late { most } else { known.last().copied().unwrap_or(0.0) };
    let colours = Scale::linear(latest);
    for (k, panel) in panels.iter().enumerate() {
        let corner = [
            left + (k as f64 % columns) * (wide + 20.0),
            top + (k as f64 / columns).floor() * (tall + head + 12.0) + head,
        ];
        let place = |i: usize| {
            let at = flat(i);
            [corner[0] + (at[0] - low[0]) * scale, corner[1] + (at[1] - low[1]) * scale]
        };
        if across {
            svg.text(
                [corner[0], corner[1] - 6.0],
                12.0,
                Anchor::Start,
                "",
                &format!("layer {}", spheres[panel[0]].layer),
            );
        }
        for &i in panel {
            let time = times.values[i];
            let fill = if time.is_finite() { level(colours.level(time)) } else { MISSING.to_owned() };
            // Soft materials other than the first are told by a darker rim.
            let rim = if spheres[i].first_material { "#bbb" } else { "#222" };
            let size = 0.5 * spheres[i].diameter * scale;
            let line = if spheres[i].first_material { 0.4 } else { 0.9 };
            svg.circle(place(i), size - 0.5 * line, &format!(r#"fill="{fill}" stroke="{rim}" stroke-width="{line}""#));
        }
        let triangles = triangles(panel, &flat, 2.0 * radius);
        for value in ticks(0.0, latest, 8).into_iter().skip(1) {
            let mut lines = Shapes::default();
            for corners in &triangles {
                crossing(&corners.map(|i| (place(i), times.values[i])), value, &mut lines);
            }
            svg.path(lines.data(), r##"fill="none" stroke="#fff" stroke-width="2""##);
            svg.path(lines.data(), r##"fill="none" stroke="#c0202a" stroke-width="0.9""##);
        }
    }
    let height = room[1].clamp(140.0, 400.0);
    colours.bar(&mut svg, [left + room[0] + 6.0, top], height, "arrival time (µs)", 1e-6, [late, false]);
    svg.finish()
}

/// Triples of neighbours: nearer than 1.2 diameters, or 1.5 where that joins none, as in square layers.
fn triangles(panel: &[usize], place: &impl Fn(usize) -> [f64; 2], diameter: f64) -> Vec<[usize; 3]> {
    use std::collections::HashMap;
    for reach in [1.2 * diameter, 1.5 * diameter] {
        let cell = |i: usize| place(i).map(|x| (x / reach).floor() as i64);
        let mut cells: HashMap<[i64; 2], Vec<usize>> = HashMap::new();
        panel.iter().for_each(|&i| cells.entry(cell(i)).or_default().push(i));
        let near = |i: usize, j: usize| {
            let ([a, b], [c, d]) = (place(i), place(j));
            (a - c).hypot(b - d) < reach
        };
        let mut found = Vec::new();
        for &i in panel {
            let [x, y] = cell(i);
            let around = (-1..=1).flat_map(|p| (-1..=1).map(move |q| [x + p, y + q]));
            let later: Vec<usize> =
                around.filter_map(|at| cells.get(&at)).flatten().copied().filter(|&j| j > i && near(i, j)).collect();
            for (k, &a) in later.iter().enumerate() {
                found.extend(later[k + 1..].iter().filter(|&&b| near(a, b)).map(|&b| [i, a, b]));
            }
        }
        if !found.is_empty() {
            return found;
        }
    }
    Vec::new()
}

/// Where a value lies between the corners of a triangle, linearly.
fn crossing(corners: &[([f64; 2], f64); 3], value: f64, lines: &mut Shapes) {
    let mut points = Vec::new();
    for (a, b) in [(0, 1), (1, 2), (2, 0)] {
        let ((p, s), (q, t)) = (corners[a], corners[b]);
        if (s < value) != (t < value) && s.is_finite() && t.is_finite() {
            let share = (value - s) / (t - s);
            points.push([p[0] + share * (q[0] - p[0]), p[1] + share * (q[1] - p[1])]);
        }
    }
    if let [from, to] = points[..] {
        lines.segment(from, to);
    }
}
