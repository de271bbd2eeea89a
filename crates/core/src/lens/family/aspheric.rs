//! Lenses that bring all rays to one point: with a front of equal travel time, or a hyperbolic back.

use super::{Bend, PLAIN, Row, one};
use crate::lens::equal_time::EqualTime;
use crate::lens::form::Face;

pub(super) const FRONT: Row = Row {
    name: "aspheric-front",
    bend: Bend::Aimed("focal distance"),
    heading: "Focal distance behind the lens",
    // Rays may be made to meet anywhere behind the lens.
    greatest: |_| f64::INFINITY,
    form: |place, curvature| {
        let [first, last] = place.depth;
        let front = EqualTime::new(first, last, last + 1.0 / curvature, place.axis, place.widest(), place.speeds)?;
        let x = place.within(front.aperture());
        Some(one(Face::EqualTime(front), Face::flat(last, x), x))
    },
    ..PLAIN
};

pub(super) const BACK: Row = Row {
    name: "aspheric-back",
    form: |place, curvature| {
        let ([first, last], [host, lens]) = (place.depth, place.speeds);
        let n = host / lens;
        let focal = 1.0 / curvature;
        if n <= 1.0 || focal <= 0.0 {
            return None;
        }
        // x² = (n² − 1) s² + 2 (n − 1) f s, with s how much thinner the lens is.
        let (thick, widest) = (last - first, place.widest());
        let rim = ((n * n - 1.0) * thick * thick + 2.0 * (n - 1.0) * focal * thick).sqrt();
        let x = place.within(rim.min(widest));
        let back = place.conic(last, -1.0 / ((n - 1.0) * focal), -n * n, x);
        Some(one(Face::flat(first, x), Face::Conic(back), x))
    },
    ..FRONT
};
