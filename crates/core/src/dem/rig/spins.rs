//! Spins and torques: as many numbers a sphere as there are axes to turn about.

use std::ops::Range;

/// A spin, a torque or the like of every sphere, the numbers of one behind those of another.
#[derive(Clone, Debug)]
pub(super) struct Spins<const D: usize>(Vec<f64>);

impl<const D: usize> Spins<D> {
    /// Numbers a sphere: none on a line, one in the plane, about the axis out of it.
    pub const AXES: usize = match D {
        2 => 1,
        3 => 3,
        _ => 0,
    };

    /// The same as the length of a row to walk in, of which there are none on a line.
    pub const ROW: usize = if Self::AXES > 0 { Self::AXES } else { 1 };

    /// Of so many spheres, all zero.
    pub fn still(spheres: usize) -> Self {
        Self(vec![0.0; Self::AXES * spheres])
    }

    /// Of these, of which the components count that there are in `D` dimensions.
    pub fn of(rows: &[[f64; 3]]) -> Self {
        Self(rows.iter().flat_map(|row| row[axes_of_spin::<D>()].iter().copied()).collect())
    }

    /// Each times a factor of its sphere.
    pub fn times(&self, factors: &[f64]) -> Self {
        let mut product = self.clone();
        multiply::<D>(&mut product.0, factors);
        product
    }

    /// That of a sphere.
    #[inline(always)]
    pub fn get(&self, sphere: usize) -> [f64; 3] {
        let mut row = [0.0; 3];
        for (n, k) in axes_of_spin::<D>().enumerate() {
            row[k] = self.0[Self::AXES * sphere + n];
        }
        row
    }

    /// Puts another in the place of that of a sphere.
    #[inline(always)]
    pub fn set(&mut self, sphere: usize, row: &[f64; 3]) {
        for (n, k) in axes_of_spin::<D>().enumerate() {
            self.0[Self::AXES * sphere + n] = row[k];
        }
    }

    /// Adds a multiple to that of a sphere.
    #[inline(always)]
    pub fn add(&mut self, sphere: usize, factor: f64, row: &[f64; 3]) {
        add::<D>(&mut self.0, sphere, factor, row);
    }

    /// All numbers.
    pub fn numbers(&self) -> &[f64] {
        &self.0
    }

    /// All numbers.
    pub fn numbers_mut(&mut self) -> &mut [f64] {
        &mut self.0
    }
}

/// The components of a spin that there are in `D` dimensions.
#[inline(always)]
fn axes_of_spin<const D: usize>() -> Range<usize> {
    match D {
        2 => 2..3,
        3 => 0..3,
        _ => 0..0,
    }
}

/// Adds a multiple to that of a sphere, in the numbers of some spheres.
#[inline(always)]
pub(super) fn add<const D: usize>(numbers: &mut [f64], sphere: usize, factor: f64, row: &[f64; 3]) {
    for (n, k) in axes_of_spin::<D>().enumerate() {
        numbers[Spins::<D>::AXES * sphere + n] += factor * row[k];
    }
}

/// Multiplies each by a factor of its sphere, in the numbers of some spheres.
#[inline(always)]
pub(super) fn multiply<const D: usize>(numbers: &mut [f64], factors: &[f64]) {
    for (row, factor) in numbers.chunks_exact_mut(Spins::<D>::ROW).zip(factors) {
        row.iter_mut().for_each(|number| *number *= factor);
    }
}
