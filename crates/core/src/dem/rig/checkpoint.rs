//! The state of a rig as bytes, and back: a run that is taken up goes on to the same bits.
//!
//! A header with format and version, a checksum of all that follows, then the state as `postcard` writes it. The rig itself
//! is not in it, only a digest: the file that describes the rig is read again, and must describe the same.

use std::fmt::Write as _;

use serde::{Deserialize, Serialize};

use super::{Arrival, Rig};
use crate::dem::Integrator;
use crate::dem::arrival::ArrivalTracker;
use crate::dem::checkpoint::{CheckpointError, sealed_behind, unsealed};

const MAGIC: &[u8; 20] = b"granulens checkpoint";
const VERSION: u32 = 8;

/// The whole state of a run, flattened to numbers.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct State {
    pub digest: u32,
    pub step: f64,
    pub count: u64,
    pub motion: Motion,
    pub integrator: Integrator,
    /// Accelerations of earlier states, where the scheme asks for them.
    pub past: Option<Accelerations>,
    pub work_in: f64,
    pub absorbed: f64,
    pub at_hand: f64,
    pub held_back: f64,
    pub near: Vec<[u32; 2]>,
    pub images: Vec<i8>,
    pub faces: Vec<(u32, bool, u32)>,
    pub memory: Vec<f64>,
    pub stretch: Vec<f64>,
    pub extra: Vec<f64>,
    pub account: Vec<f64>,
    pub kept_pairs: Vec<([u32; 2], Vec<i8>, Vec<f64>)>,
    pub kept_faces: Vec<((u32, bool, u32), Vec<f64>)>,
    pub lost: [f64; 2],
    pub lost_by_sphere: Vec<f64>,
    pub peaks: Option<PeaksSoFar>,
}

/// How bodies move, what acts on them, and where near pairs were last looked for; vectors one after the other.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Motion {
    pub displacement: Vec<f64>,
    pub velocity: Vec<f64>,
    pub acceleration: Vec<f64>,
    pub spin: Vec<f64>,
    pub spin_rate: Vec<f64>,
    pub flat_moved: Vec<f64>,
    pub flat_velocity: Vec<f64>,
    pub flat_acceleration: Vec<f64>,
    pub seen: Vec<f64>,
    pub flat_seen: Vec<f64>,
    pub skin: Vec<f64>,
    pub force: Vec<f64>,
    pub torque: Vec<f64>,
    pub flat_force: Vec<f64>,
    /// The numbers of each cluster, one after the other.
    pub clusters: Vec<f64>,
}

/// Accelerations one and two steps ago.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct Accelerations {
    pub spheres: [Vec<f64>; 2],
    pub spins: [Vec<f64>; 2],
    pub flats: [Vec<f64>; 2],
    pub clusters: [Vec<f64>; 2],
}

/// What spheres had at most, and when they moved; see [`Peaks`](super::peaks::Peaks).
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub(super) struct PeaksSoFar {
    pub arrivals: Vec<Arrival>,
    pub speed_squared: Vec<f64>,
    pub force_squared: Vec<f64>,
    pub passed: Vec<Vec<f64>>,
    pub moved_before: Vec<f64>,
    pub trackers: Vec<ArrivalTracker>,
}

impl State {
    pub fn to_bytes(&self) -> Vec<u8> {
        let mut bytes = MAGIC.to_vec();
        bytes.extend(VERSION.to_le_bytes());
        sealed_behind(bytes, self)
    }

    pub fn from_bytes(bytes: &[u8]) -> Result<Self, CheckpointError> {
        let rest = bytes.strip_prefix(MAGIC).ok_or(CheckpointError::Foreign)?;
        let (version, rest) = rest.split_first_chunk::<4>().ok_or(CheckpointError::Damaged)?;
        let version = u32::from_le_bytes(*version);
        if version != VERSION {
            return Err(CheckpointError::Version { of: version, read: VERSION });
        }
        unsealed(rest).ok_or(CheckpointError::Damaged)
    }
}

/// A checksum over everything that a rig is.
pub(super) fn digest<const D: usize>(rig: &Rig<D>) -> u32 {
    struct Hashing(crc32fast::Hasher);
    impl std::fmt::Write for Hashing {
        fn write_str(&mut self, text: &str) -> std::fmt::Result {
            self.0.update(text.as_bytes());
            Ok(())
        }
    }
    let mut hashing = Hashing(crc32fast::Hasher::new());
    // Numbers print with all their digits, so that two rigs that differ in a bit differ here.
    let _ = write!(hashing, "{rig:?}");
    hashing.0.finalize()
}
