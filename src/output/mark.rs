//! Marks: a checksum of what granulens wrote.
//!
//! Texts that begin with a comment of their own kind, layouts and beds, bear it at the end of this first line, wherever they are
//! moved. Formats without comments, or whose readers would stumble over one (JSON, tables that begin with their header, pictures that are
//! compared with what goes to standard output), have it in a hidden file beside them, `.NAME.granulens`. A file whose mark does
//! not fit, or that has none, is a user's: it is read as ever, but not replaced.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// What stands before the checksum in a first line.
const SIGN: &str = "; crc ";

/// The checksum of a file's contents, as in journals: CRC-32, in hexadecimal.
pub(crate) fn digest(contents: &[u8]) -> String {
    format!("{:08x}", crc32fast::hash(contents))
}

/// A text that begins with a comment, with its mark at the end of this line.
pub(crate) fn marked(text: String) -> String {
    let crc = digest(text.as_bytes());
    match text.split_once('\n') {
        Some((first, rest)) if first.starts_with('#') => format!("{first}{SIGN}{crc}\n{rest}"),
        _ => text,
    }
}

/// Whether a text bears a mark in itself, and then whether that fits.
fn own_mark(contents: &[u8]) -> Option<bool> {
    let end = contents.iter().position(|&byte| byte == b'\n')?;
    let first = std::str::from_utf8(&contents[..end]).ok()?;
    let (comment, crc) = first.rsplit_once(SIGN).filter(|(comment, crc)| comment.starts_with('#') && crc.len() == 8)?;
    let unmarked = [comment.as_bytes(), &contents[end..]].concat();
    Some(digest(&unmarked) == crc)
}

/// Where the mark of a file stands that cannot bear one.
fn beside(path: &Path) -> Option<PathBuf> {
    let mut name = std::ffi::OsString::from(".");
    name.push(path.file_name()?);
    name.push(".granulens");
    Some(path.with_file_name(name))
}

/// Writes a file with its mark, where it does not bear one. The mark comes first, beside that of what stands there, so that the file is
/// known again whenever the program is killed.
pub(super) fn with_mark(path: &Path, contents: &[u8], write: impl FnOnce() -> io::Result<()>) -> io::Result<()> {
    let Some(place) = beside(path).filter(|_| own_mark(contents).is_none()) else { return write() };
    let own = digest(contents) + "\n";
    let before = fs::read_to_string(&place).unwrap_or_default();
    super::put(&place, format!("{before}{own}").as_bytes(), None)?;
    write()?;
    super::put(&place, own.as_bytes(), None)
}

/// Whether granulens wrote a file, and it is as it was written.
pub(super) fn is_unchanged(path: &Path) -> bool {
    let Ok(contents) = fs::read(path) else { return false };
    own_mark(&contents).unwrap_or_else(|| {
        let known = beside(path).and_then(|place| fs::read_to_string(place).ok());
        known.is_some_and(|known| known.lines().any(|known| known == digest(&contents)))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_mark_fits_its_text_and_no_other() {
        let text = "# granulens layout\nrow,column\n1,2\n";
        let whole = marked(text.to_owned());
        assert!(whole.starts_with("# granulens layout; crc ") && whole.ends_with("\nrow,column\n1,2\n"), "{whole}");
        assert_eq!(own_mark(whole.as_bytes()), Some(true));
        // Whatever bit is turned over behind the sign, or before it.
        for at in 0..whole.len() {
            let mut changed = whole.clone().into_bytes();
            changed[at] ^= 1;
            assert_ne!(own_mark(&changed), Some(true), "{at}");
        }
        assert_eq!(own_mark(text.as_bytes()), None);
        assert_eq!(marked("row,column\n".to_owned()), "row,column\n", "a table without comments bears none");
    }
}
