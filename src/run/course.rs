//! The loop of a run, whoever moves the spheres: samples when they are due, checkpoints now and then, an end with its reason.

use std::time::{Duration, Instant};

use super::{Ending, RunError};
use crate::dem::rig::RigStop;
use crate::{Context, Progress};

/// What is followed: a simulation with the files that grow beside it.
pub(super) trait Course {
    /// Steps done.
    fn steps(&self) -> u64;
    /// Goes on by so many steps, or to where it ends.
    fn advance(&mut self, steps: u64, context: &Context) -> Result<Advanced, RunError>;
    /// Writes one sample of everything.
    fn sample(&mut self) -> Result<(), RunError>;
    /// Writes a checkpoint.
    fn keep(&mut self) -> Result<(), RunError>;
    /// What a guard says that looks between steps, if it stops the run.
    fn guarded(&mut self) -> Option<RigStop> {
        None
    }
}

/// How far a course has come.
pub(super) enum Advanced {
    /// As far as was asked.
    All,
    /// It was interrupted at a time (s).
    Interrupted(f64),
    /// A guard stopped it.
    Stopped(RigStop),
    /// It cannot be followed in this way.
    Unfit,
}

/// Follows a course from where it is to its `total` steps, with a sample after `every` so many and at its end, and no more than a
/// `chunk` of them between two looks at the clock. None where it cannot be followed in its way.
pub(super) fn follow(
    course: &mut impl Course,
    [total, every, chunk]: [u64; 3],
    keep_every: Duration,
    context: &Context,
) -> Result<Option<Ending>, RunError> {
    let mut kept = Instant::now();
    while course.steps() < total {
        let done = course.steps();
        let sample = (done / every + 1) * every;
        let until = sample.min((done / chunk + 1) * chunk).min(total);
        let interrupted = match course.advance(until - done, context)? {
            Advanced::All => None,
            Advanced::Interrupted(time) => Some(time),
            Advanced::Stopped(stop) => return Ok(Some(Ending::Stopped(stop))),
            Advanced::Unfit => return Ok(None),
        };
        // The end of the window is a sample too. A request to stop may have been seen just where one is due.
        if course.steps() == sample || course.steps() == total {
            course.sample()?;
        }
        if let Some(time) = interrupted {
            course.keep()?;
            return Ok(Some(Ending::Interrupted { time }));
        }
        if let Some(stop) = course.guarded() {
            return Ok(Some(Ending::Stopped(stop)));
        }
        if kept.elapsed() >= keep_every {
            course.keep()?;
            kept = Instant::now();
        }
        context.tell(Progress::Steps { done: course.steps(), of: total });
    }
    Ok(Some(Ending::Complete))
}
