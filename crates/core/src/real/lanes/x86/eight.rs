//! Eight numbers.

use super::*;

// Safety of every block below: see the module's page. Slices are checked to be long enough.
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
