//! Slow ways to an end that the tool would overshoot: the end of a stretch, and the end of the
//! rapid that leads to one.
//!
//! A drive with feedforward overshoots by `a (T1^2 - T2)` where the command decelerates at `a`
//! until it rests. No geometry removes that. A last piece at a speed from which the drive brakes in
//! a fraction of the loop's time constant does. If that is not slow enough, it is halved from round
//! to round.

use feedwright_gcode::canon::{Motion, MotionKind, Shape};
use feedwright_plan::FitPoint;
use feedwright_plan::vector::{add_scaled, distance, norm, sub};
use feedwright_sim::Machine;

use super::stretches::SmoothStretch;
use super::target::PrintedTarget;

/// A straight motion is slowed down before its end if it is longer than the slow piece by this
/// factor.
const LEAST_WAY: f64 = 4.0;
/// Time constants of the loop in which the drive brakes from the slow speed, and time constants
/// that the slow way takes.
const BRAKES_IN: f64 = 0.25;
const SETTLES_IN: f64 = 2.0;

/// A slow way to an end that the tool would overshoot.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct SlowEnd {
    /// Speed of the last piece, mm/s.
    pub(super) speed_mm_s: f64,
    /// Its length, mm.
    pub(super) length_mm: f64,
}

impl SlowEnd {
    /// Returns a way at half the speed and half the length.
    pub(super) fn slower(self) -> Self {
        Self {
            speed_mm_s: 0.5 * self.speed_mm_s,
            length_mm: 0.5 * self.length_mm,
        }
    }

    /// Returns a way at the same speed with `part` of the length.
    pub(super) fn shorter(self, part: f64) -> Self {
        Self {
            length_mm: part * self.length_mm,
            ..self
        }
    }

    /// Returns the time of the slow way, s.
    pub(super) fn time_s(self) -> f64 {
        self.length_mm / self.speed_mm_s
    }

    /// Lowers the feedrates of the last points.
    pub(super) fn slow_down(self, points: &mut [FitPoint]) {
        let mut to_go_mm = 0.0;
        for n in (0..points.len().saturating_sub(1)).rev() {
            to_go_mm += distance(points[n].at_mm, points[n + 1].at_mm);
            points[n].feed_mm_s = points[n].feed_mm_s.min(self.speed_mm_s);
            if to_go_mm > self.length_mm {
                break;
            }
        }
        if let [.., before, last] = points {
            last.feed_mm_s = before.feed_mm_s;
        }
    }
}

/// Returns a way to the end. It is so slow that the drive brakes in a part of the loop's time
/// constant, and as long as the loop takes to settle.
pub(super) fn slow_end(machine: &Machine) -> SlowEnd {
    let slowest_s = 1.0 / machine.slowest_kp_1_s();
    let speed_mm_s = machine.limits.tangential_accel_mm_s2 * BRAKES_IN * slowest_s;
    SlowEnd {
        speed_mm_s,
        length_mm: speed_mm_s * SETTLES_IN * slowest_s,
    }
}

/// Returns the rapid to a stretch, with its last piece at the slow end's speed; none if the rapid
/// is not much longer.
pub(super) fn slow_approach(
    stretch: &SmoothStretch,
    slow: SlowEnd,
    target: PrintedTarget<'_>,
) -> Option<[Motion; 2]> {
    let (_, rapid) = stretch.rapid.as_ref()?;
    slow.parted(rapid, target)
}

/// Returns the programmed motions, with the last of them slow at its end; none if the last is not a
/// straight line or not much longer.
pub(super) fn slow_last(
    motions: &[Motion],
    slow: SlowEnd,
    target: PrintedTarget<'_>,
) -> Option<Vec<Motion>> {
    let (last, others) = motions
        .split_last()
        .filter(|(last, _)| matches!(last.shape, Shape::Line))?;
    Some(
        others
            .iter()
            .cloned()
            .chain(slow.parted(last, target)?)
            .collect(),
    )
}

impl SlowEnd {
    /// Splits a straight motion in two, the second of them slow.
    fn parted(self, motion: &Motion, target: PrintedTarget<'_>) -> Option<[Motion; 2]> {
        let way = sub(motion.end_mm, motion.start_mm);
        let length_mm = norm(way);
        if length_mm < LEAST_WAY * self.length_mm {
            return None;
        }
        let steps_per_mm = target.steps_per_mm;
        let printed = |value: f64| (value * steps_per_mm).round() / steps_per_mm;
        let middle_mm = add_scaled(motion.end_mm, -self.length_mm / length_mm, way).map(printed);
        let feed_mm_s = if motion.kind == MotionKind::Feed {
            motion.feed_mm_s.min(self.speed_mm_s)
        } else {
            self.speed_mm_s
        };
        let last = Motion {
            kind: MotionKind::Feed,
            start_mm: middle_mm,
            feed_mm_s,
            ..motion.clone()
        };
        Some([
            Motion {
                end_mm: middle_mm,
                ..motion.clone()
            },
            last,
        ])
    }
}

#[cfg(test)]
mod tests {
    use feedwright_gcode::canon::{AuxiliaryAxes, Corner};
    use proptest::prelude::*;

    use super::*;
    use crate::TARGETS;

    #[test]
    fn a_slow_end_brakes_in_a_quarter_of_the_time_constant_of_the_loop_and_takes_two() {
        let machine = Machine::load("tnv40".as_ref()).unwrap();
        let (slow, loop_s) = (slow_end(&machine), 1.0 / machine.slowest_kp_1_s());
        assert!((slow.time_s() / loop_s - 2.0).abs() < 1e-12, "{slow:?}");
        assert!(
            (slow.speed_mm_s / machine.limits.tangential_accel_mm_s2 / loop_s - 0.25).abs() < 1e-12,
            "{slow:?}"
        );
        assert!((slow.slower().time_s() - slow.time_s()).abs() < 1e-12);
        assert!((slow.shorter(0.3).time_s() - 0.3 * slow.time_s()).abs() < 1e-12);
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]
        #[test]
        fn a_motion_that_is_parted_goes_the_same_way_and_the_last_of_it_slowly(
            start_mm in prop::array::uniform3(-3.0..3.0_f64),
            end_mm in prop::array::uniform3(-3.0..3.0_f64),
            slow_mm in 0.1..2.0_f64,
            feed_mm_s in 1.0..9.0_f64,
            is_feed: bool,
        ) {
            let slow = SlowEnd { speed_mm_s: 2.0, length_mm: slow_mm };
            let kind = if is_feed { MotionKind::Feed } else { MotionKind::Rapid };
            let (corner, others) = (Corner::ExactStop, AuxiliaryAxes::default());
            let motion = Motion { line: 7, kind, start_mm, end_mm, shape: Shape::Line, feed_mm_s, corner, others };
            let target = TARGETS[0].printed(1.0);
            let found = slow_last(std::slice::from_ref(&motion), slow, target);
            let length_mm = distance(start_mm, end_mm);
            prop_assert_eq!(found.is_some(), length_mm >= LEAST_WAY * slow_mm);
            let Some([first, last]) = found.as_deref() else { return Ok(()) };
            prop_assert!((first.start_mm, last.end_mm) == (start_mm, end_mm) && first.end_mm == last.start_mm);
            prop_assert!((first.kind, first.feed_mm_s, last.kind) == (kind, feed_mm_s, MotionKind::Feed));
            let step_mm = 1.0 / target.steps_per_mm;
            prop_assert!((distance(last.start_mm, end_mm) - slow_mm).abs() <= step_mm);
            let around_mm = distance(start_mm, first.end_mm) + distance(first.end_mm, end_mm) - length_mm;
            prop_assert!(around_mm <= step_mm, "{around_mm} mm");
            prop_assert_eq!(last.feed_mm_s, if is_feed { feed_mm_s.min(2.0) } else { 2.0 });
        }
    }

    #[test]
    fn points_are_slowed_down_over_the_length_and_no_further() {
        let point = |n: u32| FitPoint {
            at_mm: [f64::from(n), 0.0, 0.0],
            tangent: [1.0, 0.0],
            feed_mm_s: 5.0,
        };
        let mut points: Vec<FitPoint> = (0..10).map(point).collect();
        SlowEnd {
            speed_mm_s: 2.0,
            length_mm: 2.5,
        }
        .slow_down(&mut points);
        let feeds: Vec<f64> = points.iter().map(|point| point.feed_mm_s).collect();
        assert_eq!(feeds, [5.0, 5.0, 5.0, 5.0, 5.0, 5.0, 2.0, 2.0, 2.0, 2.0]);
        SlowEnd {
            speed_mm_s: 9.0,
            length_mm: 2.5,
        }
        .slow_down(&mut points);
        assert_eq!(points.last().map(|point| point.feed_mm_s), Some(2.0));
    }
}
