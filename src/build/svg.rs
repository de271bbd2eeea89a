//! Drawings as SVG whose unit is the millimetre.

use std::fmt::Write as _;

use super::drawing::{Anchor, Colour, Drawing, Face, Pen, Point, Shape, symbol};
use super::piece::Mark;
use crate::report::escape;

/// A length with a tenth of a micrometre, without trailing zeros.
fn mm(x: f64) -> String {
    let text = format!("{:.4}", x);
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

/// The part of a drawing from a corner on (mm) as a file.
pub fn svg(title: &str, marks: &[Mark], diameter: f64, drawing: &Drawing, corner: Point, size: Point) -> String {
    let [left, top, width, height] = [corner[0], corner[1], size[0], size[1]].map(mm);
    let mut text = format!(
        r##"<svg xmlns="http://www.w3.org/2000/svg" width="{width}mm" height="{height}mm" viewBox="{left} {top} {width} {height}" font-family="Helvetica, Arial, 'Liberation Sans', sans-serif">
<title>{}</title>
<rect x="{left}" y="{top}" width="{width}" height="{height}" fill="#fff"/>
"##,
        escape(title)
    );
    let symbols: Vec<Drawing> = marks.iter().map(|mark| symbol(mark, diameter)).collect();
    for shape in &drawing.shapes {
        paint(&mut text, shape, [0.0, 0.0], &symbols);
    }
    text.push_str("</svg>\n");
    text
}

fn hex([r, g, b]: Colour) -> String {
    format!("#{r:02x}{g:02x}{b:02x}")
}

fn style(fill: Option<Colour>, pen: Option<&Pen>) -> String {
    let mut text = format!(r#"fill="{}""#, fill.map_or_else(|| "none".to_owned(), hex));
    if let Some(Pen { width, colour, dash }) = pen {
        let _ = write!(text, r#" stroke="{}" stroke-width="{}""#, hex(*colour), mm(*width));
        if let Some([dash, gap]) = dash {
            let _ = write!(text, r#" stroke-dasharray="{} {}""#, mm(*dash), mm(*gap));
        }
    }
    text
}

fn paint(text: &mut String, shape: &Shape, [dx, dy]: Point, symbols: &[Drawing]) {
    let place = |[x, y]: Point| [mm(x + dx), mm(y + dy)];
    match shape {
        Shape::Disc { centre, radius, fill, pen } => {
            let [x, y] = place(*centre);
            let style = style(*fill, pen.as_ref());
            let _ = writeln!(text, r#"<circle cx="{x}" cy="{y}" r="{}" {style}/>"#, mm(*radius));
        }
        Shape::Lines { segments, pen } => {
            text.push_str("<path d=\"");
            for [from, to] in segments {
                let ([x1, y1], [x2, y2]) = (place(*from), place(*to));
                let _ = write!(text, "M{x1} {y1}L{x2} {y2}");
            }
            let _ = writeln!(text, r#"" {}/>"#, style(None, Some(pen)));
        }
        Shape::Box { corner, size, fill, pen } => {
            let ([x, y], [width, height]) = (place(*corner), size.map(mm));
            let style = style(*fill, pen.as_ref());
            let _ = writeln!(text, r#"<rect x="{x}" y="{y}" width="{width}" height="{height}" {style}/>"#);
        }
        Shape::Text { at, size, anchor, face, text: words } => {
            let [x, y] = place(*at);
            let anchor = match anchor {
                Anchor::Start => "",
                Anchor::Middle => r#" text-anchor="middle""#,
                Anchor::End => r#" text-anchor="end""#,
            };
            let face = match face {
                Face::Plain => "",
                Face::Bold => r#" font-weight="bold""#,
                Face::Fixed => r#" font-family="Courier, monospace""#,
            };
            let _ = writeln!(
                text,
                r#"<text x="{x}" y="{y}" font-size="{}"{anchor}{face}>{}</text>"#,
                mm(*size),
                escape(words)
            );
        }
        Shape::Sphere { at, material } => {
            let class = format!("sphere material-{material}");
            let _ = writeln!(text, r#"<g class="{class}">"#);
            for shape in symbols.get(*material).iter().flat_map(|symbol| &symbol.shapes) {
                paint(text, shape, *at, symbols);
            }
            text.push_str("</g>\n");
        }
    }
}
