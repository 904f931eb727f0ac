//! Motions and limits for the tests of path, feed and reference.

use feedwright_gcode::canon::{AuxiliaryAxes, Canon, Corner, Motion, MotionKind, Plane, Shape};
use feedwright_plan::PathLimits;

pub(crate) const LIMITS: PathLimits = PathLimits {
    rapid_mm_s: 100.0,
    max_feed_mm_s: 200.0,
    tangential_accel_mm_s2: 100.0,
    normal_accel_mm_s2: 400.0,
    corner_jump_mm_s: 8.0,
};

pub(crate) const BLEND: Corner = Corner::Continuous {
    tolerance_mm: None,
    merge_mm: None,
};

pub(crate) fn line(start_mm: [f64; 3], end_mm: [f64; 3], feed_mm_s: f64, corner: Corner) -> Canon {
    let kind = MotionKind::Feed;
    Canon::Motion(Motion {
        line: 1,
        kind,
        start_mm,
        end_mm,
        shape: Shape::Line,
        feed_mm_s,
        corner,
        others: AuxiliaryAxes::default(),
    })
}

pub(crate) fn arc(
    start_mm: [f64; 3],
    end_mm: [f64; 3],
    center_mm: [f64; 3],
    turns: i32,
    feed_mm_s: f64,
) -> Canon {
    let shape = Shape::Arc {
        plane: Plane::Xy,
        center_mm,
        turns,
    };
    let kind = MotionKind::Feed;
    Canon::Motion(Motion {
        line: 1,
        kind,
        start_mm,
        end_mm,
        shape,
        feed_mm_s,
        corner: BLEND,
        others: AuxiliaryAxes::default(),
    })
}

pub(crate) fn polyline(points: &[[f64; 3]], feed_mm_s: f64, corner: Corner) -> Vec<Canon> {
    let mut motions: Vec<Canon> = points
        .windows(2)
        .map(|ends| line(ends[0], ends[1], feed_mm_s, corner))
        .collect();
    for (motion, number) in motions.iter_mut().zip(1..) {
        if let Canon::Motion(motion) = motion {
            motion.line = number;
        }
    }
    motions
}

pub(crate) fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    ((a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2) + (a[2] - b[2]).powi(2)).sqrt()
}

/// Small deterministic random numbers in 0..1 (xorshift), for tests that need many.
pub(crate) struct Random(pub(crate) u64);

impl Random {
    pub(crate) fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    pub(crate) fn between(&mut self, lo: f64, hi: f64) -> f64 {
        lo + (hi - lo) * self.next()
    }
}
