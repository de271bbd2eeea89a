//! Measured histories drawn on the prediction: aligned in time, compared, and uncertain inputs fitted to them.
//!
//! In: [`Data`], times with columns of force, velocity or displacement, and a [`PreparedRig`](crate::setup::PreparedRig), the rig that was built.
//! Out: a [`Comparison`], and a page of it. Columns are named as `simulate` names those of its records.
//!
//! - `data`: the file; `channel`: what a column means in a rig
//! - `input`: what is uncertain; `predict`: the rig run with its inputs
//! - `align`: the prediction on the clock of the measurement
//! - `fit`: least squares; `compare`: arrivals, peaks, residuals
//! - `page`: words, tables and pictures

mod align;
mod channel;
mod compare;
mod data;
mod fit;
mod input;
mod page;
mod predict;

pub use channel::Channel;
pub use compare::{Comparison, Features, Matched, compare};
pub use data::{Data, DataError, Record};
pub use fit::{Fit, Fitted, fit};
pub use input::{Input, InputError};
pub use page::{curves_csv, page};
pub use predict::{PredictError, Prediction, predict};
