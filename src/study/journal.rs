//! The journal: one line of JSON for every evaluation, each with its checksum.
//!
//! The first line says what wrote it. A last line without its end, as a kill leaves it, is dropped. A line whose checksum
//! does not fit is not used: what it held is evaluated anew.

use std::fs::{File, OpenOptions};
use std::io::{Read as _, Write as _};
use std::path::{Path, PathBuf};

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::StudyError;
use crate::evaluate::Marks;

/// One evaluation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Entry {
    /// Hash of everything that the scores depend on, in hexadecimal.
    pub key: String,
    /// The letters of the free sites, in hexadecimal: four sites to a digit for two letters, two for up to four, else one.
    pub layout: String,
    /// F (J)
    #[serde(rename = "F")]
    pub focal_mean: f64,
    /// P (J)
    #[serde(rename = "P")]
    pub protected_mean: f64,
    /// C = F/P
    #[serde(rename = "C")]
    pub contrast: Option<f64>,
    /// G = F/F(all host)
    #[serde(rename = "G")]
    pub focal_gain: Option<f64>,
    /// Q = P/P(all lens material)
    #[serde(rename = "Q")]
    pub protection: Option<f64>,
    /// Why the run ended early, if it did.
    pub stop: Option<String>,
}

impl Entry {
    /// Of an evaluation that was not interrupted.
    pub fn new(key: String, layout: String, marks: &Marks) -> Self {
        // JSON has no infinity; a run that a guard stopped may hold some.
        let finite = |value: f64| if value.is_finite() { value } else { 0.0 };
        let ratio = |value: Option<f64>| value.filter(|value| value.is_finite());
        Self {
            key,
            layout,
            focal_mean: finite(marks.focal_mean),
            protected_mean: finite(marks.protected_mean),
            contrast: ratio(marks.contrast),
            focal_gain: ratio(marks.focal_gain),
            protection: ratio(marks.protection),
            stop: marks.stop.as_ref().map(ToString::to_string),
        }
    }

    /// The letters of `count` free sites; none if the entry belongs to something else.
    pub fn choice(&self, count: usize, alphabet: u8) -> Option<Vec<u8>> {
        unpack(&self.layout, count, alphabet)
    }
}

/// Letters as hexadecimal digits: four sites to a digit for two letters, two for four, one for up to sixteen.
pub fn pack(letters: &[u8], alphabet: u8) -> String {
    let bits = bits(alphabet);
    let digit = |sites: &[u8]| {
        let value = sites.iter().enumerate().fold(0_u32, |value, (k, &letter)| value | u32::from(letter) << (k * bits));
        char::from_digit(value, 16).unwrap_or('?')
    };
    letters.chunks(4 / bits).map(digit).collect()
}

/// The letters of `count` sites; none if the text is no such.
pub fn unpack(text: &str, count: usize, alphabet: u8) -> Option<Vec<u8>> {
    let bits = bits(alphabet);
    let mut letters = Vec::with_capacity(count + 4);
    for digit in text.chars() {
        let value = digit.to_digit(16)?;
        letters.extend((0..4 / bits).map(|k| (value >> (k * bits) & ((1 << bits) - 1)) as u8));
    }
    let whole = letters.len() >= count && letters.len() - count < 4 / bits;
    letters.truncate(count);
    (whole && letters.iter().all(|&letter| letter < alphabet)).then_some(letters)
}

fn bits(alphabet: u8) -> usize {
    match alphabet {
        0..=2 => 1,
        3..=4 => 2,
        _ => 4,
    }
}

#[derive(Serialize, Deserialize)]
struct Header {
    journal: String,
    format: u32,
    version: String,
}

const NAME: &str = "granulens-study";
const FORMAT: u32 = 1;

fn header() -> Header {
    Header { journal: NAME.to_owned(), format: FORMAT, version: env!("CARGO_PKG_VERSION").to_owned() }
}

/// CRC-32 (IEEE 802.3), bit by bit: lines are short and simulations long.
fn crc(bytes: &[u8]) -> u32 {
    !bytes.iter().fold(!0_u32, |crc, &byte| {
        (0..8).fold(crc ^ u32::from(byte), |crc, _| if crc & 1 == 1 { crc >> 1 ^ 0xedb8_8320 } else { crc >> 1 })
    })
}

/// A JSON object with a last field for its checksum, and a line end.
fn sealed(value: &impl Serialize) -> String {
    // Structs of texts and finite numbers: this cannot fail.
    let mut line = serde_json::to_string(value).unwrap_or_default();
    let crc = crc(line.as_bytes());
    line.pop();
    format!("{line},\"crc\":\"{crc:08x}\"}}\n")
}

/// The text before the checksum, if that fits.
fn unsealed<T: DeserializeOwned>(line: &[u8]) -> Option<T> {
    let line = std::str::from_utf8(line).ok()?;
    let (body, seal) = line.rsplit_once(",\"crc\":\"")?;
    let body = format!("{body}}}");
    let found = seal.strip_suffix("\"}")?;
    (found == format!("{:08x}", crc(body.as_bytes()))).then(|| serde_json::from_str(&body).ok())?
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
        let mut file = OpenOptions::new().read(true).append(true).create(true).open(path).map_err(fail)?;
        match file.try_lock() {
            Ok(()) => {}
            Err(std::fs::TryLockError::WouldBlock) => {
                let message = "another run is writing it. Wait for its end, or choose another folder with --out.";
                return Err(StudyError::Journal { path: path.to_owned(), message: message.to_owned() });
            }
            // A file system without locks.
            Err(std::fs::TryLockError::Error(_)) => {}
        }
        let mut bytes = Vec::new();
        file.read_to_end(&mut bytes).map_err(fail)?;
        let loaded = parse(path, &bytes)?;
        if loaded.whole < bytes.len() as u64 {
            file.set_len(loaded.whole).map_err(fail)?;
        }
        let mut journal = Self { path: path.to_owned(), file };
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
        assert_eq!(crc(b"123456789"), 0xcbf4_3926);
    }

    #[test]
    fn letters_survive_packing() {
        for alphabet in 1..=16 {
            for count in 0..10 {
                let letters: Vec<u8> = (0..count).map(|k| (7 * k as u8 + 3) % alphabet).collect();
                let text = pack(&letters, alphabet);
                assert_eq!(unpack(&text, count, alphabet), Some(letters));
                assert_eq!(unpack(&text, count + 5, alphabet), None);
            }
        }
        assert_eq!(unpack("3", 1, 3), None);
        assert_eq!(unpack("x", 1, 2), None);
    }

    /// With a checksum that fits, as another version would write it.
    #[test]
    fn other_versions_are_refused_with_words() {
        let path = Path::new("journal.jsonl");
        let refusal = |header: Header| parse(path, sealed(&header).as_bytes()).unwrap_err().to_string();
        let of = |format: u32, version: &str| Header { format, version: version.to_owned(), ..header() };
        assert!(refusal(of(2, "0.1.0")).contains("journal.jsonl: has format 2, and this version reads format 1"));
        assert!(refusal(of(1, "9.9.9")).contains("written by granulens 9.9.9"));
    }
}
