//! The journal: one line of JSON for every evaluation, each with its checksum.
//!
//! The first line says what wrote it. A last line without its end, as a kill leaves it, is dropped. A line whose checksum
//! does not fit is not used: what it held is evaluated anew.

use std::fs::{File, OpenOptions};
use std::io::{Read as _, Write as _};
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

const NAME: &str = "granulens-study";
const FORMAT: u32 = 2;

fn header() -> Header {
    Header { journal: NAME.to_owned(), format: FORMAT, version: env!("CARGO_PKG_VERSION").to_owned() }
}

/// A JSON object with a last field for its checksum, and a line end.
fn sealed(value: &impl Serialize) -> String {
    // Structs of texts and finite numbers: this cannot fail.
    let mut line = serde_json::to_string(value).unwrap_or_default();
    let crc = crc32fast::hash(line.as_bytes());
    line.pop();
    format!("{line},\"crc\":\"{crc:08x}\"}}\n")
}

/// The text before the checksum, if that fits.
fn unsealed<T: DeserializeOwned>(line: &[u8]) -> Option<T> {
    let line = std::str::from_utf8(line).ok()?;
    let (body, seal) = line.rsplit_once(",\"crc\":\"")?;
    let body = format!("{body}}}");
    let found = seal.strip_suffix("\"}")?;
    (found == format!("{:08x}", crc32fast::hash(body.as_bytes()))).then(|| serde_json::from_str(&body).ok())?
}

/// What a journal held.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Loaded {
    /// The evaluations, in order.
    pub entries: Vec<Entry>,
    /// What was not as it should be.
    pub warnings: Vec<String>,
    /// Length in bytes of the whole lines.
    whole: u64,
}

/// Reads a journal's bytes.
fn parse(path: &Path, bytes: &[u8]) -> Result<Loaded, StudyError> {
    let whole = bytes.iter().rposition(|&byte| byte == b'\n').map_or(0, |end| end + 1);
    let mut loaded = Loaded { whole: whole as u64, ..Loaded::default() };
    if whole < bytes.len() {
        let torn = bytes.len() - whole;
        loaded.warnings.push(format!(
            "{}: the last line is torn, as a kill leaves it; its {torn} bytes are dropped",
            path.display()
        ));
    }
    if whole == 0 {
        // A kill within the very first line leaves the beginning of ours; anything else is someone else's file.
        return if sealed(&header()).as_bytes().starts_with(bytes) {
            Ok(loaded)
        } else {
            Err(foreign(path, "is no journal of a study".to_owned()))
        };
    }
    let mut lines = bytes[..whole - 1].split(|&byte| byte == b'\n');
    let first: Header = lines
        .next()
        .and_then(unsealed)
        .ok_or_else(|| foreign(path, "begins with no whole first line of a study's journal".to_owned()))?;
    if first.journal != NAME || first.format != FORMAT {
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

/// A journal that is being written. No other process can write it meanwhile.
#[derive(Debug)]
pub struct Journal {
    path: PathBuf,
    file: File,
}

impl Journal {
    /// Opens or begins a journal, and reads what it holds. A torn last line is cut off.
    ///
    /// # Errors
    /// A file that cannot be read or written, another process that writes it, a journal of another version.
    pub fn open(path: &Path) -> Result<(Self, Loaded), StudyError> {
        let fail = |error: std::io::Error| failed(path, &error);
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
        let mut journal = Self { path: path.to_owned(), file };
        let mut bytes = Vec::new();
        journal.file.read_to_end(&mut bytes).map_err(fail)?;
        let loaded = parse(path, &bytes)?;
        if loaded.whole < bytes.len() as u64 {
            journal.file.set_len(loaded.whole).map_err(fail)?;
        }
        if loaded.whole == 0 {
            journal.write(&sealed(&header()))?;
        }
        Ok((journal, loaded))
    }

    /// Reads a journal, without changing it.
    ///
    /// # Errors
    /// A file that cannot be read, a journal of another version.
    pub fn read(path: &Path) -> Result<Loaded, StudyError> {
        let bytes = std::fs::read(path).map_err(|error| failed(path, &error))?;
        parse(path, &bytes)
    }

    /// Adds entries at the end, in one write.
    ///
    /// # Errors
    /// What the file system refuses.
    pub fn append(&mut self, entries: &[Entry]) -> Result<(), StudyError> {
        if entries.is_empty() { Ok(()) } else { self.write(&entries.iter().map(sealed).collect::<String>()) }
    }

    fn write(&mut self, text: &str) -> Result<(), StudyError> {
        self.file.write_all(text.as_bytes()).map_err(|error| failed(&self.path, &error))
    }
}

/// A lock belongs to the open file, and a process that is just being started holds a copy of every open file of its parent until
/// it runs its own program. To close ours would leave the lock to that copy for as long; so it is given back in words.
impl Drop for Journal {
    fn drop(&mut self) {
        // What cannot be unlocked was never locked, or goes with the process.
        let _ = self.file.unlock();
    }
}

fn failed(path: &Path, error: &std::io::Error) -> StudyError {
    let message = match error.kind() {
        std::io::ErrorKind::NotFound => "no such journal; granulens study run begins one.".to_owned(),
        _ => format!("the journal cannot be read or written: {error}"),
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
        let refusal = |header: Header| parse(path, sealed(&header).as_bytes()).unwrap_err().to_string();
        let of = |format: u32, version: &str| Header { format, version: version.to_owned(), ..header() };
        assert!(refusal(of(3, "0.1.0")).contains("journal.jsonl: has format 3, and this version reads format 2"));
        assert!(refusal(of(2, "9.9.9")).contains("written by granulens 9.9.9"));
    }
}
