//! A plano-convex front folded into zones.

use super::{PLAIN, Place, Row, one};
use crate::lens::form::{Face, Form};
use crate::ray::Conic;

pub(super) const FAMILY: Row = Row {
    name: "fresnel",
    // Zones come and go.
    is_monotonic: false,
    greatest: |place| place.max_angle.sin() / place.widest(),
    form,
    ..PLAIN
};

/// A ring of fewer sites than one has no meaning.
const MOST_ZONES: f64 = 20.0;

fn form(place: &Place, curvature: f64) -> Option<Form> {
    let Place { depth: [first, last], window, axis, .. } = *place;
    let step = last - first;
    let base = place.conic(first, curvature, 0.0, window);
    let zones = (base.sag(place.widest()) / step).ceil();
    // One zone is a plano-convex lens.
    if !(2.0..=MOST_ZONES).contains(&zones) {
        return None;
    }
    // Ring k lies where the sag of the unfolded face is from k to k + 1 steps.
    let radius = |k: f64| (k * step * (2.0 / curvature - k * step)).max(0.0).sqrt().min(place.widest());
    let mut pieces: Vec<Conic> = Vec::new();
    for k in (0..zones as u32).map(f64::from) {
        let (inner, outer) = (radius(k), if k + 1.0 == zones { place.widest() } else { radius(k + 1.0) });
        for [a, b] in [[axis - outer, axis - inner], [axis + inner, axis + outer]] {
            let x = [a.max(window[0]), b.min(window[1])];
            if x[1] > x[0] {
                pieces.push(place.conic(first - k * step, curvature, 0.0, x));
            }
        }
    }
    pieces.sort_by(|a, b| a.x[0].total_cmp(&b.x[0]));
    Some(one(Face::Zoned(pieces), Face::flat(last, window), window))
}
