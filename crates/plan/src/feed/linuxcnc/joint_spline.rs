//! From servo periods to motion: the cubic that LinuxCNC's joints run through.
//!
//! Commands of servo periods are the control points of a uniform cubic B-spline: with points `p`,
//! the position at the beginning of a period is `(p_0 + 4 p_1 + p_2) / 6`, the velocity `(p_2 -
//! p_0) / 2 T`, the acceleration `(p_0 - 2 p_1 + p_2) / T^2`, and the jerk is constant, `(p_3 - 3
//! p_2 + 3 p_1 - p_0) / T^3`. The place on the program goes through the same spline, and so stays
//! monotone.

use super::limits::PERIOD_S;
use crate::feed::AxisMotion;
use crate::vector::Vector;

/// A command, and the arc length of the program that it stands for.
#[derive(Debug, Clone, Copy)]
pub(super) struct PeriodPoint {
    /// Position, mm.
    pub(crate) position_mm: Vector,
    /// Arc length, mm.
    pub(crate) station_mm: f64,
}

/// The motion of one servo period.
#[derive(Debug, Clone, Copy)]
pub(super) struct PeriodMotion {
    /// Motion of the axes.
    pub(crate) axes: AxisMotion,
    /// Arc length, speed, acceleration and jerk of the place on the program, at the beginning.
    pub(crate) station: [f64; 4],
}

/// The last points.
#[derive(Debug)]
pub(super) struct JointSpline {
    points: [PeriodPoint; 3],
}

impl JointSpline {
    /// Creates a spline that rests at a point.
    pub(super) const fn at_rest(at: PeriodPoint) -> Self {
        Self { points: [at; 3] }
    }

    /// The motion of the period that the next point completes.
    pub(super) fn next(&mut self, point: PeriodPoint) -> PeriodMotion {
        let [a, b, c] = self.points;
        self.points = [b, c, point];
        let axis = |k: usize| cubic([a, b, c, point].map(|p| p.position_mm[k]));
        let axes = [axis(0), axis(1), axis(2)];
        let power = |i: usize| std::array::from_fn(|k| axes[k][i]);
        let axes = AxisMotion {
            position_mm: power(0),
            velocity_mm_s: power(1),
            accel_mm_s2: power(2),
            jerk_mm_s3: power(3),
        };
        PeriodMotion {
            axes,
            station: cubic([a, b, c, point].map(|p| p.station_mm)),
        }
    }
}

/// Value and derivatives at the beginning of a part of the spline.
fn cubic([a, b, c, d]: [f64; 4]) -> [f64; 4] {
    // By differences: points far from the origin lose nothing.
    let (before, after, behind) = (b - a, c - b, d - c);
    let t = PERIOD_S;
    [
        b + (after - before) / 6.0,
        0.5 * (before + after) / t,
        (after - before) / (t * t),
        (behind - 2.0 * after + before) / (t * t * t),
    ]
}
