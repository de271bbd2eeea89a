//! Smooth random choices: a low-order field for each letter, and on each site the letter whose field is highest.

use super::{Choice, Dice, Space};

/// Half waves along rows and columns.
const ORDER: usize = 5;

/// A smooth random choice: for each letter a sum of products of cosines over the sites' rectangle, of up to four half waves
/// each way and with less of the shorter ones, and a random offset; the highest field has the site.
///
/// cos(m π x) is the Chebyshev polynomial T_m of cos(π x), for which 1 - 2 (3 x² - 2 x³) stands in (off by 0.01 at
/// most), so that nothing depends on a platform's mathematical library.
pub fn level_set(space: &Space, dice: &mut Dice) -> Choice {
    let range = |k: usize| {
        let of = || space.sites.iter().map(|site| site[k]);
        let first = of().min().unwrap_or(0);
        (f64::from(first), f64::from((of().max().unwrap_or(0) - first).max(1)))
    };
    let ranges = [range(0), range(1)];
    let waves: Vec<[[f64; ORDER]; 2]> = space
        .sites
        .iter()
        .map(|site| [0, 1].map(|k| half_waves((f64::from(site[k]) - ranges[k].0) / ranges[k].1)))
        .collect();
    let mut field = || {
        let mut weights = [[0.0; ORDER]; ORDER];
        for (m, row) in weights.iter_mut().enumerate() {
            for (n, weight) in row.iter_mut().enumerate() {
                *weight = dice.bell() / (1.0 + 0.5 * (m + n) as f64);
            }
        }
        weights
    };
    let fields: Vec<[[f64; ORDER]; ORDER]> = (0..space.letters).map(|_| field()).collect();
    let height = |weights: &[[f64; ORDER]; ORDER], [down, across]: &[[f64; ORDER]; 2]| {
        let mut sum = 0.0;
        for (row, d) in weights.iter().zip(down) {
            for (weight, a) in row.iter().zip(across) {
                sum += weight * d * a;
            }
        }
        sum
    };
    let highest = |waves: &[[f64; ORDER]; 2]| {
        let mut best = (f64::NEG_INFINITY, 0);
        for (letter, weights) in (0..space.letters).zip(&fields) {
            let height = height(weights, waves);
            if height > best.0 {
                best = (height, letter);
            }
        }
        best.1
    };
    waves.iter().map(highest).collect()
}

/// About cos(m π x), m from 0 on.
fn half_waves(x: f64) -> [f64; ORDER] {
    let u = 1.0 - 2.0 * x * x * (3.0 - 2.0 * x);
    let mut waves = [1.0; ORDER];
    waves[1] = u;
    for m in 2..ORDER {
        waves[m] = 2.0 * u * waves[m - 1] - waves[m - 2];
    }
    waves
}
