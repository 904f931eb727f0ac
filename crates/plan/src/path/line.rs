//! Straight line by arc length: `p(s) = start + s t`.

use super::{Derivatives, Point};
use crate::vector::{Vector, add_scaled, dot, norm, scale, sub};

/// Straight line.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Line {
    start_mm: Vector,
    tangent: Vector,
    length_mm: f64,
}

impl Line {
    /// The line between two points; `None` when they coincide.
    pub(crate) fn new(start_mm: [f64; 3], end_mm: [f64; 3]) -> Option<Self> {
        let chord = sub(end_mm, start_mm);
        let length_mm = norm(chord);
        (length_mm > 0.0).then(|| Self {
            start_mm,
            tangent: scale(1.0 / length_mm, chord),
            length_mm,
        })
    }

    /// Length, mm.
    pub(crate) const fn length_mm(&self) -> f64 {
        self.length_mm
    }

    /// Position and tangent at `s_mm`.
    #[inline]
    pub(crate) fn at(&self, s_mm: f64) -> Point {
        Point {
            position_mm: add_scaled(self.start_mm, s_mm, self.tangent),
            tangent: self.tangent,
        }
    }

    /// Derivatives, the same everywhere.
    pub(crate) const fn derivatives(&self) -> Derivatives {
        Derivatives {
            first: self.tangent,
            second_1_mm: [0.0; 3],
            third_1_mm2: [0.0; 3],
        }
    }

    /// Arc length of the nearest point: the foot of the perpendicular, kept between the bounds.
    #[inline]
    pub(crate) fn nearest(&self, point_mm: [f64; 3], lo_mm: f64, hi_mm: f64) -> f64 {
        dot(sub(point_mm, self.start_mm), self.tangent)
            .min(hi_mm)
            .max(lo_mm)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_ends_where_it_should() {
        let line = Line::new([1.0, 2.0, 3.0], [4.0, 6.0, 15.0]).unwrap();
        assert_eq!(line.length_mm(), 13.0);
        let end = line.at(13.0).position_mm;
        for k in 0..3 {
            assert!((end[k] - [4.0, 6.0, 15.0][k]).abs() < 1e-14);
        }
    }

    #[test]
    fn no_line_between_equal_points() {
        assert!(Line::new([1.0; 3], [1.0; 3]).is_none());
    }

    #[test]
    fn the_foot_stays_between_the_bounds() {
        let line = Line::new([0.0; 3], [10.0, 0.0, 0.0]).unwrap();
        assert_eq!(line.nearest([4.0, 3.0, 0.0], 0.0, 10.0), 4.0);
        assert_eq!(line.nearest([4.0, 3.0, 0.0], 5.0, 6.0), 5.0);
        assert_eq!(line.nearest([40.0, 3.0, 0.0], 5.0, 6.0), 6.0);
    }
}
