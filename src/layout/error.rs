//! What a refused layout hears: file, line, column, what was expected, and the way out.

use std::fmt;
use std::ops::Range;
use std::path::{Path, PathBuf};

use miette::{LabeledSpan, NamedSource, SourceCode};

/// Why a layout file was refused. Shown in one line, as `FILE:LINE: WHAT`; what to try is in `help`.
#[derive(Debug, thiserror::Error)]
#[error("{}:{} {message}", .path.display(), .line.map_or(String::new(), |line| format!("{line}:")))]
pub struct LayoutFileError {
    /// The file.
    pub path: PathBuf,
    /// The line, from 1, where there is one to blame.
    pub line: Option<u64>,
    /// The column of the table, where there is one to blame.
    pub key: Option<&'static str>,
    /// What was wrong, and what was expected.
    pub message: String,
    /// What to try.
    pub help: Option<String>,
    excerpt: Option<Box<Excerpt>>,
}

/// The text with the line in it.
#[derive(Debug)]
struct Excerpt {
    text: NamedSource<String>,
    place: Range<usize>,
}

impl miette::Diagnostic for LayoutFileError {
    fn help(&self) -> Option<Box<dyn fmt::Display + '_>> {
        self.help.as_ref().map(|help| Box::new(help) as Box<dyn fmt::Display>)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.excerpt.as_ref().map(|excerpt| &excerpt.text as &dyn SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let place = self.excerpt.as_ref()?.place.clone();
        Some(Box::new(std::iter::once(LabeledSpan::new(Some("here".to_owned()), place.start, place.len()))))
    }
}

impl LayoutFileError {
    pub(super) fn of_file(path: &Path, message: String, help: &str) -> Self {
        Self { path: path.to_owned(), line: None, key: None, message, help: Some(help.to_owned()), excerpt: None }
    }

    pub(super) fn trying(self, help: impl Into<String>) -> Self {
        Self { help: Some(help.into()), ..self }
    }
}

/// The text that a layout is read from: what every complaint points into.
#[derive(Clone, Copy)]
pub(super) struct Source<'a> {
    pub path: &'a Path,
    pub text: &'a str,
    /// What its columns are called.
    pub columns: &'static [&'static str],
}

impl Source<'_> {
    /// A complaint about the line that holds the byte `at`, or about one of its columns.
    pub fn error(&self, at: usize, key: Option<usize>, message: String) -> LayoutFileError {
        let line = self.text[at..].lines().next().unwrap_or_default().trim_end();
        // The cell, where commas separate cells only.
        let mut cells = line.split(',').scan(at, |begin, cell| {
            let place = *begin..*begin + cell.len();
            *begin = place.end + 1;
            Some(place)
        });
        let place = key.and_then(|key| cells.nth(key)).filter(|cell| !cell.is_empty());
        LayoutFileError {
            path: self.path.to_owned(),
            line: Some(self.line(at)),
            key: key.map(|key| self.columns[key]),
            message,
            help: None,
            excerpt: Some(Box::new(Excerpt {
                text: NamedSource::new(self.path.display().to_string(), self.text.to_owned()),
                place: place.unwrap_or(at..at + line.len()),
            })),
        }
    }

    /// The line, from 1, of the byte `at`.
    pub fn line(&self, at: usize) -> u64 {
        self.text[..at].bytes().filter(|&byte| byte == b'\n').count() as u64 + 1
    }

    /// Where a record begins: the reader gives the place behind the record before, which may be a comment or blank.
    pub fn begin(&self, position: Option<&csv::Position>) -> usize {
        let mut at = position.map_or(0, |position| position.byte() as usize).min(self.text.len());
        for line in self.text[at..].split_inclusive('\n') {
            if !line.starts_with('#') && !line.trim().is_empty() {
                break;
            }
            at += line.len();
        }
        at
    }
}
