//! Distribution of the contour error, counted in bounded memory.

use serde::Serialize;

/// Bins on either side of zero while counting.
const BINS_PER_SIDE: usize = 512;

/// Initial width of a bin, µm. It doubles until all errors fit, so that a full histogram has 256 to
/// 512 bins on a side.
const FIRST_BIN_UM: f64 = 1e-3;

/// Most bins of a finished `Histogram`: what a plot can show.
const SHOWN_BINS: usize = 96;

/// Distribution of the contour error over the rows that cut. Bin `i` of `counts` holds errors from
/// `(first_bin + i) * bin_um` up to the next multiple.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Histogram {
    /// Width of a bin, µm: 0.001 times a power of two, so that histograms of several runs can be
    /// brought to one width.
    pub(crate) bin_um: f64,
    /// Number of the first bin; the bin from 0 upwards has number 0.
    pub(crate) first_bin: i64,
    /// Rows in each bin.
    pub counts: Vec<u64>,
}

/// Counts of a histogram under way: the same number of bins on either side of zero, wide enough for
/// all errors so far.
#[derive(Debug, Clone)]
pub(super) struct Counts {
    bin_um: f64,
    counts: Vec<u64>,
}

impl Counts {
    /// Creates an empty histogram.
    pub(super) fn new() -> Self {
        Self {
            bin_um: FIRST_BIN_UM,
            counts: vec![0; 2 * BINS_PER_SIDE],
        }
    }

    /// Counts one error, um.
    pub(super) fn add(&mut self, error_um: f64) {
        let side = BINS_PER_SIDE as f64;
        while !(-side..side).contains(&(error_um / self.bin_um).floor()) {
            self.widen();
        }
        let bin = (error_um / self.bin_um).floor() + side;
        self.counts[bin as usize] += 1;
    }

    /// Doubles the width of the bins. With zero between two bins, pairs join without remainder on
    /// either side.
    fn widen(&mut self) {
        let narrow = std::mem::replace(&mut self.counts, vec![0; 2 * BINS_PER_SIDE]);
        for (i, count) in narrow.into_iter().enumerate() {
            self.counts[i / 2 + BINS_PER_SIDE / 2] += count;
        }
        self.bin_um *= 2.0;
    }

    /// Returns the histogram for a plot.
    pub(super) fn histogram(&self) -> Histogram {
        let first = self.counts.iter().position(|&n| n > 0);
        let last = self.counts.iter().rposition(|&n| n > 0);
        let (Some(first), Some(last)) = (first, last) else {
            return Histogram {
                bin_um: self.bin_um,
                first_bin: 0,
                counts: Vec::new(),
            };
        };
        let side = BINS_PER_SIDE as i64;
        let counts = self.counts[first..=last].to_vec();
        let mut histogram = Histogram {
            bin_um: self.bin_um,
            first_bin: first as i64 - side,
            counts,
        };
        while histogram.counts.len() > SHOWN_BINS {
            histogram = histogram.widened();
        }
        histogram
    }
}

impl Histogram {
    /// Returns the same counts in bins of twice the width.
    pub fn widened(&self) -> Self {
        let first_bin = self.first_bin.div_euclid(2);
        let mut counts = Vec::with_capacity(self.counts.len() / 2 + 1);
        for (bin, &count) in (self.first_bin..).zip(&self.counts) {
            let wide = (bin.div_euclid(2) - first_bin) as usize;
            if wide == counts.len() {
                counts.push(0);
            }
            counts[wide] += count;
        }
        Self {
            bin_um: self.bin_um * 2.0,
            first_bin,
            counts,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_histogram_agrees_with_counting_by_hand() {
        let errors_um: Vec<f64> = (0..4000)
            .map(|k| 37.0 * libm::sin(f64::from(k) * 0.7) - 5.0)
            .collect();
        let mut counts = Counts::new();
        errors_um.iter().for_each(|error_um| counts.add(*error_um));
        let histogram = counts.histogram();
        assert!(
            histogram.counts.len() <= SHOWN_BINS && histogram.counts.len() > SHOWN_BINS / 2 - 2
        );
        for (bin, &count) in (histogram.first_bin..).zip(&histogram.counts) {
            let inside = |e: &&f64| (**e / histogram.bin_um).floor() as i64 == bin;
            assert_eq!(
                count,
                errors_um.iter().filter(inside).count() as u64,
                "bin {bin}"
            );
        }
        assert_eq!(histogram.counts.iter().sum::<u64>(), 4000);
    }
}
