//! Numbers as a reader wants them: so many digits, and a dash where there is no number.

/// What stands where there is no number: a ratio without a denominator, a deviation of one value.
pub const NONE: &str = "–";

/// A number to so many significant digits; very small and very large ones with an exponent.
pub fn significant(value: f64, digits: usize) -> String {
    if !value.is_finite() {
        return NONE.to_owned();
    }
    if value == 0.0 {
        return "0".to_owned();
    }
    let exponent = exponent(value, digits);
    if (-4..7).contains(&exponent) {
        let decimals = decimals(value, digits);
        let shown = format!("{value:.decimals$}");
        if decimals > 0 && digits <= 2 { shown.trim_end_matches('0').trim_end_matches('.').to_owned() } else { shown }
    } else {
        format!("{value:.*e}", digits.saturating_sub(1))
    }
}

/// A given number, such as an edge of a region, as one would write it: at most three decimals, no trailing zeros.
pub fn short(value: f64) -> String {
    let rounded = (value * 1e3).round() / 1e3;
    if rounded.is_finite() { (rounded + 0.0).to_string() } else { NONE.to_owned() }
}

/// The decimals that show a number to so many significant digits.
pub fn decimals(value: f64, digits: usize) -> usize {
    if value == 0.0 || !value.is_finite() {
        return digits.saturating_sub(1);
    }
    (digits as i32 - 1 - exponent(value, digits)).max(0) as usize
}

/// The power of ten of the number once rounded: 9.996 to three digits is 10.0.
fn exponent(value: f64, digits: usize) -> i32 {
    let shown = format!("{value:.*e}", digits.saturating_sub(1));
    shown.rsplit('e').next().and_then(|e| e.parse().ok()).unwrap_or(0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn digits_are_significant() {
        assert_eq!(significant(0.331_306, 3), "0.331");
        assert_eq!(significant(674.03, 4), "674.0");
        assert_eq!(significant(9.996, 3), "10.0");
        assert_eq!(significant(1.2e-5, 2), "1.2e-5");
        assert_eq!(significant(26000.0, 2), "26000");
        assert_eq!(significant(0.5, 2), "0.5");
        assert_eq!(significant(f64::NAN, 3), NONE);
        assert_eq!(significant(0.0, 3), "0");
        assert_eq!(short(16.500_000_000_01), "16.5");
    }
}
