//! Searches, here or on an engine.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::{Arc, Mutex, PoisonError};

use granulens::Context;
use granulens::input;
use granulens::score::Measure;
use granulens::search::{Assignment, Rng};
use granulens::study::{
    self, Asking, Engine, Entry, Journal, Key, Local, Report, Rung, Shard, State, StudyError, Watch, bundle,
    evaluate_shard, merge, run_with, why,
};
use numpy::PyReadonlyArray2;
use pyo3::prelude::*;
use pyo3::types::PyDict;

use crate::design::{Design, Layout};
use crate::failure::{Failure, Result};
use crate::running::run;
use crate::space::{SpaceDesign, SpaceLayout};
use crate::values::{Table, maybe, nested, vector};

/// A study: what is wanted of a design's layouts, and what is done to find one.
///
/// Parameters
/// ----------
/// path : path
///     Study file.
/// seed : int, optional
///     In place of the file's.
#[pyclass(frozen, subclass, module = "granulens._granulens")]
pub struct Study {
    inner: study::Study,
    /// The design whose layouts are searched.
    design: Lent,
    /// Of one that evaluates for others: what it needs for that, made once.
    local: Mutex<Option<Local>>,
}

/// The design of a study, of a sheet or in space, as its layouts hold it.
#[derive(Clone)]
enum Lent {
    Sheet(Arc<granulens::design::Design>),
    Space(Arc<granulens::design::SpaceDesign>),
}

/// A design of either kind.
#[derive(IntoPyObject)]
enum AnyDesign {
    Sheet(Design),
    Space(SpaceDesign),
}

/// A layout of either kind.
#[derive(IntoPyObject)]
enum AnyLayout {
    Sheet(Layout),
    Space(SpaceLayout),
}

#[pymethods]
impl Study {
    #[new]
    #[pyo3(signature = (path, *, seed = None))]
    fn new(path: PathBuf, seed: Option<u64>) -> Result<Self> {
        let inner = study::Study::read(&path, seed)?;
        let design = match &inner.design {
            granulens::design::AnyDesign::Plane(design) => Lent::Sheet(Arc::new((**design).clone())),
            granulens::design::AnyDesign::Space(design) => Lent::Space(Arc::new((**design).clone())),
        };
        Ok(Self { inner, design, local: Mutex::new(None) })
    }

    /// The file, as it was named.
    #[getter]
    fn path(&self) -> PathBuf {
        self.inner.path.clone()
    }
    /// Seed of everything random.
    #[getter]
    fn seed(&self) -> u64 {
        self.inner.seed
    }
    /// Evaluations of all stages together.
    #[getter]
    fn budget(&self) -> u64 {
        self.inner.budget()
    }
    /// Names of the materials that may be chosen: what letters stand for.
    #[getter]
    fn materials(&self) -> Vec<String> {
        self.inner.alphabet.iter().map(|&place| self.inner.palette[usize::from(place)].name.clone()).collect()
    }
    /// Sites that may change: int64, shape (free,), places among the design's sites.
    #[getter]
    fn free<'py>(&self, py: Python<'py>) -> Bound<'py, PyAny> {
        vector(py, self.inner.free.iter().map(|&site| site as i64).collect())
    }
    /// For each letter the sites that it stands for, each int64: one, or in space all that change together.
    #[getter]
    fn groups<'py>(&self, py: Python<'py>) -> Vec<Bound<'py, PyAny>> {
        let of = |group: &Vec<usize>| vector(py, group.iter().map(|&site| site as i64).collect());
        self.inner.groups.iter().map(of).collect()
    }
    /// The letters at the start: uint8, shape (letters,).
    #[getter]
    fn start<'py>(&self, py: Python<'py>) -> Bound<'py, PyAny> {
        vector(py, self.inner.first().swap_remove(0))
    }
    /// The design whose layouts are searched.
    #[getter]
    fn design(&self) -> AnyDesign {
        match self.design.clone() {
            Lent::Sheet(inner) => AnyDesign::Sheet(Design { inner }),
            Lent::Space(inner) => AnyDesign::Space(SpaceDesign { inner }),
        }
    }

    /// The layout that letters stand for: uint8, shape (letters,).
    fn layout(&self, letters: Vec<u8>) -> Result<AnyLayout> {
        let study = &self.inner;
        let known = |letter: &u8| usize::from(*letter) < study.alphabet.len();
        if letters.len() != study.variables() || !letters.iter().all(known) {
            return Err(Failure::input(format!(
                "letters must be {} numbers below {}, one for each site, or group of sites, that may change",
                study.variables(),
                study.alphabet.len()
            )));
        }
        let (palette, materials) = (study.palette.clone(), study.materials(&letters));
        Ok(match &self.design {
            Lent::Sheet(design) => {
                let inner = granulens::layout::Layout { lattice: design.lattice.clone(), palette, materials };
                AnyLayout::Sheet(Layout { inner, design: design.clone() })
            }
            Lent::Space(design) => AnyLayout::Space(SpaceLayout::of(design, palette, materials)),
        })
    }

    /// Random layouts of the study, as its searches begin with: letters, uint8, shape (count, letters).
    #[pyo3(signature = (count, *, seed = None))]
    fn random<'py>(&self, py: Python<'py>, count: usize, seed: Option<u64>) -> PyResult<Bound<'py, PyAny>> {
        let (space, mut rng) = (self.inner.space(), Rng::new(seed.unwrap_or(self.inner.seed)));
        let flat: Vec<u8> = (0..count).flat_map(|_| space.random(&mut rng)).collect();
        vector(py, flat).call_method1("reshape", (count, self.inner.variables()))
    }

    /// The study's files by name, so that it can be read elsewhere; the first is the study file.
    fn files(&self) -> Result<Vec<(String, String)>> {
        Ok(bundle(&self.inner)?)
    }

    /// Runs the study, or goes on with it, in a folder; see `granulens.Study.run`.
    #[pyo3(signature = (folder, *, engine = None, callback = None, force = false, threads = None))]
    fn run_in<'py>(
        &self,
        py: Python<'py>,
        folder: PathBuf,
        engine: Option<Bound<'py, PyAny>>,
        callback: Option<Bound<'py, PyAny>>,
        force: bool,
        threads: Option<usize>,
    ) -> PyResult<Bound<'py, PyAny>> {
        let study = &self.inner;
        // Each call is a command of its own.
        input::forget();
        input::remember(&study.path);
        input::remember(study.design().path());
        study::claim(&folder, study, force).map_err(|error| Failure::with_help(error.to_string(), error.help()))?;
        let journal = folder.join("journal.jsonl");
        let engine = engine.map(Bound::unbind);
        let callback = callback.map(Bound::unbind);
        // What a callback or an engine raised.
        let raised: Mutex<Option<PyErr>> = Mutex::new(None);
        let told: Mutex<Vec<String>> = Mutex::new(Vec::new());
        let state = run(py, threads, |context| {
            let mut watch =
                Told { callback: callback.as_ref(), raised: &raised, context, warnings: &told, simulated: 0 };
            match &engine {
                None => study::run(study, &journal, context, &mut watch),
                Some(engine) => {
                    let mut engine = Elsewhere { study, engine, raised: &raised, context };
                    run_with(study, &journal, &mut engine, context, &mut watch)
                }
            }
        })?;
        if let Some(error) = raised.into_inner().unwrap_or_default() {
            return Err(error);
        }
        let state = state.map_err(Failure::from)?;
        let report = Report::of(study, state).map_err(Failure::from)?;
        report.write(study, &folder, force).map_err(Failure::from)?;
        let result = nested(py, &report)?;
        result.set_item("warnings", told.into_inner().unwrap_or_default())?;
        if let Some(found) = report.state.found() {
            result.set_item("layout", self.of_entry(&found.entry)?)?;
        }
        if let Some(front) = &report.state.front {
            let layouts = front.layouts.iter().map(|found| self.of_entry(&found.entry)).collect::<Result<Vec<_>>>()?;
            result.get_item("front")?.set_item("found", layouts)?;
        }
        Ok(result)
    }

    /// Folds what shards have done, goes on with the search, and writes down what it asks for next. Gives how many layouts are newly asked
    /// for, and how many are waited for; where both are 0 the study is at its end.
    #[pyo3(signature = (folder, *, letters = None, force = false, threads = None))]
    fn ask<'py>(
        &self,
        py: Python<'py>,
        folder: PathBuf,
        letters: Option<PyReadonlyArray2<'py, u8>>,
        force: bool,
        threads: Option<usize>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let study = &self.inner;
        // Each call is a command of its own.
        input::forget();
        input::remember(&study.path);
        input::remember(study.design().path());
        study::claim(&folder, study, force).map_err(|error| Failure::with_help(error.to_string(), error.help()))?;
        let given: Vec<Assignment> = letters
            .map_or_else(Vec::new, |letters| letters.as_array().rows().into_iter().map(|row| row.to_vec()).collect());
        for assignment in &given {
            self.layout(assignment.clone())?;
        }
        let (asked, waiting, report) = run(py, threads, |context| -> Result<_> {
            if study::asked_in(&folder).exists() {
                merge(&folder)?;
            }
            let (mut asking, _) = Asking::open(study, &folder)?;
            if !given.is_empty() {
                let rung = study.stages.last().map_or(0, |stage| stage.rung);
                asking.ask(rung, &given.iter().collect::<Vec<_>>())?;
                return Ok((asking.asked, asking.waiting, None));
            }
            let state = run_with(study, &folder.join("journal.jsonl"), &mut asking, context, &mut ())?;
            let report = Report::of(study, state)?;
            report.write(study, &folder, force)?;
            Ok((asking.asked, asking.waiting, Some(report)))
        })??;
        let evaluations = report.as_ref().map(|report| report.state.evaluations);
        Ok(Table::new(py).with("asked", asked)?.with("waiting", waiting)?.with("evaluations", evaluations)?.0)
    }

    /// Evaluates one shard, such as "3/8", of what is asked for, into its own journal.
    #[pyo3(signature = (folder, shard, *, threads = None))]
    fn evaluate<'py>(
        &self,
        py: Python<'py>,
        folder: PathBuf,
        shard: &str,
        threads: Option<usize>,
    ) -> PyResult<Bound<'py, PyDict>> {
        let shard: Shard = shard.parse().map_err(Failure::from)?;
        let done = run(py, threads, |context| evaluate_shard(&self.inner, &folder, shard, context, |_| ()))?;
        let done = done.map_err(Failure::from)?;
        Ok(Table::new(py)
            .with("part", done.part)?
            .with("known", done.known)?
            .with("evaluated", done.evaluated)?
            .with("stopped", done.stopped)?
            .with("whole", done.is_whole())?
            .with("warnings", done.warnings)?
            .0)
    }

    /// Folds the journals of shards into the study's: in any order, as often as wanted. What is damaged is named, and the rest counts.
    fn merge<'py>(&self, py: Python<'py>, folder: PathBuf) -> PyResult<Bound<'py, PyDict>> {
        let merged = py.detach(|| merge(&folder)).map_err(Failure::from)?;
        let damage: Vec<&String> = merged.shards.iter().flat_map(|shard| &shard.damage).collect();
        let missing: BTreeMap<String, usize> = merged
            .shards
            .iter()
            .filter(|shard| shard.missing > 0)
            .map(|shard| (shard.path.display().to_string(), shard.missing))
            .collect();
        Ok(Table::new(py)
            .with("asked", merged.asked)?
            .with("answered", merged.answered)?
            .with("folded", merged.folded)?
            .with("repeated", merged.repeated)?
            .with("stopped", merged.shards.iter().map(|shard| shard.stopped).sum::<usize>())?
            .with("conflicts", merged.conflicts)?
            .with("damage", damage)?
            .with("missing", missing)?
            .with("absent", merged.absent)?
            .with("warnings", merged.warnings)?
            .0)
    }

    /// The journal of a folder as a table, one entry per evaluation.
    ///
    /// Columns, shape (n,): step_s; evaluation, from 1 at each step; each measure over all impacts, NaN where it has no value; loss;
    /// within_limits (bool); stop (str or None); letters, uint8, shape (n, letters).
    fn journal<'py>(&self, py: Python<'py>, folder: PathBuf) -> PyResult<Bound<'py, PyDict>> {
        let study = &self.inner;
        let entries = Journal::read(&folder.join("journal.jsonl")).map_err(Failure::from)?.entries;
        let mut rungs: Vec<(f64, Rung)> = Vec::new();
        for place in 0..study.rungs.len() {
            let plan = study.plan(place).map_err(|error| {
                Failure::from(match &self.design {
                    Lent::Sheet(design) => design.blame_plan(&error),
                    Lent::Space(design) => design.blame_plan(&error),
                })
            })?;
            let mut rung = Rung::default();
            let at = study.at(place);
            for (assignment, entry) in Key::new(&at, &plan).own(&at, &entries) {
                if rung.get(&assignment).is_none() && !entry.cut {
                    rung.add(study, &assignment, entry.clone());
                }
            }
            rungs.push((plan.step, rung));
        }
        let all: Vec<(f64, usize, &study::Judged)> = rungs
            .iter()
            .flat_map(|(step, rung)| rung.all().iter().enumerate().map(move |(k, judged)| (*step, k + 1, judged)))
            .collect();
        let mut table = Table::new(py)
            .with("step_s", vector(py, all.iter().map(|(step, ..)| *step).collect()))?
            .with("evaluation", vector(py, all.iter().map(|(_, k, _)| *k as i64).collect()))?
            .with("loss", vector(py, all.iter().map(|(.., judged)| judged.loss.total).collect()))?
            .with(
                "within_limits",
                vector(py, all.iter().map(|(.., judged)| judged.loss.miss == 0.0).collect::<Vec<bool>>()),
            )?;
        let scores: Vec<_> = all.iter().map(|(.., judged)| judged.scores(study)).collect();
        for &measure in Measure::ALL {
            let values: Vec<Option<f64>> = scores.iter().map(|scores| scores.get(measure)).collect();
            if values.iter().any(Option::is_some) {
                table = table.with(measure.column(), maybe(py, values))?;
            }
        }
        let letters: Vec<u8> = all.iter().flat_map(|(.., judged)| judged.assignment.iter().copied()).collect();
        let letters = vector(py, letters).call_method1("reshape", (all.len(), study.variables()))?;
        let stops: Vec<Option<&String>> = all.iter().map(|(.., judged)| judged.entry.stop.as_ref()).collect();
        Ok(table.with("stop", stops)?.with("letters", letters)?.0)
    }

    /// Why each evaluation of a folder's journal counts or not: a list of dicts, each for those under the same settings, with the settings
    /// that differ from the present ones.
    fn why<'py>(&self, py: Python<'py>, folder: PathBuf) -> PyResult<Bound<'py, PyAny>> {
        nested(py, &why(&self.inner, &folder.join("journal.jsonl")).map_err(Failure::from)?)
    }

    fn __repr__(&self) -> String {
        format!(
            "<Study {}: {} sites, budget {}>",
            self.inner.path.display(),
            self.inner.free.len(),
            self.inner.budget()
        )
    }
}

impl Study {
    fn of_entry(&self, entry: &Entry) -> Result<AnyLayout> {
        let letters = entry
            .assignment(self.inner.variables(), self.inner.alphabet.len() as u8)
            .ok_or_else(|| Failure::input("the layout belongs to another study"))?;
        self.layout(letters)
    }
}

/// Keeps the first error that Python raised, and ends the run.
fn keep(raised: &Mutex<Option<PyErr>>, context: &Context, error: PyErr) {
    raised.lock().unwrap_or_else(PoisonError::into_inner).get_or_insert(error);
    context.stop();
}

/// Tells a callback how the study goes.
struct Told<'a> {
    callback: Option<&'a Py<PyAny>>,
    raised: &'a Mutex<Option<PyErr>>,
    context: &'a Context,
    warnings: &'a Mutex<Vec<String>>,
    simulated: usize,
}

impl Watch for Told<'_> {
    fn warning(&mut self, text: &str) {
        self.warnings.lock().unwrap_or_else(PoisonError::into_inner).push(text.to_owned());
    }

    fn batch(&mut self, state: &State, simulated: usize) {
        self.simulated += simulated;
        let Some(callback) = self.callback else { return };
        let told = Python::attach(|py| -> PyResult<()> {
            let best = state.found().map(|found| nested(py, &found.scores)).transpose()?;
            let told = Table::new(py)
                .with("evaluations", state.evaluations)?
                .with("simulated", self.simulated)?
                .with("stopped", state.stopped)?
                .with("stage", state.stages.last().map(|stage| stage.method.clone()))?
                .with("best", best)?
                .with("loss", state.found().map(|found| found.loss))?
                .with("within_limits", state.best.is_some())?;
            callback.call1(py, (told.0,)).map(drop)
        });
        if let Err(error) = told {
            keep(self.raised, self.context, error);
        }
    }
}

/// An engine of Python: a callable that is given the place of the step, the layouts, and a function that says whether to stop, and gives
/// a line of a journal for each.
struct Elsewhere<'a> {
    study: &'a study::Study,
    engine: &'a Py<PyAny>,
    raised: &'a Mutex<Option<PyErr>>,
    context: &'a Context,
}

impl Engine for Elsewhere<'_> {
    fn entries(&mut self, rung: usize, assignments: &[&Assignment]) -> std::result::Result<Vec<Entry>, StudyError> {
        let letters = self.study.alphabet.len() as u8;
        let asked: Vec<String> = assignments.iter().map(|assignment| study::pack(assignment, letters)).collect();
        let answered = Python::attach(|py| -> PyResult<Vec<String>> {
            let handle = self.engine.call_method1(py, "submit", (rung, asked))?;
            // Asked for again and again, so that Ctrl-C is heard while others work.
            loop {
                if self.context.stopped() {
                    self.engine.call_method0(py, "stop")?;
                    return Ok(Vec::new());
                }
                if let Some(lines) =
                    self.engine.call_method1(py, "poll", (&handle,))?.extract::<Option<Vec<String>>>(py)?
                {
                    return Ok(lines);
                }
            }
        });
        let lines = match answered {
            Ok(lines) => lines,
            Err(error) => {
                keep(self.raised, self.context, error);
                return Ok(Vec::new());
            }
        };
        let entry = |line: &String| {
            Entry::from_line(line).ok_or_else(|| {
                StudyError::Engine("the engine's answer is damaged: a line's checksum does not fit".to_owned())
            })
        };
        lines.iter().map(entry).collect()
    }
}

/// Evaluates layouts of a study elsewhere: a line of a journal for each; see `granulens.engines`.
#[pyfunction]
#[pyo3(signature = (study, rung, layouts, *, threads = None))]
pub fn evaluate_lines(
    py: Python<'_>,
    study: &Bound<'_, Study>,
    rung: usize,
    layouts: Vec<String>,
    threads: Option<usize>,
) -> PyResult<Vec<String>> {
    let Study { inner: study, local, .. } = study.get();
    if rung >= study.rungs.len() {
        return Err(Failure::input(format!("the study has no step number {rung}")).into());
    }
    let letters = study.alphabet.len() as u8;
    let assignment = |text: &String| {
        study::unpack(text, study.variables(), letters)
            .ok_or_else(|| Failure::input(format!("{text} is no layout of {}", study.path.display())))
    };
    let assignments = layouts.iter().map(assignment).collect::<Result<Vec<Assignment>>>()?;
    let lines = run(py, threads, |context| -> Result<Vec<String>> {
        let mut local = local.lock().unwrap_or_else(PoisonError::into_inner);
        let known = match local.take() {
            Some(known) => known,
            None => Local::new(study, context)?,
        };
        let known = local.insert(known);
        let entries = known.entries(study, rung, &assignments.iter().collect::<Vec<_>>(), context)?;
        Ok(entries.iter().map(Entry::to_line).collect())
    })??;
    if lines.len() < layouts.len() {
        return Err(Failure::interrupted("interrupted").into());
    }
    Ok(lines)
}
