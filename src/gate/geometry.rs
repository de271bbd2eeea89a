//! Whether the piece fits, stands, and is made of what can be bought.

use super::{Line, Look, Word};
use crate::design::Design;
use crate::evaluate::{Drawing, Subject, held_spheres, settled};
use crate::material;
use crate::units::Dimension::Length;

/// Differences below this part of a diameter are rounding.
const ROUNDING: f64 = 1e-9;

/// The frame's room may be greater by this part of a diameter before it is told: 0.1 % of the diameter costs a tenth of the contrast.
const GAP: f64 = 1e-3;

pub(super) fn lines(look: &Look, frame: [Option<f64>; 2]) -> Vec<Line> {
    let mut lines = match look.drawing {
        Drawing::Plane(design, subject) => in_frame((design, subject), frame),
        Drawing::Space(..) => Vec::new(),
    };
    lines.push(catalogue_diameter(look.drawing.design().diameter()));
    lines.push(catalogue_materials(look));
    lines
}

/// Whether a sheet goes into its frame, and stands there.
fn in_frame((design, subject): (&Design, Subject<'_>), frame: [Option<f64>; 2]) -> Vec<Line> {
    let mut lines = Vec::new();
    let diameter = design.lattice.diameter();
    let mut spheres = held_spheres(subject);
    let far = |axis: usize| spheres.iter().map(|sphere| sphere.centre[axis]).fold(0.0, f64::max);
    // Between the side walls, and from the centres of row 1 to the end wall, as the frame of `build` is.
    let piece = [2.0 * far(0) + diameter, far(1) + 0.5 * diameter];
    let names = ["frame, width", "frame, depth"];
    let mut gaps = [0.0; 2];
    for k in 0..2 {
        let Some(room) = frame[k] else { continue };
        let left = room - piece[k];
        gaps[k] = left.max(0.0);
        let number = format!("the piece takes {}, the frame leaves {}", Length.show(piece[k]), Length.show(left));
        let (word, why) = match left {
            left if left < -ROUNDING * diameter => {
                (Word::Fail, "Spheres are wider than the frame: the last does not go in.")
            }
            left if left > GAP * diameter => {
                (Word::Warn, "Where spheres part from the wall the wave comes out of step.")
            }
            _ => (Word::Pass, "The walls touch the outermost spheres."),
        };
        lines.push(Line::new(names[k], word, number, format!("0 to {}", Length.show(GAP * diameter)), why));
    }
    if frame == [None; 2] {
        let number = format!(
            "{} between the side walls, {} from row 1 to the end wall",
            Length.show(piece[0]),
            Length.show(piece[1])
        );
        lines.push(Line::new(
            "frame",
            Word::Pass,
            number,
            "made to fit",
            "Walls touch the outermost spheres of the longer rows.",
        ));
    }
    let why =
        "Spheres of nominal diameter, laid in the frame, without friction, have to find their place near their sites.";
    let limit = Length.show(0.25 * diameter);
    lines.push(match settled(design, &subject.layout.palette, &mut spheres, [0.5 * gaps[0], gaps[1]]) {
        Ok(moved) => Line::new(
            "stack under gravity",
            Word::Pass,
            format!("stands; the farthest sphere moves by {}", Length.show(moved)),
            limit,
            why,
        ),
        Err(error) => Line::new("stack under gravity", Word::Fail, error.to_string(), limit, why),
    });
    lines
}

/// Ball sizes that makers keep: ISO 3290-1, table of nominal diameters, up to 25.4 mm. Fractions of an inch in 1/64, from 1/32 on, in 1/32 from 1/2
/// and in 1/16 from 3/4 on; whole and half millimetres up to 10 mm, whole ones beyond.
fn is_stock(diameter: f64) -> bool {
    let whole = |value: f64| (value - value.round()).abs() < 1e-6 && value.round() > 0.0;
    let inches = diameter / 0.0254;
    let parts = if inches < 0.5 {
        64.0
    } else if inches < 0.75 {
        32.0
    } else {
        16.0
    };
    let millimetres = 1e3 * diameter;
    let per_millimetre = if millimetres <= 10.0 { 2.0 } else { 1.0 };
    (inches >= 1.0 / 32.0 - 1e-9 && whole(parts * inches)) || whole(per_millimetre * millimetres)
}

fn catalogue_diameter(diameter: f64) -> Line {
    let word = if is_stock(diameter) { Word::Pass } else { Word::Warn };
    Line::new(
        "diameter in stock",
        word,
        Length.show(diameter),
        "a size of the catalogue (ISO 3290-1, nominal diameters)",
        "Other sizes are ground to order.",
    )
}

fn catalogue_materials(look: &Look) -> Line {
    let palette = look.drawing.palette();
    let used = look.drawing.letters().into_iter().map(usize::from);
    let missing: Vec<&str> =
        used.map(|m| palette[m].name.as_str()).filter(|name| material::canonical(name).is_none()).collect();
    let (word, number) = match missing.is_empty() {
        true => (Word::Pass, "all materials are the library's".to_owned()),
        false => (Word::Warn, format!("not in the library: {}", missing.join(", "))),
    };
    Line::new(
        "materials in stock",
        word,
        number,
        "materials of the library",
        "Values of others rest on one source; ask for a certificate.",
    )
}

#[cfg(test)]
mod tests {
    use super::is_stock;

    #[test]
    fn sizes_of_catalogues_are_known() {
        for (diameter, expected) in [
            (6.35e-3, true),
            (9.525e-3, true),
            (6.0e-3, true),
            (6.5e-3, true),
            (6.4e-3, false),
            (19.05e-3, true),
            (13.0e-3, true),
            (12.3e-3, false),
        ] {
            assert_eq!(is_stock(diameter), expected, "{diameter}");
        }
    }
}
