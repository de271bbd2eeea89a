//! Granular beds and what falls on them. Lengths in mean grain diameters d, times in collision times tau_c, masses in mean grain masses m.

use std::path::PathBuf;

use granulens::bed::{self, BedFile, FRAME_UNITS, FramePlan, Origin, Settled, Strike, measure, settle};
use granulens::dem::rig::{Body, EnergyLedger, RigError, RigStop, Simulation};
use granulens::input;
use granulens::report::{BedRecord, Provenance, draw_bed};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::failure::{Failure, Result};
use crate::frames;
use crate::running::run;
use crate::values::{Table, points, vector};

/// A bed file: grains, what falls on them, and for how long it is followed.
#[pyclass(frozen, module = "granulens")]
pub struct Bed {
    inner: BedFile,
}

/// Grains at rest between walls.
#[pyclass(frozen, module = "granulens")]
pub struct Packing {
    inner: bed::Bed,
}

/// A contact between grains: who, where, and with which normal and tangential force.
type Touch = ([usize; 2], [[f64; 2]; 2], [f64; 2]);

#[pymethods]
impl Bed {
    #[new]
    fn new(path: PathBuf) -> Result<Self> {
        Ok(Self { inner: BedFile::read(path)? })
    }

    /// Checks the text of a bed file; path is what messages call it.
    #[staticmethod]
    #[pyo3(signature = (text, path = PathBuf::from("bed.toml")))]
    fn parse(text: &str, path: PathBuf) -> Result<Self> {
        Ok(Self { inner: BedFile::parse(path, text)? })
    }

    /// Name, fit for files and folders.
    #[getter]
    fn name(&self) -> &str {
        &self.inner.name
    }
    /// Speed of the intruder at the begin (d/tau_c).
    #[getter]
    fn speed(&self) -> f64 {
        self.inner.impact.intruder.speed
    }

    /// Lets the pile settle, or reads the bed that the file names.
    #[pyo3(signature = (*, threads = None))]
    fn settle(&self, py: Python<'_>, threads: Option<usize>) -> PyResult<Packing> {
        let pile = match &self.inner.origin {
            Origin::File(path) => return Ok(Packing { inner: bed::read(path).map_err(Failure::from)? }),
            Origin::Pile(pile) => pile,
        };
        let grains = &self.inner.impact.grains;
        let Settled { bed: inner, .. } =
            run(py, threads, |context| settle(pile, grains, context))?.map_err(|error| match error {
                bed::SettleError::Stop(RigStop::Interrupted { .. }) => {
                    Failure::interrupted("the bed had not settled yet")
                }
                error => Failure::input(error.to_string()),
            })?;
        Ok(Packing { inner })
    }

    /// Lets the intruder fall on a bed at rest.
    ///
    /// Parameters
    /// ----------
    /// every : float, optional
    ///     Time between frames that are kept (tau_c), a multiple of run.sample of the file; where left out what [record] of the file says, and none
    ///     without it. Frames change nothing else, to the last bit.
    /// threads : int, optional
    ///     All cores where left out; results do not depend on it.
    ///
    /// Returns
    /// -------
    /// dict
    ///     moments : dict of arrays of shape (T,): time_tau_c, depth_d, vx, vy, fx, fy, turn and energies (m d^2/tau_c^2);
    ///     grains : dict of arrays of shape (grains,): x_d, y_d at the end, greatest_force (m d/tau_c^2);
    ///     final_depth_d, max_depth_d, peak_force, peak_force_time_tau_c : float; svg : dict of pictures; stop : str or None;
    ///     frames : Frames or None, with lengths in d, times in tau_c, masses in m
    #[pyo3(signature = (packing, *, every = None, threads = None))]
    fn strike<'py>(
        &self,
        py: Python<'py>,
        packing: &Bound<'py, Packing>,
        every: Option<f64>,
        threads: Option<usize>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let bed = &packing.get().inner;
        let impact = &self.inner.impact;
        let looks = self.looks(every, bed.grains.len() + bed.walls.len())?;
        let (course, kept) = run(py, threads, |context| {
            let mut strike = Strike::new(bed, impact)?;
            let mut kept = Vec::from_iter(looks.map(|_| strike.frame()));
            while strike.goes_on() {
                strike.go_on(context);
                if looks.is_some_and(|looks| strike.looks().is_multiple_of(looks)) {
                    kept.push(strike.frame());
                }
            }
            Ok((strike.course(), kept))
        })?
        .map_err(|error: RigError| Failure::from(error))?;
        let of = |value: fn(&bed::Moment) -> f64| vector(py, course.moments.iter().map(value).collect());
        let energy = |value: fn(&EnergyLedger) -> f64| {
            vector(py, course.moments.iter().map(|moment| value(&moment.energy)).collect())
        };
        let moments = Table::new(py)
            .with("time_tau_c", of(|m| m.time))?
            .with("depth_d", of(|m| m.depth))?
            .with("vx", of(|m| m.velocity[0]))?
            .with("vy", of(|m| m.velocity[1]))?
            .with("turn", of(|m| m.turn))?
            .with("fx", of(|m| m.force[0]))?
            .with("fy", of(|m| m.force[1]))?
            .with("work_in", energy(|e| e.work_in))?
            .with("kinetic", energy(|e| e.kinetic))?
            .with("stored", energy(|e| e.stored))?
            .with("tangential_stored", energy(|e| e.tangential_stored))?
            .with("potential", energy(|e| e.potential))?
            .with("dissipated", energy(|e| e.dissipated))?
            .with("friction", energy(|e| e.friction))?;
        let grains = Table::new(py)
            .with("x_d", vector(py, course.grains.iter().map(|place| place[0]).collect()))?
            .with("y_d", vector(py, course.grains.iter().map(|place| place[1]).collect()))?
            .with("greatest_force", vector(py, course.grain_force.clone()))?;
        let measures = measure(bed);
        let record = BedRecord { impact, bed, measures: &measures, sound: None, course: &course };
        let pictures = PyDict::new(py);
        for (name, svg) in draw_bed(&self.inner.name, &record, "", Provenance::default()).pictures {
            pictures.set_item(name, svg)?;
        }
        Table::new(py)
            .with("moments", moments.0)?
            .with("grains", grains.0)?
            .with("final_depth_d", course.final_depth)?
            .with("max_depth_d", course.max_depth)?
            .with("peak_force", course.peak_force[0])?
            .with("peak_force_time_tau_c", course.peak_force[1])?
            .with("svg", pictures)?
            .with("frames", looks.map(|_| frames::frames(py, kept, FRAME_UNITS)).transpose()?)?
            .with("stop", course.stop.as_ref().map(bed::stop_words))
            .map(|table| table.0)
    }

    /// The contacts between grains of a bed under its own weight, after some time.
    ///
    /// Parameters
    /// ----------
    /// after : float
    ///     How long forces are followed from the places in the packing on (tau_c); those of a packing that was settled come to rest within some
    ///     tens.
    ///
    /// Returns
    /// -------
    /// dict of arrays, one entry per contact
    ///     i, j : int64, numbers of the grains; x_i, y_i, x_j, y_j : float64 (d); normal, tangential : float64 (m d/tau_c^2)
    #[pyo3(signature = (packing, *, after = 50.0, threads = None))]
    fn contacts<'py>(
        &self,
        py: Python<'py>,
        packing: &Bound<'py, Packing>,
        after: f64,
        threads: Option<usize>,
    ) -> PyResult<Bound<'py, PyDict>> {
        if !(0.0..=1e6).contains(&after) {
            return Err(Failure::input(format!("after = {after} must lie from 0 to 1e6 tau_c")).into());
        }
        let bed = &packing.get().inner;
        let (grains, step) = (&self.inner.impact.grains, self.inner.impact.step);
        let found = run(py, threads, |context| -> Result<Vec<Touch>> {
            let mut simulation = Simulation::new(grains.rig(bed, true), step)?;
            let steps = (after / step).round() as u64;
            simulation.advance(steps.max(1), context).map_err(|stop| match stop {
                RigStop::Interrupted { .. } => Failure::interrupted("interrupted"),
                stop => Failure::guard(bed::stop_words(&stop)),
            })?;
            let view = simulation.view();
            let among = |body: Body| match body {
                Body::Sphere(i) if i < bed.grains.len() => Some(i),
                _ => None,
            };
            let contacts = view.contacts().filter_map(|touching| {
                let [a, b] = touching.bodies;
                let ends = [among(a)?, among(b)?];
                Some((ends, ends.map(|i| view.position(i)), [touching.force, touching.tangential]))
            });
            Ok(contacts.collect())
        })??;
        let end = |k: usize| vector(py, found.iter().map(|(ends, ..)| ends[k] as i64).collect());
        let place = |k: usize, axis: usize| vector(py, found.iter().map(|(_, places, _)| places[k][axis]).collect());
        let force = |k: usize| vector(py, found.iter().map(|(.., forces)| forces[k]).collect());
        Table::new(py)
            .with("i", end(0))?
            .with("j", end(1))?
            .with("x_i", place(0, 0))?
            .with("y_i", place(0, 1))?
            .with("x_j", place(1, 0))?
            .with("y_j", place(1, 1))?
            .with("normal", force(0))?
            .with("tangential", force(1))
            .map(|table| table.0)
    }

    fn __repr__(&self) -> String {
        format!("<Bed {}: intruder at {} d/tau_c>", self.inner.name, self.inner.impact.intruder.speed)
    }
}

impl Bed {
    /// Looks between two frames, where frames are kept.
    fn looks(&self, every: Option<f64>, bodies: usize) -> Result<Option<u64>> {
        let impact = &self.inner.impact;
        let Some(every) = every.or(self.inner.record.map(|plan| plan.every)) else { return Ok(None) };
        let (sample, window) = (impact.sample, impact.window);
        let looks = FramePlan { every, contacts: true }.looks(sample).filter(|_| every <= window);
        let looks = looks.ok_or_else(|| {
            Failure::input(format!("every = {every} must be a multiple of run.sample, {sample}, up to {window} tau_c"))
        })?;
        frames::check_room((window / every) as u64 + 1, bodies)?;
        Ok(Some(looks))
    }
}

#[pymethods]
impl Packing {
    /// Reads a bed at rest.
    #[new]
    fn new(path: PathBuf) -> Result<Self> {
        Ok(Self { inner: bed::read(&path)? })
    }

    /// Writes it, so that settling is paid for once.
    fn write(&self, path: PathBuf) -> Result<()> {
        input::forget();
        Ok(bed::write(&path, &self.inner, "A bed at rest")?)
    }

    /// Width (d).
    #[getter]
    fn width_d(&self) -> f64 {
        self.inner.width
    }
    /// Whether it repeats itself sideways.
    #[getter]
    fn periodic(&self) -> bool {
        self.inner.periodic
    }
    /// Centres of the grains (d): float64, shape (grains, 2), the second axis upwards.
    #[getter]
    fn centres_d<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        points(py, self.inner.grains.iter().map(|grain| grain.centre).collect())
    }
    /// Diameters of the grains (d): float64, shape (grains,).
    #[getter]
    fn diameters_d<'py>(&self, py: Python<'py>) -> Bound<'py, PyAny> {
        vector(py, self.inner.grains.iter().map(|grain| grain.diameter).collect())
    }
    /// Volume fraction, coordination, surface (d) and pair correlation (shape (bins, 2): r in d, g).
    fn measures<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        let found = measure(&self.inner);
        Table::new(py)
            .with("grains", found.grains)?
            .with("surface_d", found.surface)?
            .with("volume_fraction", found.volume_fraction)?
            .with("coordination", found.coordination)?
            .with("pair_correlation", points(py, found.pair_correlation)?)
            .map(|table| table.0)
    }
    fn __len__(&self) -> usize {
        self.inner.grains.len()
    }
    fn __repr__(&self) -> String {
        format!("<Packing of {} grains, {:.1} d wide>", self.inner.grains.len(), self.inner.width)
    }
}
