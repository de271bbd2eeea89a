//! One impact on one layout, with all its records.

use granulens::Context;
use granulens::dem::Stop;
use granulens::evaluate::{self, Beside, Forces, Plan, beside_uniform};
use granulens::score::Measure;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::design::{Layout, overrides};
use crate::failure::Failure;
use crate::running::run;
use crate::values::{Table, Time, maybe, nested, points, vector};

/// One impact on one layout, as `granulens check` follows it; see `granulens.simulate`.
#[pyfunction]
#[pyo3(signature = (layout, *, forces = 1, band = 0.01, step = None, window = None, integrator = None, threads = None))]
#[expect(clippy::too_many_arguments, reason = "keywords of Python")]
pub fn simulate<'py>(
    py: Python<'py>,
    layout: &Bound<'py, Layout>,
    forces: usize,
    band: f64,
    step: Option<Time>,
    window: Option<Time>,
    integrator: Option<&str>,
    threads: Option<usize>,
) -> PyResult<Bound<'py, PyDict>> {
    let Layout { inner: layout, design } = layout.get();
    let forces = Forces::new(forces, band).map_err(Failure::from)?;
    let overrides = overrides(step.as_ref(), window.as_ref(), integrator)?;
    let mut palette = layout.palette.clone();
    if let Some(reference) = design.reference().filter(|reference| !palette.contains(reference)) {
        palette.push(reference.clone());
    }
    let plan = Plan::new(design, overrides, &palette).map_err(|error| Failure::from(design.blame_plan(&error)))?;
    let job = |context: &Context| beside_uniform(design, layout, &plan, forces, context);
    let Beside { evaluation, reference, stopped, over_forces, .. } = run(py, threads, job)?.map_err(Failure::from)?;
    let mut warnings = plan.warnings.clone();
    warnings.extend(evaluation.warnings("this layout"));
    warnings.extend(stopped.iter().map(|(name, stop)| format!("{name}: {stop}")));
    let record = &evaluation.record;
    if let Some(stop @ Stop::Interrupted { .. }) = &record.stop {
        return Err(Failure::interrupted(stop.to_string()).into());
    }
    let scores = PyDict::new(py);
    let (mean, spreads) = match over_forces {
        Some((mean, spreads)) => (mean, spreads),
        None => (evaluation.scores.clone(), granulens::score::Spreads::default()),
    };
    for &measure in Measure::ALL {
        if let Some(value) = mean.get(measure) {
            scores.set_item(measure.column(), value)?;
        }
        if let Some(spread) = spreads.deviation(measure) {
            let name = measure.column().replacen(measure.name(), &format!("{}_sd", measure.name()), 1);
            scores.set_item(name, spread)?;
        }
    }
    let column = |values: &[f64]| vector(py, values.to_vec());
    let spheres = Table::new(py)
        .with("max_kinetic_J", column(&record.max_kinetic))?
        .with("max_net_force_N", column(&record.max_net_force))?
        .with("max_contact_force_N", column(&record.max_contact_force))?
        .with("arrival_s", maybe(py, record.arrival.iter().copied()))?
        .with("dissipated_J", column(&record.dissipated))?
        .with("displacement_m", points(py, record.displacement.clone())?)?
        .with("velocity_m_s", points(py, record.velocity.clone())?)?;
    let of = |value: fn(&granulens::dem::ContactRecord) -> f64| vector(py, record.contacts.iter().map(value).collect());
    let end = |k: usize| vector(py, record.contacts.iter().map(|c| c.spheres[k] as i64).collect());
    let contacts = Table::new(py)
        .with("i", end(0))?
        .with("j", end(1))?
        .with("weight", of(|c| c.weight))?
        .with("overlap_max_m", of(|c| c.overlap_max))?
        .with("force_max_N", of(|c| c.force_max))?
        .with("work_J", of(|c| c.work))?
        .with("stored_J", of(|c| c.stored))?;
    let ledger = &record.ledger;
    let energies = Table::new(py)
        .with("work_in_J", ledger.work_in)?
        .with("kinetic_J", ledger.kinetic)?
        .with("stored_J", ledger.stored)?
        .with("dissipated_J", ledger.dissipated)?;
    Ok(Table::new(py)
        .with("scores", scores)?
        .with("spheres", spheres.0)?
        .with("contacts", contacts.0)?
        .with("energies", energies.0)?
        .with("method", nested(py, &evaluate::method(design, &plan))?)?
        .with("reference", reference)?
        .with("steps", record.steps)?
        .with("warnings", warnings)?
        .with("stop", record.stop.as_ref().map(ToString::to_string))?
        .0)
}
