//! `granulens keys` and `schema`: what every key of every file means.

use granulens::reference::{FileKind, Key, page};
use serde_json::json;

use super::Common;
use super::console::{emit, emit_json, pretty};
use super::failure::Failure;
use super::folder::{write_file, write_json};

/// Say what a key of a design, rig, bed or study file means
///
/// By its name, or a part of it: granulens keys crystal.diameter, granulens keys friction. Without one, all keys of a kind of file are listed.
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
}

impl KeysOf {
    pub fn run(self, common: &Common) -> Result<(), Failure> {
        if self.page {
            emit(&page());
            return Ok(());
        }
        let kinds = FileKind::ALL.into_iter().filter(|kind| self.kind.is_none_or(|wanted| wanted == *kind));
        let of_kind = |kind: FileKind| kind.keys().all().map(move |key| (kind, key));
        let all: Vec<(FileKind, &Key)> = kinds.flat_map(of_kind).collect();
        let found = match &self.key {
            None => all,
            Some(name) => matching(&all, name)?,
        };
        let list: Vec<_> = found.iter().map(|(kind, key)| json!({ "file": kind.name(), "key": key })).collect();
        let list = json!({ "format": granulens::outcome::FORMAT, "keys": list });
        write_json(common, &list)?;
        if common.json {
            emit_json(&list);
            return Ok(());
        }
        let mut text = String::new();
        for (k, (kind, key)) in found.iter().enumerate() {
            if k == 0 || found[k - 1].0 != *kind {
                text += &format!("{}{}\n\n", if k == 0 { "" } else { "\n" }, kind.keys().title);
            }
            text += &match &self.key {
                Some(_) => key.text(),
                None => format!("  {:<32} {:<18} {}\n", key.name, key.takes, key.meaning),
            };
        }
        emit(&text);
        Ok(())
    }
}

/// Keys of that name, or else of which it is a part.
fn matching<'a>(all: &[(FileKind, &'a Key)], name: &str) -> Result<Vec<(FileKind, &'a Key)>, Failure> {
    // As a message writes it: pattern[2].angle.
    let name: String = name.split('[').map(|part| part.split_once(']').map_or(part, |(_, rest)| rest)).collect();
    let that = |fits: &dyn Fn(&Key) -> bool| all.iter().copied().filter(|(_, key)| fits(key)).collect::<Vec<_>>();
    let exact = that(&|key| key.name == name || key.name.ends_with(&format!(".{name}")));
    let found = if exact.is_empty() { that(&|key| key.name.contains(&name)) } else { exact };
    if found.is_empty() {
        let help = "granulens keys lists all; granulens keys --kind design those of a design file.";
        return Err(Failure::input_with_help(format!("no key is called {name}"), help));
    }
    Ok(found)
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
