//! granulens designs *impact lenses*: packings of metal spheres whose material, sphere by sphere, is chosen so that an
//! impact wave is steered to where it does no harm.
//!
//! ```text
//! target + materials -> lens (rays, bound) -> layout -> sample -> dem -> score -> outcome -> report
//! ```
//!
//! Each module uses only those above it:

pub mod units;
pub mod real;
pub mod material;
pub mod lattice;
pub mod target;
pub mod contact;
pub mod sample;
pub mod layout;
pub mod lens;
pub mod dem;
pub mod outcome;
pub mod report;
