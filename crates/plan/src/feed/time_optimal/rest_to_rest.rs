//! Straight from rest to rest: the closed form, where nothing else is to be decided, and where
//! nothing else works.
//!
//! Jerk, acceleration and speed have one bound each along the line; seven phases or fewer. Source:
//! Biagiotti and Melchiorri (2008), "Trajectory Planning for Automatic Machines and Robots",
//! section 3.4.

use super::steps::{AxisCaps, PlannedStep};
use crate::feed::AxisMotion;
use crate::vector::{norm, scale, sub};

/// Jerks with their durations.
fn phases(length_mm: f64, v: f64, a: f64, j: f64) -> [(f64, f64); 7] {
    // Time of jerk and of constant acceleration, then the way of speeding up and down without
    // cruising.
    let (mut jerk_s, mut hold_s) = if v * j < a * a {
        ((v / j).sqrt(), 0.0)
    } else {
        (a / j, v / a - a / j)
    };
    let way = |jerk_s: f64, hold_s: f64| j * jerk_s * (jerk_s + hold_s) * (2.0 * jerk_s + hold_s);
    let mut cruise_s = (length_mm - way(jerk_s, hold_s)) / v;
    if cruise_s < 0.0 {
        cruise_s = 0.0;
        jerk_s = libm::cbrt(length_mm / (2.0 * j)).min(a / j);
        // j T (T + H) (2 T + H) = L, solved for H.
        let rest = length_mm / (j * jerk_s);
        hold_s = (0.5 * ((jerk_s * jerk_s + 4.0 * rest).sqrt() - 3.0 * jerk_s)).max(0.0);
    }
    [
        (j, jerk_s),
        (0.0, hold_s),
        (-j, jerk_s),
        (0.0, cruise_s),
        (-j, jerk_s),
        (0.0, hold_s),
        (j, jerk_s),
    ]
}

/// Steps from one point to another, standing for the path between two places.
pub(super) fn straight(
    from_mm: [f64; 3],
    to_mm: [f64; 3],
    places_mm: [f64; 2],
    feed_mm_s: f64,
    caps: &AxisCaps,
) -> Vec<PlannedStep> {
    let way = sub(to_mm, from_mm);
    let length_mm = norm(way);
    if length_mm <= 0.0 {
        return Vec::new();
    }
    let direction = scale(1.0 / length_mm, way);
    let v = feed_mm_s.min(caps.along(direction, |limits| limits.velocity_mm_s));
    let (a, j) = (
        caps.along(direction, |l| l.accel_mm_s2),
        caps.along(direction, |l| l.jerk_mm_s3),
    );
    let mut steps = Vec::new();
    let (mut s, mut speed, mut accel) = (0.0, 0.0, 0.0);
    let place = |s: f64| places_mm[0] + (s / length_mm).min(1.0) * (places_mm[1] - places_mm[0]);
    for (jerk, duration_s) in phases(length_mm, v, a, j) {
        if duration_s <= 0.0 {
            continue;
        }
        let motion = AxisMotion {
            position_mm: std::array::from_fn(|k| from_mm[k] + s * direction[k]),
            velocity_mm_s: scale(speed, direction),
            accel_mm_s2: scale(accel, direction),
            jerk_mm_s3: scale(jerk, direction),
        };
        let t = duration_s;
        let end = s + t * (speed + t * (0.5 * accel + t * jerk / 6.0));
        steps.push(PlannedStep {
            from_mm: place(s),
            to_mm: place(end),
            duration_s,
            motion,
        });
        s = end;
        speed += t * (accel + 0.5 * t * jerk);
        accel += t * jerk;
    }
    if let Some(last) = steps.last_mut() {
        last.to_mm = places_mm[1];
    }
    steps
}
