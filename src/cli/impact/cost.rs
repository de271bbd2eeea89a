//! `--dry-run` of impacts: a moment of one, on a bed that is at rest already.

use std::time::Instant;

use granulens::Context;
use granulens::bed::{Bed, BedFile, Ensemble, Origin, strike};

use super::super::Common;
use super::super::cost::{Part, TASTE, tell};
use super::super::failure::Failure;
use super::beds::{load, place};

/// Says what beds would settle, which takes as long as it takes, and what their impacts would cost.
pub fn of(common: &Common, file: &BedFile, ensemble: Option<&Ensemble>, fresh: bool) -> Result<(), Failure> {
    let beds = ensemble.map_or(1, |ensemble| ensemble.samples);
    let (mut known, mut to_settle) = (None, 0);
    match &file.origin {
        Origin::File(path) => known = Some(load(path)?),
        Origin::Pile(pile) => {
            for k in 0..u64::from(beds) {
                let mut pile = *pile;
                pile.seed = pile.seed.wrapping_add(k);
                let path = place(&pile, &file.impact.grains);
                match path.exists() && !fresh {
                    true if known.is_none() => known = Some(load(&path)?),
                    true => {}
                    false => to_settle += 1,
                }
            }
        }
    }
    let impacts = ensemble.map_or(1, |ensemble| ensemble.cases().len() as u64);
    let seconds = known.map(|bed| one(&bed, file)).transpose()?;
    let mut parts = Vec::new();
    if to_settle > 0 {
        parts.push(Part::new("beds that settle first", to_settle, None));
    }
    parts.push(Part::new("impacts", impacts, seconds.map(|seconds| seconds * impacts as f64)));
    tell(common, &parts)
}

/// Time of one core for an impact (s).
fn one(bed: &Bed, file: &BedFile) -> Result<f64, Failure> {
    let (over, begun) = (Context::default(), Instant::now());
    let mut reached = 0.0;
    strike(bed, &file.impact, &over, |moment| {
        reached = moment.time;
        if begun.elapsed().as_secs_f64() > TASTE {
            over.stop();
        }
    })
    .map_err(|error| Failure::input(error.to_string()))?;
    Ok(begun.elapsed().as_secs_f64() * (file.impact.window / reached).max(1.0))
}
