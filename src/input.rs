//! Files that are read: every one that a user names goes through here.
//!
//! A byte order mark, with which some editors and spreadsheets begin UTF-8, is skipped. What was read is remembered, so that
//! [`output`](crate::output) can leave it alone: no command replaces what it was given.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, PoisonError};

/// Why a file has no text.
#[derive(Debug, thiserror::Error)]
pub enum Unreadable {
    /// There is none of this name.
    #[error("no such file")]
    Missing,
    /// It is a folder.
    #[error("is a folder")]
    Folder,
    /// It is not UTF-8.
    #[error("is not UTF-8 text (byte {})", .valid + 1)]
    NotText {
        /// Its bytes.
        bytes: Vec<u8>,
        /// How many of them are UTF-8.
        valid: usize,
    },
    /// The system refuses.
    #[error("cannot be read: {0}")]
    Io(io::Error),
}

/// Files that were read, by the one name that each has without links.
static READ: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// The text of a file, without a byte order mark.
///
/// # Errors
/// See [`Unreadable`].
pub fn text(path: &Path) -> Result<String, Unreadable> {
    let bytes = std::fs::read(path).map_err(|error| match error.kind() {
        io::ErrorKind::NotFound => Unreadable::Missing,
        _ if path.is_dir() => Unreadable::Folder,
        _ => Unreadable::Io(error),
    })?;
    remember(path);
    let text = String::from_utf8(bytes).map_err(|error| {
        let valid = error.utf8_error().valid_up_to();
        Unreadable::NotText { bytes: error.into_bytes(), valid }
    })?;
    Ok(text.strip_prefix('\u{feff}').map(str::to_owned).unwrap_or(text))
}

/// Takes down that a command reads a file, by whatever way.
pub fn remember(path: &Path) {
    if let Ok(path) = path.canonicalize() {
        let mut read = READ.lock().unwrap_or_else(PoisonError::into_inner);
        if !read.contains(&path) {
            read.push(path);
        }
    }
}

/// Begins a command anew: what was read before is no longer what it was given. For programs that outlive one command.
pub fn forget() {
    READ.lock().unwrap_or_else(PoisonError::into_inner).clear();
}

/// A file in `place` that was read, or `place` itself.
pub(crate) fn read_in(place: &Path) -> Option<PathBuf> {
    let place = place.canonicalize().ok()?;
    let read = READ.lock().unwrap_or_else(PoisonError::into_inner);
    read.iter().find(|path| path.starts_with(&place)).cloned()
}
