//! Data of first order: what a reader wants to know of a lens before anything is simulated.

use std::collections::BTreeMap;

use serde::{Deserialize, Serialize};

/// Where a lens, or a part of one, lies and how it is shaped.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Prescription {
    /// First row.
    pub apex_row: u32,
    /// Last row.
    pub back_row: u32,
    /// Radius of the curved face (m); of aspheric lenses the distance at which they gather, of graded slabs the focal length
    /// aimed at; none of prisms, and where several parts have each their own.
    #[serde(rename = "radius_m")]
    pub radius: Option<f64>,
    /// The family's own parameters by name, lengths in m and with `_m` at the end; of several parts each has its own.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub parameters: BTreeMap<String, f64>,
    /// Where its own axis lies (m from that of the crystal), of a part perhaps outside its strip; of several parts that of the first.
    #[serde(rename = "axis_m")]
    pub axis: f64,
    /// Greatest angle of a face against the rows (rad).
    #[serde(rename = "rim_angle_rad")]
    pub rim_angle: f64,
    /// Half aperture (m): how far it reaches from its axis. Of a part how much of its strip it covers.
    #[serde(rename = "aperture_m")]
    pub aperture: f64,
    /// Greatest extent along the wave (m).
    #[serde(rename = "thickness_m")]
    pub thickness: f64,
    /// Focal length (m) of rays close to its own axis: their distance from it over their slope behind the lens; negative if they
    /// spread. None if they stay parallel, where the axis lies outside the strip, and where several parts have each their own.
    #[serde(rename = "focal_length_m")]
    pub focal_length: Option<f64>,
}

/// What is known of a lens besides, from its rays.
#[derive(Clone, Debug, PartialEq)]
pub struct FirstOrder {
    /// Earliest and latest time (s) at which rays come to the middle row of a focal region within it.
    pub arrival: Option<[f64; 2]>,
    /// How many times more rays pass the focal region than without a lens, less what faces reflect: the fraction's gain times
    /// 4 Z Z′/(Z + Z′)² for each of two faces, Z = ρ V. It knows nothing of decay, which in metals outweighs it.
    pub gain: Option<f64>,
}
