//! Layouts that a study asks for, written down for others to evaluate, and how shards share them.

use std::collections::{BTreeMap, HashSet};
use std::fmt;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use serde::{Deserialize, Serialize};

use super::entry::{pack, unpack};
use super::journal::{Ledger, Line};
use super::{Engine, Entry, Key, Study, StudyError};
use crate::search::Assignment;

/// One layout that is asked for.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Question {
    /// Questions of one round do not depend on each other; those of the next may depend on the answers to it.
    pub round: u64,
    /// Place of the step among the study's different ones.
    pub rung: usize,
    /// The letters of the free sites, as in an [`Entry`].
    pub layout: String,
    /// The key that its evaluation will have.
    pub key: String,
}

impl Line for Question {
    const NAME: &'static str = "granulens-study-asked";
    const WORDS: &'static str = "list of what a study asks for";
    const BEGUN_BY: &'static str = "granulens study ask";
}

impl Question {
    /// The layout's letters; none if the question belongs to something else.
    pub fn assignment(&self, study: &Study) -> Option<Assignment> {
        unpack(&self.layout, study.variables(), study.alphabet.len() as u8)
    }
}

/// Where the questions of a study stand, in its folder.
pub fn asked_in(folder: &Path) -> PathBuf {
    folder.join("asked.jsonl")
}

/// One of several equal parts of the work: `3/8` is the third of eight.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Shard {
    number: u32,
    count: u32,
}

/// A shard that cannot be.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("shard {0} must be k/n with k from 1 to n and n at most {MOST_SHARDS}, such as 3/8")]
pub struct ShardError(String);

const MOST_SHARDS: u32 = 1_000_000;

impl FromStr for Shard {
    type Err = ShardError;

    fn from_str(text: &str) -> Result<Self, ShardError> {
        let parts = text.split_once('/').and_then(|(number, count)| Some((number.parse().ok()?, count.parse().ok()?)));
        match parts {
            Some((number, count)) if 1 <= number && number <= count && count <= MOST_SHARDS => {
                Ok(Self { number, count })
            }
            _ => Err(ShardError(text.to_owned())),
        }
    }
}

impl fmt::Display for Shard {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}/{}", self.number, self.count)
    }
}

/// Layouts that stand side by side in the registers of a core, on the widest machine there is: a shard that had fewer would take as long.
const BLOCK: usize = 8;

impl Shard {
    /// All shards of so many.
    pub fn all(count: u32) -> impl Iterator<Item = Self> {
        (1..=count).map(move |number| Self { number, count })
    }

    /// How many there are.
    pub fn count(self) -> u32 {
        self.count
    }

    /// The shard whose journal has this name.
    pub fn of_file(path: &Path) -> Option<Self> {
        path.file_name()?.to_str()?.strip_suffix(".jsonl")?.replacen("-of-", "/", 1).parse().ok()
    }

    /// The shard's own journal, in the study's folder.
    pub fn journal(self, folder: &Path) -> PathBuf {
        folder.join("shards").join(format!("{}-of-{}.jsonl", self.number, self.count))
    }

    /// Its part of some questions.
    pub fn part(self, questions: &[Question]) -> Vec<&Question> {
        turns(questions, self.count)
            .filter(|(number, _)| *number == self.number)
            .map(|(_, question)| question)
            .collect()
    }
}

/// For each of some questions which of `count` shards it belongs to: of each round every `count`th block of eight, so that registers
/// are full. The first block of a round goes to another shard each time.
fn turns(questions: &[Question], count: u32) -> impl Iterator<Item = (u32, &Question)> {
    questions.chunk_by(|a, b| a.round == b.round).flat_map(move |round| {
        round.chunks(BLOCK).zip(round[0].round..).flat_map(move |(block, turn)| {
            let number = (turn % u64::from(count)) as u32 + 1;
            block.iter().map(move |question| (number, question))
        })
    })
}

/// How many of the questions that are looked for each of `count` shards has, where it has any.
pub(super) fn shares(
    questions: &[Question],
    count: u32,
    looked_for: impl Fn(&Question) -> bool,
) -> Vec<(Shard, usize)> {
    let mut shares = BTreeMap::new();
    for (number, _) in turns(questions, count).filter(|(_, question)| looked_for(question)) {
        *shares.entry(number).or_insert(0) += 1;
    }
    shares.into_iter().map(|(number, some)| (Shard { number, count }, some)).collect()
}

/// Writes down what a search asks for, and lets others answer.
pub struct Asking<'a> {
    study: &'a Study,
    keys: Vec<Key>,
    ledger: Ledger<Question>,
    known: HashSet<String>,
    round: u64,
    /// Questions that were written down.
    pub asked: usize,
    /// Questions of the search that had been written down before, and are not answered yet.
    pub waiting: usize,
}

impl<'a> Asking<'a> {
    /// Opens or begins the list in a study's folder, and gives what was not as it should be.
    ///
    /// # Errors
    /// A list that cannot be read or written; a step or window with which nothing can be simulated.
    pub fn open(study: &'a Study, folder: &Path) -> Result<(Self, Vec<String>), StudyError> {
        let (ledger, loaded) = Ledger::<Question>::open(&asked_in(folder))?;
        let keys = (0..study.rungs.len())
            .map(|rung| Ok(Key::new(&study.at(rung), &study.plan(rung)?)))
            .collect::<Result<_, StudyError>>()?;
        let round = loaded.entries.last().map_or(0, |question| question.round + 1);
        let known = loaded.entries.into_iter().map(|question| question.key).collect();
        Ok((Self { study, keys, ledger, known, round, asked: 0, waiting: 0 }, loaded.warnings))
    }

    /// Writes down those that are new as one round.
    ///
    /// # Errors
    /// What the file system refuses.
    pub fn ask(&mut self, rung: usize, assignments: &[&Assignment]) -> Result<(), StudyError> {
        let letters = self.study.alphabet.len() as u8;
        let mut new = Vec::new();
        for assignment in assignments {
            let key = self.keys[rung].of(&self.study.materials(assignment));
            if self.known.insert(key.clone()) {
                new.push(Question { round: self.round, rung, layout: pack(assignment, letters), key });
            }
        }
        self.ledger.append(&new)?;
        self.round += u64::from(!new.is_empty());
        self.asked += new.len();
        self.waiting += assignments.len() - new.len();
        Ok(())
    }
}

impl Study {
    /// The letters of a layout's free sites, where it is the study's own everywhere else; the other way round of [`layout`](Self::layout).
    pub fn assignment(&self, materials: &[u8]) -> Option<Assignment> {
        let letter = |site: usize| self.alphabet.iter().position(|of| *of == materials[site]).map(|k| k as u8);
        let assignment: Assignment = self.groups.iter().map(|group| letter(group[0])).collect::<Option<_>>()?;
        (self.materials(&assignment) == materials).then_some(assignment)
    }
}

impl Engine for Asking<'_> {
    fn entries(&mut self, rung: usize, assignments: &[&Assignment]) -> Result<Vec<Entry>, StudyError> {
        self.ask(rung, assignments)?;
        Ok(Vec::new())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_are_read_as_they_are_written() {
        let shard: Shard = "3/8".parse().unwrap();
        assert_eq!(shard.to_string(), "3/8");
        assert_eq!(Shard::of_file(&shard.journal(Path::new("x"))), Some(shard));
        for wrong in ["0/8", "9/8", "3", "3/", "a/b", "1/1000001", "-1/2"] {
            assert!(wrong.parse::<Shard>().unwrap_err().to_string().contains(wrong));
        }
    }

    /// Every question is in one shard and no more, in blocks that fill registers, whatever came before and after.
    #[test]
    fn shards_share_out_everything_once() {
        let question = |round, k| Question { round, rung: 0, layout: String::new(), key: format!("{round} {k}") };
        let questions: Vec<Question> = [20, 3, 64, 7]
            .iter()
            .enumerate()
            .flat_map(|(round, &n)| (0..n).map(move |k| question(round as u64, k)))
            .collect();
        for count in [1, 2, 5, 40] {
            let mut all: Vec<&Question> = Shard::all(count).flat_map(|shard| shard.part(&questions)).collect();
            assert_eq!(all.len(), questions.len());
            all.sort_by_key(|q| questions.iter().position(|of| of == *q));
            assert!(all.into_iter().eq(&questions));
        }
        let sizes: Vec<usize> = Shard::all(4).map(|shard| shard.part(&questions[23..87]).len()).collect();
        assert_eq!(sizes, [16; 4]);
    }
}
