//! Beds at rest, kept in `reports/beds` and used again.

use std::path::{Path, PathBuf};
use std::time::Instant;

use granulens::Context;
use granulens::bed::{Bed, Damping, Grains, Pile, SettleError, Settled, read, settle, stop_words, write};
use granulens::dem::rig::RigStop;

use super::super::failure::Failure;

/// A bed from its file.
pub fn load(path: &Path) -> Result<Bed, Failure> {
    read(path).map_err(|error| Failure::input(error.to_string()))
}

/// What a bed's rest depends on. Friction rests while it settles, so that beds with and without share their rest.
fn recipe(pile: &Pile, grains: &Grains) -> String {
    let rest = serde_json::json!({
        "pile": pile,
        "stiffness": grains.stiffness,
        "gravity": grains.gravity,
        "restitution": [grains.grains.restitution, grains.walls.restitution],
        "exact": grains.damping == Damping::Exact,
        "cut": grains.cut,
    });
    rest.to_string()
}

/// Where a bed at rest is kept.
pub fn place(pile: &Pile, grains: &Grains) -> PathBuf {
    let key = crc32fast::hash(recipe(pile, grains).as_bytes());
    Path::new("reports/beds").join(format!("bed-{key:08x}.csv"))
}

/// Lets a pile settle and keeps the bed; the seconds that took.
pub fn pour(file: &Path, pile: &Pile, grains: &Grains, context: &Context) -> Result<(Bed, f64), Failure> {
    let begun = Instant::now();
    let Settled { bed, time, smoothed } = settle(pile, grains, context).map_err(|error| match error {
        SettleError::Stop(RigStop::Interrupted { .. }) => {
            Failure::Interrupted("the bed had not settled yet; it was not kept".to_owned())
        }
        SettleError::Stop(stop) => Failure::Guard(vec![stop_words(&stop)]),
        error => Failure::input(format!("{}: {error}", file.display())),
    })?;
    let notes = format!(
        "A bed at rest after {time:.0} tau_c; {smoothed} grains taken off its surface.\nMade from {}",
        recipe(pile, grains)
    );
    write(&place(pile, grains), &bed, &notes).map_err(|error| Failure::input(error.to_string()))?;
    Ok((bed, begun.elapsed().as_secs_f64()))
}
