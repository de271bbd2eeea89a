//! What makes no sheet, and what stops one.

use super::GridError;
use crate::contact::OVERLAP_LIMIT;

/// A sheet that cannot be simulated.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SheetError {
    /// The grid itself.
    #[error(transparent)]
    Grid(#[from] GridError),
    /// More crystals than stand side by side, or none.
    #[error("{designs} crystals do not fit side by side into registers of {lanes}; simulate them in groups")]
    Designs {
        /// How many were given.
        designs: usize,
        /// How many fit.
        lanes: usize,
    },
    /// A crystal with another number of spheres than the grid has.
    #[error("crystal {design} names materials for {given} spheres; the grid has {spheres}")]
    Length {
        /// Which, from 1.
        design: usize,
        /// How many it names.
        given: usize,
        /// How many there are.
        spheres: usize,
    },
    /// More materials than the tables hold, or one that is not there.
    #[error("there are {materials} materials, and {used} is asked for; up to five fit, counted from 0")]
    Materials {
        /// How many there are.
        materials: usize,
        /// The greatest that a sphere asks for.
        used: usize,
    },
    /// A step that is no positive number.
    #[error("a step of {0} s must be positive")]
    Step(f64),
}

/// Why a sheet cannot be followed further.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum SheetStop {
    /// Spheres overlap beyond what contact laws say.
    #[error(
        "spheres overlap by {:.1} % of their diameter at {time_s:.3e} s, beyond the law's range of {:.0} %; the impact is too \
         strong, or the step too large", 100.0 * overlap_ratio, 100.0 * OVERLAP_LIMIT
    )]
    Overlap {
        /// Overlap over the diameter.
        overlap_ratio: f64,
        /// Time (s).
        time_s: f64,
    },
    /// The step is too large for the deepest contact, were it that of the stiffest and lightest pair.
    #[error("a step of {step_s:.3e} s is too large at {time_s:.3e} s, where contacts ask for {limit_s:.3e} s at most")]
    Step {
        /// The step (s).
        step_s: f64,
        /// What it may be (s).
        limit_s: f64,
        /// Time (s).
        time_s: f64,
    },
    /// A velocity is not a number any more.
    #[error("a velocity is not finite at {time_s:.3e} s; try a smaller step")]
    NotFinite {
        /// Time (s).
        time_s: f64,
    },
}
