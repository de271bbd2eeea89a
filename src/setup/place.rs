//! Places, directions and spheres, as a rig file writes them.

use super::file::PlaceKeys;
use crate::document::{DocumentError, Entry, Scope};
use crate::pattern::Selection;
use crate::units::Dimension;

/// Names of the axes in `D` dimensions; the last is depth.
pub(super) const fn axes<const D: usize>() -> &'static [&'static str] {
    match D {
        1 => &["z"],
        2 => &["x", "z"],
        _ => &["x", "y", "z"],
    }
}

/// `D` values, in the order of the axes.
pub(super) fn vector<'a, const D: usize>(
    entry: &Entry<'a>,
    value: impl Fn(&Entry<'a>) -> Result<f64, DocumentError>,
) -> Result<[f64; D], DocumentError> {
    let items = entry.one_or_more();
    if items.len() != D || (D > 1 && !entry.is_list()) {
        return Err(entry.refuse(&format!("must be a list of {D}, along {}", axes::<D>().join(", "))));
    }
    let mut vector = [0.0; D];
    for (component, item) in vector.iter_mut().zip(&items) {
        *component = value(item)?;
    }
    Ok(vector)
}

/// A quantity along the wave, or a list of them along each axis.
pub(super) fn along_wave<const D: usize>(entry: &Entry, dimension: Dimension) -> Result<[f64; D], DocumentError> {
    if entry.is_list() {
        return vector(entry, |item| item.quantity(dimension));
    }
    let mut vector = [0.0; D];
    vector[D - 1] = entry.quantity(dimension)?;
    Ok(vector)
}

/// A direction: plain numbers, made a unit vector.
pub(super) fn direction<const D: usize>(entry: &Entry) -> Result<[f64; D], DocumentError> {
    let vector: [f64; D] = vector(entry, Entry::number)?;
    let length = vector.iter().map(|x| x * x).sum::<f64>().sqrt();
    if length > 0.0 { Ok(vector.map(|x| x / length)) } else { Err(entry.refuse("has no direction")) }
}

/// The axes that a list names.
pub(super) fn named_axes<const D: usize>(entry: &Entry) -> Result<[bool; D], DocumentError> {
    let known: Vec<(&str, usize)> = axes::<D>().iter().copied().zip(0..).collect();
    let mut held = [false; D];
    for item in entry.one_or_more() {
        held[item.choice("axis of this rig", &known)?] = true;
    }
    Ok(held)
}

/// First and last of a list of two, in order and from 1 up to `most`.
fn first_and_last(entry: &Entry, most: u32) -> Result<[u32; 2], DocumentError> {
    let [first, last] = match entry.one_or_more().as_slice() {
        [only] => [only.whole(1..=most)?; 2],
        [first, last] => [first.whole(1..=most)?, last.whole(1..=most)?],
        _ => return Err(entry.refuse("must be one number, or the first and the last")),
    };
    if first > last { Err(entry.refuse("is reversed")) } else { Ok([first, last]) }
}

/// Two lengths, the smaller first.
pub(super) fn range(entry: &Entry, diameter: f64) -> Result<[f64; 2], DocumentError> {
    let [low, high] = entry.pair()?;
    let range = [low.length(diameter)?, high.length(diameter)?];
    if range[0] > range[1] { Err(entry.refuse("is reversed")) } else { Ok(range) }
}

/// Which spheres a section means; none of its keys means all.
pub(super) fn selection<const D: usize>(
    scope: &Scope,
    keys: PlaceKeys,
    diameter: f64,
    layers: u32,
) -> Result<Selection<D>, DocumentError> {
    let mut selection = Selection::default();
    if let Some(entry) = scope.optional("layers", keys.layers) {
        selection.layers = Some(first_and_last(&entry, layers)?);
    }
    if let Some(entry) = scope.optional("columns", keys.columns) {
        selection.columns = Some(first_and_last(&entry, u32::MAX)?);
    }
    for (name, value) in [("x", keys.x), ("y", keys.y), ("z", keys.z)] {
        let Some(entry) = scope.optional(name, value) else { continue };
        match axes::<D>().iter().position(|axis| *axis == name) {
            Some(axis) => selection.ranges[axis] = Some(range(&entry, diameter)?),
            None => return Err(no_axis::<D>(&entry)),
        }
    }
    Ok(selection)
}

/// An axis that the rig does not have.
pub(super) fn no_axis<const D: usize>(entry: &Entry) -> DocumentError {
    let help = format!("A rig with this packing has the axes {}.", axes::<D>().join(", "));
    entry.fail("is along an axis that there is not", &help)
}

/// A spin (rad/s): in a sheet about y, in space along each axis.
pub(super) fn spin<const D: usize>(entry: &Entry) -> Result<[f64; 3], DocumentError> {
    match D {
        1 => Err(entry.fail("has no meaning in a chain", "Leave it out.")),
        2 => Ok([0.0, 0.0, spin_about_y(entry.quantity(Dimension::Spin)?)]),
        _ => {
            let about: [f64; D] = vector(entry, |item| item.quantity(Dimension::Spin))?;
            Ok(std::array::from_fn(|k| about.get(k).copied().unwrap_or(0.0)))
        }
    }
}

/// A spin or angle (rad/s, rad) of a sheet counted about y, from one counted in the plane from x towards z, or the other way: the axes
/// x, y, z are right-handed, so that a turn from x to z is one about −y.
pub fn spin_about_y(turn: f64) -> f64 {
    // Not −0, which would be written with its sign.
    0.0 - turn
}
