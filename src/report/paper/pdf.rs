//! Pictures as PDF, for papers: a page as large as the picture. Letters are those of Helvetica and Symbol, which every reader of PDF has, so that
//! none are embedded.

use std::collections::BTreeMap;

use pdf_writer::types::{LineCapStyle, LineJoinStyle};
use pdf_writer::{Content, Finish as _, Name, Pdf, Rect, Ref, Str, TextStr};
use roxmltree::Document;

use super::{Canvas, PaperError, Size, Step, Style, Text, paint, size};
use crate::page::letter_width;

/// Points in a pixel of 1/96 inch.
const POINTS: f64 = 0.75;

/// A picture as a PDF of one page of its size.
///
/// # Errors
/// See [`PaperError`].
pub fn pdf(svg: &str) -> Result<Vec<u8>, PaperError> {
    let document = Document::parse(svg)?;
    let root = document.root_element();
    let Size { view, shown, .. } = size(&root);
    let scale = POINTS * shown[0] / view[0];
    let mut page = Page { content: Content::new(), opacities: BTreeMap::new() };
    page.content.transform([f(scale), 0.0, 0.0, f(-scale), 0.0, f(POINTS * shown[1])]);
    paint(&mut page, &document)?;

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

struct Page {
    content: Content,
    /// Opacities of fill and stroke (thousandths), and the name of the state that has them.
    opacities: BTreeMap<[u32; 2], String>,
}

impl Page {
    /// Sets how strongly is painted.
    fn opacity(&mut self, style: &Style<'_>) {
        let alpha = style.opacities().map(|part| (part * 1000.0).round() as u32);
        let count = self.opacities.len();
        let name = self.opacities.entry(alpha).or_insert_with(|| format!("A{count}"));
        self.content.set_parameters(Name(name.as_bytes()));
    }

    fn pen(&mut self, style: &Style<'_>, [r, g, b]: [f64; 3]) {
        self.content.set_stroke_rgb(f(r), f(g), f(b)).set_line_width(f(style.number("stroke-width", 1.0)));
        self.content.set_dash_pattern(style.dashes().into_iter().map(f), 0.0);
        let round = |name: &str| style.is_round(name);
        self.content.set_line_join(if round("stroke-linejoin") {
            LineJoinStyle::RoundJoin
        } else {
            LineJoinStyle::MiterJoin
        });
        self.content.set_line_cap(if round("stroke-linecap") { LineCapStyle::RoundCap } else { LineCapStyle::ButtCap });
    }
}

impl Canvas for Page {
    fn clip(&mut self, corner: [f64; 2], size: [f64; 2]) {
        self.content.save_state();
        self.content.rect(f(corner[0]), f(corner[1]), f(size[0]), f(size[1])).clip_nonzero().end_path();
    }

    fn unclip(&mut self) {
        self.content.restore_state();
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

    fn text(&mut self, text: &Text<'_>, style: &Style<'_>) {
        // Runs of one font, each with its size and how much lower it stands.
        let mut runs: Vec<Run> = Vec::new();
        for (letters, size, lower) in &text.parts {
            letters.chars().for_each(|c| Run::add(&mut runs, c, text.bold, *size, *lower));
        }
        let width: f64 = runs.iter().map(|run| run.width).sum();
        let start = text.start(width);
        let (sine, cosine) = text.angle.sin_cos();
        self.opacity(style);
        // A halo is painted below the letters.
        let halo = text.halo;
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
                let place = text.place(along, down);
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

#[cfg(test)]
mod tests {
    use super::*;

    /// A page of the picture's size, with text that readers can search.
    #[test]
    fn a_picture_becomes_a_page_of_its_size() {
        let svg = r##"<svg xmlns="http://www.w3.org/2000/svg" width="86mm" height="43mm" viewBox="0 0 200 100" fill="#222"><title>t</title>
<rect width="200" height="100" fill="#fff"/><g stroke="#f00"><circle cx="5" cy="5" r="2" fill="none"/></g>
<text x="100" y="50" font-size="10" text-anchor="middle">F<tspan font-size="7" dy="2">p</tspan> τ µ</text></svg>"##;
        let bytes = pdf(svg).unwrap();
        let text = String::from_utf8_lossy(&bytes);
        assert!(text.starts_with("%PDF-") && text.contains("/MediaBox [0 0 243.7795 121.8898]"), "{text}");
        assert!(matches!(pdf("<svg xmlns=\"http://www.w3.org/2000/svg\"><image/></svg>"), Err(PaperError::Element(_))));
    }
}
