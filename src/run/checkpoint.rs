//! Where a run stands: the state of its rig and how long its streams were, in one file with a checksum.

use std::collections::BTreeMap;
use std::path::Path;

use serde::{Deserialize, Serialize};

use super::events::State;
use super::streams::Streams;
use super::{Halved, RunError, write};
use crate::dem::rig::Simulation;
use crate::dem::{sealed_behind, unsealed};
use crate::setup::PreparedRig;

/// First line of the file; the number is that of the format.
const OPENING: &[u8] = b"granulens trial checkpoint 4\n";

/// What is kept.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub(super) struct Checkpoint {
    /// Checksum of the rig file's text.
    text: u32,
    /// Seeds of what was drawn by chance.
    seeds: Vec<u64>,
    /// Whether frames are kept, by the file or by the caller.
    pub frames: bool,
    /// How often the step was halved.
    pub halved: Halved,
    /// Lengths of the streams in bytes, by name.
    pub lengths: BTreeMap<String, u64>,
    /// What the record of events remembers.
    pub events: Option<State>,
    /// The rig's own checkpoint.
    pub state: Vec<u8>,
}

/// Whether a run with this checksum and these seeds is one of the prepared rig; if not, why.
pub(super) fn is_of<const D: usize>(text: u32, seeds: &[u64], prepared: &PreparedRig<D>) -> Result<(), String> {
    if text != crc32fast::hash(prepared.text.as_bytes()) {
        return Err("the file of the rig has changed since; what was begun cannot be gone on with".to_owned());
    }
    if seeds != prepared.seeds {
        let seeds: Vec<String> = seeds.iter().map(u64::to_string).collect();
        return Err(format!("the run was begun with other seeds ({}); give the same --seed", seeds.join(", ")));
    }
    Ok(())
}

impl Checkpoint {
    /// Of a run that has just been sampled, or is between samples. Streams are written out first.
    pub fn of<const D: usize>(
        prepared: &PreparedRig<D>,
        simulation: &Simulation<D>,
        streams: &mut Streams,
        halved: &Halved,
    ) -> Result<Self, RunError> {
        streams.flush()?;
        let text = crc32fast::hash(prepared.text.as_bytes());
        Ok(Self {
            text,
            seeds: prepared.seeds.clone(),
            frames: prepared.record.frames,
            halved: halved.clone(),
            lengths: streams.lengths(),
            events: streams.events().map(|e| e.state.clone()),
            state: simulation.checkpoint(),
        })
    }

    /// Puts it in its place at once: the one before stays until this one is whole.
    pub fn write(&self, path: &Path) -> Result<(), RunError> {
        write(path, &sealed_behind(OPENING.to_vec(), self))
    }

    /// Reads one, of the same rig file.
    pub fn read<const D: usize>(path: &Path, prepared: &PreparedRig<D>) -> Result<Self, RunError> {
        let bytes = std::fs::read(path).map_err(|error| RunError::File { path: path.to_owned(), error })?;
        let Some(rest) = bytes.strip_prefix(OPENING) else {
            let ours = bytes.starts_with(b"granulens trial checkpoint");
            let reason = if ours { "the checkpoint is of another version" } else { "this is no checkpoint" };
            return Err(Self::refused(path, reason));
        };
        let checkpoint: Self = unsealed(rest).ok_or_else(|| Self::refused(path, "the checkpoint is damaged"))?;
        is_of(checkpoint.text, &checkpoint.seeds, prepared).map_err(|reason| Self::refused(path, &reason))?;
        Ok(checkpoint)
    }

    fn refused(path: &Path, reason: &str) -> RunError {
        RunError::Checkpoint { path: path.to_owned(), reason: reason.to_owned() }
    }
}
