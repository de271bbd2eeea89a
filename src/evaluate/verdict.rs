//! Whether a layout is better than what a lens has to beat, or only looks so.

use crate::outcome::{Verdict, Word};
use crate::score::{Measure, Scores, geometric};
use crate::stats::Mean;

/// The measures that a verdict is given on.
const JUDGED: [Measure; 3] = [Measure::Contrast, Measure::FocalGain, Measure::Protection];

/// What a lens has to beat, and how the kinds of arrangements begin that are it: in space strips of 1, 2, ... layers are flat too, each a kind.
const RIVALS: [(&str, &[&str]); 3] =
    [("flat", &["flat-", "strip-"]), ("uniform", &["all-host", "all-lens"]), ("random", &["random-"])];

/// One arrangement: its kind, and its scores under each force.
pub(super) struct Judged<'a> {
    pub kind: &'a str,
    pub runs: &'a [Scores],
}

/// The first of some arrangements against the others. All have scores under the same forces; those that a guard stopped are left out
/// by the caller.
pub(super) fn verdict(subject: &[Scores], others: &[Judged]) -> Vec<Verdict> {
    let of = |measure: Measure, (against, kinds): &(&'static str, &[&str])| {
        let values = |runs: &[Scores]| runs.iter().map(|run| run.get(measure)).collect::<Option<Vec<f64>>>();
        let own = values(subject).filter(|own| !own.is_empty())?;
        let value = geometric(&own);
        let mut found: Vec<&str> = Vec::new();
        for other in others.iter().filter(|other| kinds.iter().any(|kind| other.kind.starts_with(kind))) {
            if !found.contains(&other.kind) {
                found.push(other.kind);
            }
        }
        let of_kind = |kind: &&str| {
            let members: Vec<Vec<f64>> =
                others.iter().filter(|other| other.kind == *kind).filter_map(|other| values(other.runs)).collect();
            let all: Vec<f64> = members.iter().flatten().copied().collect();
            let differences: Vec<f64> =
                members.iter().flat_map(|each| own.iter().zip(each).map(|(a, b)| a - b)).collect();
            (!all.is_empty()).then(|| ((*kind).to_owned(), geometric(&all), differences))
        };
        let better = |a: f64, b: f64| measure.best(b, a) == a && a != b;
        let (kind, best, differences) =
            found.iter().filter_map(of_kind).reduce(|a, b| if better(b.1, a.1) { b } else { a })?;
        let spread = if own.len() > 1 { Mean::of(&differences).deviation } else { None };
        let word = Word::of(measure, value, best, spread);
        let [measure, against] = [measure.name(), *against].map(str::to_owned);
        let arrangement = kind;
        Some(Verdict { measure, against, arrangement, value, best, spread, word })
    };
    JUDGED.iter().flat_map(|&measure| RIVALS.iter().filter_map(move |rivals| of(measure, rivals))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn runs(contrasts: &[f64]) -> Vec<Scores> {
        contrasts.iter().map(|&c| Scores { contrast: Some(c), protection: Some(c), ..Scores::default() }).collect()
    }

    /// By hand: 2.0 and 2.2 against 1.0 and 1.0 differ by 1.0 and 1.2, whose deviation is 0.1414; against 1.9 and 2.3, by 0.1 and -0.1.
    #[test]
    fn a_verdict_counts_in_deviations_of_the_difference() {
        let (subject, strip, host) = (runs(&[2.0, 2.2]), runs(&[1.0, 1.0]), runs(&[1.9, 2.3]));
        let others = [Judged { kind: "flat-height", runs: &strip }, Judged { kind: "all-host", runs: &host }];
        let found = verdict(&subject, &others);
        let of =
            |measure: &str, against: &str| found.iter().find(|v| v.measure == measure && v.against == against).unwrap();
        assert_eq!((of("contrast", "flat").word, of("contrast", "uniform").word), (Word::Better, Word::Equal));
        // Q is the smaller the better.
        assert_eq!(of("protection", "flat").word, Word::Worse);
        assert!((of("contrast", "flat").spread.unwrap() - 0.02_f64.sqrt()).abs() < 1e-12);
        assert!((of("contrast", "flat").value - 4.4_f64.sqrt()).abs() < 1e-12);
        assert!(
            found.iter().all(|v| v.against != "random" && v.measure != "focal_gain"),
            "what is not there is not judged"
        );
    }

    /// Of random mixtures the kind with the best mean counts, and its seeds scatter too.
    #[test]
    fn random_mixtures_are_judged_over_their_seeds() {
        let subject = runs(&[1.08, 1.08]);
        let seeds = [runs(&[0.94, 0.94]), runs(&[1.18, 1.18])];
        let low = runs(&[0.5, 0.5]);
        let others = [
            Judged { kind: "random-lens-rows", runs: &low },
            Judged { kind: "random-behind", runs: &seeds[0] },
            Judged { kind: "random-behind", runs: &seeds[1] },
        ];
        let found = verdict(&subject, &others);
        assert_eq!((found[0].arrangement.as_str(), found[0].word), ("random-behind", Word::Equal));
        assert!((found[0].spread.unwrap() - (4.0 / 3.0 * 0.12_f64.powi(2)).sqrt()).abs() < 1e-12);
    }

    #[test]
    fn one_force_decides_from_four_percent_on() {
        let strip = runs(&[1.0]);
        let others = [Judged { kind: "flat-count", runs: &strip }];
        for (value, word) in
            [(1.03, Word::Undecided), (0.97, Word::Undecided), (1.05, Word::Better), (0.9, Word::Worse)]
        {
            let found = verdict(&runs(&[value]), &others);
            assert_eq!((found[0].word, found[0].spread), (word, None), "{value}");
        }
    }
}
