//! A design surface as a picture: colours and contour lines of a value, the media as labelled markers (Burgoyne 2016, fig. 4.15);
//! and the numbers behind it.

use std::fmt::Write as _;

use super::colour::Scale;
use super::crystal::halo;
use super::digits::{short, significant};
use super::labels::{Area, Places};
use super::look::Look;
use super::svg::{Anchor, Shapes, Svg};
use crate::wave::{Axis, DISSIPATED_AT, Kind, Node, Point, Setting, Surface, Value, contour};

/// Width and height of the plot, and the place of its upper left corner (px).
pub(super) const PLOT: [f64; 2] = [720.0, 520.0];
pub(super) const CORNER: [f64; 2] = [78.0, 62.0];
/// Right of the plot: the bar; below it: axis and legend (px).
const RIGHT: f64 = 104.0;
const FOOT: f64 = 100.0;

const LABEL: f64 = 11.5;

/// From variables to pixels.
struct Frame {
    ends: [[f64; 2]; 2],
    linear: [bool; 2],
    /// Width and height of the plot, and its upper left corner (px).
    plot: [f64; 2],
    corner: [f64; 2],
    /// Letters over those on a screen.
    letters: f64,
    for_paper: bool,
}

impl Frame {
    fn new(surface: &Surface, look: &Look) -> Self {
        let letters = look.letters();
        let corner = match look.is_for_paper() {
            false => CORNER,
            // Without titles.
            true => [CORNER[0] * letters, 8.0],
        };
        let width = look.pixels(CORNER[0] + PLOT[0] + RIGHT) - corner[0] - RIGHT * letters;
        let plot = [width, width * PLOT[1] / PLOT[0]];
        let ends = |nodes: &[Node]| [nodes.first(), nodes.last()].map(|node| node.map_or(1.0, |n| n.place));
        Self {
            ends: [ends(&surface.nodes[0]), ends(&surface.nodes[1])],
            linear: surface.axes.map(|axis| axis == Axis::Dimension),
            plot,
            corner,
            letters,
            for_paper: look.is_for_paper(),
        }
    }

    fn share(&self, axis: usize, place: f64) -> f64 {
        let [from, to] = self.ends[axis];
        if self.linear[axis] { (place - from) / (to - from) } else { (place / from).ln() / (to / from).ln() }
    }

    fn at(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        let ([left, top], [width, height]) = (self.corner, self.plot);
        [left + self.share(0, x) * width, top + (1.0 - self.share(1, y)) * height]
    }

    /// Radius of a round marker (px).
    fn marker(&self) -> f64 {
        MARKER * self.letters.clamp(0.6, 1.2)
    }

    fn holds(&self, place: [f64; 2]) -> bool {
        (0..2).all(|axis| (-1e-9..=1.0 + 1e-9).contains(&self.share(axis, place[axis])))
    }
}

/// What stands along an axis, and its unit in SI.
pub(super) fn caption(axis: Axis, diameter: f64) -> (String, f64) {
    match axis {
        Axis::Stiffness => {
            (format!("stiffness of the plastic contact (MN/m), spheres of {} mm", short(diameter * 1e3)), 1e6)
        }
        Axis::Density => ("mean density (kg/m³)".to_owned(), 1.0),
        Axis::YieldStress => ("yield stress of the softer partner (MPa)".to_owned(), 1e6),
        Axis::Modulus => ("Young's modulus (GPa); dimers: of a uniform medium of the same E*".to_owned(), 1e9),
        Axis::Radius => ("radius of the spheres (mm)".to_owned(), 1e-3),
        Axis::Amplitude => ("contact force (in F_p, onset of full plasticity)".to_owned(), 1.0),
        Axis::Dimension => ("dimension: 1 chain, 2 hexagonal sheet, 3 close packing".to_owned(), 1.0),
    }
}

/// What stands along an axis, in as few words as a column of a paper has room for.
fn short_caption(axis: Axis) -> &'static str {
    match axis {
        Axis::Stiffness => "stiffness (MN/m)",
        Axis::Density => "density (kg/m³)",
        Axis::YieldStress => "yield stress (MPa)",
        Axis::Modulus => "modulus (GPa)",
        Axis::Radius => "radius (mm)",
        Axis::Amplitude => "contact force over F_p",
        Axis::Dimension => "dimension",
    }
}

/// A value as it is shown: its title, what stands along the bar, and its unit in SI.
pub(super) fn shown(setting: &Setting) -> (String, &'static str, f64) {
    let against = setting.against.as_ref().map_or("", |medium| medium.label.as_str());
    match setting.value {
        Value::Speed => ("Wave speed of strong impacts (m/s)".to_owned(), "speed (m/s)", 1.0),
        Value::SpeedRatio => (format!("Wave speed over that of {against}"), "speed ratio", 1.0),
        Value::CriticalAngle => {
            (format!("Critical angle against {against} (degrees)"), "critical angle (°)", 1.0_f64.to_radians())
        }
        Value::ImpedanceRatio => (format!("Impedance ρV over that of {against}"), "impedance ratio", 1.0),
        Value::PlasticForce => ("F_p, onset of full plasticity (N)".to_owned(), "F_p (N)", 1.0),
        Value::Dissipation => {
            let amplitude = setting.amplitude.unwrap_or(DISSIPATED_AT);
            let at = if setting.amplitude.is_some() { String::new() } else { format!(" at {amplitude} F_p") };
            (format!("Energy that a contact dissipates{at} (mJ)"), "energy (mJ)", 1e-3)
        }
    }
}

/// A value of a medium beside its marker.
fn named(setting: &Setting, value: f64) -> String {
    let (_, _, unit) = shown(setting);
    if setting.value == Value::Speed { format!("{value:.0}") } else { significant(value / unit, 3) }
}

/// The variables not shown, in words.
fn fixed(surface: &Surface) -> String {
    // What has no influence is as good as shown.
    let setting = &surface.setting;
    let shown = |axis| surface.axes.contains(&axis) || !setting.value.depends_on(axis);
    let mut words = Vec::new();
    if !shown(Axis::Dimension) {
        words.push(
            ["chain", "hexagonal sheet", "close packing"][usize::from(setting.dimension.number()) - 1].to_owned(),
        );
    }
    if !shown(Axis::Density) {
        words.push(format!("density {} kg/m³", short(setting.material.density)));
    }
    match setting.stiffness {
        Some(stiffness) if !shown(Axis::Stiffness) => {
            words.push(format!("stiffness {} MN/m", short(stiffness / 1e6)));
        }
        None if !surface.axes.contains(&Axis::Stiffness) => {
            if !shown(Axis::YieldStress) {
                words.push(format!("yield stress {} MPa", short(setting.material.yield_stress / 1e6)));
            }
            if !shown(Axis::Modulus) {
                words.push(format!("modulus {} GPa", short(setting.material.youngs_modulus / 1e9)));
            }
            words.push(format!("ν {}", setting.material.poisson_ratio));
        }
        _ => {}
    }
    if !shown(Axis::Amplitude) {
        words.push(match (setting.amplitude, setting.value) {
            (Some(amplitude), _) => format!("at {amplitude} F_p"),
            (None, Value::Dissipation) => format!("at {DISSIPATED_AT} F_p"),
            (None, _) => "bound for strong impacts".to_owned(),
        });
    }
    if !shown(Axis::Radius) {
        words.push(format!("spheres of {} mm", short(setting.diameter * 1e3)));
    }
    words.push(format!("constants: {}", setting.constants));
    words.join(", ")
}

/// The picture, as on a screen or in a paper.
pub fn surface(surface: &Surface, points: &[Point], look: &Look) -> String {
    let frame = Frame::new(surface, look);
    let k = frame.letters;
    let foot = if frame.for_paper { 62.0 } else { FOOT };
    let size = [frame.corner[0] + frame.plot[0] + RIGHT * k, frame.corner[1] + frame.plot[1] + foot * k];
    let mut svg =
        Svg::new(size[0], size[1], &format!("Design surface: {}", surface.setting.value.name().replace('-', " ")));
    let (title, bar, unit) = shown(&surface.setting);
    if !frame.for_paper {
        svg.text([CORNER[0], 24.0], 16.0, Anchor::Start, r#"font-weight="bold""#, &title);
        svg.text([CORNER[0], 45.0], 12.0, Anchor::Start, r##"fill="#555""##, &fixed(surface));
    }
    // Along a radius, an amplitude or a dimension media differ in nothing: on the line that is left there is room for materials only,
    // on the point that is left for none.
    let room = |kind| match surface
        .axes
        .iter()
        .filter(|a| matches!(a, Axis::Radius | Axis::Amplitude | Axis::Dimension))
        .count()
    {
        0 => true,
        1 => kind == Kind::Uniform,
        _ => false,
    };
    let mut drawn: Vec<&Point> = points.iter().filter(|p| room(p.kind) && frame.holds(p.place)).collect();
    // The widest markers lie below, so that some of each is seen where they coincide.
    drawn.sort_by_key(|point| [Kind::Engineered, Kind::Dimer, Kind::Uniform].iter().position(|k| *k == point.kind));
    if let Some([low, high]) = surface.range() {
        let (low, high) = drawn.iter().fold((low, high), |(l, h), point| (l.min(point.value), h.max(point.value)));
        let scale = Scale::between(low / unit, high / unit).painted(look.palette);
        fill(&mut svg, surface, &frame, &scale, unit);
        let mut places = Places::new(Area::new(frame.corner, frame.plot));
        for point in &drawn {
            places.keep_clear(frame.at(point.place), frame.marker() + 2.0);
        }
        let levels: Vec<f64> = levels(low / unit, high / unit).into_iter().map(|level| level * unit).collect();
        let lines: Vec<(f64, Vec<Vec<[f64; 2]>>)> = levels
            .into_iter()
            .map(|level| {
                let lines = contour(surface, level).into_iter();
                (level, lines.map(|line| line.into_iter().map(|place| frame.at(place)).collect()).collect())
            })
            .collect();
        for line in lines.iter().flat_map(|(_, lines)| lines) {
            // White below black is seen on every colour, and in black and white.
            svg.polyline(line, r##"stroke="#fff" stroke-width="2.6" stroke-opacity="0.75""##);
            svg.polyline(line, r##"stroke="#111" stroke-width="1""##);
        }
        media(&mut svg, surface, &drawn, (&frame, look), &scale, &mut places);
        for (level, lines) in &lines {
            name_line(&mut svg, *level / unit, lines, k, &mut places);
        }
        let corner = [frame.corner[0] + frame.plot[0] + 12.0 + 10.0 * k, frame.corner[1]];
        scale.sized_bar(&mut svg, corner, frame.plot[1], bar, (1.0, k), [false; 2]);
    }
    axes(&mut svg, surface, &frame);
    legend(&mut svg, &frame, &drawn, points.len() - drawn.len());
    look.sized(svg.finish(), size)
}

/// Round levels, some ten of them, twenty over many decades.
fn levels(low: f64, high: f64) -> Vec<f64> {
    let steps: &[f64] = if high > 1e5 * low {
        &[1.0]
    } else if high > 1e3 * low {
        &[1.0, 2.0, 5.0]
    } else if high > 4.0 * low {
        &[1.0, 1.25, 1.5, 2.0, 2.5, 3.0, 4.0, 5.0, 6.0, 8.0]
    } else {
        let step = super::colour::round_up((high - low).max(1e-9 * high) / 12.0);
        let first = (low / step).ceil() as i64;
        return (0..14).map(|k| (first + k) as f64 * step).filter(|&l| l <= high).collect();
    };
    let decades = low.log10().floor() as i32..=high.log10().floor() as i32;
    let all = decades.flat_map(|power| steps.iter().map(move |step| step * 10_f64.powi(power)));
    all.filter(|level| (low..=high).contains(level)).collect()
}

/// Cells of one colour as one element, those side by side as one shape.
fn fill(svg: &mut Svg, surface: &Surface, frame: &Frame, scale: &Scale, unit: f64) {
    let mut shapes: Vec<Shapes> = vec![Shapes::default(); super::colour::LEVELS];
    let (columns, rows) = (surface.nodes[0].len() - 1, surface.nodes[1].len() - 1);
    for j in 0..rows {
        let colour = |i: usize| {
            let corners = [surface.at(i, j), surface.at(i + 1, j), surface.at(i, j + 1), surface.at(i + 1, j + 1)];
            let logs: Option<Vec<f64>> = corners.into_iter().map(|v| v.map(f64::ln)).collect();
            logs.map(|logs| scale.level((logs.iter().sum::<f64>() / 4.0).exp() / unit))
        };
        let place = |i: usize, j: usize| frame.at([surface.nodes[0][i].place, surface.nodes[1][j].place]);
        let mut i = 0;
        while i < columns {
            let (from, of) = (i, colour(i));
            while i < columns && colour(i) == of {
                i += 1;
            }
            let ([left, top], [right, bottom]) = (place(from, j + 1), place(i, j));
            // A little overlap hides the seams that anti-aliasing leaves between neighbours.
            let [width, height] = [(right - left + 0.5).max(0.0), (bottom - top + 0.5).max(0.0)];
            if let Some(of) = of.filter(|_| width > 0.6 && height > 0.6) {
                shapes[of].closed([left, top], &[[width, 0.0], [0.0, height], [-width, 0.0]]);
            }
        }
    }
    svg.clipped(frame.corner, frame.plot, |svg| {
        for (k, shapes) in shapes.iter().enumerate() {
            svg.path(shapes.data(), &format!(r#"fill="{}""#, scale.colour(k)));
        }
    });
}

const MARKER: f64 = 5.0;

/// One marker, filled with the colour of its own speed.
fn mark(svg: &mut Svg, kind: Kind, [x, y]: [f64; 2], r: f64, fill: &str) {
    for (stroke, width) in [("#fff", 0.9 * r), ("#000", 0.36 * r)] {
        let style = format!(r#"fill="{fill}" stroke="{stroke}" stroke-width="{width}""#);
        match kind {
            Kind::Uniform => svg.circle([x, y], r, &style),
            Kind::Dimer => {
                svg.polygon(&[[x, y - 1.6 * r], [x + 1.6 * r, y], [x, y + 1.6 * r], [x - 1.6 * r, y]], &style);
            }
            Kind::Engineered => svg.rectangle([x - 1.3 * r, y - 1.3 * r], [2.6 * r, 2.6 * r], &style),
        }
    }
}

fn media(
    svg: &mut Svg,
    surface: &Surface,
    points: &[&Point],
    (frame, look): (&Frame, &Look),
    scale: &Scale,
    places: &mut Places,
) {
    let (_, _, unit) = shown(&surface.setting);
    let size = LABEL * frame.letters;
    let wanted = |point: &Point| look.labelled.as_ref().is_none_or(|names| names.contains(&point.label));
    // Of a crowd those are named for which there is room; all stand in the table beside the picture.
    let named: Vec<_> = points
        .iter()
        .filter(|point| wanted(point))
        .filter_map(|point| {
            let text = format!("{}: {}", point.label, named(&surface.setting, point.value));
            Some((frame.at(point.place), places.near(frame.at(point.place), &text, size)?, text))
        })
        .collect();
    for (from, label, _) in &named {
        if let Some(to) = label.leader {
            svg.line(*from, to, r##"stroke="#fff" stroke-width="2.8""##);
            svg.line(*from, to, r##"stroke="#000" stroke-width="0.9""##);
        }
    }
    for point in points {
        mark(svg, point.kind, frame.at(point.place), frame.marker(), &scale.colour(scale.level(point.value / unit)));
    }
    for (_, label, text) in &named {
        halo(svg, label.start, size, Anchor::Start, text);
    }
}

/// Names a contour once, on its longest line that has room for it.
fn name_line(svg: &mut Svg, level: f64, lines: &[Vec<[f64; 2]>], letters: f64, places: &mut Places) {
    const STYLE: &str = r##"fill="#111" stroke="#fff" stroke-width="3" stroke-linejoin="round" paint-order="stroke""##;
    let text = significant(level, 3).trim_end_matches(".0").to_owned();
    let size = 10.5 * letters;
    let mut lines: Vec<&Vec<[f64; 2]>> = lines.iter().collect();
    lines.sort_by_key(|line| std::cmp::Reverse(line.len()));
    for line in lines {
        let middles: Vec<[f64; 2]> =
            line.windows(2).map(|w| [0.5 * (w[0][0] + w[1][0]), 0.5 * (w[0][1] + w[1][1])]).collect();
        // From a fifth of the line on, so that names do not line up across the middle, where the markers are.
        let tries = (0..middles.len()).map(|k| middles[(middles.len() / 5 + k) % middles.len()]);
        if let Some(start) = tries.into_iter().find_map(|middle| places.centred(middle, &text, size)) {
            svg.text(start, size, Anchor::Start, STYLE, &text);
            return;
        }
    }
}

fn axes(svg: &mut Svg, surface: &Surface, frame: &Frame) {
    let ([left, top], k) = (frame.corner, frame.letters);
    let (right, bottom) = (left + frame.plot[0], top + frame.plot[1]);
    svg.rectangle(frame.corner, frame.plot, r##"fill="none" stroke="#333" stroke-width="1""##);
    for axis in 0..2 {
        let (name, unit) = caption(surface.axes[axis], surface.setting.diameter);
        let name = if frame.for_paper { short_caption(surface.axes[axis]).to_owned() } else { name };
        for (tick, named) in ticks(surface.axes[axis], frame.ends[axis].map(|end| end / unit)) {
            let share = frame.share(axis, tick * unit);
            let long = if named { 6.0 } else { 3.0 };
            let text = significant(tick, 2);
            if axis == 0 {
                let x = left + share * frame.plot[0];
                svg.line([x, bottom], [x, bottom + long], r##"stroke="#333""##);
                if named {
                    svg.text([x, bottom + 5.0 + 14.0 * k], 11.5 * k, Anchor::Middle, "", &text);
                }
            } else {
                let y = bottom - share * frame.plot[1];
                svg.line([left - long, y], [left, y], r##"stroke="#333""##);
                if named {
                    svg.text([left - 9.0, y + 4.0 * k], 11.5 * k, Anchor::End, "", &text);
                }
            }
        }
        if axis == 0 {
            svg.text([0.5 * (left + right), bottom + 5.0 + 35.0 * k], 13.0 * k, Anchor::Middle, "", &name);
        } else {
            svg.text_upwards([left - 9.0 - 47.0 * k, 0.5 * (top + bottom)], 13.0 * k, "", &name);
        }
    }
}

/// Ticks in the axis' unit and whether each is named: 1 to 9 in every decade, half steps where they are few.
fn ticks(axis: Axis, [from, to]: [f64; 2]) -> Vec<(f64, bool)> {
    if axis == Axis::Dimension {
        return vec![(1.0, true), (2.0, true), (3.0, true)];
    }
    let decades = from.log10().floor() as i32..=to.log10().floor() as i32;
    let all: Vec<(f64, bool)> = decades
        .flat_map(|power| {
            (10..100).map(move |m| {
                let named = match to / from {
                    wide if wide > 60.0 => [10, 20, 50].contains(&m),
                    wide if wide > 4.0 => [10, 15, 20, 30, 40, 50, 70].contains(&m),
                    _ => m % 5 == 0,
                };
                (f64::from(m) * 10_f64.powi(power - 1), named, m)
            })
        })
        .filter(|&(_, named, m)| named || m % 10 == 0)
        .map(|(tick, named, _)| (tick, named))
        .filter(|&(tick, _)| tick >= from * 0.999_999 && tick <= to * 1.000_001)
        .collect();
    all
}

/// What the markers that are drawn mean.
fn legend(svg: &mut Svg, frame: &Frame, drawn: &[&Point], beyond: usize) {
    let k = frame.letters;
    let below = if frame.for_paper { 5.0 + 52.0 * k } else { 66.0 };
    let y = frame.corner[1] + frame.plot[1] + below;
    let mut x = if frame.for_paper { 10.0 } else { frame.corner[0] + 6.0 };
    let is_drawn = |kind: Kind| drawn.iter().any(|point| point.kind == kind);
    for (kind, words, width) in [
        (Kind::Uniform, "one material", 104.0),
        (Kind::Dimer, "dimer of two", 104.0),
        (Kind::Engineered, "engineered", 96.0),
    ] {
        if is_drawn(kind) {
            mark(svg, kind, [x, y - 4.0 * k], frame.marker(), "#ddd");
            svg.text([x + 12.0 * k, y], 12.0 * k, Anchor::Start, "", words);
            x += width * k;
        }
    }
    if frame.for_paper {
        return;
    }
    let mut notes = Vec::new();
    if is_drawn(Kind::Dimer) {
        notes.push("dimers: contacts all mixed".to_owned());
    }
    if beyond > 0 {
        notes.push(format!("{beyond} more in the table only"));
    }
    svg.text([x, y], 12.0, Anchor::Start, r##"fill="#555""##, &notes.join("; "));
    if !drawn.is_empty() {
        let words =
            "A marker's colour and number are the medium's own value, at its own values of what is not on the axes.";
        svg.text([CORNER[0], y + 21.0], 12.0, Anchor::Start, r##"fill="#555""##, words);
    }
}

/// The numbers behind the picture: every node of the grid and every medium, in SI.
pub fn surface_csv(surface: &Surface, points: &[Point]) -> String {
    let names = surface.axes.map(|axis| match axis {
        Axis::Stiffness => "stiffness_N_m",
        Axis::Density => "density_kg_m3",
        Axis::YieldStress => "yield_stress_Pa",
        Axis::Modulus => "youngs_modulus_Pa",
        Axis::Radius => "radius_m",
        Axis::Amplitude => "amplitude_F_p",
        Axis::Dimension => "dimension",
    });
    let mut text = format!("kind,name,{},{}\n", names.join(","), surface.setting.value.column());
    // A dimension's band is two grid lines of one value.
    let once = |nodes: &[Node], k: usize| k == 0 || nodes[k].value != nodes[k - 1].value;
    for (j, y) in surface.nodes[1].iter().enumerate().filter(|(j, _)| once(&surface.nodes[1], *j)) {
        for (i, x) in surface.nodes[0].iter().enumerate().filter(|(i, _)| once(&surface.nodes[0], *i)) {
            let value = surface.at(i, j).map_or(String::new(), |value| value.to_string());
            let _ = writeln!(text, "grid,,{},{},{value}", x.value, y.value);
        }
    }
    for Point { label, kind, place: [x, y], value } in points {
        let _ = writeln!(text, "{},\"{}\",{x},{y},{value}", kind.name(), label.replace('"', "\"\""));
    }
    text
}
