//! The queue of segments, and the look-ahead over it.
//!
//! With each block that comes in, the look-ahead goes back from the last: a segment of length `L`
//! and acceleration `a` that ends at `v_f` may begin at `sqrt(v_f^2 + 2 a L)`. The last may still
//! lose half of its length to a blend, and must be able to stop in what is left.

use std::collections::VecDeque;

use feedwright_gcode::canon::Corner;

use super::arc_blend::ArcBlend;
use super::blocks::PlannerBlock;
use super::joint_choice::join;
use super::limits::{DEPTH, DirectionLimits, PERIOD_S};
use super::segment::{MotionSegment, SegmentEnd};
use super::shape::SegmentShape;

/// Least duration of a segment, in servo periods.
const LEAST_PERIODS: f64 = 1.02;

/// A segment that is further than this part of its length is not looked at any more.
const BEGUN: f64 = 0.25;

/// Segments behind this many peaks are not looked at.
const MOST_PEAKS: usize = 4;

/// See the module's page.
#[derive(Debug)]
pub(super) struct SegmentQueue {
    /// Limits of the machine.
    pub(crate) limits: DirectionLimits,
    /// Segments, the one under way first.
    pub(crate) segments: VecDeque<MotionSegment>,
}

impl SegmentQueue {
    /// Creates a queue without segments.
    pub(super) const fn new(limits: DirectionLimits) -> Self {
        Self {
            limits,
            segments: VecDeque::new(),
        }
    }

    /// Adds a block.
    pub(super) fn append(&mut self, block: PlannerBlock) {
        let mut segment = MotionSegment::new(block);
        if let Some(before) = self.segments.back_mut() {
            match join(before, &mut segment, &self.limits) {
                Some(arc) => self.put_between(arc, &mut segment),
                None => before.fix_length(),
            }
        }
        self.segments.push_back(segment);
        self.look_ahead();
    }

    /// Puts an arc between the last segment and the next.
    fn put_between(&mut self, arc: ArcBlend, after: &mut MotionSegment) {
        let Some(mut before) = self.segments.pop_back() else {
            return;
        };
        let line_mm = arc.shape.line_mm;
        let ends_mm = before.length_mm - arc.cut_mm[0];
        let joint_mm = after.station_mm(0.0);
        let length_mm = arc.shape.length_mm();
        let mut places_mm = vec![
            [line_mm, before.station_mm(ends_mm)],
            [0.5 * (line_mm + length_mm), joint_mm],
            [length_mm, after.station_mm(arc.cut_mm[1])],
        ];
        if line_mm > 0.0 {
            places_mm.insert(0, [0.0, before.station_mm(0.0)]);
        }
        let mut blend = MotionSegment::new(PlannerBlock {
            shape: SegmentShape::Blend(arc.shape),
            places_mm,
            is_rapid: before.is_rapid,
            is_rotary: false,
            feed_mm_s: arc.feed_mm_s,
            highest_mm_s: arc.highest_mm_s,
            accel_mm_s2: arc.accel_mm_s2,
            corner: Corner::ExactStop,
        });
        blend.end = SegmentEnd::Tangent;
        blend.fix_length();
        after.shape = arc.after;
        after.cut_mm += arc.cut_mm[1];
        after.length_mm = arc.after.length_mm();
        if let Some(shape) = arc.before {
            before.shape = shape;
            before.length_mm = shape.length_mm();
            before.fix_length();
            self.segments.push_back(before);
        }
        self.segments.push_back(blend);
    }

    /// Goes back from the last segment.
    fn look_ahead(&mut self) {
        let mut peaks = 0;
        let mut has_stopped = false;
        for back in 1..DEPTH + 2 {
            let Some(i) = self.segments.len().checked_sub(back).filter(|i| *i > 0) else {
                return;
            };
            let mut pair = self.segments.range_mut(i - 1..=i);
            let (Some(before), Some(segment)) = (pair.next(), pair.next()) else {
                return;
            };
            if before.end != SegmentEnd::Tangent {
                if has_stopped {
                    return;
                }
                has_stopped = true;
                continue;
            }
            let begun = before.progress_mm >= BEGUN * before.length_mm;
            if begun || before.run.ends_within || before.run.blends {
                return;
            }
            if segment.is_final {
                bound_before(before, segment);
            } else {
                let peak_mm_s = (segment.along_mm_s2() * segment.length_mm).sqrt();
                let highest_mm_s = segment.overridden_mm_s().min(self.limits.path_mm_s);
                before.final_mm_s = before.highest_mm_s.min(peak_mm_s).min(highest_mm_s);
                if let Some(kink_mm_s) = before.kink_mm_s {
                    before.final_mm_s = before.final_mm_s.min(kink_mm_s);
                }
                segment.final_mm_s = 0.0;
            }
            if segment.is_peak {
                peaks += 1;
            }
            if peaks > MOST_PEAKS {
                return;
            }
        }
    }
}

/// Speed between two segments, by the second.
fn bound_before(before: &mut MotionSegment, segment: &mut MotionSegment) {
    let reached_mm_s =
        (segment.final_mm_s.powi(2) + 2.0 * segment.along_mm_s2() * segment.length_mm).sqrt();
    let most_mm_s = segment
        .highest_mm_s
        .min(before.highest_mm_s)
        .min(before.kink_mm_s.unwrap_or(f64::INFINITY));
    before.is_peak |= reached_mm_s >= most_mm_s;
    before.final_mm_s = reached_mm_s.min(most_mm_s);
    segment.highest_mm_s = segment
        .highest_mm_s
        .min(segment.length_mm / (LEAST_PERIODS * PERIOD_S));
}
