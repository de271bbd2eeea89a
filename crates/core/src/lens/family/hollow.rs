//! A circular front that is hollow towards the impact, and a flat back: it spreads, or turns rays away from what is protected.

use super::{PLAIN, Place, Row, one};
use crate::lens::form::{Face, Form};

pub(super) const PLANO_CONCAVE: Row =
    Row { name: "plano-concave", gathers: false, is_split: false, greatest, form, ..PLAIN };

/// About the protected region.
pub(super) const SHIELD: Row = Row { name: "shield", spares: true, ..PLANO_CONCAVE };

/// Thickness on the axis of a lens that is hollow there, in rows: with it the row at the back is all of the lens.
const HOLLOW: f64 = 0.5;

fn greatest(place: &Place) -> f64 {
    let widest = place.widest();
    // The face has to have risen by no more than the rows allow at the farther mirror line.
    let sag = place.thickness() - HOLLOW * place.spacing;
    let by_rows = if sag > 0.0 { 2.0 * sag / (sag * sag + widest * widest) } else { 0.0 };
    let quarter = 1.0 / widest;
    by_rows.min(place.max_angle.sin() / widest).min(quarter)
}

fn form(place: &Place, curvature: f64) -> Option<Form> {
    let (last, window) = (place.depth[1], place.window);
    let front = place.conic(last - HOLLOW * place.spacing, -curvature, 0.0, window);
    (curvature > 0.0).then(|| one(Face::Conic(front), Face::flat(last, window), window))
}
