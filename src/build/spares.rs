//! How many spheres to order besides those that are built in: a part of each count, and further sets where not every piece does what is
//! asked.
//!
//! A piece that misses is built anew, of other spheres, from lots of their own, as the pieces of a yield are. Of n pieces, each of which does
//! with the chance y, one does with 1 − (1 − y)ⁿ: the sets to order are the least n for which that is as sure as is wanted, y being the lower
//! end of the yield's interval.

use std::path::Path;

use serde::Serialize;
use serde_json::Value;

/// The sureness that sets are ordered for.
const SURE: f64 = 0.95;

/// What is ordered besides.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Spares {
    /// Of each count.
    pub part: f64,
    /// Whole sets, the piece's own among them.
    pub sets: u64,
    /// The yield that sets follow from; none without one.
    #[serde(rename = "yield")]
    pub from: Option<Yield>,
}

/// A yield that was found.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Yield {
    /// The share of pieces.
    pub share: f64,
    /// What it is known to.
    pub interval: [f64; 2],
    /// What it is of.
    pub of: String,
    /// The design and the layout that it was found for.
    #[serde(skip)]
    pub found_for: [String; 2],
}

impl Yield {
    /// Of the numbers that `granulens tolerance` wrote; `path` is only named in messages.
    ///
    /// # Errors
    /// Text that is something else, in words.
    pub fn parse(path: &Path, text: &str) -> Result<Self, String> {
        let fail = || format!("{}: is no tolerance.json of granulens tolerance", path.display());
        let told: Value = serde_json::from_str(text).map_err(|_| fail())?;
        let number = |value: &Value| value.as_f64().filter(|share| (0.0..=1.0).contains(share)).ok_or_else(fail);
        let words = |key: &str| told[key].as_str().map(str::to_owned).ok_or_else(fail);
        Ok(Self {
            share: number(&told["yield"])?,
            interval: [number(&told["interval"][0])?, number(&told["interval"][1])?],
            of: words("yield_of")?,
            found_for: [words("design")?, words("layout")?],
        })
    }
}

impl Spares {
    /// A part of each count alone.
    pub fn part(part: f64) -> Self {
        Self { part, sets: 1, from: None }
    }

    /// A part of each count, and as many sets as a yield asks for.
    ///
    /// # Errors
    /// A yield that no number of sets makes up for, in words.
    pub fn of_yield(part: f64, from: Yield) -> Result<Self, String> {
        let low = from.interval[0];
        let sets = if low >= SURE { 1.0 } else { ((1.0 - SURE).ln() / (1.0 - low).ln()).ceil() };
        // A share of some thousandths asks for a thousand sets: no workshop builds these.
        if !(1.0..=100.0).contains(&sets) {
            return Err(format!(
                "of the pieces {:.1} % at least do what is asked ({}): spares do not help",
                100.0 * low,
                from.of
            ));
        }
        Ok(Self { part, sets: sets as u64, from: Some(from) })
    }

    /// Of a material of which so many are built in; never none.
    pub fn of(&self, count: usize) -> usize {
        // A product such as 0.05 × 1200 must not be rounded up for its last bit.
        let part = ((count as f64 * self.part - 1e-9).ceil() as usize).max(1);
        part + count * (self.sets as usize - 1)
    }

    /// Why sets are ordered, in words; nothing without a yield.
    pub fn words(&self) -> String {
        let Some(Yield { share, interval: [low, high], of, .. }) = &self.from else { return String::new() };
        let Self { sets, .. } = self;
        let percent = |share: f64| 100.0 * share;
        let one = 1.0 - (1.0 - low).powi(*sets as i32);
        format!(
            "\nspares: {:.1} % of pieces ({:.1} to {:.1} %) keep {of}; of {sets} {}, at least {:.1} % have one that does\n",
            percent(*share),
            percent(*low),
            percent(*high),
            if *sets == 1 { "set" } else { "sets" },
            percent(one)
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn yields(low: f64) -> Yield {
        Yield { share: low, interval: [low, 1.0], of: "contrast at least 2".to_owned(), found_for: Default::default() }
    }

    /// By hand: 1 − 0.3³ = 0.973 and 1 − 0.3² = 0.91, so that three sets make 95 % of 70 %; of 95 % one is enough, of 94.9 % two.
    #[test]
    fn sets_are_the_least_that_are_sure() {
        for (low, sets) in [(0.7, 3), (0.95, 1), (0.949, 2), (0.5, 5), (1.0, 1)] {
            assert_eq!(Spares::of_yield(0.05, yields(low)).unwrap().sets, sets, "{low}");
        }
        assert!(Spares::of_yield(0.05, yields(0.0)).unwrap_err().contains("do not help"));
        let three = Spares::of_yield(0.05, yields(0.7)).unwrap();
        // A twentieth of 1200 is 60 and not 61, and two further sets.
        assert_eq!((three.of(1200), Spares::part(0.05).of(1200), Spares::part(0.0).of(3)), (2460, 60, 1));
    }

    #[test]
    fn other_files_are_refused() {
        for text in ["", "{}", r#"{"yield": 2.0, "interval": [0, 1], "yield_of": "", "design": "", "layout": ""}"#] {
            assert!(Yield::parse(Path::new("a.json"), text).unwrap_err().contains("a.json"), "{text}");
        }
    }
}
