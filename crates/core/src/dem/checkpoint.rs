//! States as bytes: sealed behind a checksum, and what is wrong with those that cannot be taken up.

use serde::Serialize;
use serde::de::DeserializeOwned;

/// Why a checkpoint cannot be taken up.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum CheckpointError {
    /// It is something else.
    #[error("this is no checkpoint of granulens")]
    Foreign,
    /// It was written by another version.
    #[error("the checkpoint has version {of}; this program reads version {read}")]
    Version {
        /// That of its format.
        of: u32,
        /// That which is read.
        read: u32,
    },
    /// It ends early or was changed.
    #[error("the checkpoint is damaged: its checksum does not fit")]
    Damaged,
    /// It is of another rig or crystal, or of another step.
    #[error("the checkpoint was written for another {0}")]
    Other(&'static str),
}

/// A value as `postcard` writes it, behind a checksum of that.
pub fn sealed(value: &impl Serialize) -> Vec<u8> {
    sealed_behind(Vec::new(), value)
}

/// The same behind other bytes. Written there at once: states are large.
pub fn sealed_behind(mut bytes: Vec<u8>, value: &impl Serialize) -> Vec<u8> {
    let checksum = bytes.len()..bytes.len() + 4;
    bytes.extend([0; 4]);
    let mut bytes = postcard::to_extend(value, bytes).expect("numbers, texts and lists of them can always be written");
    let hash = crc32fast::hash(&bytes[checksum.end..]);
    bytes[checksum].copy_from_slice(&hash.to_le_bytes());
    bytes
}

/// The value that [`sealed`] made these bytes of; none where their checksum does not fit, or they are of another type.
pub fn unsealed<T: DeserializeOwned>(bytes: &[u8]) -> Option<T> {
    let (checksum, body) = bytes.split_first_chunk::<4>()?;
    let whole = crc32fast::hash(body) == u32::from_le_bytes(*checksum);
    whole.then(|| postcard::from_bytes(body).ok())?
}
