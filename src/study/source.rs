//! The text of a study file while it is being checked.

use std::path::Path;

use super::StudyError;
use crate::units::Dimension;

/// The text being checked.
#[derive(Clone, Copy)]
pub(super) struct Source<'a> {
    pub path: &'a Path,
    pub text: &'a str,
}

impl Source<'_> {
    /// A complaint about a key, which stands at the beginning of its line, or, after that, anywhere in a line.
    pub fn fail(&self, key: &str, message: String) -> StudyError {
        let begins =
            |line: &str| line.trim_start().strip_prefix(key).is_some_and(|rest| rest.trim_start().starts_with('='));
        let holds = |line: &str| !line.trim_start().starts_with('#') && line.contains(key);
        let line = self.text.lines().position(begins).or_else(|| self.text.lines().position(holds));
        self.at(line.map(|line| line as u64 + 1), message)
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
        self.at(Some(found.map_or(begin, |(line, _)| line) as u64 + 1), message)
    }

    /// A complaint about a line, where it is known.
    pub fn at(&self, line: Option<u64>, message: String) -> StudyError {
        StudyError::File { path: self.path.to_owned(), line, message }
    }

    /// What the reader of TOML says, in a user's words.
    pub fn toml(&self, error: &toml::de::Error) -> StudyError {
        let line =
            error.span().map(|span| self.text[..span.start.min(self.text.len())].matches('\n').count() as u64 + 1);
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
        let key = error.span().and_then(|span| {
            let line = self.text.get(..span.start)?.rfind('\n').map_or(0, |end| end + 1);
            let (key, _) = self.text.get(line..)?.lines().next()?.split_once('=')?;
            Some(key.trim()).filter(|key| !message.contains(key)).map(|key| format!("{key}: "))
        });
        self.at(line, format!("{}{message}.", key.unwrap_or_default()))
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
