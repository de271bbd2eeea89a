//! A picture as SVG text: elements in the order in which they are painted, text escaped, numbers kept short.
//!
//! Attributes are passed as they stand in SVG (`stroke="#333" stroke-width="1.5"`); they come from this crate only.
//! Whatever a user may have named goes through [`Svg::text`], which escapes it.

use std::fmt::{self, Write as _};

/// A coordinate in pixels: two decimals at most, no trailing zeros, and never anything but a finite number.
#[derive(Clone, Copy, Debug)]
pub struct Px(pub f64);

impl fmt::Display for Px {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut text = String::with_capacity(12);
        self.onto(&mut text);
        f.write_str(&text)
    }
}

impl Px {
    /// Appends its digits. Pictures hold tens of thousands of these: the machinery of formats would take most of their time, and the
    /// shortest digits of a float more still.
    fn onto(self, text: &mut String) {
        let hundredths = (self.0 * 100.0).round();
        if !hundredths.is_finite() {
            text.push('0');
            return;
        }
        if hundredths.abs() >= 1e15 {
            text.push_str(&(hundredths / 100.0).to_string());
            return;
        }
        let left = hundredths.abs() as u64;
        let (mut whole, part) = (left / 100, (left % 100) as u8);
        // From the last digit on; fifteen digits and what goes with them.
        let mut digits = [0; 20];
        let mut first = digits.len();
        let mut put = |digit: u8| {
            first -= 1;
            digits[first] = digit;
        };
        if part != 0 {
            if part % 10 != 0 {
                put(b'0' + part % 10);
            }
            put(b'0' + part / 10);
            put(b'.');
        }
        loop {
            put(b'0' + (whole % 10) as u8);
            whole /= 10;
            if whole == 0 {
                break;
            }
        }
        if hundredths < 0.0 {
            put(b'-');
        }
        text.extend(digits[first..].iter().map(|&digit| char::from(digit)));
    }
}

/// Appends a point: its coordinates behind the letter of a path.
fn onto(text: &mut String, letter: char, [x, y]: [f64; 2]) {
    text.push(letter);
    Px(x).onto(text);
    text.push(' ');
    Px(y).onto(text);
}

/// Text with the characters that mean something to XML and HTML replaced, and those that XML forbids left out.
pub fn escape(text: &str) -> String {
    let mut escaped = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => escaped.push_str("&amp;"),
            '<' => escaped.push_str("&lt;"),
            '>' => escaped.push_str("&gt;"),
            '"' => escaped.push_str("&quot;"),
            '\'' => escaped.push_str("&#39;"),
            '\t' | '\n' | '\r' => escaped.push(' '),
            c if c.is_control() => {}
            c => escaped.push(c),
        }
    }
    escaped
}

/// Symbols whose last letter is an index; names of a user's are never among them.
const INDEXED: [&str; 4] = ["F_p", "τ_c", "δ_p", "F_y"];

/// Escaped text as a picture shows it: indices of known symbols below the line, micro by its own sign.
fn typeset(text: &str, size: f64) -> String {
    let mut set = String::with_capacity(text.len());
    let mut rest = text;
    let mut before = ' ';
    while let Some(c) = rest.chars().next() {
        let is_open = !before.is_alphanumeric() && before != '_';
        let ends = |word: &str| !rest[word.len()..].starts_with(|c: char| c.is_alphanumeric() || c == '_');
        let symbol = INDEXED.into_iter().find(|symbol| is_open && rest.starts_with(symbol) && ends(symbol));
        let micro = ["us", "um", "uJ"].into_iter().find(|unit| {
            let behind_number = set.strip_suffix(' ').is_some_and(|set| set.ends_with(|c: char| c.is_ascii_digit()));
            (before == '(' || behind_number) && rest.starts_with(unit) && ends(unit)
        });
        if let Some((letter, index)) = symbol.and_then(|symbol| symbol.split_once('_')) {
            let (small, down) = (Px(0.72 * size), Px(0.22 * size));
            // What follows stands on the line again, be it a space of no width.
            let _ = write!(
                set,
                "{letter}<tspan font-size=\"{small}\" dy=\"{down}\">{index}</tspan><tspan dy=\"-{down}\">\u{200b}</tspan>"
            );
            before = 'x';
            rest = &rest[letter.len() + 1 + index.len()..];
        } else if let Some(unit) = micro {
            set.push('µ');
            set.push_str(&unit[1..]);
            before = 'x';
            rest = &rest[unit.len()..];
        } else {
            set.push(c);
            before = c;
            rest = &rest[c.len_utf8()..];
        }
    }
    set
}

/// Where a text is anchored.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Anchor {
    /// The point is the left end.
    Start,
    /// The point is the middle.
    Middle,
    /// The point is the right end.
    End,
}

/// A picture under construction.
#[derive(Clone, Debug)]
pub struct Svg {
    width: f64,
    height: f64,
    title: String,
    body: String,
}

impl Svg {
    /// An empty white picture; the title is what screen readers and tooltips say.
    pub fn new(width: f64, height: f64, title: &str) -> Self {
        Self { width, height, title: escape(title), body: String::new() }
    }

    /// A straight line.
    pub fn line(&mut self, from: [f64; 2], to: [f64; 2], attributes: &str) {
        let ([x1, y1], [x2, y2]) = (from.map(Px), to.map(Px));
        let _ = writeln!(self.body, r#"<path d="M{x1} {y1}L{x2} {y2}" {attributes}/>"#);
    }

    /// An open line through the points.
    pub fn polyline(&mut self, points: &[[f64; 2]], attributes: &str) {
        if points.len() > 1 {
            self.path(&through(points), &format!(r#"fill="none" {attributes}"#));
        }
    }

    /// A closed area.
    pub fn polygon(&mut self, points: &[[f64; 2]], attributes: &str) {
        if points.len() > 2 {
            self.path(&(through(points) + "z"), attributes);
        }
    }

    /// A path in SVG's own notation; empty ones are left out.
    pub fn path(&mut self, d: &str, attributes: &str) {
        if !d.is_empty() {
            let _ = writeln!(self.body, r#"<path d="{d}" {attributes}/>"#);
        }
    }

    /// A rectangle by its upper left corner and its size.
    pub fn rectangle(&mut self, corner: [f64; 2], size: [f64; 2], attributes: &str) {
        let ([x, y], [width, height]) = (corner.map(Px), size.map(|s| Px(s.max(0.0))));
        let _ = writeln!(self.body, r#"<rect x="{x}" y="{y}" width="{width}" height="{height}" {attributes}/>"#);
    }

    /// A circle.
    pub fn circle(&mut self, [x, y]: [f64; 2], radius: f64, attributes: &str) {
        let (x, y, radius) = (Px(x), Px(y), Px(radius));
        let _ = writeln!(self.body, r#"<circle cx="{x}" cy="{y}" r="{radius}" {attributes}/>"#);
    }

    /// One letter about many points, as large as `size`.
    pub fn letters(&mut self, letter: char, places: &[[f64; 2]], size: f64, fill: &str) {
        let (height, escaped) = (Px(size), escape(&letter.to_string()));
        let _ =
            writeln!(self.body, r#"<g fill="{fill}" font-size="{height}" font-weight="bold" text-anchor="middle">"#);
        for &[x, y] in places {
            // Capitals are some 0.72 of their size high.
            let (x, y) = (Px(x), Px(y + 0.36 * size));
            let _ = write!(self.body, r#"<text x="{x}" y="{y}">{escaped}</text>"#);
        }
        self.body.push_str("\n</g>\n");
    }

    /// A line of text of the given size, escaped; the point lies on its baseline.
    pub fn text(&mut self, [x, y]: [f64; 2], size: f64, anchor: Anchor, attributes: &str, text: &str) {
        let text = typeset(&escape(text), size);
        let (x, y, size) = (Px(x), Px(y), Px(size));
        let anchor = match anchor {
            Anchor::Start => "",
            Anchor::Middle => r#" text-anchor="middle""#,
            Anchor::End => r#" text-anchor="end""#,
        };
        let _ = writeln!(self.body, r#"<text x="{x}" y="{y}" font-size="{size}"{anchor} {attributes}>{text}</text>"#);
    }

    /// A text that reads upwards, centred on the point.
    pub fn text_upwards(&mut self, [x, y]: [f64; 2], size: f64, attributes: &str, text: &str) {
        let turn = format!(r#"transform="rotate(-90 {} {})" {attributes}"#, Px(x), Px(y));
        self.text([x, y], size, Anchor::Middle, &turn, text);
    }

    /// What `paint` adds, with attributes for all of it.
    pub fn group(&mut self, attributes: &str, paint: impl FnOnce(&mut Self)) {
        let _ = writeln!(self.body, "<g {attributes}>");
        paint(self);
        self.body.push_str("</g>\n");
    }

    /// What `paint` adds, cut off outside a rectangle. An inner `svg` clips without an id, which an HTML page that holds
    /// several pictures would otherwise have to keep unique.
    pub fn clipped(&mut self, corner: [f64; 2], size: [f64; 2], paint: impl FnOnce(&mut Self)) {
        let ([x, y], [width, height]) = (corner.map(Px), size.map(Px));
        let _ = writeln!(
            self.body,
            r#"<svg x="{x}" y="{y}" width="{width}" height="{height}" viewBox="{x} {y} {width} {height}">"#
        );
        paint(self);
        self.body.push_str("</svg>\n");
    }

    /// The picture as the text of an SVG file.
    pub fn finish(self) -> String {
        let (width, height) = (Px(self.width.ceil()), Px(self.height.ceil()));
        format!(
            r##"<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" viewBox="0 0 {width} {height}" role="img" font-family="Helvetica, Arial, 'Liberation Sans', sans-serif" fill="#222">
<title>{}</title>
<rect width="{width}" height="{height}" fill="#fff"/>
{}</svg>
"##,
            self.title, self.body
        )
    }
}

/// Path data through the points.
fn through(points: &[[f64; 2]]) -> String {
    let mut d = String::with_capacity(14 * points.len());
    for (k, point) in points.iter().enumerate() {
        onto(&mut d, if k == 0 { 'M' } else { 'L' }, *point);
    }
    d
}

/// Path data of many small shapes, gathered so that a thousand cells of one colour are one element, in as few letters as can be: they are most of
/// a page's weight.
#[derive(Clone, Debug, Default)]
pub struct Shapes {
    d: String,
    /// Where the pen stands (hundredths of a pixel).
    pen: [i64; 2],
    /// The last letter; it holds until the next.
    letter: Option<char>,
}

/// In hundredths of a pixel.
fn hundredths(point: [f64; 2]) -> [i64; 2] {
    point.map(|c| (100.0 * c).round() as i64)
}

impl Shapes {
    /// A closed shape: where it starts, then steps from corner to corner.
    pub fn closed(&mut self, start: [f64; 2], steps: &[[f64; 2]]) {
        self.begin(hundredths(start), false);
        let first = self.pen;
        for &step in steps {
            self.step(hundredths(step));
        }
        self.d.push('z');
        (self.pen, self.letter) = (first, Some('z'));
    }

    /// A straight segment, to a tenth of a pixel.
    pub fn segment(&mut self, from: [f64; 2], to: [f64; 2]) {
        let [from, to] = [from, to].map(|end| end.map(|c| (10.0 * c).round() as i64 * 10));
        self.begin(from, true);
        self.step([to[0] - from[0], to[1] - from[1]]);
    }

    /// Moves the pen to a place: by how much, where that takes fewer letters. A line that `joins` goes on where the last one ended.
    fn begin(&mut self, place: [i64; 2], joins: bool) {
        let by = [place[0] - self.pen[0], place[1] - self.pen[1]];
        if joins && by == [0, 0] && self.letter.is_some_and(|letter| letter != 'z') {
            return;
        }
        let (mut moved, mut placed) = (String::new(), String::new());
        numbers(&mut moved, by);
        numbers(&mut placed, place);
        let is_shorter = self.letter.is_some() && moved.len() < placed.len();
        let (letter, text) = if is_shorter { ('m', moved) } else { ('M', placed) };
        self.d.push(letter);
        self.d.push_str(&text);
        (self.pen, self.letter) = (place, Some(letter));
    }

    /// A line by so much, with a letter of its own along an axis.
    fn step(&mut self, by: [i64; 2]) {
        let letter = match by {
            [0, _] => 'v',
            [_, 0] => 'h',
            _ => 'l',
        };
        let mut text = String::new();
        match letter {
            'v' => Px(by[1] as f64 / 100.0).onto(&mut text),
            'h' => Px(by[0] as f64 / 100.0).onto(&mut text),
            _ => numbers(&mut text, by),
        }
        if self.letter != Some(letter) {
            self.d.push(letter);
        } else if !text.starts_with('-') {
            self.d.push(' ');
        }
        self.d.push_str(&text);
        self.pen = [self.pen[0] + by[0], self.pen[1] + by[1]];
        self.letter = Some(letter);
    }

    /// The path data.
    pub fn data(&self) -> &str {
        &self.d
    }
}

/// Appends two numbers; a sign parts them as a blank does.
fn numbers(text: &mut String, [x, y]: [i64; 2]) {
    Px(x as f64 / 100.0).onto(text);
    if y >= 0 {
        text.push(' ');
    }
    Px(y as f64 / 100.0).onto(text);
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_are_short_and_finite() {
        let shown = |x: f64| Px(x).to_string();
        assert_eq!(shown(1.0 / 3.0), "0.33");
        assert_eq!(shown(-0.001), "0");
        assert_eq!(shown(12.0), "12");
        assert_eq!(
            [-12.5, -0.05, 3.104_9, 7.996, 1e17].map(shown),
            ["-12.5", "-0.05", "3.1", "8", "100000000000000000"]
        );
        assert_eq!(shown(f64::NAN), "0");
    }

    #[test]
    fn shapes_are_where_they_were_put() {
        let mut shapes = Shapes::default();
        let square = [[2.0, 0.0], [0.0, 2.0], [-2.0, 0.0]];
        shapes.closed([100.0, 50.25], &square);
        shapes.closed([102.5, 50.25], &square);
        shapes.segment([3.0, 4.04], [5.0, 3.0]);
        shapes.segment([5.0, 3.0], [5.0, 7.0]);
        assert_eq!(shapes.data(), "M100 50.25h2v2h-2zm2.5 0h2v2h-2zM3 4l2-1v4");
    }

    #[test]
    fn symbols_have_indices_and_names_keep_theirs() {
        assert_eq!(typeset("in 20 us, time (us), my_F_p and status", 10.0), "in 20 µs, time (µs), my_F_p and status");
        let set = typeset("F_p (N)", 10.0);
        assert!(set.starts_with("F<tspan font-size=\"7.2\" dy=\"2.2\">p</tspan>") && set.ends_with(" (N)"), "{set}");
    }

    #[test]
    fn names_cannot_open_elements() {
        let mut svg = Svg::new(10.0, 10.0, "a & b");
        svg.text([0.0, 0.0], 10.0, Anchor::Start, "", "<b>\u{0}\"");
        let text = svg.finish();
        assert!(text.contains("&lt;b&gt;&quot;</text>") && text.contains("a &amp; b"));
    }
}
