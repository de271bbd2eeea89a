//! Append-only files of lines of JSON, each with its checksum: the journal, with a line for every evaluation, and what is kept beside it.
//!
//! The first line says what wrote it. A last line without its end, as a kill leaves it, is dropped. A line whose checksum
//! does not fit is not used: what it held is evaluated anew.

use std::fs::{File, OpenOptions};
use std::io::{Read as _, Write as _};
use std::marker::PhantomData;
use std::path::{Path, PathBuf};

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::{Entry, StudyError};

#[derive(Serialize, Deserialize)]
struct Header {
    journal: String,
    format: u32,
    version: String,
}

const FORMAT: u32 = 2;

/// What the lines of a ledger hold.
pub trait Line: Serialize + DeserializeOwned {
    /// What the first line calls such a file.
    const NAME: &'static str;
    /// The same in words.
    const WORDS: &'static str;
    /// What begins one.
    const BEGUN_BY: &'static str;
}

impl Line for Entry {
    const NAME: &'static str = "granulens-study";
    const WORDS: &'static str = "journal of a study";
    const BEGUN_BY: &'static str = "granulens study run";
}

fn header<T: Line>() -> Header {
    Header { journal: T::NAME.to_owned(), format: FORMAT, version: env!("CARGO_PKG_VERSION").to_owned() }
}

/// A JSON object with a last field for its checksum, and a line end.
pub(super) fn sealed(value: &impl Serialize) -> String {
    // Structs of texts and finite numbers: this cannot fail.
    let mut line = serde_json::to_string(value).unwrap_or_default();
    let crc = crc32fast::hash(line.as_bytes());
    line.pop();
    format!("{line},\"crc\":\"{crc:08x}\"}}\n")
}

/// The text before the checksum, if that fits.
pub(super) fn unsealed<T: DeserializeOwned>(line: &[u8]) -> Option<T> {
    let line = std::str::from_utf8(line).ok()?;
    let (body, seal) = line.rsplit_once(",\"crc\":\"")?;
    let body = format!("{body}}}");
    let found = seal.strip_suffix("\"}")?;
    (found == format!("{:08x}", crc32fast::hash(body.as_bytes()))).then(|| serde_json::from_str(&body).ok())?
}

/// What a ledger held.
#[derive(Clone, Debug, PartialEq)]
pub struct Loaded<T = Entry> {
    /// What its lines hold, in order: of a journal the evaluations.
    pub entries: Vec<T>,
    /// What was not as it should be.
    pub warnings: Vec<String>,
    /// Length in bytes of the whole lines.
    whole: u64,
}

/// Reads a ledger's bytes.
fn parse<T: Line>(path: &Path, bytes: &[u8]) -> Result<Loaded<T>, StudyError> {
    let whole = bytes.iter().rposition(|&byte| byte == b'\n').map_or(0, |end| end + 1);
    let mut loaded = Loaded { entries: Vec::new(), warnings: Vec::new(), whole: whole as u64 };
    if whole < bytes.len() {
        let torn = bytes.len() - whole;
        loaded.warnings.push(format!(
            "{}: the last line is torn, as a kill leaves it; its {torn} bytes are dropped",
            path.display()
        ));
    }
    if whole == 0 {
        // A kill within the very first line leaves the beginning of ours; anything else is someone else's file.
        return if sealed(&header::<T>()).as_bytes().starts_with(bytes) {
            Ok(loaded)
        } else {
            Err(foreign(path, format!("is no {}", T::WORDS)))
        };
    }
    let mut lines = bytes[..whole - 1].split(|&byte| byte == b'\n');
    let first: Header = lines
        .next()
        .and_then(unsealed)
        .ok_or_else(|| foreign(path, format!("begins with no whole first line of a {}", T::WORDS)))?;
    if first.journal != T::NAME {
        return Err(foreign(path, format!("is no {}", T::WORDS)));
    }
    if first.format != FORMAT {
        return Err(foreign(path, format!("has format {}, and this version reads format {FORMAT}", first.format)));
    }
    if first.version != env!("CARGO_PKG_VERSION") {
        let (theirs, ours) = (first.version, env!("CARGO_PKG_VERSION"));
        return Err(foreign(
            path,
            format!("was written by granulens {theirs}, and this is {ours}, whose numbers may differ"),
        ));
    }
    for (k, line) in lines.enumerate() {
        match unsealed(line) {
            Some(entry) => loaded.entries.push(entry),
            None => loaded.warnings.push(format!(
                "{}:{}: the line is damaged, its checksum does not fit; it is not used",
                path.display(),
                k + 2
            )),
        }
    }
    Ok(loaded)
}

fn foreign(path: &Path, message: String) -> StudyError {
    let message = format!("{message}; it is left alone. Choose another folder with --out, or move it away.");
    StudyError::Journal { path: path.to_owned(), message }
}

/// An append-only file that is being written. No other process can write it meanwhile.
#[derive(Debug)]
pub struct Ledger<T> {
    path: PathBuf,
    file: File,
    lines: PhantomData<T>,
}

/// The record of a study's evaluations.
pub type Journal = Ledger<Entry>;

impl<T: Line> Ledger<T> {
    /// Opens or begins one, and reads what it holds. A torn last line is cut off.
    ///
    /// # Errors
    /// A file that cannot be read or written, another process that writes it, a journal of another version.
    pub fn open(path: &Path) -> Result<(Self, Loaded<T>), StudyError> {
        let fail = |error: std::io::Error| failed::<T>(path, &error);
        if let Some(parent) = path.parent() {
            std::fs::create_dir_all(parent).map_err(fail)?;
        }
        let file = OpenOptions::new().read(true).append(true).create(true).open(path).map_err(fail)?;
        match file.try_lock() {
            Ok(()) => {}
            Err(std::fs::TryLockError::WouldBlock) => {
                let message = "another run is writing it. Wait for its end, or choose another folder with --out.";
                return Err(StudyError::Journal { path: path.to_owned(), message: message.to_owned() });
            }
            // A file system without locks.
            Err(std::fs::TryLockError::Error(_)) => {}
        }
        // From here on the lock goes with the journal, also where it turns out to be none.
        let mut journal = Self { path: path.to_owned(), file, lines: PhantomData };
        let mut bytes = Vec::new();
        journal.file.read_to_end(&mut bytes).map_err(fail)?;
        let loaded = parse(path, &bytes)?;
        if loaded.whole < bytes.len() as u64 {
            journal.file.set_len(loaded.whole).map_err(fail)?;
        }
        if loaded.whole == 0 {
            journal.write(&sealed(&header::<T>()))?;
        }
        Ok((journal, loaded))
    }

    /// Reads one, without changing it.
    ///
    /// # Errors
    /// A file that cannot be read, a journal of another version.
    pub fn read(path: &Path) -> Result<Loaded<T>, StudyError> {
        let bytes = std::fs::read(path).map_err(|error| failed::<T>(path, &error))?;
        parse(path, &bytes)
    }

    /// Reads one if there is one, without changing it.
    ///
    /// # Errors
    /// As [`read`](Self::read).
    pub fn read_if_there(path: &Path) -> Result<Loaded<T>, StudyError> {
        if path.exists() {
            Self::read(path)
        } else {
            Ok(Loaded { entries: Vec::new(), warnings: Vec::new(), whole: 0 })
        }
    }

    /// Adds lines at the end, in one write.
    ///
    /// # Errors
    /// What the file system refuses.
    pub fn append(&mut self, entries: &[T]) -> Result<(), StudyError> {
        if entries.is_empty() { Ok(()) } else { self.write(&entries.iter().map(sealed).collect::<String>()) }
    }

    fn write(&mut self, text: &str) -> Result<(), StudyError> {
        self.file.write_all(text.as_bytes()).map_err(|error| failed::<T>(&self.path, &error))
    }
}

/// A lock belongs to the open file, and a process that is just being started holds a copy of every open file of its parent until
/// it runs its own program. To close ours would leave the lock to that copy for as long; so it is given back in words.
impl<T> Drop for Ledger<T> {
    fn drop(&mut self) {
        // What cannot be unlocked was never locked, or goes with the process.
        let _ = self.file.unlock();
    }
}

fn failed<T: Line>(path: &Path, error: &std::io::Error) -> StudyError {
    let message = match error.kind() {
        std::io::ErrorKind::NotFound => format!("no such {}; {} begins one.", T::WORDS, T::BEGUN_BY),
        _ => format!("the {} cannot be read or written: {error}", T::WORDS),
    };
    StudyError::Journal { path: path.to_owned(), message }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_checksum_is_crc_32() {
        assert_eq!(crc32fast::hash(b"123456789"), 0xcbf4_3926);
    }

    /// A second handle on the same open file is what a process holds that another thread is just starting.
    #[test]
    fn the_lock_ends_with_the_journal_whoever_holds_a_copy_of_the_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("journal.jsonl");
        let journal = Journal::open(&path).unwrap().0;
        let inherited = journal.file.try_clone().unwrap();
        assert!(Journal::open(&path).unwrap_err().to_string().contains("another run"));
        drop(journal);
        drop(Journal::open(&path).unwrap());
        // A file that turns out to be no journal is not kept locked either.
        std::fs::write(&path, "dear diary\n").unwrap();
        assert!(Journal::open(&path).unwrap_err().to_string().contains("first line"));
        assert!(Journal::open(&path).unwrap_err().to_string().contains("first line"));
        drop(inherited);
    }

    /// With a checksum that fits, as another version would write it.
    #[test]
    fn other_versions_are_refused_with_words() {
        let path = Path::new("journal.jsonl");
        let refusal = |header: Header| parse::<Entry>(path, sealed(&header).as_bytes()).unwrap_err().to_string();
        let of = |format: u32, version: &str| Header { format, version: version.to_owned(), ..header::<Entry>() };
        assert!(refusal(of(3, "0.1.0")).contains("journal.jsonl: has format 3, and this version reads format 2"));
        assert!(refusal(of(2, "9.9.9")).contains("written by granulens 9.9.9"));
    }
}
