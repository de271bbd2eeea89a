//! One rig from its file to records on disk: written as the run goes, taken up where it was left.
//!
//! In: a [`PreparedRig`]. Out: a folder with the samples over time as CSV, tables of what each sphere and contact felt, and a
//! [`Summary`]. Memory does not grow with the length of the run. A checkpoint is written now and then; a run that was killed at
//! any moment goes on from it, its files cut back to where it stood, and ends with the same bytes.
//!
//! - `streams`: samples over time; `events`: what happens, when it happens; `tables`: what is written at the end; `series`: files read back, a column at a time
//! - `frames`: every body and contact at every sample
//! - `checkpoint`: state and lengths of the streams in one file
//! - `large`: large crystals in space, followed by their rows; `course`: the loop of both
//! - `summary`: what a run came to

mod checkpoint;
mod course;
mod events;
mod frames;
mod large;
mod series;
mod streams;
mod summary;
mod tables;

use std::fs;
use std::io;
use std::path::{Path, PathBuf};
use std::time::Duration;

use serde::{Deserialize, Serialize};

pub use large::is_large;
pub use series::{Series, SeriesError};
pub use summary::{BodySummary, Recorded, Summary};

use crate::Context;
use crate::dem::rig::{RigError, RigStop, Simulation};
use crate::dem::{MoveIn, Spheres};
use crate::output::{self, OutputError};
use crate::setup::PreparedRig;
use checkpoint::Checkpoint;
use course::{Advanced, Course};
use streams::Streams;

/// The file by which a folder of a run is recognised.
pub const SUMMARY: &str = "trial.json";
/// The text of the rig file.
pub const RIG: &str = "rig.toml";
/// Where a run stands.
const CHECKPOINT: &str = "checkpoint";

/// Most steps between two looks at the clock. Chunks end at multiples of it, so that a run that is taken up looks at its
/// guards after the same steps.
const CHUNK: u64 = 4096;

/// A run that could not begin, go on or be written.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// The rig cannot be set in motion.
    #[error(transparent)]
    Rig(#[from] RigError),
    /// The folder holds something else.
    #[error("{0} exists and holds no run; it is left alone")]
    Foreign(PathBuf),
    /// The folder holds an unfinished run.
    #[error("{0} holds a run that is not finished")]
    Unfinished(PathBuf),
    /// There is nothing to take up.
    #[error("{0} holds no run that could be taken up")]
    Nothing(PathBuf),
    /// The run there is finished.
    #[error("the run in {0} is finished")]
    Finished(PathBuf),
    /// A checkpoint that cannot be used.
    #[error("{path}: {reason}")]
    Checkpoint {
        /// The file.
        path: PathBuf,
        /// Why.
        reason: String,
    },
    /// A file cannot be written or read.
    #[error("{path}: {error}")]
    File {
        /// Which.
        path: PathBuf,
        /// Why.
        error: io::Error,
    },
    /// A file cannot be written as a whole.
    #[error(transparent)]
    Output(#[from] OutputError),
    /// A record that cannot be read back.
    #[error(transparent)]
    Series(#[from] SeriesError),
}

impl RunError {
    /// What to try.
    pub fn help(&self) -> &'static str {
        match self {
            Self::Rig(RigError::Overlap { .. }) => {
                "Move or shrink one of them, or write run.precompressed = true if they are meant to."
            }
            Self::Rig(RigError::Step { .. }) => "Leave run.step out to have it chosen.",
            Self::Rig(RigError::Period { .. }) => "Widen the crystal: more cells along that axis.",
            Self::Rig(_) => "Change the rig file.",
            Self::Foreign(_) | Self::File { .. } | Self::Output(_) => "Choose another place with --out.",
            Self::Unfinished(_) => "Go on with --resume, or choose another place with --out.",
            Self::Nothing(_) => "Leave out --resume to begin.",
            Self::Finished(_) => "Leave out --resume to run it anew.",
            Self::Checkpoint { .. } | Self::Series(_) => "Begin anew in another folder, with --out.",
        }
    }
}

/// How a run is kept.
#[derive(Clone, Copy, Debug)]
pub struct Keeping {
    /// Whether to take up what the folder holds.
    pub resume: bool,
    /// Time between checkpoints.
    pub every: Duration,
}

/// Why a run came to its end.
#[derive(Clone, Debug, PartialEq)]
pub enum Ending {
    /// The window is over.
    Complete,
    /// A guard stopped it; what was computed is kept.
    Stopped(RigStop),
    /// The caller asked for it; it can be taken up.
    Interrupted {
        /// Time reached (s).
        time: f64,
    },
}

/// A chosen step is halved at most so often.
const MOST_HALVINGS: u32 = 8;

/// Runs a rig in a folder; the context is told now and then how many of how many steps are done.
///
/// Where a contact turns out stiffer than the chosen step foresaw, the run begins again from its start with half the step: what is
/// written is that of one step, as if it had been given. How often that was is kept in checkpoints, so that a run that is
/// taken up goes on with the step it had.
///
/// # Errors
/// See [`RunError`]. A guard or an interruption is no error but an [`Ending`].
pub fn run<const D: usize>(
    prepared: &PreparedRig<D>,
    folder: &Path,
    keeping: Keeping,
    context: &Context,
) -> Result<(Summary, Ending), RunError>
where
    Spheres: MoveIn<D>,
{
    let path = folder.join(CHECKPOINT);
    // What was begun by rows is gone on with by rows.
    let by_rows = if keeping.resume { large::halved(&path)? } else { None };
    let mut begun = match keeping.resume && by_rows.is_none() {
        true => Some(taken_up(prepared, folder, &path)?),
        false => None,
    };
    let mut tries_rows = begun.is_none();
    let mut keeping = keeping;
    let mut halved = by_rows.or(begun.as_ref().map(|checkpoint| checkpoint.halved.clone())).unwrap_or_default();
    let mut prepared = prepared.clone();
    prepared.record.frames = begun.as_ref().map_or(prepared.record.frames, |checkpoint| checkpoint.frames);
    loop {
        let prepared = halved.of(&prepared);
        let by_rows = if tries_rows { large::run(&prepared, folder, keeping, &halved, context)? } else { None };
        let done = match by_rows {
            Some(done) => done,
            None => {
                tries_rows = false;
                once(&prepared, folder, begun.take(), &halved, keeping.every, context)?
            }
        };
        match done {
            (_, Ending::Stopped(stop @ RigStop::Coarse { .. })) if halved.times < MOST_HALVINGS => {
                let why = stop.words("s", &|body| prepared.name_of(body));
                halved = Halved { times: halved.times + 1, why };
                keeping.resume = false;
                fs::remove_file(&path).map_err(|error| RunError::File { path: path.clone(), error })?;
            }
            done => {
                if !matches!(done.1, Ending::Interrupted { .. }) {
                    fs::remove_file(&path).map_err(|error| RunError::File { path, error })?;
                    let _ = fs::remove_file(folder.join(CHECKPOINT).with_extension("new"));
                }
                return Ok(done);
            }
        }
    }
}

/// How often a run was begun again with half the step, and why the last time.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
struct Halved {
    times: u32,
    why: String,
}

impl Halved {
    /// The rig with its step halved so often; samples stay at the same times.
    fn of<const D: usize>(&self, prepared: &PreparedRig<D>) -> PreparedRig<D> {
        let mut prepared = prepared.clone();
        if self.times > 0 {
            prepared.plan.step *= 0.5_f64.powi(self.times as i32);
            prepared.record.every <<= self.times;
            let times = if self.times == 1 { "once".to_owned() } else { format!("{} times", self.times) };
            prepared.plan.step_reason += &format!("; halved {times} and begun again: {}", self.why);
        }
        prepared
    }
}

/// A run with one step, from its beginning or from where it was left.
fn once<const D: usize>(
    prepared: &PreparedRig<D>,
    folder: &Path,
    begun: Option<Checkpoint>,
    halved: &Halved,
    keep_every: Duration,
    context: &Context,
) -> Result<(Summary, Ending), RunError>
where
    Spheres: MoveIn<D>,
{
    let mut simulation = prepared.simulation()?.recording(prepared.record.arrivals.clone());
    let path = folder.join(CHECKPOINT);
    let streams = if let Some(checkpoint) = begun {
        let damaged = |reason: String| RunError::Checkpoint { path: path.clone(), reason };
        simulation.restore(&checkpoint.state).map_err(|error| damaged(error.to_string()))?;
        Streams::restore(folder, prepared, &checkpoint.lengths, checkpoint.events)?
    } else {
        begin(prepared, folder)?;
        let mut streams = Streams::begin(folder, prepared)?;
        streams.sample(&simulation)?;
        streams.begin_events(&simulation.view());
        Checkpoint::of(prepared, &simulation, &mut streams, halved)?.write(&path)?;
        streams
    };

    let length = [prepared.plan.steps(), prepared.record.every, CHUNK];
    let mut course = OfRig { prepared, simulation, streams, halved, path };
    // Whatever a rig does, it is followed.
    let ending = course::follow(&mut course, length, keep_every, context)?.unwrap_or(Ending::Complete);
    let OfRig { simulation, mut streams, .. } = course;
    streams.flush()?;
    let complete = !matches!(ending, Ending::Interrupted { .. });
    if complete {
        tables::write_all(folder, prepared, &simulation)?;
    }
    let summary = Summary::new(prepared, &simulation, &ending, folder)?;
    write(&folder.join(SUMMARY), summary.json().as_bytes())?;
    Ok((summary, ending))
}

/// A rig on its way.
struct OfRig<'a, const D: usize> {
    prepared: &'a PreparedRig<D>,
    simulation: Simulation<D>,
    streams: Streams,
    halved: &'a Halved,
    path: PathBuf,
}

impl<const D: usize> Course for OfRig<'_, D> {
    fn steps(&self) -> u64 {
        self.simulation.steps()
    }

    /// Events are written as they happen.
    fn advance(&mut self, steps: u64, context: &Context) -> Result<Advanced, RunError> {
        let step = self.simulation.step();
        let advanced = match self.streams.events() {
            None => self.simulation.advance(steps, context),
            Some(events) => {
                let mut written = Ok(());
                let advanced = self.simulation.follow(steps, context, |view| {
                    if written.is_ok() {
                        written = events.see(view, step);
                    }
                });
                written?;
                advanced
            }
        };
        Ok(match advanced {
            Ok(()) => Advanced::All,
            Err(RigStop::Interrupted { time }) => Advanced::Interrupted(time),
            Err(stop) => Advanced::Stopped(stop),
        })
    }

    fn sample(&mut self) -> Result<(), RunError> {
        self.streams.sample(&self.simulation)
    }

    fn keep(&mut self) -> Result<(), RunError> {
        Checkpoint::of(self.prepared, &self.simulation, &mut self.streams, self.halved)?.write(&self.path)
    }
}

/// Makes the folder of a new run. What stands there is replaced only where it is a run that came to its end.
fn begin<const D: usize>(prepared: &PreparedRig<D>, folder: &Path) -> Result<(), RunError> {
    let at = |error| RunError::File { path: folder.to_owned(), error };
    if folder.exists() {
        let empty = fs::read_dir(folder).map_err(at)?.next().is_none();
        if !empty && finished(folder).is_none() {
            return Err(RunError::Foreign(folder.to_owned()));
        }
        if folder.join(CHECKPOINT).exists() {
            return Err(RunError::Unfinished(folder.to_owned()));
        }
        for entry in fs::read_dir(folder).map_err(at)? {
            let entry = entry.map_err(at)?;
            if is_written(&entry.file_name().to_string_lossy()) {
                fs::remove_file(entry.path()).map_err(at)?;
            }
        }
        frames::remove(folder).map_err(at)?;
    }
    fs::create_dir_all(folder).map_err(at)?;
    write(&folder.join(RIG), prepared.text.as_bytes())?;
    write(&folder.join(SUMMARY), Summary::beginning(prepared).json().as_bytes())
}

/// Whether a run writes files of this name, which the next one there may remove.
fn is_written(name: &str) -> bool {
    const RECORDS: [&str; 14] = [
        "intruders.csv",
        "regions.csv",
        "regions-final.csv",
        "energies.csv",
        "layers.csv",
        "flats.csv",
        "bars.csv",
        "spheres.csv",
        "contacts.csv",
        "events.csv",
        "spheres-final.csv",
        "contacts-final.csv",
        "contacts-ever.csv",
        "layers-final.csv",
    ];
    let picture = name.strip_suffix(".svg").is_some_and(|stem| {
        crate::setup::Picture::ALL.iter().any(|(known, _)| *known == stem) || stem.starts_with("arrivals-")
    });
    picture || ["report.html", "network.svg", "motion.svg"].contains(&name) || RECORDS.contains(&name)
}

/// Whether the trial in a folder came to its end; none if the folder holds no run.
fn finished(folder: &Path) -> Option<bool> {
    let text = fs::read_to_string(folder.join(SUMMARY)).ok()?;
    serde_json::from_str::<Summary>(&text).ok().map(|summary| summary.finished)
}

/// The checkpoint of the run in a folder, if it is one of this rig.
fn taken_up<const D: usize>(prepared: &PreparedRig<D>, folder: &Path, path: &Path) -> Result<Checkpoint, RunError> {
    match (path.exists(), finished(folder)) {
        (true, Some(_)) => {}
        (false, Some(true)) => return Err(RunError::Finished(folder.to_owned())),
        // Killed before its first checkpoint, it has not come far.
        (false, Some(false)) | (_, None) => return Err(RunError::Nothing(folder.to_owned())),
    }
    Checkpoint::read(path, prepared)
}

/// Writes a file by way of one beside it, so that it is there as a whole or not at all, also after a power cut.
fn write(path: &Path, bytes: &[u8]) -> Result<(), RunError> {
    Ok(output::keep(path, bytes)?)
}
