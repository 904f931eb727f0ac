//! The uncut path: how far the tool stays away from what it should have cut.
//!
//! ```text
//! uncut = max over feed points P(t) of the distance from P(t) to the tool's trace over [t - W, t + W],   W = 5 / Kp + delay
//! ```
//!
//! A feed point is where the reference stands at the start of a servo period in a programmed
//! cutting motion; the trace is the polyline through the tool's positions at the ends of the servo
//! periods. The contour error asks how far the tool is from the path; this asks how far the path is
//! from the tool, and sees the corner that was rounded, the spike that was cut short, the leg that
//! was left out. Feedforward can take the tool ahead of the command, so that it has been at a feed
//! point before the command comes there; the time before `t` counts for that reason.
//!
//! Skip a feed point once its distance from the trace is no more than the largest found so far. A
//! point that is further by `g` is checked again when the tool has moved by `g`, since it cannot
//! come nearer before. A point that remains at the end of its time is measured against the trace
//! over all of its time; it then nearly always is the new largest. One servo period therefore takes
//! only a few comparisons.

use std::collections::VecDeque;

use feedwright_plan::vector::{Vector, add_scaled, distance, dot, sub};

use crate::row::{Commanded, Row};

/// The uncut path of a run.
pub struct Uncut {
    /// Servo periods in which the tool has to come to a feed point.
    periods: u64,
    /// Servo periods so far.
    rows: u64,
    largest_mm: f64,
    /// Tool positions at the start of servo period `rows` and of the periods before; the newest is
    /// last.
    trace_mm: VecDeque<Vector>,
    /// Length of the trace.
    way_mm: f64,
    waiting: VecDeque<FeedPoint>,
    last_mm: Option<Vector>,
}

/// A feed point that the tool has not come near to.
struct FeedPoint {
    point_mm: Vector,
    row: u64,
    /// Its distance from the trace before.
    before_mm: f64,
    /// Length of the trace from which on it can be nearer.
    again_mm: f64,
}

impl Uncut {
    /// Starts with a tool at rest at `start_mm` that has `periods` servo periods for each feed
    /// point.
    pub fn new(periods: usize, start_mm: Vector) -> Self {
        Self {
            periods: periods.max(1) as u64,
            rows: 0,
            largest_mm: 0.0,
            trace_mm: VecDeque::from([start_mm]),
            way_mm: 0.0,
            waiting: VecDeque::new(),
            last_mm: None,
        }
    }

    /// Takes a row.
    pub fn row(&mut self, row: &Row) {
        let from_mm = self.trace_mm[self.trace_mm.len() - 1];
        if row.commanded == Commanded::Cut && self.last_mm != Some(row.path_mm) {
            let before_mm = self.to_trace(row.path_mm, 0);
            if before_mm > self.largest_mm {
                let again_mm = self.way_mm + distance(row.path_mm, from_mm) - self.largest_mm;
                self.waiting.push_back(FeedPoint {
                    point_mm: row.path_mm,
                    row: self.rows,
                    before_mm,
                    again_mm,
                });
            }
        }
        self.last_mm = Some(row.path_mm);
        self.go(from_mm, row.act_mm);
        self.rows += 1;
        while self
            .waiting
            .front()
            .is_some_and(|point| point.row + self.periods <= self.rows)
        {
            self.settle();
        }
        if self.trace_mm.len() as u64 > self.periods + 1 {
            self.trace_mm.pop_front();
        }
    }

    /// The largest distance, mm. A tool within `arrived_mm` of the end has arrived there, though
    /// its rows end before it settles.
    pub fn finish(mut self, arrived_mm: f64) -> f64 {
        let last_mm = self.trace_mm[self.trace_mm.len() - 1];
        if let Some(end_mm) = self.last_mm
            && distance(last_mm, end_mm) <= arrived_mm
        {
            self.trace_mm.push_back(end_mm);
            self.rows += 1;
        }
        while !self.waiting.is_empty() {
            self.settle();
        }
        self.largest_mm
    }

    /// The tool goes straight on.
    fn go(&mut self, from_mm: Vector, to_mm: Vector) {
        self.way_mm += distance(from_mm, to_mm);
        self.trace_mm.push_back(to_mm);
        let (way_mm, largest_mm) = (self.way_mm, self.largest_mm);
        self.waiting.retain_mut(|point| {
            if point.again_mm > way_mm {
                return true;
            }
            point.again_mm = way_mm + distance(point.point_mm, to_mm) - largest_mm;
            to_segment(point.point_mm, from_mm, to_mm) > largest_mm
        });
    }

    /// The time of the oldest feed point is over.
    fn settle(&mut self) {
        let Some(FeedPoint {
            point_mm,
            row,
            before_mm,
            ..
        }) = self.waiting.pop_front()
        else {
            return;
        };
        let first = self.trace_mm.len() as u64 - 1 - (self.rows - row);
        let nearest = self.to_trace(point_mm, first as usize).min(before_mm);
        if nearest.is_finite() {
            self.largest_mm = self.largest_mm.max(nearest);
        }
    }

    /// Distance of a point from the trace, from its `first` position on; infinite where the trace
    /// has not begun.
    fn to_trace(&self, point_mm: Vector, first: usize) -> f64 {
        let trace = self
            .trace_mm
            .range(first..)
            .zip(self.trace_mm.range(first + 1..));
        trace
            .map(|(from, to)| to_segment(point_mm, *from, *to))
            .fold(f64::INFINITY, f64::min)
    }
}

/// Distance of a point to a straight line between two others.
fn to_segment(point_mm: Vector, from_mm: Vector, to_mm: Vector) -> f64 {
    let along = sub(to_mm, from_mm);
    let square = dot(along, along);
    let part = if square > 0.0 {
        (dot(sub(point_mm, from_mm), along) / square).clamp(0.0, 1.0)
    } else {
        0.0
    };
    distance(point_mm, add_scaled(from_mm, part, along))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A path of one feed point a period, and a tool that is where `tool` says at the end of each.
    fn uncut(path: &[Vector], tool: impl Fn(usize) -> Vector, periods: usize) -> f64 {
        let mut uncut = Uncut::new(periods, path[0]);
        for (n, &path_mm) in path.iter().enumerate() {
            let act_mm = tool(n);
            uncut.row(&Row {
                path_mm,
                act_mm,
                ..Row::AT_REST
            });
        }
        uncut.finish(0.01)
    }

    /// Computes the uncut path by its definition.
    fn by_definition(path: &[Vector], tool: impl Fn(usize) -> Vector, periods: usize) -> f64 {
        let at = |n: usize| if n == 0 { path[0] } else { tool(n - 1) };
        let nearest = |n: usize| {
            let ends = (n + 1).saturating_sub(periods).max(1)..=(n + periods).min(path.len());
            ends.map(|k| to_segment(path[n], at(k - 1), at(k)))
                .fold(f64::INFINITY, f64::min)
        };
        (0..path.len()).map(nearest).fold(0.0, f64::max)
    }

    /// Teeth of 0.5 mm, 10 um a period.
    fn battlement() -> Vec<Vector> {
        let mut corners = vec![[0.0, 0.0, 0.0]];
        for tooth in 0..4 {
            let x = f64::from(tooth);
            corners.extend([
                [x, 0.5, 0.0],
                [x + 0.5, 0.5, 0.0],
                [x + 0.5, 0.0, 0.0],
                [x + 1.0, 0.0, 0.0],
            ]);
        }
        let leg = |ends: &[Vector]| -> Vec<Vector> {
            (0..50)
                .map(|k| add_scaled(ends[0], f64::from(k) / 50.0, sub(ends[1], ends[0])))
                .collect()
        };
        corners.windows(2).flat_map(leg).collect()
    }

    #[test]
    fn a_tool_that_lags_leaves_nothing_uncut() {
        let mut path = battlement();
        path.extend([path[path.len() - 1]; 30]);
        assert!(uncut(&path, |n| path[n.saturating_sub(20)], 100) < 1e-12);
        assert!(uncut(&path, |n| path[(n + 1).min(path.len() - 1)], 100) < 1e-12);
    }

    #[test]
    fn a_tool_that_stays_on_a_leg_that_it_has_passed_leaves_the_others_uncut() {
        let path = battlement();
        let stays = |n: usize| path[if (220..400).contains(&n) { 210 } else { n }];
        let largest_mm = uncut(&path, stays, 100);
        assert!(largest_mm > 0.4, "{largest_mm}");
    }

    #[test]
    fn a_tool_that_is_ahead_of_the_command_and_does_not_come_back_leaves_nothing_uncut() {
        let path = battlement();
        assert!(uncut(&path, |n| path[(n + 20).min(path.len() - 1)], 100) < 1e-12);
    }

    #[test]
    fn it_is_what_its_definition_says() {
        let path = battlement();
        for (lag, wobble) in [(0, 0.0), (7, 1e-3), (20, 0.02), (90, 0.1), (150, 0.3)] {
            let tool = |n: usize| {
                let phase = n as f64 * 0.3;
                add_scaled(
                    path[n.saturating_sub(lag)],
                    wobble,
                    [libm::sin(phase), libm::cos(1.7 * phase), 0.0],
                )
            };
            for periods in [1, 20, 100] {
                let (found, wanted) = (
                    uncut(&path, tool, periods),
                    by_definition(&path, tool, periods),
                );
                assert!(
                    (found - wanted).abs() < 1e-12,
                    "{lag} {wobble} {periods}: {found} {wanted}"
                );
            }
        }
    }
}
