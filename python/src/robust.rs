//! How scores change with every sphere, and what a layout is worth once a workshop has made it.

use std::path::PathBuf;

use granulens::Context;
use granulens::dem::{GradientError, Integrator, Stop};
use granulens::design::Design;
use granulens::evaluate::{
    self, EvaluatorError, MEASURES, Overrides, Plan, SensitivityError, Subject, refer, sensitivities,
};
use granulens::score::Measure;
use granulens::tolerance::{
    Criterion, Samples, State, Tolerances, Workshop, WorkshopError, as_built, distributions, sensitivity as changes,
    yield_of,
};
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::design::{Layout, overrides};
use crate::failure::{Failure, Result};
use crate::running::run;
use crate::values::{Table, Time, nested, vector};

fn plan(layout: &Layout, overrides: Overrides) -> Result<Plan> {
    let Layout { inner, design } = layout;
    Plan::new(design, overrides, &inner.palette).map_err(|error| Failure::from(design.blame_plan(&error)))
}

/// How scores change with every sphere; see `granulens.sensitivity`.
#[pyfunction]
#[pyo3(signature = (layout, of = None, *, step = None, window = None, integrator = None, threads = None))]
pub fn sensitivity<'py>(
    py: Python<'py>,
    layout: &Bound<'py, Layout>,
    of: Option<Vec<String>>,
    step: Option<Time>,
    window: Option<Time>,
    integrator: Option<&str>,
    threads: Option<usize>,
) -> PyResult<Bound<'py, PyDict>> {
    let layout = layout.get();
    let plan = plan(layout, overrides(step.as_ref(), window.as_ref(), integrator)?)?;
    let usual = || vec!["focal_mean".to_owned(), "protected_mean".to_owned(), "contrast".to_owned()];
    let named = |name: String| {
        let found = Measure::find(&name).filter(|measure| MEASURES.contains(measure));
        found.ok_or_else(|| {
            Failure::input(format!(
                "there are derivatives of {}, not of {name}",
                MEASURES.map(Measure::name).join(", ")
            ))
        })
    };
    let of = of.unwrap_or_else(usual).into_iter().map(named).collect::<Result<Vec<Measure>>>()?;
    let Layout { inner, design } = layout;
    let job = |context: &Context| sensitivities(design, inner, &plan, &of, context);
    let found = run(py, threads, job)?.map_err(|error| match error {
        SensitivityError::Stopped(stop @ Stop::Interrupted { .. })
        | SensitivityError::Gradient(GradientError::Stopped(stop @ Stop::Interrupted { .. })) => {
            Failure::interrupted(stop.to_string())
        }
        SensitivityError::Stopped(_) | SensitivityError::Gradient(GradientError::Stopped(_)) => {
            Failure::guard(error.to_string())
        }
        error => Failure::input(error.to_string()),
    })?;
    let measures = PyDict::new(py);
    for one in &found.of {
        let column = |values: &[f64]| vector(py, values.to_vec());
        let table = Table::new(py)
            .with("d_density", column(&one.density))?
            .with("d_youngs_modulus", column(&one.youngs_modulus))?
            .with("d_yield_stress", column(&one.yield_stress))?
            .with("d_radius", column(&one.radius))?
            .with("secant_density", column(&one.secant_density))?
            .with("linear", vector(py, one.linear.clone()))?;
        measures.set_item(one.measure.name(), table.0)?;
    }
    let force = PyDict::new(py);
    for one in &found.of {
        force.set_item(one.measure.name(), one.force)?;
    }
    Ok(Table::new(py)
        .with("sites", measures)?
        .with("d_force", force)?
        .with("focal_mean_J", found.means[0])?
        .with("protected_mean_J", found.means[1])?
        .with("method", nested(py, &evaluate::method(design, &plan))?)?
        .with("bytes", found.bytes)?
        .0)
}

fn of_workshop(error: WorkshopError) -> Failure {
    match error {
        WorkshopError::Evaluator(EvaluatorError::Interrupted) => Failure::interrupted(error.to_string()),
        error => Failure::input(error.to_string()),
    }
}

/// What a layout is worth once a workshop has made it; see `granulens.tolerance`.
#[pyfunction]
#[pyo3(signature = (layout, tolerances = None, *, samples = None, seed = None, step = None, window = None, integrator = None, threads = None))]
#[expect(clippy::too_many_arguments, reason = "keywords of Python")]
pub fn tolerance<'py>(
    py: Python<'py>,
    layout: &Bound<'py, Layout>,
    tolerances: Option<PathBuf>,
    samples: Option<u64>,
    seed: Option<u64>,
    step: Option<Time>,
    window: Option<Time>,
    integrator: Option<&str>,
    threads: Option<usize>,
) -> PyResult<Bound<'py, PyDict>> {
    let layout = layout.get();
    let subject = Subject::from(&layout.inner);
    let mut design = Design::clone(&layout.design);
    // As on the command line: what Q refers to where the design does not say it.
    let warnings: Vec<String> = refer(&mut design, &layout.inner.palette, &subject.drawn()).into_iter().collect();
    let (inner, design) = (&layout.inner, &design);
    let tolerances = match &tolerances {
        Some(path) => Tolerances::read(path, (design, subject)).map_err(|error| Failure::input(error.to_string()))?,
        None => Tolerances::usual(),
    };
    let mut overrides = overrides(step.as_ref(), window.as_ref(), integrator)?;
    if tolerances.state == State::Settled {
        // Rigs know Verlet only.
        overrides.integrator = Some(Integrator::Verlet);
    }
    let plan =
        Plan::new(design, overrides, &inner.palette).map_err(|error| Failure::from(design.blame_plan(&error)))?;
    let (seed, count) = (seed.or(tolerances.seed).unwrap_or(1), samples.unwrap_or(tolerances.samples));
    let thresholds = tolerances.thresholds.as_ref().unwrap_or(&design.thresholds);
    let asked: Vec<Measure> = thresholds.iter().map(|threshold| threshold.measure).collect();
    let given =
        Overrides { step: Some(plan.step), window: Some(plan.window), integrator: Some(plan.integrator), ..overrides };
    let workshop = Workshop::new((design, subject), &tolerances, &plan, &asked).map_err(of_workshop)?;
    let job = |context: &Context| -> Result<_> {
        let criterion = Criterion::new((design, subject), &tolerances, given, context)
            .map_err(|error| Failure::input(error.to_string()))?;
        let found = changes(&workshop, &asked, seed, context).map_err(of_workshop)?;
        let mut samples = Samples::new(&workshop, seed);
        samples.grow::<WorkshopError>(&workshop, count, context, |_| Ok(())).map_err(of_workshop)?;
        Ok((criterion, found, samples))
    };
    let (criterion, found, samples) = run(py, threads, job)??;
    let of_layout = subject.scores(|material| design.price(material));
    let (share, stopped) = yield_of(&samples, count as usize, &criterion, &of_layout);
    let measures: Vec<Measure> = workshop.measures().collect();
    let mut pieces = Table::new(py);
    for (which, quantity) in workshop.quantities().iter().enumerate() {
        pieces = pieces.with(&quantity.name, vector(py, samples.list.iter().map(|one| one.values[which]).collect()))?;
    }
    for &measure in &measures {
        let of = samples.list.iter().map(|one| one.scores.get(measure).unwrap_or(f64::NAN));
        pieces = pieces.with(measure.column(), vector(py, of.collect()))?;
    }
    let stops: Vec<Option<String>> = samples.list.iter().map(|one| one.stop.clone()).collect();
    let pieces = pieces.with("stop", stops)?;
    Ok(Table::new(py)
        .with("yield", share.share)?
        .with("interval", share.interval.to_vec())?
        .with("yield_of", criterion.words.clone())?
        .with("samples", share.of)?
        .with("passed", share.passed)?
        .with("stopped", stopped)?
        .with("seed", seed)?
        .with("pieces", pieces.0)?
        .with("sensitivity", nested(py, &found.changes)?)?
        .with("as_built", nested(py, &as_built(&found))?)?
        .with("distribution", nested(py, &distributions(&samples, count as usize, &measures))?)?
        .with("quantities", nested(py, &workshop.quantities().to_vec())?)?
        .with("method", nested(py, &evaluate::method(design, &plan))?)?
        .with("warnings", plan.warnings.iter().cloned().chain(warnings).collect::<Vec<_>>())?
        .0)
}
