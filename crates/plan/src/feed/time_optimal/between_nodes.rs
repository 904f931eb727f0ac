//! Checks a window between its nodes, where its problem bounds nothing: the distance of the motion
//! from the path, of the path from the motion, the feedrate, and the velocity of each axis. What
//! exceeds a bound is tightened for the next solution.

use super::mesh::{MeshNode, NEAR_START};
use super::steps::{AxisCaps, PlannedStep};
use super::track::Track;
use crate::feed::AxisMotion;
use crate::vector::{add_scaled, distance, dot, norm, sub};

/// Moments within a step at which it is looked at.
const MOMENTS: u32 = 6;

/// Number of halvings of the time between two moments to find the largest speed. The speed is flat
/// there, so its value is exact to rounding.
const HALVINGS: u32 = 24;

/// Joints of a step that are looked at closely: those that stand out most from the chord between
/// its nodes.
const JOINTS: usize = 2;

/// Allowed violation of the tolerance, mm: a hundredth of a micrometer.
const OVER_MM: f64 = 1e-5;

/// Factor of the relative excess by which the limit falls where a step exceeds its feedrate.
const FEED_TIGHTER: f64 = 1.2;

/// Allowed relative excess of the velocity of an axis between nodes, for rounding.
const FAST_OVER: f64 = 1e-7;

/// Beyond this part a step gets a node more, too, as if it left the tube by so much, mm.
const FAR_TOO_FAST: f64 = 1e-4;
const TOO_FAST_MM: f64 = 6e-5;

/// A radius is made no smaller than this part at once.
const LEAST_RADIUS: f64 = 0.3;

/// Nodes near to the start of a window, whose state is given, can be moved by no more than a
/// little.
const SLOWLY: f64 = 0.97;

/// A step that exceeds something.
#[derive(Debug, Clone, Copy)]
pub(super) struct Excess {
    pub(super) step: usize,
    /// Distance by which it leaves the tube, mm; 0 if it stays inside or was not checked. An axis
    /// far above its velocity counts as `TOO_FAST_MM`.
    pub(super) tube_mm: f64,
    /// The part of the feedrate that would keep it, 1 where it does.
    pub(super) feed_part: f64,
    /// Speed along the path at which every axis keeps its velocity, mm/s; infinite where each does.
    pub(super) axes_mm_s: f64,
}

/// All steps that exceed something; whether they leave the tube is asked of the first ones only.
pub(super) fn excesses(
    track: &Track,
    caps: &AxisCaps,
    steps: &[PlannedStep],
    first: usize,
) -> Vec<Excess> {
    let mut found = Vec::new();
    for (i, step) in steps.iter().enumerate() {
        let mut tube_mm = if i < first {
            away_mm(track, steps, i).max(left_out_mm(track, steps, i))
        } else {
            0.0
        };
        let (used, axes_mm_s) = if i < first {
            axis_use(caps, step)
        } else {
            (0.0, f64::INFINITY)
        };
        if used > 1.0 + FAR_TOO_FAST {
            tube_mm = tube_mm.max(TOO_FAST_MM);
        }
        let feed_part = (feed_mm_s(track, step) / fastest_mm_s(step)).min(1.0);
        if tube_mm > OVER_MM || feed_part < 1.0 || axes_mm_s.is_finite() {
            found.push(Excess {
                step: i,
                tube_mm: tube_mm.max(0.0),
                feed_part,
                axes_mm_s,
            });
        }
    }
    found
}

/// The smallest feedrate within a step.
fn feed_mm_s(track: &Track, step: &PlannedStep) -> f64 {
    track
        .between(step.from_mm, step.to_mm)
        .map(|piece| piece.feed_mm_s)
        .fold(f64::INFINITY, f64::min)
}

/// The largest part of its velocity that an axis uses within a step, and the speed along the path
/// at which it would keep it; infinite where every axis does. Between nodes the velocity of an axis
/// has its extreme where the acceleration is zero.
fn axis_use(caps: &AxisCaps, step: &PlannedStep) -> (f64, f64) {
    let AxisMotion {
        accel_mm_s2: a,
        jerk_mm_s3: j,
        ..
    } = step.motion;
    let (mut most, mut axes_mm_s) = (0.0, f64::INFINITY);
    for k in 0..3 {
        let t = (-a[k] / j[k]).clamp(0.0, step.duration_s);
        // Without jerk the extremes are at the ends.
        if !t.is_finite() {
            continue;
        }
        let velocity_mm_s = step.motion.after(t).velocity_mm_s;
        let used = velocity_mm_s[k].abs() / caps.axes[k].velocity_mm_s;
        if used > 1.0 + FAST_OVER {
            axes_mm_s =
                axes_mm_s.min(norm(velocity_mm_s) * (1.0 - FEED_TIGHTER * (1.0 - 1.0 / used)));
        }
        most = used.max(most);
    }
    (most, axes_mm_s)
}

/// The largest speed along the path within a step. The square of the speed has the derivative `2 v
/// a`, a cubic in time: between moments and its own extremes, the roots of a quadratic, it changes
/// its sign once at most, and halving finds where.
fn fastest_mm_s(step: &PlannedStep) -> f64 {
    let AxisMotion {
        velocity_mm_s: v,
        accel_mm_s2: a,
        jerk_mm_s3: j,
        ..
    } = step.motion;
    let h = step.duration_s;
    let speed = |t: f64| norm(step.motion.after(t).velocity_mm_s);
    let rises = |t: f64| {
        let motion = step.motion.after(t);
        dot(motion.velocity_mm_s, motion.accel_mm_s2) > 0.0
    };
    let (middle_s, half_s) = extremes_of_rise_s(dot(a, a) + dot(v, j), dot(a, j), dot(j, j));
    let mut most = speed(0.0).max(speed(h));
    for m in 0..MOMENTS {
        let [from, to] = [m, m + 1].map(|m| h * f64::from(m) / f64::from(MOMENTS));
        let [first, second] = [middle_s - half_s, middle_s + half_s].map(|t| t.clamp(from, to));
        for [mut lo, mut hi] in [[from, first], [first, second], [second, to]] {
            if rises(lo) && !rises(hi) {
                for _ in 0..HALVINGS {
                    let middle = 0.5 * (lo + hi);
                    if rises(middle) {
                        lo = middle;
                    } else {
                        hi = middle;
                    }
                }
                most = most.max(speed(lo));
            }
        }
    }
    most
}

/// Middle and half distance of the roots of `rise + 3 bend t + 3/2 jerk t^2`, the derivative of `v
/// a`; far away or together where it has none.
fn extremes_of_rise_s(rise: f64, bend: f64, jerk: f64) -> (f64, f64) {
    let middle_s = -bend / jerk;
    let square_s2 = middle_s * middle_s - rise / (1.5 * jerk);
    if square_s2.is_finite() {
        (middle_s, square_s2.max(0.0).sqrt())
    } else {
        (0.0, 0.0)
    }
}

/// Returns how far the motion of a step leaves the tube, mm.
fn away_mm(track: &Track, steps: &[PlannedStep], i: usize) -> f64 {
    let step = &steps[i];
    let tolerance = |step: &PlannedStep| {
        let pieces = track.between(step.from_mm, step.to_mm);
        pieces
            .map(|piece| piece.tolerance_mm)
            .fold(f64::INFINITY, f64::min)
    };
    let tolerance_mm = tolerance(step);
    // The nearest point may lie a little before or behind.
    let margin_mm = 2.0 * tolerance_mm + 0.5 * (step.to_mm - step.from_mm);
    let mut most = f64::NEG_INFINITY;
    for m in 0..=MOMENTS {
        let motion = step
            .motion
            .after(step.duration_s * f64::from(m) / f64::from(MOMENTS));
        let away = track.distance(
            motion.position_mm,
            step.from_mm - margin_mm,
            step.to_mm + margin_mm,
        );
        most = most.max(away - tolerance_mm);
    }
    most
}

/// Returns the distance of the path between the nodes of a step from the motion, beyond the
/// tolerance, mm.
fn left_out_mm(track: &Track, steps: &[PlannedStep], i: usize) -> f64 {
    let step = &steps[i];
    let (from, to) = (
        track.at(step.from_mm).position_mm,
        track.at(step.to_mm).position_mm,
    );
    let chord = sub(to, from);
    let square = dot(chord, chord).max(1e-18);
    let mut furthest = [(0.0_f64, [0.0; 3], 0.0); JOINTS];
    for piece in track.between(step.from_mm, step.to_mm) {
        if piece.s_mm <= step.from_mm {
            continue;
        }
        let joint = piece.start_mm;
        let along = (dot(sub(joint, from), chord) / square).clamp(0.0, 1.0);
        let away = distance(add_scaled(from, along, chord), joint);
        if away > furthest[JOINTS - 1].0 {
            furthest[JOINTS - 1] = (away, joint, piece.tolerance_mm);
            furthest.sort_by(|a, b| b.0.total_cmp(&a.0));
        }
    }
    let near = &steps[i.saturating_sub(1)..(i + 2).min(steps.len())];
    let left_out =
        furthest
            .iter()
            .filter(|joint| joint.0 > 0.0)
            .map(|&(_, joint, tolerance_mm)| {
                near.iter()
                    .map(|step| motion_distance_mm(step, joint))
                    .fold(f64::INFINITY, f64::min)
                    - tolerance_mm
            });
    left_out.fold(f64::NEG_INFINITY, f64::max)
}

/// Distance of a point from the motion of a step, by chords: between them a motion of 2 ms bends by
/// nanometres.
fn motion_distance_mm(step: &PlannedStep, point_mm: [f64; 3]) -> f64 {
    let at = |m: u32| {
        step.motion
            .after(step.duration_s * f64::from(m) / f64::from(2 * MOMENTS))
            .position_mm
    };
    let mut least = f64::INFINITY;
    for m in 0..2 * MOMENTS {
        let (from, to) = (at(m), at(m + 1));
        let chord = sub(to, from);
        let along =
            (dot(sub(point_mm, from), chord) / dot(chord, chord).max(1e-24)).clamp(0.0, 1.0);
        least = least.min(distance(add_scaled(from, along, chord), point_mm));
    }
    least
}

/// The same mesh with what is exceeded tightened: smaller offsets, or a node more where a step is
/// still long, and smaller feedrates.
pub(super) fn tightened(
    nodes: &[MeshNode],
    feed_parts: &[f64],
    steps: &[PlannedStep],
    excesses: &[Excess],
    step_s: f64,
    track: &Track,
) -> (Vec<MeshNode>, Vec<f64>) {
    let mut next: Vec<MeshNode> = nodes.to_vec();
    let mut parts = feed_parts.to_vec();
    // What was found is the better guess.
    for (node, step) in next.iter_mut().skip(1).zip(steps) {
        node.duration_s = step.duration_s;
        node.motion = step.motion.after(step.duration_s);
    }
    for excess in excesses {
        for i in [excess.step, excess.step + 1] {
            let node = &mut next[i];
            let offset_mm = distance(node.motion.position_mm, track.at(node.s_mm).position_mm);
            let least = if i < NEAR_START {
                SLOWLY * offset_mm
            } else {
                LEAST_RADIUS * node.radius_mm
            };
            node.radius_mm = (node.radius_mm - 1.2 * excess.tube_mm).max(least.min(node.radius_mm));
        }
        // The velocity of a step is between its control velocity and those of its neighbours.
        for i in excess.step.saturating_sub(2)..=(excess.step + 2).min(steps.len() - 1) {
            parts[i] *= 1.0 - FEED_TIGHTER * (1.0 - excess.feed_part);
            parts[i] = parts[i].min(excess.axes_mm_s / feed_mm_s(track, &steps[i]));
        }
    }
    for excess in excesses.iter().rev().filter(|excess| excess.tube_mm > 0.0) {
        let step = &steps[excess.step];
        if step.duration_s > 0.3 * step_s && step.to_mm - step.from_mm > 1e-6 {
            let s_mm = 0.5 * (step.from_mm + step.to_mm);
            let half_s = 0.5 * step.duration_s;
            let motion = step.motion.after(half_s);
            let offset_mm = distance(motion.position_mm, track.at(s_mm).position_mm);
            let least = if excess.step < NEAR_START {
                offset_mm
            } else {
                LEAST_RADIUS * offset_mm
            };
            let radius_mm = (0.9 * track.piece(s_mm).tolerance_mm - excess.tube_mm).max(least);
            next[excess.step + 1].duration_s = half_s;
            next.insert(
                excess.step + 1,
                MeshNode {
                    s_mm,
                    duration_s: half_s,
                    motion,
                    radius_mm,
                    followed: false,
                },
            );
            parts.insert(excess.step + 1, parts[excess.step]);
        }
    }
    (next, parts)
}

#[cfg(test)]
mod tests {
    use feedwright_gcode::canon::{AuxiliaryAxes, Canon, Corner, Motion, MotionKind, Shape};
    use proptest::prelude::*;

    use super::*;
    use crate::constraints::AxisLimits;
    use crate::path::Step;
    use crate::path::pieces::Pieces;

    const TOLERANCE_MM: f64 = 0.8;
    const FEED_MM_S: f64 = 1.5;

    /// A track of lines through these points.
    fn track(points: &[[f64; 3]]) -> Track {
        let corner = Corner::Continuous {
            tolerance_mm: None,
            merge_mm: None,
        };
        let line = |ends: &[[f64; 3]]| {
            let (start_mm, end_mm, others) = (ends[0], ends[1], AuxiliaryAxes::default());
            let (kind, shape) = (MotionKind::Feed, Shape::Line);
            Canon::Motion(Motion {
                line: 1,
                kind,
                start_mm,
                end_mm,
                shape,
                feed_mm_s: FEED_MM_S,
                corner,
                others,
            })
        };
        let mut track = Track::new(None);
        for step in Pieces::new(points.windows(2).map(line)) {
            if let Ok(Step::Piece(piece)) = step {
                track.push(0, &piece, FEED_MM_S, TOLERANCE_MM);
            }
        }
        track
    }

    /// Distance of a point from a line between two others.
    fn from_line(point: [f64; 3], from: [f64; 3], to: [f64; 3]) -> f64 {
        let way = sub(to, from);
        let part = dot(sub(point, from), way) / dot(way, way);
        distance(add_scaled(from, part.clamp(0.0, 1.0), way), point)
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

        #[test]
        fn a_straight_step_is_as_far_from_a_path_as_the_furthest_of_either(
            joints in prop::array::uniform6(prop::array::uniform3(-1.0..1.0_f64)),
        ) {
            let track = track(&joints);
            let length_mm: f64 = joints.windows(2).map(|ends| distance(ends[0], ends[1])).sum();
            let (start, end) = (joints[0], joints[5]);
            let motion = AxisMotion { position_mm: start, velocity_mm_s: sub(end, start), ..AxisMotion::REST };
            let steps = [PlannedStep { from_mm: 0.0, to_mm: length_mm, duration_s: 1.0, motion }];
            let furthest = joints[1..5].iter().map(|joint| from_line(*joint, start, end)).fold(0.0, f64::max);
            let left_out = furthest - TOLERANCE_MM;
            prop_assert!((left_out_mm(&track, &steps, 0) - left_out).abs() < 1e-9);
            let to_path = |m: u32| {
                let point = motion.after(f64::from(m) / f64::from(MOMENTS)).position_mm;
                joints.windows(2).map(|ends| from_line(point, ends[0], ends[1])).fold(f64::INFINITY, f64::min)
            };
            let furthest = (0..=MOMENTS).map(to_path).fold(0.0, f64::max);
            let away = furthest - TOLERANCE_MM;
            prop_assert!((away_mm(&track, &steps, 0) - away).abs() < 1e-9);
            // Either excess alone is reported, and so is a speed above the feedrate. For steps that
            // are not soon, only the speed is.
            let caps = AxisCaps { axes: [AxisLimits::NONE; 3] };
            let too_fast = distance(start, end) > FEED_MM_S;
            for (first, tube_mm) in [(1, left_out.max(away).max(0.0)), (0, 0.0)] {
                let found = excesses(&track, &caps, &steps, first);
                prop_assert_eq!(found.len(), usize::from(tube_mm > OVER_MM || too_fast));
                let Some(excess) = found.first() else { continue };
                prop_assert!((excess.tube_mm - tube_mm).abs() < 1e-9);
                prop_assert!((excess.feed_part - (FEED_MM_S / distance(start, end)).min(1.0)).abs() < 1e-9);
            }
        }

        #[test]
        fn no_moment_of_a_step_is_faster_than_its_fastest(
            velocity_mm_s in prop::array::uniform3(-1.0..1.0_f64),
            accel_mm_s2 in prop::array::uniform3(-9.0..9.0_f64),
            jerk_mm_s3 in prop::array::uniform3(-50.0..50.0_f64),
        ) {
            let motion = AxisMotion { position_mm: [0.0; 3], velocity_mm_s, accel_mm_s2, jerk_mm_s3 };
            let step = PlannedStep { from_mm: 0.0, to_mm: 1.0, duration_s: 0.5, motion };
            let speeds = (0..=5000_u32).map(|m| norm(motion.after(1e-4 * f64::from(m)).velocity_mm_s));
            let (fastest, sampled) = (fastest_mm_s(&step), speeds.fold(0.0, f64::max));
            // Between two samples the speed changes by less than half their distance times the
            // acceleration there.
            prop_assert!(fastest >= sampled * (1.0 - 1e-9) && fastest <= sampled + 0.5e-4 * 100.0);
        }
    }
    #[test]
    fn a_speed_that_rises_at_both_ends_of_a_short_time_is_found() {
        let motion = AxisMotion {
            position_mm: [0.0; 3],
            velocity_mm_s: [-0.7612201019932336, 0.15096466543519568, 0.4351052670490418],
            accel_mm_s2: [7.760711513434023, 8.892475998450323, -6.638000620760462],
            jerk_mm_s3: [-24.16596683721455, -30.329215382770382, 7.513819605871589],
        };
        let fastest = fastest_mm_s(&PlannedStep {
            from_mm: 0.0,
            to_mm: 1.0,
            duration_s: 0.5,
            motion,
        });
        assert!((fastest - 2.11245).abs() < 1e-5, "{fastest}");
    }
}
