//! Frames of a run in the plane: two files a sample, as impacts on beds have them.

use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};

use super::RunError;
use crate::bed::{FRAME_SI, Frame, frame_names, frame_texts_into};
use crate::dem::rig::Simulation;
use crate::setup::PreparedRig;

/// Where frames stand in the folder of a run.
const FOLDER: &str = "frames";

/// Keeps frames.
pub(super) struct Frames {
    folder: PathBuf,
    /// Steps between two samples.
    every: u64,
    /// Spheres of the crystal; those of intruders stand behind them.
    grains: usize,
    flats: Vec<String>,
    /// Room for the texts of a frame.
    texts: [String; 2],
    /// Written since the last flush.
    written: Vec<PathBuf>,
}

impl Frames {
    /// Of a prepared rig, in the folder of its run.
    pub fn of<const D: usize>(prepared: &PreparedRig<D>, folder: &Path) -> Result<Self, RunError> {
        let folder = folder.join(FOLDER);
        fs::create_dir_all(&folder).map_err(|error| RunError::File { path: folder.clone(), error })?;
        let flats = prepared.rig.flats.iter().map(|flat| flat.name.clone()).collect();
        let (every, grains, texts) = (prepared.record.every, prepared.sites.len(), Default::default());
        Ok(Self { folder, every, grains, flats, texts, written: Vec::new() })
    }

    /// Writes the present state; that of a sample which a run that is taken up writes again has the same bytes.
    pub fn keep<const D: usize>(&mut self, simulation: &Simulation<D>) -> Result<(), RunError> {
        let Some(frame) = Frame::of(simulation, [self.grains, 0]) else { return Ok(()) };
        // The last sample may come before its time.
        let number = simulation.steps().div_ceil(self.every);
        let flats: Vec<&str> = self.flats.iter().map(String::as_str).collect();
        frame_texts_into(&mut self.texts, number, &frame, FRAME_SI, &flats);
        for (name, text) in frame_names(number).iter().zip(&self.texts) {
            let path = self.folder.join(name);
            fs::write(&path, text).map_err(|error| RunError::File { path: path.clone(), error })?;
            self.written.push(path);
        }
        Ok(())
    }

    /// Hands everything to the disk.
    pub fn flush(&mut self) -> Result<(), RunError> {
        for path in self.written.drain(..) {
            File::open(&path).and_then(|file| file.sync_data()).map_err(|error| RunError::File { path, error })?;
        }
        Ok(())
    }
}

/// Takes away the frames of an earlier run, and nothing else that stands among them.
pub(super) fn remove(folder: &Path) -> io::Result<()> {
    let folder = folder.join(FOLDER);
    if !folder.is_dir() {
        return Ok(());
    }
    let mut left = false;
    for entry in fs::read_dir(&folder)? {
        let entry = entry?;
        let name = entry.file_name();
        let number = name.to_str().and_then(|name| name.get(..6)?.parse().ok());
        match number.is_some_and(|number| frame_names(number).iter().any(|known| name == known.as_str())) {
            true => fs::remove_file(entry.path())?,
            false => left = true,
        }
    }
    if left { Ok(()) } else { fs::remove_dir(&folder) }
}
