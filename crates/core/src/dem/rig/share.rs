//! Loops over many rows, shared out among threads.
//!
//! Parts over which anything is summed depend on a loop's length alone, so that sums are the same for any number of threads.

use std::ops::Range;

use rayon::prelude::*;

/// From so many rows on a loop is worth sharing.
pub const MANY: usize = 20_000;
/// So many rows for one thread at a time.
const PART: usize = 4096;

/// One value per row.
pub fn rows<T: Send>(count: usize, value: impl Fn(usize) -> T + Sync + Send) -> Vec<T> {
    if count < MANY {
        (0..count).map(value).collect()
    } else {
        (0..count).into_par_iter().with_min_len(PART).map(value).collect()
    }
}

/// One value per part of the rows, in their order; few rows are one part.
pub fn parts<T: Send>(count: usize, value: impl Fn(Range<usize>) -> T + Sync + Send) -> Vec<T> {
    pieces(count, |part| part, value)
}

/// As [`parts`], of the pieces that `take` makes of successive parts.
pub fn pieces<P: Send, T: Send>(
    count: usize,
    mut take: impl FnMut(Range<usize>) -> P,
    value: impl Fn(P) -> T + Sync + Send,
) -> Vec<T> {
    if count < MANY {
        return vec![value(take(0..count))];
    }
    let pieces: Vec<P> = (0..count).step_by(PART).map(|from| take(from..(from + PART).min(count))).collect();
    pieces.into_par_iter().with_max_len(1).map(value).collect()
}

/// The first `count` rows, which the rest is left without.
pub fn cut<'a, T>(rows: &mut &'a mut [T], count: usize) -> &'a mut [T] {
    rows.split_off_mut(..count).expect("no more rows than there are")
}
