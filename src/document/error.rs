//! What a refused file hears: file, line, key, value, the rule broken, and the way out.

use std::fmt;
use std::ops::Range;
use std::path::{Path, PathBuf};

use miette::{LabeledSpan, NamedSource, SourceCode};

/// Why a file was refused. Shown in one line, as `FILE:LINE: KEY = VALUE RULE.`; what to try is in `help`.
#[derive(Debug, thiserror::Error)]
pub struct DocumentError {
    /// The file, as it was named.
    pub file: PathBuf,
    /// The line, from 1, where there is one to blame.
    pub line: Option<usize>,
    /// The key with its sections, such as `crystal.rows`, where there is one to blame.
    pub key: Option<String>,
    /// Key, value and the rule they break, as a sentence.
    pub message: String,
    /// What to try, in whole sentences; empty where the message says it.
    pub help: String,
    more: Option<Box<More>>,
}

/// What few errors have, or what is large.
#[derive(Debug, Default)]
struct More {
    excerpt: Option<Excerpt>,
    others: Vec<DocumentError>,
}

/// The text with the place in it.
#[derive(Debug)]
struct Excerpt {
    text: NamedSource<String>,
    place: Range<usize>,
}

impl fmt::Display for DocumentError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}:", self.file.display())?;
        if let Some(line) = self.line {
            write!(f, "{line}:")?;
        }
        write!(f, " {}", self.message)
    }
}

impl miette::Diagnostic for DocumentError {
    fn help(&self) -> Option<Box<dyn fmt::Display + '_>> {
        (!self.help.is_empty()).then(|| Box::new(&self.help) as Box<dyn fmt::Display>)
    }

    fn related<'a>(&'a self) -> Option<Box<dyn Iterator<Item = &'a dyn miette::Diagnostic> + 'a>> {
        let others = self.others().iter().map(|other| other as &dyn miette::Diagnostic);
        (!self.others().is_empty()).then(|| Box::new(others) as Box<dyn Iterator<Item = _>>)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        self.excerpt().map(|excerpt| &excerpt.text as &dyn SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let place = self.excerpt()?.place.clone();
        Some(Box::new(std::iter::once(LabeledSpan::new(Some("here".to_owned()), place.start, place.len()))))
    }
}

impl DocumentError {
    /// The bytes of the text that it is about.
    pub(super) fn place(&self) -> Option<Range<usize>> {
        self.excerpt().map(|excerpt| excerpt.place.clone())
    }

    fn excerpt(&self) -> Option<&Excerpt> {
        self.more.as_ref()?.excerpt.as_ref()
    }

    /// What else is wrong with the file, in the order in which it is found.
    pub fn others(&self) -> &[Self] {
        self.more.as_ref().map_or(&[], |more| &more.others)
    }

    /// The same error with what else is wrong.
    pub(crate) fn with_others(mut self, others: Vec<Self>) -> Self {
        if !others.is_empty() {
            self.more.get_or_insert_default().others = others;
        }
        self
    }

    /// An error about a file as a whole.
    pub(crate) fn of_file(path: &Path, message: String, help: String) -> Self {
        Self { file: path.to_owned(), line: None, key: None, message, help, more: None }
    }
}

/// The text of a file: what every complaint points into.
#[derive(Clone, Copy)]
pub(crate) struct Source<'a> {
    pub path: &'a Path,
    pub text: &'a str,
    /// How each key of this kind of file is written.
    pub examples: &'static [&'static str],
}

impl Source<'_> {
    /// How a key, given with its sections, is written below the header of its section.
    pub fn example(&self, key: &str) -> Option<String> {
        super::keys::example(self.examples, key)
    }

    /// A complaint about the bytes `place` of the text, or, where they are not known, about the file.
    pub fn error(
        &self,
        place: Option<Range<usize>>,
        key: Option<&str>,
        message: String,
        help: String,
    ) -> DocumentError {
        let place = place.map(|place| self.within(place));
        DocumentError {
            file: self.path.to_owned(),
            line: place.as_ref().map(|place| line(self.text.as_bytes(), place.start)),
            key: key.map(str::to_owned),
            // A key or a text may hold line breaks of its own, written as \n.
            message: message.replace(char::is_control, " "),
            help,
            more: place.map(|place| {
                let text = NamedSource::new(self.path.display().to_string(), self.text.to_owned());
                Box::new(More { excerpt: Some(Excerpt { text, place }), others: Vec::new() })
            }),
        }
    }

    /// What is written at `place`, on one line and cut short if it is long.
    pub fn written(&self, place: Range<usize>) -> String {
        const LONGEST: usize = 60;
        let place = self.within(place);
        let line = self.text[place].split_whitespace().collect::<Vec<_>>().join(" ");
        if line.chars().count() <= LONGEST {
            return line;
        }
        line.chars().take(LONGEST).chain("...".chars()).collect()
    }

    /// The line that holds the byte `at`, without blanks at its ends.
    pub fn line_at(&self, at: usize) -> String {
        let at = self.within(at..at).start;
        let start = self.text[..at].rfind('\n').map_or(0, |end| end + 1);
        let end = self.text[at..].find('\n').map_or(self.text.len(), |end| at + end);
        self.written(start..end)
    }

    /// The place, cut to the text and to whole characters.
    fn within(&self, place: Range<usize>) -> Range<usize> {
        let whole =
            |at: usize| (0..=at.min(self.text.len())).rev().find(|&at| self.text.is_char_boundary(at)).unwrap_or(0);
        let start = whole(place.start);
        start..whole(place.end).max(start)
    }
}

/// The line, from 1, of the byte `at`. The end of the text belongs to its last line, even behind a final line break.
pub(crate) fn line(text: &[u8], at: usize) -> usize {
    let before = &text[..at.min(text.len())];
    let before = if at >= text.len() { before.strip_suffix(b"\n").unwrap_or(before) } else { before };
    before.iter().filter(|&&byte| byte == b'\n').count() + 1
}

/// The known name that was probably meant, where one is near enough.
pub(crate) fn nearest<'a>(name: &str, known: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    // Below this similarity of Jaro and Winkler the names of this crate are no longer each other's misspellings.
    const NEAR: f64 = 0.75;
    known
        .into_iter()
        .map(|candidate| (strsim::jaro_winkler(&name.to_lowercase(), &candidate.to_lowercase()), candidate))
        .filter(|(similarity, _)| *similarity > NEAR)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, candidate)| candidate)
}

/// "Did you mean ...? " before a list of what is known.
pub(crate) fn did_you_mean(near: Option<&str>) -> String {
    near.map_or(String::new(), |near| format!("Did you mean {near}? "))
}
