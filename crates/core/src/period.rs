//! What repeats itself along an axis.

/// The shortest way along an axis to a body or one of its images, where `apart` leads to the body itself, and everything repeats itself after `period`. Halfway both ways
/// are as long; where the last bit of a place decides, that of either may be told.
#[inline(always)]
pub fn nearest_image(apart: f64, period: f64) -> f64 {
    // Most are near enough as they are, and rounding takes long.
    if apart.abs() < 0.5 * period { apart } else { apart - period * (apart / period).round() }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Against all images, of periods that binary numbers have and of others: no way is shorter, and it leads to an image.
    #[test]
    fn no_other_image_is_nearer() {
        for period in [1.0, 0.7, 17.17, 3e-3] {
            for k in -4000..=4000 {
                let apart = f64::from(k) * 1e-3 * period;
                let nearest = nearest_image(apart, period);
                let images = (-5..=5).map(|image| apart + f64::from(image) * period);
                let least = images.fold(f64::INFINITY, |least, image| least.min(image.abs()));
                // Two roundings of numbers up to four and a half periods.
                assert!((nearest.abs() - least).abs() < 9.0 * f64::EPSILON * period, "{apart} {period}: {nearest}");
                let turns = (apart - nearest) / period;
                assert!((turns - turns.round()).abs() < 1e-12, "{apart} {period}: {turns}");
            }
        }
        assert_eq!((nearest_image(0.4, 1.0), nearest_image(-0.4, 1.0)), (0.4, -0.4));
    }
}
