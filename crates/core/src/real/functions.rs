//! Logarithm, exponential and arc cosine from operations that IEEE 754 fixes, so that every width and platform gives the same bits.

use std::f64::consts::{FRAC_PI_2, LOG2_E, PI};

use super::{Lanes, Number};

/// x = 2^e m, and m times a nine-bit number near 1/m leaves 1 + r with |r| ≤ 1/16, whose series ends at r¹².
#[inline(always)]
pub(super) fn ln<V: Lanes>(x: V) -> V {
    let c = V::splat;
    let (e, m, sixteenth) = x.exponent_mantissa();
    // The product of m and a nine-bit number may round; so r is taken from the rounded product, an error of 1e-16.
    let r = m * V::lookup(&INVERSE, sixteenth) - c(1.0);
    let s = r * r;
    let tail = c(-1.0 / 12.0);
    let tail = c(-1.0 / 10.0) + r * c(1.0 / 11.0) + s * tail;
    let tail = c(-1.0 / 8.0) + r * c(1.0 / 9.0) + s * tail;
    let tail = c(-1.0 / 6.0) + r * c(1.0 / 7.0) + s * tail;
    let tail = c(-1.0 / 4.0) + r * c(1.0 / 5.0) + s * tail;
    let tail = c(-1.0 / 2.0) + r * c(1.0 / 3.0) + s * tail;
    e * c(LN2_HIGH) + (V::lookup(&MINUS_LN_INVERSE, sixteenth) + (r + s * tail + e * c(LN2_LOW)))
}

/// As [`ln`], to the seven digits of single precision.
#[inline(always)]
pub(super) fn ln_single<V: Lanes>(x: V) -> V {
    let c = V::splat;
    let (e, m, sixteenth) = x.exponent_mantissa();
    let r = m * V::lookup(&INVERSE, sixteenth) - c(1.0);
    let tail = c(-1.0 / 4.0) + r * c(1.0 / 5.0);
    let tail = c(-1.0 / 2.0) + r * c(1.0 / 3.0) + r * r * tail;
    e * c(std::f64::consts::LN_2) + (V::lookup(&MINUS_LN_INVERSE, sixteenth) + (r + r * r * tail))
}

/// As [`exp_small`], to the seven digits of single precision.
#[inline(always)]
pub(super) fn exp_small_single<V: Number>(x: V) -> V {
    let (c, s) = (V::splat, x * x);
    let tail = c(1.0 / 720.0) + x * c(1.0 / 5040.0);
    let tail = c(1.0 / 24.0) + x * c(1.0 / 120.0) + s * tail;
    let tail = c(1.0 / 2.0) + x * c(1.0 / 6.0) + s * tail;
    c(1.0) + (x + s * tail)
}

/// As [`exp`], from −87 to 88, which single precision holds.
#[inline(always)]
pub(super) fn exp_single<V: Lanes>(x: V) -> V {
    let c = V::splat;
    let held = x.max(c(-87.0)).min(c(88.0));
    // Adding and taking away 1.5 2^23 rounds to a whole number.
    let k = (held * c(LOG2_E) + c(12_582_912.0)) - c(12_582_912.0);
    let power = exp_small_single(held - k * c(std::f64::consts::LN_2)) * k.power_of_two();
    let power = V::select(x.lt(c(-87.0)), c(0.0), power);
    V::select(c(88.0).lt(x), c(f64::INFINITY), power)
}

#[inline(always)]
pub(super) fn exp_small<V: Number>(x: V) -> V {
    let c = V::splat;
    let s = x * x;
    let tail = c(1.0 / 479_001_600.0) + x * c(1.0 / 6_227_020_800.0);
    let tail = c(1.0 / 3_628_800.0) + x * c(1.0 / 39_916_800.0) + s * tail;
    let tail = c(1.0 / 40_320.0) + x * c(1.0 / 362_880.0) + s * tail;
    let tail = c(1.0 / 720.0) + x * c(1.0 / 5040.0) + s * tail;
    let tail = c(1.0 / 24.0) + x * c(1.0 / 120.0) + s * tail;
    let tail = c(1.0 / 2.0) + x * c(1.0 / 6.0) + s * tail;
    c(1.0) + (x + s * tail)
}

/// x = k ln 2 + r with a whole k and |r| ≤ ln 2/2; e^r by its series.
#[inline(always)]
pub(super) fn exp<V: Lanes>(x: V) -> V {
    let c = V::splat;
    let held = x.max(c(-708.0)).min(c(709.0));
    // Adding and taking away 1.5 2^52 rounds to a whole number.
    let k = (held * c(LOG2_E) + c(WHOLE)) - c(WHOLE);
    let r = (held - k * c(LN2_HIGH)) - k * c(LN2_LOW);
    let power = exp_small(r) * k.power_of_two();
    let power = V::select(x.lt(c(-708.0)), c(0.0), power);
    V::select(c(709.0).lt(x), c(f64::INFINITY), power)
}

/// asin s = s + s z P(z) with z = s² ≤ 1/4; nearer to the ends acos x = 2 asin √((1 − |x|)/2), or π less that.
#[inline(always)]
pub(super) fn acos<V: Lanes>(x: V) -> V {
    let c = V::splat;
    let size = x.max(-x);
    let inner = size.lt(c(0.5));
    let half = (c(0.5) * (c(1.0) - size)).max(c(0.0));
    let z = V::select(inner, x * x, half);
    let s = V::select(inner, x, half.sqrt());
    let square = z * z;
    let mut sum = c(ASIN[12]);
    for k in (0..6).rev() {
        sum = (c(ASIN[2 * k]) + z * c(ASIN[2 * k + 1])) + square * sum;
    }
    let rest = s * z * sum;
    let sine = s + rest;
    let twice = sine + sine;
    let outer = V::select(x.lt(c(0.0)), c(PI) - (twice - c(PI_LOW)), twice);
    V::select(inner, c(FRAC_PI_2) - (s - (c(0.5 * PI_LOW) - rest)), outer)
}

/// 1.5 · 2^52
const WHOLE: f64 = 6_755_399_441_055_744.0;

/// π less `PI`
const PI_LOW: f64 = 1.224_646_799_147_353_2e-16;

/// P(z) = (asin √z/√z − 1)/z on 0 ≤ z ≤ 1/4, through Chebyshev points, found in sixty decimal digits; off by at most 1.5·10⁻¹⁷.
const ASIN: [f64; 13] = [
    0.166_666_666_666_666_69,
    0.074_999_999_999_984_33,
    0.044_642_857_146_355_43,
    0.030_381_944_138_531_247,
    0.022_372_172_942_149_89,
    0.017_352_392_720_869_973,
    0.013_971_212_973_552_933,
    0.011_479_177_415_184_906,
    0.010_322_814_350_185_78,
    0.005_457_506_718_640_358,
    0.017_400_879_442_694_02,
    -0.014_851_887_071_247_204,
    0.028_757_851_367_421_566,
];

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
