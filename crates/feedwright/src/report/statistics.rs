//! Statistics: the numbers of a run, from every row, in bounded memory.
//!
//! - RMS contour error: sqrt(sum of e² / n) over the n rows that cut.
//! - Largest contour error: the largest |e| over the rows that cut.
//! - Largest deviation of the command: the largest |corrected - path| over all rows.
//! - Largest acceleration of the command: the largest |c(k) - 2 c(k-1) + c(k-2)| / dt^2 over rows
//!   at equal intervals. It does not count across the part of a rest that was left out.
//! - Peak torque: the largest |torque| of each axis over all rows.
//! - Shares of the limits: the largest acceleration of the command and torque of each axis, by its
//!   limit; the largest of the axes.
//! - Feedrate: the way of the tool from row to row by its time, beside the programmed feedrate at
//!   its foot, over the rows that cut.
//! - Cutting length and time: the sum of the steps in arc length and time to the rows that cut.
//!
//! The statistics skip a row with a number that is not finite. Only a run that diverged has such
//! rows, and its outcome says so.

use std::io;

use feedwright_plan::vector::distance;
use feedwright_sim::{Outcome, Row, Sink};

use super::histogram::Counts;
use super::series::CommandAcceleration;
use super::summary::{FeedShares, RunFacts, RunSummary};
use super::worst::WorstFinder;

/// Fractions of the programmed feedrate below which a tool is slow and above which it is fast: the
/// chip is then a fifth thinner or thicker than programmed.
const SLOW_AND_FAST: [f64; 2] = [0.8, 1.2];

/// Times in which the tool is slower or faster than programmed.
#[derive(Debug, Clone, Copy, Default)]
struct FeedMeter {
    time_s: f64,
    slow_s: f64,
    fast_s: f64,
    largest: f64,
}

impl FeedMeter {
    fn add(&mut self, way_mm: f64, time_s: f64, programmed_mm_s: f64) {
        if programmed_mm_s <= 0.0 || time_s <= 0.0 {
            return;
        }
        let part = way_mm / time_s / programmed_mm_s;
        self.time_s += time_s;
        if part < SLOW_AND_FAST[0] {
            self.slow_s += time_s;
        } else if part > SLOW_AND_FAST[1] {
            self.fast_s += time_s;
        }
        self.largest = self.largest.max(part);
    }

    fn shares(self) -> Option<FeedShares> {
        let Self {
            time_s,
            slow_s,
            fast_s,
            largest,
        } = self;
        (time_s > 0.0).then(|| FeedShares {
            slow_share: slow_s / time_s,
            fast_share: fast_s / time_s,
            largest,
        })
    }
}

/// Streaming statistics of a run.
#[derive(Debug, Clone)]
pub struct Statistics {
    rows: u64,
    cutting_rows: u64,
    square_sum_mm2: f64,
    max_mm: f64,
    max_deviation_mm: f64,
    max_command_accel_mm_s2: f64,
    /// Largest acceleration of the command of each axis, mm/s2.
    axis_accel_mm_s2: [f64; 3],
    acceleration: CommandAcceleration,
    peak_torque_nm: [f64; 3],
    cutting_length_mm: f64,
    cutting_time_s: f64,
    previous: Option<Row>,
    feed: FeedMeter,
    counts: Counts,
    worst: WorstFinder,
}

impl Default for Statistics {
    fn default() -> Self {
        Self::new()
    }
}

impl Statistics {
    /// Creates statistics without any rows.
    pub fn new() -> Self {
        Self {
            rows: 0,
            cutting_rows: 0,
            square_sum_mm2: 0.0,
            max_mm: 0.0,
            max_deviation_mm: 0.0,
            max_command_accel_mm_s2: 0.0,
            axis_accel_mm_s2: [0.0; 3],
            acceleration: CommandAcceleration::default(),
            peak_torque_nm: [0.0; 3],
            cutting_length_mm: 0.0,
            cutting_time_s: 0.0,
            previous: None,
            feed: FeedMeter::default(),
            counts: Counts::new(),
            worst: WorstFinder::default(),
        }
    }

    /// Returns the summary of the run; `text` gives the text of a program line. The errors and
    /// times of a cut that diverged are NaN: they would describe only its beginning.
    pub fn summary(&self, facts: RunFacts, text: impl FnMut(u32) -> String) -> RunSummary {
        let completed = facts.run.outcome == Outcome::Completed;
        let of_whole = |value: f64| if completed { value } else { f64::NAN };
        let joint_error = facts.run.joint_error.filter(|_| completed);
        RunSummary {
            controller: facts.controller,
            machine: facts.machine,
            part: facts.part,
            axes: facts.axes,
            role: facts.role,
            outcome: facts.run.outcome,
            faded_out: facts.run.faded_out,
            transitions: facts.run.transitions,
            engaged_share: facts.run.engaged_share,
            engaged_at_end: facts.run.engaged_at_end,
            time_s: of_whole(facts.run.time_s),
            rms_um: of_whole(self.rms_um()),
            max_um: of_whole(self.max_um()),
            joint_rms_um: joint_error.map(|joints| joints.rms_mm * 1e3),
            joint_max_um: joint_error.map(|joints| joints.max_mm * 1e3),
            uncut_um: of_whole(facts.run.uncut_mm * 1e3),
            max_deviation_um: self.max_deviation_mm * 1e3,
            max_command_accel_mm_s2: self.max_command_accel_mm_s2,
            command_share: facts
                .drives
                .filter(|_| !facts.role.is_measured())
                .map(|drives| {
                    drives.shares(facts.axes, self.axis_accel_mm_s2, self.peak_torque_nm)
                }),
            peak_torque_nm: (!facts.role.is_measured()).then_some(self.peak_torque_nm),
            feed: self.feed.shares(),
            cutting_length_mm: self.cutting_length_mm,
            cutting_time_s: self.cutting_time_s,
            rows: self.rows,
            arrival_s: of_whole(facts.run.arrival_s),
            tick_median_us: facts.run.ticks.quantile_us(0.5),
            tick_p999_us: facts.run.ticks.quantile_us(0.999),
            most_register_entries: facts.run.most_entries,
            worst: self.worst.places(text),
            histogram: self.counts.histogram(),
        }
    }

    /// Returns the root mean square of the contour error over the rows that cut, µm; 0 without such
    /// rows.
    pub fn rms_um(&self) -> f64 {
        if self.cutting_rows == 0 {
            0.0
        } else {
            (self.square_sum_mm2 / self.cutting_rows as f64).sqrt() * 1e3
        }
    }

    /// Returns the largest distance of the corrected reference from the programmed path's point of
    /// the same row, µm.
    pub fn max_deviation_um(&self) -> f64 {
        self.max_deviation_mm * 1e3
    }

    /// Returns the largest acceleration of the command of any axis, mm/s2.
    pub fn max_command_accel_mm_s2(&self) -> f64 {
        self.max_command_accel_mm_s2
    }

    /// Returns the largest torque of each axis, N m.
    pub fn peak_torque_nm(&self) -> [f64; 3] {
        self.peak_torque_nm
    }

    /// Returns the largest |contour error| over the rows that cut, µm.
    pub fn max_um(&self) -> f64 {
        self.max_mm * 1e3
    }

    fn cut(&mut self, row: &Row) {
        let error_mm = row.contour_error_mm;
        self.cutting_rows += 1;
        self.square_sum_mm2 += error_mm * error_mm;
        self.max_mm = self.max_mm.max(error_mm.abs());
        self.worst.row(row);
        if let Some(last) = self.previous {
            self.cutting_time_s += row.t_s - last.t_s;
            self.cutting_length_mm += (row.s_mm - last.s_mm).max(0.0);
            self.feed.add(
                distance(row.act_mm, last.act_mm),
                row.t_s - last.t_s,
                row.programmed_mm_s,
            );
        }
        self.counts.add(error_mm * 1e3);
    }
}

impl Sink for Statistics {
    fn row(&mut self, row: &Row) -> io::Result<()> {
        let numbers = [
            row.path_mm,
            row.act_mm,
            row.cmd_mm,
            row.corrected_mm,
            row.torque_nm,
        ];
        let scalars = [row.t_s, row.s_mm, row.contour_error_mm];
        if !numbers
            .iter()
            .flatten()
            .chain(&scalars)
            .all(|x| x.is_finite())
        {
            return Ok(());
        }
        self.rows += 1;
        for k in 0..3 {
            self.peak_torque_nm[k] = self.peak_torque_nm[k].max(row.torque_nm[k].abs());
        }
        let (c, p) = (row.corrected_mm, row.path_mm);
        let deviation_mm = libm::hypot(libm::hypot(c[0] - p[0], c[1] - p[1]), c[2] - p[2]);
        self.max_deviation_mm = self.max_deviation_mm.max(deviation_mm);
        if let Some(accel) = self.acceleration.push(row.t_s, row.cmd_mm) {
            let accel_mm_s2 = libm::hypot(libm::hypot(accel[0], accel[1]), accel[2]);
            self.max_command_accel_mm_s2 = self.max_command_accel_mm_s2.max(accel_mm_s2);
            self.axis_accel_mm_s2
                .iter_mut()
                .zip(accel)
                .for_each(|(most, accel)| *most = most.max(accel.abs()));
        }
        if row.cutting {
            self.cut(row);
        }
        self.previous = Some(*row);
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::row;

    fn statistics_of(errors_um: &[f64]) -> Statistics {
        let mut statistics = Statistics::new();
        for (k, error) in errors_um.iter().enumerate() {
            statistics
                .row(&Row {
                    contour_error_mm: error * 1e-3,
                    ..row(k as f64 * 1e-3)
                })
                .unwrap();
        }
        statistics
    }

    #[test]
    fn rms_of_a_sine_is_its_amplitude_over_root_two() {
        let sine: Vec<f64> = (0..1000)
            .map(|k| 10.0 * libm::sin(f64::from(k) * std::f64::consts::TAU / 1000.0))
            .collect();
        let statistics = statistics_of(&sine);
        assert!((statistics.rms_um() - 10.0 / 2f64.sqrt()).abs() < 1e-9);
        assert!((statistics.max_um() - 10.0).abs() < 1e-12);
    }

    /// A command along x^2 + y^2 = r^2 has v^2 / r, a jump over a rest has none.
    #[test]
    fn the_acceleration_of_the_command_follows_from_its_curve() {
        let (radius_mm, speed_mm_s) = (10.0, 50.0);
        let at = |t_s: f64| {
            let angle: f64 = speed_mm_s / radius_mm * t_s;
            [
                radius_mm * libm::cos(angle),
                radius_mm * libm::sin(angle),
                0.0,
            ]
        };
        let mut statistics = Statistics::new();
        for t_s in (0..100).map(|k| f64::from(k) * 1e-3) {
            statistics
                .row(&Row {
                    cmd_mm: at(t_s),
                    path_mm: at(t_s),
                    ..row(t_s)
                })
                .unwrap();
        }
        statistics
            .row(&Row {
                cmd_mm: [900.0, 0.0, 0.0],
                ..row(5.0)
            })
            .unwrap();
        statistics
            .row(&Row {
                cmd_mm: [900.0, 0.0, 0.0],
                ..row(5.001)
            })
            .unwrap();
        let facts = RunFacts {
            axes: 2,
            ..RunFacts::default()
        };
        let accel_mm_s2 = statistics
            .summary(facts, |_| String::new())
            .max_command_accel_mm_s2;
        assert!(
            (accel_mm_s2 / (speed_mm_s * speed_mm_s / radius_mm) - 1.0).abs() < 1e-4,
            "{accel_mm_s2}"
        );
    }

    /// F is 10 mm/s: a second each at 5, 10, 13 and 8.5 mm/s, and a rapid that does not count.
    #[test]
    fn feed_shares_are_those_of_the_time_outside_a_fifth_of_f() {
        let mut statistics = Statistics::new();
        let (mut t_s, mut x_mm) = (0.0, 0.0);
        for (speed_mm_s, programmed_mm_s) in [
            (5.0, 10.0),
            (10.0, 10.0),
            (13.0, 10.0),
            (8.5, 10.0),
            (90.0, 0.0),
        ] {
            for _ in 0..100 {
                statistics
                    .row(&Row {
                        act_mm: [0.0, x_mm, 0.0],
                        programmed_mm_s,
                        ..row(t_s)
                    })
                    .unwrap();
                (t_s, x_mm) = (t_s + 0.01, x_mm + 0.01 * speed_mm_s);
            }
        }
        let facts = RunFacts {
            axes: 2,
            ..RunFacts::default()
        };
        let feed = statistics.summary(facts, |_| String::new()).feed.unwrap();
        // Each row has the speed of the interval before it, and the first row has none.
        assert!(
            (feed.slow_share - 0.25).abs() < 0.01 && (feed.fast_share - 0.25).abs() < 0.01,
            "{feed:?}"
        );
        assert!((feed.largest - 1.3).abs() < 1e-9, "{feed:?}");
    }

    /// 3, 4 and 12 um in the three axes are 13 um.
    #[test]
    fn the_deviation_of_the_command_is_that_in_space() {
        for (at_um, deviation_um) in [([3.0, 4.0, 12.0], 13.0), ([0.0, 0.0, -7.0], 7.0)] {
            let mut statistics = Statistics::new();
            statistics
                .row(&Row {
                    path_mm: [1.0; 3],
                    corrected_mm: at_um.map(|um: f64| 1.0 + um * 1e-3),
                    ..row(0.0)
                })
                .unwrap();
            assert!(
                (statistics.max_deviation_um() - deviation_um).abs() < 1e-9,
                "{}",
                statistics.max_deviation_um()
            );
        }
    }

    #[test]
    fn rapids_count_for_torque_but_not_for_the_error() {
        let mut statistics = statistics_of(&[1.0, -1.0]);
        let rapid = Row {
            cutting: false,
            contour_error_mm: 9.0,
            torque_nm: [0.0, -2.0, 0.0],
            ..row(1.0)
        };
        statistics.row(&rapid).unwrap();
        let facts = RunFacts {
            axes: 2,
            ..RunFacts::default()
        };
        let summary = statistics.summary(facts, |_| String::new());
        assert!((summary.rms_um - 1.0).abs() < 1e-12 && (summary.max_um - 1.0).abs() < 1e-12);
        assert_eq!(summary.peak_torque_nm, Some([0.0, 2.0, 0.0]));
        assert!(
            (summary.cutting_time_s - 1e-3).abs() < 1e-15,
            "{}",
            summary.cutting_time_s
        );
    }
}
