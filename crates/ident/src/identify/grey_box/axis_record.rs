//! View of one axis of a log: what was recorded of it, and how it moved.

use std::ops::Range;

use crate::average::rms;
use crate::log::{Log, LogAxis};

/// Commanded and actual positions of an axis at an even clock.
#[derive(Debug, Clone, Copy)]
pub(crate) struct AxisRecord<'a> {
    /// Name of the axis.
    pub(crate) name: &'a str,
    /// Time between two samples, s.
    pub(crate) sample_s: f64,
    /// Even stretches.
    pub(crate) stretches: &'a [Range<usize>],
    /// Command, mm.
    pub(crate) command_mm: &'a [f64],
    /// Actual position, mm.
    pub(crate) actual_mm: &'a [f64],
    /// Step of the actual position, mm; zero where none shows.
    pub(crate) step_mm: f64,
}

/// Samples to each side that a speed is taken over, and an acceleration: the mean of a few keeps
/// steps of the command out.
const SPEED_REACH: usize = 3;
const ACCELERATION_REACH: usize = 6;

/// Latest record that is looked for, s: a recorder on a network is late by tenths. A record that is
/// later hardly follows its command.
pub(super) const LATEST_S: f64 = 1.0;
/// Lag of the slowest position loops, s: they have gains from 10 1/s on.
const SLOWEST_LOOP_S: f64 = 0.1;
/// Times the least squares that a lag leaves which is as good.
const NEARLY: f64 = 4.0;
/// Samples that a lag is found from at the most.
const COMPARED: usize = 20_000;

impl<'a> AxisRecord<'a> {
    /// Returns the axes of a log.
    pub(super) fn of(log: &'a Log) -> Vec<Self> {
        let record = |axis: &'a LogAxis| Self {
            name: &axis.name,
            sample_s: log.sample_time_s,
            stretches: &log.stretches,
            command_mm: &axis.command_mm,
            actual_mm: &axis.actual_mm,
            step_mm: axis.step_mm,
        };
        log.axes.iter().map(record).collect()
    }
}

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
        self.slopes(
            &self.slopes(self.command_mm, ACCELERATION_REACH),
            ACCELERATION_REACH,
        )
    }

    /// Highest speed of the command, mm/s, and acceleration, mm/s2.
    pub(super) fn most(&self) -> [f64; 2] {
        [self.command_speed_mm_s(), self.command_acceleration_mm_s2()].map(|values| {
            values
                .iter()
                .fold(0.0_f64, |most, value| most.max(value.abs()))
        })
    }

    /// Slopes of a sequence by differences over a reach to both sides, within its stretch.
    pub(super) fn slopes(&self, values: &[f64], reach: usize) -> Vec<f64> {
        let mut slopes = vec![0.0; values.len()];
        for stretch in self.stretches {
            for k in stretch.clone() {
                let (from, to) = (
                    k.saturating_sub(reach).max(stretch.start),
                    (k + reach).min(stretch.end - 1),
                );
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

    /// Samples by which actual positions are later than the slowest position loop makes them: the
    /// rest of the lag that has the least squares over samples that count.
    pub(super) fn late_samples(&self, counts: &[bool]) -> usize {
        let longest = self
            .stretches
            .iter()
            .map(ExactSizeIterator::len)
            .max()
            .unwrap_or(0);
        let most = ((LATEST_S / self.sample_s) as usize).min(longest / 2);
        let compared = |k: &usize| {
            counts[*k]
                && self
                    .stretches
                    .iter()
                    .any(|stretch| stretch.contains(k) && k - most >= stretch.start)
        };
        let samples: Vec<usize> = (most..self.actual_mm.len()).filter(compared).collect();
        let apart = samples.len().div_ceil(COMPARED).max(1);
        let square_mm2 = |lag: usize| -> f64 {
            let errors = samples
                .iter()
                .step_by(apart)
                .map(|&k| self.actual_mm[k] - self.command_mm[k - lag]);
            errors.map(|error| error * error).sum()
        };
        let squares_mm2: Vec<f64> = (0..=most).map(square_mm2).collect();
        let least_mm2 = squares_mm2.iter().copied().fold(f64::INFINITY, f64::min);
        // A motion that comes again is as near a period later.
        let lag = squares_mm2
            .iter()
            .position(|square_mm2| *square_mm2 <= NEARLY * least_mm2)
            .unwrap_or(0);
        lag.saturating_sub((SLOWEST_LOOP_S / self.sample_s).ceil() as usize)
    }

    /// Samples at the beginning of a stretch that depend on commands before it, beside the time in
    /// which an axis settles: none but in a late record.
    pub(super) fn without_command(&self, counts: &[bool]) -> usize {
        match self.late_samples(counts) {
            0 => 0,
            late => late + (2.0 * SLOWEST_LOOP_S / self.sample_s).ceil() as usize,
        }
    }

    /// RMS of the following error over samples that count, mm.
    pub(super) fn following_mm(&self, counts: &[bool]) -> f64 {
        rms((0..counts.len())
            .filter(|&k| counts[k])
            .map(|k| self.command_mm[k] - self.actual_mm[k]))
    }
}

/// Samples that position and speed at a start are taken from.
const START_SAMPLES: usize = 8;
