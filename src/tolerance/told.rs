//! All that is told of a layout before it is built, as JSON has it and in words.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use serde::Serialize;

use super::criterion::{Beaten, Criterion};
use super::quantity::Quantity;
use super::samples::Samples;
use super::sensitivity::{AsBuilt, Change};
use super::yields::{INTERVAL, Share, quantile};
use super::{State, Tolerances};
use crate::outcome::Method;
use crate::score::{Measure, Scores};
use crate::stats::Mean;

/// How a score is distributed over pieces that ran to their end.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Distribution {
    /// Mean and standard deviation.
    pub mean: f64,
    /// Of single pieces.
    pub deviation: Option<f64>,
    /// 5, 25, 50, 75 and 95 % of the pieces have at most this.
    pub quantiles: [f64; 5],
}

/// The parts of the distribution that are told.
const PARTS: [f64; 5] = [0.05, 0.25, 0.5, 0.75, 0.95];

/// What the yield is, and of what.
#[derive(Clone, Debug, Serialize)]
pub struct Told {
    /// Format of the file.
    pub format: u32,
    /// The design's name.
    pub design: String,
    /// The layout's file.
    pub layout: String,
    /// `nominal-sites` or `settled`.
    pub state: &'static str,
    /// What is assumed, sentence by sentence.
    pub assumed: Vec<String>,
    /// The share of pieces that do what is asked.
    #[serde(rename = "yield")]
    pub share: f64,
    /// What it is known to.
    pub interval: [f64; 2],
    /// What the interval is.
    pub interval_method: &'static str,
    /// What the yield is of, in words.
    pub yield_of: String,
    /// The baseline that is to be beaten, where nothing else is asked.
    pub baseline: Option<Beaten>,
    /// Pieces that do.
    pub passed: u64,
    /// Pieces that were made.
    pub samples: u64,
    /// Pieces that a guard stopped, or that do not stand: they do nothing that is asked.
    pub stopped: u64,
    /// The seed.
    pub seed: u64,
    /// What may turn out otherwise.
    pub quantities: Vec<Quantity>,
    /// What each does to each score, worst first for each score.
    pub sensitivity: Vec<Change>,
    /// Why there are no derivatives beside these, where some quantity would have one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub no_derivatives: Option<String>,
    /// Each score as built, by root-sum-square.
    pub as_built: Vec<AsBuilt>,
    /// Each score over the pieces.
    pub distribution: BTreeMap<&'static str, Distribution>,
    /// How runs were made.
    #[serde(flatten)]
    pub method: Method,
    /// What the reader should know.
    pub warnings: Vec<String>,
    /// What else was asked for, by its name.
    #[serde(flatten)]
    pub more: BTreeMap<&'static str, serde_json::Value>,
    /// The same in words.
    #[serde(skip)]
    pub words: String,
}

/// How each measure is distributed over the first `count` pieces.
pub fn distributions(samples: &Samples, count: usize, measures: &[Measure]) -> BTreeMap<&'static str, Distribution> {
    let of = |&measure: &Measure| {
        let sorted = samples.sorted(count, measure);
        let quantiles = PARTS.map(|part| quantile(&sorted, part));
        let Mean { mean, deviation, .. } = (!sorted.is_empty()).then(|| Mean::of(&sorted))?;
        Some((measure.name(), Distribution { mean, deviation, quantiles: quantiles.map(Option::unwrap_or_default) }))
    };
    measures.iter().filter_map(of).collect()
}

/// What is assumed, sentence by sentence.
pub fn assumed(tolerances: &Tolerances, quantities: &[Quantity], given: bool) -> Vec<String> {
    let mut words = Vec::new();
    if !given {
        words.push("no file of tolerances is given: diameters are of grade G100, friction is the design's (0 unless it says otherwise), and all else is nominal".to_owned());
    }
    if !tolerances.diameters_from.is_empty() {
        words.push(format!("diameters: {}", tolerances.diameters_from));
    }
    words.push(match tolerances.state {
        State::NominalSites => {
            "centres lie on the nominal sites, which are as far apart as the largest sphere of the piece needs"
                .to_owned()
        }
        State::Settled => {
            "spheres have settled in the frame under gravity along the axis; walls stand at the sides and the end"
                .to_owned()
        }
    });
    words.push(match tolerances.halves_alike {
        true => "both halves of a piece are alike".to_owned(),
        false => "each half of a piece turns out in its own way".to_owned(),
    });
    let limits = |quantity: &Quantity| format!("{} {}", quantity.name, quantity.limits_in_words());
    let list: Vec<String> = quantities.iter().map(limits).collect();
    words.push(match list.is_empty() {
        true => "nothing turns out otherwise than drawn".to_owned(),
        false => format!("within limits all values are as likely: {}", list.join("; ")),
    });
    words
}

/// The yield of the first `count` pieces.
pub fn yield_of(samples: &Samples, count: usize, criterion: &Criterion, of_layout: &Scores) -> (Share, u64) {
    let stopped = samples.list.iter().take(count).filter(|sample| sample.stop.is_some()).count();
    (samples.share(count, criterion, of_layout), stopped as u64)
}

impl Told {
    /// The tables and sentences of a terminal.
    pub fn words(&self) -> String {
        let mut text = String::new();
        self.assumed.iter().for_each(|line| {
            let _ = writeln!(text, "{line}");
        });
        let _ = writeln!(
            text,
            "\n| score | quantity | limits | change | of it | by the derivative | spread | linear | believed |\n|---|---|---|---|---|---|---|---|---|"
        );
        for change in &self.sensitivity {
            let quantity = self.quantities.iter().find(|quantity| quantity.name == change.quantity);
            let _ = writeln!(
                text,
                "| {} | {} | {} | {:+.4}{} | {:+.1} % | {} | {} | {} | {} |",
                change.score,
                change.quantity,
                quantity.map_or(String::new(), Quantity::limits_in_words),
                change.change,
                if change.resolved { "" } else { " (within the scatter)" },
                100.0 * change.relative,
                change.by_derivative.map_or("-".to_owned(), |change| format!("{change:+.4}")),
                change.spread.map_or("-".to_owned(), |spread| format!("{spread:.4}")),
                if change.linear { "yes" } else { "no" },
                change.believed.name(),
            );
        }
        text += "\n";
        if let Some(why) = &self.no_derivatives {
            let _ = writeln!(text, "no derivatives: {why}");
        }
        for built in &self.as_built {
            let AsBuilt { score, nominal, rss, refused } = built;
            let _ = match (rss, refused) {
                (Some(rss), _) => writeln!(
                    text,
                    "{score} as drawn {nominal:.4}, as built +- {rss:.4} (standard deviation, root-sum-square)"
                ),
                (None, refused) => writeln!(
                    text,
                    "{score} as drawn {nominal:.4}; no root-sum-square: {}",
                    refused.as_deref().unwrap_or("-")
                ),
            };
        }
        let _ = writeln!(
            text,
            "\n| score | mean | deviation | 5 % | 25 % | 50 % | 75 % | 95 % |\n|---|---|---|---|---|---|---|---|"
        );
        for (score, found) in &self.distribution {
            let deviation = found.deviation.map_or("-".to_owned(), |deviation| format!("{deviation:.4}"));
            let quantiles = found.quantiles.map(|value| format!("{value:.4}")).join(" | ");
            let _ = writeln!(text, "| {score} | {:.4} | {deviation} | {quantiles} |", found.mean);
        }
        let share = Share { passed: self.passed, of: self.samples, share: self.share, interval: self.interval };
        let _ = writeln!(
            text,
            "\nyield: {} of {} pieces keep {} ({INTERVAL}); seed {}",
            share.words(),
            self.samples,
            self.yield_of,
            self.seed
        );
        if self.stopped > 0 {
            let _ = writeln!(text, "{} of them were stopped by a guard or do not stand", self.stopped);
        }
        text += &self.words;
        text += &self.method.words();
        text
    }
}
