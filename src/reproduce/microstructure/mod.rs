//! Kondic et al. 2012, section IV: the force network and the motion of grains while an intruder comes in; and of Takahashi et al. 2018
//! whether loops of the network tell of the intruder's deceleration.
//!
//! Of the figures only captions and text are known, so claims in words are tested. Published Betti numbers are those of thresholded
//! pictures of the grains; ours those of the network on particles: a grain is there where the sum of the forces at its contacts exceeds
//! the threshold, two of them are joined where they touch. Beds as in `kondic`, 0.6 of the published ones in every length. What is
//! compared is so bed by bed, and the mean over beds is given with its 95 % interval.
//!
//! - `forces`: chains, normal and tangential forces, the front; `network`: its components and loops
//! - `movement`: how grains move, where the energy goes; `intruder`: its acceleration and depth

mod forces;
mod intruder;
mod movement;
mod network;

use std::sync::Arc;

use super::Wanted::Above;
use super::kondic::{SPEED, disk};
use super::{Part, Row, RowError};
use crate::Context;
use crate::bed::{Bed, BedImpact, Frame, Grains, Moment, Strike};
use crate::stats::Mean;

/// All of them.
pub(super) fn rows() -> impl Iterator<Item = &'static Row> {
    [forces::ROWS, network::ROWS, movement::ROWS, intruder::ROWS].into_iter().flatten()
}

/// Time between two frames (τ_c).
const EVERY: f64 = 2.0;
/// How long impacts are followed here (τ_c).
const WINDOW: f64 = 120.0;

/// Follows an impact and shows its frames.
fn watch(
    bed: &Bed,
    grains: Grains,
    window: f64,
    context: &Context,
    show: impl FnMut(&Moment, &Frame),
) -> Result<(), RowError> {
    let impact = BedImpact { sample: EVERY, ..BedImpact::new(grains, disk(SPEED), window) };
    watch_impact(bed, &impact, context, show)
}

fn watch_impact(
    bed: &Bed,
    impact: &BedImpact,
    context: &Context,
    mut show: impl FnMut(&Moment, &Frame),
) -> Result<(), RowError> {
    let mut strike = Strike::new(bed, impact)?;
    show(strike.moment(), &strike.frame());
    while strike.goes_on() {
        strike.go_on(context);
        if let Some(stop) = strike.stop() {
            return Err(stop.clone().into());
        }
        show(strike.moment(), &strike.frame());
    }
    Ok(())
}

/// A number of each bed.
fn of_each(beds: &[Arc<Bed>], measure: impl Fn(&Bed) -> Result<f64, RowError>) -> Result<Vec<f64>, RowError> {
    beds.iter().map(|bed| measure(bed)).collect()
}

/// The lower end of the 95 % interval of a mean.
fn lower_end(values: &[f64]) -> f64 {
    let mean = Mean::of(values);
    mean.mean - mean.interval.unwrap_or(f64::INFINITY)
}

/// Two numbers of a ratio, bed by bed, that is claimed to be above this: its mean, and the lower end of the mean's interval.
fn above(what: &str, words: &str, ratios: &[f64], limit: f64) -> [Part; 2] {
    [
        Part::words(what, words, Mean::of(ratios).mean, "", Above(limit)),
        Part::words(format!("{what}: lower end"), words, lower_end(ratios), "", Above(limit)),
    ]
}

/// One over the other, bed by bed.
fn ratios(these: &[f64], those: &[f64]) -> Vec<f64> {
    these.iter().zip(those).map(|(this, that)| this / that).collect()
}
