//! granulens designs *impact lenses*: packings of metal spheres whose material, sphere by sphere, is chosen so that an
//! impact wave is steered to where it does no harm.
//!
//! ```text
//! target + materials -> lens (rays, bound) -> layout -> sample -> dem -> score -> outcome -> search, study -> report
//! ```
//!
//! Each module uses only those above it:

pub use granulens_core::{
    Context, Progress, contact, dem, lattice, lens, material, pattern, period, ray, real, sample, score, search, stats,
    target, units, wave,
};

mod memory;
pub mod input;
pub mod output;
pub mod document;
pub mod layout;
pub mod bed;
pub mod columns;
pub mod network;
pub mod motion;
pub mod outcome;
pub mod design;
pub mod evaluate;
pub mod setup;
pub mod run;
pub mod study;
pub mod reference;
pub mod export;
pub mod inside;
pub mod page;
pub mod report;
pub mod tolerance;
pub mod gate;
pub mod build;
pub mod measured;
pub mod reproduce;
