//! The map cut into sheets of paper, at 1:1, with an overview to begin with.

use super::drawing::{Anchor, Drawing, GREY, Pen, Point, RULER};
use super::map::{legend, map};
use super::pdf::{Page, View, document};
use super::piece::{Kind, Mark, Piece};

/// A size of paper.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Paper {
    /// 210 mm by 297 mm
    A4,
    /// 297 mm by 420 mm
    A3,
    /// 8.5 in by 11 in
    Letter,
}

/// What printers leave white on every side, and a little more (mm).
const EDGE: f64 = 10.0;
/// Room for the ruler that stands on the left (mm).
const LEFT: f64 = 9.0;
/// Room for the words and the ruler below the window (mm).
const BELOW: f64 = 24.0;
/// How much two neighbouring sheets show alike (mm).
const OVERLAP: f64 = 14.0;

impl Paper {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::A4, Self::A3, Self::Letter];

    /// As in the names of files.
    pub fn name(self) -> &'static str {
        match self {
            Self::A4 => "a4",
            Self::A3 => "a3",
            Self::Letter => "letter",
        }
    }

    /// Width and height, upright (mm).
    pub fn size(self) -> Point {
        match self {
            Self::A4 => [210.0, 297.0],
            Self::A3 => [297.0, 420.0],
            Self::Letter => [215.9, 279.4],
        }
    }
}

/// How a map is cut.
struct Cut {
    /// The sheet (mm).
    sheet: Point,
    /// The window on it (mm).
    window: Point,
    /// Sheets across and down.
    count: [usize; 2],
    /// Distance of neighbouring windows on the map (mm).
    step: Point,
}

impl Cut {
    fn new(sheet: Point, map: Point) -> Self {
        let window = [sheet[0] - 2.0 * EDGE - LEFT, sheet[1] - 2.0 * EDGE - BELOW];
        let count = [0, 1].map(|k| ((map[k] - OVERLAP) / (window[k] - OVERLAP) - 1e-9).ceil().max(1.0) as usize);
        let step = [0, 1].map(|k| match count[k] {
            1 => 0.0,
            // Overlaps are alike, and as wide as the sheets allow.
            count => (map[k] - window[k]) / (count - 1) as f64,
        });
        Self { sheet, window, count, step }
    }

    fn sheets(&self) -> usize {
        self.count[0] * self.count[1]
    }

    /// Where two sheets are joined, in the middle of what both show: distances from the map's corner (mm).
    fn seams(&self, k: usize) -> Vec<f64> {
        let overlap = self.window[k] - self.step[k];
        (1..self.count[k]).map(|n| n as f64 * self.step[k] + 0.5 * overlap).collect()
    }
}

/// The map on sheets of a size of paper, upright or across, whichever takes fewer.
pub fn map_pdf(piece: &Piece, paper: Paper) -> Vec<u8> {
    maps_pdf(&piece.name, std::slice::from_ref(piece), &piece.marks, paper)
}

/// The maps of several pieces, one after the other; `marks` are those of all together. An overview comes first, and before each that takes
/// several sheets.
pub fn maps_pdf(name: &str, pieces: &[Piece], marks: &[Mark], paper: Paper) -> Vec<u8> {
    let drawn: Vec<Drawn> = pieces.iter().map(|piece| Drawn::new(piece, paper)).collect();
    let mut pages = Vec::new();
    for (k, (piece, drawn)) in pieces.iter().zip(&drawn).enumerate() {
        let Drawn { map, seamed, cut, origin: [left, top], extent } = drawn;
        if k == 0 || cut.sheets() > 1 {
            pages.push(overview(piece, map, [*left, *top], *extent, cut, paper));
        }
        for down in 0..cut.count[1] {
            for over in 0..cut.count[0] {
                let origin = [left + over as f64 * cut.step[0], top + down as f64 * cut.step[1]];
                let size = [0, 1].map(|k| cut.window[k].min(extent[k]));
                let corner = [EDGE + LEFT, EDGE];
                let view = View { drawing: seamed, corner, size, origin, scale: 1.0 };
                pages.push(Page { size: cut.sheet, drawing: around(piece, cut, [over, down], size), view: Some(view) });
            }
        }
    }
    let title = format!("{name}: assembly map, 1:1, {}", paper.name().to_uppercase());
    document(&title, marks, pieces.first().map_or(1.0, |piece| piece.diameter), &pages)
}

/// A map, and how it is cut.
struct Drawn {
    map: Drawing,
    /// With seams.
    seamed: Drawing,
    cut: Cut,
    /// Its upper left corner (mm).
    origin: Point,
    /// Its size (mm).
    extent: Point,
}

impl Drawn {
    fn new(piece: &Piece, paper: Paper) -> Self {
        let (map, [left, top, right, bottom]) = map(piece);
        let extent = [right - left, bottom - top];
        let [width, height] = paper.size();
        let (upright, across) = (Cut::new([width, height], extent), Cut::new([height, width], extent));
        let cut = if across.sheets() < upright.sheets() { across } else { upright };
        let seamed = seamed(&map, &cut, [left, top, right, bottom]);
        Self { map, seamed, cut, origin: [left, top], extent }
    }
}

fn seamed(map: &Drawing, cut: &Cut, [left, top, right, bottom]: [f64; 4]) -> Drawing {
    let extent = [right - left, bottom - top];

    // Seams, and crosses on them that show whether two sheets lie right, are part of the map.
    let mut seamed = map.clone();
    let seam = Pen::black(0.15).coloured(GREY).dashed([1.0, 1.5]);
    for x in cut.seams(0).into_iter().map(|x| left + x) {
        seamed.line([x, top], [x, bottom], seam);
        (0..=cut.count[1] * 3)
            .for_each(|k| cross(&mut seamed, [x, top + 4.0 + (extent[1] - 8.0) * part(k, cut.count[1])]));
    }
    for y in cut.seams(1).into_iter().map(|y| top + y) {
        seamed.line([left, y], [right, y], seam);
        (0..=cut.count[0] * 3)
            .for_each(|k| cross(&mut seamed, [left + 4.0 + (extent[0] - 8.0) * part(k, cut.count[0]), y]));
    }
    seamed
}

fn part(k: usize, count: usize) -> f64 {
    k as f64 / (3 * count) as f64
}

fn cross(drawing: &mut Drawing, [x, y]: Point) {
    let pen = Pen::black(0.12);
    drawing.lines(vec![[[x - 3.0, y], [x + 3.0, y]], [[x, y - 3.0], [x, y + 3.0]]], pen);
    drawing.disc([x, y], 1.5, None, Some(pen));
}

/// The number of a sheet, from 1, in reading order.
fn number(cut: &Cut, [over, down]: [usize; 2]) -> usize {
    down * cut.count[0] + over + 1
}

/// What stands on a sheet around its window.
fn around(piece: &Piece, cut: &Cut, [over, down]: [usize; 2], size: Point) -> Drawing {
    let mut page = Drawing::default();
    let (x, y) = (EDGE + LEFT, EDGE);
    page.rectangle([x, y], size, None, Some(Pen::black(0.1).coloured(GREY)));
    // The neighbours, by what lies beyond each edge of the window.
    let of = |over: usize, down: usize| format!("sheet {}", number(cut, [over, down]));
    let size_of_words = 2.4;
    if over + 1 < cut.count[0] {
        page.text([x + size[0] - 1.0, y + 4.0], size_of_words, Anchor::End, format!("{} >", of(over + 1, down)));
    }
    if over > 0 {
        page.text([x + 1.0, y + 4.0], size_of_words, Anchor::Start, format!("< {}", of(over - 1, down)));
    }
    let foot = EDGE + cut.window[1];
    if down + 1 < cut.count[1] {
        page.text([x + size[0], foot + 3.4], size_of_words, Anchor::End, format!("below: {}", of(over, down + 1)));
    }
    let name = format!("{}: sheet {} of {}", piece.name, number(cut, [over, down]), cut.sheets());
    page.bold([x, foot + 4.2], 3.6, Anchor::Start, name);
    let above = if down > 0 { format!("; above: {}", of(over, down - 1)) } else { String::new() };
    page.text(
        [x, foot + 8.2],
        2.5,
        Anchor::Start,
        format!("Print at 100 % (actual size). Both rulers must measure 100 mm. Cut along a dashed seam, lay cross on cross{above}."),
    );
    page.ruler([x, foot + 15.0], false);
    page.text([x + RULER + 2.0, foot + 15.0], 2.6, Anchor::Start, "100 mm");
    page.ruler([EDGE + LEFT - 2.5, y + 4.0], true);
    let letters: Vec<String> = piece.used().map(|(_, mark)| format!("{} {}", mark.letter, mark.material)).collect();
    for (k, line) in wrapped(&letters, 0.52 * 2.5, cut.window[0]).iter().take(2).enumerate() {
        page.text([x, foot + 19.4 + 3.2 * k as f64], 2.5, Anchor::Start, line.clone());
    }
    plan(&mut page, cut, Some([over, down]), [x + cut.window[0] - 20.0, foot + 9.6], [20.0, 9.0]);
    page
}

/// Words joined by commas in lines of a width (mm), at so much for a letter.
fn wrapped(words: &[String], letter: f64, width: f64) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in words {
        match lines.last_mut() {
            Some(line) if letter * (line.len() + word.len() + 3) as f64 <= width => {
                line.push_str(",  ");
                line.push_str(word);
            }
            _ => lines.push(word.clone()),
        }
    }
    lines
}

/// How the sheets lie, one of them filled, within a room (mm).
fn plan(page: &mut Drawing, cut: &Cut, here: Option<[usize; 2]>, corner: Point, room: Point) {
    let [across, down] = cut.count;
    let cell = (room[0] / across as f64).min(room[1] / down as f64).min(6.0);
    let left = corner[0] + room[0] - cell * across as f64;
    for row in 0..down {
        for column in 0..across {
            let at = [left + cell * column as f64, corner[1] + cell * row as f64];
            let fill = (here == Some([column, row])).then_some([190, 190, 190]);
            page.rectangle(at, [cell, cell], fill, Some(Pen::black(0.12)));
            let size = (0.55 * cell).min(2.6);
            let number = number(cut, [column, row]).to_string();
            page.text([at[0] + 0.5 * cell, at[1] + 0.5 * cell + 0.36 * size], size, Anchor::Middle, number);
        }
    }
}

/// The first page: the whole map made small, what the letters mean, and how to print and join the sheets.
fn overview<'a>(piece: &Piece, map: &'a Drawing, origin: Point, extent: Point, cut: &Cut, paper: Paper) -> Page<'a> {
    let [width, height] = paper.size();
    let mut page = Drawing::default();
    let x = EDGE + LEFT;
    let wide = width - x - EDGE;
    page.bold([x, EDGE + 6.0], 6.0, Anchor::Start, format!("{}: assembly map", piece.name));
    let [left, top, right, bottom] = piece.extent();
    let (across, down) = (right - left, bottom - top);
    let (last, rows) = match &piece.kind {
        Kind::Sheet => {
            ("Row 1 is struck.".to_owned(), "Rows count from the struck side, columns from the left of each row.")
        }
        Kind::Layer { of, .. } => (
            format!("It is laid first, of {of}; layer 1, the last, is struck."),
            "Rows count from above, columns from the left of each row.",
        ),
    };
    let lines = [
        format!(
            "{} spheres of {} mm in {} rows; {across:.2} mm wide and {down:.2} mm deep over the spheres. {last}",
            piece.spheres.len(),
            piece.diameter,
            piece.rows,
        ),
        format!(
            "The map follows at 1:1 on {} sheet{} of {} paper. Print at 100 % (\"actual size\"), without fitting to the page;",
            cut.sheets(),
            if cut.sheets() == 1 { "" } else { "s" },
            paper.name().to_uppercase()
        ),
        "then measure both rulers of every sheet: they must be 100 mm long. Every material has a letter, a colour and a".to_owned(),
        format!("hatching, each of which is enough. {rows}"),
    ];
    for (k, line) in lines.into_iter().enumerate() {
        page.text([x, EDGE + 13.0 + 4.6 * k as f64], 3.1, Anchor::Start, line);
    }
    let mut y = EDGE + 34.0;
    y += legend(&mut page, &piece.marks, piece.diameter, [x, y], wide) + 3.0;
    if cut.sheets() > 1 {
        page.text([x, y + 4.0], 3.1, Anchor::Start, "How the sheets lie:");
        plan(&mut page, cut, None, [x + 30.0, y], [40.0, 18.0]);
        y += 22.0;
    }
    page.ruler([x, height - EDGE - 4.0], false);
    page.text([x + RULER + 2.0, height - EDGE - 4.0], 2.6, Anchor::Start, "100 mm");
    page.ruler([EDGE + LEFT - 2.5, EDGE + 4.0], true);
    let room = [wide, height - EDGE - 14.0 - y];
    let scale = (room[0] / extent[0]).min(room[1] / extent[1]).min(1.0);
    page.text([x, y + 3.0], 2.8, Anchor::Start, format!("The whole map, at {:.0} % of its size:", 100.0 * scale));
    let view = View { drawing: map, corner: [x, y + 5.0], size: [extent[0] * scale, extent[1] * scale], origin, scale };
    Page { size: [width, height], drawing: page, view: Some(view) }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every point of the map is on a sheet, neighbours share what they should, and seams lie in what both show.
    #[test]
    fn sheets_cover_the_map() {
        for paper in Paper::ALL {
            for map in [[100.0, 100.0], [236.0, 300.0], [181.0, 253.0], [1000.0, 90.0]] {
                let cut = Cut::new(paper.size(), map);
                for k in 0..2 {
                    let reach = (cut.count[k] - 1) as f64 * cut.step[k] + cut.window[k];
                    assert!(reach >= map[k] - 1e-9, "{paper:?} {map:?}");
                    if cut.count[k] > 1 {
                        assert!(cut.window[k] - cut.step[k] >= OVERLAP - 1e-9 && (reach - map[k]).abs() < 1e-9);
                    }
                    for (n, seam) in cut.seams(k).into_iter().enumerate() {
                        let (end, begin) = (n as f64 * cut.step[k] + cut.window[k], (n + 1) as f64 * cut.step[k]);
                        assert!(seam - begin >= 0.5 * OVERLAP - 1e-9 && end - seam >= 0.5 * OVERLAP - 1e-9);
                    }
                }
            }
        }
    }
}
