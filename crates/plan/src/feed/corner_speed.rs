//! The speed at the joint of two pieces.
//!
//! With `theta` the angle by which the tangent turns at the joint:
//!
//! * Turning. Short blocks stand for a curve, whose curvature must not escape because it is hidden
//!   in joints. A joint turns by `theta` over half of each neighbour's length, so it counts as a
//!   curvature of `theta / l` with `l = (min(l1, 3 l2) + min(l2, 3 l1)) / 2`, on top of the
//!   neighbours' own: `v^2 (k + theta / l) <= a_n`. For a circle cut into chords of different
//!   lengths `theta / l` is exactly `1 / R`, as long as neighbours differ by no more than the
//!   factor 3; beyond, the longer one counts as three times the shorter, so that a tiny chamfer
//!   between long lines is taken as the corner that it is.
//! * Jump. The velocity vector jumps by `2 v sin(theta / 2)`, in continuous mode (G64) at most by
//!   `corner_jump_mm_s`. A joint with `theta` below [`TANGENT_TOLERANCE_RAD`] is
//!   tangent-continuous, it has no such limit.
//! * Tolerance. The P word of G64 allows the tool to cut a corner by as much. It is read and not
//!   used: the path is followed exactly, corners included, so that the contour error is what is
//!   left of the program's own geometry.
//! * Stop. G61.1 stops at every joint, G61 at those that are not tangent-continuous.

use feedwright_gcode::canon::Corner;

use crate::constraints::PathLimits;
use crate::vector::angle;

/// A turn below this is no corner: the velocity jumps by a thousandth of the speed, 0.05 mm/s at 50
/// mm/s; and programs that round to 0.001 mm leave turns of this size where arcs of a few mm should
/// join without any. Smaller would stop there under G61, larger would let corners pass that can be
/// seen on the part.
pub(crate) const TANGENT_TOLERANCE_RAD: f64 = 1e-3;

/// Largest ratio of the lengths of neighboring blocks at which the longer one counts with its full
/// length. CAM programs cut curves into blocks whose neighbors seldom differ more.
const LENGTH_RATIO: f64 = 3.0;

/// One side of a joint.
#[derive(Debug, Clone, Copy)]
pub(crate) struct JointSide {
    /// Unit tangent at the joint.
    pub(crate) tangent: [f64; 3],
    /// Curvature at the joint, 1/mm.
    pub(crate) curvature_1_mm: f64,
    /// Length of the piece, mm.
    pub(crate) length_mm: f64,
}

/// Upper bound on the square of the speed at the joint, mm2/s2; infinity means no bound.
pub(crate) fn joint_cap(
    before: &JointSide,
    after: &JointSide,
    corner: Corner,
    limits: &PathLimits,
) -> f64 {
    let theta = angle(before.tangent, after.tangent);
    let corner_cap = match corner {
        Corner::ExactStop => 0.0,
        _ if theta < TANGENT_TOLERANCE_RAD => f64::INFINITY,
        Corner::ExactPath => 0.0,
        Corner::Continuous { .. } => {
            (limits.corner_jump_mm_s / (2.0 * libm::sin(0.5 * theta))).powi(2)
        }
    };
    let (l1, l2) = (before.length_mm, after.length_mm);
    let length_mm = 0.5 * (l1.min(LENGTH_RATIO * l2) + l2.min(LENGTH_RATIO * l1));
    let curvature = before.curvature_1_mm.max(after.curvature_1_mm) + theta / length_mm;
    corner_cap.min(limits.normal_accel_mm_s2 / curvature)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{FRAC_PI_2, PI};

    const LIMITS: PathLimits = PathLimits {
        rapid_mm_s: 100.0,
        max_feed_mm_s: 50.0,
        tangential_accel_mm_s2: 100.0,
        normal_accel_mm_s2: 400.0,
        corner_jump_mm_s: 8.0,
    };
    const BLEND: Corner = Corner::Continuous {
        tolerance_mm: None,
        merge_mm: None,
    };

    fn side(direction: f64, length_mm: f64) -> JointSide {
        JointSide {
            tangent: [libm::cos(direction), libm::sin(direction), 0.0],
            curvature_1_mm: 0.0,
            length_mm,
        }
    }

    #[test]
    fn the_velocity_jumps_by_no_more_than_allowed() {
        for theta in [0.3, FRAC_PI_2, 2.5, PI] {
            let v = joint_cap(&side(0.2, 100.0), &side(0.2 + theta, 100.0), BLEND, &LIMITS).sqrt();
            let jump = v * libm::hypot(libm::cos(theta) - 1.0, libm::sin(theta));
            assert!((jump - 8.0).abs() < 1e-12, "{theta} {jump}");
        }
    }

    #[test]
    fn exact_modes_stop() {
        let straight = (side(0.0, 10.0), side(1e-4, 10.0));
        let bent = (side(0.0, 10.0), side(0.1, 10.0));
        assert_eq!(
            joint_cap(&straight.0, &straight.1, Corner::ExactStop, &LIMITS),
            0.0
        );
        assert!(joint_cap(&straight.0, &straight.1, Corner::ExactPath, &LIMITS) > 2500.0);
        assert_eq!(joint_cap(&bent.0, &bent.1, Corner::ExactPath, &LIMITS), 0.0);
        assert!(joint_cap(&bent.0, &bent.1, BLEND, &LIMITS) > 0.0);
    }

    #[test]
    fn chords_of_a_circle_have_its_curvature() {
        let radius: f64 = 10.0;
        // Angles at the centre of two neighbouring chords.
        for (a, b) in [(1e-4, 1e-4), (0.01, 0.02), (0.01, 0.03)] {
            let chord = |angle: f64| 2.0 * radius * libm::sin(0.5 * angle);
            let cap = joint_cap(
                &side(0.0, chord(a)),
                &side(0.5 * (a + b), chord(b)),
                BLEND,
                &LIMITS,
            );
            assert!((cap / (400.0 * radius) - 1.0).abs() < 1e-4, "{a} {b} {cap}");
        }
    }
}
