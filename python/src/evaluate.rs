//! Many layouts to scores, side by side in the registers of every core.

use std::sync::Arc;

use granulens::dem::{Stop, Strike};
use granulens::evaluate::{self, Detail, Evaluated, Forces, Overrides, Plan};
use granulens::layout::LayoutCounter;
use granulens::score::{Measure, Scores, Spreads, over_forces};
use numpy::PyReadonlyArray2;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::design::{Design, check, overrides, palette};
use crate::failure::{Failure, Result};
use crate::material::{Material, MaterialLike};
use crate::running::run;
use crate::values::{Table, Time, maybe, nested};

/// Turns layouts of one design into scores, relative to the uniform crystals of host and reference under the same impact; these are simulated
/// once, when it is made.
///
/// Parameters
/// ----------
/// design : Design
/// palette : list of Material or str, optional
///     What the numbers of layouts stand for, host first; the design's own materials where left out.
/// forces, band : int, float
///     Over how many forces within which part of the design's own each layout is judged.
/// step, window : float or str, optional
///     In place of the chosen ones (s, or text with a unit).
/// integrator : str, optional
///     adams, verlet or rk4.
/// records : bool
///     Full records: momentum, forces, arrivals and dissipation too, at some four times the work.
/// threads : int, optional
///     All cores where left out; results do not depend on it.
#[pyclass(frozen, module = "granulens")]
pub struct Evaluator {
    design: Arc<granulens::design::Design>,
    palette: Vec<granulens::material::Material>,
    forces: Forces,
    counter: LayoutCounter,
    threads: Option<usize>,
    plan: Plan,
    inner: evaluate::Evaluator,
}

#[pymethods]
impl Evaluator {
    #[new]
    #[pyo3(signature = (design, palette = None, *, forces = 1, band = 0.01, step = None, window = None, integrator = None, records = false, threads = None))]
    #[expect(clippy::too_many_arguments, reason = "keywords of Python")]
    fn new(
        py: Python<'_>,
        design: &Bound<'_, Design>,
        palette: Option<Vec<MaterialLike>>,
        forces: usize,
        band: f64,
        step: Option<Time>,
        window: Option<Time>,
        integrator: Option<&str>,
        records: bool,
        threads: Option<usize>,
    ) -> PyResult<Self> {
        let design = design.get().inner.clone();
        let palette = self::palette(&design, palette)?;
        let forces = Forces::new(forces, band).map_err(Failure::from)?;
        let overrides = overrides(step.as_ref(), window.as_ref(), integrator)?;
        // Step and window are those of the design's own force, as check takes them.
        let mut all = palette.clone();
        all.extend(design.reference().filter(|reference| !palette.contains(reference)).cloned());
        let plan = Plan::new(&design, overrides, &all).map_err(|error| Failure::from(design.blame_plan(&error)))?;
        let overrides = Overrides { step: Some(plan.step), window: Some(plan.window), ..overrides };
        let detail = if records { Detail::Everything } else { Detail::Energies };
        let strengths = forces.about(design.impact.strength()).into_iter();
        let strikes: Vec<Strike> = strengths.map(|strength| design.impact.with_strength(strength)).collect();
        let inner = run(py, threads, |context| {
            let made = evaluate::Evaluator::new(&*design, &strikes, palette.clone(), overrides, context);
            made.map(|made| made.recording(detail))
        })?;
        let inner = inner.map_err(|error| match error {
            evaluate::EvaluatorError::Plan(error) => design.blame_plan(&error).into(),
            error => Failure::from(error),
        })?;
        let counter = LayoutCounter::new(&design.lattice, None, &palette, |material| design.price(material));
        Ok(Self { design, palette, forces, counter, threads, plan, inner })
    }

    /// What the numbers of layouts stand for, host first.
    #[getter]
    fn palette(&self) -> Vec<Material> {
        self.palette.iter().map(|inner| Material { inner: inner.clone() }).collect()
    }

    /// Law, constants, integrator, step and window of every run, each with its reason.
    #[getter]
    fn method<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyAny>> {
        nested(py, &evaluate::method(&self.design, &self.plan))
    }

    /// Scores of layouts.
    ///
    /// Parameters
    /// ----------
    /// layouts : array of uint8, shape (n, sites)
    ///     For each layout the number of the material on each site.
    ///
    /// Returns
    /// -------
    /// dict of columns, one entry per layout
    ///     focal_mean_J, protected_mean_J, contrast, focal_gain, protection and whatever else is known, float64, NaN where a measure has no
    ///     value; over several forces also contrast_sd and the like; stop : list of str or None, why a guard stopped a run.
    fn __call__<'py>(&self, py: Python<'py>, layouts: PyReadonlyArray2<'py, u8>) -> PyResult<Bound<'py, PyDict>> {
        let rows: Vec<Vec<u8>> = layouts.as_array().rows().into_iter().map(|row| row.to_vec()).collect();
        for (number, row) in rows.iter().enumerate() {
            check(&self.design, &self.palette, row, number)?;
        }
        let runs = run(py, self.threads, |context| self.inner.scores(&rows, context))?.map_err(Failure::from)?;
        let judged = rows.iter().zip(&runs).map(|(row, runs)| self.judged(row, runs)).collect::<Result<Vec<_>>>()?;
        let mut table = Table::new(py);
        for &measure in Measure::ALL {
            let values: Vec<Option<f64>> = judged.iter().map(|(scores, ..)| scores.get(measure)).collect();
            if values.iter().any(Option::is_some) {
                table = table.with(measure.column(), maybe(py, values))?;
            }
            let spread: Vec<Option<f64>> = judged.iter().map(|(_, spreads, _)| spreads.deviation(measure)).collect();
            if spread.iter().any(Option::is_some) {
                let name = measure.column().replacen(measure.name(), &format!("{}_sd", measure.name()), 1);
                table = table.with(&name, maybe(py, spread))?;
            }
        }
        let stops: Vec<Option<String>> = judged.into_iter().map(|(.., stop)| stop).collect();
        Ok(table.with("stop", stops)?.0)
    }

    fn __repr__(&self) -> String {
        format!("<Evaluator of {}: {} materials, {} forces>", self.design.name, self.palette.len(), self.forces.count())
    }
}

impl Evaluator {
    /// Of one layout its scores, over the forces; how they scatter; why a run was stopped.
    fn judged(&self, row: &[u8], runs: &[Evaluated]) -> Result<(Scores, Spreads, Option<String>)> {
        let stop = runs.iter().find_map(|run| run.stop.as_ref());
        if let Some(stop @ Stop::Interrupted { .. }) = stop {
            return Err(Failure::interrupted(stop.to_string()));
        }
        let each: Vec<Scores> = runs.iter().map(|run| run.scores.clone()).collect();
        let (mut scores, spreads) = match &each[..] {
            [one] => (one.clone(), Spreads::default()),
            several => over_forces(several),
        };
        scores.add_layout(&self.counter.stats(row));
        Ok((scores, spreads, stop.map(ToString::to_string)))
    }
}
