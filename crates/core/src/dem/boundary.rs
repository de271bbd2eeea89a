//! Where the crystal ends: mirror planes.
//!
//! A mirror stands for the other half of a symmetric crystal. A sphere on it is half a sphere: it keeps no velocity across
//! the plane and carries weight 1/2 in every sum. A sphere half a diameter away touches its own image.

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
