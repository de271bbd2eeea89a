//! Whole files and folders, written so that nothing of a user's is lost.
//!
//! A file appears when it is complete, by way of a temporary one beside it. One that stands there already is replaced only where
//! granulens wrote it and nobody changed it since, or where that is asked for by force; never, even so, where the same command
//! reads it. Devices, pipes and links are written through: who names a link means what it leads to. A folder is replaced as a whole, and only where it is one of
//! results whose files are as they were written.
//!
//! - `mark`: how what granulens wrote is told from what others did
//! - `folder`: folders of results

mod folder;
mod mark;

use std::fs;
use std::io::{self, Write as _};
use std::path::{Path, PathBuf};

pub use folder::{Folder, check_folder, seal_folder};
use mark::is_unchanged;
pub(crate) use mark::{digest, marked};

use crate::input;

/// Why nothing is written.
#[derive(Debug, thiserror::Error)]
pub enum OutputError {
    /// The command reads what it would replace.
    #[error("{}: is read by this command, and is not replaced by what it makes", .0.display())]
    Input(PathBuf),
    /// A file that others wrote or changed.
    #[error("{}: exists, and granulens did not write it or it was changed since; it is left alone", .0.display())]
    NotOurs(PathBuf),
    /// A file without the permission to be written.
    #[error("{}: exists and may not be written; it is left alone", .0.display())]
    ReadOnly(PathBuf),
    /// A folder of something else.
    #[error("{} exists and is no folder of results; it is left alone", .0.display())]
    Foreign(PathBuf),
    /// A folder of results in which something is a user's.
    #[error("{}: {file} {what}; the folder is left alone", .folder.display())]
    Changed {
        /// The folder.
        folder: PathBuf,
        /// What in it.
        file: String,
        /// In which way it is a user's.
        what: &'static str,
    },
    /// A folder that holds what the command reads.
    #[error("{}: holds {}, which this command reads; it is left alone", .0.display(), .1.display())]
    HoldsInput(PathBuf, PathBuf),
    /// A folder in which the program runs.
    #[error("{} is the current folder or holds it, and cannot be replaced", .0.display())]
    Here(PathBuf),
    /// The system refuses.
    #[error("{}: cannot be written: {}", .path.display(), reason(path, error))]
    Io {
        /// What was to be written.
        path: PathBuf,
        /// Why.
        error: io::Error,
    },
}

impl OutputError {
    pub(crate) fn io(path: &Path, error: io::Error) -> Self {
        Self::Io { path: path.to_owned(), error }
    }

    /// The file or folder that it is about.
    pub fn path(&self) -> &Path {
        match self {
            Self::Input(path) | Self::NotOurs(path) | Self::ReadOnly(path) | Self::Foreign(path) => path,
            Self::HoldsInput(path, _) | Self::Here(path) | Self::Io { path, .. } => path,
            Self::Changed { folder, .. } => folder,
        }
    }

    /// What to try.
    pub fn help(&self) -> &'static str {
        match self {
            Self::NotOurs(_) | Self::ReadOnly(_) | Self::Changed { .. } => {
                "Choose another place, or replace it with --force."
            }
            Self::Foreign(_) => "Choose another place with --out.",
            Self::Here(_) => "Name a folder in it with --out.",
            Self::Input(_) | Self::HoldsInput(..) | Self::Io { .. } => "Choose another place.",
        }
    }
}

/// Of a temporary file's error only the reason counts: its name is nothing the user gave.
fn reason(path: &Path, error: &io::Error) -> String {
    match path.ancestors().skip(1).find(|parent| parent.exists()) {
        _ if error.kind() == io::ErrorKind::IsADirectory => "it is a folder".to_owned(),
        Some(parent) if parent.is_file() => format!("{} is a file", parent.display()),
        _ => match error.raw_os_error() {
            Some(code) => io::Error::from_raw_os_error(code).to_string(),
            None => error.to_string(),
        },
    }
}

/// Where a file goes.
enum Place {
    /// It is put there as a whole; what stood there has these permissions.
    Whole(PathBuf, Option<fs::Permissions>),
    /// A device or a pipe: it is written to.
    Through(PathBuf),
}

/// Whether a file may be written there: found out before a simulation rather than after it.
///
/// # Errors
/// See [`OutputError`].
pub fn check(path: &Path, force: bool) -> Result<(), OutputError> {
    match place(path, force)? {
        Place::Through(_) => Ok(()),
        Place::Whole(target, _) => {
            let parent = parent_of(&target);
            let probed = fs::create_dir_all(&parent).and_then(|()| tempfile::NamedTempFile::new_in(&parent));
            probed.map(drop).map_err(|error| OutputError::io(path, error))
        }
    }
}

/// Writes a file as a whole. Where it stands there already, word for word, there is nothing to do.
///
/// # Errors
/// See [`OutputError`].
pub fn write(path: &Path, contents: &[u8], force: bool) -> Result<(), OutputError> {
    let place = match place(path, force) {
        Err(OutputError::Input(_) | OutputError::NotOurs(_) | OutputError::ReadOnly(_))
            if fs::read(path).is_ok_and(|found| found == contents) =>
        {
            return Ok(());
        }
        place => place?,
    };
    let written = match place {
        Place::Whole(target, permissions) => mark::with_mark(&target, contents, || put(&target, contents, permissions)),
        Place::Through(target) => fs::OpenOptions::new().write(true).open(target).and_then(|mut file| {
            file.write_all(contents)?;
            file.flush()
        }),
    };
    written.map_err(|error| OutputError::io(path, error))
}

/// Whether a folder that fills file by file may be used: one that is new or empty, or that holds one of the files by which those
/// of this kind are known.
///
/// # Errors
/// [`OutputError::Foreign`].
pub fn check_known(folder: &Path, known: &[&str]) -> Result<(), OutputError> {
    let is_empty = || fs::read_dir(folder).is_ok_and(|mut entries| entries.next().is_none());
    if !folder.exists() || is_empty() || known.iter().any(|name| folder.join(name).exists()) {
        return Ok(());
    }
    Err(OutputError::Foreign(folder.to_owned()))
}

/// Where a file of that name goes, if it may.
fn place(path: &Path, force: bool) -> Result<Place, OutputError> {
    let fail = |error| OutputError::io(path, error);
    // What stands there may be a file all the same, such as one to which output goes, open as it is.
    if ["/dev", "/proc"].iter().any(|folder| path.starts_with(folder)) && path.exists() {
        return Ok(Place::Through(path.to_owned()));
    }
    let found = match fs::metadata(path) {
        Ok(found) => found,
        Err(error) if error.kind() == io::ErrorKind::NotFound => {
            // Of a link that leads nowhere yet, the file appears where it leads to.
            let target = match fs::read_link(path) {
                Ok(target) => parent_of(path).join(target),
                Err(_) => path.to_owned(),
            };
            return Ok(Place::Whole(target, None));
        }
        Err(error) => return Err(fail(error)),
    };
    if found.is_dir() {
        return Err(fail(io::ErrorKind::IsADirectory.into()));
    }
    if !found.is_file() {
        return Ok(Place::Through(path.to_owned()));
    }
    let target = path.canonicalize().map_err(fail)?;
    if input::read_in(&target).is_some() {
        return Err(OutputError::Input(path.to_owned()));
    }
    // An empty file holds nothing that could be lost.
    if !force && found.len() > 0 {
        if found.permissions().readonly() {
            return Err(OutputError::ReadOnly(path.to_owned()));
        }
        if !is_link(path) && !is_unchanged(&target) {
            return Err(OutputError::NotOurs(path.to_owned()));
        }
    }
    Ok(Place::Whole(target, Some(found.permissions())))
}

/// Whether a name is that of a link.
fn is_link(path: &Path) -> bool {
    fs::symlink_metadata(path).is_ok_and(|found| found.is_symlink())
}

/// Writes a file of the program's own, with a name that nobody else would give it, such as one of a cache. It is there as a
/// whole or not at all, also after a power cut: what was there stays until the new one is whole.
///
/// # Errors
/// What the system refuses.
pub fn keep(path: &Path, contents: &[u8]) -> Result<(), OutputError> {
    put(path, contents, None).map_err(|error| OutputError::io(path, error))
}

/// As [`keep`], of contents that `write` gives piece by piece, so that they are never in memory as a whole.
///
/// # Errors
/// What the system refuses, or `write` gives up for.
pub fn keep_by(path: &Path, write: impl FnOnce(&mut dyn io::Write) -> io::Result<()>) -> Result<(), OutputError> {
    let gradually = |file: &mut fs::File| {
        let mut buffer = io::BufWriter::new(file);
        write(&mut buffer)?;
        buffer.flush()
    };
    put_by(path, gradually, None).map_err(|error| OutputError::io(path, error))
}

fn put(path: &Path, contents: &[u8], permissions: Option<fs::Permissions>) -> io::Result<()> {
    put_by(path, |file| file.write_all(contents), permissions)
}

fn put_by(
    path: &Path,
    write: impl FnOnce(&mut fs::File) -> io::Result<()>,
    permissions: Option<fs::Permissions>,
) -> io::Result<()> {
    let parent = parent_of(path);
    fs::create_dir_all(&parent)?;
    let mut temporary = tempfile::NamedTempFile::new_in(&parent)?;
    write(temporary.as_file_mut())?;
    temporary.as_file().sync_all()?;
    match permissions {
        Some(permissions) => fs::set_permissions(temporary.path(), permissions)?,
        None => make_readable(temporary.path())?,
    }
    temporary.persist(path)?;
    Ok(())
}

/// Temporary files and folders are private; results are not.
#[cfg(unix)]
fn make_readable(path: &Path) -> io::Result<()> {
    use std::os::unix::fs::PermissionsExt as _;
    let mode = if path.is_dir() { 0o755 } else { 0o644 };
    fs::set_permissions(path, fs::Permissions::from_mode(mode))
}

#[cfg(not(unix))]
fn make_readable(_: &Path) -> io::Result<()> {
    Ok(())
}

fn parent_of(path: &Path) -> PathBuf {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent.to_owned(),
        _ => PathBuf::from("."),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn desk() -> tempfile::TempDir {
        tempfile::tempdir().unwrap()
    }

    #[test]
    fn only_what_is_ours_and_unchanged_is_replaced() {
        let desk = desk();
        for (name, one, two) in [
            ("plain.json", "{\"a\": 1}".to_owned(), "{\"a\": 2}".to_owned()),
            ("marked.csv", marked("# a layout\nrow\n1\n".to_owned()), marked("# a layout\nrow\n2\n".to_owned())),
        ] {
            let path = desk.path().join(name);
            write(&path, one.as_bytes(), false).unwrap();
            write(&path, two.as_bytes(), false).unwrap();
            assert_eq!(fs::read_to_string(&path).unwrap(), two, "ours is replaced");
            let mine = format!("{two}\n# a note of my own\n");
            fs::write(&path, &mine).unwrap();
            assert!(matches!(check(&path, false), Err(OutputError::NotOurs(_))));
            assert!(matches!(write(&path, one.as_bytes(), false), Err(OutputError::NotOurs(_))));
            assert_eq!(fs::read_to_string(&path).unwrap(), mine, "{name}");
            write(&path, one.as_bytes(), true).unwrap();
            assert_eq!(fs::read_to_string(&path).unwrap(), one, "by force");
            write(&path, two.as_bytes(), false).unwrap();
        }
    }

    /// Killed behind any of its three steps, it leaves a file that is known to be ours.
    #[test]
    fn a_kill_leaves_nothing_that_is_not_known() {
        let desk = desk();
        let path = desk.path().join("numbers.json");
        write(&path, b"one", false).unwrap();
        let killed = mark::with_mark(&path, b"two", || Err(io::ErrorKind::Interrupted.into()));
        assert!(killed.is_err());
        check(&path, false).unwrap();
        fs::write(&path, "two").unwrap();
        check(&path, false).unwrap();
        write(&path, b"three", false).unwrap();
        fs::write(&path, "two").unwrap();
        assert!(check(&path, false).is_err(), "only the last is ours");
    }

    #[test]
    fn what_was_read_is_never_replaced() {
        let desk = desk();
        let path = desk.path().join("layout.csv");
        write(&path, marked("# ours\n1\n".to_owned()).as_bytes(), false).unwrap();
        input::text(&path).unwrap();
        for force in [false, true] {
            assert!(matches!(write(&path, b"new", force), Err(OutputError::Input(_))), "{force}");
        }
        #[cfg(unix)]
        {
            let link = desk.path().join("link");
            std::os::unix::fs::symlink("layout.csv", &link).unwrap();
            assert!(matches!(write(&link, b"new", true), Err(OutputError::Input(_))), "by another name");
        }
    }

    #[test]
    fn an_empty_file_is_nobodys_and_a_byte_order_mark_is_skipped() {
        let desk = desk();
        let path = desk.path().join("empty");
        fs::write(&path, "").unwrap();
        write(&path, b"whole", false).unwrap();
        let marked = desk.path().join("marked.toml");
        fs::write(&marked, "\u{feff}format = 1").unwrap();
        assert_eq!(input::text(&marked).unwrap(), "format = 1");
    }

    #[cfg(unix)]
    #[test]
    fn links_are_followed_and_stay_links_and_permissions_stay() {
        use std::os::unix::fs::{PermissionsExt as _, symlink};
        let desk = desk();
        let [real, link, new, dangling] = ["real", "link", "new", "dangling"].map(|name| desk.path().join(name));
        write(&real, b"old", false).unwrap();
        fs::set_permissions(&real, fs::Permissions::from_mode(0o600)).unwrap();
        symlink("real", &link).unwrap();
        symlink("new", &dangling).unwrap();
        write(&link, b"one", false).unwrap();
        write(&dangling, b"two", false).unwrap();
        for (link, real, text) in [(&link, &real, "one"), (&dangling, &new, "two")] {
            assert!(fs::symlink_metadata(link).unwrap().is_symlink());
            assert_eq!(fs::read_to_string(real).unwrap(), text);
        }
        assert_eq!(fs::metadata(&real).unwrap().permissions().mode() & 0o777, 0o600);
        // Who names a link means what it leads to, whoever wrote that; by its own name it is left alone.
        fs::write(&new, "a user's").unwrap();
        assert!(matches!(write(&new, b"five", false), Err(OutputError::NotOurs(_))));
        write(&dangling, b"five", false).unwrap();
        assert_eq!(fs::read_to_string(&new).unwrap(), "five");
        fs::set_permissions(&real, fs::Permissions::from_mode(0o400)).unwrap();
        assert!(matches!(write(&link, b"three", false), Err(OutputError::ReadOnly(_))));
        // Where the mark of a link's file stands, beside the file, it is found by the file's own name too.
        fs::set_permissions(&real, fs::Permissions::from_mode(0o600)).unwrap();
        write(&real, b"three", false).unwrap();
    }
}
