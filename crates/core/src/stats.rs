//! Chance in numbers: fractions from a generator's raw bits, the same on every platform and in every release of the generator's
//! crate; and how far a mean can be trusted.

use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::Rng;
use serde::Serialize;

/// A number from 0 to 1, 1 not included: the upper 53 bits of the next output, which are what a fraction holds.
pub(crate) fn fraction(generator: &mut Xoshiro256PlusPlus) -> f64 {
    (generator.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
}

/// Mean of some numbers, and how far it can be trusted.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Mean {
    /// Sum over count.
    pub mean: f64,
    /// Standard deviation of single numbers (n − 1); none of one number.
    pub deviation: Option<f64>,
    /// Half the width of the 95 % confidence interval of the mean, by Student's t; none of one number.
    pub interval: Option<f64>,
}

impl Mean {
    /// Of at least one number.
    pub fn of(numbers: &[f64]) -> Self {
        let count = numbers.len() as f64;
        let mean = numbers.iter().sum::<f64>() / count;
        if numbers.len() < 2 {
            return Self { mean, deviation: None, interval: None };
        }
        let variance = numbers.iter().map(|x| (x - mean) * (x - mean)).sum::<f64>() / (count - 1.0);
        let interval = student(numbers.len() - 1) * (variance / count).sqrt();
        Self { mean, deviation: Some(variance.sqrt()), interval: Some(interval) }
    }
}

/// Quantile 0.975 of Student's distribution: tabulated to 10 degrees of freedom ν, then by its expansion in 1/ν (Abramowitz and
/// Stegun 26.7.5), to 10⁻⁴. Of no freedom there is none to tell, and it is infinite.
pub fn student(freedom: usize) -> f64 {
    const FEW: [f64; 10] =
        [12.706_205, 4.302_653, 3.182_446, 2.776_445, 2.570_582, 2.446_912, 2.364_624, 2.306_004, 2.262_157, 2.228_139];
    if freedom == 0 {
        return f64::INFINITY;
    }
    if let Some(quantile) = FEW.get(freedom - 1) {
        return *quantile;
    }
    let (x, v) = (1.959_963_985_f64, freedom as f64);
    let (x3, x5, x7) = (x.powi(3), x.powi(5), x.powi(7));
    x + (x3 + x) / (4.0 * v)
        + (5.0 * x5 + 16.0 * x3 + 3.0 * x) / (96.0 * v * v)
        + (3.0 * x7 + 19.0 * x5 + 17.0 * x3 - 15.0 * x) / (384.0 * v * v * v)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Quantiles as tables print them.
    #[test]
    fn quantiles_are_student_s() {
        for (freedom, quantile) in [(1, 12.706), (4, 2.776), (11, 2.201), (20, 2.086), (49, 2.0096), (1000, 1.9623)] {
            assert!((student(freedom) - quantile).abs() < 6e-4, "{freedom}: {}", student(freedom));
        }
    }

    /// 1, 2, 3, 4: mean 2.5, variance 5/3, standard error √(5/12).
    #[test]
    fn means_and_intervals_are_those_of_the_textbook() {
        let known = Mean::of(&[1.0, 2.0, 3.0, 4.0]);
        assert!((known.mean - 2.5).abs() < 1e-15);
        assert!((known.deviation.unwrap() - (5.0_f64 / 3.0).sqrt()).abs() < 1e-15);
        assert!((known.interval.unwrap() - 3.182_446 * (5.0_f64 / 12.0).sqrt()).abs() < 1e-15);
        assert_eq!(Mean::of(&[7.0]), Mean { mean: 7.0, deviation: None, interval: None });
    }
}
