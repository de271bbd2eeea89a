//! What is built, and how its materials are told apart: by letter, by colour and by hatching, each of which would do alone.

use crate::evaluate::Subject;
use crate::lattice::{Block, Layered};
use crate::layout::{Layout, PieceSphere};
use crate::material::Material;
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
    /// The sheet that it is, or the layer of a crystal in space.
    pub kind: Kind,
}

/// What a piece is.
#[derive(Clone, Debug, PartialEq)]
pub enum Kind {
    /// A sheet, seen from the side: x to the right from the axis, depth below row 1 down.
    Sheet,
    /// A layer, seen from the struck side: x to the right from the axis, y up from it. Rows count from above.
    Layer {
        /// From the struck one on.
        number: u32,
        /// How many there are.
        of: u32,
        /// Where the centres of the layer lie on which this one is laid: x and, down the map, −y (m).
        below: Vec<[f64; 2]>,
    },
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

/// A length (m) in millimetres, to the millionth: 3/8 in are 9.525 mm, whatever binary fractions make of it.
pub(super) fn millimetres(length: f64) -> f64 {
    (1e9 * length).round() / 1e6
}

impl Piece {
    /// The whole piece of a layout, or one whose halves differ. Materials that do not occur take no letter.
    pub fn new<'a>(name: &str, of: impl Into<Subject<'a>>) -> Self {
        let subject: Subject<'_> = of.into();
        let (layout, spheres) = (subject.layout, subject.spheres());
        Self {
            name: name.to_owned(),
            diameter: millimetres(layout.lattice.diameter()),
            marks: marks(&layout.palette, &spheres),
            spheres,
            rows: layout.lattice.rows(),
            kind: Kind::Sheet,
        }
    }

    /// The layers of a layout in space, both halves, in the order in which they are laid: the struck one, layer 1, comes last. Letters are the
    /// same in all of them, and those of the whole, which are given too.
    pub fn layers(name: &str, layout: &Layout<Block>) -> (Vec<Self>, Vec<Mark>) {
        let block = &layout.lattice;
        let of = block.layers();
        let layers: Vec<Vec<PieceSphere>> = (1..=of).map(|layer| layer_of(layout, layer)).collect();
        let whole = marks(&layout.palette, &layers.concat());
        let piece = |number: u32| {
            let spheres = layers[number as usize - 1].clone();
            let count = |k: usize| spheres.iter().filter(|sphere| usize::from(sphere.material) == k).count();
            let below = layers.get(number as usize).into_iter().flatten().map(|sphere| [sphere.x, sphere.z]);
            Self {
                name: format!("{name}, layer {number}"),
                diameter: millimetres(block.diameter()),
                marks: whole.iter().enumerate().map(|(k, mark)| Mark { count: count(k), ..mark.clone() }).collect(),
                rows: spheres.last().map_or(0, |sphere| sphere.row),
                kind: Kind::Layer { number, of, below: below.collect() },
                spheres,
            }
        };
        ((1..=of).rev().map(piece).collect(), whole)
    }

    /// Number of the layer that it is, from the struck one on; of a sheet 1.
    pub fn number(&self) -> u32 {
        match self.kind {
            Kind::Sheet => 1,
            Kind::Layer { number, .. } => number,
        }
    }

    /// The materials that occur.
    pub fn used(&self) -> impl Iterator<Item = (usize, &Mark)> {
        used(&self.marks)
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

/// Those of which there are any.
pub fn used(marks: &[Mark]) -> impl Iterator<Item = (usize, &Mark)> {
    marks.iter().enumerate().filter(|(_, mark)| mark.count > 0)
}

/// How the materials of some spheres are drawn.
fn marks(palette: &[Material], spheres: &[PieceSphere]) -> Vec<Mark> {
    let mut used = 0;
    let mark = |(k, material): (usize, &Material)| {
        let count = spheres.iter().filter(|sphere| usize::from(sphere.material) == k).count();
        let place = used;
        used += usize::from(count > 0);
        Mark {
            material: material.name.clone(),
            letter: if count > 0 { letters(place) } else { String::new() },
            colour: pale(material_colour(place)),
            hatch: Hatch::of(place),
            count,
        }
    };
    palette.iter().enumerate().map(mark).collect()
}

/// The spheres of a layer, both halves, row by row from that of the greatest y, each from left to right.
fn layer_of(layout: &Layout<Block>, layer: u32) -> Vec<PieceSphere> {
    let block = &layout.lattice;
    let mut spheres: Vec<PieceSphere> = Vec::new();
    for site in block.layer(layer) {
        let [x, y, _] = block.sites()[site].centre;
        let material = layout.materials[site];
        let sides = [x, -x].into_iter().take(usize::from(block.copies()[site]));
        spheres.extend(sides.map(|x| PieceSphere { row: 0, column: 0, x, z: -y, material, site }));
    }
    spheres.sort_by(|a, b| a.z.total_cmp(&b.z).then(a.x.total_cmp(&b.x)));
    let near = 0.1 * block.diameter();
    for (row, of_row) in (1..).zip(spheres.chunk_by_mut(|a, b| (a.z - b.z).abs() < near)) {
        of_row.sort_by(|a, b| a.x.total_cmp(&b.x));
        (1..).zip(of_row).for_each(|(column, sphere)| (sphere.row, sphere.column) = (row, column));
    }
    spheres
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
