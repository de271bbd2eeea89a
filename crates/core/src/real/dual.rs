//! A number and its derivatives: automatic differentiation in forward mode.

use std::ops::{Add, Div, Mul, Neg, Sub};

use super::Number;

/// A value and its derivatives with respect to N quantities, which every operation carries along by the rules of calculus. The value's
/// bits are those of the plain computation. Where a function has no derivative, that of the branch taken stands; see [`Number`].
///
/// ```
/// use granulens_core::real::{Dual, Number};
/// let x = Dual::<f64, 1>::variable(2.0, 0);
/// let y = x * x * x;
/// assert_eq!((y.value, y.slopes[0]), (8.0, 12.0));
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Dual<V, const N: usize> {
    /// The value.
    pub value: V,
    /// Its derivatives.
    pub slopes: [V; N],
}

impl<V: Number, const N: usize> Dual<V, N> {
    /// The quantity number `which` itself: its derivative with respect to itself is one.
    #[inline(always)]
    pub fn variable(value: V, which: usize) -> Self {
        let mut slopes = [V::splat(0.0); N];
        slopes[which] = V::splat(1.0);
        Self { value, slopes }
    }

    /// A number that depends on nothing.
    #[inline(always)]
    pub fn constant(value: V) -> Self {
        Self { value, slopes: [V::splat(0.0); N] }
    }

    /// A function's value, with its derivative with respect to this number.
    #[inline(always)]
    fn chain(self, value: V, derivative: V) -> Self {
        let mut slopes = self.slopes;
        for slope in &mut slopes {
            *slope = *slope * derivative;
        }
        Self { value, slopes }
    }

    #[inline(always)]
    fn both(self, other: Self, value: V, join: impl Fn(V, V) -> V) -> Self {
        let mut slopes = self.slopes;
        for k in 0..N {
            slopes[k] = join(self.slopes[k], other.slopes[k]);
        }
        Self { value, slopes }
    }
}

impl<V: Number, const N: usize> Add for Dual<V, N> {
    type Output = Self;
    #[inline(always)]
    fn add(self, other: Self) -> Self {
        self.both(other, self.value + other.value, |a, b| a + b)
    }
}

impl<V: Number, const N: usize> Sub for Dual<V, N> {
    type Output = Self;
    #[inline(always)]
    fn sub(self, other: Self) -> Self {
        self.both(other, self.value - other.value, |a, b| a - b)
    }
}

#[expect(clippy::suspicious_arithmetic_impl, reason = "the rules for products and quotients")]
impl<V: Number, const N: usize> Mul for Dual<V, N> {
    type Output = Self;
    #[inline(always)]
    fn mul(self, other: Self) -> Self {
        self.both(other, self.value * other.value, |a, b| a * other.value + self.value * b)
    }
}

#[expect(clippy::suspicious_arithmetic_impl, reason = "the rules for products and quotients")]
impl<V: Number, const N: usize> Div for Dual<V, N> {
    type Output = Self;
    #[inline(always)]
    fn div(self, other: Self) -> Self {
        let quotient = self.value / other.value;
        self.both(other, quotient, |a, b| (a - quotient * b) / other.value)
    }
}

impl<V: Number, const N: usize> Neg for Dual<V, N> {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        let mut slopes = self.slopes;
        for slope in &mut slopes {
            *slope = -*slope;
        }
        Self { value: -self.value, slopes }
    }
}

impl<V: Number, const N: usize> Number for Dual<V, N> {
    type Mask = V::Mask;

    #[inline(always)]
    fn splat(value: f64) -> Self {
        Self::constant(V::splat(value))
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        let root = self.value.sqrt();
        let positive = V::splat(0.0).lt(root);
        // No infinity is formed that a zero slope would turn into NaN.
        let divisor = V::select(positive, root + root, V::splat(1.0));
        self.chain(root, V::select(positive, V::splat(1.0) / divisor, V::splat(0.0)))
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self::select(self.value.lt(other.value), self, other)
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self::select(other.value.lt(self.value), self, other)
    }
    #[inline(always)]
    fn lt(self, other: Self) -> V::Mask {
        self.value.lt(other.value)
    }
    #[inline(always)]
    fn select(mask: V::Mask, yes: Self, no: Self) -> Self {
        yes.both(no, V::select(mask, yes.value, no.value), |a, b| V::select(mask, a, b))
    }
    #[inline(always)]
    fn or(a: V::Mask, b: V::Mask) -> V::Mask {
        V::or(a, b)
    }
    #[inline(always)]
    fn and(a: V::Mask, b: V::Mask) -> V::Mask {
        V::and(a, b)
    }
    #[inline(always)]
    fn any(mask: V::Mask) -> bool {
        V::any(mask)
    }
    #[inline(always)]
    fn all(mask: V::Mask) -> bool {
        V::all(mask)
    }
    #[inline(always)]
    fn ln(self) -> Self {
        self.chain(self.value.ln(), V::splat(1.0) / self.value)
    }
    #[inline(always)]
    fn exp(self) -> Self {
        let power = self.value.exp();
        self.chain(power, power)
    }
    #[inline(always)]
    fn acos(self) -> Self {
        let one = V::splat(1.0);
        let square = (one - self.value) * (one + self.value);
        let inside = V::splat(0.0).lt(square);
        let slope = -(one / V::select(inside, square, one).sqrt());
        self.chain(self.value.acos(), V::select(inside, slope, V::splat(0.0)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Each function's derivative against a central difference, whose error is some 10⁻⁹ at a step of 10⁻⁵.
    #[test]
    fn derivatives_are_slopes() {
        type One = Dual<f64, 1>;
        let functions: [fn(One) -> One; 6] = [
            |x| x.sqrt(),
            |x| x.ln(),
            |x| x.exp(),
            |x| x.acos(),
            |x| One::splat(1.0) / (x * x - One::splat(3.0)),
            |x| x.exp_small().max(x * x) - x.min(One::splat(0.2)),
        ];
        for function in functions {
            for k in 1..50 {
                let x = 0.0099 + 0.0099 * f64::from(k);
                let at = |x: f64| function(One::variable(x, 0));
                let difference = (at(x + 1e-5).value - at(x - 1e-5).value) / 2e-5;
                assert!((at(x).slopes[0] - difference).abs() < 1e-6 * (1.0 + difference.abs()), "at {x}");
            }
        }
    }

    /// The contract where tangents are vertical.
    #[test]
    fn vertical_tangents_have_no_slope() {
        let of = |value| Dual::<f64, 1>::variable(value, 0);
        assert_eq!((of(0.0).sqrt().slopes, of(1.0).acos().slopes, of(-1.0).acos().slopes), ([0.0], [0.0], [0.0]));
        assert_eq!((of(-2.0).max(Dual::splat(0.0)).sqrt()), Dual::constant(0.0));
    }
}
