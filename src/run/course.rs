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
        let advanced = course.advance(until - done, context)?;
        if matches!(advanced, Advanced::Unfit) {
            return Ok(None);
        }
        // The end of the window is a sample too. A request to stop, or a guard, may have been heard just where one is due; what is no number is none.
        let is_due = course.steps() == sample || course.steps() == total;
        if is_due && !matches!(advanced, Advanced::Stopped(RigStop::NotFinite { .. })) {
            course.sample()?;
        }
        match advanced {
            Advanced::All | Advanced::Unfit => {}
            Advanced::Interrupted(time) => {
                course.keep()?;
                return Ok(Some(Ending::Interrupted { time }));
            }
            Advanced::Stopped(stop) => return Ok(Some(Ending::Stopped(stop))),
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

#[cfg(test)]
mod tests {
    use super::*;

    /// Ends for a reason at a step, and keeps the steps at which it was sampled.
    struct Ends {
        at: u64,
        why: fn() -> Advanced,
        steps: u64,
        samples: Vec<u64>,
        kept: usize,
    }

    impl Course for Ends {
        fn steps(&self) -> u64 {
            self.steps
        }

        fn advance(&mut self, steps: u64, _: &Context) -> Result<Advanced, RunError> {
            self.steps = (self.steps + steps).min(self.at);
            Ok(if self.steps == self.at { (self.why)() } else { Advanced::All })
        }

        fn sample(&mut self) -> Result<(), RunError> {
            self.samples.push(self.steps);
            Ok(())
        }

        fn keep(&mut self) -> Result<(), RunError> {
            self.kept += 1;
            Ok(())
        }
    }

    /// Steps of the samples of a run of 100, one after every 20 and a look at the clock after every 16, that ends at a step.
    fn samples(at: u64, why: fn() -> Advanced) -> Vec<u64> {
        let mut course = Ends { at, why, steps: 0, samples: Vec::new(), kept: 0 };
        let ending = follow(&mut course, [100, 20, 16], Duration::MAX, &Context::default()).unwrap();
        assert!(!matches!(ending, None | Some(Ending::Complete)));
        assert_eq!(course.kept, usize::from(matches!(ending, Some(Ending::Interrupted { .. }))));
        course.samples
    }

    #[test]
    fn what_is_due_where_a_run_ends_is_sampled() {
        let leaves = || {
            let body = crate::dem::rig::Body::Sphere(0);
            Advanced::Stopped(RigStop::Overlap { bodies: [body; 2], ratio: 0.2, limit: 0.1, time: 1.0 })
        };
        let is_none = || Advanced::Stopped(RigStop::NotFinite { body: crate::dem::rig::Body::Sphere(0), time: 1.0 });
        for why in [leaves, || Advanced::Interrupted(1.0)] {
            assert_eq!(samples(60, why), [20, 40, 60]);
            assert_eq!(samples(59, why), [20, 40]);
            assert_eq!(samples(100, why), [20, 40, 60, 80, 100]);
        }
        assert_eq!(samples(60, is_none), [20, 40]);
    }
}
