//! The piece row by row: as a table, and on paper to tick.

use std::fmt::Write as _;

use super::drawing::{Anchor, Drawing, Pen};
use super::map::{COUNTED, legend};
use super::pdf::{Page, document};
use super::piece::{Kind, Mark, Piece, used};

/// Every sphere, row by row from the left: where it goes and what it is.
pub fn placement_csv(piece: &Piece) -> String {
    let mut text = "row,column,x_mm,z_mm,letter,material,done\n".to_owned();
    for sphere in &piece.spheres {
        let [x, z] = piece.place(sphere);
        let mark = piece.mark(sphere);
        let _ = writeln!(text, "{},{},{x:.4},{z:.4},{},{},", sphere.row, sphere.column, mark.letter, mark.material);
    }
    text
}

/// The same of the layers of a crystal in space, in the order in which they are laid.
pub fn layers_csv(layers: &[Piece]) -> String {
    let mut text = "layer,row,column,x_mm,y_mm,letter,material,done\n".to_owned();
    for piece in layers {
        let Kind::Layer { number, .. } = piece.kind else { continue };
        for sphere in &piece.spheres {
            let ([x, down], mark) = (piece.place(sphere), piece.mark(sphere));
            // No minus before a zero.
            let y = 0.0 - down;
            let (row, column) = (sphere.row, sphere.column);
            let _ = writeln!(text, "{number},{row},{column},{x:.4},{y:.4},{},{},", mark.letter, mark.material);
        }
    }
    text
}

/// Paper that A4 and Letter printers both print whole (mm).
const SHEET: [f64; 2] = [210.0, 279.4];
const EDGE: f64 = 12.0;
/// Size of the letters of rows (mm).
const SIZE: f64 = 3.4;
/// Distance of lines (mm).
const PITCH: f64 = 5.2;

/// The list on paper: for each row a box to tick, its letters from the left in groups of five, and how many of each.
pub fn placement_pdf(piece: &Piece) -> Vec<u8> {
    placements_pdf(&piece.name, std::slice::from_ref(piece), &piece.marks)
}

/// The same of several pieces, one after the other; `marks` are those of all together.
pub fn placements_pdf(name: &str, pieces: &[Piece], marks: &[Mark]) -> Vec<u8> {
    let Some(first) = pieces.first() else { return Vec::new() };
    let longest = used(marks).map(|(_, mark)| mark.letter.len()).max().unwrap_or(1);
    let letter = SIZE * 0.6;
    // Groups of five, a space behind each; as many as stand in a line.
    let group = COUNTED as usize * longest + 1;
    let room = SHEET[0] - 2.0 * EDGE - 17.0;
    let groups = ((room / letter) as usize / group).max(1);

    let mut pages: Vec<Drawing> = Vec::new();
    let mut y = f64::INFINITY;
    let head_of_page = |pages: &mut Vec<Drawing>| {
        let mut page = Drawing::default();
        let y = head(name, first, marks, pages.len() + 1, &mut page);
        pages.push(page);
        y
    };
    for (piece, row) in pieces.iter().flat_map(|piece| (1..=piece.rows).map(move |row| (piece, row))) {
        if let Kind::Layer { number, of, .. } = piece.kind
            && row == 1
        {
            // Its first row stands on the same page.
            if y + 4.0 * PITCH > SHEET[1] - EDGE {
                y = head_of_page(&mut pages);
            }
            let page = pages.last_mut().expect("a page was begun");
            page.bold([EDGE, y + 2.0], 3.8, Anchor::Start, format!("Layer {number} of {of}"));
            y += 2.0 + PITCH;
        }
        let spheres: Vec<_> = piece.spheres.iter().filter(|sphere| sphere.row == row).collect();
        let letters: Vec<&str> = spheres.iter().map(|sphere| &piece.mark(sphere).letter[..]).collect();
        let lines: Vec<String> = letters
            .chunks(COUNTED as usize * groups)
            .map(|line| {
                let words = line
                    .chunks(COUNTED as usize)
                    .map(|five| five.iter().map(|letter| format!("{letter:<longest$}")).collect::<String>());
                words.collect::<Vec<_>>().join(" ")
            })
            .collect();
        let height = PITCH * (lines.len() as f64 + 0.75) + 1.2;
        if y + height > SHEET[1] - EDGE {
            y = head_of_page(&mut pages);
        }
        let page = pages.last_mut().expect("the first row begins a page");
        page.rectangle([EDGE, y - 3.2], [3.6, 3.6], None, Some(Pen::black(0.25)));
        page.bold([EDGE + 6.0, y], 3.4, Anchor::Start, row.to_string());
        for (k, line) in lines.iter().enumerate() {
            page.fixed([EDGE + 15.0, y + PITCH * k as f64], SIZE, line.clone());
        }
        let counts: Vec<String> = piece
            .used()
            .filter_map(|(k, mark)| {
                let count = spheres.iter().filter(|sphere| usize::from(sphere.material) == k).count();
                (count > 0).then(|| format!("{count} {}", mark.letter))
            })
            .collect();
        let below = y + PITCH * lines.len() as f64 - 1.2;
        page.text(
            [EDGE + 15.0, below],
            2.6,
            Anchor::Start,
            format!("{} spheres: {}", spheres.len(), counts.join(", ")),
        );
        y += height;
        page.line([EDGE, y - 4.2], [SHEET[0] - EDGE, y - 4.2], Pen::black(0.05));
    }
    let pages: Vec<Page> = pages.into_iter().map(|drawing| Page { size: SHEET, drawing, view: None }).collect();
    document(&format!("{name}: placement list"), marks, first.diameter, &pages)
}

/// The head of a page; where its rows begin.
fn head(name: &str, first: &Piece, marks: &[Mark], number: usize, page: &mut Drawing) -> f64 {
    page.bold([EDGE, EDGE + 3.0], 4.6, Anchor::Start, format!("{name}: placement list"));
    page.text([SHEET[0] - EDGE, EDGE + 3.0], 3.0, Anchor::End, format!("page {number}"));
    let which = match first.kind {
        Kind::Sheet => "Row 1 is struck.",
        Kind::Layer { .. } => "In the order of laying; layer 1 is struck.",
    };
    page.text(
        [EDGE, EDGE + 8.0],
        2.8,
        Anchor::Start,
        format!("{which} Letters from the left of each row, in groups of five as numbered on the map. Tick each row when it lies."),
    );
    EDGE + 16.0 + legend(page, marks, first.diameter, [EDGE, EDGE + 10.0], SHEET[0] - 2.0 * EDGE)
}
