//! Ask, evaluate, write down, tell.

use std::collections::{HashMap, HashSet};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};

use serde::{Deserialize, Serialize};

use super::journal::pack;
use super::{Entry, Journal, Study, StudyError};
use crate::dem::Stop;
use crate::evaluate::{Evaluator, Plan};
use crate::search::{Choice, Rounds, Search};

/// Batches in a row without a choice that is new, after which everything within reach is taken to be known.
const STALE: u32 = 1000;

/// Hashes what the scores of a study's layouts depend on.
#[derive(Clone, Copy, Debug)]
pub struct Key(u128);

impl Key {
    /// Everything but the layout: the design's text, materials, integrator, step and window.
    pub fn new(study: &Study, plan: &Plan) -> Self {
        let mut key = Self(0x6c62_272e_07bb_0142_62b8_2175_6295_c58d);
        key.add(study.design.text.as_bytes());
        key.add(format!("{:?}", study.palette).as_bytes());
        key.add(plan.integrator.to_string().as_bytes());
        key.add(&plan.step.to_bits().to_le_bytes());
        key.add(&plan.window.to_bits().to_le_bytes());
        key
    }

    /// FNV-1a, 128 bits; the length first, so that parts cannot run into each other.
    fn add(&mut self, bytes: &[u8]) {
        for byte in (bytes.len() as u64).to_le_bytes().iter().chain(bytes) {
            self.0 = (self.0 ^ u128::from(*byte)).wrapping_mul(0x0000_0000_0100_0000_0000_0000_0000_013b);
        }
    }

    /// With a layout, as hexadecimal text.
    pub fn of(mut self, materials: &[u8]) -> String {
        self.add(materials);
        format!("{:032x}", self.0)
    }

    /// The entries of a journal that belong to the study as it is now, by choice.
    pub fn own<'a>(self, study: &Study, entries: &'a [Entry]) -> Vec<(Choice, &'a Entry)> {
        let letters = study.letters.len() as u8;
        let own = |entry: &'a Entry| {
            let choice = entry.choice(study.free.len(), letters)?;
            (self.of(&study.layout(&choice).materials) == entry.key).then_some((choice, entry))
        };
        entries.iter().filter_map(own).collect()
    }
}

/// The best layout of a study.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Best {
    /// Its scores.
    #[serde(flatten)]
    pub entry: Entry,
    /// Which evaluation it was, from 1.
    pub evaluation: u64,
    /// Whether it keeps the objective's limits.
    pub within_limits: bool,
    /// Whether it is known that no flip of a single site makes the objective better.
    pub one_opt: bool,
}

/// Why a study ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Ended {
    /// All evaluations are done.
    Budget,
    /// The search finds nothing that it has not seen.
    NothingNew,
    /// On request; run again to go on.
    Interrupted,
}

/// How far a study is. Nothing in it depends on when and how often it was interrupted.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// Evaluations of different layouts.
    pub evaluations: u64,
    /// How many of these a guard stopped.
    pub stopped: u64,
    /// Rounds of the method that have ended.
    pub rounds: u64,
    /// Why it ended.
    pub ended: Ended,
    /// The start's scores.
    pub start: Option<Entry>,
    /// The best layout: of those within the limits that with the least loss, or of all if none is within.
    pub best: Option<Best>,
}

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

/// Runs a study to its end, or on from where it was, on all threads of the current pool. When `interrupt` is set it ends with
/// what it has.
///
/// # Errors
/// See [`StudyError`].
pub fn run(study: &Study, journal: &Path, interrupt: &AtomicBool, watch: &mut impl Watch) -> Result<State, StudyError> {
    // Errors of the study are found before anything is written.
    let evaluator = Evaluator::new(&study.design, study.palette.clone(), study.overrides, interrupt)?;
    let key = Key::new(study, evaluator.plan());
    let (mut journal, loaded) = Journal::open(journal)?;
    loaded.warnings.iter().for_each(|warning| watch.warning(warning));
    let own = key.own(study, &loaded.entries);
    let others = loaded.entries.len() - own.len();
    if others > 0 {
        watch.warning(&format!("{others} evaluations of the journal belong to other settings and are not used"));
    }
    let cache: HashMap<Choice, &Entry> = own.into_iter().collect();

    let space = study.space();
    let first = study.first();
    let mut search = Rounds::new(study.method, &space, first.clone(), study.seed);
    let mut known: HashMap<Choice, Entry> = HashMap::new();
    let mut state = State { evaluations: 0, stopped: 0, rounds: 0, ended: Ended::Budget, start: None, best: None };
    // Whether the best is within the limits, its loss, and its choice.
    let mut best: Option<(bool, f64, Choice)> = None;
    let mut stale = 0;
    loop {
        if interrupt.load(Ordering::Relaxed) {
            state.ended = Ended::Interrupted;
            break;
        }
        let asked = search.ask();
        if asked.is_empty() || stale == STALE {
            state.ended = Ended::NothingNew;
            break;
        }
        // What is asked for the first time, within the budget.
        let mut fresh: Vec<&Choice> = Vec::new();
        let mut listed = HashSet::new();
        for choice in &asked {
            if !known.contains_key(choice) && listed.insert(choice) {
                fresh.push(choice);
            }
        }
        let left = usize::try_from(study.budget - state.evaluations).unwrap_or(usize::MAX);
        let cut = fresh.len() > left;
        fresh.truncate(left);
        stale = if fresh.is_empty() { stale + 1 } else { 0 };

        let unknown: Vec<&Choice> = fresh.iter().copied().filter(|choice| !cache.contains_key(*choice)).collect();
        let layouts: Vec<Vec<u8>> = unknown.iter().map(|choice| study.layout(choice).materials).collect();
        let marks = evaluator.marks(&layouts, interrupt)?;
        // Only what comes before the first interrupted one is kept, so that the journal's order is that of the search.
        let whole = marks.iter().position(|m| matches!(m.stop, Some(Stop::Interrupted { .. }))).unwrap_or(marks.len());
        let new: Vec<Entry> = marks[..whole]
            .iter()
            .zip(&layouts)
            .zip(&unknown)
            .map(|((marks, layout), choice)| Entry::new(key.of(layout), pack(choice, space.letters), marks))
            .collect();
        journal.append(&new)?;
        let simulated = new.len();
        let mut new = new.into_iter();
        for choice in &fresh {
            let entry = match cache.get(*choice) {
                Some(&entry) => entry.clone(),
                None => match new.next() {
                    Some(entry) => entry,
                    None => break,
                },
            };
            state.evaluations += 1;
            state.stopped += u64::from(entry.stop.is_some());
            if **choice == first {
                state.start = Some(entry.clone());
            }
            let (within_limits, loss) = (study.objective.is_met(&entry), study.objective.loss(&entry));
            let better = loss.is_finite()
                && best.as_ref().is_none_or(|(within, least, _)| (!within_limits, loss) < (!within, *least));
            if better {
                best = Some((within_limits, loss, (*choice).clone()));
                let entry = entry.clone();
                state.best = Some(Best { entry, evaluation: state.evaluations, within_limits, one_opt: false });
            }
            known.insert((*choice).clone(), entry);
        }
        let losses: Option<Vec<f64>> =
            asked.iter().map(|choice| known.get(choice).map(|entry| study.objective.loss(entry))).collect();
        if let Some(losses) = &losses {
            search.tell(losses);
        }
        if let (Some(state), Some((_, _, choice))) = (&mut state.best, &best) {
            state.one_opt = search.one_opt() && search.best().is_some_and(|(best, _)| best == choice);
        }
        state.rounds = search.ended();
        watch.batch(&state, simulated);
        if whole < marks.len() {
            state.ended = Ended::Interrupted;
            break;
        }
        if cut || state.evaluations == study.budget {
            break;
        }
    }
    Ok(state)
}
