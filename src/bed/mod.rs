//! Granular beds (from the core), as files.
//!
//! - `file`: the bed file, as written and as checked
//! - `frames`: every body and contact at moments of an impact
//! - `store`: prepared beds as files

mod file;
mod frames;
mod store;

pub(crate) use file::EXAMPLES;
pub use file::{BedFile, Origin};
pub use frames::{
    FramePlan, MIRROR, SI as FRAME_SI, UNITS as FRAME_UNITS, names as frame_names, read as read_frame,
    read_named as read_frame_named, texts_into as frame_texts_into,
};
pub use granulens_core::bed::*;
pub use store::{StoreError, read, write};
