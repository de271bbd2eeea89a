//! The section [preload]: a crystal that is squeezed to rest before it is struck.

use super::file::PreloadFile;
use super::place::along_wave;
use crate::Context;
use crate::dem::rig::{Precompressed, PreloadError, Rig, Squeeze, precompress};
use crate::dem::{MoveIn, Spheres};
use crate::document::{DocumentError, Entry, Scope};
use crate::units::Dimension;

/// How a rig was squeezed.
#[derive(Clone, Debug, PartialEq)]
pub struct Preload {
    /// By which part it is shorter along each axis.
    pub strain: Vec<f64>,
    /// The force (N) across a section along each axis.
    pub force: Vec<f64>,
    /// The greatest force on a sphere that is not balanced, over the greatest contact force.
    pub unbalanced: f64,
}

/// In words.
impl std::fmt::Display for Preload {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let list = |values: &[f64], dimension: Dimension| {
            values.iter().map(|&value| dimension.show(value)).collect::<Vec<_>>().join(", ")
        };
        write!(
            f,
            "squeezed to rest: strain {}, force across a section {}, balanced to {:.1e} of the greatest contact force",
            list(&self.strain, Dimension::Fraction),
            list(&self.force, Dimension::Force),
            self.unbalanced
        )
    }
}

/// A state at rest whose forces balance to this part of the greatest contact force.
const TOLERANCE: f64 = 1e-7;

/// Squeezes a rig whose first `crystal` spheres are those of its crystal.
pub(super) fn preload<const D: usize>(
    rig: &mut Rig<D>,
    crystal: usize,
    scope: &Scope,
    file: &PreloadFile,
) -> Result<Preload, DocumentError>
where
    Spheres: MoveIn<D>,
{
    if rig.sample.spheres.len() > crystal {
        return Err(scope.fail("does not go with intruders", "Strike by [[moving]], [[load]] or a [[flat]]."));
    }
    let mut along = [None; D];
    for (key, written, dimension, make) in [
        ("strain", &file.strain, Dimension::Fraction, Squeeze::Strain as fn(f64) -> Squeeze),
        ("force", &file.force, Dimension::Force, Squeeze::Force),
    ] {
        let Some(entry) = scope.optional(key, written) else { continue };
        for (axis, value) in along_wave::<D>(&entry, dimension)?.into_iter().enumerate().filter(|(_, v)| *v != 0.0) {
            if value < 0.0 || (key == "strain" && value > 0.2) {
                let rule = if key == "strain" { "must lie from 0 to 0.2" } else { "must not be negative" };
                return Err(entry.refuse(rule));
            }
            if along[axis].replace(make(value)).is_some() {
                return Err(entry.fail("is given for an axis that has a strain", "Give one of both for each axis."));
            }
        }
    }
    if along.iter().all(Option::is_none) {
        return Err(
            scope.fail("squeezes nothing", "Give strain = 0.001 or force = \"100 N\", along the wave or as a list.")
        );
    }
    let tolerance = match scope.optional("tolerance", &file.tolerance) {
        Some(entry) => within(&entry)?,
        None => TOLERANCE,
    };
    let never = Context::default();
    let squeezed = precompress(rig, along, tolerance, &never).map_err(|error| {
        let help = match error {
            PreloadError::Loose => "Hold its ends, by sides that are walls, fixed or periodic.",
            PreloadError::Rig(_) | PreloadError::Stop(_) | PreloadError::Force { .. } => "Squeeze it less.",
            PreloadError::Part(_) => "Leave it out.",
            PreloadError::Unrest { .. } => "Give a greater preload.tolerance, like 1e-5.",
        };
        scope.fail(&format!("leads to no rest: {error}"), help)
    })?;
    let Precompressed { rig: at_rest, strain, force, unbalanced } = squeezed;
    *rig = at_rest;
    Ok(Preload { strain: strain.to_vec(), force: force.to_vec(), unbalanced })
}

fn within(entry: &Entry) -> Result<f64, DocumentError> {
    match entry.quantity(Dimension::Fraction)? {
        tolerance if (1e-12..=1e-2).contains(&tolerance) => Ok(tolerance),
        _ => Err(entry.refuse("must lie from 1e-12 to 0.01")),
    }
}
