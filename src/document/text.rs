//! From a path to text.

use std::io::ErrorKind;
use std::path::{Path, PathBuf};

use super::error::{DocumentError, line, nearest};

/// The text of a file.
///
/// # Errors
/// The file cannot be read or is not UTF-8.
pub(crate) fn text(path: &Path) -> Result<String, DocumentError> {
    let bytes = std::fs::read(path).map_err(|error| unreadable(path, &error))?;
    String::from_utf8(bytes).map_err(|error| {
        let valid = error.utf8_error().valid_up_to();
        let mut refusal = DocumentError::of_file(
            path,
            format!("is not UTF-8 text (byte {}).", valid + 1),
            "Save the file as UTF-8; a design file is plain text.".to_owned(),
        );
        refusal.line = Some(line(error.as_bytes(), valid));
        refusal
    })
}

fn unreadable(path: &Path, error: &std::io::Error) -> DocumentError {
    let (message, help) = if error.kind() == ErrorKind::NotFound {
        let help = near_file(path).map_or_else(
            || "Check the path; it is taken from the current folder.".to_owned(),
            |near| format!("Did you mean {}?", near.display()),
        );
        ("no such file.".to_owned(), help)
    } else if path.is_dir() {
        ("is a folder.".to_owned(), "Name a design file in it.".to_owned())
    } else {
        (format!("cannot be read: {error}."), "Check the file and its permissions.".to_owned())
    };
    DocumentError::of_file(path, message, help)
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
