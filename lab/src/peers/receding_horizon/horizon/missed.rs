//! Prediction error several knots ahead: whether the model knows the effect of an offset on the
//! tool.
//!
//! The innovation measures the prediction one knot ahead. This prediction is good even on a machine
//! that the identifier does not know, because the last error is added to the next prediction.
//! Further ahead this does not help, and a plan built on such predictions swings about the path.
//! The controller therefore compares the tool with its position predicted [`AHEAD_KNOTS`] knots
//! ago:
//!
//! ```text
//! p(k) - g(k)   against   p(k | k-M) - g(k | k-M)       g: displacement of the tool by the offset
//! ```
//!
//! Both sides exclude the effect of the offset, because the plan has changed since. Only the
//! component of the difference across the path counts.

use feedwright_control::vector::{norm, reject, sub};

/// M: knots ahead.
pub(crate) const AHEAD_KNOTS: usize = 6;
/// Part of the largest miss lately that is forgotten in a feed period: it lasts a second and a half.
const FORGOTTEN: f64 = 0.002;
/// A miss beyond this says no more, mm: no position that has leapt is to be remembered for longer than others.
const MAX_MM: f64 = 0.05;
/// Predictions under way.
const UNDER_WAY: usize = AHEAD_KNOTS * super::MAX_PERIODS + 1;

/// Predictions under way, and the largest miss lately.
#[derive(Debug, Clone)]
pub(crate) struct Missed<const N: usize> {
    /// Where the tool is to be without the offset, mm, and in which feed period.
    foreseen: [([f64; N], usize); UNDER_WAY],
    period: usize,
    largest_mm: f64,
}

impl<const N: usize> Missed<N> {
    /// Nothing is foreseen yet.
    pub(crate) const NONE: Self = Self { foreseen: [([0.0; N], usize::MAX); UNDER_WAY], period: 0, largest_mm: 0.0 };

    /// The largest miss lately, mm.
    pub(crate) fn largest_mm(&self) -> f64 {
        self.largest_mm
    }

    /// A feed period further, the tool without the offset is here, on a path in this direction, mm.
    pub(crate) fn look_back(&mut self, open_mm: [f64; N], tangent: [f64; N]) {
        self.period = self.period.wrapping_add(1);
        let (foreseen_mm, period) = self.foreseen[self.period % UNDER_WAY];
        let missed_mm = norm(reject(sub(open_mm, foreseen_mm), tangent));
        self.largest_mm *= 1.0 - FORGOTTEN;
        // Not a number is not larger.
        if period == self.period && missed_mm > self.largest_mm {
            self.largest_mm = missed_mm.min(MAX_MM);
        }
    }

    /// Stores a prediction: in [`AHEAD_KNOTS`] knots of `periods` feed periods each, the tool
    /// without the offset is at `open_mm`.
    pub(crate) fn foresee(&mut self, periods: usize, open_mm: [f64; N]) {
        let period = self.period.wrapping_add(AHEAD_KNOTS * periods.min(super::MAX_PERIODS));
        self.foreseen[period % UNDER_WAY] = (open_mm, period);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_miss_counts_across_the_path_when_its_time_has_come_and_is_forgotten() {
        let mut missed = Missed::<2>::NONE;
        missed.foresee(2, [1.0, 2.0]);
        for _ in 1..2 * AHEAD_KNOTS {
            missed.look_back([0.0; 2], [1.0, 0.0]);
            assert_eq!(missed.largest_mm(), 0.0);
        }
        missed.look_back([5.0, 2.02], [1.0, 0.0]);
        assert!((missed.largest_mm() - 0.02).abs() < 1e-12);
        for _ in 0..500 {
            missed.look_back([0.0; 2], [1.0, 0.0]);
        }
        assert!((0.006..0.008).contains(&missed.largest_mm()), "{}", missed.largest_mm());
    }

    #[test]
    fn neither_a_leap_nor_what_is_no_number_is_remembered_for_long() {
        let mut missed = Missed::<2>::NONE;
        for position_mm in [[0.0, 7.0], [0.0, f64::NAN]] {
            missed.foresee(1, [0.0; 2]);
            (0..AHEAD_KNOTS).for_each(|_| missed.look_back(position_mm, [1.0, 0.0]));
            assert!(missed.largest_mm() <= MAX_MM);
        }
    }
}
