//! Several plano-convex lenses one behind the other.

use super::plano_convex::element;
use super::{PLAIN, Parameter, Place, Quantity, Row, greatest};
use crate::lens::form::Form;

pub(super) const FAMILY: Row = Row {
    name: "stages",
    parameters: &[Parameter {
        name: "stages",
        about: "How many there are, one behind the other",
        quantity: Quantity::Count,
        // More leave none of them a face to speak of.
        range: [2.0, 10.0],
        usual: 2.0,
        is_sought: false,
    }],
    takes_others: true,
    // Each stage two rows, one of host between two.
    least_span: |values| 3 * stages(values) - 2,
    greatest: |place| {
        let [first, last] = stage(place, 0);
        greatest(last - first, place.widest(), place.max_angle)
    },
    form: |place, curvature| {
        let of = |k: u32| {
            let material = 1 + u8::try_from(k % (place.others + 1)).unwrap_or(0);
            element(place, stage(place, k), curvature, material)
        };
        Some(Form::Elements((0..stages(place.values)).map(of).collect()))
    },
    ..PLAIN
};

fn stages(values: &[f64]) -> u32 {
    values[0] as u32
}

/// Depths of first and last row of a stage; whole rows, one of host between two stages.
fn stage(place: &Place, k: u32) -> [f64; 2] {
    let stages = stages(place.values);
    let rows = (place.thickness() / place.spacing).round() + 1.0;
    let each = ((rows - f64::from(stages - 1)) / f64::from(stages)).floor();
    let first = f64::from(k) * (each + 1.0);
    // The last takes what is left over.
    let last = if k + 1 == stages { rows - 1.0 } else { first + each - 1.0 };
    [first, last].map(|row| place.depth[0] + row * place.spacing)
}
