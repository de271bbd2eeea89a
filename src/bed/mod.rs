//! Granular beds (from the core), as files.
//!
//! - `file`: the bed file, as written and as checked
//! - `store`: prepared beds as files

mod file;
mod store;

pub use file::{BedFile, Origin};
pub use granulens_core::bed::*;
pub use store::{StoreError, read, write};
