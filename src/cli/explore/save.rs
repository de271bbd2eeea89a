//! Design, layout and report as files: by the code of the command line, below the folder in which the program was started, and never
//! in the place of a file that is a user's.

use std::path::{Component, Path, PathBuf};

use granulens::evaluate::{Forces, compare};
use granulens::layout;
use granulens::output::{self, Folder};
use serde::Deserialize;
use serde_json::{Value, json};

use super::desk::read;
use super::scene::{Painted, comparison};
use super::server::Shared;
use crate::cli::failure::Failure;
use crate::cli::run::fill;

/// What is saved.
#[derive(Deserialize)]
#[serde(rename_all = "kebab-case")]
enum What {
    /// The text of the design file.
    Design,
    /// The simulated half.
    Layout,
    /// The whole piece.
    LayoutFull,
    /// The folder of `granulens run`.
    Report,
}

#[derive(Deserialize)]
pub struct Asked {
    what: What,
    /// Where, below the folder in which the program was started.
    path: String,
    text: String,
    #[serde(default)]
    layout: Option<Painted>,
    tab: String,
}

/// Writes it, and says where it stands.
pub fn save(asked: Asked, shared: &Shared) -> Result<Value, Failure> {
    let here = std::env::current_dir().map_err(|error| Failure::input(format!("the current folder: {error}")))?;
    let place = within(&here, &asked.path)?;
    let design = read(&asked.text, shared)?;
    match asked.what {
        What::Design => output::write(&place, asked.text.as_bytes(), false)?,
        What::Layout | What::LayoutFull => {
            let comparison = comparison(&design, asked.layout.as_ref())?;
            let text = match asked.what {
                What::Layout => layout::write(&comparison.subject),
                _ => layout::write_full(&comparison.subject),
            };
            output::write(&place, text.as_bytes(), false)?;
        }
        What::Report => {
            let job = shared.work.begin(&asked.tab, "report");
            let folder = Folder::begin(&place, false)?;
            let comparison = comparison(&design, asked.layout.as_ref())?.over(Forces::USUAL);
            let outcome = compare(&comparison, job.context())?;
            if outcome.arrangements.len() < comparison.len() || outcome.forces.is_empty() && outcome.speeds.is_empty() {
                return Err(Failure::Interrupted("the report was not finished, and nothing is written".to_owned()));
            }
            fill(&folder, &outcome, comparison.piece())?;
            folder.finish()?;
        }
    }
    Ok(json!({ "saved": asked.path }))
}

/// A place below a folder; links that lead out of it are followed to see that they do.
pub fn within(here: &Path, path: &str) -> Result<PathBuf, Failure> {
    let refused = |why: &str| {
        Err(Failure::input_with_help(
            format!("{path}: {why}"),
            "Name a place below the folder in which granulens explore was started, such as my-lens.toml.",
        ))
    };
    let asked = Path::new(path);
    let plain = |part: Component| matches!(part, Component::Normal(_) | Component::CurDir);
    if path.is_empty() || path.len() > 400 || path.contains('\0') || !asked.components().all(plain) {
        return refused("is no place below this folder");
    }
    let root = here.canonicalize().map_err(|error| Failure::input(format!("the current folder: {error}")))?;
    // The nearest ancestor that stands already: below it nothing can lead elsewhere.
    let standing = here.join(asked).ancestors().find_map(|place| place.canonicalize().ok());
    let is_link = std::fs::symlink_metadata(here.join(asked)).is_ok_and(|found| found.is_symlink());
    if !standing.is_some_and(|place| place.starts_with(&root)) || is_link && !here.join(asked).exists() {
        return refused("leads out of this folder");
    }
    // Without the folder's own name, as on the command line.
    Ok(asked.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_written_elsewhere() {
        let desk = tempfile::tempdir().unwrap();
        let [here, elsewhere] = ["here", "elsewhere"].map(|name| desk.path().join(name));
        for folder in [&here, &elsewhere] {
            std::fs::create_dir(folder).unwrap();
        }
        for good in ["a.toml", "./a.toml", "new/deep/a.toml", "with space.csv"] {
            assert!(within(&here, good).is_ok(), "{good}");
        }
        for bad in ["", "../a.toml", "new/../../a.toml", "/etc/passwd", "a\0b"] {
            assert!(within(&here, bad).is_err(), "{bad}");
        }
        #[cfg(unix)]
        {
            use std::os::unix::fs::symlink;
            symlink(&elsewhere, here.join("out")).unwrap();
            symlink(elsewhere.join("new.toml"), here.join("dangling")).unwrap();
            symlink(&here, here.join("in")).unwrap();
            assert!(within(&here, "out/a.toml").is_err() && within(&here, "dangling").is_err());
            assert!(within(&here, "in/a.toml").is_ok());
        }
    }
}
