//! The map for CAD: DXF of release 12, which everything reads, in millimetres; one layer for each material.

use std::fmt::Write as _;

use super::piece::Piece;

/// Colours by AutoCAD's index, one for each material in turn.
const COLOURS: [u8; 7] = [8, 2, 3, 1, 5, 6, 4];

/// Release 12 knows layers of up to 31 capital letters, digits, $, - and _.
fn layer(letter: &str, material: &str) -> String {
    let plain = |c: char| if c.is_ascii_alphanumeric() || c == '-' { c.to_ascii_uppercase() } else { '_' };
    format!("{letter}-{}", material.chars().map(plain).collect::<String>()).chars().take(31).collect()
}

/// Tagged lines: a number that says what follows, then that.
struct Tags(String);

impl Tags {
    fn put(&mut self, code: u16, value: impl std::fmt::Display) {
        let _ = writeln!(self.0, "{code}\n{value}");
    }

    /// y points up in CAD.
    fn point(&mut self, first: u16, [x, y]: [f64; 2]) {
        self.put(first, x);
        self.put(first + 10, -y);
        self.put(first + 20, 0.0);
    }

    fn text(&mut self, layer: &str, [x, y]: [f64; 2], height: f64, text: &str) {
        self.put(0, "TEXT");
        self.put(8, layer);
        let middle = [x, y + 0.5 * height];
        self.point(10, middle);
        self.put(40, height);
        self.put(1, text);
        // Centred across; the baseline is placed by hand.
        self.put(72, 1);
        self.point(11, middle);
    }

    fn line(&mut self, layer: &str, from: [f64; 2], to: [f64; 2]) {
        self.put(0, "LINE");
        self.put(8, layer);
        self.point(10, from);
        self.point(11, to);
    }
}

/// The piece as a drawing: circles on a layer of their material, letters, numbers of rows, hatching, the inner faces of the frame and the axis.
pub fn dxf(piece: &Piece) -> String {
    let mut tags = Tags(String::new());
    let [left, top, right, bottom] = piece.extent();
    tags.put(
        999,
        format!(
            "{}: assembly map, lengths in millimetres; x = 0 is the crystal's axis, y = 0 row 1, -y depth",
            piece.name
        ),
    );
    tags.put(0, "SECTION");
    tags.put(2, "HEADER");
    tags.put(9, "$ACADVER");
    tags.put(1, "AC1009");
    tags.put(9, "$EXTMIN");
    tags.point(10, [left, bottom]);
    tags.put(9, "$EXTMAX");
    tags.point(10, [right, top]);
    tags.put(0, "ENDSEC");

    tags.put(0, "SECTION");
    tags.put(2, "TABLES");
    tags.put(0, "TABLE");
    tags.put(2, "LTYPE");
    tags.put(70, 1);
    tags.put(0, "LTYPE");
    tags.put(2, "CONTINUOUS");
    tags.put(70, 0);
    tags.put(3, "Solid line");
    tags.put(72, 65);
    tags.put(73, 0);
    tags.put(40, 0.0);
    tags.put(0, "ENDTAB");
    let names: Vec<String> = piece.marks.iter().map(|mark| layer(&mark.letter, &mark.material)).collect();
    let layers: Vec<(&str, u8)> = piece
        .used()
        .map(|(k, _)| (&names[k][..], COLOURS[k % COLOURS.len()]))
        .chain([("LETTERS", 7), ("HATCHING", 9), ("ROWS", 7), ("FRAME", 7), ("AXIS", 9)])
        .collect();
    tags.put(0, "TABLE");
    tags.put(2, "LAYER");
    tags.put(70, layers.len());
    for (name, colour) in &layers {
        tags.put(0, "LAYER");
        tags.put(2, name);
        tags.put(70, 0);
        tags.put(62, colour);
        tags.put(6, "CONTINUOUS");
    }
    tags.put(0, "ENDTAB");
    tags.put(0, "ENDSEC");

    tags.put(0, "SECTION");
    tags.put(2, "ENTITIES");
    let radius = 0.5 * piece.diameter;
    for sphere in &piece.spheres {
        let place = piece.place(sphere);
        tags.put(0, "CIRCLE");
        tags.put(8, &names[usize::from(sphere.material)]);
        tags.point(10, place);
        tags.put(40, radius);
        let mark = piece.mark(sphere);
        tags.text("LETTERS", place, 0.3 * piece.diameter / mark.letter.len().max(1) as f64, &mark.letter);
        for chord in mark.hatch.chords(radius) {
            let [from, to] = chord.map(|[x, y]| [place[0] + x, place[1] + y]);
            tags.line("HATCHING", from, to);
        }
    }
    for row in 1..=piece.rows {
        if let Some(sphere) = piece.spheres.iter().find(|sphere| sphere.row == row) {
            tags.text("ROWS", [left - 0.7 * piece.diameter, 1e3 * sphere.z], 0.3 * piece.diameter, &row.to_string());
        }
    }
    tags.line("FRAME", [left, 0.0], [left, bottom]);
    tags.line("FRAME", [left, bottom], [right, bottom]);
    tags.line("FRAME", [right, bottom], [right, 0.0]);
    tags.line("AXIS", [0.0, top - piece.diameter], [0.0, bottom + piece.diameter]);
    tags.put(0, "ENDSEC");
    tags.put(0, "EOF");
    tags.0
}
