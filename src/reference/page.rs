//! The keys of all files as a page of the book.

use std::fmt::Write as _;

use super::{FileKind, Key};
use crate::search::Method;
use crate::study::STAGES;

/// The page docs/keys.md; a test holds the file to it.
pub fn page() -> String {
    let mut text = String::from(
        "# The keys of all files\n\nWhat `granulens keys` says, key by key: `granulens keys crystal.diameter`. Quantities are text with a unit, \
         `\"6.35 mm\"`, `\"26 kN\"`; `#` begins a comment. `granulens init KIND` writes a file to begin with, `granulens schema KIND` a JSON \
         Schema by which editors check files as they are written. Made by `granulens keys --page`.\n",
    );
    for kind in FileKind::ALL {
        let keys = kind.keys();
        let _ = write!(text, "\n## {}\n\n{}\n", keys.title, keys.about);
        for section in &keys.sections {
            let _ = match section.name.as_str() {
                "" => write!(text, "\n### At the top\n\n{}\n", section.about),
                name if section.many => write!(text, "\n### `[[{name}]]`\n\n{}\n", section.about),
                name => write!(text, "\n### `[{name}]`\n\n{}\n", section.about),
            };
            if section.keys.is_empty() {
                continue;
            }
            text += "\n| key | takes | default | example | meaning |\n|---|---|---|---|---|\n";
            for key in &section.keys {
                text += &row(key);
            }
            if kind == FileKind::Study && section.name == "stage" {
                text += "\n| method | what it does |\n|---|---|\n";
                let all = Method::all().map(|method| (method.name(), method.about())).chain(STAGES);
                for (name, about) in all {
                    let _ = writeln!(text, "| `{name}` | {about} |");
                }
            }
        }
    }
    text
}

fn row(key: &Key) -> String {
    let name = key.name.rsplit('.').next().unwrap_or_default();
    let mut takes = key.takes.clone();
    if !key.range.is_empty() {
        takes += &format!(", {}", key.range);
    }
    let mut meaning = key.meaning.clone();
    if !key.choices.is_empty() {
        meaning += &format!(" One of `{}`.", key.choices.join("`, `"));
    }
    let usual = if key.required { "**required**" } else { &key.default };
    format!("| `{name}` | {takes} | {usual} | `{}` | {meaning} |\n", key.example)
}

#[cfg(test)]
mod tests {
    /// After a change of keys: `granulens keys --page > docs/keys.md`.
    #[test]
    fn the_page_in_the_book_is_this_one() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/docs/keys.md");
        let stored = std::fs::read_to_string(path).unwrap();
        let differs = stored.lines().zip(super::page().lines()).find(|(a, b)| a != b).map(|(a, b)| format!("{a}\n{b}"));
        assert!(stored == super::page(), "granulens keys --page > docs/keys.md; {differs:?}");
    }
}
