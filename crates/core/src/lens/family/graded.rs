//! A flat slab mixed of host and lens material, slowest on its axis.

use super::{Bend, PLAIN, Row};
use crate::lens::form::Form;
use crate::lens::graded::Profile;
use crate::lens::raster::Raster;

pub(super) const FAMILY: Row = Row {
    name: "graded",
    aliases: &["grin"],
    bend: Bend::Sought("focal length"),
    heading: "Focal length aimed at",
    is_split: false,
    takes_others: true,
    is_mixed: true,
    raster: Raster::Diffused,
    // Half the depth to the focus is the shortest that a thick slab is given.
    greatest: |place| 2.0 / (place.focus - place.depth[1]),
    form: |place, curvature| {
        let [host, lens] = place.speeds;
        (place.depth[1] < place.focus).then(|| {
            Form::Graded(Profile {
                depth: place.depth,
                axis: place.axis,
                focal_length: 1.0 / curvature,
                slowness: [1.0 / host, 1.0 / lens],
            })
        })
    },
    ..PLAIN
};
