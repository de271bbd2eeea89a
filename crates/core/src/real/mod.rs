//! The number that the physics is written in: one design's `f64`, or several designs side by side.
//!
//! Contact laws and the stepper are generic over [`Real`], so that one page of physics serves one design and, in the lanes
//! of a vector register, four or eight designs on one lattice. Only operations whose result IEEE 754 fixes to the last
//! bit are used (sums, products, quotients, roots, comparisons, exponent extraction), never fused; `ln` and `exp` are built
//! from them here. So every width gives the same bits, and results do not depend on a platform's mathematical library.
//!
//! - `lanes`: four and eight designs in AVX2 and AVX-512 registers, and the choice between them

mod lanes;

pub use lanes::{Kernel, Width};

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
    /// A place in a table, one per number.
    type Index: Copy;
    /// How many designs stand side by side.
    const LANES: usize;

    /// The same number everywhere.
    fn splat(value: f64) -> Self;
    /// One of the numbers.
    fn lane(self, lane: usize) -> f64;
    /// Replaces one of the numbers.
    fn set_lane(&mut self, lane: usize, value: f64);
    /// The first numbers of a slice; it must hold as many.
    fn load(from: &[f64]) -> Self;
    /// Writes the numbers to the start of a slice.
    fn store(self, to: &mut [f64]);
    /// The numbers moved one place on; into the first place comes the last one of `before`.
    fn after(self, before: Self) -> Self;
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
    /// Places from bytes below 16, one per number.
    fn index(places: &[u8]) -> Self::Index;
    /// The entries at given places.
    fn lookup(table: &[f64; 16], place: Self::Index) -> Self;
    /// Writes a positive normal number as m 2^e with m in [1, 2); gives e, m, and in which sixteenth of [1, 2) m lies.
    fn exponent_mantissa(self) -> (Self, Self, Self::Index);

    /// Natural logarithm of a positive normal number, to about 2 units in the last place of max(|ln x|, 1).
    ///
    /// x = 2^e m, and m times a nine-bit number near 1/m leaves 1 + r with |r| ≤ 1/16, whose series ends at r¹².
    #[inline(always)]
    fn ln(self) -> Self {
        let c = Self::splat;
        let (e, m, sixteenth) = self.exponent_mantissa();
        // The product of m and a nine-bit number may round; so r is taken from the rounded product, an error of 1e-16.
        let r = m * Self::lookup(&INVERSE, sixteenth) - c(1.0);
        let s = r * r;
        let tail = c(-1.0 / 12.0);
        let tail = c(-1.0 / 10.0) + r * c(1.0 / 11.0) + s * tail;
        let tail = c(-1.0 / 8.0) + r * c(1.0 / 9.0) + s * tail;
        let tail = c(-1.0 / 6.0) + r * c(1.0 / 7.0) + s * tail;
        let tail = c(-1.0 / 4.0) + r * c(1.0 / 5.0) + s * tail;
        let tail = c(-1.0 / 2.0) + r * c(1.0 / 3.0) + s * tail;
        e * c(LN2_HIGH) + (Self::lookup(&MINUS_LN_INVERSE, sixteenth) + (r + s * tail + e * c(LN2_LOW)))
    }

    /// exp(x) for 0 ≤ x ≤ 0.5, to 10⁻¹⁵: the Taylor series to x¹³.
    #[inline(always)]
    fn exp_small(self) -> Self {
        let c = Self::splat;
        let x = self;
        let s = x * x;
        let tail = c(1.0 / 479_001_600.0) + x * c(1.0 / 6_227_020_800.0);
        let tail = c(1.0 / 3_628_800.0) + x * c(1.0 / 39_916_800.0) + s * tail;
        let tail = c(1.0 / 40_320.0) + x * c(1.0 / 362_880.0) + s * tail;
        let tail = c(1.0 / 720.0) + x * c(1.0 / 5040.0) + s * tail;
        let tail = c(1.0 / 24.0) + x * c(1.0 / 120.0) + s * tail;
        let tail = c(1.0 / 2.0) + x * c(1.0 / 6.0) + s * tail;
        c(1.0) + (x + s * tail)
    }
}

/// ln 2 in two parts; the high one has trailing zeros, so that its product with an exponent is exact.
const LN2_HIGH: f64 = 0.693_147_180_369_123_8;
const LN2_LOW: f64 = 1.908_214_929_270_587_7e-10;

/// For each sixteenth of [1, 2) a number of nine bits near the inverse of its middle; 1 for the first, so that ln 1 = 0.
const INVERSE: [f64; 16] = [
    1.0,
    0.914_062_5,
    0.865_234_375,
    0.820_312_5,
    0.781_25,
    0.744_140_625,
    0.710_937_5,
    0.681_640_625,
    0.652_343_75,
    0.626_953_125,
    0.603_515_625,
    0.582_031_25,
    0.560_546_875,
    0.542_968_75,
    0.525_390_625,
    0.507_812_5,
];

/// −ln of `INVERSE`, correctly rounded.
const MINUS_LN_INVERSE: [f64; 16] = [
    0.0,
    0.089_856_329_121_861_05,
    0.144_754_854_994_372_16,
    0.198_069_913_762_093_8,
    0.246_860_077_931_525_78,
    0.295_525_249_912_806_8,
    0.341_170_757_402_767_14,
    0.383_252_702_837_080_6,
    0.427_183_632_062_807_35,
    0.466_883_501_909_491_9,
    0.504_983_348_141_762_3,
    0.541_231_138_534_103_3,
    0.578_842_409_279_886_7,
    0.610_703_511_348_870_7,
    0.643_613_245_437_668_6,
    0.677_642_994_023_980_1,
];

impl Real for f64 {
    type Mask = bool;
    type Index = usize;
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
    fn load(from: &[f64]) -> Self {
        from[0]
    }
    #[inline(always)]
    fn store(self, to: &mut [f64]) {
        to[0] = self;
    }
    #[inline(always)]
    fn after(self, before: Self) -> Self {
        before
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        f64::sqrt(self)
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
    fn index(places: &[u8]) -> usize {
        usize::from(places[0])
    }
    #[inline(always)]
    fn lookup(table: &[f64; 16], place: usize) -> Self {
        table[place & 15]
    }
    #[inline(always)]
    fn exponent_mantissa(self) -> (Self, Self, usize) {
        let bits = self.to_bits();
        let exponent = ((bits >> 52) & 0x7ff) as i64 - 1023;
        let mantissa = f64::from_bits((bits & 0x000f_ffff_ffff_ffff) | 0x3ff0_0000_0000_0000);
        (exponent as f64, mantissa, (bits >> 48) as usize & 15)
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
            assert!((ours - library).abs() <= 4.5e-16 * library.abs().max(1.0), "ln {x}: {ours} and {library}");
            let y = f64::from(k) / 40_000.0;
            assert!((y.exp_small() / y.exp() - 1.0).abs() < 1e-15, "exp {y}");
        }
        assert_eq!(Real::ln(1.0), 0.0);
    }
}
