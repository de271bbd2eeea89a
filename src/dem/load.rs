//! What strikes the crystal.

/// A constant force along +z on every sphere of the first row.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ForcePulse {
    /// Force on each struck sphere [N].
    pub force: f64,
    /// How long it lasts [s].
    pub duration: f64,
}
