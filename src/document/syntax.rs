//! Text that is no TOML, in words for someone who has not read the grammar.

use std::ops::Range;

use toml::Spanned;
use toml::de::{DeTable, DeValue};

use super::error::{DocumentError, Source};

/// Beginnings of the parser's complaints, what they mean, and what to try.
const FAULTS: &[(&[&str], &str, &str)] = &[
    (&["duplicate key"], "this key or section was given before", "Keep one of them."),
    (
        &[
            "string values must be quoted",
            "invalid boolean",
            "unquoted string",
            "missing opening quote",
            "unexpected key or value",
        ],
        "text and quantities must stand in quotes",
        "Write it like force = \"26 kN\" or name = \"thesis-lens\".",
    ),
    (
        &["invalid basic string", "invalid literal string", "invalid multi-line"],
        "the closing quote is missing",
        "Close the text with the quote it began with, on the same line.",
    ),
    (
        &["missing escaped value", "too few unicode"],
        "\\ in quotes begins a special character",
        "Write \\\\ for the character itself, or use single quotes.",
    ),
    (
        &["key with no value", "missing value", "missing assignment", "invalid key-value pair"],
        "a key needs = and a value",
        "Write one key = value on a line, like rows = 50.",
    ),
    (
        &[
            "missing comma",
            "unclosed array",
            "unclosed inline table",
            "extra comma",
            "missing key for inline table",
            "unexpected `=` in array",
        ],
        "here or just before, a bracket or brace is not closed, or a comma is missing or too many",
        "Write it like { rows = [30, 34], x = [\"0 D\", \"2.5 D\"] }.",
    ),
    (&["unclosed table"], "the name of the section is not closed", "Write it like [crystal]."),
    (&["unexpected leading zero"], "a number must not begin with a superfluous 0", "Leave out the 0."),
    (&["cannot recurse", "recursion limit"], "brackets stand too deep within brackets", "No key of a design needs it."),
];

/// Parses the text; only its syntax can be wrong.
pub(crate) fn parse<'a>(source: Source<'a>) -> Result<Spanned<DeTable<'a>>, DocumentError> {
    DeTable::parse(source.text).map_err(|error| {
        let complaint = error.message();
        let known = FAULTS.iter().find(|(begins, ..)| begins.iter().any(|begin| complaint.starts_with(begin)));
        let (fault, help) = known.map_or_else(
            || {
                let plain = complaint.split(", expected").next().unwrap_or(complaint);
                (
                    plain.split_whitespace().collect::<Vec<_>>().join(" "),
                    "Write one key = value on a line, like rows = 50.",
                )
            },
            |(_, fault, help)| ((*fault).to_owned(), *help),
        );
        let place = error.span().unwrap_or(0..0);
        let line = source.line_at(place.start);
        let message = if line.is_empty() {
            format!("cannot be read: {fault}.")
        } else {
            format!("{line} cannot be read: {fault}.")
        };
        source.error(Some(place), None, message, help.to_owned())
    })
}

/// Where `key`, such as `run.step`, stands with its value; or, where it is left out, the name of its section.
pub(crate) fn place(source: Source<'_>, key: &str) -> Option<Range<usize>> {
    let document = parse(source).ok()?;
    let mut table = document.get_ref();
    let mut place = None;
    for part in key.split('.') {
        let Some((name, value)) = table.iter().find(|(name, _)| name.get_ref().as_ref() == part) else { break };
        match value.get_ref() {
            DeValue::Table(inner) => {
                place = Some(name.span());
                table = inner;
            }
            _ => return Some(name.span().start..value.span().end),
        }
    }
    place
}

/// The key, with its sections, that stands at a place of the text.
pub(crate) fn key_at(text: &str, place: &Range<usize>) -> Option<String> {
    let table = DeTable::parse(text).ok()?;
    super::keys::find(table.get_ref(), place, "").map(|(key, _)| key)
}
