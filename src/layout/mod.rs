//! Which material sits on which site (from the core), and layouts as files.
//!
//! - `write`: as CSV and JSON; `read`: the half or the whole piece; `error`: what a refused file hears

mod error;
mod read;
mod write;

pub use error::LayoutFileError;
pub use granulens_core::layout::*;
pub use read::{ReadLayout, read, read_noted};
pub use write::{write, write_full, write_json};
