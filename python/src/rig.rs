//! Anything a lab can build, strike and measure: histories in memory, or records on disk as `granulens simulate` writes them.

use std::path::PathBuf;
use std::time::Duration;

use granulens::Context;
use granulens::bed::{FRAME_SI, Frame};
use granulens::dem::rig::{EnergyLedger, RigStop, Simulation};
use granulens::dem::{MoveIn, Spheres};
use granulens::run::{self, Ending, Keeping};
use granulens::setup::{PreparedRig, Setup};
use granulens::{input, output, report};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::design::Layout;
use crate::failure::{Failure, Result};
use crate::frames;
use crate::running::run;
use crate::values::{Table, Time, nested, points, shaped, vector};

/// A rig, from a file with kind = "rig" or from a lens design, whose proposed lens is then set up under its impact.
#[pyclass(frozen, module = "granulens")]
pub struct Rig {
    setup: Setup,
}

/// Runs a piece of code with the prepared rig of whatever dimension.
macro_rules! with_rig {
    ($setup:expr, $prepared:ident => $code:expr) => {
        match $setup {
            Setup::One($prepared) => $code,
            Setup::Two($prepared) => $code,
            Setup::Three($prepared) => $code,
        }
    };
}

#[pymethods]
impl Rig {
    #[new]
    #[pyo3(signature = (path, *, seed = None))]
    fn new(path: PathBuf, seed: Option<u64>) -> Result<Self> {
        Ok(Self { setup: Setup::read_seeded(path, seed)? })
    }

    /// A layout of a design under the design's impact, as a rig.
    #[staticmethod]
    fn of_layout(layout: &Bound<'_, Layout>) -> Result<Self> {
        let Layout { inner, design } = layout.get();
        Ok(Self { setup: Setup::of_layout(design, inner)? })
    }

    /// Checks the text of a rig file; path is what messages call it.
    #[staticmethod]
    #[pyo3(signature = (text, path = PathBuf::from("rig.toml")))]
    fn parse(text: &str, path: PathBuf) -> Result<Self> {
        Ok(Self { setup: Setup::parse(path, text)? })
    }

    /// Name, fit for files and folders.
    #[getter]
    fn name(&self) -> &str {
        with_rig!(&self.setup, prepared => &prepared.name)
    }
    /// Number of dimensions, 1 to 3.
    #[getter]
    fn dimension(&self) -> usize {
        match self.setup {
            Setup::One(_) => 1,
            Setup::Two(_) => 2,
            Setup::Three(_) => 3,
        }
    }
    /// Number of spheres.
    #[getter]
    fn spheres(&self) -> usize {
        with_rig!(&self.setup, prepared => prepared.rig.sample.spheres.len())
    }
    /// The step that is chosen (s).
    #[getter]
    fn step_s(&self) -> f64 {
        with_rig!(&self.setup, prepared => prepared.plan.step)
    }
    /// How long the run lasts (s).
    #[getter]
    fn window_s(&self) -> f64 {
        with_rig!(&self.setup, prepared => prepared.plan.window)
    }
    /// What the user should know about these choices.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        with_rig!(&self.setup, prepared => prepared.plan.warnings.clone())
    }

    /// The spheres at rest, as a table.
    ///
    /// Columns, shape (spheres,): layer, column (int64; 0 for those of intruders); radius_m, mass_kg (float64); material (str);
    /// position_m (float64), shape (spheres, dimension).
    fn table<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        with_rig!(&self.setup, prepared => table(py, prepared))
    }

    /// Runs it in memory and keeps every sphere's motion over time.
    ///
    /// Parameters
    /// ----------
    /// every : float or str, optional
    ///     Time between frames (s, or text with a unit); a hundredth of the window where left out.
    /// threads : int, optional
    ///     All cores where left out; results do not depend on it.
    ///
    /// Returns
    /// -------
    /// dict
    ///     time_s, shape (T,); displacement_m, velocity_m_s, net_force_N, shape (T, spheres, dimension); energies, a dict of arrays of
    ///     shape (T,) in J; max_speed_m_s, max_force_N, shape (spheres,); step_s; stop : str or None
    #[pyo3(signature = (*, every = None, threads = None))]
    fn histories<'py>(
        &self,
        py: Python<'py>,
        every: Option<Time>,
        threads: Option<usize>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let every = every.map(|time| time.seconds("every")).transpose()?;
        with_rig!(&self.setup, prepared => histories(py, prepared, every, threads))
    }

    /// Runs it in memory and keeps every body and closed contact at moments; of rigs in the plane and chains.
    ///
    /// Parameters
    /// ----------
    /// every : float or str, optional
    ///     Time between frames (s, or text with a unit); a hundredth of the window where left out.
    /// threads : int, optional
    ///     All cores where left out; results do not depend on it.
    ///
    /// Returns
    /// -------
    /// Frames
    ///     In SI; a chain lies along z. What granulens simulate --frames writes, to the last bit.
    #[pyo3(signature = (*, every = None, threads = None))]
    fn frames<'py>(&self, py: Python<'py>, every: Option<Time>, threads: Option<usize>) -> PyResult<Bound<'py, PyAny>> {
        let every = every.map(|time| time.seconds("every")).transpose()?;
        with_rig!(&self.setup, prepared => frames_of(py, prepared, every, threads))
    }

    /// Runs it into a folder of records, as granulens simulate does; gives what trial.json holds.
    ///
    /// A run that was left is taken up with resume; a folder that holds something else is left alone without force.
    #[pyo3(signature = (folder, *, resume = false, force = false, threads = None))]
    fn run<'py>(
        &self,
        py: Python<'py>,
        folder: PathBuf,
        resume: bool,
        force: bool,
        threads: Option<usize>,
    ) -> PyResult<Bound<'py, PyAny>> {
        with_rig!(&self.setup, prepared => to_folder(py, prepared, folder, resume, force, threads))
    }

    fn __repr__(&self) -> String {
        with_rig!(&self.setup, prepared => format!("<Rig {}: {} spheres, {} layers>", prepared.name, prepared.rig.sample.spheres.len(), prepared.layers))
    }
}

fn table<'py, const D: usize>(py: Python<'py>, prepared: &PreparedRig<D>) -> PyResult<Bound<'py, PyDict>> {
    let sample = &prepared.rig.sample;
    let site = |k: usize, of: fn(&granulens::setup::SphereSite) -> u32| prepared.sites.get(k).map_or(0, of);
    let count = sample.spheres.len();
    Table::new(py)
        .with("layer", vector(py, (0..count).map(|k| i64::from(site(k, |s| s.layer))).collect()))?
        .with("column", vector(py, (0..count).map(|k| i64::from(site(k, |s| s.column))).collect()))?
        .with("radius_m", vector(py, sample.spheres.iter().map(|s| s.radius).collect()))?
        .with("mass_kg", vector(py, prepared.rig.mass.clone()))?
        .with(
            "material",
            sample.spheres.iter().map(|s| sample.materials[s.material].name.as_str()).collect::<Vec<_>>(),
        )?
        .with("position_m", points(py, sample.spheres.iter().map(|s| s.centre).collect())?)
        .map(|table| table.0)
}

/// What is kept of a run.
#[derive(Default)]
struct Kept {
    times: Vec<f64>,
    displacement: Vec<f64>,
    velocity: Vec<f64>,
    force: Vec<f64>,
    energies: Vec<EnergyLedger>,
    speed: Vec<f64>,
    greatest: Vec<f64>,
    stop: Option<RigStop>,
}

/// Follows a rig and looks at it at the start, every so many steps, and at the end.
fn follow<const D: usize>(
    prepared: &PreparedRig<D>,
    every: u64,
    context: &Context,
    mut look: impl FnMut(&Simulation<D>),
) -> Result<(Simulation<D>, Option<RigStop>)>
where
    Spheres: MoveIn<D>,
{
    let words = |error: &granulens::dem::rig::RigError| {
        Failure::input(format!("{}: {}", prepared.path.display(), error.words(&|body| prepared.name_of(body))))
    };
    let mut simulation = prepared.simulation().map_err(|error| words(&error))?;
    let mut left = prepared.plan.steps();
    loop {
        look(&simulation);
        if left == 0 {
            return Ok((simulation, None));
        }
        let some = every.min(left);
        left -= some;
        if let Err(stop) = simulation.advance(some, context) {
            return Ok((simulation, Some(stop)));
        }
        if context.stopped() {
            return Ok((simulation, None));
        }
    }
}

fn keep<const D: usize>(prepared: &PreparedRig<D>, every: u64, context: &Context) -> Result<Kept>
where
    Spheres: MoveIn<D>,
{
    let count = prepared.rig.sample.spheres.len();
    let mut kept = Kept::default();
    let (simulation, stop) = follow(prepared, every, context, |simulation| {
        let view = simulation.view();
        kept.times.push(view.time());
        for sphere in 0..count {
            kept.displacement.extend(view.displacement(sphere));
            kept.velocity.extend(view.velocity(sphere));
            kept.force.extend(view.whole_force(sphere));
        }
        kept.energies.push(simulation.ledger());
    })?;
    (kept.speed, kept.greatest, kept.stop) = (simulation.greatest_speed(), simulation.greatest_force(), stop);
    Ok(kept)
}

/// Steps between two moments, and how many moments that makes.
fn moments<const D: usize>(prepared: &PreparedRig<D>, every: Option<f64>) -> (u64, u64) {
    let every = every.unwrap_or(prepared.plan.window / 100.0);
    let steps = ((every / prepared.plan.step).round() as u64).max(1);
    (steps, prepared.plan.steps() / steps + 2)
}

fn frames_of<'py, const D: usize>(
    py: Python<'py>,
    prepared: &PreparedRig<D>,
    every: Option<f64>,
    threads: Option<usize>,
) -> PyResult<Bound<'py, PyAny>>
where
    Spheres: MoveIn<D>,
{
    if D > 2 {
        let message = "frames are of what lies in the plane, and this rig has three dimensions";
        return Err(Failure::with_help(message, "Take histories().").into());
    }
    let (steps, count) = moments(prepared, every);
    frames::check_room(count, prepared.rig.sample.spheres.len())?;
    let (kept, stop) = run(py, threads, |context| {
        let mut kept = Vec::new();
        let ended = follow(prepared, steps, context, |simulation| {
            kept.extend(Frame::of(simulation, [prepared.sites.len(), 0]));
        });
        ended.map(|(_, stop)| (kept, stop))
    })??;
    if let Some(stop) = stop {
        return Err(Failure::guard(stop.words("s", &|body| prepared.name_of(body))).into());
    }
    frames::frames(py, kept, FRAME_SI)
}

fn histories<'py, const D: usize>(
    py: Python<'py>,
    prepared: &PreparedRig<D>,
    every: Option<f64>,
    threads: Option<usize>,
) -> PyResult<Bound<'py, PyDict>>
where
    Spheres: MoveIn<D>,
{
    let (steps, frames) = moments(prepared, every);
    let count = prepared.rig.sample.spheres.len();
    let bytes = frames as f64 * (count * D * 3 * 8) as f64;
    if bytes > frames::MOST {
        let message = format!("{frames} frames of {count} spheres take {:.1} GB", 1e-9 * bytes);
        return Err(Failure::with_help(message, "Take them less often, or write them with run(folder).").into());
    }
    let kept = run(py, threads, |context| keep(prepared, steps, context))??;
    let shape = [kept.times.len(), count, D];
    let energy = |of: fn(&EnergyLedger) -> f64| vector(py, kept.energies.iter().map(of).collect());
    let energies = Table::new(py)
        .with("work_in_J", energy(|e| e.work_in))?
        .with("kinetic_J", energy(|e| e.kinetic))?
        .with("stored_J", energy(|e| e.stored))?
        .with("tangential_stored_J", energy(|e| e.tangential_stored))?
        .with("potential_J", energy(|e| e.potential))?
        .with("dissipated_J", energy(|e| e.dissipated))?
        .with("friction_J", energy(|e| e.friction))?
        .with("absorbed_J", energy(|e| e.absorbed))?;
    Table::new(py)
        .with("energies", energies.0)?
        .with("time_s", vector(py, kept.times))?
        .with("displacement_m", shaped(py, kept.displacement, shape)?)?
        .with("velocity_m_s", shaped(py, kept.velocity, shape)?)?
        .with("net_force_N", shaped(py, kept.force, shape)?)?
        .with("max_speed_m_s", vector(py, kept.speed))?
        .with("max_force_N", vector(py, kept.greatest))?
        .with("step_s", prepared.plan.step)?
        .with("stop", kept.stop.map(|stop| stop.words("s", &|body| prepared.name_of(body))))
        .map(|table| table.0)
}

fn to_folder<'py, const D: usize>(
    py: Python<'py>,
    prepared: &PreparedRig<D>,
    folder: PathBuf,
    resume: bool,
    force: bool,
    threads: Option<usize>,
) -> PyResult<Bound<'py, PyAny>>
where
    Spheres: MoveIn<D>,
{
    // Each call is a command of its own.
    input::forget();
    input::remember(&prepared.path);
    let summary = run(py, threads, |context| -> Result<_> {
        if !resume {
            output::check_folder(&folder, force)?;
        }
        let keeping = Keeping { resume, every: Duration::from_secs(60) };
        let (summary, ending) = run::run(prepared, &folder, keeping, context)?;
        if let Ending::Interrupted { .. } = ending {
            return Err(Failure::interrupted("interrupted; go on with resume=True"));
        }
        report::draw_run(&folder)?;
        output::seal_folder(&folder)?;
        Ok(summary)
    })??;
    nested(py, &summary)
}
