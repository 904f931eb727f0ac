//! How two segments are joined: tangent, by an arc, by a parabola, or at rest.
//!
//! A corner by `alpha` at the speed `v` takes the acceleration `2 (v / T + a) sin(alpha / 2)` for
//! one servo period `T`. If every axis needs less than [`KINK_RATIO`] of its acceleration for that,
//! the segments count as tangent, and their acceleration falls by the part that the corner takes.
//! Otherwise, in G64, the fastest of three joints is chosen: the corner itself, at the speed that
//! meets this limit; an arc; or a parabola, which counts with half its speed.
//!
//! A parabola adds two motions, each at half of its acceleration: the next segment begins while the
//! one before slows down.

use super::arc_blend::{ArcBlend, arc_blend, half_angle};
use super::limits::{DirectionLimits, KINK_RATIO, PERIOD_S, TANGENTIAL_RATIO};
use super::segment::{MotionSegment, SegmentEnd};
use super::shape::SegmentShape;
use crate::vector::{Vector, add_scaled, dot, norm, scale, sub};

/// The square of the sum of unit vectors below which a corner is a reversal: 2 degrees.
const REVERSAL: f64 = 0.034_906_585_039_886_59 * 0.034_906_585_039_886_59;

/// Half angles closer to a right angle than this need no tolerance.
const FLAT: f64 = 1e-3;

/// Joins a segment to the one before; an arc that comes between is handed back.
pub(super) fn join(
    before: &mut MotionSegment,
    after: &mut MotionSegment,
    limits: &DirectionLimits,
) -> Option<ArcBlend> {
    if before.is_rapid != after.is_rapid {
        end(before, after, SegmentEnd::Stop);
    }
    if before.progress_mm > 0.5 * before.length_mm
        || before.is_rotary
        || after.is_rotary
        || before.end == SegmentEnd::Stop
    {
        return None;
    }
    let tangents = [before.shape.tangents()[1], after.shape.tangents()[0]];
    let sum = add_scaled(tangents[0], 1.0, tangents[1]);
    if dot(sum, sum) < REVERSAL {
        end(before, after, SegmentEnd::Stop);
        return None;
    }
    if is_tangent(before, after, tangents, limits) {
        end(before, after, SegmentEnd::Tangent);
        return None;
    }
    let may_blend = before.end == SegmentEnd::Parabolic && !before.is_final && !after.is_final;
    let arc = if may_blend {
        arc_blend(before, after, limits)
    } else {
        None
    };
    if before.end != SegmentEnd::Parabolic {
        return None;
    }
    let by_parabola = 0.5 * net_blend_mm_s(before, after, limits);
    let by_tangent = before.kink_mm_s.unwrap_or(0.0);
    let by_arc = arc.map_or(0.0, |arc| arc.highest_mm_s);
    if by_arc > by_parabola && by_arc > by_tangent {
        without_kink(before, after);
        end(before, after, SegmentEnd::Tangent);
        return arc;
    }
    if by_tangent > by_parabola {
        end(before, after, SegmentEnd::Tangent);
    } else {
        without_kink(before, after);
        end(before, after, SegmentEnd::Parabolic);
    }
    None
}

fn end(before: &mut MotionSegment, after: &mut MotionSegment, how: SegmentEnd) {
    before.end = how;
    after.is_blended_into = how == SegmentEnd::Parabolic;
}

fn without_kink(before: &mut MotionSegment, after: &mut MotionSegment) {
    before.kink_mm_s = None;
    before.kink_parts[1] = 0.0;
    after.kink_parts[0] = 0.0;
}

/// Returns true if a corner takes a small enough part of the acceleration. Records the part that it
/// takes, and the speed at which the part is small enough.
fn is_tangent(
    before: &mut MotionSegment,
    after: &mut MotionSegment,
    tangents: [Vector; 2],
    limits: &DirectionLimits,
) -> bool {
    let speed_mm_s = before.overridden_mm_s().min(after.overridden_mm_s());
    let accel_mm_s2 = speed_mm_s / PERIOD_S + after.accel_mm_s2;
    let mut part = limits.accel_part(scale(accel_mm_s2, sub(tangents[1], tangents[0])));
    if [&before.shape, &after.shape]
        .iter()
        .any(|shape| matches!(shape, SegmentShape::Circle(_)))
    {
        part /= TANGENTIAL_RATIO;
    }
    let small = part < KINK_RATIO;
    let taken = if small { part } else { KINK_RATIO };
    before.kink_mm_s = Some(if small {
        speed_mm_s
    } else {
        speed_mm_s * KINK_RATIO / part
    });
    before.kink_parts[1] = before.kink_parts[1].max(taken);
    after.kink_parts[0] = after.kink_parts[0].max(taken);
    small
}

/// Highest speed of a segment if it begins and ends at rest; as long as it may be cut, half of it.
fn peak_mm_s(segment: &MotionSegment) -> f64 {
    let length_mm = if segment.is_final {
        segment.length_mm
    } else {
        0.5 * segment.length_mm
    };
    (segment.along_mm_s2() * length_mm).sqrt()
}

/// Direction of the acceleration at the beginning of a segment: on a circle at half of its speed,
/// with what is normal.
fn begins(segment: &MotionSegment) -> Vector {
    let SegmentShape::Circle(circle) = segment.shape else {
        return segment.shape.tangents()[0];
    };
    let forward = scale(
        segment.whole_accel_mm_s2() / circle.radius_mm,
        circle.second_mm,
    );
    let inward = (0.5 * segment.feed_mm_s / circle.radius_mm).powi(2);
    let both = add_scaled(forward, -inward, circle.first_mm);
    scale(1.0 / norm(both).max(f64::MIN_POSITIVE), both)
}

/// Speeds of both segments where one slows down while the other speeds up, going for `wanted_mm_s`.
pub(super) fn blend_speeds_mm_s(
    before: &MotionSegment,
    after: &MotionSegment,
    wanted_mm_s: [f64; 2],
) -> [f64; 2] {
    let both = [before, after];
    let accel = both.map(MotionSegment::along_mm_s2);
    let reached: [f64; 2] = std::array::from_fn(|i| peak_mm_s(both[i]).min(wanted_mm_s[i]));
    let longest_s = (0..2)
        .map(|i| both[i].length_mm / reached[i])
        .fold(f64::INFINITY, f64::min);
    let blend_s = (0..2)
        .map(|i| reached[i] / accel[i])
        .fold(0.0, f64::max)
        .min(longest_s);
    let cos = libm::cos(half_angle([before.shape.tangents()[1], begins(after)]));
    let by_tolerance = if before.tolerance_mm > 0.0 && cos > libm::sin(FLAT) {
        2.0 * (accel[0] * before.tolerance_mm / cos).sqrt()
    } else {
        f64::INFINITY
    };
    std::array::from_fn(|i| reached[i].min(blend_s * accel[i]).min(by_tolerance))
}

/// Speed along the blend.
fn net_blend_mm_s(before: &MotionSegment, after: &MotionSegment, limits: &DirectionLimits) -> f64 {
    let wanted = [before, after].map(|segment| segment.overridden_mm_s().min(limits.path_mm_s));
    let speeds = blend_speeds_mm_s(before, after, wanted);
    let sin = libm::sin(half_angle([before.shape.tangents()[1], begins(after)]));
    0.5 * sin * (speeds[0] + speeds[1])
}
