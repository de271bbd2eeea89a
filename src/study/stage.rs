//! What a study does one after the other: each stage a method, its evaluations, and the step at which it simulates.

use serde::Deserialize;

use super::StudyError;
use super::source::Source;
use crate::evaluate::Forces;
use crate::search::{BATCH, Method, MethodError, ORDER, TEMPERATURES};
use crate::units::Dimension::Time;

/// More is taken for a slip: all evaluations are held in memory.
pub(super) const MOST_EVALUATIONS: u64 = 10_000_000;

/// Finer fields than sites.
const MOST_ORDER: usize = 12;

/// As many beside each other as eight registers hold; beliefs about beliefs are worth little long before.
const MOST_BATCH: usize = 64;

/// What a stage does.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Work {
    /// Searches, from the best layouts so far.
    Search(Method),
    /// Anneals at low temperature, screened at a coarse step before scores at its own decide.
    Climb,
    /// Evaluates anew, at its own step, the best layouts so far and a sample of the others.
    Rescore,
}

/// The name of [`Work::Climb`].
const CLIMB: &str = "climb";

/// That of [`Work::Rescore`].
const RESCORE: &str = "rescore";

/// Layouts that a climb begins with where nobody says how many.
const BASINS: usize = 4;

/// Layouts that are evaluated anew where nobody says how many.
const RESCORED: usize = 16;

/// What stages do besides the methods of search, and in a line what that is.
pub(crate) const OTHERS: [(&str, &str); 2] = [
    (CLIMB, "annealing at low temperature, screened at a coarse step before scores at its own decide"),
    (RESCORE, "the best layouts so far and a sample of the others, evaluated anew at the stage's step"),
];

/// Of the screened proposals of a climb about one in so many is judged.
const JUDGED: u64 = 16;

impl Work {
    /// The name as it is written in files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Search(method) => method.name(),
            Self::Climb => CLIMB,
            Self::Rescore => RESCORE,
        }
    }
}

/// One stage.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stage {
    /// What it does.
    pub work: Work,
    /// Evaluations of layouts that are new at its step; of a climb proposals that are screened.
    pub evaluations: u64,
    /// Place of its step, and of how many forces it judges by, among the study's rungs.
    pub rung: usize,
    /// The same of a climb's screen; else its own.
    pub screen: usize,
    /// First and last temperature of a climb, in ln C where C alone counts.
    pub temperatures: [f64; 2],
    /// How many of the best layouts of the stages before it is given.
    pub promote: usize,
    /// How many layouts, evenly over the ranks of what the stages before evaluated, are evaluated with them, so that the rank
    /// correlation of the two steps is that of all and not of the best alone.
    pub sample: usize,
    /// Half waves each way of the fields of a level set, and one more; knots of a curve.
    pub order: usize,
    /// How many lenses a Bayesian search asks for at a time.
    pub batch: usize,
}

#[derive(Clone, Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct StageFile {
    method: String,
    evaluations: Option<u64>,
    step: Option<String>,
    promote: Option<usize>,
    sample: Option<usize>,
    order: Option<usize>,
    batch: Option<usize>,
    screen: Option<String>,
    screen_window: Option<String>,
    forces: Option<usize>,
    temperature: Option<[f64; 2]>,
}

impl StageFile {
    /// How many forces it judges by, where it says.
    pub fn forces(&self) -> Option<usize> {
        self.forces
    }
}

impl Stage {
    /// About how many evaluations there will be at most, at any step.
    pub fn most_evaluations(&self) -> u64 {
        self.evaluations + if self.work == Work::Climb { self.evaluations / JUDGED } else { 0 }
    }
}

/// How layouts are scored; what is left out is the study's, or the design's own.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Scoring {
    /// The step (s).
    pub step: Option<f64>,
    /// The forces that layouts are judged over.
    pub forces: Option<Forces>,
    /// The window (s).
    pub window: Option<f64>,
}

/// Stages, and the different ways in which they score, in order of first use. `band` is how far forces lie from an
/// impact's own, `usual` are the study's forces.
pub(super) fn read(
    source: &Source<'_>,
    files: &[StageFile],
    band: f64,
    usual: Forces,
) -> Result<(Vec<Stage>, Vec<Scoring>), StudyError> {
    let mut rungs: Vec<Scoring> = Vec::new();
    let mut stages: Vec<Stage> = Vec::new();
    for (k, file) in files.iter().enumerate() {
        let fail = |key: &str, message: String| source.fail_in("stage", k, key, message);
        let time = |key: &'static str, text: &Option<String>| match text {
            Some(text) => source.quantity(Time, key, text, |message| fail(key, message)).map(Some),
            None => Ok(None),
        };
        let step = time("step", &file.step)?;
        let forces = file.forces.map(|count| Forces::new(count, band)).transpose();
        let forces = forces.map_err(|error| fail("forces", format!("forces: {error}.")))?;
        let mut place = |scoring: Scoring| {
            // What is alike is one rung, however it is written.
            let scoring = Scoring { forces: scoring.forces.filter(|forces| *forces != usual), ..scoring };
            rungs.iter().position(|&known| known == scoring).unwrap_or_else(|| {
                rungs.push(scoring);
                rungs.len() - 1
            })
        };
        let work = match file.method.as_str() {
            CLIMB => Work::Climb,
            RESCORE => Work::Rescore,
            name => match name.parse() {
                Ok(method) => Work::Search(method),
                Err(error @ MethodError::Unknown(_)) => {
                    return Err(fail("method", format!("{error}, climb, rescore.")));
                }
                Err(error) => return Err(fail("method", format!("{error}."))),
            },
        };
        let (screen, rung) = if work == Work::Climb {
            let Some(screen) = time("screen", &file.screen)? else {
                let message = "a climb needs a screen, such as screen = \"5e-7 s\", beside its step.";
                return Err(fail("method", message.to_owned()));
            };
            // First the coarse one, as stages use them.
            let window = time("screen_window", &file.screen_window)?;
            let screen = place(Scoring { step: Some(screen), forces: Some(Forces::ONE), window });
            (screen, place(Scoring { step, forces, window: None }))
        } else {
            let own = [
                ("screen", file.screen.is_some()),
                ("screen_window", file.screen_window.is_some()),
                ("temperature", file.temperature.is_some()),
            ];
            if let Some((key, _)) = own.into_iter().find(|(_, given)| *given) {
                return Err(fail(key, format!("{key} belongs to stages with method = \"climb\".")));
            }
            let rung = place(Scoring { step, forces, window: None });
            (rung, rung)
        };
        let temperatures = file.temperature.unwrap_or(TEMPERATURES);
        if !(temperatures[1] > 0.0 && temperatures[0] >= temperatures[1] && temperatures[0] <= 1.0) {
            let message =
                "temperature must be the first and the last, from 1 down to more than 0, such as [0.002, 0.0005].";
            return Err(fail("temperature", message.to_owned()));
        }
        let promote = file.promote.unwrap_or(match work {
            Work::Climb => BASINS,
            Work::Rescore => RESCORED,
            Work::Search(method) => method.starts(),
        });
        let sample = file.sample.unwrap_or(0);
        if work == Work::Rescore && k == 0 {
            return Err(fail(
                "method",
                "method = \"rescore\" has nothing to evaluate anew in the first stage.".to_owned(),
            ));
        }
        if work != Work::Rescore && sample > 0 {
            return Err(fail("sample", "sample belongs to stages with method = \"rescore\".".to_owned()));
        }
        let order = file.order.unwrap_or(ORDER);
        let taking = |takes: fn(Method) -> bool| {
            let names: Vec<String> = Method::all().filter(|&m| takes(m)).map(|m| format!("\"{}\"", m.name())).collect();
            names.join(" or ")
        };
        if file.order.is_some() && !matches!(work, Work::Search(method) if method.takes_order()) {
            let message = format!("order belongs to stages with method = {}.", taking(Method::takes_order));
            return Err(fail("order", message));
        }
        if !(2..=MOST_ORDER).contains(&order) {
            let message = format!("order = {order} must be 2 to {MOST_ORDER}: cosines each way, or knots of a curve.");
            return Err(fail("order", message));
        }
        if file.batch.is_some() && !matches!(work, Work::Search(method) if method.takes_batch()) {
            return Err(fail("batch", "batch belongs to stages with method = \"lens-family-bayes\".".to_owned()));
        }
        let batch = file.batch.unwrap_or(BATCH);
        if !(1..=MOST_BATCH).contains(&batch) {
            return Err(fail("batch", format!("batch = {batch} must be 1 to {MOST_BATCH} lenses at a time.")));
        }
        let evaluations = match (work, file.evaluations) {
            (Work::Rescore, None) => promote as u64 + sample as u64,
            (Work::Rescore, Some(_)) => {
                return Err(fail(
                    "evaluations",
                    "a rescore evaluates promote and sample; leave evaluations out.".to_owned(),
                ));
            }
            (_, Some(evaluations)) => evaluations,
            (_, None) => {
                return Err(fail("evaluations", "evaluations is missing: how many this stage may do.".to_owned()));
            }
        };
        if !(1..=MOST_EVALUATIONS).contains(&evaluations) {
            return Err(fail("evaluations", format!("evaluations = {evaluations} must be 1 to {MOST_EVALUATIONS}.")));
        }
        let promote = promote.max(1);
        stages.push(Stage { work, evaluations, rung, screen, temperatures, promote, sample, order, batch });
    }
    Ok((stages, rungs))
}

/// The one stage of a study that names its method at the top.
pub(super) fn single(method: Method, evaluations: u64) -> Stage {
    Stage {
        work: Work::Search(method),
        evaluations,
        rung: 0,
        screen: 0,
        temperatures: TEMPERATURES,
        promote: 1,
        sample: 0,
        order: ORDER,
        batch: BATCH,
    }
}
