//! A wedge that turns all rays one way.

use super::{Bend, PLAIN, Row, one};
use crate::lens::form::Face;

pub(super) const FAMILY: Row = Row {
    name: "prism",
    bend: Bend::Side,
    gathers: false,
    has_axis: false,
    greatest: |_| 1.0,
    form: |place, curvature| {
        let ([first, last], window) = (place.depth, place.window);
        // The edge lies at the far mirror line or, if negative, on the axis; thickest at the other. Of a part likewise.
        let slope = (last - first) / (window[1] - window[0]);
        let ends = if curvature > 0.0 { [first, last] } else { [last, first] };
        let front = Face::Ramp { from: [window[0], ends[0]], to: [window[1], ends[1]] };
        (slope.atan() <= place.max_angle + 1e-9).then(|| one(front, Face::flat(last, window), window))
    },
    ..PLAIN
};
