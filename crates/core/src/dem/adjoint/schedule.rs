//! Which states of a run are kept, so that it can be walked through backwards.

use std::ops::Range;

/// Cuts a run into blocks, from the last to the first. The state at the start of each block is kept from the way there; on the way back the
/// block is run once more, with all its states. With blocks of about the square root of the steps, and as many of them, memory grows
/// as the square root of the run, for one more run.
pub(super) fn blocks(steps: u64) -> Vec<Range<u64>> {
    let length = (steps as f64).sqrt().ceil().max(1.0) as u64;
    (0..steps.div_ceil(length)).rev().map(|block| block * length..((block + 1) * length).min(steps)).collect()
}

#[cfg(test)]
mod tests {
    use super::blocks;

    #[test]
    fn every_step_is_in_one_block_and_few_states_are_kept() {
        for steps in (0..400).chain([1750, 7000, 100_000]) {
            let blocks = blocks(steps);
            let forwards: Vec<u64> = blocks.iter().rev().flat_map(Clone::clone).collect();
            assert_eq!(forwards, (0..steps).collect::<Vec<_>>(), "{steps}");
            let longest = blocks.iter().map(|block| block.end - block.start).max().unwrap_or(0);
            let root = (steps as f64).sqrt();
            assert!((longest as f64) < root + 1.0 && (blocks.len() as f64) < root + 1.0, "{steps}");
        }
    }
}
