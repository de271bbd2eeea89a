//! Two circular faces of one radius, both convex.

use super::{PLAIN, Row, greatest, one, reach};
use crate::lens::form::Face;

pub(super) const FAMILY: Row = Row {
    name: "biconvex",
    greatest: |place| greatest(0.5 * place.thickness(), place.widest(), place.max_angle),
    form: |place, curvature| {
        let [first, last] = place.depth;
        let x = place.within(reach(0.5 * (last - first), curvature, place.widest()));
        let [front, back] = [place.conic(first, curvature, 0.0, x), place.conic(last, -curvature, 0.0, x)];
        Some(one(Face::Conic(front), Face::Conic(back), x))
    },
    ..PLAIN
};
