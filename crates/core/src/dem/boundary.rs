//! Where the crystal ends: mirror planes, and where it does not: periods.
//!
//! A mirror stands for the other half of a symmetric crystal. A sphere on it is half a sphere: it keeps no velocity across
//! the plane and carries weight 1/2 in every sum. A sphere half a diameter away touches its own image. Along a period the crystal
//! goes on like itself: a contact across it is one like any other, from a sphere to the nearest image of the other.

/// A plane of symmetry across one axis. The simulated half lies on the side that `inward` points to.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mirror {
    /// Axis that the plane cuts.
    pub axis: usize,
    /// Where on that axis (m).
    pub position: f64,
    /// +1.0 or −1.0: direction from the plane into the simulated half.
    pub inward: f64,
}

impl Mirror {
    /// Signed distance of a centre from the plane (m), positive inside.
    pub fn distance<const D: usize>(&self, centre: &[f64; D]) -> f64 {
        (centre[self.axis] - self.position) * self.inward
    }

    /// Whether a sphere's centre lies on the plane, to 10⁻⁹ of its radius.
    pub fn carries<const D: usize>(&self, centre: &[f64; D], radius: f64) -> bool {
        self.distance(centre).abs() < 1e-9 * radius
    }
}

/// Along an axis everything repeats itself.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Period {
    /// The axis.
    pub axis: usize,
    /// After which way (m): three of the greatest diameters or more, so that two spheres meet through one image alone.
    pub length: f64,
}

impl Period {
    /// From one centre to the nearest image of another, where `between` leads from one to the other (m).
    #[inline(always)]
    pub(super) fn nearest<const D: usize>(periods: &[Self], mut between: [f64; D]) -> [f64; D] {
        for Self { axis, length } in periods {
            between[*axis] -= length * (between[*axis] / length).round();
        }
        between
    }
}
