//! Rig files from text to records.
//!
//! - `rigs`: the experiments in `designs/`, run and compared with closed forms and published statements
//! - `resume`: runs that are killed, interrupted and taken up; checkpoints that cannot be used; guards
//! - `sections`: what each section of a file does, by what moves
//! - `preload`: squeezed crystals: at rest, in small vibrations, and struck
//! - `records`: events, regions, sampled maxima and losses
//! - `cases`: small rigs that were wrong elsewhere, with the values that are right
//! - `intruders`: bodies that strike, layouts as patterns, springs and dashpots
//! - `large`: crystals that are followed by their rows
//! - `steps`: the step that is chosen: guards, accuracy, restitution, laws that make energy
//! - `refusals`: what a wrong rig file hears

mod cases;
mod felt;
mod intruders;
mod large;
mod preload;
mod records;
mod refusals;
mod resume;
mod rigs;
mod sections;
mod steps;

use std::path::{Path, PathBuf};
use std::time::Duration;

use granulens::dem::{MoveIn, Spheres};
use granulens::run::{self, Ending, Keeping, Series, Summary};
use granulens::setup::{PreparedRig, Setup};
use granulens::{Context, Progress};

/// A file of the repository.
fn shipped(path: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join(path)
}

/// A context that is stopped as soon as so many steps of so many are done.
fn until(there: impl Fn(u64, u64) -> bool + Send + Sync + 'static) -> Context {
    let context = Context::default();
    let stop = context.clone();
    context.telling(move |progress| {
        if matches!(*progress, Progress::Steps { done, of } if there(done, of)) {
            stop.stop();
        }
    })
}

/// A run in a folder of its own.
struct Ran {
    folder: tempfile::TempDir,
    summary: Summary,
    ending: Ending,
}

impl Ran {
    #[track_caller]
    fn of<const D: usize>(prepared: &PreparedRig<D>) -> Self
    where
        Spheres: MoveIn<D>,
    {
        let folder = tempfile::tempdir().unwrap();
        let keeping = Keeping { resume: false, every: Duration::from_secs(3600) };
        let (summary, ending) = run::run(prepared, folder.path(), keeping, &Context::default()).unwrap();
        Self { folder, summary, ending }
    }

    fn series(&self, name: &str) -> Series {
        Series::read(&self.folder.path().join(name), usize::MAX).unwrap()
    }

    /// A column of the table of spheres; NaN where it holds no number.
    fn spheres(&self, column: &str) -> Vec<f64> {
        self.series("spheres-final.csv").column(column).to_vec()
    }
}

#[track_caller]
fn chain(text: &str) -> PreparedRig<1> {
    match Setup::parse("rig.toml", text) {
        Ok(Setup::One(prepared)) => prepared,
        other => panic!("{other:?}"),
    }
}

#[track_caller]
fn sheet(text: &str) -> PreparedRig<2> {
    match Setup::parse("rig.toml", text) {
        Ok(Setup::Two(prepared)) => prepared,
        other => panic!("{other:?}"),
    }
}

#[track_caller]
fn solid(text: &str) -> PreparedRig<3> {
    match Setup::parse("rig.toml", text) {
        Ok(Setup::Three(prepared)) => prepared,
        other => panic!("{other:?}"),
    }
}

/// The opening lines of a rig file.
const HEAD: &str = "format = 1\nkind = \"rig\"\nname = \"test\"\n";
