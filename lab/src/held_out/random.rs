//! Random numbers that are the same on every platform: logarithms are those of a library that is.

use feedwright_sim::rounded;
use rand::{RngExt, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

/// Random numbers that are the same on every platform.
pub(crate) struct Random(Xoshiro256PlusPlus);

impl Random {
    pub(crate) fn new(seed: u64) -> Self {
        Self(Xoshiro256PlusPlus::seed_from_u64(seed))
    }

    pub(crate) fn between(&mut self, [low, high]: [f64; 2]) -> f64 {
        self.0.random_range(low..=high)
    }

    /// Evenly spread in its logarithm, to three digits.
    pub(crate) fn by_ratio(&mut self, [low, high]: [f64; 2]) -> f64 {
        rounded(
            low * libm::exp(self.between([0.0, libm::log(high / low)])),
            3,
        )
    }

    pub(crate) fn whole(&mut self, low: u32, high: u32) -> u32 {
        self.0.random_range(low..=high)
    }

    pub(super) fn sign(&mut self) -> f64 {
        if self.one_in(2) { 1.0 } else { -1.0 }
    }

    pub(crate) fn one_in(&mut self, count: u32) -> bool {
        self.0.random_range(0..count) == 0
    }
}
