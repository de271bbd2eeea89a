//! `granulens study merge`.

use std::path::{Path, PathBuf};

use granulens::outcome::FORMAT;
use granulens::study::{FoundShard, Merged, merge};
use serde_json::json;

use super::{folder, read};
use crate::cli::console::{emit, emit_json, note};
use crate::cli::failure::Failure;
use crate::cli::{Band, Common};

#[derive(clap::Args)]
pub struct Merge {
    /// Study file
    study: PathBuf,
    #[command(flatten)]
    forces: Band,
}

impl Merge {
    pub fn run(self, common: &Common) -> Result<(), Failure> {
        let study = read(&self.study, &self.forces, common)?;
        let folder = folder(common, &study);
        let merged = merge(&folder)?;
        tell(common, &folder, &merged);
        if merged.is_whole() { Ok(()) } else { Err(Failure::Asked(missing(&merged))) }
    }
}

fn missing(merged: &Merged) -> String {
    let some: Vec<&str> = merged.absent.iter().map(String::as_str).take(12).collect();
    let more = if merged.absent.len() > some.len() { ", ..." } else { "" };
    let absent = if some.is_empty() { String::new() } else { format!("; not begun: shards {}{more}", some.join(", ")) };
    format!(
        "{} of {} layouts are not evaluated yet{absent}; to run their shards again is to go on",
        merged.asked - merged.answered,
        merged.asked
    )
}

/// What folding came to; what is damaged is named.
pub fn tell(common: &Common, folder: &Path, merged: &Merged) {
    if common.json {
        let shard = |shard: &FoundShard| {
            json!({ "journal": shard.path, "evaluations": shard.entries, "stopped": shard.stopped, "missing": shard.missing,
                    "damage": shard.damage })
        };
        let shards: Vec<_> = merged.shards.iter().map(shard).collect();
        emit_json(&json!({
            "format": FORMAT, "asked": merged.asked, "answered": merged.answered, "folded": merged.folded,
            "repeated": merged.repeated, "unasked": merged.unasked, "conflicts": merged.conflicts, "shards": shards,
            "absent": merged.absent, "warnings": merged.warnings,
        }));
        return;
    }
    emit(&words(folder, merged));
    for told in merged.warnings.iter().chain(&merged.conflicts) {
        note(common, &format!("note: {told}"));
    }
    for damage in merged.shards.iter().flat_map(|shard| &shard.damage) {
        note(common, &format!("damaged: {damage}"));
    }
}

fn words(folder: &Path, merged: &Merged) -> String {
    let mut text = format!(
        "{} of {} layouts asked for are evaluated; {} new from {} shards, {} known already\n",
        merged.answered,
        merged.asked,
        merged.folded,
        merged.shards.len(),
        merged.repeated
    );
    if merged.unasked > 0 {
        text.push_str(&format!("{} evaluations that nobody asked for are left where they are\n", merged.unasked));
    }
    for shard in merged.shards.iter().filter(|shard| shard.missing > 0) {
        let name = shard.path.strip_prefix(folder).unwrap_or(&shard.path).display();
        text.push_str(&format!(
            "{name}: {} evaluated, {} missing: under way, killed, or its machine lost; no layout's fault\n",
            shard.entries, shard.missing
        ));
    }
    let stopped: usize = merged.shards.iter().map(|shard| shard.stopped).sum();
    if stopped > 0 {
        text.push_str(&format!("{stopped} layouts were stopped by a guard, which is an answer\n"));
    }
    text
}
