//! Where the time goes: what the parts of a run take, measured while it runs.

use std::ops::AddAssign;
use std::time::{Duration, Instant};

/// Time that passed in the parts of a run (s).
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Phases {
    /// Finding contacts and making their laws.
    pub preparing: f64,
    /// Moving the spheres.
    pub motion: f64,
    /// Forces and memories of the contacts.
    pub contacts: f64,
    /// Maxima, guards.
    pub watching: f64,
}

impl Phases {
    /// All of it (s).
    pub fn total(&self) -> f64 {
        self.preparing + self.motion + self.contacts + self.watching
    }
}

impl AddAssign for Phases {
    fn add_assign(&mut self, other: Self) {
        self.preparing += other.preparing;
        self.motion += other.motion;
        self.contacts += other.contacts;
        self.watching += other.watching;
    }
}

/// A part of a run.
#[derive(Clone, Copy)]
pub(super) enum Phase {
    Preparing,
    Motion,
    Contacts,
    Watching,
}

/// Looked at when a part ends, some four times a step, which costs a ten-thousandth of the step of a lens; or never.
pub(super) struct Clock {
    last: Option<Instant>,
    spent: [Duration; 4],
}

impl Clock {
    /// Runs from now on, if at all.
    pub fn new(runs: bool) -> Self {
        Self { last: runs.then(Instant::now), spent: [Duration::ZERO; 4] }
    }

    /// The time since the last call was spent on this.
    #[inline]
    pub fn lap(&mut self, phase: Phase) {
        if let Some(last) = &mut self.last {
            let now = Instant::now();
            self.spent[phase as usize] += now - *last;
            *last = now;
        }
    }

    pub fn phases(&self) -> Phases {
        let [preparing, motion, contacts, watching] = self.spent.map(|spent| spent.as_secs_f64());
        Phases { preparing, motion, contacts, watching }
    }
}
