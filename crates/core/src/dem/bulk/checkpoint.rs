//! The state of a run as bytes, and back: a run that is taken up goes on to the same bits.
//!
//! A header with version and a digest of the crystal and its impact, then the numbers, little-endian, of those sections that the wave has
//! reached, then a checksum of it all. It is written and read as a stream, so that no second copy of the state is held.

use std::io::{self, Read, Write};

use super::Bulk;
use super::section::{Arrivals, Section};
use crate::dem::arrival::{ArrivalTracker, Point};

const MAGIC: &[u8; 24] = b"granulens bulk version 3";

/// Why a checkpoint cannot be written or taken up.
#[derive(Debug, thiserror::Error)]
pub enum BulkCheckpointError {
    /// It is something else, or of another version.
    #[error("this is no checkpoint of a large crystal by this version")]
    Foreign,
    /// It ends early or was changed.
    #[error("the checkpoint is damaged: its checksum does not fit")]
    Damaged,
    /// It is of another crystal, impact or record.
    #[error("the checkpoint was written for another crystal or impact")]
    Other,
    /// It cannot be read or written.
    #[error(transparent)]
    File(#[from] io::Error),
}

/// Numbers written or read at once.
const CHUNK: usize = 4096;

struct Out<'a> {
    to: &'a mut dyn Write,
    checksum: crc32fast::Hasher,
}

impl Out<'_> {
    fn bytes(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.checksum.update(bytes);
        self.to.write_all(bytes)
    }

    fn numbers(&mut self, numbers: &[f64]) -> io::Result<()> {
        let mut bytes = Vec::with_capacity(8 * CHUNK);
        for chunk in numbers.chunks(CHUNK) {
            bytes.clear();
            bytes.extend(chunk.iter().flat_map(|number| number.to_le_bytes()));
            self.bytes(&bytes)?;
        }
        Ok(())
    }
}

struct In<'a> {
    from: &'a mut dyn Read,
    checksum: crc32fast::Hasher,
}

impl In<'_> {
    fn bytes(&mut self, bytes: &mut [u8]) -> Result<(), BulkCheckpointError> {
        self.from.read_exact(bytes).map_err(|error| match error.kind() {
            io::ErrorKind::UnexpectedEof => BulkCheckpointError::Damaged,
            _ => BulkCheckpointError::File(error),
        })?;
        self.checksum.update(bytes);
        Ok(())
    }

    fn numbers(&mut self, numbers: &mut [f64]) -> Result<(), BulkCheckpointError> {
        let mut bytes = vec![0; 8 * CHUNK];
        for chunk in numbers.chunks_mut(CHUNK) {
            let bytes = &mut bytes[..8 * chunk.len()];
            self.bytes(bytes)?;
            for (number, bytes) in chunk.iter_mut().zip(bytes.chunks_exact(8)) {
                *number = f64::from_le_bytes(bytes.try_into().unwrap_or_default());
            }
        }
        Ok(())
    }

    fn count(&mut self) -> Result<u64, BulkCheckpointError> {
        let mut bytes = [0; 8];
        self.bytes(&mut bytes)?;
        Ok(u64::from_le_bytes(bytes))
    }
}

impl Bulk {
    /// Writes the state; in a file of its own, by way of a buffer of some kilobytes or none.
    ///
    /// # Errors
    /// What is written to fails.
    pub fn save(&self, to: &mut dyn Write) -> io::Result<()> {
        let mut out = Out { to, checksum: crc32fast::Hasher::new() };
        out.bytes(MAGIC)?;
        out.bytes(&self.digest().to_le_bytes())?;
        out.bytes(&self.steps.to_le_bytes())?;
        out.numbers(&self.few())?;
        out.numbers(&self.judged)?;
        for section in &self.sections {
            out.bytes(&[u8::from(section.any_active)])?;
        }
        for (k, section) in self.sections.iter().enumerate().filter(|(_, section)| section.any_active) {
            let active: Vec<u8> = section.active.iter().map(|&active| u8::from(active)).collect();
            out.bytes(&active)?;
            for numbers in section.x.iter().chain(&section.predicted) {
                out.numbers(numbers.get())?;
            }
            let rest = [&section.past, &section.speed_squared, &section.acceleration_squared, &section.store.numbers];
            for numbers in rest {
                out.numbers(numbers.get())?;
            }
            match &section.arrivals {
                Arrivals::None => {}
                Arrivals::Speed(_, times) => out.numbers(times)?,
                Arrivals::Own(trackers) => {
                    for ArrivalTracker { points, last, base, previous } in trackers {
                        out.bytes(&(points.len() as u64).to_le_bytes())?;
                        out.numbers(&[*previous, *base])?;
                        for &Point { speed, steps } in points.iter().chain([last]) {
                            out.numbers(&[speed])?;
                            out.bytes(&steps.to_le_bytes())?;
                        }
                    }
                }
            }
            // A seam belongs to the section above it, and acts only where that or the one below is reached.
            for seam in [k.checked_sub(1), Some(k)].into_iter().flatten().filter(|&seam| self.keeps_seam(seam, k)) {
                out.numbers(self.seams[seam].store.numbers.get())?;
            }
        }
        let checksum = out.checksum.clone().finalize();
        out.to.write_all(&checksum.to_le_bytes())
    }

    /// Takes up a state that was written of the same crystal under the same impact; where this fails the crystal is to be made anew.
    ///
    /// # Errors
    /// See [`BulkCheckpointError`].
    pub fn restore(&mut self, from: &mut dyn Read) -> Result<(), BulkCheckpointError> {
        let mut source = In { from, checksum: crc32fast::Hasher::new() };
        let mut magic = [0; 24];
        source.bytes(&mut magic)?;
        if magic != *MAGIC {
            return Err(BulkCheckpointError::Foreign);
        }
        let mut digest = [0; 4];
        source.bytes(&mut digest)?;
        if u32::from_le_bytes(digest) != self.digest() {
            return Err(BulkCheckpointError::Other);
        }
        self.steps = source.count()?;
        let mut few = self.few();
        source.numbers(&mut few)?;
        [self.work[0], self.work[1], self.exit[0], self.exit[1], self.strangers.way, self.strangers.room] = few;
        source.numbers(&mut self.judged)?;
        let mut any = vec![0; self.sections.len()];
        source.bytes(&mut any)?;
        for (section, any) in self.sections.iter_mut().zip(any) {
            section.any_active = any == 1;
        }
        for k in 0..self.sections.len() {
            if !self.sections[k].any_active {
                continue;
            }
            read_section(&mut source, &mut self.sections[k])?;
            let seams = [k.checked_sub(1), Some(k)].into_iter().flatten();
            for seam in seams.filter(|&seam| self.keeps_seam(seam, k)).collect::<Vec<usize>>() {
                source.numbers(self.seams[seam].store.numbers.get_mut())?;
            }
        }
        let expected = source.checksum.clone().finalize();
        let mut checksum = [0; 4];
        source.bytes(&mut checksum)?;
        if u32::from_le_bytes(checksum) != expected {
            return Err(BulkCheckpointError::Damaged);
        }
        self.terms.load = self.load(self.steps);
        Ok(())
    }

    /// Whether a seam is written with a section: with the first of its two that is reached.
    fn keeps_seam(&self, seam: usize, section: usize) -> bool {
        seam < self.seams.len() && (section == seam || !self.sections[seam].any_active)
    }

    fn few(&self) -> [f64; 6] {
        let ([work, ahead], [momentum, force]) = (self.work, self.exit);
        [work, ahead, momentum, force, self.strangers.way, self.strangers.room]
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

fn read_section(source: &mut In<'_>, section: &mut Section) -> Result<(), BulkCheckpointError> {
    let mut active = vec![0; section.active.len()];
    source.bytes(&mut active)?;
    section.active = active.into_iter().map(|active| active == 1).collect();
    for numbers in section.x.iter_mut().chain(&mut section.predicted) {
        source.numbers(numbers.get_mut())?;
    }
    let Section { past, speed_squared, acceleration_squared, store, .. } = section;
    for numbers in [past, speed_squared, acceleration_squared, &mut store.numbers] {
        source.numbers(numbers.get_mut())?;
    }
    match &mut section.arrivals {
        Arrivals::None => {}
        Arrivals::Speed(_, times) => source.numbers(times)?,
        Arrivals::Own(trackers) => {
            for tracker in trackers {
                let count = source.count()?;
                let mut speeds = [0.0; 2];
                source.numbers(&mut speeds)?;
                [tracker.previous, tracker.base] = speeds;
                tracker.points.clear();
                for n in 0..=count {
                    let (mut speed, mut steps) = ([0.0], [0; 4]);
                    source.numbers(&mut speed)?;
                    source.bytes(&mut steps)?;
                    let point = Point { speed: speed[0], steps: u32::from_le_bytes(steps) };
                    if n < count {
                        tracker.points.push(point);
                    } else {
                        tracker.last = point;
                    }
                }
            }
        }
    }
    Ok(())
}
