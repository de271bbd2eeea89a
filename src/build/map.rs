//! The assembly map at 1:1: every sphere where it lies, with its letter, colour and hatching.

use super::drawing::{Anchor, Drawing, GREY, Pen, Point, RULER, WHITE};
use super::piece::{Kind, Mark, Piece, used};
use super::svg::svg;

/// Room for the numbers of rows on either side, and for words above and below (mm).
const MARGIN: Point = [11.0, 12.0];

/// Columns between two that carry their number: rows are counted off in fives.
pub const COUNTED: u32 = 5;

/// The map, its origin at the crystal's axis on row 1, and the box that holds it: left, top, right, bottom (mm).
pub fn map(piece: &Piece) -> (Drawing, [f64; 4]) {
    let [left, top, right, bottom] = piece.extent();
    let diameter = piece.diameter;
    let mut drawing = Drawing::default();
    if piece.kind == Kind::Sheet {
        // The inner faces of side walls and end wall.
        let wall = Pen::black(0.35);
        let front = 0.0;
        drawing.lines(
            vec![[[left, front], [left, bottom]], [[left, bottom], [right, bottom]], [[right, bottom], [right, front]]],
            wall,
        );
    }
    for sphere in &piece.spheres {
        drawing.sphere(piece.place(sphere), usize::from(sphere.material));
    }
    // Every fifth sphere of a row carries the number of its column, below its letter.
    for sphere in piece.spheres.iter().filter(|sphere| sphere.column.is_multiple_of(COUNTED)) {
        let [x, y] = piece.place(sphere);
        let size = 0.21 * diameter;
        let text = sphere.column.to_string();
        let wide = 0.6 * size * text.len() as f64 + 0.1 * size;
        drawing.rectangle([x - 0.5 * wide, y + 0.245 * diameter], [wide, 0.2 * diameter], Some(WHITE), None);
        drawing.text([x, y + 0.415 * diameter], size, Anchor::Middle, text);
    }
    if let Kind::Layer { below, .. } = &piece.kind {
        // Seen through the hollows, where they lie.
        below.iter().for_each(|&[x, y]| drawing.disc([1e3 * x, 1e3 * y], 0.05 * diameter, Some(GREY), None));
    }
    let axis = Pen::black(0.15).coloured(GREY).dashed([4.0, 1.5]);
    drawing.line([0.0, top - 5.0], [0.0, top], axis);
    drawing.line([0.0, bottom], [0.0, bottom + 5.0], axis);
    let size = (0.45 * diameter).min(2.6);
    let mut seen = 0;
    for sphere in &piece.spheres {
        if sphere.row == seen {
            continue;
        }
        seen = sphere.row;
        let y = 1e3 * sphere.z + 0.36 * size;
        drawing.text([left - 2.0, y], size, Anchor::End, seen.to_string());
        drawing.text([right + 2.0, y], size, Anchor::Start, seen.to_string());
    }
    let (head, foot) = match &piece.kind {
        Kind::Sheet => (
            "IMPACT on row 1, from above; crystal's axis at the dashed strokes".to_owned(),
            "thick lines: inner faces of the frame; small numbers: every fifth column, counted from the left"
                .to_owned(),
        ),
        Kind::Layer { number, of, below } => {
            // The lens's axis.
            drawing.line([left - 5.0, 0.0], [left, 0.0], axis);
            drawing.line([right, 0.0], [right + 5.0, 0.0], axis);
            let dots = match below.is_empty() {
                true => "; it is laid first",
                false => "; grey dots: centres of the layer that it is laid on",
            };
            (format!("LAYER {number} of {of}, from the struck side"), format!("axis at the dashed strokes{dots}"))
        }
    };
    // Letters are some 0.56 of their size wide; small pieces are narrower than what is said of them.
    let reach = (0.56 * 2.8 * head.len() as f64).max(0.56 * 2.4 * foot.len() as f64);
    drawing.text([3.0, top - 2.5], 2.8, Anchor::Start, head);
    drawing.text([3.0, bottom + 4.6], 2.4, Anchor::Start, foot);
    let right = (right + MARGIN[0]).max(5.0 + reach);
    (drawing, [left - MARGIN[0], top - MARGIN[1], right, bottom + MARGIN[1]])
}

/// What each letter means, from a corner on, in lines of this width (mm); gives the height that it takes.
pub fn legend(drawing: &mut Drawing, marks: &[Mark], diameter: f64, [x, y]: Point, width: f64) -> f64 {
    let (pitch, size) = ((diameter + 2.0).max(6.0), 3.0);
    let (mut at, mut line) = (0.0, 0.0);
    for (k, mark) in used(marks) {
        let words = format!("{} = {}, {}", mark.letter, mark.material, mark.count);
        let wide = diameter + 2.0 + 0.56 * size * words.len() as f64 + 6.0;
        if at > 0.0 && at + wide > width {
            (at, line) = (0.0, line + pitch);
        }
        let middle = y + line + 0.5 * pitch;
        drawing.sphere([x + at + 0.5 * diameter, middle], k);
        drawing.text([x + at + diameter + 2.0, middle + 0.36 * size], size, Anchor::Start, words);
        at += wide;
    }
    line + pitch
}

/// The map as one SVG in millimetres, with what the letters mean and a ruler below.
pub fn map_svg(piece: &Piece) -> String {
    let (mut drawing, [left, top, right, bottom]) = map(piece);
    let width = (right - left).max(RULER + 10.0);
    let corner = [left + 5.0, bottom + 2.0];
    let below = bottom + 2.0 + legend(&mut drawing, &piece.marks, piece.diameter, corner, width - 10.0);
    drawing.ruler([corner[0], below + 6.0], false);
    drawing.text(
        [corner[0], below + 10.0],
        2.8,
        Anchor::Start,
        format!("{}: map at 1:1, this ruler is 100 mm long", piece.name),
    );
    let title = format!("{}: assembly map, 1:1", piece.name);
    svg(&title, &piece.marks, piece.diameter, &drawing, [left, top], [width, below + 13.0 - top])
}
