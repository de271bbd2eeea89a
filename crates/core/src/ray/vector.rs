//! Points and directions in the plane of the rays.

use std::ops::{Add, AddAssign, Div, Mul, Neg, Sub};

/// (x, z): distance from the axis and depth, here called x and y.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Vector2 {
    /// Distance from the axis.
    pub x: f64,
    /// Depth.
    pub y: f64,
}

impl Vector2 {
    /// From its components.
    pub const fn new(x: f64, y: f64) -> Self {
        Self { x, y }
    }

    /// The unit vector along depth.
    pub const fn y() -> Self {
        Self { x: 0.0, y: 1.0 }
    }

    /// a·b
    pub fn dot(&self, other: &Self) -> f64 {
        self.x * other.x + self.y * other.y
    }

    /// |a|²
    pub fn norm_squared(&self) -> f64 {
        self.dot(self)
    }

    /// |a|
    pub fn norm(&self) -> f64 {
        self.norm_squared().sqrt()
    }

    /// a/|a|
    #[must_use]
    pub fn normalize(&self) -> Self {
        *self / self.norm()
    }
}

impl From<[f64; 2]> for Vector2 {
    fn from([x, y]: [f64; 2]) -> Self {
        Self { x, y }
    }
}

impl From<Vector2> for [f64; 2] {
    fn from(Vector2 { x, y }: Vector2) -> Self {
        [x, y]
    }
}

impl AddAssign for Vector2 {
    fn add_assign(&mut self, other: Self) {
        *self = *self + other;
    }
}

impl Add for Vector2 {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self { x: self.x + other.x, y: self.y + other.y }
    }
}

impl Sub for Vector2 {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self { x: self.x - other.x, y: self.y - other.y }
    }
}

impl Neg for Vector2 {
    type Output = Self;
    fn neg(self) -> Self {
        Self { x: -self.x, y: -self.y }
    }
}

impl Mul<f64> for Vector2 {
    type Output = Self;
    fn mul(self, factor: f64) -> Self {
        Self { x: self.x * factor, y: self.y * factor }
    }
}

impl Div<f64> for Vector2 {
    type Output = Self;
    fn div(self, divisor: f64) -> Self {
        Self { x: self.x / divisor, y: self.y / divisor }
    }
}
