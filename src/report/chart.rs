//! Lines over time, with axes and a legend.

use super::colour::round_up;
use super::digits::{short, significant};
use super::look::Look;
use super::svg::{Anchor, Svg};

/// One line of a chart.
pub struct Line {
    /// What the legend says; a line without a name is not in it.
    pub name: String,
    /// Stroke colour.
    pub colour: String,
    /// Whether it is drawn dashed.
    pub dashed: bool,
    /// Points in the units of the axes.
    pub points: Vec<[f64; 2]>,
}

/// A chart of lines.
pub struct Chart {
    /// What stands above.
    pub title: String,
    /// Names of the axes with their units.
    pub labels: [String; 2],
    /// The lines, first ones below.
    pub lines: Vec<Line>,
}

/// A place along the first axis that has a name.
pub struct Mark {
    /// Where.
    pub at: f64,
    /// Its name.
    pub name: String,
}

/// Room for the lines (px), and around them: left, top, right (legend), bottom.
const ROOM: [f64; 2] = [640.0, 340.0];
const MARGIN: [f64; 4] = [78.0, 40.0, 190.0, 52.0];

/// Colours after Okabe & Ito (2008), chosen to differ for every kind of colour vision.
pub const COLOURS: [&str; 7] = ["#0072b2", "#d55e00", "#008f68", "#a0528a", "#b98a00", "#444444", "#3fa7d6"];

/// Round values from `low` to `high`, some `count` of them.
pub fn ticks(low: f64, high: f64, count: usize) -> Vec<f64> {
    let step = round_up((high - low) / count as f64);
    let slack = 1e-9 * step;
    let first = ((low - slack) / step).ceil() as i64;
    let last = ((high + slack) / step).floor() as i64;
    (first..=last).map(|k| k as f64 * step).collect()
}

impl Chart {
    /// As the text of an SVG file.
    pub fn svg(&self) -> String {
        self.drawn(&[], &Look::default())
    }

    /// The same with marks, as on a screen or in a paper, where the legend stands below.
    pub fn drawn(&self, marks: &[Mark], look: &Look) -> String {
        let (k, for_paper) = (look.letters(), look.is_for_paper());
        let named: Vec<&Line> = self.lines.iter().filter(|line| !line.name.is_empty()).collect();
        let [left, mut top, mut right, mut bottom] = MARGIN.map(|margin| margin * k);
        let mut room = ROOM;
        if for_paper {
            (top, right) = (10.0, 12.0);
            bottom += (named.len() as f64 * 18.0 + 4.0) * k;
            let width = look.pixels(0.0) - left - right;
            room = [width, width * ROOM[1] / ROOM[0]];
        }
        let size = [left + room[0] + right, top + room[1] + bottom];
        let mut svg = Svg::new(size[0], size[1], &self.title);
        if !for_paper {
            svg.text([left, 22.0], 14.0, Anchor::Start, r#"font-weight="bold""#, &self.title);
        }
        let finite = || self.lines.iter().flat_map(|line| &line.points).filter(|p| p.iter().all(|x| x.is_finite()));
        let extent = |k: usize| finite().map(|p| p[k]).fold([0.0_f64, 0.0], |[a, b], x| [a.min(x), b.max(x)]);
        let [x, mut y] = [extent(0), extent(1)];
        if y[1] - y[0] <= 0.0 {
            y[1] = 1.0;
        }
        let space = 0.05 * (y[1] - y[0]);
        y = [if y[0] < 0.0 { y[0] - space } else { 0.0 }, y[1] + space];
        let width = if x[1] > x[0] { x[1] - x[0] } else { 1.0 };
        let place =
            |p: &[f64; 2]| [left + (p[0] - x[0]) / width * room[0], top + (y[1] - p[1]) / (y[1] - y[0]) * room[1]];
        for tick in ticks(y[0], y[1], 6) {
            let at = place(&[x[0], tick])[1];
            let stroke = if tick == 0.0 { "#999" } else { "#e2e2e2" };
            svg.line([left, at], [left + room[0], at], &format!(r#"stroke="{stroke}""#));
            svg.text([left - 8.0, at + 4.0 * k], 11.0 * k, Anchor::End, "", &significant(tick, 2));
        }
        // In a column of a paper there is room for fewer numbers.
        let count = if for_paper { (room[0] / (48.0 * k)).clamp(2.0, 8.0) as usize } else { 8 };
        for tick in ticks(x[0], x[0] + width, count) {
            let at = place(&[tick, y[0]])[0];
            svg.line([at, top + room[1]], [at, top + room[1] + 5.0], r##"stroke="#555""##);
            svg.text([at, top + room[1] + 5.0 + 14.0 * k], 11.0 * k, Anchor::Middle, "", &short(tick));
        }
        for mark in marks {
            let at = place(&[mark.at, y[0]])[0];
            svg.line([at, top], [at, top + room[1]], r##"stroke="#777" stroke-dasharray="5 4""##);
            svg.text([at + 4.0, top + 14.0 * k], 11.0 * k, Anchor::Start, r##"fill="#555""##, &mark.name);
        }
        svg.rectangle([left, top], room, r##"fill="none" stroke="#555""##);
        let below = top + room[1] + 5.0 + 35.0 * k;
        svg.text([left + room[0] / 2.0, below], 12.0 * k, Anchor::Middle, "", &self.labels[0]);
        svg.text_upwards([18.0 * k, top + room[1] / 2.0], 12.0 * k, "", &self.labels[1]);
        for line in &self.lines {
            let points: Vec<[f64; 2]> =
                line.points.iter().filter(|p| p.iter().all(|x| x.is_finite())).map(place).collect();
            svg.polyline(&points, &style(line));
        }
        for (number, line) in named.into_iter().enumerate() {
            let [from, at] = match for_paper {
                false => [left + room[0] + 14.0, top + 12.0 + 20.0 * number as f64],
                true => [left, below + (16.0 + 18.0 * number as f64) * k],
            };
            svg.line([from, at], [from + 26.0 * k, at], &style(line));
            svg.text([from + 33.0 * k, at + 4.0 * k], 12.0 * k, Anchor::Start, "", &line.name);
        }
        look.sized(svg.finish(), size)
    }
}

fn style(line: &Line) -> String {
    let dash = if line.dashed { r#" stroke-dasharray="6 4""# } else { "" };
    format!(r#"stroke="{}" stroke-width="1.7" stroke-linejoin="round"{dash}"#, line.colour)
}
