//! The physics of impact lenses, and how good ones are searched for. Nothing here knows files, a clock on the wall, or a terminal.
//!
//! ```text
//! material, contact law, crystal -> dem: one impact, many designs, or anything a lab can build -> record
//! target + bound + rays -> lens -> layout;  record + target -> score;  search: numbers only
//! ```
//!
//! Each module uses only those above it.

mod context;
pub mod units;
pub mod stats;
pub mod period;
pub mod search;
pub mod real;
pub mod material;
pub mod lattice;
pub mod target;
pub mod contact;
pub mod sample;
pub mod layout;
pub mod pattern;
pub mod wave;
pub mod ray;
pub mod lens;
pub mod network;
pub mod motion;
pub mod dem;
pub mod bed;
pub mod score;

pub use context::{Context, Progress};
