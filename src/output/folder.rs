//! Folders of results, which appear only when they are complete.
//!
//! A folder keeps the checksums of its files: as a comment at the end of its page, or else as the key `files` of its manifest. By
//! them it is known again, and what was changed or added since.

use std::collections::BTreeMap;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use serde_json::Value;

use super::mark::digest;
use super::{OutputError, make_readable, parent_of};
use crate::input;

/// Pages, one of which a folder may have.
const PAGES: [&str; 2] = ["report.html", "impact.html"];
/// Files of JSON, one of which a folder has.
const MANIFESTS: [&str; 4] = ["manifest.json", "impact.json", "trial.json", "network.json"];
/// How the list begins at the end of a page.
const OPENING: &str = "<!-- granulens files\n";
const CLOSING: &str = "-->\n";
/// Under which key it stands in a manifest.
const FILES: &str = "files";

type Digests = BTreeMap<String, String>;

/// A folder in the making, beside the place where it will stand.
pub struct Folder {
    place: PathBuf,
    making: tempfile::TempDir,
}

impl Folder {
    /// Begins a folder. Found out at once rather than after the simulations: whether it can be written, and whether what
    /// stands there already may be replaced.
    ///
    /// # Errors
    /// See [`OutputError`].
    pub fn begin(place: &Path, force: bool) -> Result<Self, OutputError> {
        if place.exists() {
            match stands(place) {
                Stands::Foreign => return Err(OutputError::Foreign(place.to_owned())),
                Stands::Changed(file, what) if !force => {
                    return Err(OutputError::Changed { folder: place.to_owned(), file, what });
                }
                _ => {}
            }
            if let Some(read) = input::read_in(place) {
                return Err(OutputError::HoldsInput(place.to_owned(), read));
            }
            let here = std::env::current_dir();
            if place.canonicalize().is_ok_and(|place| here.is_ok_and(|here| here.starts_with(place))) {
                return Err(OutputError::Here(place.to_owned()));
            }
        }
        // A link to a folder stays one.
        let target = place.canonicalize().unwrap_or_else(|_| place.to_owned());
        let parent = parent_of(&target);
        let making = fs::create_dir_all(&parent)
            .and_then(|()| tempfile::Builder::new().prefix(".granulens-").tempdir_in(&parent))
            .map_err(|error| OutputError::io(place, error))?;
        Ok(Self { place: target, making })
    }

    /// Begins a folder beside `place`: its name with an ending, and with a number where that is taken by something else.
    ///
    /// # Errors
    /// See [`OutputError`].
    pub fn beside(place: &Path, ending: &str) -> Result<(PathBuf, Self), OutputError> {
        let named = |number: u32| {
            let mut name = place.as_os_str().to_owned();
            name.push(format!(".{ending}"));
            if number > 1 {
                name.push(format!("-{number}"));
            }
            PathBuf::from(name)
        };
        let free = |place: &PathBuf| !place.exists() || matches!(stands(place), Stands::Own);
        let place = (1..100).map(named).find(free).unwrap_or_else(|| named(1));
        Ok((place.clone(), Self::begin(&place, false)?))
    }

    /// Where to write meanwhile.
    pub fn path(&self) -> &Path {
        self.making.path()
    }

    /// Writes a file in it.
    ///
    /// # Errors
    /// What the system refuses.
    pub fn write(&self, name: &str, contents: &[u8]) -> Result<(), OutputError> {
        let path = self.path().join(name);
        fs::write(&path, contents).map_err(|error| OutputError::io(&self.place.join(name), error))
    }

    /// Puts the folder in its place; results that stood there are replaced.
    ///
    /// # Errors
    /// What the system refuses.
    pub fn finish(self) -> Result<(), OutputError> {
        let place = self.place;
        let attempt = || -> io::Result<()> {
            seal(self.making.path())?;
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
        attempt().map_err(|error| OutputError::io(&place, error))
    }
}

/// What stands in the place of a folder.
enum Stands {
    /// Nothing, or results that are as they were written.
    Own,
    /// Results, and a file in them that is a user's, in what way.
    Changed(String, &'static str),
    /// Something else.
    Foreign,
}

/// Whether results in a folder that fills as a run goes may be replaced: those that are listed must be as they were written. What
/// else stands there is not touched by such a run.
///
/// # Errors
/// [`OutputError::Changed`], [`OutputError::HoldsInput`].
pub fn check_folder(place: &Path, force: bool) -> Result<(), OutputError> {
    if let Some(read) = input::read_in(place).filter(|_| place.is_dir()) {
        return Err(OutputError::HoldsInput(place.to_owned(), read));
    }
    let Some(listed) = listed(place).filter(|_| !force) else { return Ok(()) };
    match changed(place, &listed) {
        Some((file, what)) => Err(OutputError::Changed { folder: place.to_owned(), file, what }),
        None => Ok(()),
    }
}

/// Takes down the checksums of the files of a folder that was filled where it stands.
///
/// # Errors
/// What the system refuses.
pub fn seal_folder(place: &Path) -> Result<(), OutputError> {
    seal(place).map_err(|error| OutputError::io(place, error))
}

fn stands(place: &Path) -> Stands {
    if !place.is_dir() {
        return Stands::Foreign;
    }
    let names = names(place, "").unwrap_or_default();
    if names.is_empty() && fs::read_dir(place).is_ok_and(|mut entries| entries.next().is_none()) {
        return Stands::Own;
    }
    let Some(listed) = listed(place) else {
        return match is_results(place) {
            true => Stands::Changed("what it holds".to_owned(), "was written by granulens 0.1, without checksums"),
            false => Stands::Foreign,
        };
    };
    if let Some((file, what)) = changed(place, &listed) {
        return Stands::Changed(file, what);
    }
    match names.into_iter().find(|name| !listed.contains_key(name)) {
        Some(added) => Stands::Changed(added, "was not written by granulens"),
        None => Stands::Own,
    }
}

/// A listed file that is no more as it was written.
fn changed(place: &Path, listed: &Digests) -> Option<(String, &'static str)> {
    let is_changed = |(name, crc): &(&String, &String)| {
        fs::read(place.join(name)).is_ok_and(|contents| digest(&unsealed(name, contents)) != **crc)
    };
    listed.iter().find(is_changed).map(|(name, _)| (name.clone(), "was changed since granulens wrote it"))
}

/// A folder as 0.1 wrote them, with a manifest, or with the numbers of an impact. Others write files of these names too.
fn is_results(place: &Path) -> bool {
    let holds = |name: &str, keys: &[&str]| {
        json(&place.join(name)).is_some_and(|value| keys.iter().all(|key| value.get(key).is_some()))
    };
    holds("manifest.json", &["format", "design", "integrator", "step_s"]) || holds("impact.json", &["final_depth_d"])
}

fn json(path: &Path) -> Option<Value> {
    serde_json::from_str(&fs::read_to_string(path).ok()?).ok()
}

/// Names of the files of a folder and of those in it, below `above`.
fn names(folder: &Path, above: &str) -> io::Result<Vec<String>> {
    let mut names = Vec::new();
    for entry in fs::read_dir(folder)? {
        let entry = entry?;
        let name = format!("{above}{}", entry.file_name().to_string_lossy());
        if entry.file_type()?.is_dir() {
            names.extend(self::names(&entry.path(), &format!("{name}/"))?);
        } else {
            names.push(name);
        }
    }
    names.sort();
    Ok(names)
}

/// A file's contents without the list of checksums that it may hold.
fn unsealed(name: &str, contents: Vec<u8>) -> Vec<u8> {
    let opening = OPENING.as_bytes();
    if PAGES.contains(&name)
        && let Some(at) = contents.windows(opening.len()).rposition(|bytes| bytes == opening)
        && contents.ends_with(CLOSING.as_bytes())
    {
        return contents[..at].to_vec();
    }
    if MANIFESTS.contains(&name)
        && let Ok(Value::Object(mut manifest)) = serde_json::from_slice(&contents)
        && manifest.remove(FILES).is_some()
    {
        return pretty(&Value::Object(manifest)).into_bytes();
    }
    contents
}

fn pretty(value: &Value) -> String {
    // Values that were read have string keys and finite numbers: this cannot fail.
    serde_json::to_string_pretty(value).unwrap_or_default() + "\n"
}

/// The checksums that a folder keeps.
fn listed(place: &Path) -> Option<Digests> {
    for page in PAGES {
        let Ok(text) = fs::read_to_string(place.join(page)) else { continue };
        let Some(at) = text.rfind(OPENING) else { continue };
        // Whatever was written behind it.
        let lines = text[at + OPENING.len()..].lines().take_while(|line| *line != CLOSING.trim_end());
        return lines.map(|line| line.split_once(' ').map(|(crc, name)| (name.to_owned(), crc.to_owned()))).collect();
    }
    MANIFESTS.iter().find_map(|name| {
        let manifest = json(&place.join(name))?;
        let files = manifest.get(FILES)?.as_object()?;
        files.iter().map(|(name, crc)| Some((name.clone(), crc.as_str()?.to_owned()))).collect()
    })
}

/// Takes down the checksums of all files of a folder, its page or manifest among them, without the list itself.
fn seal(place: &Path) -> io::Result<()> {
    let mut digests = Digests::new();
    for name in names(place, "")? {
        let contents = fs::read(place.join(&name))?;
        digests.insert(name.clone(), digest(&unsealed(&name, contents)));
    }
    if let Some(page) = PAGES.into_iter().find(|page| digests.contains_key(*page)) {
        let path = place.join(page);
        let mut contents = unsealed(page, fs::read(&path)?);
        contents.extend(OPENING.bytes());
        // A name cannot end the comment: only pages and records of our own naming stand here.
        digests.iter().for_each(|(name, crc)| contents.extend(format!("{crc} {name}\n").bytes()));
        contents.extend(CLOSING.bytes());
        return fs::write(path, contents);
    }
    let Some(name) = MANIFESTS.into_iter().find(|name| digests.contains_key(*name)) else { return Ok(()) };
    let path = place.join(name);
    let Some(Value::Object(mut manifest)) = json(&path) else { return Ok(()) };
    manifest.remove(FILES);
    // Of the manifest as it is read back: numbers may be written in another way.
    digests.insert(name.to_owned(), digest(pretty(&Value::Object(manifest.clone())).as_bytes()));
    manifest.insert(FILES.to_owned(), serde_json::to_value(&digests).unwrap_or_default());
    fs::write(path, pretty(&Value::Object(manifest)))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fill(place: &Path, force: bool, page: bool) -> Result<(), OutputError> {
        let folder = Folder::begin(place, force)?;
        folder.write("numbers.csv", b"a,b\n1,2\n")?;
        folder.write("manifest.json", b"{\"name\": \"x\", \"step_s\": 1e-7}\n")?;
        if page {
            folder.write("report.html", b"<html></html>\n")?;
        }
        folder.finish()
    }

    #[test]
    fn results_are_replaced_unless_a_user_has_been_there() {
        for page in [false, true] {
            let desk = tempfile::tempdir().unwrap();
            let place = desk.path().join("results");
            fill(&place, false, page).unwrap();
            fill(&place, false, page).unwrap();
            if page {
                let path = place.join("report.html");
                let longer = fs::read_to_string(&path).unwrap() + "\n";
                fs::write(&path, longer).unwrap();
                assert!(fill(&place, false, page).unwrap_err().to_string().contains("report.html"));
                fill(&place, true, page).unwrap();
            }
            for (name, text) in [("numbers.csv", "mine"), ("notes.txt", "mine"), ("manifest.json", "{\"name\": 2}")] {
                if page || name != "manifest.json" {
                    fs::write(place.join(name), text).unwrap();
                    let refused = fill(&place, false, page).unwrap_err();
                    assert!(refused.to_string().contains(name), "{refused}");
                    assert_eq!(fs::read_to_string(place.join(name)).unwrap(), text);
                    fill(&place, true, page).unwrap();
                }
            }
            assert_eq!(fs::read_dir(&place).unwrap().count(), if page { 3 } else { 2 }, "nothing is left");
            fill(&place, false, page).unwrap();
        }
    }

    #[test]
    fn what_is_no_folder_of_results_is_left_alone_by_force_too() {
        let desk = tempfile::tempdir().unwrap();
        let place = desk.path().join("home");
        fs::create_dir(&place).unwrap();
        fs::write(place.join("thesis.tex"), "mine").unwrap();
        assert!(matches!(fill(&place, true, true), Err(OutputError::Foreign(_))));
        let results = desk.path().join("results");
        fill(&results, false, true).unwrap();
        input::text(&results.join("numbers.csv")).unwrap();
        assert!(matches!(fill(&results, true, true), Err(OutputError::HoldsInput(..))));
    }
}
