//! One evaluation, as the journal holds it.

use serde::{Deserialize, Serialize};

use super::journal::{sealed, unsealed};
use crate::dem::Stop;
use crate::evaluate::Evaluated;
use crate::score::{Measure, Scores, Spreads, over_forces};

/// One evaluation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Entry {
    /// Hash of everything that the scores depend on, in hexadecimal.
    pub key: String,
    /// The letters of the free sites, in hexadecimal: four sites to a digit for two letters, two for up to four, else one.
    pub layout: String,
    /// The scores under each impact, in the study's order; over several forces where the study asks for them.
    #[serde(with = "lines")]
    pub impacts: Vec<Scores>,
    /// How the scores of single forces scatter under each impact; empty with one force.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub over_forces: Vec<Spreads>,
    /// Why a run ended early, if one did.
    pub stop: Option<String>,
    /// Whether a run was cut short because it had come above what was of interest: its scores are bounds.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub cut: bool,
}

/// The scores of a journal, whose lines are many: only what a study knows, below short keys.
mod lines {
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    use crate::score::Scores;

    #[derive(Serialize, Deserialize)]
    struct Line {
        #[serde(rename = "F")]
        focal_mean: f64,
        #[serde(rename = "P")]
        protected_mean: f64,
        #[serde(rename = "C")]
        contrast: Option<f64>,
        #[serde(rename = "G")]
        focal_gain: Option<f64>,
        #[serde(rename = "Q")]
        protection: Option<f64>,
        #[serde(default, skip_serializing_if = "Option::is_none")]
        balance: Option<f64>,
        #[serde(rename = "Q_best", default, skip_serializing_if = "Option::is_none")]
        protection_best: Option<f64>,
        #[serde(flatten, skip_serializing_if = "Option::is_none")]
        felt: Option<Response>,
    }

    /// What needs full records; pairs are of the focal and the protected region.
    #[derive(Serialize, Deserialize)]
    struct Response {
        #[serde(rename = "momentum_kg_m_s")]
        momentum: [f64; 2],
        #[serde(rename = "force_N")]
        force: [f64; 2],
        #[serde(rename = "arrival_s")]
        arrival: [Option<f64>; 2],
        #[serde(rename = "far_momentum_kg_m_s")]
        far_momentum: f64,
        #[serde(rename = "far_force_N")]
        far_force: f64,
        dissipation: f64,
    }

    impl Line {
        fn of(scores: &Scores) -> Self {
            let felt = || {
                Some(Response {
                    momentum: [scores.focal_momentum?, scores.protected_momentum?],
                    force: [scores.focal_force?, scores.protected_force?],
                    arrival: [scores.focal_arrival, scores.protected_arrival],
                    far_momentum: scores.far_momentum?,
                    far_force: scores.far_force?,
                    dissipation: scores.dissipation?,
                })
            };
            Self {
                focal_mean: scores.focal_mean,
                protected_mean: scores.protected_mean,
                contrast: scores.contrast,
                focal_gain: scores.focal_gain,
                protection: scores.protection,
                balance: scores.balance,
                protection_best: scores.protection_best,
                felt: felt(),
            }
        }

        fn scores(self) -> Scores {
            let mut scores = Scores {
                focal_mean: self.focal_mean,
                protected_mean: self.protected_mean,
                contrast: self.contrast,
                focal_gain: self.focal_gain,
                protection: self.protection,
                balance: self.balance,
                protection_best: self.protection_best,
                ..Scores::default()
            };
            if let Some(felt) = self.felt {
                [scores.focal_momentum, scores.protected_momentum] = felt.momentum.map(Some);
                [scores.focal_force, scores.protected_force] = felt.force.map(Some);
                [scores.focal_arrival, scores.protected_arrival] = felt.arrival;
                (scores.far_momentum, scores.far_force) = (Some(felt.far_momentum), Some(felt.far_force));
                scores.dissipation = Some(felt.dissipation);
            }
            scores
        }
    }

    pub fn serialize<S: Serializer>(scores: &[Scores], serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(scores.iter().map(Line::of))
    }

    pub fn deserialize<'de, D: Deserializer<'de>>(deserializer: D) -> Result<Vec<Scores>, D::Error> {
        Ok(Vec::<Line>::deserialize(deserializer)?.into_iter().map(Line::scores).collect())
    }

    /// What the lines of a journal keep of scores, and so what replaying it gives: the same whether it was just simulated or read back.
    pub fn kept(scores: &Scores) -> Scores {
        Line::of(scores).scores()
    }
}

impl Entry {
    /// Of an evaluation that was not interrupted: of each impact its runs, one for each force.
    pub fn new(key: String, layout: String, impacts: &[&[Evaluated]]) -> Self {
        // JSON has no infinity; a run that a guard stopped may hold some.
        let sound = |scores: &Scores| {
            let mut kept = lines::kept(scores);
            for &measure in Measure::ALL {
                kept.set(measure, kept.get(measure).filter(|value| value.is_finite()));
            }
            kept
        };
        let runs = |runs: &&[Evaluated]| runs.iter().map(|run| sound(&run.scores)).collect::<Vec<_>>();
        let (scores, spreads): (Vec<_>, Vec<_>) = impacts.iter().map(|impact| over_forces(&runs(impact))).unzip();
        let stop = impacts.iter().copied().flatten().find_map(|run| run.stop.as_ref());
        let cut = matches!(stop, Some(Stop::Beyond { .. }));
        let stop = stop.map(ToString::to_string);
        let several = impacts.iter().any(|runs| runs.len() > 1);
        Self { key, layout, impacts: scores, over_forces: if several { spreads } else { Vec::new() }, stop, cut }
    }

    /// As a line of a journal, with its checksum and its end.
    pub fn to_line(&self) -> String {
        sealed(self)
    }

    /// From a line of a journal; none if its checksum does not fit.
    pub fn from_line(line: &str) -> Option<Self> {
        unsealed(line.trim_end().as_bytes())
    }

    /// The letters of `count` free sites; none if the entry belongs to something else.
    pub fn assignment(&self, count: usize, alphabet: u8) -> Option<Vec<u8>> {
        unpack(&self.layout, count, alphabet)
    }
}

/// Letters as hexadecimal digits: four sites to a digit for two letters, two for four, one for up to sixteen.
pub fn pack(letters: &[u8], alphabet: u8) -> String {
    let bits = bits(alphabet);
    let digit = |sites: &[u8]| {
        let value = sites.iter().enumerate().fold(0_u32, |value, (k, &letter)| value | u32::from(letter) << (k * bits));
        char::from_digit(value, 16).unwrap_or('?')
    };
    letters.chunks(4 / bits).map(digit).collect()
}

/// The letters of `count` sites; none if the text is no such.
pub fn unpack(text: &str, count: usize, alphabet: u8) -> Option<Vec<u8>> {
    let bits = bits(alphabet);
    let mut letters = Vec::with_capacity(count + 4);
    for digit in text.chars() {
        let value = digit.to_digit(16)?;
        letters.extend((0..4 / bits).map(|k| (value >> (k * bits) & ((1 << bits) - 1)) as u8));
    }
    let whole = letters.len() >= count && letters.len() - count < 4 / bits;
    letters.truncate(count);
    (whole && letters.iter().all(|&letter| letter < alphabet)).then_some(letters)
}

fn bits(alphabet: u8) -> usize {
    match alphabet {
        0..=2 => 1,
        3..=4 => 2,
        _ => 4,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_survive_packing() {
        for alphabet in 1..=16 {
            for count in 0..10 {
                let letters: Vec<u8> = (0..count).map(|k| (7 * k as u8 + 3) % alphabet).collect();
                let text = pack(&letters, alphabet);
                assert_eq!(unpack(&text, count, alphabet), Some(letters));
                assert_eq!(unpack(&text, count + 5, alphabet), None);
            }
        }
        assert_eq!(unpack("3", 1, 3), None);
        assert_eq!(unpack("x", 1, 2), None);
    }
}
