//! The program as its users and their scripts meet it: arguments in; files, stdout, stderr and an exit code out.
//!
//! - `jobs`: run, design and compare; the same numbers on any number of threads
//! - `build`: what a workshop gets, and differences of layouts; `measured`: measurements on predictions
//! - `check`: layouts under an impact, steps, guards and thresholds
//! - `layouts`: what a wrong layout file hears
//! - `laws`: materials, contact and speed; `surface`: design surfaces; `trace`: rays
//! - `simulate`: rigs; `modes`: small vibrations; `impact`: granular beds
//! - `network`: network and motion, of files of any program
//! - `sensitivity`: how scores change with every sphere
//! - `tolerance`: pieces as made, and the gate; `tolerance_space`: pieces in space
//! - `cost`: what --dry-run says; `documents`: what README and docs promise; `truth`: the same numbers from every command
//! - `figures`: figures for papers, and pages
//! - `space`: designs in space
//! - `shards`: studies evaluated apart and folded, by hand and as job arrays
//! - `results`: every key and column that is written is listed
//! - `refusals`: usage and input errors, as text and as JSON
//! - `folders`: where output may go, and interruption; `kept`: nothing of a user's is lost

mod build;
mod check;
mod cost;
mod documents;
mod figures;
mod folders;
mod impact;
mod jobs;
mod kept;
mod laws;
mod layouts;
mod measured;
mod modes;
mod network;
mod refusals;
mod results;
mod sensitivity;
mod shards;
mod sheets;
mod simulate;
mod space;
mod space_studies;
mod studies;
mod surface;
mod tolerance;
mod tolerance_space;
mod trace;
mod truth;

use std::path::{Path, PathBuf};

use assert_cmd::Command;
use serde_json::Value;
use tempfile::TempDir;

/// A crystal of 60 spheres and a wave that passes its regions: milliseconds.
const SMALL: &str = r#"format = 1
name = "small"
[crystal]
packing = "hexagonal-2d"
diameter = "6.35 mm"
rows = 12
half_width = 4.5
sides = "mirror"
host = "stainless-440c"
[impact]
kind = "force-pulse"
force = "16 kN"
duration = "20 us"
[target]
focus = { rows = [8, 10], x = ["0 D", "1 D"] }
protect = { rows = [8, 10], x = ["3 D", "4.5 D"] }
[lens]
family = "plano-convex"
material = "brass-260"
apex_row = 2
back_row = 5
radius = "6 D"
[run]
window = "100 us"
[compare]
seeds = 2
"#;

/// A folder of one test's own in which the program runs, so that messages name files as `small.toml`.
struct Desk(TempDir);

/// What one call of the program left.
struct Ran {
    code: i32,
    stdout: String,
    stderr: String,
}

impl Desk {
    /// With `small.toml` on it.
    fn new() -> Self {
        let desk = Self(tempfile::tempdir().unwrap());
        desk.write("small.toml", SMALL);
        desk
    }

    /// With the small design's layout too, as `small.csv`.
    fn with_layout() -> Self {
        let desk = Self::new();
        desk.run(&["design", "small.toml", "--out", "small.csv"]).ok();
        desk
    }

    fn path(&self, name: &str) -> PathBuf {
        self.0.path().join(name)
    }

    fn write(&self, name: &str, text: impl AsRef<[u8]>) {
        std::fs::write(self.path(name), text).unwrap();
    }

    /// Writes the small design with one piece of its text exchanged.
    fn design_with(&self, name: &str, old: &str, new: &str) {
        assert!(SMALL.contains(old), "the small design does not contain {old:?}");
        self.write(name, SMALL.replacen(old, new, 1));
    }

    fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.path(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
    }

    fn json(&self, name: &str) -> Value {
        serde_json::from_str(&self.read(name)).unwrap()
    }

    /// Names of everything on the desk, hidden files too.
    fn names(&self) -> Vec<String> {
        names(self.0.path())
    }

    fn command(&self, arguments: &[&str]) -> Command {
        let mut command = Command::new(env!("CARGO_BIN_EXE_granulens"));
        command.current_dir(self.0.path()).args(arguments).env("NO_COLOR", "1");
        command
    }

    fn run(&self, arguments: &[&str]) -> Ran {
        Ran::of(self.command(arguments))
    }
}

impl Ran {
    fn of(mut command: Command) -> Self {
        let output = command.output().unwrap();
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).unwrap();
        Self { code: output.status.code().unwrap(), stdout: text(output.stdout), stderr: text(output.stderr) }
    }

    #[track_caller]
    fn ok(self) -> Self {
        assert_eq!(self.code, 0, "{}", self.stderr);
        self
    }

    /// Stdout as one JSON value with a format number.
    #[track_caller]
    fn json(&self) -> Value {
        let value: Value = serde_json::from_str(&self.stdout).unwrap_or_else(|e| panic!("{e}: {}", self.stdout));
        assert_eq!(value["format"], 1);
        value
    }

    /// Stderr as one JSON object that agrees with the exit code; the error in it.
    #[track_caller]
    fn json_error(&self) -> Value {
        let value: Value = serde_json::from_str(&self.stderr).unwrap_or_else(|e| panic!("{e}: {}", self.stderr));
        assert_eq!((&value["format"], &value["error"]["exit_code"]), (&1.into(), &self.code.into()));
        value["error"].clone()
    }
}

fn names(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).unwrap();
    let mut names: Vec<String> = entries.map(|entry| entry.unwrap().file_name().into_string().unwrap()).collect();
    names.sort();
    names
}

/// A file of the repository.
fn shipped(path: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path).to_str().unwrap().to_owned()
}

/// The keys of an object, in order.
fn keys(value: &Value) -> Vec<&str> {
    value.as_object().unwrap().keys().map(String::as_str).collect()
}
