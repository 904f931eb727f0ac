//! One servo period of the queue.
//!
//! In each period of `T` a segment goes for the speed `v = -a T / 2 + sqrt(v_f^2 + a (2 d - v_0
//! T) + (a T / 2)^2)`, from which it still comes to `v_f` in the distance `d` that is left, at most
//! for its feedrate, with at most its acceleration. Where a segment ends within a period the next
//! one has the rest of that period.

use super::joint_choice::blend_speeds_mm_s;
use super::limits::{NO_DISTANCE_MM, PERIOD_S, RAMP_HZ};
use super::queue::SegmentQueue;
use super::segment::{MotionSegment, SegmentEnd};
use crate::vector::{Vector, add_scaled, sub};

/// Speeds and times that count as none.
const NO_SPEED_MM_S: f64 = 1e-8;
const NO_TIME_S: f64 = 1e-12;

/// Advance of the motion in one period.
#[derive(Debug, Clone, Copy, Default)]
pub(super) struct PeriodStep {
    /// Displacement of the axes, mm.
    pub(crate) way_mm: Vector,
    /// Advance of the arc length on the programmed path, mm.
    pub(crate) station_mm: f64,
}

impl SegmentQueue {
    /// Moves on by a servo period.
    pub(super) fn run_period(&mut self) -> PeriodStep {
        let mut step = PeriodStep::default();
        self.activate();
        if self
            .segments
            .front()
            .is_some_and(|segment| segment.run.ends_within)
        {
            self.end_within(&mut step);
        } else {
            self.run_whole(&mut step);
        }
        if self
            .segments
            .front()
            .is_some_and(|segment| segment.run.is_over)
        {
            self.segments.pop_front();
        }
        step
    }

    /// Segments that begin.
    fn activate(&mut self) {
        let Some(segment) = self
            .segments
            .front_mut()
            .filter(|segment| !segment.run.is_active)
        else {
            return;
        };
        let reached_mm_s = segment.final_mm_s.min(segment.wanted_mm_s());
        let time_s = 2.0 * segment.left_mm() / (segment.speed_mm_s + reached_mm_s);
        segment.run.is_ramp = time_s < 1.0 / RAMP_HZ
            && !segment.is_rapid
            && segment.end == SegmentEnd::Tangent
            && segment.left_mm() != 0.0;
        segment.run.is_active = true;
        segment.run.blends = false;
        segment.run.slows_down = false;
    }

    /// The first segment goes to its end, the next one has the rest of the period.
    fn end_within(&mut self, step: &mut PeriodStep) {
        let Some(segment) = self
            .segments
            .front_mut()
            .filter(|segment| !segment.run.is_over)
        else {
            return;
        };
        let from_mm = segment.progress_mm;
        segment.progress_mm = segment.length_mm;
        segment.run.is_over = true;
        step.add(segment, from_mm);
        let (end, used_s, ending_mm_s) = (segment.end, segment.run.period_s, segment.ending_mm_s);
        if let Some(next) = self.segments.get_mut(1) {
            if end == SegmentEnd::Tangent {
                next.run.period_s = PERIOD_S - used_s;
                next.speed_mm_s = ending_mm_s;
            }
            let behind_mm_s = self.segments.get(2).map(MotionSegment::wanted_mm_s);
            self.segments[1].run_part(behind_mm_s, step);
        }
    }

    /// The first segment has the whole period; where it is being blended, the next moves, too.
    fn run_whole(&mut self, step: &mut PeriodStep) {
        let next_mm_s = self.segments.get(1).map(MotionSegment::wanted_mm_s);
        let Some(segment) = self
            .segments
            .front_mut()
            .filter(|segment| !segment.run.is_over)
        else {
            return;
        };
        segment.run.period_s = PERIOD_S;
        segment.run_part(next_mm_s, step);
        if segment.end != SegmentEnd::Parabolic || self.segments.len() < 2 {
            return;
        }
        let wanted = [0, 1].map(|i| self.segments[i].wanted_mm_s());
        let [blend_mm_s, _] = blend_speeds_mm_s(&self.segments[0], &self.segments[1], wanted);
        let segment = &mut self.segments[0];
        segment.run.blends |= segment.run.slows_down && segment.speed_mm_s < blend_mm_s;
        if segment.run.blends {
            self.segments[1].run_part(None, step);
        }
    }
}

impl PeriodStep {
    fn add(&mut self, segment: &MotionSegment, from_mm: f64) {
        let way = sub(
            segment.shape.at(segment.progress_mm),
            segment.shape.at(from_mm),
        );
        self.way_mm = add_scaled(self.way_mm, 1.0, way);
        self.station_mm += segment.station_mm(segment.progress_mm) - segment.station_mm(from_mm);
    }
}

impl MotionSegment {
    /// Moves for its time in this period; `next_mm_s` is the speed that the next one goes for,
    /// where there is one.
    fn run_part(&mut self, next_mm_s: Option<f64>, step: &mut PeriodStep) {
        let from_mm = self.progress_mm;
        let final_mm_s = self.real_final_mm_s(next_mm_s);
        let ramp =
            (self.run.is_ramp && self.end == SegmentEnd::Tangent && final_mm_s >= NO_SPEED_MM_S)
                .then(|| self.ramp(final_mm_s));
        let (accel_mm_s2, aimed_mm_s) = ramp.unwrap_or_else(|| self.trapezoid(final_mm_s));
        self.advance(accel_mm_s2, aimed_mm_s);
        self.look_for_end(final_mm_s);
        step.add(self, from_mm);
    }

    /// Speed at its end.
    fn real_final_mm_s(&self, next_mm_s: Option<f64>) -> f64 {
        if self.end == SegmentEnd::Tangent {
            self.final_mm_s
                .min(self.wanted_mm_s())
                .min(next_mm_s.unwrap_or(0.0))
        } else {
            0.0
        }
    }

    /// One acceleration up to the end, and the speed there.
    fn ramp(&self, final_mm_s: f64) -> (f64, f64) {
        let mean_mm_s = 0.5 * (self.speed_mm_s + final_mm_s);
        let left_s = if mean_mm_s > NO_SPEED_MM_S {
            (self.left_mm() / mean_mm_s).max(1e-16)
        } else {
            1e-16
        };
        let most = self.along_mm_s2();
        (
            ((final_mm_s - self.speed_mm_s) / left_s).clamp(-most, most),
            final_mm_s,
        )
    }

    /// The acceleration of this period, and the speed from which it still comes to the final one.
    fn trapezoid(&self, final_mm_s: f64) -> (f64, f64) {
        let (most, period_s) = (self.along_mm_s2(), self.run.period_s);
        let half = 0.5 * most * period_s;
        let known = final_mm_s.powi(2) + most * (2.0 * self.left_mm() - self.speed_mm_s * period_s);
        let aimed_mm_s = if known > 0.0 {
            (known + half * half).sqrt() - half
        } else {
            -half
        };
        let wanted_mm_s = self.wanted_mm_s();
        let speed_mm_s = aimed_mm_s.clamp(-wanted_mm_s, wanted_mm_s);
        (
            ((speed_mm_s - self.speed_mm_s) / period_s.max(NO_TIME_S)).clamp(-most, most),
            aimed_mm_s,
        )
    }

    fn advance(&mut self, accel_mm_s2: f64, aimed_mm_s: f64) {
        let period_s = self.run.period_s;
        let mut speed_mm_s = self.speed_mm_s + accel_mm_s2 * period_s;
        if speed_mm_s < 0.0 {
            speed_mm_s = 0.0;
            if self.left_mm() < self.speed_mm_s * period_s {
                self.progress_mm = self.length_mm;
            }
        } else {
            let way_mm = 0.5 * (speed_mm_s + self.speed_mm_s) * period_s;
            self.progress_mm = (self.progress_mm + way_mm).clamp(0.0, self.length_mm);
        }
        self.speed_mm_s = speed_mm_s;
        self.run.slows_down = (aimed_mm_s - speed_mm_s).abs() < NO_SPEED_MM_S && accel_mm_s2 < 0.0;
    }

    /// Checks whether the segment ends within the next period. Stores after which time, and at
    /// which speed.
    fn look_for_end(&mut self, final_mm_s: f64) {
        self.run.period_s = PERIOD_S;
        let (left_mm, speed_mm_s) = (self.left_mm(), self.speed_mm_s);
        let rests = matches!(self.end, SegmentEnd::Stop | SegmentEnd::Exact);
        if left_mm <= NO_DISTANCE_MM {
            self.progress_mm = self.length_mm;
            self.ends_after(0.0, speed_mm_s);
            self.run.is_over |= rests;
            return;
        }
        if rests {
            return;
        }
        let mean_mm_s = 0.5 * (speed_mm_s + final_mm_s);
        if mean_mm_s <= NO_SPEED_MM_S {
            return;
        }
        let most = self.along_mm_s2();
        let mut time_s = left_mm / mean_mm_s;
        let mut ending_mm_s = final_mm_s;
        let needed = (final_mm_s - speed_mm_s) / time_s;
        if needed.abs() > most {
            let accel = most.copysign(needed);
            let square = (speed_mm_s / accel).powi(2) + 2.0 / accel * left_mm;
            if square < 0.0 {
                return;
            }
            let root = if square < NO_TIME_S * NO_TIME_S {
                0.0
            } else {
                square.sqrt().copysign(accel)
            };
            time_s = root - speed_mm_s / accel;
            ending_mm_s = speed_mm_s + time_s * accel;
        }
        if time_s < NO_TIME_S {
            self.progress_mm = self.length_mm;
            self.ends_after(0.0, ending_mm_s);
        } else if time_s < PERIOD_S {
            self.ends_after(time_s, ending_mm_s);
        }
    }

    fn ends_after(&mut self, time_s: f64, speed_mm_s: f64) {
        self.run.ends_within = true;
        self.run.period_s = time_s;
        self.ending_mm_s = speed_mm_s;
    }
}
