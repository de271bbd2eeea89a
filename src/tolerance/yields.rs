//! How many pieces do: a share and the interval it is known to.

use serde::Serialize;

/// Quantile 0.975 of the normal distribution.
const Z: f64 = 1.959_963_984_540_054;

/// A share of pieces with its interval.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Share {
    /// Pieces that do.
    pub passed: u64,
    /// Of how many.
    pub of: u64,
    /// The first over the second.
    pub share: f64,
    /// Wilson's score interval to 95 % (E. B. Wilson, J. Am. Stat. Assoc. 22, 209, 1927):
    ///   (p + z²/2n ± z √(p(1 − p)/n + z²/4n²)) / (1 + z²/n)
    pub interval: [f64; 2],
}

/// What the interval is called.
pub const INTERVAL: &str = "Wilson score, 95 %";

impl Share {
    /// So many of at least one.
    pub fn of(passed: u64, of: u64) -> Self {
        let (n, z2) = (of as f64, Z * Z);
        let share = passed as f64 / n;
        let middle = (share + z2 / (2.0 * n)) / (1.0 + z2 / n);
        let half = Z * (share * (1.0 - share) / n + z2 / (4.0 * n * n)).sqrt() / (1.0 + z2 / n);
        // At none and at all the end is exact, but for rounding.
        let low = if passed == 0 { 0.0 } else { middle - half };
        let high = if passed == of { 1.0 } else { middle + half };
        Self { passed, of, share, interval: [low, high] }
    }

    /// In words: `92.0 % (89.3 to 94.1 %)`.
    pub fn words(&self) -> String {
        let [low, high] = self.interval.map(|end| 100.0 * end);
        format!("{:.1} % ({low:.1} to {high:.1} %)", 100.0 * self.share)
    }
}

/// Quantiles of a score over pieces, by the nearest rank; none of no value.
pub fn quantile(sorted: &[f64], part: f64) -> Option<f64> {
    let rank = (part * sorted.len() as f64).ceil() as usize;
    sorted.get(rank.max(1) - 1).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Newcombe (Stat. Med. 17, 857, 1998), table I, method 3: 81 of 263, 15 of 148, 0 of 20, 1 of 29.
    #[test]
    fn intervals_are_wilson_s() {
        for (passed, of, expected) in [
            (81, 263, [0.2553, 0.3662]),
            (15, 148, [0.0624, 0.1605]),
            (0, 20, [0.0, 0.1611]),
            (1, 29, [0.0061, 0.1718]),
        ] {
            let found = Share::of(passed, of).interval;
            assert!((0..2).all(|k| (found[k] - expected[k]).abs() < 5e-5), "{passed} of {of}: {found:?}");
        }
        assert_eq!(Share::of(29, 29).interval[1], 1.0);
    }

    /// Of pieces that pass with a known chance the interval holds it about as often as it says: 95 % of 2000 sets, within three standard
    /// errors and Wilson's own unevenness of a percent.
    #[test]
    fn intervals_hold_the_truth_as_often_as_they_say() {
        let mut rng = crate::search::Rng::new(7);
        for chance in [0.5, 0.9] {
            let held = (0..2000).filter(|_| {
                let passed = (0..100).filter(|_| rng.unit() < chance).count() as u64;
                let [low, high] = Share::of(passed, 100).interval;
                (low..=high).contains(&chance)
            });
            let part = held.count() as f64 / 2000.0;
            assert!((0.92..=0.98).contains(&part), "{chance}: {part}");
        }
    }
}
