//! Which material sits on which site (from the core), and layouts as files.
//!
//! - `file`: layouts as CSV, in and out

mod file;

pub use file::{LayoutFileError, read, write, write_full, write_json};
pub use granulens_core::layout::*;
