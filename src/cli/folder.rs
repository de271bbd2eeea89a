//! Where output goes: the rules of [`granulens::output`], as the options of a command line.

use std::path::{Path, PathBuf};

use granulens::output::{self, Folder};

use super::Common;
use super::console::pretty;
use super::failure::Failure;

/// Writes a file as a whole, if it may.
pub fn write_file(common: &Common, path: &Path, text: &str) -> Result<(), Failure> {
    write_bytes(common, path, text.as_bytes())
}

/// The same for what is no text.
pub fn write_bytes(common: &Common, path: &Path, contents: &[u8]) -> Result<(), Failure> {
    Ok(output::write(path, contents, common.force)?)
}

/// Whether a file can and may be written there: found out before a simulation rather than after it.
pub fn probe(common: &Common, path: Option<&PathBuf>) -> Result<(), Failure> {
    match path {
        Some(path) => Ok(output::check(path, common.force)?),
        None => Ok(()),
    }
}

/// Whether all these files can be written, each in a place of its own.
pub fn probe_all(common: &Common, paths: &[Option<&PathBuf>]) -> Result<(), Failure> {
    let given: Vec<&PathBuf> = paths.iter().copied().flatten().collect();
    if let Some(k) = (1..given.len()).find(|&k| given[..k].contains(&given[k])) {
        return Err(Failure::input_with_help(
            format!("{}: is named for two outputs", given[k].display()),
            "Give each a place of its own.",
        ));
    }
    given.into_iter().try_for_each(|path| probe(common, Some(path)))
}

/// Writes one JSON value to the file of --out, where that is given.
pub fn write_json(common: &Common, value: &impl serde::Serialize) -> Result<(), Failure> {
    match &common.out {
        Some(path) => write_file(common, path, &pretty(value)),
        None => Ok(()),
    }
}

/// Begins a folder of results, if it may stand there.
pub fn begin(common: &Common, place: &Path) -> Result<Folder, Failure> {
    Ok(Folder::begin(place, common.force)?)
}
