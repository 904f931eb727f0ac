//! The shortest way in which an axis stops, and with it a bound on the way along a path.

use super::published::PublishedPlan;
use crate::constraints::AxisLimits;

/// Returns the shortest distance in which an axis comes to rest, from a velocity of 0 or more and
/// an acceleration: jerk down to a deceleration, held where the limit requires it, and back up.
/// `None` if the acceleration makes the axis reverse before it rests.
fn braking_mm(velocity_mm_s: f64, accel_mm_s2: f64, limits: &AxisLimits) -> Option<f64> {
    let (v, a, j) = (velocity_mm_s, accel_mm_s2, limits.jerk_mm_s3);
    if a < 0.0 && v <= a * a / (2.0 * j) {
        return None;
    }
    let decel = (j * v + 0.5 * a * a).sqrt().min(limits.accel_mm_s2);
    let hold_s = ((v + (a * a - 2.0 * decel * decel) / (2.0 * j)) / decel).max(0.0);
    let mut way_mm = 0.0;
    let (mut speed, mut accel) = (v, a);
    for (jerk, time_s) in [(-j, (a + decel) / j), (0.0, hold_s), (j, decel / j)] {
        way_mm += time_s * (speed + time_s * (0.5 * accel + time_s * jerk / 6.0));
        speed += time_s * (accel + 0.5 * time_s * jerk);
        accel += time_s * jerk;
    }
    Some(way_mm)
}

/// The path is gone along for at least so far from a moment of a plan on before the tool can rest
/// on it, mm: each axis has to come as far along the path as it needs for itself. Where the path
/// leads it back before that, the axis says nothing.
pub fn shortest_stop_mm(plan: &PublishedPlan, axes: &[AxisLimits; 3], tau_s: f64) -> f64 {
    let begin = plan.at(tau_s);
    let mut until_s = tau_s;
    for k in 0..3 {
        let sign = begin.velocity_mm_s[k].signum();
        let (v, a) = (sign * begin.velocity_mm_s[k], sign * begin.accel_mm_s2[k]);
        // An axis that stands moves by rounding errors, and may wait for the next corner to do so.
        let Some(way_mm) = braking_mm(v, a, &axes[k]).filter(|way_mm| *way_mm > NO_WAY_MM) else {
            continue;
        };
        let mut at_s = tau_s;
        while at_s < plan.end_s() {
            let motion = plan.at(at_s);
            if sign * motion.velocity_mm_s[k] < 0.0 {
                break;
            }
            if sign * (motion.position_mm[k] - begin.position_mm[k]) >= way_mm {
                until_s = until_s.max(at_s);
                break;
            }
            at_s += STEP_S;
        }
    }
    plan.length_mm(tau_s, (until_s - STEP_S).max(tau_s))
}

/// A way of less than this is a rounding error, mm.
const NO_WAY_MM: f64 = 1e-9;

/// Plan time is looked through in steps of this, s.
const STEP_S: f64 = 5e-5;
