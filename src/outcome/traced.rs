//! What rays say of a design, to be stored and drawn.

use serde::{Deserialize, Serialize};

use super::{Method, Proposal};
use crate::lattice::Site;
use crate::target::Target;

/// The result of `trace`. Everything in SI, for the half x >= 0.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Traced {
    /// Format number of this structure.
    pub format: u32,
    /// Name of the design.
    pub name: String,
    /// What strikes the crystal, in words.
    pub impact: String,
    /// The crystal's sites, in the order of all per-site lists.
    pub sites: Vec<Site>,
    /// Sphere diameter (m).
    #[serde(rename = "diameter_m")]
    pub diameter: f64,
    /// Distance from the axis to the far mirror line (m).
    #[serde(rename = "half_width_m")]
    pub half_width: f64,
    /// Where energy is wanted and where it is not.
    pub target: Target,
    /// Names of the materials that `layout` counts: host first.
    pub materials: Vec<String>,
    /// For each site an index into the materials.
    pub layout: Vec<u8>,
    /// The lens; none where a layout was given, whose faces nobody knows.
    pub proposal: Option<Proposal>,
    /// The rays, from the axis to the far mirror line; none without a lens.
    pub rays: Vec<TracedRay>,
    /// Where rays are at equal times.
    pub wavefronts: Vec<Front>,
    /// The caustic: the lines that neighbouring rays touch.
    #[serde(rename = "caustic_m")]
    pub caustic: Vec<Vec<[f64; 2]>>,
    /// What comes to each focal region, in the order of the target.
    #[serde(default)]
    pub foci: Vec<TracedFocus>,
    /// The spot that rays make in the middle row of the focal region, and the smallest they make anywhere behind the lens; none of
    /// either where there are several regions.
    pub spots: [Option<TracedSpot>; 2],
    /// First arrival at each site by the eikonal equation on the lattice (s).
    #[serde(rename = "first_arrival_s")]
    pub first_arrival: Vec<f64>,
    /// Where the first arrival is at the same times as the wavefronts: unconnected pieces.
    pub isochrones: Vec<Front>,
    /// First arrival in the middle row of the focal region (s): by rays, where any come there, and by the eikonal equation, both
    /// at the wave-speed bound.
    #[serde(rename = "focal_arrival_s")]
    pub focal_arrival: [Option<f64>; 2],
    /// The same by the eikonal equation in a wave that decays, where that was asked for; first arrivals and isochrones are
    /// then those of that wave.
    #[serde(default, rename = "focal_arrival_decaying_s")]
    pub focal_arrival_decaying: Option<f64>,
    /// With what, and how, uniform crystals were simulated to find how the wave decays; the window is at least this one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub decay_method: Option<Method>,
    /// What to know before trusting a wave that decays.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<String>,
    /// How the wave decays in the uniform crystal of each material, where that was asked for.
    #[serde(default)]
    pub decays: Vec<TracedDecay>,
}

/// The spot diagram of one focal region: where the rays that are meant for it pass its middle row.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SpotDiagram {
    /// Depth of the middle row (m).
    #[serde(rename = "depth_m")]
    pub depth: f64,
    /// Edges of the region (m).
    #[serde(rename = "x_m")]
    pub x: [f64; 2],
    /// The strip of the struck width whose rays are meant for it (m).
    #[serde(rename = "strip_m")]
    pub strip: [f64; 2],
    /// Of each of these rays that comes to the depth: where it starts (m), where it passes (m), and when (s).
    pub passages: Vec<[f64; 3]>,
    /// Root of the mean squared distance of the passages from the centre, and the centre.
    pub spot: Option<TracedSpot>,
}

impl SpotDiagram {
    /// How many of the rays pass within the region.
    pub fn inside(&self) -> usize {
        self.passages.iter().filter(|[_, x, _]| (self.x[0]..=self.x[1]).contains(x)).count()
    }
}

/// What comes to one focal region, in its middle row.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TracedFocus {
    /// Where rays pass; without a lens there are none.
    #[serde(flatten)]
    pub rays: SpotDiagram,
    /// First arrival within it (s): by rays, where any come there, and by the eikonal equation, both at the wave-speed bound.
    #[serde(rename = "arrival_s")]
    pub arrival: [Option<f64>; 2],
    /// The same by the eikonal equation in a wave that decays, where that was asked for.
    #[serde(default, rename = "arrival_decaying_s", skip_serializing_if = "Option::is_none")]
    pub arrival_decaying: Option<f64>,
}

/// A wave that decays in the uniform crystal of a material, row by row from the struck one on.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TracedDecay {
    /// The material.
    pub material: String,
    /// Speed over the wave-speed bound.
    pub reached: Vec<f64>,
    /// Greatest force on a contact (N).
    #[serde(rename = "force_N")]
    pub force: Vec<f64>,
}

/// One ray.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TracedRay {
    /// Corners (x, z) (m).
    #[serde(rename = "points_m")]
    pub points: Vec<[f64; 2]>,
    /// Time at each of them (s).
    #[serde(rename = "times_s")]
    pub times: Vec<f64>,
    /// Why it did not come to the last row, if so.
    pub failure: Option<String>,
}

/// A wave at one time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Front {
    /// Time (s).
    #[serde(rename = "time_s")]
    pub time: f64,
    /// Lines of points (x, z) (m).
    #[serde(rename = "lines_m")]
    pub lines: Vec<Vec<[f64; 2]>>,
}

/// Where rays pass a depth.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct TracedSpot {
    /// Depth (m).
    #[serde(rename = "depth_m")]
    pub depth: f64,
    /// Mean distance from the crystal's axis (m).
    #[serde(rename = "centre_m")]
    pub centre: f64,
    /// Root of the mean squared distance from the centre (m).
    #[serde(rename = "radius_m")]
    pub radius: f64,
    /// Number of rays.
    pub rays: usize,
}
