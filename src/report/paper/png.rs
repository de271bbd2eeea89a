//! Pictures in dots, for slides and for programs that take no others: 300 of them to an inch of a width on paper, else two to a pixel each way.

use roxmltree::Document;
use tiny_skia::{
    Color, FillRule, LineCap, LineJoin, Mask, Paint, Path, PathBuilder, Pixmap, Rect, Stroke, StrokeDash, Transform,
};

use super::letters::outline;
use super::{Canvas, PaperError, Step, Style, Text, paint, size};

/// Dots to a pixel of 1/96 inch: on a screen, and in print.
const SCREEN: f64 = 2.0;
const PRINT: f64 = 300.0 / 96.0;

/// The greatest number of dots each way.
const MOST: u32 = 20_000;

/// A picture as PNG, on white.
///
/// # Errors
/// See [`PaperError`].
pub fn png(svg: &str) -> Result<Vec<u8>, PaperError> {
    let document = Document::parse(svg)?;
    let size = size(&document.root_element());
    let dots = if size.printed { PRINT } else { SCREEN };
    let [width, height] = size.shown.map(|length| (length * dots).ceil().clamp(1.0, 1e9) as u32);
    let large = || PaperError::Large(width, height);
    if width.max(height) > MOST {
        return Err(large());
    }
    let mut sheet = Pixmap::new(width, height).ok_or_else(large)?;
    sheet.fill(Color::WHITE);
    let scale = (dots * size.shown[0] / size.view[0]) as f32;
    let mut dotted = Dotted { sheet, scale: Transform::from_scale(scale, scale), clips: Vec::new() };
    paint(&mut dotted, &document)?;
    let bytes = dotted.sheet.encode_png().map_err(|_| large())?;
    Ok(with_density(&bytes, dots * 96.0))
}

/// With how many dots there are to an inch, which word processors go by: a chunk of its own behind the first (PNG specification, section 11.3.4.3).
fn with_density(bytes: &[u8], per_inch: f64) -> Vec<u8> {
    // Signature, and the header's length, name, 13 bytes and checksum.
    const FIRST: usize = 8 + 4 + 4 + 13 + 4;
    let per_metre = (per_inch / 0.0254).round() as u32;
    let mut chunk = b"pHYs".to_vec();
    chunk.extend(per_metre.to_be_bytes());
    chunk.extend(per_metre.to_be_bytes());
    chunk.push(1);
    let mut with = bytes[..FIRST].to_vec();
    with.extend((chunk.len() as u32 - 4).to_be_bytes());
    with.extend(&chunk);
    with.extend(crc32fast::hash(&chunk).to_be_bytes());
    with.extend(&bytes[FIRST..]);
    with
}

struct Dotted {
    sheet: Pixmap,
    scale: Transform,
    /// What may be painted on, the innermost clip last; none where it is empty.
    clips: Vec<Option<Mask>>,
}

fn colour([r, g, b]: [f64; 3], opacity: f64) -> Paint<'static> {
    let part = |x: f64| x.clamp(0.0, 1.0) as f32;
    let mut paint = Paint { anti_alias: true, ..Paint::default() };
    paint.set_color(Color::from_rgba(part(r), part(g), part(b), part(opacity)).unwrap_or(Color::BLACK));
    paint
}

fn pen(style: &Style<'_>) -> Stroke {
    let dashes: Vec<f32> = style.dashes().into_iter().map(|dash| dash as f32).collect();
    Stroke {
        width: style.number("stroke-width", 1.0) as f32,
        line_cap: if style.is_round("stroke-linecap") { LineCap::Round } else { LineCap::Butt },
        line_join: if style.is_round("stroke-linejoin") { LineJoin::Round } else { LineJoin::Miter },
        // An odd number of lengths is taken twice, as SVG has it.
        dash: StrokeDash::new(if dashes.len() % 2 == 1 { dashes.repeat(2) } else { dashes }, 0.0),
        ..Stroke::default()
    }
}

impl Dotted {
    fn fill(&mut self, path: &Path, paint: &Paint<'_>, place: Transform) {
        let Some(clip) = self.clips.last().map_or(Some(None), |clip| clip.as_ref().map(Some)) else { return };
        self.sheet.fill_path(path, paint, FillRule::Winding, place, clip);
    }

    fn stroke(&mut self, path: &Path, paint: &Paint<'_>, pen: &Stroke, place: Transform) {
        let Some(clip) = self.clips.last().map_or(Some(None), |clip| clip.as_ref().map(Some)) else { return };
        self.sheet.stroke_path(path, paint, pen, place, clip);
    }
}

impl Canvas for Dotted {
    fn clip(&mut self, [x, y]: [f64; 2], [width, height]: [f64; 2]) {
        let window = Rect::from_xywh(x as f32, y as f32, width as f32, height as f32).map(PathBuilder::from_rect);
        let around = self.clips.last();
        let clip = window.and_then(|window| {
            let mut clip = match around {
                Some(around) => around.clone()?,
                None => {
                    let mut whole = Mask::new(self.sheet.width(), self.sheet.height())?;
                    whole.fill_path(&window, FillRule::Winding, true, self.scale);
                    return Some(whole);
                }
            };
            clip.intersect_path(&window, FillRule::Winding, true, self.scale);
            Some(clip)
        });
        self.clips.push(clip);
    }

    fn unclip(&mut self) {
        self.clips.pop();
    }

    fn shape(&mut self, steps: &[Step], style: &Style<'_>) {
        let mut path = PathBuilder::new();
        for step in steps {
            match *step {
                Step::Move([x, y]) => path.move_to(x as f32, y as f32),
                Step::Line([x, y]) => path.line_to(x as f32, y as f32),
                Step::Close => path.close(),
            }
        }
        let Some(path) = path.finish() else { return };
        let [fill, stroke] = style.opacities();
        if let Some(inside) = style.colour("fill", Some([0.0; 3])) {
            self.fill(&path, &colour(inside, fill), self.scale);
        }
        if let Some(edge) = style.colour("stroke", None) {
            self.stroke(&path, &colour(edge, stroke), &pen(style), self.scale);
        }
    }

    fn text(&mut self, text: &Text<'_>, style: &Style<'_>) {
        let parts: Vec<_> =
            text.parts.iter().map(|(letters, size, lower)| (outline(letters, *size, text.bold), *lower)).collect();
        let start = text.start(parts.iter().map(|((_, width), _)| width).sum());
        let [fill, stroke] = style.opacities();
        let inside = colour(style.colour("fill", Some([0.0; 3])).unwrap_or_default(), fill);
        // The edge is painted below all letters.
        for is_halo in [true, false] {
            let (mut along, mut down) = (start, 0.0);
            for ((path, width), lower) in &parts {
                down += lower;
                let [x, y] = text.place(along, down);
                along += width;
                let Some(path) = path else { continue };
                let (sine, cosine) = text.angle.sin_cos();
                let place =
                    Transform::from_row(cosine as f32, sine as f32, -sine as f32, cosine as f32, x as f32, y as f32);
                let place = self.scale.pre_concat(place);
                match text.halo.filter(|_| is_halo) {
                    Some(edge) => self.stroke(path, &colour(edge, stroke), &pen(style), place),
                    None if is_halo => {}
                    None => self.fill(path, &inside, place),
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn dots(svg: &str) -> Pixmap {
        Pixmap::decode_png(&png(svg).unwrap()).unwrap()
    }

    fn at(dots: &Pixmap, x: u32, y: u32) -> [u8; 3] {
        let dot = dots.pixel(x, y).unwrap();
        [dot.red(), dot.green(), dot.blue()]
    }

    /// Two dots to a pixel: shapes where they are, cut where they are clipped, letters dark on their halo.
    #[test]
    fn a_picture_becomes_dots_of_its_colours() {
        let svg = r##"<svg xmlns="http://www.w3.org/2000/svg" width="100" height="50" viewBox="0 0 100 50" fill="#222"><title>t</title>
<rect x="10" y="10" width="20" height="20" fill="#f00" fill-opacity="0.5"/>
<svg x="40" y="0" width="10" height="50"><rect x="30" y="0" width="40" height="10" fill="#00f"/></svg>
<g stroke="#0f0" stroke-width="4"><line x1="0" y1="40" x2="100" y2="40"/></g></svg>"##;
        let dots = dots(svg);
        assert_eq!((dots.width(), dots.height()), (200, 100));
        assert_eq!(at(&dots, 2, 2), [255; 3]);
        let [red, green, blue] = at(&dots, 40, 40);
        assert!(red == 255 && (126..=129).contains(&green) && green == blue, "{red} {green} {blue}");
        assert_eq!((at(&dots, 90, 10), at(&dots, 70, 10), at(&dots, 110, 10)), ([0, 0, 255], [255; 3], [255; 3]));
        assert_eq!(at(&dots, 100, 80), [0, 255, 0]);
    }

    /// 86 mm at 300 dots to an inch, and said so: 11811 to a metre. A bar of letters as long as the font is wide.
    #[test]
    fn print_has_its_density() {
        let svg = r##"<svg xmlns="http://www.w3.org/2000/svg" width="86mm" height="43mm" viewBox="0 0 200 100">
<text x="100" y="50" font-size="20" text-anchor="middle">MMM</text></svg>"##;
        let bytes = png(svg).unwrap();
        let place = bytes.windows(4).position(|name| name == b"pHYs").unwrap();
        assert_eq!(bytes[place + 4..place + 13], [0, 0, 0x2e, 0x23, 0, 0, 0x2e, 0x23, 1]);
        let dots = Pixmap::decode_png(&bytes).unwrap();
        assert_eq!(dots.width(), 1016);
        let scale = f64::from(dots.width()) / 200.0;
        let dark: Vec<u32> =
            (0..dots.width()).filter(|x| (0..dots.height()).any(|y| at(&dots, *x, y)[0] < 100)).collect();
        // Three M of 0.833 of 20 px about the middle; each has some room at its sides.
        let (from, to) = (f64::from(dark[0]) / scale, f64::from(dark[dark.len() - 1]) / scale);
        assert!((75.0..78.0).contains(&from) && (122.0..125.0).contains(&to), "{from} {to}");
    }

    #[test]
    fn what_is_too_large_is_refused() {
        let svg = r##"<svg xmlns="http://www.w3.org/2000/svg" width="30000" height="10" viewBox="0 0 30000 10"/>"##;
        assert!(matches!(png(svg), Err(PaperError::Large(60_000, 20))));
    }
}
