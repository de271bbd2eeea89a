//! The letters of pictures in dots: outlines of a font that the program holds.

use std::sync::OnceLock;

use tiny_skia::{Path, PathBuilder, Transform};
use ttf_parser::{Face, OutlineBuilder};

/// Liberation Sans, which is as wide as Helvetica and Arial, letter by letter; cut down to what pictures hold.
const REGULAR: &[u8] = include_bytes!("fonts/sans-regular.ttf");
const BOLD: &[u8] = include_bytes!("fonts/sans-bold.ttf");

/// The font; none only if the program were broken.
fn face(bold: bool) -> Option<&'static Face<'static>> {
    static FACES: OnceLock<[Option<Face<'static>>; 2]> = OnceLock::new();
    let faces = FACES.get_or_init(|| [REGULAR, BOLD].map(|data| Face::parse(data, 0).ok()));
    faces[usize::from(bold)].as_ref()
}

/// A line of letters of one size, from the origin on: its outline, and its width (px).
pub fn outline(letters: &str, size: f64, bold: bool) -> (Option<Path>, f64) {
    let Some(face) = face(bold) else { return (None, 0.0) };
    let scale = size / f64::from(face.units_per_em());
    let mut pen = Pen { path: PathBuilder::new(), along: 0.0 };
    for letter in letters.chars().filter(|letter| *letter != '\u{200b}') {
        let glyph = face.glyph_index(letter).or_else(|| face.glyph_index('?'));
        let Some(glyph) = glyph else { continue };
        face.outline_glyph(glyph, &mut pen);
        pen.along += f32::from(face.glyph_hor_advance(glyph).unwrap_or_default());
    }
    let width = f64::from(pen.along) * scale;
    // Fonts count upwards.
    let upright = Transform::from_scale(scale as f32, -scale as f32);
    (pen.path.finish().and_then(|path| path.transform(upright)), width)
}

/// Draws a glyph where the line has come to.
struct Pen {
    path: PathBuilder,
    along: f32,
}

impl OutlineBuilder for Pen {
    fn move_to(&mut self, x: f32, y: f32) {
        self.path.move_to(self.along + x, y);
    }

    fn line_to(&mut self, x: f32, y: f32) {
        self.path.line_to(self.along + x, y);
    }

    fn quad_to(&mut self, x1: f32, y1: f32, x: f32, y: f32) {
        self.path.quad_to(self.along + x1, y1, self.along + x, y);
    }

    fn curve_to(&mut self, x1: f32, y1: f32, x2: f32, y2: f32, x: f32, y: f32) {
        self.path.cubic_to(self.along + x1, y1, self.along + x2, y2, self.along + x, y);
    }

    fn close(&mut self) {
        self.path.close();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::page::letter_width;

    /// Pictures are laid out by the widths of Helvetica.
    #[test]
    fn letters_are_as_wide_as_pictures_take_them_for() {
        for bold in [false, true] {
            for letter in
                (' '..='~').filter(|letter| !matches!(letter, '\'' | '`' | '"' | '*' | '^' | '|' | '{' | '}' | '~'))
            {
                let (_, width) = outline(&letter.to_string(), 1.0, bold);
                let wanted = letter_width(letter, bold);
                assert!((width - wanted).abs() < 0.002, "{letter} {bold}: {width}, {wanted}");
            }
        }
    }

    /// What stands in pictures has a letter of its own.
    #[test]
    fn no_letter_of_pictures_is_missing() {
        let letters = "µ²³·°±×½éöü–—−’…≤≥√αβγδηθμνπρστωΔΣ₀₉";
        for bold in [false, true] {
            let face = face(bold).unwrap();
            let missing: String = letters.chars().filter(|letter| face.glyph_index(*letter).is_none()).collect();
            assert_eq!(missing, "", "{bold}");
        }
    }
}
