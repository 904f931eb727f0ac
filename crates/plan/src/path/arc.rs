//! Circular arc and helix by arc length.
//!
//! With `t0` and `n0` the unit tangent and the unit vector to the centre at the start, both in the
//! plane of the circle, `phi = s cos(gamma) / R` the angle turned and `h` the rise along the
//! plane's normal for each mm of path:
//!
//! `p(s) = start + R (sin(phi) t0 + (1 - cos(phi)) n0) + s h`
//!
//! The centre does not appear, so that a flat arc of enormous radius loses nothing to cancellation:
//! `1 - cos(phi) = 2 sin(phi/2)^2`.

use feedwright_gcode::canon::Plane;

use super::{Derivatives, Point};
use crate::vector::{Vector, add_scaled, cross, distance, dot, scale, sub};
use std::f64::consts::{PI, TAU};

/// Newton steps for the nearest point of a helix; the iteration is monotone and quadratic, it needs
/// about six.
const MAX_NEWTON_STEPS: usize = 60;

/// Circular arc, possibly of several turns, possibly rising along its axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Arc {
    start_mm: Vector,
    /// Tangent at the start, in the plane of the circle.
    tangent0: Vector,
    /// Unit vector from the start to the center.
    normal0: Vector,
    /// Rise per mm of path, along the plane's normal.
    rise: Vector,
    radius_mm: f64,
    /// Angle turned per mm of path.
    turn_rad_mm: f64,
    /// Part of the speed that lies in the plane, cos(gamma).
    in_plane: f64,
    length_mm: f64,
}

impl Arc {
    /// The arc that starts at `start_mm`, turns by `sweep_rad` (positive is counter-clockwise seen
    /// from the plane's positive normal) about the centre at `to_center_mm` (first and second axis
    /// of `plane`) from the start, and rises by `rise_mm`.
    pub(super) fn new(
        start_mm: Vector,
        to_center_mm: [f64; 2],
        plane: Plane,
        sweep_rad: f64,
        rise_mm: f64,
    ) -> Self {
        let [first, second, normal] = plane.axes();
        let radius_mm = libm::hypot(to_center_mm[0], to_center_mm[1]);
        let inward = [to_center_mm[0] / radius_mm, to_center_mm[1] / radius_mm];
        let sense = sweep_rad.signum();

        let mut normal0 = [0.0; 3];
        normal0[first] = inward[0];
        normal0[second] = inward[1];
        // Counter-clockwise travel has the centre on its left: the tangent is the inward normal
        // turned by -90 degrees.
        let mut tangent0 = [0.0; 3];
        tangent0[first] = sense * inward[1];
        tangent0[second] = -sense * inward[0];

        let flat_mm = radius_mm * sweep_rad.abs();
        let length_mm = libm::hypot(flat_mm, rise_mm);
        let in_plane = flat_mm / length_mm;
        let mut rise = [0.0; 3];
        rise[normal] = rise_mm / length_mm;
        Self {
            start_mm,
            tangent0,
            normal0,
            rise,
            radius_mm,
            turn_rad_mm: sweep_rad.abs() / length_mm,
            in_plane,
            length_mm,
        }
    }

    /// Length, mm.
    pub(crate) const fn length_mm(&self) -> f64 {
        self.length_mm
    }

    /// Radius of the circle, mm.
    pub const fn radius_mm(&self) -> f64 {
        self.radius_mm
    }

    /// Centre of the circle; of a helix at the height of its start.
    pub fn center_mm(&self) -> Vector {
        add_scaled(self.start_mm, self.radius_mm, self.normal0)
    }

    /// Unit normal of the circle's plane, about which it turns counter-clockwise.
    pub fn axis(&self) -> Vector {
        cross(self.tangent0, self.normal0)
    }

    /// Angle that it turns by, rad.
    pub fn sweep_rad(&self) -> f64 {
        self.turn_rad_mm * self.length_mm
    }

    /// Returns true if the arc stays in the plane of the circle.
    pub fn is_flat(&self) -> bool {
        self.rise == [0.0; 3]
    }

    /// Curvature, 1/mm: `cos(gamma)^2 / R`.
    pub(crate) fn curvature(&self) -> f64 {
        self.in_plane * self.turn_rad_mm
    }

    /// Position and tangent at `s_mm`.
    #[inline]
    pub(crate) fn at(&self, s_mm: f64) -> Point {
        let (half_sin, half_cos) = libm::sincos(0.5 * self.turn_rad_mm * s_mm);
        let sin = 2.0 * half_sin * half_cos;
        let versine = 2.0 * half_sin * half_sin;
        let across = self.radius_mm * sin;
        let inward = self.radius_mm * versine;
        let forward = self.in_plane * (1.0 - versine);
        let sideways = self.in_plane * sin;
        let mut position_mm = [0.0; 3];
        let mut tangent = [0.0; 3];
        for k in 0..3 {
            position_mm[k] = self.start_mm[k]
                + across * self.tangent0[k]
                + inward * self.normal0[k]
                + s_mm * self.rise[k];
            tangent[k] = forward * self.tangent0[k] + sideways * self.normal0[k] + self.rise[k];
        }
        Point {
            position_mm,
            tangent,
        }
    }

    /// Derivatives at `s_mm`: with `phi' = k`, `p'' = R k^2 (cos(phi) n0 - sin(phi) t0)`, `p''' =
    /// -R k^3 (cos(phi) t0 + sin(phi) n0)`.
    pub(crate) fn derivatives(&self, s_mm: f64) -> Derivatives {
        let (sin, cos) = libm::sincos(self.turn_rad_mm * s_mm);
        let along = add_scaled(scale(cos, self.tangent0), sin, self.normal0);
        let inward = add_scaled(scale(cos, self.normal0), -sin, self.tangent0);
        let curvature = self.curvature();
        Derivatives {
            first: add_scaled(self.rise, self.in_plane, along),
            second_1_mm: scale(curvature, inward),
            third_1_mm2: scale(-curvature * self.turn_rad_mm, along),
        }
    }

    /// Arc length of the nearest point between the bounds.
    #[inline]
    pub(crate) fn nearest(&self, point_mm: [f64; 3], lo_mm: f64, hi_mm: f64) -> f64 {
        let from_start = sub(point_mm, self.start_mm);
        // In the frame of the start, the circle's point at angle phi is R (sin(phi), 1 - cos(phi)).
        let across = dot(from_start, self.tangent0);
        let outward = self.radius_mm - dot(from_start, self.normal0);
        let bearing = libm::atan2(across, outward);
        let s_mm = if self.rise == [0.0; 3] {
            nearest_angle(bearing, self.turn_rad_mm * lo_mm, self.turn_rad_mm * hi_mm)
                / self.turn_rad_mm
        } else {
            self.nearest_on_helix(
                point_mm,
                bearing,
                libm::hypot(across, outward),
                lo_mm,
                hi_mm,
            )
        };
        s_mm.min(hi_mm).max(lo_mm)
    }

    /// Half the derivative of the squared distance with respect to phi is `R rho sin(x) + k^2 (x -
    /// z)` where `x` is phi counted from the point's bearing in some turn, `rho` the point's
    /// distance from the axis, `k` the rise per radian and `z` the value of `x` at which the helix
    /// is as high as the point. The best turn is the one nearest in height; if its minimum lies
    /// outside the bounds, the best is a minimum of the nearest turn inside them, or a bound.
    #[cold]
    fn nearest_on_helix(
        &self,
        point_mm: Vector,
        bearing: f64,
        rho: f64,
        lo_mm: f64,
        hi_mm: f64,
    ) -> f64 {
        let rise_mm_mm = self.rise[0] + self.rise[1] + self.rise[2];
        let per_rad = rise_mm_mm / self.turn_rad_mm;
        let height = dot(sub(point_mm, self.start_mm), self.rise) / rise_mm_mm;
        let level = height / per_rad;
        let pull = self.radius_mm * rho / (per_rad * per_rad);

        let turn_of = |phi: f64| ((phi - bearing) / TAU).round();
        let first = turn_of(self.turn_rad_mm * lo_mm);
        let last = turn_of(self.turn_rad_mm * hi_mm);
        let best_turn = turn_of(level).clamp(first, last);

        let distance_at = |s_mm: f64| distance(self.at(s_mm).position_mm, point_mm);
        let mut best = (distance_at(lo_mm), lo_mm);
        let mut offer = |s_mm: f64| {
            let s_mm = s_mm.min(hi_mm).max(lo_mm);
            let here = distance_at(s_mm);
            if here < best.0 {
                best = (here, s_mm);
            }
        };
        for turn in [best_turn - 1.0, best_turn, best_turn + 1.0] {
            let base = bearing + TAU * turn;
            if let Some(x) = turn_minimum(pull, level - base) {
                offer((base + x) / self.turn_rad_mm);
            }
        }
        offer(hi_mm);
        best.1
    }
}

/// The angle equal to `bearing` up to whole turns that lies between the bounds, the smallest if
/// there are several, or the bound nearest to it.
#[inline]
fn nearest_angle(bearing: f64, lo: f64, hi: f64) -> f64 {
    let above = bearing + TAU * ((lo - bearing) / TAU).ceil();
    if above <= hi {
        above
    } else if above - hi < lo - (above - TAU) {
        hi
    } else {
        lo
    }
}

/// Root of `x + pull sin(x) = level` in `[-pi, pi]` that is a minimum, where there is one.
///
/// For `level >= 0` the left side rises from 0 and is concave up to its crest at `cos(x) =
/// -1/pull`; Newton from 0 stays left of the root and converges monotonically. Beyond the crest
/// there are only maxima.
fn turn_minimum(pull: f64, level: f64) -> Option<f64> {
    let target = level.abs();
    let crest = if pull > 1.0 {
        libm::acos(-1.0 / pull)
    } else {
        PI
    };
    if target > crest + pull * libm::sin(crest) {
        return None;
    }
    let mut x = 0.0;
    for _ in 0..MAX_NEWTON_STEPS {
        let (sin, cos) = libm::sincos(x);
        let slope = 1.0 + pull * cos;
        let next = if slope > 0.0 {
            x + (target - x - pull * sin) / slope
        } else {
            crest
        };
        let next = next.min(crest);
        // Monotone from the left: as soon as it no longer advances, it is there.
        if next <= x {
            break;
        }
        x = next;
    }
    Some(x.copysign(level))
}

/// Centre of a circle through both ends of `chord` that turns by at most half a turn in `sense`, as
/// near as possible to `to_center`; both relative to the start of the chord. Returns the new centre
/// and the sweep.
pub(super) fn recenter(chord: [f64; 2], to_center: [f64; 2], sense: f64) -> ([f64; 2], f64) {
    let length = libm::hypot(chord[0], chord[1]);
    // Unit normal of the chord on the side of the centre.
    let side = [-sense * chord[1] / length, sense * chord[0] / length];
    let height =
        (to_center[0] - 0.5 * chord[0]) * side[0] + (to_center[1] - 0.5 * chord[1]) * side[1];
    let center = [
        0.5 * chord[0] + height * side[0],
        0.5 * chord[1] + height * side[1],
    ];
    (center, sense * 2.0 * libm::atan2(0.5 * length, height))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::vector::norm;

    /// Distance of the end of an arc from a place, mm.
    fn end_error_mm(arc: &Arc, end_mm: Vector) -> f64 {
        distance(arc.at(arc.length_mm).position_mm, end_mm)
    }

    #[test]
    fn recentering_puts_both_ends_on_the_circle() {
        // Quarter circle of radius 10 whose centre misses by 0.01 mm.
        let (center, sweep) = recenter([-10.0, 10.0], [-10.01, 0.003], 1.0);
        assert!(
            (libm::hypot(center[0], center[1]) - libm::hypot(center[0] + 10.0, center[1] - 10.0))
                .abs()
                < 1e-14
        );
        assert!((sweep - PI / 2.0).abs() < 2e-3);
        let arc = Arc::new([10.0, 0.0, 0.0], center, Plane::Xy, sweep, 0.0);
        assert!(end_error_mm(&arc, [0.0, 10.0, 0.0]) < 1e-14);
    }

    #[test]
    fn an_enormous_radius_loses_nothing() {
        // Chord of 100 mm on a radius of 1e9 mm: the sagitta is 1.25 um.
        let (center, sweep) = recenter([100.0, 0.0], [50.0, 1e9], 1.0);
        let arc = Arc::new([0.0; 3], center, Plane::Xy, sweep, 0.0);
        assert!(end_error_mm(&arc, [100.0, 0.0, 0.0]) < 1e-13);
        let middle = arc.at(0.5 * arc.length_mm()).position_mm;
        assert!((middle[1] + 1.25e-6).abs() < 1e-14, "{middle:?}");
    }

    #[test]
    fn a_turn_minimum_is_a_root() {
        for (pull, level) in [
            (0.3, 1.0),
            (5.0, 2.0),
            (40.0, -3.0),
            (1.0, 3.1),
            (1e-9, -2.0),
            (1e6, 0.0),
        ] {
            let x = turn_minimum(pull, level).unwrap();
            assert!(
                (x + pull * libm::sin(x) - level).abs() < 1e-9 * (1.0 + pull),
                "{pull} {level} {x}"
            );
        }
        assert!(turn_minimum(0.5, 4.0).is_none());
    }

    #[test]
    fn tangent_is_a_unit_vector_on_a_helix() {
        let arc = Arc::new([1.0, 2.0, 3.0], [3.0, -4.0], Plane::Zx, -7.0, 12.0);
        for i in 0..50 {
            let tangent = arc.at(arc.length_mm() * f64::from(i) / 49.0).tangent;
            assert!((norm(tangent) - 1.0).abs() < 1e-14);
        }
        let end = add_scaled(arc.at(arc.length_mm()).position_mm, -1.0, arc.start_mm);
        assert!((end[1] - 12.0).abs() < 1e-13);
    }
}
