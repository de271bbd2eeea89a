//! Pictures of this program as PDF, for papers: a page as large as the picture, lines and letters as such.
//!
//! What is read is what [`svg`](super::svg) writes, no other SVG: shapes with plain attributes, groups that hand theirs on, inner pictures
//! that clip, and text in one font. Letters are those of Helvetica and Symbol, which every reader of PDF has, so that none are embedded.

use std::collections::BTreeMap;

use pdf_writer::types::{LineCapStyle, LineJoinStyle};
use pdf_writer::{Content, Finish as _, Name, Pdf, Rect, Ref, Str, TextStr};
use roxmltree::{Document, Node};

use crate::page::letter_width;

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

/// Points in a pixel of 1/96 inch.
const POINTS: f64 = 0.75;

/// A picture that is none of ours.
#[derive(Debug, thiserror::Error)]
pub enum PdfError {
    /// It is no XML.
    #[error("the picture is no SVG: {0}")]
    Xml(#[from] roxmltree::Error),
    /// A part that is not drawn here.
    #[error("the picture holds <{0}>, which no picture of granulens does")]
    Element(String),
}

/// A picture as a PDF of one page of its size.
///
/// # Errors
/// See [`PdfError`].
pub fn pdf(svg: &str) -> Result<Vec<u8>, PdfError> {
    let document = Document::parse(svg)?;
    let root = document.root_element();
    let [_, _, width, height] = view(&root);
    let shown = [length(root.attribute("width"), width), length(root.attribute("height"), height)];
    let scale = POINTS * shown[0] / width;
    let mut page = Page { content: Content::new(), opacities: BTreeMap::new() };
    page.content.transform([f(scale), 0.0, 0.0, f(-scale), 0.0, f(POINTS * shown[1])]);
    let style = Style::default().with(&root);
    page.children(&root, &style)?;

    let mut file = Pdf::new();
    let (catalog, tree, leaf, content, info) = (Ref::new(1), Ref::new(2), Ref::new(3), Ref::new(4), Ref::new(5));
    let fonts = [
        (Name(b"F"), Ref::new(6), &b"Helvetica"[..]),
        (Name(b"B"), Ref::new(7), b"Helvetica-Bold"),
        (Name(b"S"), Ref::new(8), b"Symbol"),
    ];
    file.catalog(catalog).pages(tree);
    let title =
        root.children().find(|node| node.has_tag_name("title")).and_then(|node| node.text()).unwrap_or_default();
    file.document_info(info).title(TextStr(title)).creator(TextStr("granulens"));
    file.pages(tree).kids([leaf]).count(1);
    for (_, id, base) in fonts {
        let mut font = file.type1_font(id);
        font.base_font(Name(base));
        if base != b"Symbol" {
            font.encoding_predefined(Name(b"WinAnsiEncoding"));
        }
    }
    let states: Vec<((String, [u32; 2]), Ref)> = page
        .opacities
        .iter()
        .enumerate()
        .map(|(k, (alpha, name))| ((name.clone(), *alpha), Ref::new(9 + k as i32)))
        .collect();
    for ((_, [fill, stroke]), id) in &states {
        file.ext_graphics(*id).non_stroking_alpha(*fill as f32 / 1000.0).stroking_alpha(*stroke as f32 / 1000.0);
    }
    file.stream(content, &page.content.finish());
    let mut sheet = file.page(leaf);
    sheet.media_box(Rect::new(0.0, 0.0, f(POINTS * shown[0]), f(POINTS * shown[1]))).parent(tree).contents(content);
    let mut resources = sheet.resources();
    resources.fonts().pairs(fonts.map(|(name, id, _)| (name, id)));
    let mut graphics = resources.ext_g_states();
    for ((name, _), id) in &states {
        graphics.pair(Name(name.as_bytes()), *id);
    }
    graphics.finish();
    resources.finish();
    sheet.finish();
    Ok(file.finish())
}

fn f(x: f64) -> f32 {
    ((x * 1e4).round() / 1e4) as f32
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
struct Style<'a>(BTreeMap<&'static str, &'a str>);

impl<'a> Style<'a> {
    /// With what an element says itself.
    fn with(&self, node: &Node<'a, '_>) -> Self {
        let mut style = self.clone();
        for name in INHERITED {
            if let Some(value) = node.attribute(name) {
                style.0.insert(name, value);
            }
        }
        style
    }

    fn number(&self, name: &str, usual: f64) -> f64 {
        self.0.get(name).and_then(|text| text.trim_end_matches("px").parse().ok()).unwrap_or(usual)
    }

    /// A colour; none where nothing is painted.
    fn colour(&self, name: &str, usual: Option<[f64; 3]>) -> Option<[f64; 3]> {
        let Some(text) = self.0.get(name) else { return usual };
        let digits = text.strip_prefix('#')?;
        let part = |at: usize, long: usize| {
            let value = f64::from(u8::from_str_radix(digits.get(at * long..(at + 1) * long)?, 16).ok()?);
            Some(if long == 1 { value * 17.0 } else { value } / 255.0)
        };
        let long = if digits.len() == 3 { 1 } else { 2 };
        Some([part(0, long)?, part(1, long)?, part(2, long)?])
    }
}

struct Page {
    content: Content,
    /// Opacities of fill and stroke (thousandths), and the name of the state that has them.
    opacities: BTreeMap<[u32; 2], String>,
}

/// A step of a path, places absolute.
enum Step {
    Move([f64; 2]),
    Line([f64; 2]),
    Close,
}

impl Page {
    fn children(&mut self, node: &Node<'_, '_>, style: &Style<'_>) -> Result<(), PdfError> {
        node.children().filter(Node::is_element).try_for_each(|child| self.element(&child, style))
    }

    fn element(&mut self, node: &Node<'_, '_>, above: &Style<'_>) -> Result<(), PdfError> {
        let style = above.with(node);
        let number = |name: &str| length(node.attribute(name), 0.0);
        match node.tag_name().name() {
            "title" => {}
            "g" => self.children(node, &style)?,
            "svg" => {
                let (corner, size) = ([number("x"), number("y")], [number("width"), number("height")]);
                self.content.save_state();
                self.content.rect(f(corner[0]), f(corner[1]), f(size[0]), f(size[1])).clip_nonzero().end_path();
                self.children(node, &style)?;
                self.content.restore_state();
            }
            "rect" => {
                let ([x, y], [width, height]) = ([number("x"), number("y")], [number("width"), number("height")]);
                let corners = [[x, y], [x + width, y], [x + width, y + height], [x, y + height]];
                self.shape(&closed(&corners), &style);
            }
            "line" => {
                let steps = [Step::Move([number("x1"), number("y1")]), Step::Line([number("x2"), number("y2")])];
                self.shape(&steps, &style);
            }
            "polyline" | "polygon" => {
                let points: Vec<[f64; 2]> = numbers(node.attribute("points").unwrap_or_default())
                    .chunks_exact(2)
                    .map(|p| [p[0], p[1]])
                    .collect();
                if node.has_tag_name("polygon") {
                    self.shape(&closed(&points), &style);
                } else {
                    self.shape(&open(&points), &style);
                }
            }
            "circle" => {
                // So many corners leave a circle by less than a thousandth of its radius.
                const CORNERS: u32 = 72;
                let ([x, y], r) = ([number("cx"), number("cy")], number("r"));
                let corner = |k: u32| {
                    let angle = f64::from(k) / f64::from(CORNERS) * std::f64::consts::TAU;
                    [x + r * angle.cos(), y + r * angle.sin()]
                };
                self.shape(&closed(&(0..CORNERS).map(corner).collect::<Vec<_>>()), &style);
            }
            "path" => self.shape(&steps(node.attribute("d").unwrap_or_default()), &style),
            "text" => self.text(node, &style),
            other => return Err(PdfError::Element(other.to_owned())),
        }
        Ok(())
    }

    /// Sets how strongly is painted.
    fn opacity(&mut self, style: &Style<'_>) {
        let whole = style.number("opacity", 1.0);
        let part = |name: &str| (style.number(name, 1.0) * whole * 1000.0).round() as u32;
        let alpha = [part("fill-opacity"), part("stroke-opacity")];
        let count = self.opacities.len();
        let name = self.opacities.entry(alpha).or_insert_with(|| format!("A{count}"));
        self.content.set_parameters(Name(name.as_bytes()));
    }

    fn pen(&mut self, style: &Style<'_>, [r, g, b]: [f64; 3]) {
        self.content.set_stroke_rgb(f(r), f(g), f(b)).set_line_width(f(style.number("stroke-width", 1.0)));
        let dash = style.0.get("stroke-dasharray").map(|text| numbers(text)).unwrap_or_default();
        self.content.set_dash_pattern(dash.into_iter().map(f), 0.0);
        let round = |name: &str| style.0.get(name) == Some(&"round");
        self.content.set_line_join(if round("stroke-linejoin") {
            LineJoinStyle::RoundJoin
        } else {
            LineJoinStyle::MiterJoin
        });
        self.content.set_line_cap(if round("stroke-linecap") { LineCapStyle::RoundCap } else { LineCapStyle::ButtCap });
    }

    fn shape(&mut self, steps: &[Step], style: &Style<'_>) {
        let fill = style.colour("fill", Some([0.0; 3]));
        let stroke = style.colour("stroke", None);
        if steps.is_empty() || (fill.is_none() && stroke.is_none()) {
            return;
        }
        self.opacity(style);
        if let Some([r, g, b]) = fill {
            self.content.set_fill_rgb(f(r), f(g), f(b));
        }
        if let Some(colour) = stroke {
            self.pen(style, colour);
        }
        for step in steps {
            match *step {
                Step::Move([x, y]) => self.content.move_to(f(x), f(y)),
                Step::Line([x, y]) => self.content.line_to(f(x), f(y)),
                Step::Close => self.content.close_path(),
            };
        }
        match (fill.is_some(), stroke.is_some()) {
            (true, true) => self.content.fill_nonzero_and_stroke(),
            (true, false) => self.content.fill_nonzero(),
            _ => self.content.stroke(),
        };
    }

    /// A line of text; parts in a `tspan` may be smaller and lower.
    fn text(&mut self, node: &Node<'_, '_>, style: &Style<'_>) {
        let size = style.number("font-size", 12.0);
        let bold = style.0.get("font-weight") == Some(&"bold");
        // Runs of one font, each with its size and how much lower it stands.
        let mut runs: Vec<Run> = Vec::new();
        for part in node.children() {
            let (text, scale, lower) = if part.is_text() {
                (part.text().unwrap_or_default(), 1.0, 0.0)
            } else {
                let own = Style::default().with(&part).number("font-size", size);
                (part.text().unwrap_or_default(), own / size, length(part.attribute("dy"), 0.0))
            };
            text.chars().for_each(|c| Run::add(&mut runs, c, bold, scale * size, lower));
        }
        let width: f64 = runs.iter().map(|run| run.width).sum();
        let start = match style.0.get("text-anchor") {
            Some(&"middle") => -0.5 * width,
            Some(&"end") => -width,
            _ => 0.0,
        };
        let [x, y] = ["x", "y"].map(|name| length(node.attribute(name), 0.0));
        let turned = node
            .attribute("transform")
            .and_then(|text| text.strip_prefix("rotate(")?.split([' ', ')']).next()?.parse::<f64>().ok());
        let (sine, cosine) = turned.unwrap_or(0.0).to_radians().sin_cos();
        self.opacity(style);
        // A halo is painted below the letters.
        let halo = style.colour("stroke", None).filter(|_| node.attribute("paint-order") == Some("stroke"));
        for is_halo in [true, false] {
            if is_halo && halo.is_none() {
                continue;
            }
            let mode = if is_halo {
                pdf_writer::types::TextRenderingMode::Stroke
            } else {
                pdf_writer::types::TextRenderingMode::Fill
            };
            match halo.filter(|_| is_halo) {
                Some(colour) => self.pen(style, colour),
                None => {
                    let [r, g, b] = style.colour("fill", Some([0.0; 3])).unwrap_or_default();
                    self.content.set_fill_rgb(f(r), f(g), f(b));
                }
            }
            let (mut along, mut down) = (start, 0.0);
            for run in &runs {
                down += run.lower;
                let place = [x + along * cosine - down * sine, y + along * sine + down * cosine];
                self.content.begin_text().set_font(Name(run.font.as_bytes()), f(run.size));
                self.content.set_text_rendering_mode(mode);
                self.content.set_text_matrix([f(cosine), f(sine), f(sine), f(-cosine), f(place[0]), f(place[1])]);
                self.content.show(Str(&run.bytes)).end_text();
                along += run.width;
            }
        }
    }
}

/// Letters of one font, one size and one height.
struct Run {
    font: &'static str,
    bytes: Vec<u8>,
    size: f64,
    /// How much lower than the run before (px).
    lower: f64,
    width: f64,
}

impl Run {
    fn add(runs: &mut Vec<Self>, c: char, bold: bool, size: f64, lower: f64) {
        let plain = if bold { "B" } else { "F" };
        if c == '\u{200b}' {
            runs.push(Self { font: plain, bytes: Vec::new(), size, lower, width: 0.0 });
            return;
        }
        let (font, byte, width) = match c {
            ' '..='~' => (plain, c as u8, letter_width(c, bold)),
            // These stand in WinAnsi where they stand in Latin-1.
            '\u{a0}'..='\u{ff}' => (plain, c as u32 as u8, 0.556),
            '–' => (plain, 0x96, 0.556),
            '—' => (plain, 0x97, 1.0),
            '‘' | '’' => (plain, 0x92, 0.222),
            '−' => (plain, 0x96, 0.556),
            'Δ' => ("S", b'D', 0.612),
            'α' => ("S", b'a', 0.631),
            'β' => ("S", b'b', 0.549),
            'γ' => ("S", b'g', 0.411),
            'δ' => ("S", b'd', 0.494),
            'η' => ("S", b'h', 0.603),
            'θ' => ("S", b'q', 0.521),
            'μ' => ("S", b'm', 0.576),
            'ν' => ("S", b'n', 0.521),
            'π' => ("S", b'p', 0.549),
            'ρ' => ("S", b'r', 0.549),
            'σ' => ("S", b's', 0.603),
            'τ' => ("S", b't', 0.439),
            'ω' => ("S", b'w', 0.686),
            '≤' => ("S", 0xa3, 0.549),
            '≥' => ("S", 0xb3, 0.549),
            '√' => ("S", 0xd6, 0.549),
            _ => (plain, b'?', 0.556),
        };
        match runs.last_mut() {
            // A part that stands lower begins a run; the letters after its first go on in it.
            Some(run) if run.font == font && run.size == size && (lower == 0.0 || run.lower == lower) => {
                run.bytes.push(byte);
                run.width += width * size;
            }
            last => {
                let lower = if last.is_some_and(|run| run.size == size && run.lower == lower) { 0.0 } else { lower };
                runs.push(Self { font, bytes: vec![byte], size, lower, width: width * size });
            }
        }
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

/// The steps of path data: M, L, l, h, v and z, as our pictures write them.
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
            if letter == b'M' {
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
        let shown: Vec<String> = steps("M1 2l3-4.5 1,1v2h-1zM0 0L5 6")
            .iter()
            .map(|step| match step {
                Step::Move([x, y]) => format!("M{x} {y}"),
                Step::Line([x, y]) => format!("L{x} {y}"),
                Step::Close => "z".to_owned(),
            })
            .collect();
        assert_eq!(shown, ["M1 2", "L4 -2.5", "L5 -1.5", "L5 0.5", "L4 0.5", "z", "M0 0", "L5 6"]);
    }

    /// A page of the picture's size, with text that readers can search.
    #[test]
    fn a_picture_becomes_a_page_of_its_size() {
        let svg = r##"<svg xmlns="http://www.w3.org/2000/svg" width="86mm" height="43mm" viewBox="0 0 200 100" fill="#222"><title>t</title>
<rect width="200" height="100" fill="#fff"/><g stroke="#f00"><circle cx="5" cy="5" r="2" fill="none"/></g>
<text x="100" y="50" font-size="10" text-anchor="middle">F<tspan font-size="7" dy="2">p</tspan> τ µ</text></svg>"##;
        let bytes = pdf(svg).unwrap();
        let text = String::from_utf8_lossy(&bytes);
        assert!(text.starts_with("%PDF-") && text.contains("/MediaBox [0 0 243.7795 121.8898]"), "{text}");
        assert!(matches!(pdf("<svg xmlns=\"http://www.w3.org/2000/svg\"><image/></svg>"), Err(PdfError::Element(_))));
    }
}
