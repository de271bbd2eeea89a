//! The text of a study file while it is being checked.

use std::ops::Range;
use std::path::Path;

use super::StudyError;
use crate::document;
use crate::units::Dimension;

/// How keys are written, where one that is wrong has to be taken for right to find what else is wrong.
const EXAMPLES: &[&str] = &[
    "rows = [2, 4]",
    "materials = [\"440c\", \"brass-260\"]",
    "objective = { contrast = { maximise = 1 } }",
    "budget = 100",
    "method = \"local\"",
    "stage.method = \"local\"",
    "stage.evaluations = 100",
    "impact.force = \"26 kN\"",
    "impact.duration = \"20 us\"",
];

/// The text being checked.
#[derive(Clone, Copy)]
pub(super) struct Source<'a> {
    pub path: &'a Path,
    pub text: &'a str,
}

impl<'a> Source<'a> {
    /// As files that people write are read.
    pub fn document(&self) -> document::Source<'a> {
        document::Source { path: self.path, text: self.text, examples: EXAMPLES }
    }

    /// A complaint about a key, which stands at the beginning of its line, or, after that, anywhere in a line.
    pub fn fail(&self, key: &str, message: String) -> StudyError {
        let begins =
            |line: &str| line.trim_start().strip_prefix(key).is_some_and(|rest| rest.trim_start().starts_with('='));
        let holds = |line: &str| !line.trim_start().starts_with('#') && line.contains(key);
        let line = self.text.lines().position(begins).or_else(|| self.text.lines().position(holds));
        self.at(line, message)
    }

    /// A complaint about entry `k`, from 0, of a list of sections, `[[name]]`, or about a key of it.
    pub fn fail_in(&self, name: &str, k: usize, key: &str, message: String) -> StudyError {
        let heading = format!("[[{name}]]");
        let headings = self.text.lines().enumerate().filter(|(_, line)| line.trim_start().starts_with(&heading));
        let Some((begin, _)) = headings.clone().nth(k) else { return self.fail(name, message) };
        let of_key =
            self.text.lines().enumerate().skip(begin + 1).take_while(|(_, line)| !line.trim_start().starts_with('['));
        let found = of_key.into_iter().find(|(_, line)| {
            line.trim_start().strip_prefix(key).is_some_and(|rest| rest.trim_start().starts_with('='))
        });
        match found {
            Some((line, _)) => self.at(Some(line), message),
            // The key is missing.
            None => {
                let place = self.place(begin);
                self.document()
                    .error(Some(place), Some(&format!("{name}[{}].{key}", k + 1)), message, String::new())
                    .into()
            }
        }
    }

    /// A complaint about a key at the top that is not there.
    pub fn missing(&self, key: &str, message: String) -> StudyError {
        self.document().error(None, Some(key), message, String::new()).into()
    }

    /// A complaint about a line, from 0, where it is known.
    fn at(&self, line: Option<usize>, message: String) -> StudyError {
        let place = line.map(|line| self.place(line));
        let key = place.as_ref().and_then(|place| document::key_at(self.text, place));
        self.document().error(place, key.as_deref(), message, String::new()).into()
    }

    /// What a line, from 0, holds without blanks at its ends.
    fn place(&self, line: usize) -> Range<usize> {
        let start: usize = self.text.split_inclusive('\n').take(line).map(str::len).sum();
        let text = self.text[start..].lines().next().unwrap_or_default();
        let first = start + text.len() - text.trim_start().len();
        first..first + text.trim().len()
    }

    /// What the reader of TOML says, in a user's words.
    pub fn toml(&self, error: &toml::de::Error) -> StudyError {
        // The reader names types as the program does; a user knows numbers, text and lists.
        let mut message = error.message().trim_end_matches('.').replace('\n', " ");
        for (type_name, words) in [
            ("u64", "a whole number from 0 up"),
            ("u32", "a whole number from 0 up"),
            ("f64", "a number"),
            ("a string", "text in quotes"),
            ("a sequence", "a list"),
            ("usize", "a whole number from 0 up"),
        ] {
            message = message.replace(&format!("expected {type_name}"), &format!("expected {words}"));
        }
        // Before words are exchanged: a name between backticks, known ones behind it.
        let mut quoted = error.message().split('`').skip(1).step_by(2);
        let (named, known): (Option<&str>, Vec<&str>) = (quoted.next(), quoted.collect());
        let section = error.span().and_then(|span| document::key_at(self.text, &span));
        let (path, help) = if message.starts_with("missing field") {
            let path = named.map(|named| section.map_or(named.to_owned(), |section| format!("{section}.{named}")));
            (path, String::new())
        } else {
            let near = named.filter(|_| message.starts_with("unknown field"));
            let near = near.and_then(|named| document::nearest(named, known.iter().copied()));
            (section, document::did_you_mean(near).trim_end().to_owned())
        };
        let key = error.span().and_then(|span| {
            let line = self.text.get(..span.start)?.rfind('\n').map_or(0, |end| end + 1);
            let (key, _) = self.text.get(line..)?.lines().next()?.split_once('=')?;
            Some(key.trim()).filter(|key| !message.contains(key)).map(|key| format!("{key}: "))
        });
        let message = format!("{}{message}.", key.unwrap_or_default());
        self.document().error(error.span(), path.as_deref(), message, help).into()
    }

    /// A positive quantity with its unit.
    pub fn quantity(
        &self,
        dimension: Dimension,
        key: &str,
        text: &str,
        fail: impl Fn(String) -> StudyError,
    ) -> Result<f64, StudyError> {
        match dimension.parse(text) {
            Ok(value) if value > 0.0 => Ok(value),
            Ok(_) => Err(fail(format!("{key} = \"{text}\" must be positive."))),
            Err(error) => Err(fail(format!("{key}: {error}"))),
        }
    }
}
