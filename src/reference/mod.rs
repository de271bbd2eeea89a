//! What every key of every file that people write means: type, unit, range, default, an example.
//!
//! The tables stand beside this file, one for each kind; what a choice may be is named by the type that reads it, and examples are those of
//! the readers' messages. `granulens keys`, `granulens schema` and docs/keys.md are made of it.
//!
//! - `schema`: as JSON Schema, for editors; `page`: as a page of the book; `starter`: files to begin with
//! - `results`: what columns and keys of what commands write mean

mod page;
mod results;
mod schema;
mod starter;

pub use page::page;
pub use results::{Table, meaning, results_page, tables};
pub use starter::Starter;

use std::fmt;
use std::sync::OnceLock;

use serde::{Deserialize, Serialize};

use crate::contact::{Constants, LawKind};
use crate::dem::rig::SpringDashpot;
use crate::lattice::Cell;
use crate::lens::{Family, Raster};
use crate::search::Method;
use crate::study::STAGES;
use crate::{bed, design, document, setup};

/// A kind of file that people write.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FileKind {
    /// A lens design.
    Design,
    /// A rig.
    Rig,
    /// A granular bed.
    Bed,
    /// A study.
    Study,
    /// Own materials, which stand in designs and rigs.
    Materials,
}

impl FileKind {
    /// All of them, in the order of the book.
    pub const ALL: [Self; 5] = [Self::Design, Self::Rig, Self::Bed, Self::Study, Self::Materials];

    /// Its name on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Design => "design",
            Self::Rig => "rig",
            Self::Bed => "bed",
            Self::Study => "study",
            Self::Materials => "materials",
        }
    }

    /// The kind of that name.
    pub fn find(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|kind| kind.name() == name)
    }

    fn table(self) -> &'static str {
        match self {
            Self::Design => include_str!("design.toml"),
            Self::Rig => include_str!("rig.toml"),
            Self::Bed => include_str!("bed.toml"),
            Self::Study => include_str!("study.toml"),
            Self::Materials => include_str!("materials.toml"),
        }
    }

    fn examples(self) -> &'static [&'static str] {
        match self {
            Self::Design => design::EXAMPLES,
            Self::Rig => setup::EXAMPLES,
            Self::Bed => bed::EXAMPLES,
            Self::Study | Self::Materials => &[],
        }
    }

    /// All its keys.
    pub fn keys(self) -> &'static Keys {
        static TABLES: OnceLock<Vec<Keys>> = OnceLock::new();
        let tables = TABLES.get_or_init(|| Self::ALL.into_iter().map(Self::read).collect());
        &tables[self as usize]
    }

    fn read(self) -> Keys {
        let file: File = toml::from_str(self.table()).unwrap_or_default();
        let of = |section: &str, row: &Row| {
            let name = if section.is_empty() { row.name.clone() } else { format!("{section}.{}", row.name) };
            let value = |line: String| line.split_once(" = ").map_or(String::new(), |(_, value)| value.to_owned());
            let example = row.example.clone().or_else(|| document::example(self.examples(), &name).map(value));
            Key {
                name,
                takes: row.takes.clone(),
                choices: row.choices.as_ref().map_or(Vec::new(), Choices::names),
                range: row.range.clone(),
                required: row.required,
                default: row.default.clone(),
                example: example.unwrap_or_default(),
                meaning: row.meaning.clone(),
            }
        };
        let sections = file.section.iter().map(|section| {
            let own = section.key.iter();
            let shared = file.group.iter().filter(|group| section.uses.contains(&group.name));
            let shared = shared.flat_map(|group| &group.key);
            Section {
                name: section.name.clone(),
                many: section.many,
                required: section.required,
                about: section.about.clone(),
                keys: own.chain(shared).map(|row| of(&section.name, row)).collect(),
            }
        });
        Keys { title: file.title.clone(), about: file.about.clone(), sections: sections.collect() }
    }
}

impl fmt::Display for FileKind {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// The keys of a kind of file.
#[derive(Clone, Debug, Serialize)]
pub struct Keys {
    /// What such files are called.
    pub title: String,
    /// What they are for, and which commands take them.
    pub about: String,
    /// Their sections, the keys before the first one in a section without a name.
    pub sections: Vec<Section>,
}

impl Keys {
    /// Every key.
    pub fn all(&self) -> impl Iterator<Item = &Key> {
        self.sections.iter().flat_map(|section| &section.keys)
    }
}

/// A section of a file.
#[derive(Clone, Debug, Serialize)]
pub struct Section {
    /// Its name.
    pub name: String,
    /// Whether it is written as `[[name]]`, as often as wanted.
    pub many: bool,
    /// Whether it has to be there.
    pub required: bool,
    /// What it says.
    pub about: String,
    /// Its keys.
    pub keys: Vec<Key>,
}

/// A key.
#[derive(Clone, Debug, Serialize)]
pub struct Key {
    /// With its section, `crystal.diameter`.
    pub name: String,
    /// Its type, or the quantity whose unit is written with it.
    pub takes: String,
    /// What it may be, where that is a choice.
    pub choices: Vec<String>,
    /// Which values are allowed.
    pub range: String,
    /// Whether it has to be there.
    pub required: bool,
    /// What holds where it is left out.
    pub default: String,
    /// How it is written.
    pub example: String,
    /// What it says.
    pub meaning: String,
}

impl Key {
    /// In words: what it is, may be and is if left out.
    pub fn text(&self) -> String {
        let mut text = format!("{}\n  {}\n  takes     {}", self.name, self.meaning, self.takes);
        if !self.range.is_empty() {
            text += &format!(", {}", self.range);
        }
        if !self.choices.is_empty() {
            text += &format!("\n  one of    {}", self.choices.join(", "));
        }
        let usual = if self.required { "required" } else { &self.default };
        text += &format!("\n  default   {usual}\n");
        if !self.example.is_empty() {
            let name = self.name.rsplit('.').next().unwrap_or_default();
            text += &format!("  example   {name} = {}\n", self.example);
        }
        text
    }
}

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct File {
    title: String,
    about: String,
    section: Vec<SectionRow>,
    #[serde(default)]
    group: Vec<Group>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct SectionRow {
    name: String,
    about: String,
    #[serde(default)]
    many: bool,
    #[serde(default)]
    required: bool,
    #[serde(default)]
    uses: Vec<String>,
    key: Vec<Row>,
}

/// Keys that several sections share.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Group {
    name: String,
    #[expect(dead_code, reason = "says to who reads the table what the group is")]
    about: String,
    key: Vec<Row>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Row {
    name: String,
    takes: String,
    choices: Option<Choices>,
    #[serde(default)]
    range: String,
    #[serde(default)]
    required: bool,
    #[serde(default)]
    default: String,
    example: Option<String>,
    meaning: String,
}

/// What a choice may be: words, or the name of the type that has them.
#[derive(Deserialize)]
#[serde(untagged)]
enum Choices {
    Words(Vec<String>),
    Type(String),
}

impl Choices {
    fn names(&self) -> Vec<String> {
        let laws = || LawKind::ALL.iter().map(|law| law.name());
        let methods = || Method::all().map(Method::name);
        let names: Vec<&str> = match self {
            Self::Words(words) => words.iter().map(String::as_str).collect(),
            Self::Type(name) => match name.as_str() {
                "laws" => laws().collect(),
                "rig laws" => laws().chain([SpringDashpot::NAME]).collect(),
                "constants" => Constants::ALL.iter().map(|set| set.name()).collect(),
                "families" => Family::ALL.iter().map(|family| family.name()).collect(),
                "rasters" => Raster::ALL.iter().map(|raster| raster.name()).collect(),
                "methods" => methods().collect(),
                "stage methods" => methods().chain(STAGES.map(|(name, _)| name)).collect(),
                "packings" => {
                    let chains = Cell::<1>::ALL.iter().map(|cell| cell.name());
                    let sheets = Cell::<2>::ALL.iter().map(|cell| cell.name());
                    chains.chain(sheets).chain(Cell::<3>::ALL.iter().map(|cell| cell.name())).collect()
                }
                _ => Vec::new(),
            },
        };
        names.into_iter().map(str::to_owned).collect()
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use super::*;
    use crate::bed::BedFile;
    use crate::design::Design;
    use crate::setup::Setup;

    #[test]
    fn every_row_is_whole() {
        for kind in FileKind::ALL {
            assert!(!kind.keys().sections.is_empty(), "{kind}: {:?}", toml::from_str::<File>(kind.table()).err());
            for key in kind.keys().all() {
                assert!(!key.meaning.is_empty() && !key.example.is_empty(), "{kind}: {}", key.name);
                assert_ne!(key.required, !key.default.is_empty(), "{kind}: {} is required or has a default", key.name);
                assert_eq!(key.takes.ends_with("choice"), !key.choices.is_empty(), "{kind}: {}", key.name);
            }
        }
    }

    /// The readers' own tests hold their examples to the keys that they read.
    #[test]
    fn every_key_that_is_read_has_a_row() {
        for kind in [FileKind::Design, FileKind::Rig, FileKind::Bed] {
            for line in kind.examples() {
                let name = line.split(" = ").next().unwrap_or_default();
                let known = |key: &Key| match name.strip_prefix("*.") {
                    Some(shared) => key.name.ends_with(&format!(".{shared}")),
                    None => key.name == name,
                };
                let any_measure = name.starts_with("thresholds.");
                assert!(any_measure || kind.keys().all().any(known), "{kind}: {name}");
            }
        }
    }

    /// A file with one key set, or taken away.
    fn with(text: &str, key: &str, value: Option<toml::Value>) -> String {
        let mut file: toml::Table = text.parse().unwrap();
        let (section, name) = key.rsplit_once('.').unwrap_or(("", key));
        let mut table = &mut file;
        for part in section.split('.').filter(|part| !part.is_empty()) {
            let entry = table.entry(part).or_insert_with(|| toml::Table::new().into());
            table = match entry {
                toml::Value::Array(items) => items[0].as_table_mut().unwrap(),
                table => table.as_table_mut().unwrap(),
            };
        }
        match value {
            Some(value) => drop(table.insert(name.to_owned(), value)),
            None => drop(table.remove(name)),
        }
        file.to_string()
    }

    fn error(kind: FileKind, text: &str) -> Option<String> {
        let path = Path::new("file.toml");
        // Of repeated sections the first is meant.
        let told = |error: document::DocumentError| format!("{error} {}", error.help).replace("[1]", "");
        match kind {
            FileKind::Design => Design::parse(path, text).err().map(told),
            FileKind::Bed => BedFile::parse(path, text).err().map(told),
            _ => Setup::parse(path, text).err().map(told),
        }
    }

    /// What a choice may be is what the reader says when it hears another word; what is required is missed; ranges are kept.
    #[test]
    fn choices_ranges_and_what_is_required_are_those_of_the_reader() {
        for kind in [FileKind::Design, FileKind::Rig, FileKind::Bed] {
            let text = kind.starter().text;
            assert_eq!(error(kind, text), None, "{kind}");
            let file: toml::Table = text.parse().unwrap();
            for section in &kind.keys().sections {
                let mut written: Option<&toml::Value> = None;
                let mut table = Some(&file);
                for part in section.name.split('.').filter(|part| !part.is_empty()) {
                    written = table.and_then(|table| table.get(part));
                    table = written.and_then(toml::Value::as_table);
                }
                // Sections that the starter does not have are not begun here: what else they need would be missed first.
                if !section.name.is_empty() && (written.is_none() || section.name.starts_with("target.")) {
                    continue;
                }
                // What belongs to another kind of pattern or shape has no default here.
                for key in section.keys.iter().filter(|key| key.required || key.default != "-") {
                    if key.takes == "choice" && key.choices.len() > 1 {
                        let said = error(kind, &with(text, &key.name, Some("no-such-word".into()))).unwrap_or_default();
                        let foreign = said.contains("does not belong to");
                        for word in key.choices.iter().filter(|_| !foreign) {
                            assert!(said.contains(word.as_str()), "{kind}: {} may be {word}: {said}", key.name);
                        }
                    }
                    if key.required {
                        let said = error(kind, &with(text, &key.name, None)).unwrap_or_default();
                        assert!(said.contains(&key.name) && said.contains("missing"), "{kind}: {}: {said}", key.name);
                    }
                    let Some((low, high)) = key.range.split_once(" to ") else { continue };
                    let (Ok(low), Ok(high)) = (low.parse::<f64>(), high.parse::<f64>()) else { continue };
                    for outside in [low - 1.0, low - 1e-3, high + 1.0] {
                        let value = match key.takes.as_str() {
                            "whole" if outside.fract() != 0.0 => continue,
                            "whole" => toml::Value::Integer(outside as i64),
                            "number" => toml::Value::Float(outside),
                            _ => continue,
                        };
                        let said = error(kind, &with(text, &key.name, Some(value))).unwrap_or_default();
                        assert!(said.contains(&key.name), "{kind}: {} = {outside}: {said}", key.name);
                    }
                }
            }
        }
    }
}
