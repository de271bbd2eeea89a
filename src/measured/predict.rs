//! The rig run with its inputs at some values, and what its channels show.

use super::{Channel, Input};
use crate::Context;
use crate::dem::rig::{RigError, RigStop, Simulation};
use crate::dem::{MoveIn, Spheres};
use crate::setup::PreparedRig;

/// What the channels of a rig show, sample by sample.
#[derive(Clone, Debug, PartialEq)]
pub struct Prediction {
    /// Time between two samples (s); the first is at 0.
    pub interval: f64,
    /// For each channel its samples.
    pub values: Vec<Vec<f64>>,
}

/// A run that could not be.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PredictError {
    /// The rig cannot be set in motion.
    #[error(transparent)]
    Rig(#[from] RigError),
    /// A guard stopped it, or the caller.
    #[error("{0}")]
    Stopped(RigStop),
}

/// Most samples of a prediction.
const MOST: u64 = 4000;

/// Runs a rig to the end of its window with inputs at values.
///
/// # Errors
/// See [`PredictError`].
pub fn predict<const D: usize>(
    prepared: &PreparedRig<D>,
    channels: &[Channel],
    inputs: &[(Input, f64)],
    context: &Context,
) -> Result<Prediction, PredictError>
where
    Spheres: MoveIn<D>,
{
    let mut prepared = prepared.clone();
    inputs.iter().for_each(|(input, value)| input.set(&mut prepared.rig, *value));
    let step = prepared.plan.step;
    let steps = prepared.plan.steps();
    let every = steps.div_ceil(MOST).max(1);
    let mut simulation = prepared.simulation()?;
    let mut values = vec![Vec::new(); channels.len()];
    for _ in 0..steps.div_ceil(every) {
        see(&simulation, channels, &prepared, &mut values);
        simulation.advance(every, context).map_err(PredictError::Stopped)?;
    }
    see(&simulation, channels, &prepared, &mut values);
    Ok(Prediction { interval: step * every as f64, values })
}

fn see<const D: usize>(
    simulation: &Simulation<D>,
    channels: &[Channel],
    prepared: &PreparedRig<D>,
    values: &mut [Vec<f64>],
) {
    let view = simulation.view();
    for (channel, values) in channels.iter().zip(values) {
        values.push(channel.value(&view, prepared));
    }
}

impl Prediction {
    /// A channel at a time (s), linear between samples. Before the start everything is as at the start; after the end nothing is known.
    pub fn at(&self, channel: usize, time: f64) -> Option<f64> {
        let values = &self.values[channel];
        let place = time / self.interval;
        if place <= 0.0 {
            return values.first().copied();
        }
        let below = place.floor() as usize;
        if below + 1 >= values.len() {
            return (below + 1 == values.len() && place.fract() == 0.0).then(|| values[below]);
        }
        Some(values[below] + place.fract() * (values[below + 1] - values[below]))
    }

    /// When it ends (s).
    pub fn end(&self) -> f64 {
        self.interval * (self.values.first().map_or(1, Vec::len) - 1) as f64
    }
}
