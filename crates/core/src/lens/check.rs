//! Whether a request makes sense in its crystal.

use super::LensRequest;
use super::Stack;
use super::plano_convex::least_radius;
use super::unreachable::Unreachable;
use crate::target::Target;
use crate::units::Dimension::{Angle, Length};

/// Why there is no lens for a request.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LensError {
    /// The rows that may hold lens material are no range of the crystal's rows.
    #[error("lens rows {} to {}: give a first and a later last row within the crystal's 1 to {rows}", .given[0], .given[1])]
    Rows {
        /// First and last row as given.
        given: [u32; 2],
        /// Rows of the crystal.
        rows: u32,
    },
    /// The focal region is no range of the crystal's rows.
    #[error("focal rows {} to {}: give a first and a last row within the crystal's 1 to {rows}", .given[0], .given[1])]
    FocusRows {
        /// First and last row as given.
        given: [u32; 2],
        /// Rows of the crystal.
        rows: u32,
    },
    /// The focal region's distances from the axis are no range.
    #[error("focal region from {} to {} off the axis: the first must be the smaller", Length.show(.0[0]), Length.show(.0[1]))]
    FocusWidth([f64; 2]),
    /// The greatest interface angle is none of a face that waves come through.
    #[error("max_interface_angle = {} must lie above 0 and below 90 degrees", Angle.show(*.0))]
    MaxAngle(f64),
    /// The apex row as given is not allowed.
    #[error("apex_row = {given}: the lens may lie in rows {} to {} and needs a row behind its apex, so the apex may be at most in row {last}", .rows[0], .rows[1])]
    ApexRow {
        /// As given.
        given: u32,
        /// Rows that may hold lens material.
        rows: [u32; 2],
        /// Greatest possible.
        last: u32,
    },
    /// The back row as given is not allowed.
    #[error("back_row = {given}: the lens may lie in rows {} to {}, in front of the focal region (row {focus}) and behind its own apex, so the back may be in rows {first} to {last}", .rows[0], .rows[1])]
    BackRow {
        /// As given.
        given: u32,
        /// Rows that may hold lens material.
        rows: [u32; 2],
        /// First row of any focal region.
        focus: u32,
        /// Least possible.
        first: u32,
        /// Greatest possible.
        last: u32,
    },
    /// The radius as given is no length.
    #[error("radius = {0} m must be a positive number")]
    RadiusSign(f64),
    /// The radius as given makes the front too steep.
    #[error(
        "radius = {} makes the face steeper than max_interface_angle = {}; over these rows it must be at least {}",
        Length.show(*.given), Angle.show(*.max_angle), Length.show(*.least)
    )]
    Radius {
        /// As given (m).
        given: f64,
        /// The limit that it breaks (rad).
        max_angle: f64,
        /// Least radius that does not (m).
        least: f64,
    },
    /// The lens's axis lies outside the crystal.
    #[error("axis = {}: the lens's axis must lie within the half crystal, 0 to {}", Length.show(*.given), Length.show(*.half_width))]
    Axis {
        /// As given (m).
        given: f64,
        /// Distance to the far mirror line (m).
        half_width: f64,
    },
    /// The family needs more rows.
    #[error("lens rows {} to {}: a lens of the family {family} needs at least {least}", .given[0], .given[1])]
    Span {
        /// Its name.
        family: &'static str,
        /// First and last row as given.
        given: [u32; 2],
        /// Least number of rows.
        least: u32,
    },
    /// A lens of the family is one and cannot be split among several foci.
    #[error("a lens of the family {family} cannot be split among {foci} focal regions")]
    Split {
        /// Its name.
        family: &'static str,
        /// Number of focal regions.
        foci: usize,
    },
    /// A parameter that the family does not have, or a value of one outside of its range.
    #[error("{name} of a lens of the family {family} {rule}")]
    Parameter {
        /// The family's name.
        family: &'static str,
        /// The parameter's.
        name: String,
        /// What it is, or has to be.
        rule: String,
    },
    /// An axis is given, and each of several parts has its own.
    #[error("axis = {}: each of several focal regions has a part with an axis of its own", Length.show(*.0))]
    PartsAxis(f64),
    /// A body of revolution has no axis but that of the crystal.
    #[error(
        "a body of revolution lies on the crystal's axis; off it, or for several focal regions, it would be a ridge"
    )]
    OffAxis,
    /// No lens within the limits serves the target.
    #[error(transparent)]
    Unreachable(Box<Unreachable>),
}

/// Checks a request against its crystal and itself, as far as that needs no rays.
pub(super) fn check(stack: &Stack, request: &LensRequest, target: &Target) -> Result<(), LensError> {
    let is_range = |[first, last]: [u32; 2]| 1 <= first && first <= last && last <= stack.rows;
    if !is_range(request.rows) || request.rows[0] == request.rows[1] {
        return Err(LensError::Rows { given: request.rows, rows: stack.rows });
    }
    for focus in target.foci.iter().map(|focus| &focus.region) {
        if !is_range(focus.rows) {
            return Err(LensError::FocusRows { given: focus.rows, rows: stack.rows });
        }
        // A comparison with NaN has no order.
        if focus.x[0].partial_cmp(&focus.x[1]).is_none_or(|order| order.is_gt()) {
            return Err(LensError::FocusWidth(focus.x));
        }
    }
    if target.foci.len() > 1 {
        if !request.family.is_split() && !request.family.spares() {
            return Err(LensError::Split { family: request.family.name(), foci: target.foci.len() });
        }
        if let Some(axis) = request.axis.filter(|_| request.family.is_split()) {
            return Err(LensError::PartsAxis(axis));
        }
    }
    let first_focal = target.focal_rows()[0];
    let max_angle = request.max_interface_angle;
    if !(max_angle > 0.0 && max_angle < std::f64::consts::FRAC_PI_2) {
        return Err(LensError::MaxAngle(max_angle));
    }
    if let Some(axis) = request.axis
        && !(0.0..=stack.half_width * (1.0 + 1e-9)).contains(&axis)
    {
        return Err(LensError::Axis { given: axis, half_width: stack.half_width });
    }
    let span = request.family.least_span(&request.values(stack.diameter)?);
    if request.rows[1] - request.rows[0] < span {
        return Err(LensError::Span { family: request.family.name(), given: request.rows, least: span + 1 });
    }
    let last_row = request.rows[1].min(first_focal - 1);
    if let Some(given) = request.apex_row {
        let last = last_row.saturating_sub(1);
        if given < request.rows[0] || given > last {
            return Err(LensError::ApexRow { given, rows: request.rows, last });
        }
    }
    if let Some(given) = request.back_row {
        let first = request.apex_row.unwrap_or(request.rows[0]) + 1;
        if given < first || given > last_row {
            let (rows, focus) = (request.rows, first_focal);
            return Err(LensError::BackRow { given, rows, focus, first, last: last_row });
        }
    }
    if let Some(given) = request.radius {
        if !(given.is_finite() && given > 0.0) {
            return Err(LensError::RadiusSign(given));
        }
        let one = target.foci.len() == 1;
        if !request.family.row().has_fan || request.axis.is_some() || !one {
            return Ok(());
        }
        // The thinnest lens that the rows allow has the smallest least radius.
        let rows = match (request.apex_row, request.back_row) {
            (Some(apex), Some(back)) => back - apex,
            _ => 1,
        };
        let thickness = f64::from(rows) * stack.spacing;
        let least = least_radius(thickness, stack.half_width, max_angle);
        // 1e-9, so that an angle of exactly the limit is within it.
        if given < least * (1.0 - 1e-9) {
            return Err(LensError::Radius { given, max_angle, least });
        }
    }
    Ok(())
}
