//! Output folders and files that appear only when they are complete.

use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use granulens::outcome::Manifest;

use super::Common;
use super::console::pretty;
use super::failure::Failure;

/// Writes a file by way of a temporary one beside it, so that a file that was there stays until the new one is whole.
pub fn write_file(path: &Path, text: &str) -> Result<(), Failure> {
    write_bytes(path, text.as_bytes())
}

/// The same for what is no text.
pub fn write_bytes(path: &Path, contents: &[u8]) -> Result<(), Failure> {
    let attempt = || -> io::Result<()> {
        let parent = parent_of(path);
        fs::create_dir_all(&parent)?;
        let temporary = tempfile::NamedTempFile::new_in(&parent)?;
        fs::write(temporary.path(), contents)?;
        make_readable(temporary.path())?;
        temporary.persist(path)?;
        Ok(())
    };
    attempt().map_err(|error| Failure::write(path, &error))
}

/// Whether a file can be written there: found out before a simulation rather than after it.
pub fn probe(path: Option<&PathBuf>) -> Result<(), Failure> {
    let Some(path) = path else { return Ok(()) };
    let attempt = || -> io::Result<()> {
        if path.is_dir() {
            return Err(io::ErrorKind::IsADirectory.into());
        }
        let parent = parent_of(path);
        fs::create_dir_all(&parent)?;
        tempfile::NamedTempFile::new_in(&parent).map(drop)
    };
    attempt().map_err(|error| Failure::write(path, &error))
}

/// Writes one JSON value to the file of --out, where that is given.
pub fn write_json(common: &Common, value: &impl serde::Serialize) -> Result<(), Failure> {
    match &common.out {
        Some(path) => write_file(path, &pretty(value)),
        None => Ok(()),
    }
}

/// Temporary files are private; results are not.
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

/// A folder in the making, beside the place where it will stand.
pub struct Folder {
    place: PathBuf,
    making: tempfile::TempDir,
}

/// The file by which a folder of results is recognised.
const MARK: &str = "manifest.json";

impl Folder {
    /// Begins a folder. Found out at once rather than after the simulations: whether it can be written, and whether what
    /// stands there already is a folder of results, which alone is replaced.
    pub fn begin(place: &Path) -> Result<Self, Failure> {
        if place.exists() && !is_results(place) {
            return Err(Failure::input_with_help(
                format!("{} exists and is no folder of results; it is left alone", place.display()),
                "Choose another place with --out.",
            ));
        }
        if fs::canonicalize(place).is_ok_and(|place| std::env::current_dir().is_ok_and(|here| here.starts_with(place)))
        {
            return Err(Failure::input_with_help(
                format!("{} is the current folder or holds it, and cannot be replaced", place.display()),
                "Name a folder in it with --out.",
            ));
        }
        let parent = parent_of(place);
        let making = fs::create_dir_all(&parent)
            .and_then(|()| tempfile::Builder::new().prefix(".granulens-").tempdir_in(&parent))
            .map_err(|error| Failure::write(place, &error))?;
        Ok(Self { place: place.to_owned(), making })
    }

    /// Begins a folder beside `place`: its name with an ending, and with a number where that is taken by something else.
    pub fn beside(place: &Path, ending: &str) -> Result<(PathBuf, Self), Failure> {
        let named = |number: u32| {
            let mut name = place.as_os_str().to_owned();
            name.push(format!(".{ending}"));
            if number > 1 {
                name.push(format!("-{number}"));
            }
            PathBuf::from(name)
        };
        let free = |place: &PathBuf| !place.exists() || is_results(place);
        let place = (1..100).map(named).find(free).unwrap_or_else(|| named(1));
        Ok((place.clone(), Self::begin(&place)?))
    }

    /// Where to write meanwhile.
    pub fn path(&self) -> &Path {
        self.making.path()
    }

    /// Puts the folder in its place; results that stood there are replaced.
    pub fn finish(self) -> Result<(), Failure> {
        let place = self.place;
        let attempt = || -> io::Result<()> {
            make_readable(self.making.path())?;
            let made = self.making.keep();
            if !place.exists() {
                return fs::rename(made, &place);
            }
            let old = tempfile::Builder::new().prefix(".granulens-old-").tempdir_in(parent_of(&place))?;
            let aside = old.path().join("old");
            fs::rename(&place, &aside)?;
            // If the new one cannot take its place, the old one goes back.
            fs::rename(&made, &place).inspect_err(|_| {
                let _ = fs::rename(&aside, &place);
            })
        };
        attempt().map_err(|error| Failure::write(&place, &error))
    }
}

/// The file by which a folder of an impact on a bed is recognised, and a key that is always in it.
const IMPACT: (&str, &str) = ("impact.json", "final_depth_d");

/// A folder with a manifest of ours, or with the numbers of an impact, or an empty one. Others write files of these names too.
fn is_results(place: &Path) -> bool {
    let empty = || fs::read_dir(place).is_ok_and(|mut entries| entries.next().is_none());
    let manifest = || fs::read_to_string(place.join(MARK)).ok().map(|text| serde_json::from_str::<Manifest>(&text));
    let impact = || {
        let text = fs::read_to_string(place.join(IMPACT.0)).unwrap_or_default();
        serde_json::from_str::<serde_json::Value>(&text).is_ok_and(|value| value.get(IMPACT.1).is_some())
    };
    place.is_dir() && (matches!(manifest(), Some(Ok(_))) || impact() || empty())
}
