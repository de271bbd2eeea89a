//! Lens families, solved from a target, laid on the lattice.

use crate::material::Material;

/// What kind of lens is asked for, and what is already decided about it.
#[derive(Clone, Debug, PartialEq)]
pub struct LensRequest {
    /// Material of the lens; the crystal's host surrounds it.
    pub material: Material,
    /// First and last row that may hold lens material.
    pub rows: [u32; 2],
    /// Greatest angle of the curved face against the rows [rad]; at most 60 degrees unless asked for.
    pub max_interface_angle: f64,
    /// The row of the apex on the axis, where given.
    pub apex_row: Option<u32>,
    /// The last row of the lens (its flat face), where given.
    pub back_row: Option<u32>,
    /// Radius of the curved face [m], where given.
    pub radius: Option<f64>,
}
