//! How many of what: the piece, spares, mass and cost.

use std::fmt::Write as _;

use serde::Serialize;

use super::piece::{Mark, Piece, millimetres, used};
use super::spares::Spares;
use crate::design::Design;
use crate::evaluate::Subject;
use crate::lattice::Block;
use crate::layout::{Bill, Layout};
use crate::material::Material;

/// One line of the list.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Part {
    /// As on the map.
    pub letter: String,
    /// Its material.
    pub material: String,
    /// Diameter (mm).
    pub diameter_mm: f64,
    /// Spheres of the piece.
    pub count: usize,
    /// Spheres to order besides.
    pub spares: usize,
    /// Mass of the piece's spheres of it (kg).
    pub mass_kg: f64,
    /// Price of one, as the design file says, in its currency.
    pub price: Option<f64>,
    /// Price of all, spares among them.
    pub cost: Option<f64>,
}

/// What the piece is made of.
pub fn parts(piece: &Piece, subject: Subject<'_>, design: &Design, spares: &Spares) -> Vec<Part> {
    let bill = subject.piece(|material| design.price(material));
    let price = |material: &Material| design.price(material);
    of_bill(&piece.marks, &bill, &subject.layout.palette, subject.layout.lattice.diameter(), price, spares)
}

/// What a layout in space is made of, whose materials are drawn as `marks`.
pub fn parts_in_space(
    marks: &[Mark],
    layout: &Layout<Block>,
    price: impl Fn(&Material) -> Option<f64> + Copy,
    spares: &Spares,
) -> Vec<Part> {
    of_bill(marks, &layout.piece_in_space(price), &layout.palette, layout.lattice.diameter(), price, spares)
}

fn of_bill(
    marks: &[Mark],
    bill: &Bill,
    palette: &[Material],
    diameter: f64,
    price: impl Fn(&Material) -> Option<f64>,
    spares: &Spares,
) -> Vec<Part> {
    let part = |(k, mark): (usize, &Mark)| {
        let (count, material) = (bill.counts[k] as usize, &palette[k]);
        let spares = spares.of(count);
        let price = price(material);
        Part {
            letter: mark.letter.clone(),
            material: mark.material.clone(),
            diameter_mm: millimetres(diameter),
            count,
            spares,
            mass_kg: count as f64 * material.sphere_mass(diameter),
            price,
            cost: price.map(|price| price * (count + spares) as f64),
        }
    };
    used(marks).map(part).collect()
}

/// The list with a sum in its last line; a missing price leaves the sum of costs empty.
pub fn parts_csv(parts: &[Part]) -> String {
    let mut text = "letter,material,diameter_mm,count,spares,order,mass_kg,price,cost\n".to_owned();
    let shown = |price: Option<f64>| price.map_or(String::new(), |price| format!("{price:.2}"));
    for part in parts {
        let Part { letter, material, diameter_mm, count, spares, mass_kg, price, cost } = part;
        let order = count + spares;
        let _ = writeln!(
            text,
            "{letter},{material},{diameter_mm},{count},{spares},{order},{mass_kg:.6},{},{}",
            shown(*price),
            shown(*cost)
        );
    }
    let sum = |of: fn(&Part) -> usize| parts.iter().map(of).sum::<usize>();
    let (count, spares) = (sum(|part| part.count), sum(|part| part.spares));
    let mass: f64 = parts.iter().map(|part| part.mass_kg).sum();
    let _ = writeln!(text, "all,,,{count},{spares},{},{mass:.6},,{}", count + spares, shown(total_cost(parts)));
    text
}

/// What all of it costs; none where a price is missing.
pub fn total_cost(parts: &[Part]) -> Option<f64> {
    parts.iter().map(|part| part.cost).sum()
}
