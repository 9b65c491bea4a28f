//! Seeds of runs, and separate streams of draws within one.

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

/// Seed of one run of a fleet.
pub fn run_seed(seed: u64, run: usize) -> u64 {
    // The golden ratio keeps neighbouring fleets apart.
    seed.wrapping_add((run as u64 + 1).wrapping_mul(0x9E37_79B9_7F4A_7C15))
}

/// The draws of one purpose: another purpose of the same run draws what it drew without this one.
pub(crate) fn stream(seed: u64, number: u64) -> ChaCha8Rng {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream(number);
    rng
}
