//! Four numbers.

use super::*;

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
