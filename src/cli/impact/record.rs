//! Impacts whose frames are kept: streamed to disk as the run goes, and taken up where it was left.

use std::fs;
use std::path::{Path, PathBuf};
use std::sync::mpsc::{Receiver, sync_channel};
use std::time::{Duration, Instant};

use granulens::Context;
use granulens::bed::{
    Bed, BedFile, Course, FRAME_UNITS, Frame, FramePlan, Moment, Strike, frame_names, frame_texts_into,
};
use granulens::output::OutputError;

use super::super::Common;
use super::super::console::{context, note};
use super::super::failure::Failure;

/// Time between checkpoints.
const EVERY: Duration = Duration::from_secs(10);
/// How the file begins that says what run it is.
const OPENING: &str = "# granulens impact, on its way\n";
/// How many frames may wait to be written.
const WAITING: usize = 2;

/// A run on its way: a folder beside its place, with the frames so far and where it stands.
pub struct Recording {
    folder: PathBuf,
}

/// What the system says of a file that cannot be written.
fn refused(path: &Path, error: std::io::Error) -> Failure {
    OutputError::Io { path: path.to_owned(), error }.into()
}

/// What is written, in this order, while the run goes on.
enum Job {
    Frame(u64, Frame),
    Checkpoint(Vec<u8>),
}

impl Recording {
    /// Beside the place of the results.
    pub fn beside(place: &Path) -> Self {
        let mut name = place.as_os_str().to_owned();
        name.push(".unfinished");
        Self { folder: PathBuf::from(name) }
    }

    fn frames(&self) -> PathBuf {
        self.folder.join("frames")
    }

    /// Whether the folder is new, or of the same run. A folder that something else made is left alone.
    fn begin(&self, run: &str) -> Result<(), Failure> {
        let name = self.folder.join("run.txt");
        let known = fs::read_to_string(&name).ok().filter(|text| text.starts_with(OPENING));
        if self.folder.exists() && known.as_deref() != Some(run) {
            let what = if known.is_some() { "another run on its way" } else { "something else" };
            return Err(Failure::input_with_help(
                format!("{} holds {what} and is left alone", self.folder.display()),
                "Move or delete it, or choose another place with --out.",
            ));
        }
        let made = fs::create_dir_all(self.frames()).and_then(|()| fs::write(&name, run));
        made.map_err(|error| refused(&self.folder, error))
    }

    fn checkpoint(&self) -> PathBuf {
        self.folder.join("checkpoint")
    }

    /// Follows an impact and keeps its frames. A run that was left is taken up.
    pub fn strike(
        &self,
        common: &Common,
        bed: &Bed,
        file: &BedFile,
        plan: FramePlan,
        mut progress: impl FnMut(&Moment),
    ) -> Result<Course, Failure> {
        let wrong = |error: &dyn std::fmt::Display| Failure::input(format!("{}: {error}", file.path.display()));
        let mut strike = Strike::new(bed, &file.impact).map_err(|error| wrong(&error))?;
        self.begin(&format!("{OPENING}{:?}\n{:?}\n", file.impact, plan))?;
        let kept = self.checkpoint();
        let taken_up = kept.exists();
        if taken_up {
            let bytes = fs::read(&kept).map_err(|error| Failure::input(format!("{}: {error}", kept.display())))?;
            strike.restore(&bytes).map_err(|error| {
                Failure::input_with_help(
                    format!("{} holds a run that cannot be taken up: {error}", self.folder.display()),
                    "Delete it to begin anew, or choose another place with --out.",
                )
            })?;
            note(common, &format!("taken up at {} tau_c", strike.moment().time));
        }
        let looks = plan.looks(file.impact.sample).unwrap_or(1);
        let (send, receive) = sync_channel(WAITING);
        let written = std::thread::scope(|scope| {
            let writer = scope.spawn(|| self.write(plan, receive));
            // What the writer cannot write it says at the end; until then nobody hears the jobs.
            let put = |job: Job| send.send(job).is_ok();
            let mut last = Instant::now();
            let mut goes_on = taken_up || put(Job::Frame(0, strike.frame()));
            let never = Context::default();
            while goes_on && strike.goes_on() {
                // Asked between two looks, so that what is taken up later stands where a run that was not stopped looks too.
                if context().stopped() {
                    break;
                }
                strike.go_on(&never);
                progress(strike.moment());
                let number = strike.looks();
                if number.is_multiple_of(looks) {
                    goes_on = put(Job::Frame(number / looks, strike.frame()));
                }
                if last.elapsed() > EVERY {
                    goes_on = goes_on && put(Job::Checkpoint(strike.checkpoint()));
                    last = Instant::now();
                }
            }
            if strike.goes_on() {
                put(Job::Checkpoint(strike.checkpoint()));
            }
            drop(send);
            writer.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
        });
        written?;
        if strike.goes_on() {
            return Err(Failure::Interrupted(format!(
                "at {} tau_c; the frames so far are in {}; give the command again to go on",
                strike.moment().time,
                self.folder.display()
            )));
        }
        Ok(strike.course())
    }

    fn write(&self, plan: FramePlan, jobs: Receiver<Job>) -> Result<(), Failure> {
        let mut texts = [String::new(), String::new()];
        for job in jobs {
            match job {
                Job::Frame(number, frame) => {
                    frame_texts_into(&mut texts, number, &frame, FRAME_UNITS, &["intruder"]);
                    for (name, text) in frame_names(number).iter().zip(&texts) {
                        if plan.contacts || name.contains("grains") {
                            let path = self.frames().join(name);
                            fs::write(&path, text).map_err(|error| refused(&path, error))?;
                        }
                    }
                }
                // Renamed into its place, so that there is always a whole one.
                Job::Checkpoint(bytes) => {
                    let (path, made) = (self.checkpoint(), self.folder.join("checkpoint.new"));
                    let put = fs::write(&made, bytes).and_then(|()| fs::rename(&made, &path));
                    put.map_err(|error| refused(&path, error))?;
                }
            }
        }
        Ok(())
    }

    /// Moves the frames to the results, and takes away what only a run on its way needs.
    pub fn finish(self, results: &Path) -> Result<(), Failure> {
        let place = results.join("frames");
        fs::rename(self.frames(), &place)
            .and_then(|()| fs::remove_dir_all(&self.folder))
            .map_err(|error| refused(&place, error))
    }
}
