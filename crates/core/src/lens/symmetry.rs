//! How a form in the plane is continued out of it: as it is, or as a body of revolution.

use serde::{Deserialize, Serialize};

use crate::wave::Dimension;

/// What a form z(x) is in space.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Symmetry {
    /// The form of a sheet, the same in every plane parallel to it; x is the distance from the axis to either side.
    #[default]
    Plane,
    /// A body of revolution in a close packing: x is the distance from the axis all round it. Rays in a plane through the axis
    /// stay in that plane, so that faces and rays are those of the sheet; what is weighed differs.
    Axis,
}

impl Symmetry {
    /// Which part of what is struck up to a distance `whole` from the axis (m) lies between two distances (m): of a width
    /// (x₂ − x₁)/w, of a disc (x₂² − x₁²)/w².
    pub fn struck(self, [from, to]: [f64; 2], whole: f64) -> f64 {
        match self {
            Self::Plane => (to - from) / whole,
            Self::Axis => (to - from) * (to + from) / (whole * whole),
        }
    }

    /// The packing whose wave-speed bound holds: the hexagonal sheet, or a close packing.
    pub const fn dimension(self) -> Dimension {
        match self {
            Self::Plane => Dimension::Two,
            Self::Axis => Dimension::Three,
        }
    }

    /// How far the matter at a distance `x` (m) reaches out of the half plane x ≥ 0: both halves of a sheet count 2, of a body the
    /// circle 2 π x (m).
    fn out_of_plane(self, x: f64) -> f64 {
        match self {
            Self::Plane => 2.0,
            Self::Axis => 2.0 * std::f64::consts::PI * x,
        }
    }

    /// Sites on a unit of area or volume, for spheres of a `diameter` (m): 2/(√3 D²) on an area (1/m²),
    /// √2/D³ in a volume (1/m³).
    pub fn sites(self, diameter: f64) -> f64 {
        match self {
            Self::Plane => 2.0 / (3.0_f64.sqrt() * diameter * diameter),
            Self::Axis => 2.0_f64.sqrt() / diameter.powi(3),
        }
    }

    /// Area (m²) of both halves of a sheet, or volume (m³) of a body, between two distances from the axis (m), whose `thickness`
    /// (m) at a distance is given. Simpson's rule in so many parts as make a kink of a face one part in 10⁷.
    pub(super) fn extent(self, [from, to]: [f64; 2], thickness: impl Fn(f64) -> f64) -> f64 {
        const PARTS: u32 = 4096;
        let step = (to - from) / f64::from(PARTS);
        let at = |k: u32| {
            let x = from + step * f64::from(k);
            let weight = if k == 0 || k == PARTS { 1.0 } else { f64::from(2 + 2 * (k % 2)) };
            weight * thickness(x).max(0.0) * self.out_of_plane(x)
        };
        (0..=PARTS).map(at).sum::<f64>() * step / 3.0
    }
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;

    /// Rings of a disc: areas over that of the disc; parts sum to the whole.
    #[test]
    fn the_struck_part_is_a_width_or_an_area() {
        let (a, b, w) = (2.0, 5.0, 8.0);
        assert_eq!(Symmetry::Plane.struck([a, b], w), 3.0 / 8.0);
        let ring = PI * (b * b - a * a) / (PI * w * w);
        assert!((Symmetry::Axis.struck([a, b], w) / ring - 1.0).abs() < 1e-15);
        for symmetry in [Symmetry::Plane, Symmetry::Axis] {
            let parts = [[0.0, a], [a, b], [b, w]].map(|part| symmetry.struck(part, w));
            assert!((parts.iter().sum::<f64>() - 1.0).abs() < 1e-15);
        }
    }

    /// A cap of height h of a sphere of radius R has the volume π h² (3 R − h)/3, a segment of a circle the area
    /// R² acos(1 − h/R) − (R − h) √(2 R h − h²). Their edge is no kink, as both end at an angle: Simpson's rule leaves 10⁻⁹.
    #[test]
    fn a_cap_has_its_volume_and_a_segment_its_area() {
        let (r, h): (f64, f64) = (20.0, 6.0);
        let reach = (2.0 * r * h - h * h).sqrt();
        let thickness = |x: f64| (r * r - x * x).sqrt() - (r - h);
        let cap = PI * h * h * (3.0 * r - h) / 3.0;
        let segment = r * r * (1.0 - h / r).acos() - (r - h) * reach;
        assert!((Symmetry::Axis.extent([0.0, reach], thickness) / cap - 1.0).abs() < 1e-9);
        assert!((Symmetry::Plane.extent([0.0, reach], thickness) / segment - 1.0).abs() < 1e-9);
    }

    /// Spheres of one diameter fill π/√12 of a sheet's plane and π/√18 of a close packing.
    #[test]
    fn sites_fill_the_packing_fraction() {
        let d = 0.3_f64;
        assert!((Symmetry::Plane.sites(d) * PI * d * d / 4.0 - PI / 12.0_f64.sqrt()).abs() < 1e-14);
        assert!((Symmetry::Axis.sites(d) * PI * d.powi(3) / 6.0 - PI / 18.0_f64.sqrt()).abs() < 1e-14);
    }
}
