//! The piece row by row: as a table, and on paper to tick.

use std::fmt::Write as _;

use super::drawing::{Anchor, Drawing, Pen};
use super::map::{COUNTED, legend};
use super::pdf::{Page, document};
use super::piece::Piece;

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

/// Paper that A4 and Letter printers both print whole (mm).
const SHEET: [f64; 2] = [210.0, 279.4];
const EDGE: f64 = 12.0;
/// Size of the letters of rows (mm).
const SIZE: f64 = 3.4;
/// Distance of lines (mm).
const PITCH: f64 = 5.2;

/// The list on paper: for each row a box to tick, its letters from the left in groups of five, and how many of each.
pub fn placement_pdf(piece: &Piece) -> Vec<u8> {
    let longest = piece.used().map(|(_, mark)| mark.letter.len()).max().unwrap_or(1);
    let letter = SIZE * 0.6;
    // Groups of five, a space behind each; as many as stand in a line.
    let group = COUNTED as usize * longest + 1;
    let room = SHEET[0] - 2.0 * EDGE - 17.0;
    let groups = ((room / letter) as usize / group).max(1);

    let mut pages: Vec<Drawing> = Vec::new();
    let mut y = f64::INFINITY;
    for row in 1..=piece.rows {
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
            pages.push(Drawing::default());
            y = head(piece, pages.len(), pages.last_mut().expect("one was pushed"));
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
    document(&format!("{}: placement list", piece.name), &piece.marks, piece.diameter, &pages)
}

/// The head of a page; where its rows begin.
fn head(piece: &Piece, number: usize, page: &mut Drawing) -> f64 {
    page.bold([EDGE, EDGE + 3.0], 4.6, Anchor::Start, format!("{}: placement list", piece.name));
    page.text([SHEET[0] - EDGE, EDGE + 3.0], 3.0, Anchor::End, format!("page {number}"));
    page.text(
        [EDGE, EDGE + 8.0],
        2.8,
        Anchor::Start,
        "Row 1 is struck. Letters from the left of each row, in groups of five as numbered on the map. Tick each row when it lies.",
    );
    EDGE + 16.0 + legend(page, piece, [EDGE, EDGE + 10.0], SHEET[0] - 2.0 * EDGE)
}
