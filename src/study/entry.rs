//! One evaluation, as the journal holds it.

use serde::{Deserialize, Serialize};

use crate::evaluate::{Felt, Marks};

/// One evaluation.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Entry {
    /// Hash of everything that the scores depend on, in hexadecimal.
    pub key: String,
    /// The letters of the free sites, in hexadecimal: four sites to a digit for two letters, two for up to four, else one.
    pub layout: String,
    /// The scores under each impact, in the study's order.
    pub impacts: Vec<Scored>,
    /// Why a run ended early, if one did.
    pub stop: Option<String>,
}

/// The scores under one impact.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Scored {
    /// F (J)
    #[serde(rename = "F")]
    pub focal_mean: f64,
    /// P (J)
    #[serde(rename = "P")]
    pub protected_mean: f64,
    /// C = F/P
    #[serde(rename = "C")]
    pub contrast: Option<f64>,
    /// G = F/F(all host), under the same impact
    #[serde(rename = "G")]
    pub focal_gain: Option<f64>,
    /// Q = P/P(all lens material), under the same impact
    #[serde(rename = "Q")]
    pub protection: Option<f64>,
    /// How evenly several foci are served, where there are several
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub balance: Option<f64>,
    /// P over the least P of all baselines under the same impact, where the study asks for it
    #[serde(rename = "Q_best", default, skip_serializing_if = "Option::is_none")]
    pub against_best: Option<f64>,
    /// What else was felt, where the study asks for it.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    pub felt: Option<Felt>,
}

impl Entry {
    /// Of an evaluation that was not interrupted.
    pub fn new(key: String, layout: String, marks: &[Marks]) -> Self {
        // JSON has no infinity; a run that a guard stopped may hold some.
        let finite = |value: f64| if value.is_finite() { value } else { 0.0 };
        let ratio = |value: Option<f64>| value.filter(|value| value.is_finite());
        let scored = |marks: &Marks| Scored {
            focal_mean: finite(marks.focal_mean),
            protected_mean: finite(marks.protected_mean),
            contrast: ratio(marks.contrast),
            focal_gain: ratio(marks.focal_gain),
            protection: ratio(marks.protection),
            balance: ratio(marks.balance),
            against_best: ratio(marks.against_best),
            felt: marks.felt,
        };
        let stop = marks.iter().find_map(|marks| marks.stop.as_ref()).map(ToString::to_string);
        Self { key, layout, impacts: marks.iter().map(scored).collect(), stop }
    }

    /// The letters of `count` free sites; none if the entry belongs to something else.
    pub fn choice(&self, count: usize, alphabet: u8) -> Option<Vec<u8>> {
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
