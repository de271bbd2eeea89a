//! granulens designs *impact lenses*: packings of metal spheres whose material, sphere by sphere, is chosen so that an
//! impact wave is steered to where it does no harm.
//!
//! ```text
//! target + materials -> lens (rays, bound) -> layout -> sample -> dem -> score -> outcome -> search, study -> report
//! ```
//!
//! Each module uses only those above it:

pub mod units;
pub mod chance;
pub mod search;
pub mod real;
pub mod material;
pub mod document;
pub mod lattice;
pub mod target;
pub mod contact;
pub mod sample;
pub mod layout;
pub mod pattern;
pub mod wave;
pub mod ray;
pub mod lens;
pub mod dem;
pub mod bed;
pub mod score;
pub mod outcome;
pub mod design;
pub mod evaluate;
pub mod setup;
pub mod trial;
pub mod study;
pub mod export;
pub mod report;
pub mod reproduce;
