//! Files that people write: TOML with quantities in units, and what a wrong one hears.
//!
//! Design files and rig files share this: the reader that knows where every value stands, and a [`DocumentError`] that names
//! file, line, key, value, the rule broken and the way out. What the keys mean is known by those who read them.
//!
//! - `text`: from a path to text; `syntax`: text that is no TOML; `keys`: the file as written
//! - `value`: one value read as its key asks; `own`: the sections [materials.NAME]
//! - `all`: everything that is wrong, told at once
//! - `kind`: what kind of file it is; `error`: what a refused file hears

mod all;
mod error;
mod keys;
mod kind;
mod own;
mod syntax;
mod text;
mod value;

pub use error::DocumentError;

pub(crate) use all::{all, others};
pub(crate) use error::{Source, did_you_mean, nearest};
#[cfg(test)]
pub(crate) use keys::assert_examples;
pub(crate) use keys::{OneOrSeveral, Section, Sections, Written, example, joined, read, section};
pub(crate) use kind::{Kind, expect};
pub(crate) use own::{OwnMaterials, chosen, materials};
pub(crate) use syntax::{key_at, parse, place};
pub(crate) use text::text;
pub(crate) use value::{Entry, Scope, is_plain_name};
