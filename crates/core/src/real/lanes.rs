//! Four and eight numbers in AVX2 and AVX-512 registers: the one module with unsafe code.
//!
//! Everything unsafe here is a call of a vector instruction. Its only precondition is that the processor has it, and the
//! types below are made by [`Width::run`] alone, which has asked the processor.

/// How many designs stand side by side in one register.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Width {
    /// One at a time; every processor can.
    Scalar,
    /// Four, AVX2.
    Four,
    /// Eight, AVX-512.
    Eight,
}

/// Something to compute with numbers of whichever width.
pub trait Kernel {
    /// What comes out.
    type Output;
    /// Computes it. Must be `#[inline(always)]`, as must be all it calls in its hot part: only then is it compiled for the
    /// width's instructions.
    fn run<V: super::Lanes>(self) -> Self::Output;
}

impl Width {
    /// Number of designs.
    pub const fn lanes(self) -> usize {
        match self {
            Self::Scalar => 1,
            Self::Four => 4,
            Self::Eight => 8,
        }
    }

    /// Those that this processor has, widest last.
    pub fn available() -> Vec<Self> {
        [Self::Scalar, Self::Four, Self::Eight].into_iter().filter(|width| width.is_available()).collect()
    }

    /// Whether this processor has it.
    pub fn is_available(self) -> bool {
        match self {
            Self::Scalar => true,
            #[cfg(target_arch = "x86_64")]
            Self::Four => is_x86_feature_detected!("avx2"),
            #[cfg(target_arch = "x86_64")]
            Self::Eight => {
                is_x86_feature_detected!("avx512f")
                    && is_x86_feature_detected!("avx512dq")
                    && is_x86_feature_detected!("avx512vl")
            }
            #[cfg(not(target_arch = "x86_64"))]
            Self::Four | Self::Eight => false,
        }
    }

    /// The widest that this processor has.
    pub fn widest() -> Self {
        Self::available().last().copied().unwrap_or(Self::Scalar)
    }

    /// Runs a kernel at this width in registers, for which alone it is compiled. None where there are none: one design at a time, or a
    /// width that the processor lacks.
    pub fn run_side_by_side<K: Kernel>(self, kernel: K) -> Option<K::Output> {
        #[cfg(target_arch = "x86_64")]
        if self.is_available() && self != Self::Scalar {
            return Some(x86::run_side_by_side(self, kernel));
        }
        let _ = kernel;
        None
    }

    /// Runs a kernel with sixteen numbers of single precision. None where the processor lacks them.
    pub fn run_in_single<K: Kernel>(kernel: K) -> Option<K::Output> {
        #[cfg(target_arch = "x86_64")]
        if Self::Eight.is_available() {
            return Some(single::run(kernel));
        }
        let _ = kernel;
        None
    }

    /// Runs a kernel at this width, or one design at a time where the processor lacks it. The bits are the same.
    pub fn run<K: Kernel>(self, kernel: K) -> K::Output {
        #[cfg(target_arch = "x86_64")]
        if self.is_available() && self != Self::Scalar {
            return x86::run_side_by_side(self, kernel);
        }
        kernel.run::<f64>()
    }
}

/// Asks for the lines of memory in which some bytes of a slice from a place on lie, if there are such, so that they are at hand when they are read.
#[inline(always)]
pub fn fetch_ahead<T>(slice: &[T], place: usize, bytes: usize) {
    #[cfg(target_arch = "x86_64")]
    if place < slice.len() {
        x86::fetch(slice[place..].as_ptr().cast(), bytes.div_ceil(64));
    }
}

#[cfg(target_arch = "x86_64")]
#[expect(unsafe_code, reason = "vector instructions; see the module's page")]
mod single;

#[cfg(target_arch = "x86_64")]
#[expect(unsafe_code, reason = "vector instructions; see the module's page")]
mod x86 {
    use std::arch::x86_64::*;
    use std::fmt;
    use std::ops::{Add, Div, Mul, Neg, Sub};

    use super::{Kernel, Width};
    use crate::real::{Job, Lanes, Number, functions_of_lanes};

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
            let (low, high) =
                (_mm512_setr_epi64(0, 1, 8, 9, 4, 5, 12, 13), _mm512_setr_epi64(2, 3, 10, 11, 6, 7, 14, 15));
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
            let (low, high) =
                (_mm512_setr_epi64(0, 1, 8, 9, 4, 5, 12, 13), _mm512_setr_epi64(2, 3, 10, 11, 6, 7, 14, 15));
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

    // Safety of every block below: see the module's page. Slices are checked to be long enough.
    impl Number for F64x4 {
        type Mask = __m256d;

        #[inline(always)]
        fn splat(value: f64) -> Self {
            Self(unsafe { _mm256_set1_pd(value) })
        }
        #[inline(always)]
        fn sqrt(self) -> Self {
            Self(unsafe { _mm256_sqrt_pd(self.0) })
        }
        #[inline(always)]
        fn min(self, other: Self) -> Self {
            Self(unsafe { _mm256_min_pd(self.0, other.0) })
        }
        #[inline(always)]
        fn max(self, other: Self) -> Self {
            Self(unsafe { _mm256_max_pd(self.0, other.0) })
        }
        #[inline(always)]
        fn lt(self, other: Self) -> __m256d {
            unsafe { _mm256_cmp_pd::<_CMP_LT_OQ>(self.0, other.0) }
        }
        #[inline(always)]
        fn select(mask: __m256d, yes: Self, no: Self) -> Self {
            Self(unsafe { _mm256_blendv_pd(no.0, yes.0, mask) })
        }
        #[inline(always)]
        fn or(a: __m256d, b: __m256d) -> __m256d {
            unsafe { _mm256_or_pd(a, b) }
        }
        #[inline(always)]
        fn and(a: __m256d, b: __m256d) -> __m256d {
            unsafe { _mm256_and_pd(a, b) }
        }
        #[inline(always)]
        fn any(mask: __m256d) -> bool {
            unsafe { _mm256_movemask_pd(mask) != 0 }
        }
        #[inline(always)]
        fn all(mask: __m256d) -> bool {
            unsafe { _mm256_movemask_pd(mask) == 15 }
        }
        functions_of_lanes!();
    }

    impl Lanes for F64x4 {
        type Index = __m128i;
        const LANES: usize = 4;

        #[inline(always)]
        fn lane(self, lane: usize) -> f64 {
            self.array()[lane]
        }
        fn set_lane(&mut self, lane: usize, value: f64) {
            let mut array = self.array();
            array[lane] = value;
            *self = Self::from_array(array);
        }
        #[inline(always)]
        fn load(from: &[f64]) -> Self {
            let from = &from[..4];
            Self(unsafe { _mm256_loadu_pd(from.as_ptr()) })
        }
        #[inline(always)]
        fn store(self, to: &mut [f64]) {
            let to = &mut to[..4];
            unsafe { _mm256_storeu_pd(to.as_mut_ptr(), self.0) }
        }
        #[inline(always)]
        fn after(self, before: Self) -> Self {
            unsafe {
                let middle = _mm256_permute2f128_pd::<0x21>(before.0, self.0);
                Self(_mm256_shuffle_pd::<0b0101>(middle, self.0))
            }
        }
        #[inline(always)]
        fn columns(rows: &[&[f64; 4]]) -> [Self; 4] {
            let rows = &rows[..4];
            unsafe {
                let (a, b) = (_mm256_loadu_pd(rows[0].as_ptr()), _mm256_loadu_pd(rows[1].as_ptr()));
                let (c, d) = (_mm256_loadu_pd(rows[2].as_ptr()), _mm256_loadu_pd(rows[3].as_ptr()));
                let (even, odd) = (_mm256_unpacklo_pd(a, b), _mm256_unpackhi_pd(a, b));
                let (even_too, odd_too) = (_mm256_unpacklo_pd(c, d), _mm256_unpackhi_pd(c, d));
                [
                    Self(_mm256_permute2f128_pd::<0x20>(even, even_too)),
                    Self(_mm256_permute2f128_pd::<0x20>(odd, odd_too)),
                    Self(_mm256_permute2f128_pd::<0x31>(even, even_too)),
                    Self(_mm256_permute2f128_pd::<0x31>(odd, odd_too)),
                ]
            }
        }
        #[inline(always)]
        fn columns_apart(a: &[&[f64; 4]], b: &[&[f64; 4]]) -> [Self; 4] {
            let (a, b) = (&a[..4], &b[..4]);
            unsafe {
                let mut apart = [Self(_mm256_setzero_pd()); 4];
                for i in 0..4 {
                    apart[i] = Self(_mm256_sub_pd(_mm256_loadu_pd(a[i].as_ptr()), _mm256_loadu_pd(b[i].as_ptr())));
                }
                // To turn rows into columns is to turn columns into rows.
                let [x, y, z, w] = rows_of_four(&apart);
                [Self(x), Self(y), Self(z), Self(w)]
            }
        }
        #[inline(always)]
        fn add_to_rows(first: &[Self; 4], second: &[Self; 4], places: &[[usize; 2]], rows: &mut [[f64; 4]]) {
            let places = &places[..4];
            unsafe {
                let (first, second) = (rows_of_four(first), rows_of_four(second));
                for lane in 0..4 {
                    add_to_two(rows, places[lane], [first[lane], second[lane]]);
                }
            }
        }
        #[inline(always)]
        fn exchange(columns: &[Self; 4], places: &[[usize; 2]], rows: &mut [[f64; 4]]) {
            let places = &places[..4];
            unsafe {
                let given = rows_of_four(columns);
                for lane in 0..4 {
                    add_to_two(rows, places[lane], [opposite(given[lane]), given[lane]]);
                }
            }
        }
        #[inline(always)]
        fn load_threes(from: &[f64]) -> [Self; 3] {
            let from = &from[..12];
            unsafe {
                let (a, b) = (_mm256_loadu_pd(from.as_ptr()), _mm256_loadu_pd(from.as_ptr().add(4)));
                let c = _mm256_loadu_pd(from.as_ptr().add(8));
                // x₀ y₀ x₂ y₂, z₀ x₁ z₂ x₃ and y₁ z₁ y₃ z₃.
                let xy = _mm256_permute2f128_pd::<0x30>(a, b);
                let zx = _mm256_permute2f128_pd::<0x21>(a, c);
                let yz = _mm256_permute2f128_pd::<0x30>(b, c);
                [
                    Self(_mm256_shuffle_pd::<0b1010>(xy, zx)),
                    Self(_mm256_shuffle_pd::<0b0101>(xy, yz)),
                    Self(_mm256_shuffle_pd::<0b1010>(zx, yz)),
                ]
            }
        }
        #[inline(always)]
        fn store_threes(&[x, y, z]: &[Self; 3], to: &mut [f64]) {
            let to = &mut to[..12];
            unsafe {
                let (xy, yz) = (_mm256_unpacklo_pd(x.0, y.0), _mm256_unpackhi_pd(y.0, z.0));
                let zx = _mm256_shuffle_pd::<0b1010>(z.0, x.0);
                _mm256_storeu_pd(to.as_mut_ptr(), _mm256_permute2f128_pd::<0x20>(xy, zx));
                _mm256_storeu_pd(to.as_mut_ptr().add(4), _mm256_permute2f128_pd::<0x30>(yz, xy));
                _mm256_storeu_pd(to.as_mut_ptr().add(8), _mm256_permute2f128_pd::<0x31>(zx, yz));
            }
        }
        #[inline(always)]
        fn index(places: &[u8]) -> __m128i {
            let bytes: [u8; 4] = [places[0] & 15, places[1] & 15, places[2] & 15, places[3] & 15];
            unsafe { _mm_cvtepu8_epi32(_mm_cvtsi32_si128(i32::from_le_bytes(bytes))) }
        }
        #[inline(always)]
        fn lookup(table: &[f64; 16], place: __m128i) -> Self {
            // Places are below 16.
            Self(unsafe { _mm256_i32gather_pd::<8>(table.as_ptr(), place) })
        }
        #[inline(always)]
        fn exponent_mantissa(self) -> (Self, Self, __m128i) {
            unsafe {
                let bits = _mm256_castpd_si256(self.0);
                // Positive: no sign bit stands above the exponent.
                let exponent = _mm256_or_si256(_mm256_srli_epi64::<52>(bits), _mm256_set1_epi64x(TWO_52_BITS));
                let exponent = _mm256_sub_pd(_mm256_castsi256_pd(exponent), _mm256_set1_pd(TWO_52 + 1023.0));
                let mantissa = _mm256_and_si256(bits, _mm256_set1_epi64x(MANTISSA));
                let mantissa = _mm256_or_si256(mantissa, _mm256_set1_epi64x(ONE));
                let place = _mm256_and_si256(_mm256_srli_epi64::<48>(bits), _mm256_set1_epi64x(15));
                let even = _mm256_permutevar8x32_epi32(place, _mm256_setr_epi32(0, 2, 4, 6, 0, 2, 4, 6));
                (Self(exponent), Self(_mm256_castsi256_pd(mantissa)), _mm256_castsi256_si128(even))
            }
        }
        #[inline(always)]
        fn power_of_two(self) -> Self {
            unsafe {
                // The exponent's bits come to lie lowest, and are moved to their place.
                let bits = _mm256_castpd_si256(_mm256_add_pd(self.0, _mm256_set1_pd(TWO_52 + 1023.0)));
                Self(_mm256_castsi256_pd(_mm256_slli_epi64::<52>(bits)))
            }
        }
        #[inline(always)]
        fn outlined<J: Job>(job: J) -> J::Output {
            unsafe { four_outlined(job) }
        }
    }

    impl Number for F64x8 {
        type Mask = __mmask8;

        #[inline(always)]
        fn splat(value: f64) -> Self {
            Self(unsafe { _mm512_set1_pd(value) })
        }
        #[inline(always)]
        fn sqrt(self) -> Self {
            Self(unsafe { _mm512_sqrt_pd(self.0) })
        }
        #[inline(always)]
        fn min(self, other: Self) -> Self {
            Self(unsafe { _mm512_min_pd(self.0, other.0) })
        }
        #[inline(always)]
        fn max(self, other: Self) -> Self {
            Self(unsafe { _mm512_max_pd(self.0, other.0) })
        }
        #[inline(always)]
        fn lt(self, other: Self) -> __mmask8 {
            unsafe { _mm512_cmp_pd_mask::<_CMP_LT_OQ>(self.0, other.0) }
        }
        #[inline(always)]
        fn select(mask: __mmask8, yes: Self, no: Self) -> Self {
            Self(unsafe { _mm512_mask_blend_pd(mask, no.0, yes.0) })
        }
        #[inline(always)]
        fn or(a: __mmask8, b: __mmask8) -> __mmask8 {
            a | b
        }
        #[inline(always)]
        fn and(a: __mmask8, b: __mmask8) -> __mmask8 {
            a & b
        }
        #[inline(always)]
        fn any(mask: __mmask8) -> bool {
            mask != 0
        }
        #[inline(always)]
        fn all(mask: __mmask8) -> bool {
            mask == 255
        }
        functions_of_lanes!();
    }

    impl Lanes for F64x8 {
        type Index = __m512i;
        const LANES: usize = 8;

        #[inline(always)]
        fn lane(self, lane: usize) -> f64 {
            self.array()[lane]
        }
        fn set_lane(&mut self, lane: usize, value: f64) {
            let mut array = self.array();
            array[lane] = value;
            *self = Self::from_array(array);
        }
        #[inline(always)]
        fn load(from: &[f64]) -> Self {
            let from = &from[..8];
            Self(unsafe { _mm512_loadu_pd(from.as_ptr()) })
        }
        #[inline(always)]
        fn store(self, to: &mut [f64]) {
            let to = &mut to[..8];
            unsafe { _mm512_storeu_pd(to.as_mut_ptr(), self.0) }
        }
        #[inline(always)]
        fn after(self, before: Self) -> Self {
            unsafe {
                let (before, own) = (_mm512_castpd_si512(before.0), _mm512_castpd_si512(self.0));
                Self(_mm512_castsi512_pd(_mm512_alignr_epi64::<7>(own, before)))
            }
        }
        #[inline(always)]
        fn columns(rows: &[&[f64; 4]]) -> [Self; 4] {
            let rows = &rows[..8];
            unsafe {
                // Row i and row i + 4 in one register: halves are then turned alike.
                let mut both = [_mm512_setzero_pd(); 4];
                for i in 0..4 {
                    let low = _mm512_castpd256_pd512(_mm256_loadu_pd(rows[i].as_ptr()));
                    both[i] = _mm512_insertf64x4::<1>(low, _mm256_loadu_pd(rows[i + 4].as_ptr()));
                }
                columns_of_halves(both)
            }
        }
        #[inline(always)]
        fn columns_apart(a: &[&[f64; 4]], b: &[&[f64; 4]]) -> [Self; 4] {
            let (a, b) = (&a[..8], &b[..8]);
            unsafe {
                let mut both = [_mm512_setzero_pd(); 4];
                for i in 0..4 {
                    let low = _mm256_sub_pd(_mm256_loadu_pd(a[i].as_ptr()), _mm256_loadu_pd(b[i].as_ptr()));
                    let high = _mm256_sub_pd(_mm256_loadu_pd(a[i + 4].as_ptr()), _mm256_loadu_pd(b[i + 4].as_ptr()));
                    both[i] = _mm512_insertf64x4::<1>(_mm512_castpd256_pd512(low), high);
                }
                columns_of_halves(both)
            }
        }
        #[inline(always)]
        fn add_to_rows(first: &[Self; 4], second: &[Self; 4], places: &[[usize; 2]], rows: &mut [[f64; 4]]) {
            let places = &places[..8];
            unsafe {
                let (first, second) = (rows_of_eight(first), rows_of_eight(second));
                for lane in 0..8 {
                    add_to_two(rows, places[lane], [first[lane], second[lane]]);
                }
            }
        }
        #[inline(always)]
        fn exchange(columns: &[Self; 4], places: &[[usize; 2]], rows: &mut [[f64; 4]]) {
            let places = &places[..8];
            unsafe {
                let given = rows_of_eight(columns);
                for lane in 0..8 {
                    add_to_two(rows, places[lane], [opposite(given[lane]), given[lane]]);
                }
            }
        }
        #[inline(always)]
        fn load_threes(from: &[f64]) -> [Self; 3] {
            let from = &from[..24];
            unsafe {
                let (a, b) = (_mm512_loadu_pd(from.as_ptr()), _mm512_loadu_pd(from.as_ptr().add(8)));
                let c = _mm512_loadu_pd(from.as_ptr().add(16));
                // Each column has numbers of the first two registers, then of the third; places that are taken afterwards stand as 0.
                let x = _mm512_permutex2var_pd(a, _mm512_setr_epi64(0, 3, 6, 9, 12, 15, 0, 0), b);
                let y = _mm512_permutex2var_pd(a, _mm512_setr_epi64(1, 4, 7, 10, 13, 0, 0, 0), b);
                let z = _mm512_permutex2var_pd(a, _mm512_setr_epi64(2, 5, 8, 11, 14, 0, 0, 0), b);
                [
                    Self(_mm512_permutex2var_pd(x, _mm512_setr_epi64(0, 1, 2, 3, 4, 5, 10, 13), c)),
                    Self(_mm512_permutex2var_pd(y, _mm512_setr_epi64(0, 1, 2, 3, 4, 8, 11, 14), c)),
                    Self(_mm512_permutex2var_pd(z, _mm512_setr_epi64(0, 1, 2, 3, 4, 9, 12, 15), c)),
                ]
            }
        }
        #[inline(always)]
        fn store_threes(&[x, y, z]: &[Self; 3], to: &mut [f64]) {
            let to = &mut to[..24];
            unsafe {
                let a = _mm512_permutex2var_pd(x.0, _mm512_setr_epi64(0, 8, 0, 1, 9, 0, 2, 10), y.0);
                let b = _mm512_permutex2var_pd(x.0, _mm512_setr_epi64(0, 3, 11, 0, 4, 12, 0, 5), y.0);
                let c = _mm512_permutex2var_pd(x.0, _mm512_setr_epi64(13, 0, 6, 14, 0, 7, 15, 0), y.0);
                let a = _mm512_permutex2var_pd(a, _mm512_setr_epi64(0, 1, 8, 3, 4, 9, 6, 7), z.0);
                let b = _mm512_permutex2var_pd(b, _mm512_setr_epi64(10, 1, 2, 11, 4, 5, 12, 7), z.0);
                let c = _mm512_permutex2var_pd(c, _mm512_setr_epi64(0, 13, 2, 3, 14, 5, 6, 15), z.0);
                _mm512_storeu_pd(to.as_mut_ptr(), a);
                _mm512_storeu_pd(to.as_mut_ptr().add(8), b);
                _mm512_storeu_pd(to.as_mut_ptr().add(16), c);
            }
        }
        #[inline(always)]
        fn index(places: &[u8]) -> __m512i {
            let mut bytes = [0; 8];
            bytes.copy_from_slice(&places[..8]);
            unsafe { _mm512_cvtepu8_epi64(_mm_cvtsi64_si128(i64::from_le_bytes(bytes))) }
        }
        #[inline(always)]
        fn lookup(table: &[f64; 16], place: __m512i) -> Self {
            unsafe {
                let low = _mm512_loadu_pd(table.as_ptr());
                let high = _mm512_loadu_pd(table.as_ptr().add(8));
                Self(_mm512_permutex2var_pd(low, place, high))
            }
        }
        #[inline(always)]
        fn exponent_mantissa(self) -> (Self, Self, __m512i) {
            unsafe {
                let bits = _mm512_castpd_si512(self.0);
                let exponent = _mm512_sub_epi64(_mm512_srli_epi64::<52>(bits), _mm512_set1_epi64(1023));
                let mantissa = _mm512_and_si512(bits, _mm512_set1_epi64(MANTISSA));
                let mantissa = _mm512_or_si512(mantissa, _mm512_set1_epi64(ONE));
                // permutex2var looks at the low four bits of a place only.
                let place = _mm512_srli_epi64::<48>(bits);
                (Self(_mm512_cvtepi64_pd(exponent)), Self(_mm512_castsi512_pd(mantissa)), place)
            }
        }
        #[inline(always)]
        fn power_of_two(self) -> Self {
            unsafe {
                // The exponent's bits come to lie lowest, and are moved to their place.
                let bits = _mm512_castpd_si512(_mm512_add_pd(self.0, _mm512_set1_pd(TWO_52 + 1023.0)));
                Self(_mm512_castsi512_pd(_mm512_slli_epi64::<52>(bits)))
            }
        }
        #[inline(always)]
        fn outlined<J: Job>(job: J) -> J::Output {
            unsafe { eight_outlined(job) }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Kernel, Width};
    use crate::real::Lanes;

    /// Many operations on many numbers; lane k of a group holds number k.
    struct Everything<'a>(&'a [f64]);

    impl Kernel for Everything<'_> {
        type Output = Vec<u64>;
        #[inline(always)]
        fn run<V: Lanes>(self) -> Vec<u64> {
            let table: [f64; 16] = std::array::from_fn(|k| k as f64);
            let mut out = Vec::new();
            for group in self.0.chunks(V::LANES) {
                let mut x = V::splat(1.0);
                let mut places = [0; 8];
                for (lane, &value) in group.iter().enumerate() {
                    x.set_lane(lane, value);
                    places[lane] = (value.to_bits() >> 7) as u8 & 15;
                }
                let half = x.lt(V::splat(1.0));
                let parts = x.exponent_mantissa();
                let rows: [[f64; 4]; 8] = std::array::from_fn(|lane| {
                    let value = group.get(lane).copied().unwrap_or(0.0);
                    [value, 2.0 * value, value - 1.0, 1.0]
                });
                let columns = V::columns(&rows.each_ref());
                let others: [[f64; 4]; 8] =
                    std::array::from_fn(|lane| [0.5, 3.0 * rows[lane][0], -1.0, rows[7 - lane][1]]);
                let apart = V::columns_apart(&rows.each_ref(), &others.each_ref());
                // Into rows that several lanes have in common.
                let at: [[usize; 2]; 8] = std::array::from_fn(|lane| [lane / 3, lane / 2 + 1]);
                let mut sums = [[0.0; 4]; 6];
                V::exchange(&columns, &at, &mut sums);
                V::add_to_rows(&columns, &apart, &at, &mut sums);
                let mut expected = [[0.0; 4]; 6];
                for lane in 0..V::LANES {
                    for k in 0..4 {
                        expected[at[lane][0]][k] -= rows[lane][k];
                        expected[at[lane][1]][k] += rows[lane][k];
                    }
                }
                for lane in 0..V::LANES {
                    for k in 0..4 {
                        expected[at[lane][0]][k] += rows[lane][k];
                        expected[at[lane][1]][k] += rows[lane][k] - others[lane][k];
                    }
                }
                assert_eq!(sums, expected);
                let mut threes = [0.0; 24];
                V::store_threes(&[columns[0], columns[1], columns[2]], &mut threes);
                for (k, number) in threes[..3 * V::LANES].iter().enumerate() {
                    assert_eq!(number.to_bits(), rows[k / 3][k % 3].to_bits());
                }
                let threes = V::load_threes(&threes);
                let results = [
                    columns[0],
                    columns[1],
                    columns[2],
                    columns[3],
                    apart[0],
                    apart[1],
                    threes[0],
                    threes[1],
                    threes[2],
                    x.ln(),
                    (x.min(V::splat(700.0)) * V::splat(-1.0)).exp(),
                    x.min(V::splat(12.0)).exp(),
                    (V::splat(1.0) - x).acos(),
                    (x.min(V::splat(0.5))).exp_small(),
                    x.sqrt() / (x + V::splat(3.0)),
                    -(x * x - x),
                    V::select(half, x, V::splat(2.0)).max(V::splat(0.3)),
                    V::select(V::or(half, V::splat(5.0).lt(x)), x, -x),
                    V::lookup(&table, V::index(&places)),
                    parts.0,
                    parts.1,
                    V::lookup(&table, parts.2),
                ];
                for lane in 0..group.len() {
                    out.extend(results.iter().map(|r| r.lane(lane).to_bits()));
                }
            }
            out
        }
    }

    /// Rows of numbers, moved one place on.
    struct Moved<'a>(&'a [f64]);

    impl Kernel for Moved<'_> {
        type Output = Vec<f64>;
        #[inline(always)]
        fn run<V: Lanes>(self) -> Vec<f64> {
            let mut out = vec![0.0; self.0.len()];
            let mut before = V::splat(-1.0);
            for start in (0..self.0.len()).step_by(V::LANES) {
                let own = V::load(&self.0[start..]);
                own.after(before).store(&mut out[start..]);
                before = own;
            }
            out
        }
    }

    #[test]
    fn rows_move_one_place_on_across_registers() {
        let row: Vec<f64> = (0..32).map(f64::from).collect();
        let expected: Vec<f64> = (-1..31).map(f64::from).collect();
        for width in Width::available() {
            assert_eq!(width.run(Moved(&row)), expected, "{width:?}");
        }
    }

    #[test]
    fn every_width_gives_the_same_bits() {
        let numbers: Vec<f64> =
            (0..4001).map(|k| 1e-9 * 1.009_f64.powi(k % 3900) * (1.0 + f64::from(k) * 1e-5)).collect();
        let scalar = Width::Scalar.run(Everything(&numbers));
        for width in Width::available() {
            assert!(width.run(Everything(&numbers)) == scalar, "{width:?}");
        }
    }
}
