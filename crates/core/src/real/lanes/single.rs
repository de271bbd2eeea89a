//! Sixteen numbers of single precision in an AVX-512 register: for screening, where a percent is enough. What comes of them is no other width's bits.

use std::arch::x86_64::*;
use std::fmt;
use std::ops::{Add, Div, Mul, Neg, Sub};

use crate::real::{Job, Lanes, Number, functions};

/// Sixteen numbers.
#[derive(Clone, Copy)]
#[repr(transparent)]
pub struct F32x16(__m512);

impl F32x16 {
    fn array(self) -> [f32; 16] {
        // Safety: both are plain numbers of the same size.
        unsafe { std::mem::transmute(self) }
    }
}

impl fmt::Debug for F32x16 {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.array().fmt(f)
    }
}

macro_rules! operator {
    ($trait:ident, $method:ident, $instruction:ident) => {
        impl $trait for F32x16 {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self {
                // Safety: see the module's page.
                Self(unsafe { $instruction(self.0, other.0) })
            }
        }
    };
}

operator!(Add, add, _mm512_add_ps);
operator!(Sub, sub, _mm512_sub_ps);
operator!(Mul, mul, _mm512_mul_ps);
operator!(Div, div, _mm512_div_ps);

impl Neg for F32x16 {
    type Output = Self;
    #[inline(always)]
    fn neg(self) -> Self {
        // Safety: see the module's page.
        Self(unsafe { _mm512_xor_ps(self.0, _mm512_set1_ps(-0.0)) })
    }
}

// Safety of every block below: see the module's page. Slices are checked to be long enough.
impl Number for F32x16 {
    type Mask = __mmask16;

    #[inline(always)]
    fn splat(value: f64) -> Self {
        Self(unsafe { _mm512_set1_ps(value as f32) })
    }
    #[inline(always)]
    fn sqrt(self) -> Self {
        Self(unsafe { _mm512_sqrt_ps(self.0) })
    }
    #[inline(always)]
    fn min(self, other: Self) -> Self {
        Self(unsafe { _mm512_min_ps(self.0, other.0) })
    }
    #[inline(always)]
    fn max(self, other: Self) -> Self {
        Self(unsafe { _mm512_max_ps(self.0, other.0) })
    }
    #[inline(always)]
    fn lt(self, other: Self) -> __mmask16 {
        unsafe { _mm512_cmp_ps_mask::<_CMP_LT_OQ>(self.0, other.0) }
    }
    #[inline(always)]
    fn select(mask: __mmask16, yes: Self, no: Self) -> Self {
        Self(unsafe { _mm512_mask_blend_ps(mask, no.0, yes.0) })
    }
    #[inline(always)]
    fn or(a: __mmask16, b: __mmask16) -> __mmask16 {
        a | b
    }
    #[inline(always)]
    fn and(a: __mmask16, b: __mmask16) -> __mmask16 {
        a & b
    }
    #[inline(always)]
    fn any(mask: __mmask16) -> bool {
        mask != 0
    }
    #[inline(always)]
    fn all(mask: __mmask16) -> bool {
        mask == u16::MAX
    }
    #[inline(always)]
    fn ln(self) -> Self {
        functions::ln_single(self)
    }
    #[inline(always)]
    fn exp(self) -> Self {
        functions::exp_single(self)
    }
    #[inline(always)]
    fn acos(self) -> Self {
        functions::acos(self)
    }
    #[inline(always)]
    fn exp_small(self) -> Self {
        functions::exp_small_single(self)
    }
}

impl Lanes for F32x16 {
    type Index = __m512i;
    const LANES: usize = 16;
    const IS_SINGLE: bool = true;

    #[inline(always)]
    fn lane(self, lane: usize) -> f64 {
        f64::from(self.array()[lane])
    }
    fn set_lane(&mut self, lane: usize, value: f64) {
        let mut array = self.array();
        array[lane] = value as f32;
        // Safety: both are plain numbers of the same size.
        *self = unsafe { std::mem::transmute::<[f32; 16], Self>(array) };
    }
    #[inline(always)]
    fn load(from: &[f64]) -> Self {
        let from = &from[..16];
        unsafe {
            let low = _mm512_cvtpd_ps(_mm512_loadu_pd(from.as_ptr()));
            let high = _mm512_cvtpd_ps(_mm512_loadu_pd(from.as_ptr().add(8)));
            Self(_mm512_insertf32x8::<1>(_mm512_castps256_ps512(low), high))
        }
    }
    #[inline(always)]
    fn store(self, to: &mut [f64]) {
        let to = &mut to[..16];
        unsafe {
            _mm512_storeu_pd(to.as_mut_ptr(), _mm512_cvtps_pd(_mm512_castps512_ps256(self.0)));
            _mm512_storeu_pd(to.as_mut_ptr().add(8), _mm512_cvtps_pd(_mm512_extractf32x8_ps::<1>(self.0)));
        }
    }
    #[inline(always)]
    fn after(self, before: Self) -> Self {
        unsafe {
            let (before, own) = (_mm512_castps_si512(before.0), _mm512_castps_si512(self.0));
            Self(_mm512_castsi512_ps(_mm512_alignr_epi32::<15>(own, before)))
        }
    }
    #[inline(always)]
    fn columns(rows: &[&[f64; 4]]) -> [Self; 4] {
        let mut columns = [[0.0; 16]; 4];
        for lane in 0..16 {
            for k in 0..4 {
                columns[k][lane] = rows[lane][k];
            }
        }
        [Self::load(&columns[0]), Self::load(&columns[1]), Self::load(&columns[2]), Self::load(&columns[3])]
    }
    #[inline(always)]
    fn index(places: &[u8]) -> __m512i {
        let places = &places[..16];
        unsafe { _mm512_cvtepu8_epi32(_mm_loadu_si128(places.as_ptr().cast())) }
    }
    #[inline(always)]
    fn lookup(table: &[f64; 16], place: __m512i) -> Self {
        // The permutation looks at the low four bits of a place only.
        unsafe { Self(_mm512_permutexvar_ps(place, Self::load(table).0)) }
    }
    #[inline(always)]
    fn exponent_mantissa(self) -> (Self, Self, __m512i) {
        unsafe {
            let bits = _mm512_castps_si512(self.0);
            let exponent = _mm512_sub_epi32(_mm512_srli_epi32::<23>(bits), _mm512_set1_epi32(127));
            let mantissa = _mm512_and_si512(bits, _mm512_set1_epi32(0x007f_ffff));
            let mantissa = _mm512_or_si512(mantissa, _mm512_set1_epi32(0x3f80_0000));
            let place = _mm512_srli_epi32::<19>(bits);
            (Self(_mm512_cvtepi32_ps(exponent)), Self(_mm512_castsi512_ps(mantissa)), place)
        }
    }
    #[inline(always)]
    fn power_of_two(self) -> Self {
        unsafe {
            let bits = _mm512_add_epi32(_mm512_cvtps_epi32(self.0), _mm512_set1_epi32(127));
            Self(_mm512_castsi512_ps(_mm512_slli_epi32::<23>(bits)))
        }
    }
    #[inline(always)]
    fn outlined<J: Job>(job: J) -> J::Output {
        unsafe { super::x86::eight_outlined(job) }
    }
}

/// Runs a kernel in single precision; the caller has asked the processor for the width of eight doubles.
pub fn run<K: super::Kernel>(kernel: K) -> K::Output {
    #[target_feature(enable = "avx512f,avx512dq,avx512vl,avx2")]
    fn sixteen<K: super::Kernel>(kernel: K) -> K::Output {
        kernel.run::<F32x16>()
    }
    // Safety: the caller has found the instructions present.
    unsafe { sixteen(kernel) }
}
