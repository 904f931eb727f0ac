//! How long the ticks took: a histogram, logarithmic and of fixed size, whatever the length of the
//! run.

/// Buckets an octave in the histogram of tick times: a quantile is good to 5 %.
const BUCKETS_AN_OCTAVE: usize = 8;
/// 2^32 ns is over four seconds.
const OCTAVES: usize = 32;

/// A histogram of tick times.
#[derive(Debug, Clone, PartialEq)]
pub struct TickTimes {
    counts: Box<[u64; BUCKETS_AN_OCTAVE * OCTAVES]>,
    total: u64,
}

impl Default for TickTimes {
    fn default() -> Self {
        Self {
            counts: Box::new([0; BUCKETS_AN_OCTAVE * OCTAVES]),
            total: 0,
        }
    }
}

impl TickTimes {
    pub(super) fn add(&mut self, ns: u128) {
        let octaves = libm::log2(ns.max(1) as f64);
        let bucket = (octaves * BUCKETS_AN_OCTAVE as f64) as usize;
        self.counts[bucket.min(self.counts.len() - 1)] += 1;
        self.total += 1;
    }

    /// The time that this part of the ticks stays below, us; zero without ticks.
    pub fn quantile_us(&self, part: f64) -> f64 {
        let wanted = part * self.total as f64;
        let mut seen = 0;
        for (bucket, count) in self.counts.iter().enumerate() {
            seen += count;
            if *count > 0 && seen as f64 >= wanted {
                return libm::exp2((bucket as f64 + 0.5) / BUCKETS_AN_OCTAVE as f64) * 1e-3;
            }
        }
        0.0
    }
}
