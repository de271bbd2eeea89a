//! A circular front, convex towards the impact, and a flat back.

use super::{PLAIN, Place, Row, reach};
use crate::lens::form::{Element, Face, Form};

pub(super) const FAMILY: Row = Row {
    name: "plano-convex",
    is_central: true,
    has_fan: true,
    form: |place, curvature| Some(Form::Elements(vec![element(place, place.depth, curvature, 1)])),
    ..PLAIN
};

/// One such piece between two depths (m).
pub(super) fn element(place: &Place, [first, last]: [f64; 2], curvature: f64, material: u8) -> Element {
    let x = place.within(reach(last - first, curvature, place.widest()));
    let front = place.conic(first, curvature, 0.0, x);
    Element { front: Face::Conic(front), back: Face::flat(last, x), x, material }
}
