//! `granulens init`: a file to begin with.

use std::path::PathBuf;

use granulens::reference::FileKind;
use serde_json::json;

use super::Common;
use super::console::{emit, emit_json};
use super::failure::Failure;
use super::folder::write_file;
use super::keys::kind;

/// Write a commented file to begin with, which runs as it is
#[derive(clap::Args)]
pub struct Init {
    /// design, rig, bed, study or materials
    #[arg(default_value = "design", value_parser = kind)]
    kind: FileKind,
}

impl Init {
    pub fn run(self, common: &Common) -> Result<(), Failure> {
        let starter = self.kind.starter();
        let path = common.out.clone().unwrap_or_else(|| PathBuf::from(starter.file));
        write_file(common, &path, starter.text)?;
        let shown = path.display().to_string();
        let next = starter.next.replace(starter.file, &shown);
        if common.json {
            emit_json(
                &json!({ "format": granulens::outcome::FORMAT, "file": shown, "kind": self.kind.name(), "next": next }),
            );
        } else if !common.quiet {
            emit(&format!("{shown}\nnext: {next}\n"));
        }
        Ok(())
    }
}
