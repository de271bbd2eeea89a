//! Four numbers in an AVX2 register (`four`) and eight in an AVX-512 register (`eight`), what both have by one macro; and kernels compiled for either.

use std::arch::x86_64::*;
use std::fmt;
use std::ops::{Add, Div, Mul, Neg, Sub};

use super::{Kernel, Width};
use crate::real::{Job, Lanes, Number, functions_of_lanes};

mod eight;
mod four;

/// A hint about so many lines of memory, which may lie anywhere: no hint faults.
#[inline(always)]
pub fn fetch(from: *const i8, lines: usize) {
    for line in 0..lines {
        // Safety: nothing is read.
        unsafe { _mm_prefetch::<_MM_HINT_T0>(from.wrapping_add(64 * line)) }
    }
}

/// The caller has asked the processor for this width, which is not one.
pub fn run_side_by_side<K: Kernel>(width: Width, kernel: K) -> K::Output {
    match width {
        // Safety: the caller has found the instructions present.
        Width::Eight => unsafe { eight(kernel) },
        _ => unsafe { four(kernel) },
    }
}

#[target_feature(enable = "avx2")]
fn four<K: Kernel>(kernel: K) -> K::Output {
    kernel.run::<F64x4>()
}

#[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2")]
fn eight<K: Kernel>(kernel: K) -> K::Output {
    kernel.run::<F64x8>()
}

#[target_feature(enable = "avx2")]
#[inline(never)]
fn four_outlined<J: Job>(job: J) -> J::Output {
    job.run()
}

#[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2")]
#[inline(never)]
pub fn eight_outlined<J: Job>(job: J) -> J::Output {
    job.run()
}

/// Four numbers.
#[derive(Clone, Copy)]
#[repr(transparent)]
pub struct F64x4(__m256d);

/// Eight numbers.
#[derive(Clone, Copy)]
#[repr(transparent)]
pub struct F64x8(__m512d);

macro_rules! operator {
    ($type:ident, $trait:ident, $method:ident, $instruction:ident) => {
        impl $trait for $type {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                // Safety: see the module's page.
                Self(unsafe { $instruction(self.0, other.0) })
            }
        }
    };
}

macro_rules! number {
    ($type:ident, $lanes:literal, $splat:ident, $xor:ident) => {
        impl $type {
            fn array(self) -> [f64; $lanes] {
                // Safety: both are plain numbers of the same size.
                unsafe { std::mem::transmute(self) }
            }
            fn from_array(array: [f64; $lanes]) -> Self {
                // Safety: both are plain numbers of the same size.
                unsafe { std::mem::transmute(array) }
            }
        }
        impl fmt::Debug for $type {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                self.array().fmt(f)
            }
        }
        impl Neg for $type {
            type Output = Self;
            #[inline(always)]
            fn neg(self) -> Self {
                // Safety: see the module's page.
                Self(unsafe { $xor(self.0, $splat(-0.0)) })
            }
        }
    };
}

operator!(F64x4, Add, add, _mm256_add_pd);
operator!(F64x4, Sub, sub, _mm256_sub_pd);
operator!(F64x4, Mul, mul, _mm256_mul_pd);
operator!(F64x4, Div, div, _mm256_div_pd);
number!(F64x4, 4, _mm256_set1_pd, _mm256_xor_pd);
operator!(F64x8, Add, add, _mm512_add_pd);
operator!(F64x8, Sub, sub, _mm512_sub_pd);
operator!(F64x8, Mul, mul, _mm512_mul_pd);
operator!(F64x8, Div, div, _mm512_div_pd);
number!(F64x8, 8, _mm512_set1_pd, _mm512_xor_pd);

const MANTISSA: i64 = 0x000f_ffff_ffff_ffff;
const ONE: i64 = 0x3ff0_0000_0000_0000;
/// 2^52: an integer below it, put into its low bits, becomes that integer on subtraction.
const TWO_52: f64 = 4_503_599_627_370_496.0;
const TWO_52_BITS: i64 = 0x4330_0000_0000_0000;

/// Adds to two rows of four numbers, one after the other.
///
/// # Safety
/// The processor has AVX.
#[inline(always)]
unsafe fn add_to_two(rows: &mut [[f64; 4]], [a, b]: [usize; 2], [first, second]: [__m256d; 2]) {
    unsafe {
        let row = rows[a].as_mut_ptr();
        _mm256_storeu_pd(row, _mm256_add_pd(_mm256_loadu_pd(row), first));
        let row = rows[b].as_mut_ptr();
        _mm256_storeu_pd(row, _mm256_add_pd(_mm256_loadu_pd(row), second));
    }
}

/// The opposite numbers.
///
/// # Safety
/// The processor has AVX.
#[inline(always)]
unsafe fn opposite(row: __m256d) -> __m256d {
    unsafe { _mm256_xor_pd(row, _mm256_set1_pd(-0.0)) }
}

/// Columns as rows, one a lane.
///
/// # Safety
/// The processor has AVX.
#[inline(always)]
unsafe fn rows_of_four([x, y, z, w]: &[F64x4; 4]) -> [__m256d; 4] {
    unsafe {
        let (even, odd) = (_mm256_unpacklo_pd(x.0, y.0), _mm256_unpackhi_pd(x.0, y.0));
        let (even_too, odd_too) = (_mm256_unpacklo_pd(z.0, w.0), _mm256_unpackhi_pd(z.0, w.0));
        [
            _mm256_permute2f128_pd::<0x20>(even, even_too),
            _mm256_permute2f128_pd::<0x20>(odd, odd_too),
            _mm256_permute2f128_pd::<0x31>(even, even_too),
            _mm256_permute2f128_pd::<0x31>(odd, odd_too),
        ]
    }
}

/// Rows of four, row i and row i + 4 in one register, as columns.
///
/// # Safety
/// The processor has AVX-512.
#[inline(always)]
unsafe fn columns_of_halves([a, b, c, d]: [__m512d; 4]) -> [F64x8; 4] {
    unsafe {
        let (even, odd) = (_mm512_unpacklo_pd(a, b), _mm512_unpackhi_pd(a, b));
        let (even_too, odd_too) = (_mm512_unpacklo_pd(c, d), _mm512_unpackhi_pd(c, d));
        let (low, high) = (_mm512_setr_epi64(0, 1, 8, 9, 4, 5, 12, 13), _mm512_setr_epi64(2, 3, 10, 11, 6, 7, 14, 15));
        [
            F64x8(_mm512_permutex2var_pd(even, low, even_too)),
            F64x8(_mm512_permutex2var_pd(odd, low, odd_too)),
            F64x8(_mm512_permutex2var_pd(even, high, even_too)),
            F64x8(_mm512_permutex2var_pd(odd, high, odd_too)),
        ]
    }
}

/// Columns as rows, one a lane.
///
/// # Safety
/// The processor has AVX-512.
#[inline(always)]
unsafe fn rows_of_eight([x, y, z, w]: &[F64x8; 4]) -> [__m256d; 8] {
    unsafe {
        let (even, odd) = (_mm512_unpacklo_pd(x.0, y.0), _mm512_unpackhi_pd(x.0, y.0));
        let (even_too, odd_too) = (_mm512_unpacklo_pd(z.0, w.0), _mm512_unpackhi_pd(z.0, w.0));
        let (low, high) = (_mm512_setr_epi64(0, 1, 8, 9, 4, 5, 12, 13), _mm512_setr_epi64(2, 3, 10, 11, 6, 7, 14, 15));
        // Row i and row i + 4 in one register.
        let (a, b) = (_mm512_permutex2var_pd(even, low, even_too), _mm512_permutex2var_pd(odd, low, odd_too));
        let (c, d) = (_mm512_permutex2var_pd(even, high, even_too), _mm512_permutex2var_pd(odd, high, odd_too));
        [
            _mm512_castpd512_pd256(a),
            _mm512_castpd512_pd256(b),
            _mm512_castpd512_pd256(c),
            _mm512_castpd512_pd256(d),
            _mm512_extractf64x4_pd::<1>(a),
            _mm512_extractf64x4_pd::<1>(b),
            _mm512_extractf64x4_pd::<1>(c),
            _mm512_extractf64x4_pd::<1>(d),
        ]
    }
}
