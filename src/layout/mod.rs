//! Which material sits on which site (from the core), and layouts as files.
//!
//! - `write`: as CSV and JSON; `read`: the half or the whole piece; `table`: lines and cells of any; `error`: what a refused file hears
//! - `space`: layouts of crystals in space; `any`: of either kind
//! - `extent`: the lattice that a file was written for; `piece`: the whole piece, both halves

mod any;
mod error;
mod extent;
mod piece;
mod read;
mod space;
mod table;
mod write;

pub use any::AnyLayout;
pub use error::LayoutFileError;
pub use extent::lattice_of;
pub use granulens_core::layout::*;
pub use piece::{PieceSphere, whole};
pub use read::{ReadLayout, read, read_noted, read_piece};
pub use space::{read_in_space, write_in_space, write_whole_in_space};
pub use write::{write, write_full, write_json, write_piece};
