//! A study from the page: start, stop, go on; what its journal holds, whoever writes it.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::thread::JoinHandle;

use granulens::Context;
use granulens::score::{Measure, Scores};
use granulens::study::{Ended, Judged, Rung, State, Study, Watch, front_of};
use serde::Deserialize;
use serde_json::{Value, json};

use super::save::within;
use super::server::Shared;
use super::work::caught;
use crate::cli::failure::Failure;
use crate::cli::study::show::{Known, find};
use crate::cli::study::{compare, folder, read, run};
use crate::cli::{Band, Common};

/// Most evaluations that are sent, the best among them: more are a black picture.
const MOST: usize = 3000;

/// The study that the page runs, one at a time.
#[derive(Default)]
pub struct Runner(Mutex<Option<Running>>);

struct Running {
    path: String,
    stop: Context,
    thread: Option<JoinHandle<()>>,
    news: Arc<Mutex<News>>,
}

/// How it goes.
#[derive(Clone, Default)]
struct News {
    evaluations: u64,
    ended: Option<Value>,
}

impl Runner {
    fn lock(&self) -> MutexGuard<'_, Option<Running>> {
        self.0.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Stops the study, if one runs, and waits until its journal is whole.
    pub fn end(&self) {
        if let Some(mut running) = self.lock().take() {
            running.stop.stop();
            if let Some(thread) = running.thread.take() {
                let _ = thread.join();
            }
        }
    }
}

#[derive(Deserialize)]
pub struct Asked {
    /// The study file, below the folder in which the program was started.
    path: String,
    /// Length of the journal that the page knows (bytes).
    #[serde(default)]
    known: Option<u64>,
}

#[derive(Deserialize)]
pub struct One {
    path: String,
    /// Place of the step among the study's.
    rung: usize,
    /// Which evaluation at it, from 0.
    evaluation: usize,
}

#[derive(Deserialize)]
pub struct Several {
    folders: Vec<String>,
}

/// As the command line without options.
fn plain() -> (Common, Band) {
    let common =
        Common { json: false, quiet: true, threads: None, seed: None, out: None, force: false, dry_run: false };
    (common, Band { forces: None, band: None })
}

fn here(path: &str, shared: &Shared) -> Result<PathBuf, Failure> {
    // What was named at the start may lie anywhere.
    if shared.opened.study.as_ref().is_some_and(|study| study.display().to_string() == path) {
        return Ok(PathBuf::from(path));
    }
    let folder = std::env::current_dir().map_err(|error| Failure::input(format!("the current folder: {error}")))?;
    within(&folder, path)
}

/// Study files in the folder and in those right below it.
pub fn list(shared: &Shared) -> Result<Value, Failure> {
    let mut found: Vec<String> = shared.opened.study.iter().map(|path| path.display().to_string()).collect();
    let mut look = |folder: &Path| -> Vec<PathBuf> {
        let mut folders = Vec::new();
        let entries = std::fs::read_dir(folder).into_iter().flatten().flatten().take(500);
        let mut paths: Vec<PathBuf> = entries.map(|entry| entry.path()).collect();
        paths.sort();
        for path in paths {
            let path = path.strip_prefix(".").map_or(path.clone(), Path::to_owned);
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|extension| extension == "toml") {
                let text = std::fs::read_to_string(&path).unwrap_or_default();
                let is_study = text.parse::<toml::Table>().is_ok_and(|table| {
                    table.contains_key("design") && (table.contains_key("objective") || table.contains_key("materials"))
                });
                let name = path.display().to_string();
                if is_study && !found.contains(&name) {
                    found.push(name);
                }
            }
        }
        folders
    };
    for folder in look(Path::new(".")) {
        look(&folder);
    }
    Ok(json!({ "studies": found }))
}

/// What a study's journal holds.
pub fn show(asked: &Asked, shared: &Shared) -> Result<Value, Failure> {
    let (common, band) = plain();
    let path = here(&asked.path, shared)?;
    let study = read(&path, &band, &common)?;
    let place = folder(&common, &study);
    let length = std::fs::metadata(place.join("journal.jsonl")).map_or(0, |found| found.len());
    let mut answer = json!({
        "path": asked.path,
        "folder": place,
        "journal": length,
        "budget": study.budget(),
        "running": running(&asked.path, shared),
    });
    if length == 0 {
        answer["study"] = about(&study);
    } else if asked.known != Some(length) {
        let Known { study, rungs, best, .. } = find(&path, &band, &common)?;
        answer["study"] = about(&study);
        answer["rungs"] = rungs.iter().map(|(step, rung)| of_rung(&study, *step, rung)).collect();
        answer["best"] = json!(best);
        let finest = rungs.iter().filter(|(_, rung)| !rung.all().is_empty()).min_by(|a, b| a.0.total_cmp(&b.0));
        answer["front"] = json!(finest.and_then(|(_, rung)| {
            let front = front_of(&study, rung, None)?;
            // By their places among the evaluations, as everything else here.
            let places: Vec<u64> = front.layouts.iter().map(|found| found.evaluation.saturating_sub(1)).collect();
            Some(json!({ "measures": front.measures, "evaluations": places, "knee": front.knee }))
        }));
    }
    Ok(answer)
}

/// What is asked.
fn about(study: &Study) -> Value {
    let measures: Vec<Value> = measures(study)
        .iter()
        .map(|measure| json!({ "name": measure.name(), "symbol": measure.symbol(), "unit": measure.unit().name() }))
        .collect();
    json!({
        "design": study.design().text(),
        "design_file": study.design().path(),
        "seed": study.seed,
        "sites": study.free.len(),
        "materials": study.alphabet.iter().map(|&place| &study.palette[usize::from(place)].name).collect::<Vec<_>>(),
        "wanted": study.objective.goals().map(|term| term.measure.name()).collect::<Vec<_>>(),
        "measures": measures,
        "stages": study.stages.iter().map(|stage| json!({
            "method": stage.work.name(), "evaluations": stage.evaluations, "rung": stage.rung,
        })).collect::<Vec<_>>(),
    })
}

/// What is wanted, and the usual three.
fn measures(study: &Study) -> Vec<Measure> {
    let mut found = vec![Measure::Contrast, Measure::FocalGain, Measure::Protection];
    for term in &study.objective.terms {
        if !found.contains(&term.measure) {
            found.push(term.measure);
        }
    }
    found
}

/// The evaluations at a step: thinned where there are many, the best of all times and the best of all kept.
fn of_rung(study: &Study, step: f64, rung: &Rung) -> Value {
    let all = rung.all();
    let measures = measures(study);
    let mut least = f64::INFINITY;
    let mut best = Vec::new();
    let stride = all.len().div_ceil(MOST).max(1);
    let mut kept = Vec::new();
    for (k, judged) in all.iter().enumerate() {
        let within = judged.loss.miss == 0.0;
        let better = within && judged.loss.total < least;
        if better {
            least = judged.loss.total;
            best.push(json!([k + 1, finite(judged.loss.total)]));
        }
        if better || k % stride == 0 {
            kept.push(of_evaluation(study, k, judged, &measures, within));
        }
    }
    json!({ "step_s": step, "evaluations": all.len(), "best": best, "kept": kept })
}

fn of_evaluation(study: &Study, k: usize, judged: &Judged, measures: &[Measure], within: bool) -> Value {
    let scores: Scores = judged.scores(study);
    let values: Vec<Option<f64>> = measures.iter().map(|&measure| scores.get(measure).and_then(finite)).collect();
    json!([k, finite(judged.loss.total), within, values])
}

fn finite(value: f64) -> Option<f64> {
    value.is_finite().then_some(value)
}

/// Whether the page's study is this one, and how it goes.
fn running(path: &str, shared: &Shared) -> Value {
    match &*shared.study.lock() {
        Some(running) if running.path == path => {
            let news = running.news.lock().unwrap_or_else(PoisonError::into_inner).clone();
            json!({ "runs": news.ended.is_none(), "evaluations": news.evaluations, "ended": news.ended })
        }
        Some(running) => {
            let ended = running.news.lock().unwrap_or_else(PoisonError::into_inner).ended.is_some();
            json!({ "runs": false, "other": if ended { None } else { Some(&running.path) } })
        }
        None => json!({ "runs": false }),
    }
}

struct Told(Arc<Mutex<News>>);

impl Watch for Told {
    fn warning(&mut self, _: &str) {}
    fn batch(&mut self, state: &State, _: usize) {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).evaluations = state.evaluations;
    }
}

/// Starts a study, or goes on with it.
pub fn start(asked: &Asked, shared: &Shared) -> Result<Value, Failure> {
    let (common, band) = plain();
    let path = here(&asked.path, shared)?;
    let study = read(&path, &band, &common)?;
    let place = folder(&common, &study);
    let mut slot = shared.study.lock();
    let busy = |running: &Running| running.news.lock().unwrap_or_else(PoisonError::into_inner).ended.is_none();
    if let Some(other) = slot.as_ref().filter(|running| busy(running)) {
        return Err(Failure::input_with_help(
            format!("{} is running", other.path),
            "Stop it first; what it has found is kept, and it goes on where it was.",
        ));
    }
    let (stop, news) = (Context::default(), Arc::new(Mutex::new(News::default())));
    let (context, told) = (stop.clone(), Arc::clone(&news));
    let thread = std::thread::spawn(move || {
        let mut watch = Told(Arc::clone(&told));
        let done = caught(|| run::search(&study, &place, &common, &context, &mut watch));
        let ended = match done {
            Ok(Ok(state)) => json!({ "why": state.ended, "evaluations": state.evaluations }),
            Ok(Err(Failure::Interrupted(_))) => json!({ "why": Ended::Interrupted }),
            Ok(Err(failure)) => json!({ "error": failure.told() }),
            Err(words) => json!({ "error": { "kind": "crash", "message": format!("the study crashed: {words}") } }),
        };
        told.lock().unwrap_or_else(PoisonError::into_inner).ended = Some(ended);
    });
    *slot = Some(Running { path: asked.path.clone(), stop, thread: Some(thread), news });
    Ok(json!({ "started": asked.path }))
}

/// Asks the study to stop.
pub fn stop(shared: &Shared) -> Result<Value, Failure> {
    if let Some(running) = &*shared.study.lock() {
        running.stop.stop();
    }
    Ok(json!({ "stopping": true }))
}

/// A layout of the journal.
pub fn layout(asked: &One, shared: &Shared) -> Result<Value, Failure> {
    let (common, band) = plain();
    let Known { study, rungs, .. } = find(&here(&asked.path, shared)?, &band, &common)?;
    let judged = rungs.get(asked.rung).and_then(|(_, rung)| rung.all().get(asked.evaluation));
    let judged = judged.ok_or_else(|| Failure::input("the journal has no such evaluation"))?;
    let layout = study.layout(&judged.assignment);
    Ok(json!({
        "palette": layout.palette().iter().map(|material| &material.name).collect::<Vec<_>>(),
        "materials": layout.materials(),
        "design": study.design().text(),
    }))
}

/// Studies that were run, side by side.
pub fn side_by_side(asked: &Several, shared: &Shared) -> Result<Value, Failure> {
    let folders = asked.folders.iter().map(|path| here(path, shared)).collect::<Result<Vec<_>, _>>()?;
    let (value, table) = compare::side_by_side(&folders)?;
    Ok(json!({ "compared": value, "table": table }))
}
