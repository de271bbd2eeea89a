//! Granular beds: settled packings of disks under gravity, and intruders that strike them (Kondic et al. 2012).
//!
//! Lengths are in mean diameters d, times in binary collision times τ_c = π √(d/(2 g k_n)), masses in that of a disk of
//! diameter d. Then k = π²/2 and g = π²/(2 k_n), whatever the grains are made of.
//!
//! - `grains`: what grains are like: stiffness, restitution, friction; and their laws
//! - `packing`: how they are laid out at first; `settle`: how they come to rest
//! - `measure`: volume fraction, coordination, pair correlation, surface
//! - `intruder`: what strikes them; `impact`: what follows; `drag`: what resists; `frame`: every body and contact at a moment; `sound`: how fast a push travels through a bed
//! - `ensemble`: many impacts, and what they come to on average

mod drag;
mod ensemble;
mod frame;
mod grains;
mod impact;
mod intruder;
mod measure;
mod packing;
mod settle;
mod sound;

pub use crate::dem::rig::Arm;
pub use drag::{Drag, Fitted, exponent};
pub use ensemble::{Case, Cell, Ensemble, Outcome, Rubbing, Scaling, scaling, summarise};
pub use frame::{End, Frame, FrameBody, FrameContact, Role};
pub use grains::{Damping, Grains, Surface};
pub use impact::{BedImpact, Course, Moment, Snapshot, Strike, stop_words, strike};
pub use intruder::{Body, Intruder, Outline};
pub use measure::{Measures, measure};
pub use packing::{Packing, Pile, Sides};
pub use settle::{SettleError, Settled, settle};
pub use sound::{Sound, SoundError, listen};

use serde::{Deserialize, Serialize};

/// One disk of a bed.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Disk {
    /// Centre (d); the second axis points up.
    pub centre: [f64; 2],
    /// Diameter (d).
    pub diameter: f64,
}

/// A bed at rest: grains between walls.
#[derive(Clone, Debug, PartialEq)]
pub struct Bed {
    /// The grains that move.
    pub grains: Vec<Disk>,
    /// The immobile disks of which walls are made.
    pub walls: Vec<Disk>,
    /// Width (d).
    pub width: f64,
    /// Whether the bed repeats itself sideways.
    pub periodic: bool,
}
