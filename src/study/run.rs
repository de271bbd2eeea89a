//! Ask, evaluate, write down, tell: stage after stage.

use std::collections::{HashMap, HashSet, VecDeque};
use std::path::Path;
use std::time::{Duration, Instant};

use super::climb::above;
use super::engine::{Engine, Local};
use super::family::RayNotes;
use super::rung::{Judged, Rung, order};
use super::stage::{Stage, Work};
use super::state::{self, Ended, Found, RungState, StageState, State};
use super::tolerance::{self, Robustness};
use super::why::Circumstances;
use super::{Entry, Final, Improvement, Journal, Study, StudyError, baselines, finals};
use crate::Context;
use crate::evaluate::EvaluatorError;
use crate::search::{Assignment, LocalOptimality, Loss, Parametrisation, Rng, Rounds, Search as _};

/// Batches in a row without an assignment that is new, after which everything within reach is taken to be known.
const STALE: u32 = 1000;

/// Is told how a study goes.
pub trait Watch {
    /// Something about the journal that should be known.
    fn warning(&mut self, text: &str);
    /// A batch is done: `simulated` of its evaluations by simulation, the others came from the journal.
    fn batch(&mut self, state: &State, simulated: usize);
}

/// Nobody is told.
impl Watch for () {
    fn warning(&mut self, _: &str) {}
    fn batch(&mut self, _: &State, _: usize) {}
}

/// Runs a study to its end, or on from where it was, on all threads of the current pool. When it is stopped, or the
/// study's time for a run is over, it ends with what it has.
///
/// # Errors
/// See [`StudyError`].
pub fn run(study: &Study, journal: &Path, context: &Context, watch: &mut impl Watch) -> Result<State, StudyError> {
    go(study, journal, None, context, watch)
}

/// As [`run`], where others evaluate what is asked for; uniform crystals, baselines and tolerances are simulated here. What they give is
/// checked and journalled here, so that a run that ends anywhere goes on to the same bits, with whatever engine.
///
/// # Errors
/// As there, and those of the engine.
pub fn run_with(
    study: &Study,
    journal: &Path,
    engine: &mut dyn Engine,
    context: &Context,
    watch: &mut impl Watch,
) -> Result<State, StudyError> {
    go(study, journal, Some(engine), context, watch)
}

fn go(
    study: &Study,
    journal: &Path,
    engine: Option<&mut dyn Engine>,
    context: &Context,
    watch: &mut impl Watch,
) -> Result<State, StudyError> {
    let deadline = study.time.map(|time| Instant::now() + Duration::from_secs_f64(time.min(1e9)));
    // Errors of the study are found before anything is written.
    let local = Local::new(study, context)?;
    let journal_path = journal;
    let (journal, loaded) = Journal::open(journal)?;
    loaded.warnings.iter().for_each(|warning| watch.warning(warning));
    for (rung, evaluator) in local.evaluators.iter().enumerate() {
        let plan = evaluator.plan();
        let told = Circumstances::note(&local.at[rung], plan, local.keys[rung], journal_path)?;
        told.iter().for_each(|told| watch.warning(told));
    }
    if let Some(missing) = local.no_protection() {
        watch.warning(&format!("there is no Q under every impact: {missing}"));
    }
    let cache: Vec<HashMap<Assignment, VecDeque<&Entry>>> =
        local.keys.iter().zip(&local.at).map(|(key, study)| by_choice(key.own(study, &loaded.entries))).collect();
    let used: HashSet<&str> =
        cache.iter().flat_map(HashMap::values).flatten().map(|entry| entry.key.as_str()).collect();
    let others = loaded.entries.iter().filter(|entry| !used.contains(entry.key.as_str())).count();
    if others > 0 {
        watch.warning(&format!(
            "{others} evaluations of the journal belong to other settings and are not used; study show --why says which"
        ));
    }
    let rungs = vec![Rung::default(); study.rungs.len()];
    let steps = local.evaluators.iter().map(|evaluator| evaluator.plan().step).collect();
    let state = State {
        evaluations: 0,
        stopped: 0,
        stages: Vec::new(),
        ended: Ended::Budget,
        start: None,
        best: None,
        nearest: None,
        rungs: Vec::new(),
        glances: Vec::new(),
        front: None,
        history: Vec::new(),
        baselines: Vec::new(),
        finals: Vec::new(),
        tolerance: None,
    };
    let first = study.first();
    let rays = RayNotes::default();
    let run =
        Run { study, local, engine, steps, journal, cache, rungs, first, context, deadline, state, rays, top: None };
    run.go(watch)
}

/// A journal's entries by assignment, those of one assignment in their order.
fn by_choice(own: Vec<(Assignment, &Entry)>) -> HashMap<Assignment, VecDeque<&Entry>> {
    let mut all: HashMap<Assignment, VecDeque<&Entry>> = HashMap::new();
    own.into_iter().for_each(|(assignment, entry)| all.entry(assignment).or_default().push_back(entry));
    all
}

/// A study that is under way.
pub(super) struct Run<'a, 'e> {
    pub study: &'a Study,
    pub local: Local,
    /// Who evaluates, where others do.
    engine: Option<&'e mut dyn Engine>,
    /// Step of each rung (s).
    steps: Vec<f64>,
    journal: Journal,
    /// For each rung what the journal holds and has not been asked for yet.
    cache: Vec<HashMap<Assignment, VecDeque<&'a Entry>>>,
    pub rungs: Vec<Rung>,
    first: Vec<Assignment>,
    context: &'a Context,
    deadline: Option<Instant>,
    pub state: State,
    /// What rays say of lenses that were asked for.
    rays: RayNotes,
    /// Rung, assignment and loss of the best or nearest.
    top: Option<(usize, Assignment, Loss)>,
}

/// How a batch ended.
enum Batch {
    /// Whole, with the losses of all that was asked for.
    Whole(Vec<Loss>),
    /// With the stage's evaluations used up.
    Spent,
    /// Before its end, on request.
    Interrupted,
    /// Before its end, since the others have not answered yet.
    Asked,
}

/// What others say, if it is what was asked for.
fn answers(
    study: &Study,
    local: &Local,
    rung: usize,
    asked: &[&Assignment],
    answers: Vec<Entry>,
) -> Result<Vec<Entry>, StudyError> {
    let other = answers.len() > asked.len()
        || asked.iter().zip(&answers).any(|(assignment, entry)| entry.key != local.key(study, rung, assignment));
    if other {
        let message = "the engine answered other layouts than it was asked for, or under other settings: its granulens or its files differ from these";
        return Err(StudyError::Engine(message.to_owned()));
    }
    Ok(answers)
}

impl Run<'_, '_> {
    fn go(mut self, watch: &mut impl Watch) -> Result<State, StudyError> {
        let mut rng = Rng::new(self.study.seed);
        for k in 0..self.study.stages.len() {
            // A study of one stage has the seed itself, later stages have others.
            let seed = if k == 0 { self.study.seed } else { rng.bits() };
            let ended = self.stage(k, seed, watch)?;
            self.state.ended = ended;
            if ended.goes_on() {
                break;
            }
        }
        let finest = self.top.as_ref().map_or(0, |(rung, ..)| *rung);
        self.state.rungs = (0..self.rungs.len())
            .filter(|&rung| !self.rungs[rung].all().is_empty())
            .map(|rung| {
                let (rank_correlation, shared) = self.rungs[rung].correlation(&self.rungs[finest]);
                let evaluations = self.rungs[rung].all().len() as u64;
                let forces = self.local.at[rung].forces.count() as u64;
                RungState { step: self.steps[rung], forces, evaluations, rank_correlation, shared: shared as u64 }
            })
            .collect();
        let start = self.rungs[finest].get(&self.first[0]).or_else(|| self.rungs[0].get(&self.first[0]));
        self.state.front = state::front_of(self.study, &self.rungs[finest], start);
        if !self.state.ended.goes_on() {
            // Some of what is simulated here gives no half answers: a request to stop is then an error of its own.
            match self.close(finest) {
                Err(StudyError::Evaluator(EvaluatorError::Interrupted)) => self.state.ended = Ended::Interrupted,
                closed => closed?,
            }
        }
        Ok(self.state)
    }

    /// What is told of a study whose stages are done.
    fn close(&mut self, finest: usize) -> Result<(), StudyError> {
        let evaluator = &self.local.evaluators[finest];
        let baselines = baselines::evaluate(&self.local.at[finest], evaluator, self.context)?;
        if self.context.stopped() {
            self.state.ended = Ended::Interrupted;
            return Ok(());
        }
        self.state.baselines = baselines;
        self.state.finals = self.finals(finest)?;
        self.state.tolerance = self.tolerance(finest)?;
        self.state.glances = self.rungs[finest].glances(self.study, &self.rays);
        Ok(())
    }

    /// The best or nearest layout.
    fn found(&self) -> Option<Assignment> {
        self.state.found()?.entry.assignment(self.study.variables(), self.study.alphabet.len() as u8)
    }

    /// The figures of the best or nearest layout.
    fn finals(&mut self, finest: usize) -> Result<Vec<Final>, StudyError> {
        let Some(assignment) = self.found() else { return Ok(Vec::new()) };
        let finals = finals::evaluate(self.study, &assignment, self.steps[finest], self.context)?;
        if self.context.stopped() {
            self.state.ended = Ended::Interrupted;
        }
        Ok(finals)
    }

    /// What the best or nearest layout loses where it is not built as drawn.
    fn tolerance(&mut self, finest: usize) -> Result<Option<Robustness>, StudyError> {
        let Some(assignment) = self.found() else { return Ok(None) };
        let loses = tolerance::evaluate(&self.local.at[finest], &assignment, finest, self.context)?;
        if self.context.stopped() {
            self.state.ended = Ended::Interrupted;
            return Ok(None);
        }
        Ok(loses)
    }

    /// The best `count` of the stages before this one, at the step of the last of them; the starts before there is any.
    fn promoted(&self, k: usize) -> Vec<Assignment> {
        self.promoted_of(k, self.study.stages[k].promote)
    }

    /// The same with another number of them.
    pub fn promoted_of(&self, k: usize, count: usize) -> Vec<Assignment> {
        let Some(before) = k.checked_sub(1) else { return self.first.clone() };
        let ranked = self.rungs[self.study.stages[before].rung].ranked();
        ranked.iter().take(count).map(|judged| judged.assignment.clone()).collect()
    }

    /// Evenly over the ranks behind those that are promoted.
    fn sample(&self, k: usize) -> Vec<Assignment> {
        let Stage { promote, sample, .. } = self.study.stages[k];
        let ranked = self.rungs[self.study.stages[k - 1].rung].ranked();
        let rest = ranked.get(promote..).unwrap_or_default();
        (0..sample.min(rest.len())).map(|j| rest[j * rest.len() / sample.min(rest.len())].assignment.clone()).collect()
    }

    fn stage(&mut self, k: usize, seed: u64, watch: &mut impl Watch) -> Result<Ended, StudyError> {
        let stage = self.study.stages[k];
        self.state.stages.push(StageState {
            method: stage.work.name().to_owned(),
            step: self.steps[stage.rung],
            evaluations: 0,
            rounds: 0,
            judged: 0,
            best: None,
            within_limits: false,
        });
        if stage.work == Work::Climb {
            return self.climb(k, seed, watch);
        }
        let starts = self.promoted(k);
        let mut search = match stage.work {
            Work::Search(method) => {
                let space = self.study.space();
                let parametrisation = match method.takes_parametrisation() {
                    true => self
                        .study
                        .parametrisation(&self.rays)
                        .map(|parametrisation| Parametrisation { batch: stage.batch, ..parametrisation }),
                    false => starts.first().and_then(|start| method.fields(&space, stage.order, start)),
                };
                Some(Rounds::new(method, &space, starts.clone(), parametrisation, seed))
            }
            Work::Climb | Work::Rescore => None,
        };
        let mut list = if search.is_none() { [starts, self.sample(k)].concat() } else { Vec::new() };
        let mut stale = 0;
        let ended = loop {
            if let Some(ended) = self.is_over() {
                break ended;
            }
            let asked = match &mut search {
                Some(search) => search.ask(),
                None => list.drain(..list.len().min(RESCORED)).collect(),
            };
            if asked.is_empty() || stale == STALE {
                break Ended::NothingNew;
            }
            let before = self.state.evaluations;
            let (batch, simulated) = self.batch(k, &asked)?;
            stale = if self.state.evaluations > before { 0 } else { stale + 1 };
            let mut local_optimality = LocalOptimality::None;
            if let Some(search) = &mut search {
                if let Batch::Whole(losses) = &batch {
                    search.tell(losses);
                }
                local_optimality = search.best().map_or(local_optimality, |(best, _)| {
                    self.local_optimality_of(stage.rung, best, search.local_optimality())
                });
                self.state.stages[k].rounds = search.ended();
            }
            self.show_best(local_optimality);
            watch.batch(&self.state, simulated);
            match batch {
                Batch::Whole(_) if self.state.stages[k].evaluations < stage.evaluations => {}
                Batch::Whole(_) | Batch::Spent => break Ended::Budget,
                Batch::Interrupted => break Ended::Interrupted,
                Batch::Asked => break Ended::Asked,
            }
        };
        self.show_stage(k);
        Ok(ended)
    }

    /// Whether what is not there has been asked of others.
    pub fn waits(&self) -> bool {
        self.engine.is_some() && !self.context.stopped()
    }

    /// Why nothing more is to be done, if so.
    pub fn is_over(&self) -> Option<Ended> {
        if self.context.stopped() {
            return Some(Ended::Interrupted);
        }
        self.deadline.filter(|deadline| Instant::now() >= *deadline).map(|_| Ended::Time)
    }

    /// What the journal holds of an assignment and has not given yet. An entry that was cut short serves only where it is above one of the
    /// limits.
    fn held(&mut self, rung: usize, assignment: &Assignment, limits: Option<&Vec<f64>>) -> Option<Entry> {
        let held = self.cache[rung].get_mut(assignment)?;
        while let Some(entry) = held.pop_front() {
            if !entry.cut || limits.is_some_and(|limits| above(entry, limits)) {
                return Some(entry.clone());
            }
        }
        None
    }

    /// Entries of assignments, from the journal or by simulation: all, or those before the first that was interrupted, so that the journal's
    /// order is that of the search; and how many were simulated.
    pub fn entries(
        &mut self,
        rung: usize,
        assignments: &[&Assignment],
        limits: Option<&[Vec<f64>]>,
    ) -> Result<(Vec<Entry>, usize), StudyError> {
        let of = |k: usize| limits.map(|limits| &limits[k]);
        let held: Vec<Option<Entry>> = (0..assignments.len()).map(|k| self.held(rung, assignments[k], of(k))).collect();
        let unknown: Vec<usize> = (0..assignments.len()).filter(|&k| held[k].is_none()).collect();
        let asked: Vec<&Assignment> = unknown.iter().map(|&k| assignments[k]).collect();
        let limits: Option<Vec<Vec<f64>>> = limits.map(|limits| unknown.iter().map(|&k| limits[k].clone()).collect());
        let new = match &mut self.engine {
            _ if asked.is_empty() => Vec::new(),
            None => self.local.entries_within(self.study, rung, &asked, limits.as_deref(), self.context)?,
            // Others know of no limits and answer in full.
            Some(engine) => answers(self.study, &self.local, rung, &asked, engine.entries(rung, &asked)?)?,
        };
        self.journal.append(&new)?;
        let simulated = new.len();
        let mut new = new.into_iter();
        Ok((held.into_iter().map_while(|held| held.or_else(|| new.next())).collect(), simulated))
    }

    /// Evaluates what is new of a batch, within the stage's evaluations; and how many of it were simulated.
    fn batch(&mut self, k: usize, asked: &[Assignment]) -> Result<(Batch, usize), StudyError> {
        let Stage { rung, evaluations, .. } = self.study.stages[k];
        let mut fresh: Vec<&Assignment> = Vec::new();
        let mut listed = HashSet::new();
        for assignment in asked {
            if self.rungs[rung].get(assignment).is_none() && listed.insert(assignment) {
                fresh.push(assignment);
            }
        }
        let left = usize::try_from(evaluations - self.state.stages[k].evaluations).unwrap_or(usize::MAX);
        let cut = fresh.len() > left;
        fresh.truncate(left);

        let (entries, simulated) = self.entries(rung, &fresh, None)?;
        let whole = entries.len() == fresh.len();
        for (assignment, entry) in fresh.into_iter().zip(entries) {
            self.count(k, &entry);
            self.judge(rung, assignment, entry);
        }
        if !whole {
            return Ok((if self.waits() { Batch::Asked } else { Batch::Interrupted }, simulated));
        }
        let losses =
            asked.iter().map(|assignment| self.rungs[rung].get(assignment).map(|judged| judged.loss.clone())).collect();
        // What was cut off has no loss, and nobody asks further.
        Ok((if cut { None } else { losses }.map_or(Batch::Spent, Batch::Whole), simulated))
    }

    /// Counts one evaluation of a stage.
    pub fn count(&mut self, k: usize, entry: &Entry) {
        self.state.evaluations += 1;
        self.state.stages[k].evaluations += 1;
        self.state.stopped += u64::from(entry.stop.is_some() && !entry.cut);
    }

    /// Takes down one evaluation.
    pub fn judge(&mut self, rung: usize, assignment: &Assignment, entry: Entry) {
        let judged = self.rungs[rung].add(self.study, assignment, entry);
        let loss = judged.loss.clone();
        if self.state.start.is_none() && *assignment == self.first[0] {
            let judged = judged.clone();
            self.state.start = Some(Found::new(self.study, &self.rungs[rung], &judged, LocalOptimality::None));
        }
        // The word of a finer step, or of more forces, counts more than any coarser one's.
        let fineness = |rung: usize| (-self.steps[rung], self.local.at[rung].forces.count());
        let better = loss.is_finite()
            && self.top.as_ref().is_none_or(|(at, _, least)| {
                fineness(rung) > fineness(*at) || (rung == *at && order(&loss) < order(least))
            });
        if better {
            let (evaluations, step) = (self.state.evaluations, self.steps[rung]);
            let within_limits = loss.miss == 0.0;
            self.state.history.push(Improvement { evaluations, step, loss: loss.total, within_limits });
            self.top = Some((rung, assignment.clone(), loss));
        }
    }

    /// What is proved of a search's best holds of the study's, if they are the same at the same step.
    fn local_optimality_of(
        &self,
        rung: usize,
        best: &Assignment,
        local_optimality: LocalOptimality,
    ) -> LocalOptimality {
        let same = self.top.as_ref().is_some_and(|(at, assignment, _)| *at == rung && assignment == best);
        if same { local_optimality } else { LocalOptimality::None }
    }

    pub fn show_best(&mut self, local_optimality: LocalOptimality) {
        let Some((rung, assignment, _)) = &self.top else { return };
        let rung = &self.rungs[*rung];
        let Some(judged) = rung.get(assignment) else { return };
        let found = Found::new(self.study, rung, judged, local_optimality);
        (self.state.best, self.state.nearest) =
            if found.within_limits { (Some(found), None) } else { (None, Some(found)) };
    }

    pub fn show_stage(&mut self, k: usize) {
        let best: Option<&Judged> = self.rungs[self.study.stages[k].rung]
            .all()
            .iter()
            .filter(|judged| judged.loss.is_finite())
            .min_by(|a, b| order(&a.loss).partial_cmp(&order(&b.loss)).unwrap_or(std::cmp::Ordering::Equal));
        let stage = &mut self.state.stages[k];
        stage.best = best.map(|judged| judged.scores(self.study));
        stage.within_limits = best.is_some_and(|judged| judged.loss.miss == 0.0);
    }
}

/// Layouts that a rescore evaluates at a time: two registers of eight.
const RESCORED: usize = 16;
