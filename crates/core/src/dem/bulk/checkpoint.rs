//! The state of a run as bytes, and back: a run that is taken up goes on to the same bits.
//!
//! Words with the version, then blocks, each its length and a [`sealed`] value: what is so of the whole crystal, and what each section remembers that the wave has
//! reached. It is written and read as a stream, so that no more than a section's state is ever held twice.

use std::borrow::Cow;
use std::io::{self, Read, Write};

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use super::Bulk;
use super::section::{Arrivals, Section};
use crate::dem::arrival::ArrivalTracker;
use crate::dem::checkpoint::{CheckpointError, sealed, unsealed};

/// The version follows as a digit.
const MAGIC: &[u8; 23] = b"granulens bulk version ";
const VERSION: u8 = 4;
const _: () = assert!(VERSION < 10, "the version is one digit");

/// Why a checkpoint cannot be written or taken up.
#[derive(Debug, thiserror::Error)]
pub enum BulkCheckpointError {
    /// Its state.
    #[error(transparent)]
    State(#[from] CheckpointError),
    /// It cannot be read.
    #[error(transparent)]
    File(#[from] io::Error),
}

/// What is so of the whole crystal.
#[derive(Debug, PartialEq, Serialize, Deserialize)]
struct Whole {
    digest: u32,
    steps: u64,
    /// Work of the load so far, and in the step to come (J).
    work: [f64; 2],
    /// Greatest momentum (kg m/s) and force (N) of the exit.
    exit: [f64; 2],
    /// How far spheres can have come since strangers were looked for, and how far they may.
    way: f64,
    room: f64,
    judged: Vec<f64>,
    /// Which sections the wave has reached.
    reached: Vec<bool>,
}

/// What a section remembers that the wave has reached; see [`Section`].
#[derive(Debug, PartialEq, Serialize, Deserialize)]
struct Remembered<'a> {
    /// Of its rows, those that the wave has reached.
    active: Cow<'a, [bool]>,
    displacement: [Cow<'a, [f64]>; 3],
    predicted: [Cow<'a, [f64]>; 3],
    past: Cow<'a, [f64]>,
    speed_squared: Cow<'a, [f64]>,
    acceleration_squared: Cow<'a, [f64]>,
    contacts: Cow<'a, [f64]>,
    /// Contacts with the sections before and after it. They stand with the first of the two that is reached.
    before: Option<Cow<'a, [f64]>>,
    after: Option<Cow<'a, [f64]>>,
    /// First arrivals, as times or by what they follow from; of what is recorded.
    times: Cow<'a, [f64]>,
    trackers: Cow<'a, [ArrivalTracker]>,
}

/// Writes a block.
fn put(to: &mut dyn Write, value: &impl Serialize) -> io::Result<()> {
    let block = sealed(value);
    to.write_all(&(block.len() as u64).to_le_bytes())?;
    to.write_all(&block)
}

/// Reads so many bytes, or what there is where there are fewer.
fn bytes(from: &mut dyn Read, count: u64) -> io::Result<Vec<u8>> {
    let mut bytes = Vec::new();
    from.take(count).read_to_end(&mut bytes)?;
    Ok(bytes)
}

/// Reads a block.
fn take<T: DeserializeOwned>(from: &mut dyn Read) -> Result<T, BulkCheckpointError> {
    let length = bytes(from, 8)?.try_into().map_err(|_| CheckpointError::Damaged)?;
    Ok(unsealed(&bytes(from, u64::from_le_bytes(length))?).ok_or(CheckpointError::Damaged)?)
}

/// Puts what was remembered in its place, which has room for as much.
fn fill<T: Copy>(place: &mut [T], remembered: &[T]) -> Result<(), CheckpointError> {
    if place.len() != remembered.len() {
        return Err(CheckpointError::Damaged);
    }
    place.copy_from_slice(remembered);
    Ok(())
}

impl Bulk {
    /// Writes the state; in a file of its own.
    ///
    /// # Errors
    /// What is written to fails.
    pub fn save(&self, to: &mut dyn Write) -> io::Result<()> {
        to.write_all(MAGIC)?;
        to.write_all(&[b'0' + VERSION])?;
        put(
            to,
            &Whole {
                digest: self.digest(),
                steps: self.steps,
                work: self.work,
                exit: self.exit,
                way: self.strangers.way,
                room: self.strangers.room,
                judged: self.judged.clone(),
                reached: self.sections.iter().map(|section| section.any_active).collect(),
            },
        )?;
        for (k, section) in self.sections.iter().enumerate().filter(|(_, section)| section.any_active) {
            let seam = |seam: Option<usize>| {
                let seam = seam.filter(|&seam| self.keeps_seam(seam, k))?;
                Some(self.seams[seam].store.numbers.get().into())
            };
            put(to, &section.remembered([seam(k.checked_sub(1)), seam(Some(k))]))?;
        }
        Ok(())
    }

    /// Takes up a state that was written of the same crystal under the same impact; where this fails the crystal is to be made anew.
    ///
    /// # Errors
    /// See [`BulkCheckpointError`].
    pub fn restore(&mut self, from: &mut dyn Read) -> Result<(), BulkCheckpointError> {
        let opening = bytes(from, MAGIC.len() as u64 + 1)?;
        match opening.strip_prefix(MAGIC) {
            Some([version]) if *version == b'0' + VERSION => {}
            Some([version @ b'0'..=b'9']) => {
                let [of, read] = [version - b'0', VERSION].map(u32::from);
                return Err(CheckpointError::Version { of, read }.into());
            }
            _ => return Err(CheckpointError::Foreign.into()),
        }
        let Whole { digest, steps, work, exit, way, room, judged, reached } = take(from)?;
        if digest != self.digest() {
            return Err(CheckpointError::Other("crystal or impact").into());
        }
        if reached.len() != self.sections.len() {
            return Err(CheckpointError::Damaged.into());
        }
        (self.steps, self.work, self.exit) = (steps, work, exit);
        (self.strangers.way, self.strangers.room) = (way, room);
        fill(&mut self.judged, &judged)?;
        for (section, reached) in self.sections.iter_mut().zip(reached) {
            section.any_active = reached;
        }
        for k in 0..self.sections.len() {
            if !self.sections[k].any_active {
                continue;
            }
            let mut remembered: Remembered<'_> = take(from)?;
            for (seam, contacts) in [(k.checked_sub(1), remembered.before.take()), (Some(k), remembered.after.take())] {
                match (seam.filter(|&seam| self.keeps_seam(seam, k)), contacts) {
                    (Some(seam), Some(contacts)) => fill(self.seams[seam].store.numbers.get_mut(), &contacts)?,
                    (None, None) => {}
                    _ => return Err(CheckpointError::Damaged.into()),
                }
            }
            self.sections[k].recall(remembered)?;
        }
        self.terms.load = self.load(self.steps);
        Ok(())
    }

    /// Whether a seam is written with a section: with the first of its two that is reached.
    fn keeps_seam(&self, seam: usize, section: usize) -> bool {
        seam < self.seams.len() && (section == seam || !self.sections[seam].any_active)
    }

    /// Of all that a run is made by.
    fn digest(&self) -> u32 {
        let mut hasher = crc32fast::Hasher::new();
        let impact = &self.impact;
        let window = crate::dem::Impact { window: 0.0, ..impact.clone() };
        hasher.update(format!("{window:?} {:?} {:?}", self.materials, self.recording).as_bytes());
        for section in &self.sections {
            hasher.update(&section.kinds);
        }
        for row in &self.found.rows {
            let [x, y, z] = row.centre.map(f64::to_le_bytes);
            hasher.update(&[(row.count as u64).to_le_bytes(), x, y, z].concat());
        }
        hasher.finalize()
    }
}

impl Section {
    fn remembered<'a>(&'a self, [before, after]: [Option<Cow<'a, [f64]>>; 2]) -> Remembered<'a> {
        let (times, trackers) = match &self.arrivals {
            Arrivals::None => (&[][..], &[][..]),
            Arrivals::Speed(_, times) => (&times[..], &[][..]),
            Arrivals::Own(trackers) => (&[][..], &trackers[..]),
        };
        Remembered {
            active: self.active[..].into(),
            displacement: self.x.each_ref().map(|axis| axis.get().into()),
            predicted: self.predicted.each_ref().map(|axis| axis.get().into()),
            past: self.past.get().into(),
            speed_squared: self.speed_squared.get().into(),
            acceleration_squared: self.acceleration_squared.get().into(),
            contacts: self.store.numbers.get().into(),
            before,
            after,
            times: times.into(),
            trackers: trackers.into(),
        }
    }

    /// Seams are not the section's.
    fn recall(&mut self, remembered: Remembered<'_>) -> Result<(), CheckpointError> {
        fill(&mut self.active, &remembered.active)?;
        let axes = self.x.iter_mut().zip(&remembered.displacement);
        for (axis, numbers) in axes.chain(self.predicted.iter_mut().zip(&remembered.predicted)) {
            fill(axis.get_mut(), numbers)?;
        }
        fill(self.past.get_mut(), &remembered.past)?;
        fill(self.speed_squared.get_mut(), &remembered.speed_squared)?;
        fill(self.acceleration_squared.get_mut(), &remembered.acceleration_squared)?;
        fill(self.store.numbers.get_mut(), &remembered.contacts)?;
        match &mut self.arrivals {
            Arrivals::None => Ok(()),
            Arrivals::Speed(_, times) => fill(times, &remembered.times),
            Arrivals::Own(trackers) if trackers.len() == remembered.trackers.len() => {
                *trackers = remembered.trackers.into_owned();
                Ok(())
            }
            Arrivals::Own(_) => Err(CheckpointError::Damaged),
        }
    }
}
