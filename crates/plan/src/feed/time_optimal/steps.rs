//! Steps of constant jerk per axis, beside the path.

use crate::constraints::AxisLimits;
use crate::feed::AxisMotion;
use crate::vector::dot;

/// Part by which rounding may exceed a jerk.
const JERK_OVER: f64 = 1e-4;

/// Limits of the three axes.
#[derive(Debug, Clone, Copy)]
pub(super) struct AxisCaps {
    pub(super) axes: [AxisLimits; 3],
}

impl AxisCaps {
    /// Limit along `direction`: the axis that reaches its own limit first sets it. `of` selects the
    /// limit, whose unit the result has.
    pub(super) fn along(&self, direction: [f64; 3], of: impl Fn(&AxisLimits) -> f64) -> f64 {
        let parts = self
            .axes
            .iter()
            .zip(direction)
            .filter(|(_, part)| part.abs() > 1e-12);
        parts
            .map(|(limits, part)| of(limits) / part.abs())
            .fold(f64::INFINITY, f64::min)
    }

    /// Returns true if each axis keeps its jerk limit in a step, up to rounding.
    pub(super) fn keeps_jerk(&self, step: &PlannedStep) -> bool {
        let mut axes = self.axes.iter().zip(step.motion.jerk_mm_s3);
        axes.all(|(limits, jerk_mm_s3)| jerk_mm_s3.abs() <= (1.0 + JERK_OVER) * limits.jerk_mm_s3)
    }

    /// Returns the time that the slowest axis takes to stop from a speed, s: `v / a + a / j`, or `2
    /// sqrt(v / j)` where it does not reach its acceleration limit.
    pub(super) fn stop_s(&self, speed_mm_s: f64) -> f64 {
        let stop_s = |limits: &AxisLimits| {
            let AxisLimits {
                velocity_mm_s,
                accel_mm_s2,
                jerk_mm_s3,
            } = *limits;
            let speed_mm_s = velocity_mm_s.min(speed_mm_s);
            if speed_mm_s * jerk_mm_s3 < accel_mm_s2 * accel_mm_s2 {
                2.0 * (speed_mm_s / jerk_mm_s3).sqrt()
            } else {
                speed_mm_s / accel_mm_s2 + accel_mm_s2 / jerk_mm_s3
            }
        };
        self.axes.iter().map(stop_s).fold(0.0, f64::max)
    }
}

/// A step from one place of the programmed path to another.
#[derive(Debug, Clone, Copy)]
pub(super) struct PlannedStep {
    pub(super) from_mm: f64,
    pub(super) to_mm: f64,
    pub(super) duration_s: f64,
    /// Position and motion of the axes at the start of the step.
    pub(super) motion: AxisMotion,
}

/// Largest number of iterations: as many as bisection alone would take.
const MOST_NEWTON: u32 = 52;

/// Place on the programmed path over the time of a step: `s, s', s'' / 2, s''' / 6`.
pub(super) type PlacePowers = [f64; 4];

/// The place of the programmed path that stands for each moment of a step: with the speed of the
/// motion along the path at both ends, or, where that would run backwards, evenly.
pub(super) fn place_powers(step: &PlannedStep, from: [f64; 3], to: [f64; 3]) -> PlacePowers {
    let h = step.duration_s;
    let way_mm = step.to_mm - step.from_mm;
    let mean = way_mm / h;
    let first = dot(step.motion.velocity_mm_s, from);
    let last = dot(step.motion.after(h).velocity_mm_s, to);
    // Fritsch and Carlson (1980): no more than three times the mean at either end is monotone.
    if (0.0..=3.0 * mean).contains(&first) && (0.0..=3.0 * mean).contains(&last) {
        [
            step.from_mm,
            first,
            (3.0 * mean - 2.0 * first - last) / h,
            (first + last - 2.0 * mean) / (h * h),
        ]
    } else {
        [step.from_mm, mean, 0.0, 0.0]
    }
}

/// The place after a time.
pub(super) fn place_after(powers: &PlacePowers, t: f64) -> f64 {
    powers[0] + t * (powers[1] + t * (powers[2] + t * powers[3]))
}

/// Returns the time at which a place is reached, s. Uses Newton's method, and bisection where that
/// leaves the known interval.
pub(super) fn time_of_place(powers: &PlacePowers, place_mm: f64, duration_s: f64) -> f64 {
    let (mut lo, mut hi) = (0.0, duration_s);
    let mut t = 0.5 * duration_s;
    for _ in 0..MOST_NEWTON {
        let missed_mm = place_after(powers, t) - place_mm;
        if missed_mm < 0.0 {
            lo = t;
        } else {
            hi = t;
        }
        let speed_mm_s = powers[1] + t * (2.0 * powers[2] + t * 3.0 * powers[3]);
        let next = t - missed_mm / speed_mm_s;
        let next = if next > lo && next < hi {
            next
        } else {
            0.5 * (lo + hi)
        };
        if (next - t).abs() <= f64::EPSILON * duration_s {
            return next;
        }
        t = next;
    }
    t
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn places_rise_from_one_end_of_a_step_to_the_other_and_each_has_its_time(
            (from_mm, way_mm, duration_s) in (0.0..100.0_f64, 0.01..2.0_f64, 1e-3..0.1_f64),
            (first, last) in (-1.0..4.0_f64, -1.0..4.0_f64),
            part in 0.0..1.0_f64,
        ) {
            // Straight along X, with these parts of the mean speed at its ends.
            let mean_mm_s = way_mm / duration_s;
            let along = |part: f64| [part * mean_mm_s, 0.0, 0.0];
            let accel_mm_s2 = along((last - first) / duration_s);
            let motion = AxisMotion { velocity_mm_s: along(first), accel_mm_s2, ..AxisMotion::REST };
            let step = PlannedStep { from_mm, to_mm: from_mm + way_mm, duration_s, motion };
            let powers = place_powers(&step, [1.0, 0.0, 0.0], [1.0, 0.0, 0.0]);
            let places: Vec<f64> = (0..=50).map(|n| place_after(&powers, duration_s * f64::from(n) / 50.0)).collect();
            prop_assert!((places[0] - from_mm).abs() < 1e-9 && (places[50] - step.to_mm).abs() < 1e-9, "{places:?}");
            prop_assert!(places.windows(2).all(|pair| pair[1] >= pair[0] - 1e-9), "{places:?}");
            if (0.0..=3.0).contains(&first) && (0.0..=3.0).contains(&last) {
                let end = powers[1] + duration_s * (2.0 * powers[2] + 3.0 * duration_s * powers[3]);
                prop_assert!((powers[1] / mean_mm_s - first).abs() < 1e-9 && (end / mean_mm_s - last).abs() < 1e-9);
            }
            let place_mm = from_mm + part * way_mm;
            let found_mm = place_after(&powers, time_of_place(&powers, place_mm, duration_s));
            prop_assert!((found_mm - place_mm).abs() < 1e-9, "{found_mm} in place of {place_mm}");
        }
    }
}
