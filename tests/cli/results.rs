//! What commands write is what the book says: every column of every table, and every key of every JSON object.

use std::path::Path;

use granulens::reference::{meaning, tables};
use serde_json::Value;

use super::network::SQUARES;
use super::{Desk, names, studies::STUDY};

/// Keys of an object and of all that it holds; names of columns are values there and not looked at.
fn keys(value: &Value, found: &mut Vec<String>) {
    match value {
        Value::Object(object) => {
            for (key, value) in object {
                found.push(key.clone());
                keys(value, found);
            }
        }
        Value::Array(values) => values.iter().for_each(|value| keys(value, found)),
        _ => {}
    }
}

/// The first line of a table that is no comment.
fn head(text: &str) -> Vec<String> {
    let line = text.lines().find(|line| !line.starts_with('#')).unwrap_or_default();
    line.split(',').map(str::to_owned).collect()
}

/// Tables below a folder, but for those named.
fn found(folder: &Path, tables: &mut Vec<(String, Vec<String>)>) {
    for name in names(folder) {
        let path = folder.join(&name);
        if path.is_dir() {
            found(&path, tables);
        } else if name.ends_with(".csv") {
            tables.push((name, head(&std::fs::read_to_string(path).unwrap())));
        }
    }
}

#[test]
fn every_column_and_key_is_in_the_book() {
    let desk = Desk::new();
    desk.design_with("priced.toml", "[compare]", "[prices]\nbrass-260 = 0.3\nstainless-440c = 0.1\n[compare]");
    desk.run(&["design", "priced.toml", "--out", "small.csv"]).ok();
    desk.write("study.toml", STUDY);
    desk.write("contacts.txt", SQUARES);
    let commands: [&[&str]; 21] = [
        &["design", "priced.toml"],
        &["design", "priced.toml", "--rank", "--simulate", "1"],
        &["run", "priced.toml", "--out", "out/run"],
        &[
            "check",
            "small.csv",
            "--design",
            "priced.toml",
            "--forces",
            "2",
            "--laws",
            "all",
            "--spheres",
            "out/felt.csv",
        ],
        &["check", "small.csv", "--design", "small.toml", "--gate"],
        &["compare", "priced.toml", "--forces", "2"],
        &["report", "small.toml", "small.csv", "--out", "out/report"],
        &["diff", "small.csv", "small.csv", "--design", "small.toml"],
        &["trace", "small.toml"],
        &["build", "small.csv", "--design", "priced.toml", "--out", "out/build"],
        &["tolerance", "small.csv", "--design", "small.toml", "--samples", "8", "--sites", "--out", "out/made"],
        &["simulate", "small.toml", "--frames", "--out", "out/simulated"],
        &["study", "run", "study.toml", "--out", "out/study"],
        &["study", "show", "study.toml", "--out", "out/study"],
        &["network", "contacts.txt", "--out", "out/network"],
        &["materials"],
        &["contact", "--pair", "440c,brass"],
        &["speed", "--material", "440c", "--amplitude", "2"],
        &["surface", "--find-speed", "629 m/s"],
        &["bench", "small.toml"],
        &["reproduce", "4.3-brass"],
    ];
    let mut unknown = Vec::new();
    for command in commands {
        let json = desk.run(&[command, &["--json", "--quiet"]].concat()).ok().json();
        let mut named = Vec::new();
        keys(&json, &mut named);
        // Names of materials, measures and records are values that stand as keys.
        unknown
            .extend(named.into_iter().filter(|key| meaning(key).is_none()).map(|key| format!("{}: {key}", command[0])));
    }
    for command in [
        &["contact", "--pair", "440c,brass", "--out", "out/contact.csv"][..],
        &["surface", "--out", "out/surface.svg"],
        &["study", "export", "study.toml", "--out", "out/study", "--journal", "out/journal.csv"],
    ] {
        desk.run(command).ok();
    }
    unknown.sort();
    unknown.dedup();
    assert!(unknown.is_empty(), "src/reference/results.toml does not know\n{}", unknown.join("\n"));
    let mut written = Vec::new();
    found(&desk.path("out"), &mut written);
    assert!(written.len() > 25, "{}", written.len());
    let mut seen = vec![false; tables().len()];
    for (name, columns) in &written {
        let fits = tables().iter().position(|table| columns.iter().all(|column| table.has(column)));
        let Some(place) = fits else { panic!("no table of src/reference/results.toml has all of {name}: {columns:?}") };
        // As many as are written by name there.
        let plain = tables()[place].columns.iter().filter(|column| !column.contains('*'));
        let missing: Vec<_> = plain.filter(|column| !columns.contains(column)).collect();
        assert!(missing.is_empty(), "{name}: {missing:?} of {}", tables()[place].file);
        seen[place] = true;
    }
    assert!(seen.iter().filter(|seen| **seen).count() > 18, "{seen:?}");
}
