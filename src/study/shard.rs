//! Shards: parts of what a study asks for, each evaluated by a process of its own into a journal of its own, and folded together.
//!
//! Whatever happens to a shard, what is whole of its journal counts: a process that was killed, a machine that was lost, a line that was
//! damaged leave questions without an answer, and no layout that failed. A layout that a guard stops is an answer.

use std::collections::{HashMap, HashSet};
use std::path::{Path, PathBuf};

use super::asked::{Question, Shard, asked_in, shares};
use super::journal::Ledger;
use super::{Entry, Journal, Key, Local, Study, StudyError};
use crate::Context;
use crate::search::Assignment;

/// What a shard has come to.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct ShardDone {
    /// How much of what is asked for is its part.
    pub part: usize,
    /// Of these were known: from the study's journal, or from a shard.
    pub known: usize,
    /// Evaluated now.
    pub evaluated: usize,
    /// Of these a guard stopped.
    pub stopped: usize,
    /// Asked for under other settings than the study's present ones; left alone.
    pub others: usize,
    /// What was not as it should be.
    pub warnings: Vec<String>,
}

impl ShardDone {
    /// Whether nothing of its part is left.
    pub fn is_whole(&self) -> bool {
        self.known + self.evaluated == self.part
    }
}

/// The journals of shards in a study's folder, in the order of their names.
fn shard_journals(folder: &Path) -> Result<Vec<PathBuf>, StudyError> {
    let shards = folder.join("shards");
    let fail = |error: std::io::Error| StudyError::Journal { path: shards.clone(), message: error.to_string() };
    if !shards.exists() {
        return Ok(Vec::new());
    }
    let mut paths = Vec::new();
    for entry in std::fs::read_dir(&shards).map_err(fail)? {
        let path = entry.map_err(fail)?.path();
        if path.extension().is_some_and(|extension| extension == "jsonl") {
            paths.push(path);
        }
    }
    paths.sort();
    Ok(paths)
}

/// Evaluates one shard of what a study asks for into the shard's own journal, on the threads of the current pool. `told` hears after every
/// batch how much of its part is done. Ends early when it is stopped; to begin again is to go on.
///
/// # Errors
/// See [`StudyError`]; nothing asked for yet.
pub fn evaluate_shard(
    study: &Study,
    folder: &Path,
    shard: Shard,
    context: &Context,
    mut told: impl FnMut(&ShardDone),
) -> Result<ShardDone, StudyError> {
    let asked = Ledger::<Question>::read(&asked_in(folder))?;
    let mut done = ShardDone { warnings: asked.warnings, ..ShardDone::default() };
    let keys: Vec<Key> = (0..study.rungs.len())
        .map(|rung| Ok(Key::new(&study.at(rung), &study.plan(rung)?)))
        .collect::<Result<_, StudyError>>()?;
    let ours = |question: &Question| {
        let assignment = question.assignment(study)?;
        let key = keys.get(question.rung)?.of(&study.materials(&assignment));
        (key == question.key).then_some(assignment)
    };
    let mut known: HashSet<String> =
        Journal::read_if_there(&folder.join("journal.jsonl"))?.entries.into_iter().map(|entry| entry.key).collect();
    for path in shard_journals(folder)? {
        // Whether one is damaged is told where they are folded.
        if let Ok(loaded) = Journal::read(&path) {
            known.extend(loaded.entries.into_iter().map(|entry| entry.key));
        }
    }
    // All that is not known, in order, by steps.
    let mut open: Vec<Vec<Assignment>> = vec![Vec::new(); study.rungs.len()];
    for question in shard.part(&asked.entries) {
        match ours(question) {
            None => done.others += 1,
            Some(assignment) => {
                done.part += 1;
                if known.insert(question.key.clone()) { open[question.rung].push(assignment) } else { done.known += 1 }
            }
        }
    }
    if done.is_whole() {
        return Ok(done);
    }
    let local = Local::new(study, context)?;
    let (mut journal, loaded) = Journal::open(&shard.journal(folder))?;
    done.warnings.extend(loaded.warnings);
    // What is lost to a kill is one batch: registers of all threads.
    let batch = 8 * rayon::current_num_threads();
    for (rung, assignments) in open.iter().enumerate() {
        for some in assignments.chunks(batch) {
            let some: Vec<&Assignment> = some.iter().collect();
            let entries = local.entries(study, rung, &some, context)?;
            journal.append(&entries)?;
            done.evaluated += entries.len();
            done.stopped += entries.iter().filter(|entry| entry.stop.is_some()).count();
            told(&done);
            if context.stopped() {
                return Ok(done);
            }
        }
    }
    Ok(done)
}

/// A shard's journal, as it was found where shards are folded.
#[derive(Clone, Debug, PartialEq)]
pub struct FoundShard {
    /// Its journal.
    pub path: PathBuf,
    /// Evaluations that are whole.
    pub entries: usize,
    /// Of these a guard stopped the layout: answers like others.
    pub stopped: usize,
    /// Of its part of what is asked for nobody has answered: it is under way, was killed, or lost its machine.
    pub missing: usize,
    /// What is damaged of it; the rest counts.
    pub damage: Vec<String>,
}

/// What folding came to.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Merged {
    /// Layouts asked for.
    pub asked: usize,
    /// Of these the journal knows.
    pub answered: usize,
    /// Evaluations that were new to the journal.
    pub folded: usize,
    /// Evaluations that the journal or another shard holds too, with the same bits.
    pub repeated: usize,
    /// Evaluations that nobody asked for; left where they are.
    pub unasked: usize,
    /// The same layout with other bits than in the journal, or than in another shard; those first found count. Machines or builds differ.
    pub conflicts: Vec<String>,
    /// The shards that there are.
    pub shards: Vec<FoundShard>,
    /// Shards that have a part of what is not answered, and no journal: they have not begun.
    pub absent: Vec<String>,
    /// What was not as it should be of the journal and of the list of what is asked for.
    pub warnings: Vec<String>,
}

impl Merged {
    /// Whether everything that is asked for is answered.
    pub fn is_whole(&self) -> bool {
        self.answered == self.asked
    }
}

/// Folds the journals of all shards in a study's folder into its journal: in the order in which they were asked for, each once. In
/// whatever order shards come, and however often they are folded, the journal knows the same.
///
/// # Errors
/// A journal, or a list of what is asked for, that cannot be read or written. Shards that cannot be read are named and left out.
pub fn merge(folder: &Path) -> Result<Merged, StudyError> {
    let asked = Ledger::<Question>::read(&asked_in(folder))?;
    let (mut journal, loaded) = Journal::open(&folder.join("journal.jsonl"))?;
    let mut merged = Merged { warnings: [asked.warnings, loaded.warnings].concat(), ..Merged::default() };
    let place: HashMap<&str, usize> =
        asked.entries.iter().enumerate().map(|(place, question)| (question.key.as_str(), place)).collect();
    merged.asked = place.len();
    let mut known: HashMap<String, Entry> =
        loaded.entries.into_iter().map(|entry| (entry.key.clone(), entry)).collect();
    let mut new: Vec<(usize, Entry)> = Vec::new();
    let mut counts: Vec<u32> = Vec::new();
    for path in shard_journals(folder)? {
        let mut found = FoundShard { path: path.clone(), entries: 0, stopped: 0, missing: 0, damage: Vec::new() };
        match Journal::read(&path) {
            Err(error) => found.damage.push(error.to_string()),
            Ok(shard) => {
                found.damage = shard.warnings;
                for entry in shard.entries {
                    found.entries += 1;
                    found.stopped += usize::from(entry.stop.is_some());
                    let Some(&place) = place.get(entry.key.as_str()) else {
                        merged.unasked += 1;
                        continue;
                    };
                    match known.get(&entry.key) {
                        Some(same) if *same == entry => merged.repeated += 1,
                        Some(_) => merged.conflicts.push(format!(
                            "{}: layout {} has other scores than were known; those count",
                            path.display(),
                            place + 1
                        )),
                        None => {
                            known.insert(entry.key.clone(), entry.clone());
                            new.push((place, entry));
                        }
                    }
                }
            }
        }
        counts.extend(Shard::of_file(&path).map(Shard::count));
        merged.shards.push(found);
    }
    new.sort_by_key(|(place, _)| *place);
    let new: Vec<Entry> = new.into_iter().map(|(_, entry)| entry).collect();
    journal.append(&new)?;
    merged.folded = new.len();
    merged.answered = place.keys().filter(|key| known.contains_key(**key)).count();
    counts.sort_unstable();
    counts.dedup();
    for count in counts {
        for (shard, missing) in shares(&asked.entries, count, |question| !known.contains_key(&question.key)) {
            let path = shard.journal(folder);
            match merged.shards.iter_mut().find(|found| found.path == path) {
                Some(found) => found.missing = missing,
                None => merged.absent.push(shard.to_string()),
            }
        }
    }
    Ok(merged)
}
