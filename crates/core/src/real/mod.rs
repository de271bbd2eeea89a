//! The number that the physics is written in: one design's `f64`, several designs side by side, or a number with derivatives.
//!
//! Contact laws are generic over [`Number`], the stepper over [`Lanes`], so that one page of physics serves one design, in the lanes
//! of a vector register four or eight designs on one lattice, and with [`Dual`] its derivatives. Only operations whose result
//! IEEE 754 fixes to the last bit are used (sums, products, quotients, roots, comparisons, exponents), never fused;
//! logarithm, exponential and arc cosine are built from them here. So every width gives the same bits, and results do not depend on
//! a platform's mathematical library.
//!
//! - `functions`: logarithm, exponential and arc cosine from basic operations
//! - `lanes`: four and eight designs in AVX2 and AVX-512 registers, sixteen in single precision, and the choice between them
//! - `dual`: a number and its derivatives

mod dual;
mod functions;
mod lanes;

pub use dual::Dual;
pub use lanes::{Kernel, Width, fetch_ahead};

use std::fmt::Debug;
use std::ops::{Add, Div, Mul, Neg, Sub};

/// A number as contact laws need it: one, several side by side that are computed alike, or one that carries derivatives.
///
/// Where a number carries derivatives, comparisons look at its value, `select`, `min` and `max` pass on the derivatives of what they
/// choose, and functions with a vertical tangent have the derivative 0 there: sqrt'(0) = 0, acos'(±1) = 0. A law may therefore take the root of
/// what has been cut at zero.
pub trait Number:
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

    /// The same number everywhere, a constant.
    fn splat(value: f64) -> Self;
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
    /// Both masks.
    fn and(a: Self::Mask, b: Self::Mask) -> Self::Mask;
    /// Whether the mask holds anywhere.
    fn any(mask: Self::Mask) -> bool;
    /// Whether the mask holds everywhere.
    fn all(mask: Self::Mask) -> bool;
    /// Natural logarithm of a positive normal number, to about 2 units in the last place of max(|ln x|, 1).
    fn ln(self) -> Self;
    /// e to the power x, to 3 units in the last place; 0 below −708, infinite above 709.
    fn exp(self) -> Self;
    /// Arc cosine, to 4·10⁻¹⁶; that of the nearer end outside −1 to 1.
    fn acos(self) -> Self;

    /// exp(x) for −0.35 ≤ x ≤ 0.5, to 10⁻¹⁵: the Taylor series to x¹³.
    #[inline(always)]
    fn exp_small(self) -> Self {
        functions::exp_small(self)
    }
}

/// Numbers side by side, as the registers hold them: lane k belongs to design k.
pub trait Lanes: Number {
    /// A place in a table, one per number.
    type Index: Copy;
    /// How many designs stand side by side.
    const LANES: usize;
    /// Whether numbers have single precision: seven digits, from 10⁻³⁸ to 10³⁸.
    const IS_SINGLE: bool = false;

    /// One of the numbers.
    fn lane(self, lane: usize) -> f64;
    /// The greatest of the numbers, and of 0; those that are none do not count.
    #[inline(always)]
    fn greatest(self) -> f64 {
        let mut greatest = 0.0;
        for lane in 0..Self::LANES {
            let one = self.lane(lane);
            greatest = if one > greatest { one } else { greatest };
        }
        greatest
    }
    /// Replaces one of the numbers.
    fn set_lane(&mut self, lane: usize, value: f64);
    /// The first numbers of a slice; it must hold as many.
    fn load(from: &[f64]) -> Self;
    /// Writes the numbers to the start of a slice.
    fn store(self, to: &mut [f64]);
    /// The numbers moved one place on; into the first place comes the last one of `before`.
    fn after(self, before: Self) -> Self;
    /// Rows of four, at least one per lane, as columns: number k of each row stands in column k.
    fn columns(rows: &[&[f64; 4]]) -> [Self; 4];
    /// The differences a − b of such rows as columns.
    #[inline(always)]
    fn columns_apart(a: &[&[f64; 4]], b: &[&[f64; 4]]) -> [Self; 4] {
        let (mut apart, from) = (Self::columns(a), Self::columns(b));
        for k in 0..4 {
            apart[k] = apart[k] - from[k];
        }
        apart
    }
    /// Adds columns to rows of four: lane after lane, `first` to the row in the first of the lane's two places, then `second` to that in the second.
    #[inline(always)]
    fn add_to_rows(first: &[Self; 4], second: &[Self; 4], places: &[[usize; 2]], rows: &mut [[f64; 4]]) {
        for lane in 0..Self::LANES {
            for (columns, place) in [first, second].into_iter().zip(places[lane]) {
                for k in 0..4 {
                    rows[place][k] += columns[k].lane(lane);
                }
            }
        }
    }
    /// As [`add_to_rows`](Self::add_to_rows), of what is taken from one row and given to the other.
    #[inline(always)]
    fn exchange(columns: &[Self; 4], places: &[[usize; 2]], rows: &mut [[f64; 4]]) {
        let mut taken = *columns;
        for k in 0..4 {
            taken[k] = -columns[k];
        }
        Self::add_to_rows(&taken, columns, places, rows);
    }
    /// The first rows of three of a slice, one per lane, as columns; it must hold as many numbers.
    #[inline(always)]
    fn load_threes(from: &[f64]) -> [Self; 3] {
        let mut columns = [[0.0; 16]; 3];
        for lane in 0..Self::LANES {
            for k in 0..3 {
                columns[k][lane] = from[3 * lane + k];
            }
        }
        [Self::load(&columns[0]), Self::load(&columns[1]), Self::load(&columns[2])]
    }
    /// Writes columns as rows of three to the start of a slice.
    #[inline(always)]
    fn store_threes(columns: &[Self; 3], to: &mut [f64]) {
        let mut stored = [[0.0; 16]; 3];
        for k in 0..3 {
            columns[k].store(&mut stored[k]);
        }
        for lane in 0..Self::LANES {
            for k in 0..3 {
                to[3 * lane + k] = stored[k][lane];
            }
        }
    }
    /// Places from bytes below 16, one per number.
    fn index(places: &[u8]) -> Self::Index;
    /// The entries at given places.
    fn lookup(table: &[f64; 16], place: Self::Index) -> Self;
    /// Writes a positive normal number as m 2^e with m in [1, 2); gives e, m, and in which sixteenth of [1, 2) m lies.
    fn exponent_mantissa(self) -> (Self, Self, Self::Index);
    /// 2 to the power of a whole number from −1022 to 1023.
    fn power_of_two(self) -> Self;
    /// Does a job in a function of its own, compiled for this width's instructions.
    fn outlined<J: Job>(job: J) -> J::Output;
}

/// Something to compute in a function of its own; see [`Lanes::outlined`].
pub trait Job {
    /// What comes out.
    type Output;
    /// Computes it. Must be `#[inline(always)]`, as must be all it calls.
    fn run(self) -> Self::Output;
}

/// How a register takes its functions from `functions`.
macro_rules! functions_of_lanes {
    () => {
        #[inline(always)]
        fn ln(self) -> Self {
            $crate::real::functions::ln(self)
        }
        #[inline(always)]
        fn exp(self) -> Self {
            $crate::real::functions::exp(self)
        }
        #[inline(always)]
        fn acos(self) -> Self {
            $crate::real::functions::acos(self)
        }
    };
}
use functions_of_lanes;

impl Number for f64 {
    type Mask = bool;

    #[inline(always)]
    fn splat(value: f64) -> Self {
        value
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
    fn and(a: bool, b: bool) -> bool {
        a && b
    }
    #[inline(always)]
    fn any(mask: bool) -> bool {
        mask
    }
    #[inline(always)]
    fn all(mask: bool) -> bool {
        mask
    }
    functions_of_lanes!();
}

impl Lanes for f64 {
    type Index = usize;
    const LANES: usize = 1;

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
    fn columns(rows: &[&[f64; 4]]) -> [Self; 4] {
        *rows[0]
    }
    #[inline(always)]
    fn load_threes(from: &[f64]) -> [Self; 3] {
        [from[0], from[1], from[2]]
    }
    #[inline(always)]
    fn store_threes(columns: &[Self; 3], to: &mut [f64]) {
        to[..3].copy_from_slice(columns);
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
    #[inline(always)]
    fn power_of_two(self) -> Self {
        f64::from_bits(((self as i64 + 1023) as u64) << 52)
    }
    #[inline(never)]
    fn outlined<J: Job>(job: J) -> J::Output {
        job.run()
    }
}

#[cfg(test)]
mod tests {
    use super::Number;

    /// Against the platform's library, itself good to one unit in the last place.
    #[test]
    fn functions_are_exact_to_rounding() {
        for k in 0..20_000 {
            let x = 1e-12 * 1.004_f64.powi(k % 14_000) * (1.0 + f64::from(k) * 1e-6);
            let (ours, library) = (Number::ln(x), f64::ln(x));
            assert!((ours - library).abs() <= 4.5e-16 * library.abs().max(1.0), "ln {x}: {ours} and {library}");
            let y = f64::from(k) / 40_000.0;
            assert!((y.exp_small() / y.exp() - 1.0).abs() < 1e-15, "exp {y}");
            let wide = -700.0 + 0.07 * f64::from(k);
            assert!((Number::exp(wide) / f64::exp(wide) - 1.0).abs() < 7e-16, "exp {wide}");
            let cosine = -1.0 + f64::from(k) / 9_999.5;
            let (ours, library) = (Number::acos(cosine), f64::acos(cosine));
            assert!((ours - library).abs() <= 4.5e-16 * library.max(1.0), "acos {cosine}: {ours} and {library}");
        }
        assert_eq!(Number::ln(1.0), 0.0);
        assert_eq!((Number::exp(0.0), Number::exp(-800.0), Number::exp(720.0)), (1.0, 0.0, f64::INFINITY));
        assert_eq!((Number::acos(1.0), Number::acos(2.0)), (0.0, 0.0));
        assert_eq!((Number::acos(-1.0), Number::acos(0.0)), (std::f64::consts::PI, std::f64::consts::FRAC_PI_2));
    }
}
