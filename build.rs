//! Tells the program which commit it is built from.

use std::path::Path;
use std::process::Command;

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rustc-env=GRANULENS_COMMIT={}", commit().unwrap_or_else(|| "unknown".to_owned()));
}

/// The commit of the working copy, or that from which cargo packed the sources; none where they come without either.
fn commit() -> Option<String> {
    let packed = Path::new(".cargo_vcs_info.json");
    if let Ok(text) = std::fs::read_to_string(packed) {
        println!("cargo::rerun-if-changed={}", packed.display());
        let hash = text.split("\"sha1\"").nth(1)?.split('"').nth(1)?;
        return hash.get(..12).map(str::to_owned);
    }
    // Of a copy inside another project's repository that one's commit would say nothing.
    if !Path::new(".git").exists() {
        return None;
    }
    for file in ["HEAD", "logs/HEAD"] {
        if let Some(path) = git(&["rev-parse", "--git-path", file]).filter(|path| Path::new(path).exists()) {
            println!("cargo::rerun-if-changed={path}");
        }
    }
    git(&["rev-parse", "--short=12", "HEAD"])
}

fn git(arguments: &[&str]) -> Option<String> {
    let output = Command::new("git").args(arguments).output().ok().filter(|output| output.status.success())?;
    let text = String::from_utf8(output.stdout).ok()?;
    Some(text.trim().to_owned()).filter(|text| !text.is_empty())
}
