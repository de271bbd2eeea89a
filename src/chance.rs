//! Fractions from a generator's raw bits, the same on every platform and in every release of the generator's crate.

use rand_xoshiro::Xoshiro256PlusPlus;
use rand_xoshiro::rand_core::Rng;

/// A number from 0 to 1, 1 not included: the upper 53 bits of the next output, which are what a fraction holds.
pub(crate) fn fraction(generator: &mut Xoshiro256PlusPlus) -> f64 {
    (generator.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
}
