//! How many numbers stand side by side in a register, and what is computed at which width. The registers themselves (`lanes/x86.rs`, `lanes/single.rs`) are the one
//! place with unsafe code.
//!
//! Everything unsafe there is a call of a vector instruction. Its only precondition is that the processor has it, and the
//! types are made by [`Width::run`] and its like alone, which have asked the processor.

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
    #[cfg(not(target_arch = "x86_64"))]
    let _ = (slice, place, bytes);
}

#[cfg(target_arch = "x86_64")]
#[expect(unsafe_code, reason = "vector instructions; see the module's page")]
mod single;

#[cfg(target_arch = "x86_64")]
#[expect(unsafe_code, reason = "vector instructions; see the module's page")]
mod x86;

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
