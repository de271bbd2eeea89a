//! What is built, and how its materials are told apart: by letter, by colour and by hatching, each of which would do alone.

use crate::evaluate::Subject;
use crate::layout::PieceSphere;
use crate::page::Hatch;
use crate::report::material_colour;

/// A layout as it is to be built.
#[derive(Clone, Debug)]
pub struct Piece {
    /// Name of the design.
    pub name: String,
    /// Diameter of the spheres (mm).
    pub diameter: f64,
    /// All spheres, row by row from left to right.
    pub spheres: Vec<PieceSphere>,
    /// How each material of the layout's palette is drawn.
    pub marks: Vec<Mark>,
    /// Number of rows.
    pub rows: u32,
}

/// How one material is drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct Mark {
    /// Its name.
    pub material: String,
    /// A to Z without I and O, which are taken for 1 and 0; then AA, AB and so on.
    pub letter: String,
    /// Fill, red, green and blue.
    pub colour: [u8; 3],
    /// Hatching.
    pub hatch: Hatch,
    /// Spheres of the piece that are made of it.
    pub count: usize,
}

/// The letters of the k-th material.
fn letters(mut k: usize) -> String {
    const ALPHABET: &[u8; 24] = b"ABCDEFGHJKLMNPQRSTUVWXYZ";
    let mut letters = Vec::new();
    loop {
        letters.insert(0, char::from(ALPHABET[k % 24]));
        if k < 24 {
            return letters.into_iter().collect();
        }
        k = k / 24 - 1;
    }
}

/// A colour that black letters and lines stand out from: half way to white.
fn pale(hex: &str) -> [u8; 3] {
    let part = |at: usize| hex.get(at..at + 2).and_then(|digits| u8::from_str_radix(digits, 16).ok()).unwrap_or(255);
    [1, 3, 5].map(|at| part(at) / 2 + 128)
}

impl Piece {
    /// The whole piece of a layout, or one whose halves differ. Materials that do not occur take no letter.
    pub fn new<'a>(name: &str, of: impl Into<Subject<'a>>) -> Self {
        let subject: Subject<'_> = of.into();
        let (layout, spheres) = (subject.layout, subject.spheres());
        let count = |material: usize| spheres.iter().filter(|s| usize::from(s.material) == material).count();
        let mut used = 0;
        let marks = layout.palette.iter().enumerate().map(|(k, material)| {
            let count = count(k);
            let place = used;
            used += usize::from(count > 0);
            Mark {
                material: material.name.clone(),
                letter: if count > 0 { letters(place) } else { String::new() },
                colour: pale(material_colour(place)),
                hatch: Hatch::of(place),
                count,
            }
        });
        let marks = marks.collect();
        Self {
            name: name.to_owned(),
            diameter: 1e3 * layout.lattice.diameter(),
            spheres,
            marks,
            rows: layout.lattice.rows(),
        }
    }

    /// The materials that occur.
    pub fn used(&self) -> impl Iterator<Item = (usize, &Mark)> {
        self.marks.iter().enumerate().filter(|(_, mark)| mark.count > 0)
    }

    /// How a sphere is drawn.
    pub fn mark(&self, sphere: &PieceSphere) -> &Mark {
        &self.marks[usize::from(sphere.material)]
    }

    /// Where a sphere's centre lies on the map (mm).
    pub fn place(&self, sphere: &PieceSphere) -> [f64; 2] {
        [1e3 * sphere.x, 1e3 * sphere.z]
    }

    /// What the spheres fill: left, top, right and bottom of the outermost surfaces (mm).
    pub fn extent(&self) -> [f64; 4] {
        let radius = 0.5 * self.diameter;
        let places = self.spheres.iter().map(|sphere| self.place(sphere));
        places.fold([f64::INFINITY, f64::INFINITY, f64::NEG_INFINITY, f64::NEG_INFINITY], |[l, t, r, b], [x, y]| {
            [l.min(x - radius), t.min(y - radius), r.max(x + radius), b.max(y + radius)]
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_go_on_behind_z_and_never_repeat() {
        let many: Vec<String> = (0..256).map(letters).collect();
        assert_eq!(
            (&many[0][..], &many[8][..], &many[23][..], &many[24][..], &many[47][..]),
            ("A", "J", "Z", "AA", "AZ")
        );
        let distinct: std::collections::BTreeSet<&String> = many.iter().collect();
        assert_eq!(distinct.len(), 256);
        assert!(many.iter().all(|letters| !letters.contains(['I', 'O'])));
    }
}
