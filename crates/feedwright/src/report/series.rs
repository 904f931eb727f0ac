//! Series: the record of a run for drawing, bounded for any length of the run.
//!
//! Rows are gathered in buckets of equal row count. When [`Series::MAX_POINTS`] buckets are full,
//! neighbors merge in pairs and each bucket takes twice as many rows. A bucket is represented by
//! its row of largest contour error, and it keeps the least and the largest error, so that no peak
//! is lost at any resolution.

use std::io;

use feedwright_plan::vector::{distance, sub};
use feedwright_sim::{Row, Sink};

use super::outline::{OutlineBuilder, Vertex};

/// One point of a [`Series`]: a few successive rows, represented by the one with the largest
/// contour error.
///
/// If any of the rows cuts, only rows that cut count for the error.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SeriesPoint {
    /// Time of the row, s.
    pub t_s: f64,
    /// Arc length along the programmed path, mm.
    pub(crate) s_mm: f64,
    /// Line of the program.
    pub(crate) line: u32,
    /// True where any of the rows cuts.
    pub cutting: bool,
    /// Contour error of the row, mm, signed as in [`Row`].
    pub error_mm: f64,
    /// Least contour error of the rows, mm.
    pub error_min_mm: f64,
    /// Largest contour error of the rows, mm.
    pub error_max_mm: f64,
    /// Point of the programmed path nearest to the tool, mm.
    pub foot_mm: [f64; 3],
    /// Vector from `foot_mm` to the tool, mm: it has the length of `error_mm` and its direction in
    /// the drawing.
    pub deviation_mm: [f64; 3],
    /// Mean planned feedrate, mm/s.
    pub(crate) feed_plan_mm_s: f64,
    /// Mean actual speed of the tool, mm/s: length of the polyline through its positions over the
    /// time it took.
    pub(crate) feed_act_mm_s: f64,
    /// Torque of largest magnitude on each axis, N m, with its sign.
    pub(crate) torque_nm: [f64; 3],
    /// Acceleration of largest magnitude of each axis's command, mm/s2, with its sign: the second
    /// difference over servo periods.
    pub(crate) accel_mm_s2: [f64; 3],
}

/// Relative difference below which two periods are the same: times are rounded.
const SAME_PERIOD: f64 = 1e-3;

/// Acceleration of the command, by second differences over servo periods.
#[derive(Debug, Clone, Default)]
pub(super) struct CommandAcceleration {
    /// Times and commands of the last two rows, the last first.
    commands: [Option<(f64, [f64; 3])>; 2],
}

impl CommandAcceleration {
    /// Takes the command of a row. Returns the acceleration of each axis, mm/s2, if the previous
    /// rows are one period apart.
    pub(super) fn push(&mut self, t_s: f64, command_mm: [f64; 3]) -> Option<[f64; 3]> {
        let [last, before] = self.commands;
        self.commands = [Some((t_s, command_mm)), last];
        let ((last_s, last_mm), (before_s, before_mm)) = (last?, before?);
        let dt_s = t_s - last_s;
        let second = |k: usize| command_mm[k] - 2.0 * last_mm[k] + before_mm[k];
        let even = (dt_s - (last_s - before_s)).abs() <= SAME_PERIOD * dt_s;
        even.then(|| std::array::from_fn(|k| second(k) / (dt_s * dt_s)))
    }
}

/// Bounded record of a run.
#[derive(Debug, Clone)]
pub struct Series {
    buckets: Vec<Bucket>,
    rows_per_point: u64,
    outline: OutlineBuilder,
    previous: Option<(f64, [f64; 3])>,
    acceleration: CommandAcceleration,
}

#[derive(Debug, Clone, Copy)]
struct Bucket {
    /// Representative row; its feedrates are filled in when it is read.
    point: SeriesPoint,
    rows: u64,
    plan_sum_mm_s: f64,
    travel_mm: f64,
    span_s: f64,
}

impl Default for Series {
    fn default() -> Self {
        Self::new()
    }
}

impl Series {
    /// Largest number of points: ten for each pixel on a wide screen, and a page of less than 2 MB
    /// with two controllers. Even, so that a full record merges without a remainder.
    pub const MAX_POINTS: usize = 20_000;

    /// Creates an empty record.
    pub fn new() -> Self {
        Self {
            buckets: Vec::new(),
            rows_per_point: 1,
            outline: OutlineBuilder::default(),
            previous: None,
            acceleration: CommandAcceleration::default(),
        }
    }

    /// Returns the number of rows that one point represents.
    pub(crate) fn rows_per_point(&self) -> u64 {
        self.rows_per_point
    }

    /// Returns the points in order of time.
    pub fn points(&self) -> impl ExactSizeIterator<Item = SeriesPoint> {
        self.buckets.iter().map(Bucket::point)
    }

    /// Returns the programmed path, with its corners.
    pub(super) fn outline(&self) -> impl Iterator<Item = Vertex> {
        self.outline.vertices()
    }

    fn push(&mut self, bucket: Bucket) {
        match self.buckets.last_mut() {
            Some(last) if last.rows < self.rows_per_point => *last = last.merged(&bucket),
            _ => {
                if self.buckets.len() == Self::MAX_POINTS {
                    self.halve();
                }
                self.buckets.push(bucket);
            }
        }
    }

    fn halve(&mut self) {
        for i in 0..self.buckets.len() / 2 {
            self.buckets[i] = self.buckets[2 * i].merged(&self.buckets[2 * i + 1]);
        }
        self.buckets.truncate(self.buckets.len() / 2);
        self.rows_per_point *= 2;
    }
}

impl Sink for Series {
    /// Leaves out rows with a number that is not finite: only a run that diverged has them.
    fn row(&mut self, row: &Row) -> io::Result<()> {
        let numbers = [
            row.path_mm,
            row.act_mm,
            row.foot_mm,
            row.cmd_mm,
            row.torque_nm,
        ];
        let scalars = [row.t_s, row.s_mm, row.contour_error_mm, row.feed_plan_mm_s];
        if !numbers
            .iter()
            .flatten()
            .chain(&scalars)
            .all(|x| x.is_finite())
        {
            return Ok(());
        }
        let (travel_mm, span_s) = match self.previous {
            Some((t_s, act_mm)) => (distance(act_mm, row.act_mm), row.t_s - t_s),
            None => (0.0, 0.0),
        };
        self.previous = Some((row.t_s, row.act_mm));
        let accel_mm_s2 = self
            .acceleration
            .push(row.t_s, row.cmd_mm)
            .unwrap_or_default();
        self.outline.push(Vertex {
            point_mm: row.path_mm,
            cutting: row.cutting,
        });
        self.push(Bucket {
            point: SeriesPoint {
                t_s: row.t_s,
                s_mm: row.s_mm,
                line: row.line,
                cutting: row.cutting,
                error_mm: row.contour_error_mm,
                error_min_mm: row.contour_error_mm,
                error_max_mm: row.contour_error_mm,
                foot_mm: row.foot_mm,
                deviation_mm: sub(row.act_mm, row.foot_mm),
                feed_plan_mm_s: row.feed_plan_mm_s,
                feed_act_mm_s: 0.0,
                torque_nm: row.torque_nm,
                accel_mm_s2,
            },
            rows: 1,
            plan_sum_mm_s: row.feed_plan_mm_s,
            travel_mm,
            span_s,
        });
        Ok(())
    }
}

impl Bucket {
    fn point(&self) -> SeriesPoint {
        SeriesPoint {
            feed_plan_mm_s: self.plan_sum_mm_s / self.rows as f64,
            feed_act_mm_s: if self.span_s > 0.0 {
                self.travel_mm / self.span_s
            } else {
                0.0
            },
            ..self.point
        }
    }

    /// Merges this bucket with `next`, which follows it.
    fn merged(&self, next: &Self) -> Self {
        let (a, b) = (&self.point, &next.point);
        let mut point = match (a.cutting, b.cutting) {
            (true, false) => *a,
            (false, true) => *b,
            _ if b.error_mm.abs() > a.error_mm.abs() => *b,
            _ => *a,
        };
        if a.cutting == b.cutting {
            point.error_min_mm = a.error_min_mm.min(b.error_min_mm);
            point.error_max_mm = a.error_max_mm.max(b.error_max_mm);
        }
        for k in 0..3 {
            let larger = |x: f64, y: f64| if y.abs() > x.abs() { y } else { x };
            point.torque_nm[k] = larger(a.torque_nm[k], b.torque_nm[k]);
            point.accel_mm_s2[k] = larger(a.accel_mm_s2[k], b.accel_mm_s2[k]);
        }
        Self {
            point,
            rows: self.rows + next.rows,
            plan_sum_mm_s: self.plan_sum_mm_s + next.plan_sum_mm_s,
            travel_mm: self.travel_mm + next.travel_mm,
            span_s: self.span_s + next.span_s,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::report::row;

    #[test]
    fn actual_feed_is_the_speed_of_the_tool() {
        let mut series = Series::new();
        for k in 0..70_000 {
            let t = f64::from(k) * 1e-3;
            series
                .row(&Row {
                    act_mm: [30.0 * t, 40.0 * t, 0.0],
                    ..row(t)
                })
                .unwrap();
        }
        assert_eq!(series.rows_per_point(), 4);
        for point in series.points() {
            assert!((point.feed_act_mm_s - 50.0).abs() < 1e-6, "{point:?}");
        }
    }

    #[test]
    fn rapids_do_not_hide_the_cut_next_to_them() {
        let mut series = Series::new();
        for k in 0..=Series::MAX_POINTS {
            let cutting = k % 2 == 0;
            let error = if cutting { 0.001 } else { 5.0 };
            series
                .row(&Row {
                    cutting,
                    contour_error_mm: error,
                    ..row(k as f64)
                })
                .unwrap();
        }
        assert!(
            series
                .points()
                .all(|p| p.cutting && p.error_max_mm == 0.001)
        );
    }

    #[test]
    fn rows_that_are_not_finite_are_left_out() {
        let mut series = Series::new();
        series.row(&row(0.0)).unwrap();
        series
            .row(&Row {
                act_mm: [f64::NAN, 0.0, 0.0],
                ..row(1.0)
            })
            .unwrap();
        series
            .row(&Row {
                contour_error_mm: f64::INFINITY,
                ..row(2.0)
            })
            .unwrap();
        assert_eq!(series.points().len(), 1);
    }
}
