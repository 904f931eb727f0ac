//! What was recorded of one axis, and how it moved.

use std::ops::Range;

use crate::average::rms;

/// Commanded and actual positions of an axis at an even clock.
#[derive(Debug, Clone, Copy)]
pub struct AxisRecord<'a> {
    /// Name of the axis.
    pub name: &'a str,
    /// Time between two samples, s.
    pub sample_s: f64,
    /// Even stretches.
    pub stretches: &'a [Range<usize>],
    /// Command, mm.
    pub command_mm: &'a [f64],
    /// Actual position, mm.
    pub actual_mm: &'a [f64],
    /// Step of the actual position, mm; zero where none shows.
    pub step_mm: f64,
}

/// Samples to each side that a speed is taken over, and an acceleration: the mean of a few keeps steps of the command out.
const SPEED_REACH: usize = 3;
const ACCELERATION_REACH: usize = 6;

impl AxisRecord<'_> {
    /// Speed of the command at each sample, mm/s.
    pub(super) fn command_speed_mm_s(&self) -> Vec<f64> {
        self.slopes(self.command_mm, SPEED_REACH)
    }

    /// Speed of the actual position at each sample, mm/s.
    pub(super) fn actual_speed_mm_s(&self) -> Vec<f64> {
        self.slopes(self.actual_mm, SPEED_REACH)
    }

    /// Acceleration of the command at each sample, mm/s2.
    pub(super) fn command_acceleration_mm_s2(&self) -> Vec<f64> {
        self.slopes(&self.slopes(self.command_mm, ACCELERATION_REACH), ACCELERATION_REACH)
    }

    /// Slopes of a sequence by differences over a reach to both sides, within its stretch.
    pub(super) fn slopes(&self, values: &[f64], reach: usize) -> Vec<f64> {
        let mut slopes = vec![0.0; values.len()];
        for stretch in self.stretches {
            for k in stretch.clone() {
                let (from, to) = (k.saturating_sub(reach).max(stretch.start), (k + reach).min(stretch.end - 1));
                if to > from {
                    slopes[k] = (values[to] - values[from]) / ((to - from) as f64 * self.sample_s);
                }
            }
        }
        slopes
    }

    /// Actual position and speed at a sample, by a line through some samples from it on.
    pub(super) fn start(&self, stretch: &Range<usize>, sample: usize) -> [f64; 2] {
        let to = (sample + START_SAMPLES).min(stretch.end);
        let n = (to - sample) as f64;
        if n < 3.0 {
            return [self.actual_mm[sample], 0.0];
        }
        let middle = 0.5 * (n - 1.0);
        let (mut mean, mut moment) = (0.0, 0.0);
        for (i, actual) in self.actual_mm[sample..to].iter().enumerate() {
            mean += actual / n;
            moment += (i as f64 - middle) * actual;
        }
        let slope = 12.0 * moment / (n * (n * n - 1.0));
        [mean - slope * middle, slope / self.sample_s]
    }

    /// RMS of the following error over samples that count, mm.
    pub(super) fn following_mm(&self, counts: &[bool]) -> f64 {
        rms((0..counts.len()).filter(|&k| counts[k]).map(|k| self.command_mm[k] - self.actual_mm[k]))
    }
}

/// Samples that position and speed at a start are taken from.
const START_SAMPLES: usize = 8;
