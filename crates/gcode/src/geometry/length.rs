//! Length of a canonical motion.

use crate::canon::{Motion, Shape, Spline};
use crate::geometry::spiral::Spiral;

/// Chords that a span of a spline is divided into for its length. The relative error of a chord is
/// its turning angle squared over 24, so that even a span that turns by a full radian is measured
/// to 5e-6.
const CHORDS_PER_SPAN: usize = 100;

impl Motion {
    /// Length of the path of X, Y, Z, mm.
    pub fn length_mm(&self) -> f64 {
        match &self.shape {
            Shape::Line => norm(self.start_mm, self.end_mm),
            Shape::Arc {
                plane,
                center_mm,
                turns,
            } => Spiral::new(self.start_mm, self.end_mm, *center_mm, *plane, *turns).length_mm(),
            Shape::Spline(spline) => spline.length_mm(),
        }
    }
}

fn norm(a: [f64; 3], b: [f64; 3]) -> f64 {
    ((a[0] - b[0]).powi(2) + (a[1] - b[1]).powi(2) + (a[2] - b[2]).powi(2)).sqrt()
}

impl Spline {
    /// The point at parameter `u`, by de Boor's algorithm on homogeneous coordinates (C. de Boor,
    /// On calculating with B-splines, 1972).
    pub(crate) fn point_mm(&self, u: f64) -> [f64; 3] {
        let last = self.control_mm.len() - 1;
        let span = (self.degree..=last)
            .rev()
            .find(|&span| self.knots[span] <= u && self.knots[span] < self.knots[span + 1])
            .unwrap_or(self.degree);
        let mut points: Vec<[f64; 4]> = (0..=self.degree)
            .map(|n| {
                let (p, w) = (
                    self.control_mm[span - self.degree + n],
                    self.weights[span - self.degree + n],
                );
                [p[0] * w, p[1] * w, p[2] * w, w]
            })
            .collect();
        for level in 1..=self.degree {
            for n in (level..=self.degree).rev() {
                let low = self.knots[span - self.degree + n];
                let high = self.knots[span + 1 + n - level];
                let share = if high > low {
                    (u - low) / (high - low)
                } else {
                    0.0
                };
                for axis in 0..4 {
                    points[n][axis] = (1.0 - share) * points[n - 1][axis] + share * points[n][axis];
                }
            }
        }
        let [x, y, z, w] = points[self.degree];
        [x / w, y / w, z / w]
    }

    /// Length of the curve, mm.
    pub fn length_mm(&self) -> f64 {
        let mut length = 0.0;
        for span in self.degree..self.control_mm.len() {
            let (from, to) = (self.knots[span], self.knots[span + 1]);
            if to <= from {
                continue;
            }
            let mut before = self.point_mm(from);
            for chord in 1..=CHORDS_PER_SPAN {
                // Just below the end of the span: the next one has other control points.
                let u = if chord == CHORDS_PER_SPAN {
                    to - (to - from) * f64::EPSILON * 4.0
                } else {
                    from + (to - from) * chord as f64 / CHORDS_PER_SPAN as f64
                };
                let point = self.point_mm(u);
                length += norm(before, point);
                before = point;
            }
        }
        length
    }
}
