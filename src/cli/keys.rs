//! `granulens keys` and `schema`: what every key of every file means, and every column of results.

use granulens::reference::{FileKind, Key, Section, meaning, page, results_page};
use serde_json::json;

use super::Common;
use super::console::{emit, emit_json, pretty};
use super::failure::Failure;
use super::folder::{write_file, write_json};

/// Say what a key of a design, rig, bed or study file means, or a column of a result
///
/// By its name, or a part of it: granulens keys crystal.diameter, granulens keys friction, granulens keys focal_mean_J. Without one, all keys of a kind of
/// file are listed.
#[derive(clap::Args)]
pub struct KeysOf {
    /// A key with its section, such as crystal.diameter, or a part of it
    key: Option<String>,
    /// Only of this kind of file
    #[arg(long, value_name = "KIND", value_parser = kind)]
    kind: Option<FileKind>,
    /// All as the page of the book
    #[arg(long, conflicts_with_all = ["key", "kind"])]
    page: bool,
    /// What columns of tables and keys of JSON mean, as the page of the book
    #[arg(long, conflicts_with_all = ["key", "kind", "page"])]
    results: bool,
}

impl KeysOf {
    pub fn run(self, common: &Common) -> Result<(), Failure> {
        if self.page || self.results {
            emit(&if self.page { page() } else { results_page() });
            return Ok(());
        }
        let found = match &self.key {
            None => Found { keys: self.keys(), ..Found::default() },
            Some(name) => self.find(name)?,
        };
        let keys: Vec<_> = found.keys.iter().map(|(kind, key)| json!({ "file": kind.name(), "key": key })).collect();
        let sections: Vec<_> =
            found.sections.iter().map(|(kind, of)| json!({ "file": kind.name(), "section": of })).collect();
        let results: Vec<_> =
            found.result.iter().map(|(name, means)| json!({ "name": name, "meaning": means })).collect();
        let format = granulens::outcome::FORMAT;
        let list = json!({ "format": format, "keys": keys, "sections": sections, "results": results });
        write_json(common, &list)?;
        match common.json {
            true => emit_json(&list),
            false => emit(&found.words(self.key.is_some())),
        }
        Ok(())
    }

    /// All keys of the kinds that are asked for.
    fn keys(&self) -> Vec<(FileKind, &'static Key)> {
        self.kinds().flat_map(|kind| kind.keys().all().map(move |key| (kind, key))).collect()
    }

    fn kinds(&self) -> impl Iterator<Item = FileKind> {
        let wanted = self.kind;
        FileKind::ALL.into_iter().filter(move |kind| wanted.is_none_or(|wanted| wanted == *kind))
    }

    /// What is called so: keys and names of results, or else keys of which it is a part.
    fn find(&self, name: &str) -> Result<Found, Failure> {
        let all = self.keys();
        // As a message writes it: pattern[2].angle.
        let name: String = name.split('[').map(|part| part.split_once(']').map_or(part, |(_, rest)| rest)).collect();
        let that = |fits: &dyn Fn(&Key) -> bool| all.iter().copied().filter(|(_, key)| fits(key)).collect::<Vec<_>>();
        let of_kind = |kind: FileKind| kind.keys().sections.iter().map(move |section| (kind, section));
        // A section whose keys are names of materials has none to list.
        let open = self.kinds().flat_map(of_kind).filter(|(_, of)| of.keys.is_empty() && of.name == name);
        let meaning = meaning(&name).filter(|_| self.kind.is_none());
        let mut found = Found {
            keys: that(&|key| key.name == name || key.name.ends_with(&format!(".{name}"))),
            sections: open.collect(),
            result: meaning.map(|meaning| (name.clone(), meaning)),
        };
        if found.keys.is_empty() && found.sections.is_empty() && found.result.is_none() {
            found.keys = that(&|key| key.name.contains(&name));
        }
        if found.keys.is_empty() && found.sections.is_empty() && found.result.is_none() {
            // By its last part, so that study.method finds stage.method.
            let last = |name: &str| name.rsplit('.').next().unwrap_or_default().to_owned();
            let near = all.iter().find(|(_, key)| last(&key.name) == last(&name));
            let near = near.map_or(String::new(), |(_, key)| format!("Did you mean {}? ", key.name));
            let help = near + "granulens keys lists all; granulens keys --kind design those of a design file.";
            return Err(Failure::input_with_help(format!("no key is called {name}"), &help));
        }
        Ok(found)
    }
}

/// What is called by a name.
#[derive(Default)]
struct Found {
    keys: Vec<(FileKind, &'static Key)>,
    /// Sections without keys of their own.
    sections: Vec<(FileKind, &'static Section)>,
    /// A column or key of results, and what it means.
    result: Option<(String, String)>,
}

impl Found {
    /// For a person: in full, or a line each.
    fn words(&self, full: bool) -> String {
        let mut parts = Vec::new();
        for (k, (kind, key)) in self.keys.iter().enumerate() {
            if k == 0 || self.keys[k - 1].0 != *kind {
                parts.push(format!("{}\n\n", kind.keys().title));
            }
            let text = match full {
                true => key.text(),
                false => format!("  {:<32} {:<18} {}\n", key.name, key.takes, key.meaning),
            };
            if let Some(part) = parts.last_mut() {
                part.push_str(&text);
            }
        }
        let section =
            |(kind, of): &(FileKind, &Section)| format!("{}\n\n[{}]\n  {}\n", kind.keys().title, of.name, of.about);
        parts.extend(self.sections.iter().map(section));
        parts.extend(self.result.iter().map(|(name, meaning)| format!("Results\n\n{name}\n  {meaning}\n")));
        parts.join("\n")
    }
}

/// Write the JSON Schema of a kind of file, by which editors check it
///
/// An editor that knows TOML schemas takes it from the file's first line: #:schema granulens-design.schema.json
#[derive(clap::Args)]
pub struct Schema {
    /// design, rig, bed, study or materials
    #[arg(value_parser = kind)]
    kind: FileKind,
}

impl Schema {
    pub fn run(self, common: &Common) -> Result<(), Failure> {
        let text = pretty(&self.kind.schema());
        match &common.out {
            Some(path) => write_file(common, path, &text),
            None => {
                emit(&text);
                Ok(())
            }
        }
    }
}

pub fn kind(name: &str) -> Result<FileKind, String> {
    let known = FileKind::ALL.map(FileKind::name).join(", ");
    FileKind::find(name).ok_or_else(|| format!("must be one of {known}"))
}
