//! From a path to text.

use std::path::{Path, PathBuf};

use super::error::{DocumentError, line, nearest};
use crate::input::{self, Unreadable};

/// The text of a file.
///
/// # Errors
/// The file cannot be read or is not UTF-8.
pub(crate) fn text(path: &Path) -> Result<String, DocumentError> {
    input::text(path).map_err(|error| unreadable(path, &error))
}

fn unreadable(path: &Path, error: &Unreadable) -> DocumentError {
    let help = match error {
        Unreadable::Missing => near_file(path).map_or_else(
            || "Check the path; it is taken from the current folder.".to_owned(),
            |near| format!("Did you mean {}?", near.display()),
        ),
        Unreadable::Folder => "Name a design file in it.".to_owned(),
        Unreadable::NotText { .. } => "Save the file as UTF-8; a design file is plain text.".to_owned(),
        Unreadable::Io(_) => "Check the file and its permissions.".to_owned(),
    };
    let mut refusal = DocumentError::of_file(path, format!("{error}."), help);
    if let Unreadable::NotText { bytes, valid } = error {
        refusal.line = Some(line(bytes, *valid));
    }
    refusal
}

/// The TOML file in the same folder whose name is most like that of `path`.
fn near_file(path: &Path) -> Option<PathBuf> {
    let wanted = path.file_name()?.to_str()?;
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let names: Vec<String> = std::fs::read_dir(folder)
        .ok()?
        .filter_map(|entry| entry.ok()?.file_name().into_string().ok())
        .filter(|name| name.ends_with(".toml"))
        .collect();
    nearest(wanted, names.iter().map(String::as_str)).map(|near| path.with_file_name(near))
}
