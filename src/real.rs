//! The number that the physics is written in: one design's `f64`.
//!
//! Contact laws and the stepper are generic over [`Real`], so that the same page of physics serves one design or, with
//! several numbers side by side, several designs on one lattice. Only operations whose result IEEE 754 fixes to the last
//! bit are used (sums, products, quotients, roots, comparisons, exponent extraction); `ln` and `exp` are built from them here, so
//! results do not depend on a platform's mathematical library.

use std::fmt::Debug;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A real number, or several side by side that are computed alike.
pub trait Real:
    Copy
    + Debug
    + Send
    + Sync
    + 'static
    + Add<Output = Self>
    + Sub<Output = Self>
    + Mul<Output = Self>
    + Div<Output = Self>
    + Neg<Output = Self>
{
    /// The outcome of a comparison, one truth value per number.
    type Mask: Copy;
    /// How many designs stand side by side.
    const LANES: usize;

    /// The same number everywhere.
    fn splat(value: f64) -> Self;
    /// One of the numbers.
    fn lane(self, lane: usize) -> f64;
    /// Replaces one of the numbers.
    fn set_lane(&mut self, lane: usize, value: f64);
    /// Square root.
    fn sqrt(self) -> Self;
    /// The lesser; `other` where a number is NaN.
    fn min(self, other: Self) -> Self;
    /// The greater; `other` where a number is NaN.
    fn max(self, other: Self) -> Self;
    /// self < other
    fn lt(self, other: Self) -> Self::Mask;
    /// Where the mask holds `yes`, elsewhere `no`.
    fn select(mask: Self::Mask, yes: Self, no: Self) -> Self;
    /// Either mask.
    fn or(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// Whether the mask holds anywhere.
    fn any(mask: Self::Mask) -> bool;
    /// Whether the mask holds everywhere.
    fn all(mask: Self::Mask) -> bool;
    /// Writes a positive normal number as m 2^e with m in [1/√2, √2).
    fn mantissa_exponent(self) -> (Self, Self);

    /// Natural logarithm of a positive normal number, to 2 units in the last place.
    ///
    /// ln x = e ln 2 + 2 artanh((m − 1)/(m + 1)); the series of artanh ends where |s| ≤ 0.1716 leaves less than 10⁻¹⁷.
    #[inline(always)]
    fn ln(self) -> Self {
        let c = Self::splat;
        let (m, e) = self.mantissa_exponent();
        let s = (m - c(1.0)) / (m + c(1.0));
        let z = s * s;
        let z2 = z * z;
        // Two interleaved Horner chains: even and odd powers of z.
        let even =
            c(2.0 / 3.0) + z2 * (c(2.0 / 7.0) + z2 * (c(2.0 / 11.0) + z2 * (c(2.0 / 15.0) + z2 * c(2.0 / 19.0))));
        let odd = c(2.0 / 5.0) + z2 * (c(2.0 / 9.0) + z2 * (c(2.0 / 13.0) + z2 * c(2.0 / 17.0)));
        let tail = s * (z * (even + z * odd));
        e * c(LN2_HIGH) + (s + s + (tail + e * c(LN2_LOW)))
    }

    /// exp(x) for 0 ≤ x ≤ 0.5, to 10⁻¹⁵: the Taylor series to x¹³.
    #[inline(always)]
    fn exp_small(self) -> Self {
        let mut sum = Self::splat(1.0);
        for k in (1..=13).rev() {
            sum = Self::splat(1.0) + self * sum * Self::splat(1.0 / f64::from(k));
        }
        sum
    }
}

/// ln 2 in two parts; the high one has trailing zeros, so that its product with an exponent is exact.
const LN2_HIGH: f64 = 0.693_147_180_369_123_8;
const LN2_LOW: f64 = 1.908_214_929_270_587_7e-10;

impl Real for f64 {
    type Mask = bool;
    const LANES: usize = 1;

    #[inline(always)]
    fn splat(value: f64) -> Self {
        value
    }
    #[inline(always)]
    fn lane(self, _: usize) -> f64 {
        self
    }
    #[inline(always)]
    fn set_lane(&mut self, _: usize, value: f64) {
        *self = value;
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        self.sqrt()
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        if self < other { self } else { other }
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        if self > other { self } else { other }
    }
    #[inline(always)]
    fn lt(self, other: Self) -> bool {
        self < other
    }
    #[inline(always)]
    fn select(mask: bool, yes: Self, no: Self) -> Self {
        if mask { yes } else { no }
    }
    #[inline(always)]
    fn or(a: bool, b: bool) -> bool {
        a || b
    }
    #[inline(always)]
    fn any(mask: bool) -> bool {
        mask
    }
    #[inline(always)]
    fn all(mask: bool) -> bool {
        mask
    }
    #[inline(always)]
    fn mantissa_exponent(self) -> (Self, Self) {
        // Shifting the bits so that √½ becomes a power of two's boundary puts m into [1/√2, √2).
        const SQRT_HALF: u64 = 0x3fe6_a09e_667f_3bcd;
        const ONE: u64 = 0x3ff0_0000_0000_0000;
        let bits = self.to_bits().wrapping_add(ONE - SQRT_HALF);
        let exponent = (bits >> 52) as i64 - 1023;
        let mantissa = (bits & 0x000f_ffff_ffff_ffff) + SQRT_HALF;
        (f64::from_bits(mantissa), exponent as f64)
    }
}

#[cfg(test)]
mod tests {
    use super::Real;

    /// Against the platform's library, itself good to one unit in the last place.
    #[test]
    fn logarithm_and_exponential_are_exact_to_rounding() {
        for k in 0..20_000 {
            let x = 1e-12 * 1.004_f64.powi(k % 14_000) * (1.0 + f64::from(k) * 1e-6);
            let (ours, library) = (Real::ln(x), f64::ln(x));
            assert!((ours - library).abs() <= 4.5e-16 * library.abs().max(0.5), "ln {x}: {ours} and {library}");
            let y = f64::from(k) / 40_000.0;
            assert!((y.exp_small() / y.exp() - 1.0).abs() < 1e-15, "exp {y}");
        }
        assert_eq!(Real::ln(1.0), 0.0);
    }
}
