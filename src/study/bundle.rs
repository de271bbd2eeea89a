//! A study with all its files, to be read elsewhere.

use std::path::Path;

use super::{Start, Study, StudyError};
use crate::document;

/// The files that a study is read from, each by a name and its text, so that they can be written into one folder elsewhere and mean
/// the same; the first is the study file. The seed is that of the study.
///
/// # Errors
/// A file that cannot be read any more.
pub fn bundle(study: &Study) -> Result<Vec<(String, String)>, StudyError> {
    let text = document::text(&study.path)?;
    // It was read before; what cannot be read now is said where it is read.
    let mut table = text.parse::<toml::Table>().unwrap_or_default();
    let mut files = vec![("design.toml".to_owned(), study.design().text().to_owned())];
    table.insert("design".to_owned(), "design.toml".into());
    table.insert("seed".to_owned(), toml::Value::Integer(study.seed as i64));
    let mut name = |path: &Path| -> Result<String, StudyError> {
        let name = format!("start-{}.csv", files.len());
        files.push((name.clone(), document::text(path)?));
        Ok(name)
    };
    let starts = study
        .starts
        .iter()
        .map(|start| match start {
            Start::Lens => Ok("lens".into()),
            Start::Random => Ok("random".into()),
            Start::File(path) => Ok(toml::Value::String(name(path)?)),
        })
        .collect::<Result<Vec<toml::Value>, StudyError>>()?;
    table.insert("start".to_owned(), toml::Value::Array(starts));
    // Forces of a command line take the place of the file's.
    if !study.forces.is_one() {
        table.insert("forces".to_owned(), toml::Value::Integer(study.forces.count() as i64));
        table.insert("band".to_owned(), format!("{} %", 100.0 * study.forces.band()).into());
    }
    files.insert(0, ("study.toml".to_owned(), table.to_string()));
    Ok(files)
}
