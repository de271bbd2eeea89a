//! Why an evaluation of the journal counts or does not: under which settings it was made, and which of them differ from the present ones.
//!
//! An evaluation's key is a hash, which says that something differs and not what. So whoever evaluates notes beside the journal what the
//! hash was made of, once for all evaluations under the same settings.

use std::collections::{BTreeMap, BTreeSet, HashSet};
use std::path::{Path, PathBuf};

use serde::{Deserialize, Serialize};

use super::entry::unpack;
use super::journal::{Journal, Ledger, Line};
use super::key::Key;
use super::{Study, StudyError};
use crate::evaluate::Plan;
use crate::units::Dimension::{Angle, Length, Time};

/// What the evaluations of one key depend on, each setting by its name.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Circumstances {
    /// The key without a layout.
    pub key: String,
    /// Settings by name, as text.
    pub settings: BTreeMap<String, String>,
    /// Sites that may change: a digit for each site, 1 where it may.
    free: String,
    /// Place in the palette of every other site's material: a digit for each site.
    base: String,
    /// Places in the palette of the materials that may be chosen.
    letters: Vec<u8>,
    /// For each site that may change which letter of a layout is its own; empty where each has one.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    tied: Vec<usize>,
}

impl Line for Circumstances {
    const NAME: &'static str = "granulens-study-settings";
    const WORDS: &'static str = "list of a study's settings";
    const BEGUN_BY: &'static str = "granulens study run";
}

/// Where the list stands, beside the journal.
fn list_of(journal: &Path) -> PathBuf {
    journal.with_file_name("settings-history.jsonl")
}

fn digits(numbers: impl Iterator<Item = u8>) -> String {
    numbers.map(|number| char::from_digit(number.into(), 10).unwrap_or('?')).collect()
}

fn numbers(digits: &str) -> Vec<u8> {
    digits.chars().map(|digit| digit.to_digit(10).unwrap_or(0) as u8).collect()
}

impl Circumstances {
    /// A study's present settings at one of its steps.
    pub(super) fn now(study: &Study, plan: &Plan, key: Key) -> Self {
        let mut settings = BTreeMap::new();
        let mut set = |name: &str, value: String| settings.insert(name.to_owned(), value);
        match study.design().text().parse::<toml::Table>() {
            Ok(table) => flatten("design", &toml::Value::Table(table), &mut set),
            Err(_) => drop(set("design", study.design().text().to_owned())),
        }
        set("design.crystal.law", format!("\"{}\"", study.design().law()));
        set("materials", study.palette.iter().map(|material| material.name.as_str()).collect::<Vec<_>>().join(", "));
        for material in &study.palette {
            set(&format!("constants of {}", material.name), format!("{material:?}"));
        }
        set("integrator", plan.integrator.to_string());
        set("step", Time.show(plan.step));
        for (law, step) in &plan.own_steps {
            set(&format!("step under {law}"), Time.show(*step));
        }
        set("window", Time.show(plan.window));
        for (k, impact) in study.impacts.iter().enumerate() {
            let mut words = impact.strike.to_string();
            if impact.angle != 0.0 {
                words.push_str(&format!(" at {}", Angle.show(impact.angle)));
            }
            if let Some([from, to]) = impact.place {
                words.push_str(&format!(" on {} to {}", Length.show(from), Length.show(to)));
            }
            if let Some(law) = impact.law {
                words.push_str(&format!(", law {law}"));
            }
            set(&format!("impact {}", k + 1), words);
        }
        set("forces", format!("{} within {}", study.forces.count(), study.forces.band()));
        let crystals = study.tolerance.filter(|tolerance| tolerance.members > 0);
        let crystals = crystals
            .map(|t| format!("{} crystals, wrong {:?}, radii {:?}, seed {}", t.members, t.wrong, t.radii, t.seed));
        set("tolerance", crystals.unwrap_or_else(|| "as drawn".to_owned()));
        set("recorded", format!("{:?}", study.detail()));
        set("compared with baselines", study.has_rivals().to_string());
        let mut free = vec![0; study.bases[0].len()];
        study.free.iter().for_each(|&site| free[site] = 1);
        let (free, base) = (digits(free.into_iter()), digits(study.bases[0].iter().copied()));
        let group = |site: &usize| study.groups.iter().position(|group| group.contains(site)).unwrap_or(0);
        let tied = if study.is_tied() { study.free.iter().map(group).collect() } else { Vec::new() };
        Self { key: key.text(), settings, free, base, letters: study.alphabet.clone(), tied }
    }

    /// Notes a study's settings beside its journal, if they are new there; gives what was not as it should be.
    pub(super) fn note(study: &Study, plan: &Plan, key: Key, journal: &Path) -> Result<Vec<String>, StudyError> {
        let now = Self::now(study, plan, key);
        let (mut list, loaded) = Ledger::<Self>::open(&list_of(journal))?;
        if !loaded.entries.contains(&now) {
            list.append(&[now])?;
        }
        Ok(loaded.warnings)
    }

    /// Whether an evaluation was made under these.
    fn made(&self, layout: &str, key: &str) -> Option<()> {
        let free = numbers(&self.free);
        let count = match self.tied.iter().max() {
            Some(last) => last + 1,
            None => free.iter().filter(|&&free| free == 1).count(),
        };
        let letters = unpack(layout, count, self.letters.len() as u8)?;
        let tied: Vec<u8> = self.tied.iter().map(|&group| letters[group]).collect();
        let mut letters = if tied.is_empty() { letters } else { tied }.into_iter();
        let site = |(free, base): (u8, u8)| match free {
            1 => self.letters.get(usize::from(letters.next()?)).copied(),
            _ => Some(base),
        };
        let materials: Vec<u8> = free.into_iter().zip(numbers(&self.base)).map(site).collect::<Option<_>>()?;
        (Key::from_text(&self.key)?.of(&materials) == key).then_some(())
    }

    /// What differs from others: settings, and which spheres may change or what the others are.
    fn differences(&self, now: &Self) -> Vec<Difference> {
        let names: BTreeSet<&String> = self.settings.keys().chain(now.settings.keys()).collect();
        let mut differences: Vec<Difference> = names
            .into_iter()
            .filter(|name| self.settings.get(*name) != now.settings.get(*name))
            .map(|name| Difference {
                setting: name.clone(),
                now: now.settings.get(name).cloned(),
                then: self.settings.get(name).cloned(),
            })
            .collect();
        let mut sites = |name: &str, here: &str, there: &str| {
            let count = here.chars().zip(there.chars()).filter(|(a, b)| a != b).count();
            if here != there {
                let (now, then) = (None, Some(format!("{count} sites differ")));
                differences.push(Difference { setting: name.to_owned(), now, then });
            }
        };
        sites("which sites may change (rows, x)", &now.free, &self.free);
        sites("sites that do not change, and the start", &now.base, &self.base);
        differences
    }
}

/// Every value of a table by its path.
fn flatten(path: &str, value: &toml::Value, set: &mut impl FnMut(&str, String) -> Option<String>) {
    match value {
        toml::Value::Table(table) => {
            table.iter().for_each(|(key, value)| flatten(&format!("{path}.{key}"), value, set));
        }
        value => drop(set(path, value.to_string())),
    }
}

/// A setting that differs.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Difference {
    /// Its name.
    pub setting: String,
    /// Its present value; none where it is not set.
    pub now: Option<String>,
    /// Its value then; none where it was not set.
    pub then: Option<String>,
}

/// Evaluations of a journal that were made under the same settings, and why they count or not.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Why {
    /// How many.
    pub evaluations: usize,
    /// Whether they are used: the study has these settings at one of its steps.
    pub used: bool,
    /// Step at which they were made, as text; none where it is not known.
    pub step: Option<String>,
    /// Which settings differ from those of the study's step that is most alike; none where they are not known, as of evaluations of 0.1.
    pub differences: Option<Vec<Difference>>,
    /// How many of these layouts were evaluated anew under present settings.
    pub anew: usize,
}

/// Explains a study's journal: every evaluation of it is in one of these.
///
/// # Errors
/// A journal, or a list of settings, that cannot be read.
pub fn why(study: &Study, journal: &Path) -> Result<Vec<Why>, StudyError> {
    let entries = Journal::read(journal)?.entries;
    let list = Ledger::<Circumstances>::read_if_there(&list_of(journal))?.entries;
    let now = (0..study.rungs.len())
        .map(|rung| {
            let plan = study.plan(rung)?;
            let study = &study.at(rung);
            Ok(Circumstances::now(study, &plan, Key::new(study, &plan)))
        })
        .collect::<Result<Vec<_>, StudyError>>()?;
    let known: Vec<&Circumstances> = now.iter().chain(list.iter().filter(|known| !now.contains(known))).collect();
    // Entries by the settings that they were made under; the last stand for none that is known.
    let mut made: Vec<Vec<&super::Entry>> = vec![Vec::new(); known.len() + 1];
    for entry in &entries {
        let place = known.iter().position(|known| known.made(&entry.layout, &entry.key).is_some());
        made[place.unwrap_or(known.len())].push(entry);
    }
    let present: HashSet<&str> = made[..now.len()].iter().flatten().map(|entry| entry.layout.as_str()).collect();
    let mut counted: HashSet<&str> = HashSet::new();
    let mut reasons = Vec::new();
    for (place, entries) in made.iter().enumerate() {
        if entries.is_empty() {
            continue;
        }
        let known = known.get(place).copied();
        let used = place < now.len();
        let differences = known.map(|known| {
            now.iter().map(|now| known.differences(now)).min_by_key(Vec::len).filter(|_| !used).unwrap_or_default()
        });
        let anew = entries
            .iter()
            .filter(|entry| !used && present.contains(entry.layout.as_str()))
            .filter(|entry| counted.insert(&entry.layout))
            .count();
        let step = known.and_then(|known| known.settings.get("step").cloned());
        reasons.push(Why { evaluations: entries.len(), used, step, differences, anew });
    }
    Ok(reasons)
}
