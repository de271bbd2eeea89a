//! Pictures of this program on paper: as PDF, lines and letters as such, and as PNG, in dots.
//!
//! What is read is what [`svg`](super::svg) writes, no other SVG: shapes with plain attributes, groups that hand theirs on, inner pictures
//! that clip, and text in one font. A [`Canvas`] is painted on, of which there is one for each kind of file.
//!
//! - `pdf`: a page; `png`: dots; `letters`: the font of these

mod letters;
mod pdf;
mod png;

use std::collections::BTreeMap;

use roxmltree::{Document, Node};

pub use pdf::pdf;
pub use png::png;

/// Attributes that groups hand on to what stands in them.
const INHERITED: [&str; 12] = [
    "opacity",
    "fill",
    "fill-opacity",
    "stroke",
    "stroke-width",
    "stroke-opacity",
    "stroke-dasharray",
    "stroke-linejoin",
    "stroke-linecap",
    "font-size",
    "font-weight",
    "text-anchor",
];

/// Why a picture is not drawn on paper.
#[derive(Debug, thiserror::Error)]
pub enum PaperError {
    /// It is no XML.
    #[error("the picture is no SVG: {0}")]
    Xml(#[from] roxmltree::Error),
    /// A part that is not drawn here.
    #[error("the picture holds <{0}>, which no picture of granulens does")]
    Element(String),
    /// More dots than there are to be had.
    #[error("a picture of {0} by {1} dots is too large; 20000 each way are the most")]
    Large(u32, u32),
}

/// What a picture is painted on.
trait Canvas {
    /// What follows is cut off outside a rectangle, until [`Canvas::unclip`].
    fn clip(&mut self, corner: [f64; 2], size: [f64; 2]);
    /// Ends the innermost clip.
    fn unclip(&mut self);
    /// A shape, filled and outlined as its style says.
    fn shape(&mut self, steps: &[Step], style: &Style<'_>);
    /// A line of text.
    fn text(&mut self, text: &Text<'_>, style: &Style<'_>);
}

/// A step of a path, places absolute.
enum Step {
    Move([f64; 2]),
    Line([f64; 2]),
    Close,
}

/// A line of text.
struct Text<'a> {
    /// Its parts: letters, their size (px), and how much lower they stand than the part before (px).
    parts: Vec<(&'a str, f64, f64)>,
    bold: bool,
    /// Where it is anchored, on its baseline (px).
    at: [f64; 2],
    anchor: Option<&'a str>,
    /// By how much it is turned (rad), to the right.
    angle: f64,
    /// The colour of the edge that is painted below its letters.
    halo: Option<[f64; 3]>,
}

impl Text<'_> {
    /// Where it begins along its own direction, counted from the anchor, for a width.
    fn start(&self, width: f64) -> f64 {
        match self.anchor {
            Some("middle") => -0.5 * width,
            Some("end") => -width,
            _ => 0.0,
        }
    }

    /// The place of a point of the line, so far along it and below its baseline.
    fn place(&self, along: f64, down: f64) -> [f64; 2] {
        let (sine, cosine) = self.angle.sin_cos();
        [self.at[0] + along * cosine - down * sine, self.at[1] + along * sine + down * cosine]
    }
}

/// A picture's size: in its own units, and as shown (px).
struct Size {
    view: [f64; 2],
    shown: [f64; 2],
    /// Whether the width is one on paper.
    printed: bool,
}

fn size(root: &Node<'_, '_>) -> Size {
    let [_, _, width, height] = view(root);
    let shown = [length(root.attribute("width"), width), length(root.attribute("height"), height)];
    let printed = root.attribute("width").is_some_and(|text| text.ends_with("mm"));
    Size { view: [width, height], shown, printed }
}

/// Paints a picture.
fn paint(canvas: &mut impl Canvas, document: &Document<'_>) -> Result<(), PaperError> {
    let root = document.root_element();
    children(canvas, &root, &Style::default().with(&root))
}

fn children(canvas: &mut impl Canvas, node: &Node<'_, '_>, style: &Style<'_>) -> Result<(), PaperError> {
    node.children().filter(Node::is_element).try_for_each(|child| element(canvas, &child, style))
}

fn element(canvas: &mut impl Canvas, node: &Node<'_, '_>, above: &Style<'_>) -> Result<(), PaperError> {
    let style = above.with(node);
    let number = |name: &str| length(node.attribute(name), 0.0);
    match node.tag_name().name() {
        "title" => {}
        "g" => children(canvas, node, &style)?,
        "svg" => {
            canvas.clip([number("x"), number("y")], [number("width"), number("height")]);
            let done = children(canvas, node, &style);
            canvas.unclip();
            done?;
        }
        "rect" => {
            let ([x, y], [width, height]) = ([number("x"), number("y")], [number("width"), number("height")]);
            let corners = [[x, y], [x + width, y], [x + width, y + height], [x, y + height]];
            canvas.shape(&closed(&corners), &style);
        }
        "line" => {
            let steps = [Step::Move([number("x1"), number("y1")]), Step::Line([number("x2"), number("y2")])];
            canvas.shape(&steps, &style);
        }
        "polyline" | "polygon" => {
            let points: Vec<[f64; 2]> =
                numbers(node.attribute("points").unwrap_or_default()).chunks_exact(2).map(|p| [p[0], p[1]]).collect();
            let steps = if node.has_tag_name("polygon") { closed(&points) } else { open(&points) };
            canvas.shape(&steps, &style);
        }
        "circle" => {
            // So many corners leave a circle by less than a thousandth of its radius.
            const CORNERS: u32 = 72;
            let ([x, y], r) = ([number("cx"), number("cy")], number("r"));
            let corner = |k: u32| {
                let angle = f64::from(k) / f64::from(CORNERS) * std::f64::consts::TAU;
                [x + r * angle.cos(), y + r * angle.sin()]
            };
            canvas.shape(&closed(&(0..CORNERS).map(corner).collect::<Vec<_>>()), &style);
        }
        "path" => canvas.shape(&steps(node.attribute("d").unwrap_or_default()), &style),
        "text" => canvas.text(&text(node, &style), &style),
        other => return Err(PaperError::Element(other.to_owned())),
    }
    Ok(())
}

/// A line of text; parts in a `tspan` may be smaller and lower.
fn text<'a>(node: &Node<'a, '_>, style: &Style<'a>) -> Text<'a> {
    let size = style.number("font-size", 12.0);
    let part = |part: Node<'a, '_>| {
        let text = part.text().unwrap_or_default();
        if part.is_text() {
            return (text, size, 0.0);
        }
        (text, Style::default().with(&part).number("font-size", size), length(part.attribute("dy"), 0.0))
    };
    let turned = node
        .attribute("transform")
        .and_then(|text| text.strip_prefix("rotate(")?.split([' ', ')']).next()?.parse::<f64>().ok());
    Text {
        parts: node.children().map(part).collect(),
        bold: style.word("font-weight") == Some("bold"),
        at: ["x", "y"].map(|name| length(node.attribute(name), 0.0)),
        anchor: style.word("text-anchor"),
        angle: turned.unwrap_or(0.0).to_radians(),
        halo: style.colour("stroke", None).filter(|_| node.attribute("paint-order") == Some("stroke")),
    }
}

/// A length in pixels; millimetres are turned into them.
fn length(text: Option<&str>, usual: f64) -> f64 {
    let Some(text) = text else { return usual };
    let (number, unit) = match text.strip_suffix("mm") {
        Some(number) => (number, 96.0 / 25.4),
        None => (text, 1.0),
    };
    number.trim().parse().map_or(usual, |value: f64| value * unit)
}

fn view(node: &Node<'_, '_>) -> [f64; 4] {
    let numbers = numbers(node.attribute("viewBox").unwrap_or_default());
    std::array::from_fn(|k| numbers.get(k).copied().unwrap_or(if k < 2 { 0.0 } else { 1.0 }))
}

/// The numbers of a text, whatever parts them.
fn numbers(text: &str) -> Vec<f64> {
    text.split([' ', ',', '\n']).filter_map(|word| word.parse().ok()).collect()
}

/// What shapes are painted with.
#[derive(Clone, Default)]
pub(super) struct Style<'a>(BTreeMap<&'static str, &'a str>);

impl<'a> Style<'a> {
    /// With what an element says itself.
    pub(super) fn with(&self, node: &Node<'a, '_>) -> Self {
        let mut style = self.clone();
        for name in INHERITED {
            if let Some(value) = node.attribute(name) {
                style.0.insert(name, value);
            }
        }
        style
    }

    pub(super) fn number(&self, name: &str, usual: f64) -> f64 {
        self.0.get(name).and_then(|text| text.trim_end_matches("px").parse().ok()).unwrap_or(usual)
    }

    /// A colour; none where nothing is painted.
    pub(super) fn colour(&self, name: &str, usual: Option<[f64; 3]>) -> Option<[f64; 3]> {
        let Some(text) = self.0.get(name) else { return usual };
        let digits = text.strip_prefix('#')?;
        let part = |at: usize, long: usize| {
            let value = f64::from(u8::from_str_radix(digits.get(at * long..(at + 1) * long)?, 16).ok()?);
            Some(if long == 1 { value * 17.0 } else { value } / 255.0)
        };
        let long = if digits.len() == 3 { 1 } else { 2 };
        Some([part(0, long)?, part(1, long)?, part(2, long)?])
    }

    /// What is written for a name.
    pub(super) fn word(&self, name: &str) -> Option<&'a str> {
        self.0.get(name).copied()
    }

    /// Opacities of fill and stroke.
    pub(super) fn opacities(&self) -> [f64; 2] {
        let whole = self.number("opacity", 1.0);
        ["fill-opacity", "stroke-opacity"].map(|name| self.number(name, 1.0) * whole)
    }

    /// Dashes and gaps of its lines; empty for unbroken ones.
    pub(super) fn dashes(&self) -> Vec<f64> {
        self.0.get("stroke-dasharray").map(|text| numbers(text)).unwrap_or_default()
    }

    /// Whether joins or caps are round.
    pub(super) fn is_round(&self, name: &str) -> bool {
        self.word(name) == Some("round")
    }
}

fn open(points: &[[f64; 2]]) -> Vec<Step> {
    points.iter().enumerate().map(|(k, &point)| if k == 0 { Step::Move(point) } else { Step::Line(point) }).collect()
}

fn closed(points: &[[f64; 2]]) -> Vec<Step> {
    let mut steps = open(points);
    if !steps.is_empty() {
        steps.push(Step::Close);
    }
    steps
}

/// The steps of path data: M, m, L, l, h, v and z, as our pictures write them.
fn steps(data: &str) -> Vec<Step> {
    let mut steps = Vec::new();
    let (mut at, mut begun) = ([0.0; 2], [0.0; 2]);
    let mut rest = data;
    while let Some(command) = rest.find(|c: char| c.is_ascii_alphabetic()) {
        let letter = rest.as_bytes()[command];
        rest = &rest[command + 1..];
        let end = rest.find(|c: char| c.is_ascii_alphabetic()).unwrap_or(rest.len());
        let values = signed(&rest[..end]);
        rest = &rest[end..];
        if letter == b'z' || letter == b'Z' {
            steps.push(Step::Close);
            at = begun;
            continue;
        }
        let pairs: Vec<[f64; 2]> = match letter {
            b'h' => values.iter().map(|x| [*x, 0.0]).collect(),
            b'v' => values.iter().map(|y| [0.0, *y]).collect(),
            _ => values.chunks_exact(2).map(|pair| [pair[0], pair[1]]).collect(),
        };
        for pair in pairs {
            at = if letter.is_ascii_lowercase() { [at[0] + pair[0], at[1] + pair[1]] } else { pair };
            if letter.eq_ignore_ascii_case(&b'm') {
                begun = at;
                steps.push(Step::Move(at));
            } else {
                steps.push(Step::Line(at));
            }
        }
    }
    steps
}

/// Numbers parted by blanks, commas or the sign of the next.
fn signed(text: &str) -> Vec<f64> {
    let mut words: Vec<String> = vec![String::new()];
    for c in text.chars() {
        match c {
            ' ' | ',' => words.push(String::new()),
            '-' if words.last().is_some_and(|word| !word.is_empty()) => words.push("-".to_owned()),
            c => words.last_mut().into_iter().for_each(|word| word.push(c)),
        }
    }
    words.iter().filter_map(|word| word.parse().ok()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_read_as_they_are_written() {
        let shown: Vec<String> = steps("M1 2l3-4.5 1,1v2h-1zm-1-2L5 6")
            .iter()
            .map(|step| match step {
                Step::Move([x, y]) => format!("M{x} {y}"),
                Step::Line([x, y]) => format!("L{x} {y}"),
                Step::Close => "z".to_owned(),
            })
            .collect();
        assert_eq!(shown, ["M1 2", "L4 -2.5", "L5 -1.5", "L5 0.5", "L4 0.5", "z", "M0 0", "L5 6"]);
    }
}
