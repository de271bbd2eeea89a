//! What is written is what `docs/columns.md` lists: every key of JSON and every column of a table.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

use granulens::reference::{meaning, tables};
use serde_json::Value;

use super::Desk;

const STUDY: &str = r#"format = 1
design = "small.toml"
materials = ["stainless-440c", "brass-260", "aluminium-2017"]
rows = [2, 6]
[objective]
contrast = { maximise = 1 }
[tolerance]
radii = "0.1 %"
reported = 2
[[stage]]
method = "level-set"
evaluations = 40
step = "4e-7 s"
[[stage]]
method = "climb"
evaluations = 32
screen = "4e-7 s"
step = "2e-7 s"
"#;

/// Names that are the user's or those of files: keys below these are not listed.
const FREE: [&str; 4] = ["files", "settings", "letters", "counts"];

/// Keys of a value and of all in it, with where they stand.
fn walk(value: &Value, place: &str, found: &mut BTreeMap<String, String>) {
    match value {
        Value::Object(map) => {
            for (key, value) in map {
                found.entry(key.clone()).or_insert_with(|| place.to_owned());
                if !FREE.contains(&key.as_str()) {
                    walk(value, &format!("{place}.{key}"), found);
                }
            }
        }
        Value::Array(list) => list.iter().for_each(|value| walk(value, place, found)),
        _ => {}
    }
}

/// All files below a folder, by their names from there.
fn files(folder: &Path, name: &str, list: &mut Vec<String>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let entry = entry.unwrap();
        let name = format!("{name}/{}", entry.file_name().into_string().unwrap());
        if entry.path().is_dir() { files(&entry.path(), &name, list) } else { list.push(name) }
    }
}

#[test]
fn every_key_and_column_that_is_written_is_listed() {
    let desk = Desk::with_layout();
    desk.write("study.toml", STUDY);
    desk.run(&["init", "rig", "--out", "rig.toml"]).ok();
    let mut said = BTreeMap::new();
    let commands: &[&str] = &[
        "run small.toml --out run",
        "design small.toml --out other.csv",
        "trace small.toml --out trace.svg",
        "check small.csv --design small.toml --forces 2 --laws thesis,hertz --gate --spheres spheres.csv",
        "compare small.toml",
        "report small.toml small.csv --out report --swaps --sensitivity",
        "diff small.csv small.csv --design small.toml",
        "build small.csv --design small.toml --out build",
        "tolerance small.csv --design small.toml --samples 4 --out tolerance --sites --indices --rechoose 2",
        "sensitivity small.csv --design small.toml --out sensitivity.csv",
        "materials",
        "contact --pair 440c,brass --out contact.csv",
        "speed --material 440c",
        "surface --out surface.svg",
        "study run study.toml --out study",
        "study show study.toml --out study --why",
        "study export study.toml --out study --journal journal.csv",
        "simulate rig.toml --out rig",
    ];
    for line in commands {
        let words: Vec<&str> = line.split(' ').collect();
        let ran = desk.run(&[&words[..], &["--json", "--quiet"]].concat()).ok();
        walk(&serde_json::from_str(&ran.stdout).unwrap(), line, &mut said);
    }
    let mut list = Vec::new();
    files(&desk.path("."), ".", &mut list);
    let mut strange = BTreeSet::new();
    for name in &list {
        let text = || desk.read(name);
        if name.ends_with(".json") {
            walk(&serde_json::from_str(&text()).unwrap(), name, &mut said);
        } else if name.ends_with(".jsonl") {
            text().lines().for_each(|line| walk(&serde_json::from_str(line).unwrap(), name, &mut said));
        } else if name.ends_with(".csv") {
            let text = text();
            let header: Vec<&str> = text.lines().find(|line| !line.starts_with('#')).unwrap().split(',').collect();
            if !tables().iter().any(|table| header.iter().all(|column| table.has(column))) {
                strange.insert(format!("{name}: no table has the columns {}", header.join(",")));
            }
        }
    }
    assert!(list.len() > 40, "{list:?}");
    strange.extend(said.iter().filter(|(key, _)| meaning(key).is_none()).map(|(key, place)| format!("{place}: {key}")));
    assert!(strange.is_empty(), "not in src/reference/results.toml: {strange:#?}");
}
