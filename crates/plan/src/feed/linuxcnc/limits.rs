//! Settings that LinuxCNC reads from its INI file, and the limits of axes as limits along a
//! direction.

use crate::constraints::{AxisLimits, Constraints};
use crate::vector::Vector;

/// Servo period, `[EMCMOT]SERVO_PERIOD`, s.
pub(super) const PERIOD_S: f64 = 1e-3;

/// Largest feed override, `[DISPLAY]MAX_FEED_OVERRIDE`: corners are laid out for it.
pub(super) const MAX_OVERRIDE: f64 = 2.0;

/// Blocks that the look-ahead goes back over, `[TRAJ]ARC_BLEND_OPTIMIZATION_DEPTH`.
pub(super) const DEPTH: usize = 50;

/// Part of the acceleration that a corner without a blend may take, `[TRAJ]ARC_BLEND_KINK_RATIO`.
pub(super) const KINK_RATIO: f64 = 0.1;

/// A line that takes fewer servo periods than this goes into the blend behind it,
/// `[TRAJ]ARC_BLEND_GAP_CYCLES`.
pub(super) const GAP_PERIODS: f64 = 4.0;

/// Segments shorter than one period of this are run through at one acceleration,
/// `[TRAJ]ARC_BLEND_RAMP_FREQ`, Hz.
pub(super) const RAMP_HZ: f64 = 100.0;

/// Part of the acceleration of a circle for tangential acceleration, at least, and for normal
/// acceleration, at most.
pub(super) const TANGENTIAL_RATIO: f64 = 0.5;
pub(super) const NORMAL_RATIO: f64 = 0.866_025_403_784_438_6;

/// No distance.
pub(super) const NO_DISTANCE_MM: f64 = 1e-12;

/// Limits of the axes and of the path.
#[derive(Debug, Clone)]
pub(super) struct DirectionLimits {
    /// Speed of each axis.
    pub(crate) velocity_mm_s: Vector,
    /// Acceleration of each axis.
    pub(crate) accel_mm_s2: Vector,
    /// Speed along the path.
    pub(crate) path_mm_s: f64,
}

impl DirectionLimits {
    /// Takes the limits of a machine. An axis without limits of its own takes those of the last
    /// axis that has some.
    pub(super) fn new(constraints: &Constraints) -> Self {
        let axis = |k: usize| constraints.axis(k).unwrap_or(AxisLimits::NONE);
        let path = &constraints.path;
        let bounded = |value: f64| value.min(1e12);
        Self {
            velocity_mm_s: std::array::from_fn(|k| bounded(axis(k).velocity_mm_s)),
            accel_mm_s2: std::array::from_fn(|k| bounded(axis(k).accel_mm_s2)),
            path_mm_s: path.rapid_mm_s.max(path.max_feed_mm_s),
        }
    }

    /// Highest speed along a unit vector.
    pub(super) fn speed_mm_s(&self, direction: Vector) -> f64 {
        along(self.velocity_mm_s, direction)
    }

    /// Highest acceleration along a unit vector.
    pub(super) fn accel_along_mm_s2(&self, direction: Vector) -> f64 {
        along(self.accel_mm_s2, direction)
    }

    /// Speed and acceleration that are possible in every direction of the plane across a unit
    /// vector.
    pub(super) fn in_plane(&self, normal: Vector) -> [f64; 2] {
        [
            in_plane(self.velocity_mm_s, normal),
            in_plane(self.accel_mm_s2, normal),
        ]
    }

    /// The least speed and acceleration of the two axes beside the one that is nearest to a vector.
    pub(super) fn of_plane(&self, normal: Vector) -> [f64; 2] {
        let largest = (0..3).fold(0, |best, k| {
            if normal[k].abs() > normal[best].abs() {
                k
            } else {
                best
            }
        });
        let least = |values: Vector| {
            (0..3)
                .filter(|&k| k != largest)
                .map(|k| values[k])
                .fold(f64::INFINITY, f64::min)
        };
        [least(self.velocity_mm_s), least(self.accel_mm_s2)]
    }

    /// Largest part of its acceleration that an axis takes.
    pub(super) fn accel_part(&self, accel_mm_s2: Vector) -> f64 {
        (0..3)
            .map(|k| (accel_mm_s2[k] / self.accel_mm_s2[k]).abs())
            .fold(0.0, f64::max)
    }
}

fn along(limits: Vector, direction: Vector) -> f64 {
    (0..3)
        .filter(|&k| direction[k].abs() > 1e-7)
        .map(|k| limits[k] / direction[k].abs())
        .fold(1e12, f64::min)
}

/// An axis at an angle to the plane reaches its limit later.
fn in_plane(limits: Vector, normal: Vector) -> f64 {
    let part = |k: usize| (1.0 - normal[k] * normal[k]).max(0.0).sqrt().max(1e-12);
    (0..3)
        .map(|k| limits[k] / part(k))
        .fold(f64::INFINITY, f64::min)
}
