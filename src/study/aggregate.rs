//! How the scores of a layout under several impacts become one.

use serde::{Deserialize, Serialize};

use super::{Entry, Study};
use crate::evaluate::Evaluated;
use crate::layout::LayoutStats;
use crate::score::{Better, Measure, Needs, Scores};

/// How the scores under several impacts become one.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Aggregate {
    /// The impact under which a score is worst for what is asked of it, for each score by itself.
    #[default]
    Worst,
    /// The mean of all impacts.
    Mean,
}

/// Which of several values counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extreme {
    /// The least.
    Least,
    /// The greatest.
    Most,
}

/// A measure of one layout over all impacts: the value that counts, where every impact gives one.
pub fn value(
    measure: Measure,
    entry: &Entry,
    stats: &LayoutStats,
    aggregate: Aggregate,
    extreme: Extreme,
) -> Option<f64> {
    if measure.needs() == Needs::Layout {
        let mut scores = Scores::default();
        scores.add_layout(stats);
        return scores.get(measure);
    }
    let values: Vec<f64> = entry.impacts.iter().map(|scores| scores.get(measure)).collect::<Option<_>>()?;
    match (aggregate, extreme) {
        (Aggregate::Mean, _) => (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64),
        (Aggregate::Worst, Extreme::Least) => values.into_iter().reduce(f64::min),
        (Aggregate::Worst, Extreme::Most) => values.into_iter().reduce(f64::max),
    }
}

/// All measures of one layout over all impacts: of each the value under the impact where it is worst, or the mean.
pub fn summary(entry: &Entry, stats: &LayoutStats, aggregate: Aggregate) -> Scores {
    let mut scores = Scores::default();
    for &measure in Measure::ALL {
        let extreme = if measure.better() == Better::Greater { Extreme::Least } else { Extreme::Most };
        scores.set(measure, value(measure, entry, stats, aggregate, extreme));
    }
    scores
}

/// The same of a layout's runs under all impacts and forces; none where a guard stopped one of them.
pub(super) fn of_runs(study: &Study, runs: &[Evaluated], stats: &LayoutStats) -> Option<Scores> {
    let entry = Entry::new(String::new(), String::new(), &study.by_impact(runs));
    entry.stop.is_none().then(|| summary(&entry, stats, study.objective.aggregate))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Under the worst impact every measure is what is worst for what is asked of it: the least of what is to be great, the greatest of what is to be
    /// small. In the mean it is neither.
    #[test]
    fn the_worst_impact_counts_for_every_measure() {
        let scores = |number: f64| {
            let mut scores = Scores::default();
            Measure::ALL.iter().for_each(|&measure| scores.set(measure, Some(number)));
            scores
        };
        let entry = Entry::new(String::new(), String::new(), &[]);
        let entry = Entry { impacts: vec![scores(2.0), scores(5.0), scores(3.0)], ..entry };
        let all = |aggregate| summary(&entry, &LayoutStats::default(), aggregate);
        for &measure in Measure::ALL.iter().filter(|measure| measure.needs() != Needs::Layout) {
            let worst = if measure.better() == Better::Greater { 2.0 } else { 5.0 };
            assert_eq!(all(Aggregate::Worst).get(measure), Some(worst), "{}", measure.name());
            assert_eq!(all(Aggregate::Mean).get(measure), Some(10.0 / 3.0), "{}", measure.name());
        }
    }
}
