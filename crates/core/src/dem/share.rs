//! Loops over many rows, shared out among threads.
//!
//! Parts over which anything is summed depend on a loop's length alone, so that sums are the same for any number of threads.

use std::ops::Range;
use std::sync::Mutex;

use rayon::prelude::*;

/// From so many rows on a loop is worth sharing.
pub const MANY: usize = 20_000;
/// So many rows for one thread at a time.
const PART: usize = 4096;

/// Does something for each number below `count`, on as many threads as there are. Compiled once: what is generic calls it.
fn each(count: usize, work: &(dyn Fn(usize) + Sync)) {
    (0..count).into_par_iter().with_max_len(1).for_each(work);
}

/// One value of each item, in their order; worth its while where a value takes a microsecond or more.
pub fn each_of<P: Send, T: Send>(items: Vec<P>, value: impl Fn(P) -> T + Sync) -> Vec<T> {
    let places: Vec<_> = items.into_iter().map(|item| Mutex::new((Some(item), None))).collect();
    each(places.len(), &|k| {
        // Each is taken once, and where a value panics so does the loop.
        if let Ok(mut place) = places[k].lock() {
            place.1 = place.0.take().map(&value);
        }
    });
    places.into_iter().filter_map(|place| place.into_inner().ok()?.1).collect()
}

/// One value per row.
pub fn rows<T: Send>(count: usize, value: impl Fn(usize) -> T + Sync + Send) -> Vec<T> {
    joined(parts(count, |part| part.map(&value).collect::<Vec<T>>()))
}

/// Lists one after the other, in as much room as they take.
pub fn joined<T>(mut lists: Vec<Vec<T>>) -> Vec<T> {
    if lists.len() == 1 {
        return lists.swap_remove(0);
    }
    let mut all = Vec::with_capacity(lists.iter().map(Vec::len).sum());
    lists.into_iter().for_each(|list| all.extend(list));
    all
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
    each_of((0..count).step_by(PART).map(|from| take(from..(from + PART).min(count))).collect(), value)
}

/// The first `count` rows, which the rest is left without.
pub fn cut<'a, T>(rows: &mut &'a mut [T], count: usize) -> &'a mut [T] {
    rows.split_off_mut(..count).expect("no more rows than there are")
}
