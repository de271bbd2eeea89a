//! Frames of beds and rigs in the plane as arrays.

use std::path::PathBuf;

use granulens::bed::{End, FRAME_SI, FRAME_UNITS, Frame, FrameContact, read_frame};
use granulens::{input, network};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::failure::{Failure, Result};
use crate::running::run;
use crate::values::{Table, shaped, vector};

/// Most bytes of frames in memory.
pub const MOST: f64 = 4e9;

/// So many frames of so many bodies, each with some two contacts, find room.
pub fn check_room(frames: u64, bodies: usize) -> Result<()> {
    let bytes = frames as f64 * bodies as f64 * (8.0 * 8.0 + 2.0 * 8.0 * 8.0);
    if bytes <= MOST {
        return Ok(());
    }
    let message = format!("{frames} frames of {bodies} bodies take some {:.1} GB", 1e-9 * bytes);
    Err(Failure::with_help(message, "Take them less often, or let the command line write them, one by one."))
}

/// Reads frames that granulens impact or simulate kept.
///
/// Parameters
/// ----------
/// folder : path
///     OUT/frames of an impact with record.every in the bed file, or of a rig with record.frames.
///
/// Returns
/// -------
/// Frames
#[pyfunction]
pub fn read_frames(py: Python<'_>, folder: PathBuf) -> PyResult<Bound<'_, PyAny>> {
    input::forget();
    let (frames, units) = run(py, Some(1), |_| -> Result<_> {
        let files = network::frames(&folder)?;
        let frames = files.iter().map(read_frame).collect::<std::result::Result<Vec<_>, _>>()?;
        // What units the numbers are in is said by the first line of each file.
        let first = input::text(&files[0][0]).unwrap_or_default();
        let units =
            if first.lines().next().is_some_and(|line| line.contains(FRAME_UNITS)) { FRAME_UNITS } else { FRAME_SI };
        Ok((frames, units))
    })??;
    self::frames(py, frames, units)
}

/// Frames of the same bodies as an object of Python.
pub fn frames<'py>(py: Python<'py>, frames: Vec<Frame>, units: &str) -> PyResult<Bound<'py, PyAny>> {
    let bodies = frames.first().map_or(&[][..], |frame| &frame.bodies[..]);
    let shape = [frames.len(), bodies.len()];
    let all = || frames.iter().flat_map(|frame| &frame.bodies);
    let pairs = |of: fn(&granulens::bed::FrameBody) -> [f64; 2]| {
        shaped(py, all().flat_map(of).collect(), [shape[0], shape[1], 2])
    };
    let values = Table::new(py)
        .with("units", units)?
        .with("period", frames.first().and_then(|frame| frame.period))?
        .with("grains", frames.first().map_or(0, Frame::grains))?
        .with("kinds", bodies.iter().map(|body| body.role.name()).collect::<Vec<_>>())?
        .with("diameters", vector(py, bodies.iter().map(|body| body.diameter).collect()))?
        .with("times", vector(py, frames.iter().map(|frame| frame.time).collect()))?
        .with("places", pairs(|body| body.place)?)?
        .with("velocities", pairs(|body| body.velocity)?)?
        .with("spins", shaped(py, all().map(|body| body.spin).collect(), shape)?)?
        .with("forces", pairs(|body| body.force)?)?
        .with("contacts", frames.iter().map(|frame| contacts(py, &frame.contacts)).collect::<PyResult<Vec<_>>>()?)?;
    py.import("granulens._run")?.getattr("Frames")?.call((), Some(&values.0))
}

/// The contacts of a frame; a body has its number from 0 on, a flat -1, an image in a mirror -2.
fn contacts<'py>(py: Python<'py>, contacts: &[FrameContact]) -> PyResult<Bound<'py, PyDict>> {
    let end = |k: usize| {
        let number = |contact: &FrameContact| match contact.ends[k] {
            End::Body(i) => i64::from(i),
            End::Flat(_) => -1,
            End::Mirror => -2,
        };
        vector(py, contacts.iter().map(number).collect())
    };
    let of = |of: &dyn Fn(&FrameContact) -> f64| vector(py, contacts.iter().map(of).collect());
    Table::new(py)
        .with("i", end(0))?
        .with("j", end(1))?
        .with("x_i", of(&|contact| contact.places[0][0]))?
        .with("z_i", of(&|contact| contact.places[0][1]))?
        .with("x_j", of(&|contact| contact.places[1][0]))?
        .with("z_j", of(&|contact| contact.places[1][1]))?
        .with("normal", of(&|contact| contact.normal))?
        .with("tangential", of(&|contact| contact.tangential))
        .map(|table| table.0)
}
