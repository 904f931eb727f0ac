//! Fits a few arcs and straight lines to points, within a tolerance and without corners between
//! them.
//!
//! A straight line, one arc or a biarc passes a stretch of points. A biarc is two arcs with a
//! common tangent: the first starts with the tangent at the first point, the second ends with the
//! tangent at the last point. With `v` from the first point to the last and `t0`, `t1` the unit
//! tangents, their joint is `(p0 + p1 + d (t0 - t1)) / 2`, where
//!
//! ```text
//! 2 (1 - t0 t1) d^2 + 2 d v (t0 + t1) - v v = 0
//! ```
//!
//! From each point the fit takes the longest stretch that it finds by doubling and halving. Arcs
//! lie in the plane of the first two axes; along the third they rise evenly (helices). A stretch
//! without motion in the plane is straight. Points along the axes of G18 or G19 give arcs of that
//! plane.
//!
//! Source: Bolton (1975), Biarc curves; equal tangent lengths as in Sutcliffe (2005).

use feedwright_gcode::canon::{Plane, Shape};

use crate::vector::{Vector, add_scaled, distance, dot, sub};

/// Tangents that differ by less meet without a corner, rad: half of what feed planners take for
/// one.
const TANGENT_RAD: f64 = 5e-4;
/// An arc turns by no more, rad: at half a turn its centre would be anybody's guess.
const MOST_RAD: f64 = 3.0;
/// An arc of a larger radius is straight, mm.
const STRAIGHT_MM: f64 = 2e4;
/// An arc of a smaller radius is straight, mm: its centre is only as good as its printed digits.
const POINT_MM: f64 = 0.02;
/// An arc between ends that are closer is straight, mm: four printed steps in inches. Rounded to
/// steps, its end could come to lie before its start, and the arc would be a full turn.
const LEAST_MM: f64 = 1e-4;
/// Lengths in the plane up to this count as zero, mm.
const NO_WAY_MM: f64 = 1e-6;
/// Most points of a stretch: bounds the work.
const MOST_POINTS: usize = 4096;
/// One arc is taken in place of a biarc that goes further by no more than this factor.
const TWO_FOR_ONE: usize = 2;

/// A point to be passed.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct FitPoint {
    /// Position along the axes of the plane and its normal, mm.
    pub at_mm: Vector,
    /// Direction of travel, of length 1 in the plane; zero where there is no way in the plane.
    pub tangent: [f64; 2],
    /// Feedrate from here on, mm/s; a motion ends where it changes.
    pub feed_mm_s: f64,
}

/// A motion of the fit, along the same axes.
#[derive(Debug, Clone, PartialEq)]
pub struct FitMotion {
    /// Start, mm.
    pub start_mm: Vector,
    /// End, mm.
    pub end_mm: Vector,
    /// Line or arc.
    pub shape: Shape,
    /// Feedrate, mm/s.
    pub feed_mm_s: f64,
}

/// An arc or a line of the plane, with its rise.
#[derive(Debug, Clone, Copy)]
struct FitArc {
    start_mm: Vector,
    end_mm: Vector,
    /// Signed radius, mm: positive is to the left; none is straight.
    radius_mm: Option<f64>,
    center_mm: [f64; 2],
    sweep_rad: f64,
    length_mm: f64,
}

/// Fits points.
pub struct ArcFit<'a> {
    points: &'a [FitPoint],
    tolerance_mm: f64,
    /// Printed steps in a millimetre.
    steps_per_mm: f64,
}

impl<'a> ArcFit<'a> {
    /// A fit of these points within a tolerance, written with `steps_per_mm` steps in a millimetre.
    pub const fn new(points: &'a [FitPoint], tolerance_mm: f64, steps_per_mm: f64) -> Self {
        Self {
            points,
            tolerance_mm,
            steps_per_mm,
        }
    }

    /// The motions, from the first point to the last.
    pub fn motions(&self) -> Vec<FitMotion> {
        let (mut motions, mut at) = (Vec::new(), 0);
        while at + 1 < self.points.len() {
            let (next, arcs) = self.longest(at);
            for arc in arcs {
                motions.push(FitMotion {
                    start_mm: arc.start_mm,
                    end_mm: arc.end_mm,
                    shape: self.shape(&arc),
                    feed_mm_s: self.points[at].feed_mm_s,
                });
            }
            at = next;
        }
        motions.retain(|motion| motion.start_mm != motion.end_mm);
        motions
    }

    /// The furthest point that is reached from a point, and how.
    fn longest(&self, from: usize) -> (usize, Vec<FitArc>) {
        let one = self.search(from, |to| self.single(from, to));
        let two = self.search(from, |to| self.biarc(from, to));
        match (one, two) {
            (Some((one, arc)), Some((two, _))) if TWO_FOR_ONE * (one - from) >= two - from => {
                (one, vec![arc])
            }
            (_, Some((two, arcs))) => (two, arcs.to_vec()),
            (Some((one, arc)), None) => (one, vec![arc]),
            (None, None) => (from + 1, vec![self.straight(from, from + 1)]),
        }
    }

    /// The furthest point that `fits`, by doubling and halving.
    fn search<T>(&self, from: usize, fits: impl Fn(usize) -> Option<T>) -> Option<(usize, T)> {
        let feed_mm_s = self.points[from].feed_mm_s;
        let changes = self.points[from + 1..]
            .iter()
            .position(|point| point.feed_mm_s != feed_mm_s);
        let last = changes
            .map_or(self.points.len() - 1, |k| from + 1 + k)
            .min(from + MOST_POINTS);
        let (mut best, mut good, mut bad) = (None, from, last + 1);
        let mut step = 1;
        while good < last {
            let to = (from + step).min(last);
            match fits(to) {
                Some(found) => (best, good) = (Some((to, found)), to),
                None => {
                    bad = to;
                    break;
                }
            }
            step *= 2;
        }
        while bad - good > 1 && bad <= last {
            let to = good + (bad - good) / 2;
            match fits(to) {
                Some(found) => (best, good) = (Some((to, found)), to),
                None => bad = to,
            }
        }
        best
    }

    /// A line or an arc from one point to another that starts along the tangent at the first.
    /// `None` if it does not end along the tangent at the last or does not fit the points between
    /// them.
    fn single(&self, from: usize, to: usize) -> Option<FitArc> {
        let (start, end) = (&self.points[from], &self.points[to]);
        let arc = self.arc(start.at_mm, start.tangent, end.at_mm);
        let arrives = arc.end_tangent(start.tangent);
        let turns = end.tangent == [0.0; 2] || turn_rad(arrives, end.tangent).abs() < TANGENT_RAD;
        (turns && self.passes(&[arc], from, to)).then_some(arc)
    }

    fn biarc(&self, from: usize, to: usize) -> Option<[FitArc; 2]> {
        let (start, end) = (&self.points[from], &self.points[to]);
        let (t0, t1) = (start.tangent, end.tangent);
        if t0 == [0.0; 2] || t1 == [0.0; 2] {
            return None;
        }
        let (p0, p1) = (self.printed(start.at_mm), self.printed(end.at_mm));
        let v = [p1[0] - p0[0], p1[1] - p0[1]];
        let along = dot(v, t0) + dot(v, t1);
        let bend = 2.0 * (1.0 - dot(t0, t1));
        let square = dot(v, v);
        // The root of the equation that does not lose digits where the tangents are almost equal.
        let d = square / (along + (along * along + bend * square).sqrt());
        if !(d.is_finite() && d > LEAST_MM) {
            return None;
        }
        let joint = [0, 1].map(|i| 0.5 * (p0[i] + p1[i] + d * (t0[i] - t1[i])));
        let flat = self.arc(p0, t0, [joint[0], joint[1], p0[2]]);
        let rest = self.arc([joint[0], joint[1], p0[2]], flat.end_tangent(t0), p1);
        let part = flat.length_mm / (flat.length_mm + rest.length_mm);
        let middle = self.printed([joint[0], joint[1], p0[2] + part * (p1[2] - p0[2])]);
        let first = self.arc(p0, t0, middle);
        // The end has the tangent: the second arc is made from there.
        let second = self.arc(p1, t1.map(|x| -x), middle).reversed();
        let arcs = [first, second];
        self.passes(&arcs, from, to).then_some(arcs)
    }

    fn straight(&self, from: usize, to: usize) -> FitArc {
        FitArc::straight(
            self.printed(self.points[from].at_mm),
            self.printed(self.points[to].at_mm),
        )
    }

    /// The arc from `start_mm` with a tangent there to `end_mm`, straight where it hardly bends.
    fn arc(&self, start_mm: Vector, tangent: [f64; 2], end_mm: Vector) -> FitArc {
        let (start_mm, end_mm) = (self.printed(start_mm), self.printed(end_mm));
        let way = [end_mm[0] - start_mm[0], end_mm[1] - start_mm[1]];
        let normal = [-tangent[1], tangent[0]];
        let (aside, along, square) = (dot(way, normal), dot(way, tangent), dot(way, way));
        let radius_mm = square / (2.0 * aside);
        let sweep_rad = 2.0 * libm::atan2(aside, along);
        if !(square > LEAST_MM * LEAST_MM
            && (POINT_MM..STRAIGHT_MM).contains(&radius_mm.abs())
            && sweep_rad.abs() > 1e-9)
        {
            return FitArc::straight(start_mm, end_mm);
        }
        let center_mm = [
            start_mm[0] + radius_mm * normal[0],
            start_mm[1] + radius_mm * normal[1],
        ];
        let length_mm = libm::hypot(radius_mm * sweep_rad, end_mm[2] - start_mm[2]);
        FitArc {
            start_mm,
            end_mm,
            radius_mm: Some(radius_mm),
            center_mm,
            sweep_rad,
            length_mm,
        }
    }

    /// Returns true if the arcs pass all points between `from` and `to`, and no arc turns too far.
    fn passes(&self, arcs: &[FitArc], from: usize, to: usize) -> bool {
        let gentle = |arc: &FitArc| arc.sweep_rad.abs() < MOST_RAD;
        let passed = |point: &FitPoint| {
            arcs.iter()
                .any(|arc| arc.distance_mm(point.at_mm) <= self.tolerance_mm)
        };
        // An arc with the length of many turns may come near all points and still not follow them.
        let way_mm: f64 = arcs.iter().map(|arc| arc.length_mm).sum();
        let points_mm: f64 = self.points[from..=to]
            .windows(2)
            .map(|pair| distance(pair[0].at_mm, pair[1].at_mm))
            .sum();
        arcs.iter().all(gentle)
            && way_mm < 1.1 * points_mm + self.tolerance_mm
            && self.points[from + 1..to].iter().all(passed)
    }

    /// Returns the shape as the reader gives it in G17.
    fn shape(&self, arc: &FitArc) -> Shape {
        let Some(radius_mm) = arc.radius_mm else {
            return Shape::Line;
        };
        let [i, j] = [0, 1].map(|k| self.print(arc.center_mm[k] - arc.start_mm[k]));
        let center_mm = [arc.start_mm[0] + i, arc.start_mm[1] + j, arc.start_mm[2]];
        Shape::Arc {
            plane: Plane::Xy,
            center_mm,
            turns: if radius_mm > 0.0 { 1 } else { -1 },
        }
    }

    fn print(&self, value: f64) -> f64 {
        (value * self.steps_per_mm).round() / self.steps_per_mm
    }

    fn printed(&self, point_mm: Vector) -> Vector {
        point_mm.map(|value| self.print(value))
    }
}

impl FitMotion {
    /// The same along X, Y and Z, of a fit to points along the axes of a plane.
    #[must_use]
    pub fn in_plane(self, plane: Plane) -> Self {
        let along = |of_plane: Vector| {
            let mut place = [0.0; 3];
            plane
                .axes()
                .into_iter()
                .zip(of_plane)
                .for_each(|(axis, value)| place[axis] = value);
            place
        };
        let shape = match self.shape {
            Shape::Arc {
                center_mm, turns, ..
            } => Shape::Arc {
                plane,
                center_mm: along(center_mm),
                turns,
            },
            shape => shape,
        };
        Self {
            start_mm: along(self.start_mm),
            end_mm: along(self.end_mm),
            shape,
            ..self
        }
    }
}

impl FitArc {
    fn straight(start_mm: Vector, end_mm: Vector) -> Self {
        let length_mm = distance(start_mm, end_mm);
        Self {
            start_mm,
            end_mm,
            radius_mm: None,
            center_mm: [0.0; 2],
            sweep_rad: 0.0,
            length_mm,
        }
    }

    /// The same the other way.
    fn reversed(self) -> Self {
        let Self {
            start_mm,
            end_mm,
            radius_mm,
            sweep_rad,
            ..
        } = self;
        Self {
            start_mm: end_mm,
            end_mm: start_mm,
            radius_mm: radius_mm.map(|r| -r),
            sweep_rad: -sweep_rad,
            ..self
        }
    }

    /// Tangent at its end, where it has `tangent` at its start.
    fn end_tangent(&self, tangent: [f64; 2]) -> [f64; 2] {
        if self.radius_mm.is_none() {
            let way = [
                self.end_mm[0] - self.start_mm[0],
                self.end_mm[1] - self.start_mm[1],
            ];
            let length = libm::hypot(way[0], way[1]);
            return if length > NO_WAY_MM {
                way.map(|x| x / length)
            } else {
                tangent
            };
        }
        let (sin, cos) = libm::sincos(self.sweep_rad);
        [
            tangent[0] * cos - tangent[1] * sin,
            tangent[0] * sin + tangent[1] * cos,
        ]
    }

    fn distance_mm(&self, point_mm: Vector) -> f64 {
        let Some(radius_mm) = self.radius_mm else {
            let (way, to_point) = (
                sub(self.end_mm, self.start_mm),
                sub(point_mm, self.start_mm),
            );
            let square = dot(way, way);
            let part = if square > 0.0 {
                (dot(to_point, way) / square).clamp(0.0, 1.0)
            } else {
                0.0
            };
            return distance(point_mm, add_scaled(self.start_mm, part, way));
        };
        let from_center = |at: Vector| [at[0] - self.center_mm[0], at[1] - self.center_mm[1]];
        let turned =
            turn_rad(from_center(self.start_mm), from_center(point_mm)) * radius_mm.signum();
        let part = (turned / self.sweep_rad.abs()).clamp(0.0, 1.0);
        let place = if part <= 0.0 {
            self.start_mm
        } else if part >= 1.0 {
            self.end_mm
        } else {
            let [x, y] = from_center(point_mm);
            let scale = radius_mm.abs() / libm::hypot(x, y);
            let z_mm = self.start_mm[2] + part * (self.end_mm[2] - self.start_mm[2]);
            [
                self.center_mm[0] + scale * x,
                self.center_mm[1] + scale * y,
                z_mm,
            ]
        };
        distance(place, point_mm)
    }
}

/// Angle from one direction to another, -pi to pi.
fn turn_rad(a: [f64; 2], b: [f64; 2]) -> f64 {
    libm::atan2(a[0] * b[1] - a[1] * b[0], dot(a, b))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Points of a helix of R = 5 mm, exact or with an error of each.
    fn helix(rise_mm: f64, count: usize) -> Vec<FitPoint> {
        (0..=count)
            .map(|k| {
                let part = k as f64 / count as f64;
                let (sin, cos) = libm::sincos(part * std::f64::consts::TAU);
                FitPoint {
                    at_mm: [5.0 * cos, 5.0 * sin, rise_mm * part],
                    tangent: [-sin, cos],
                    feed_mm_s: 10.0,
                }
            })
            .collect()
    }

    #[test]
    fn a_plunge_that_is_a_step_aside_has_no_arc() {
        let point = |k: u32| {
            let aside_mm = f64::from(k % 2) * 2e-5;
            FitPoint {
                at_mm: [1.0, 1.0 + aside_mm, -0.1 * f64::from(k)],
                tangent: [1.0, 0.0],
                feed_mm_s: 10.0,
            }
        };
        let points: Vec<FitPoint> = (0..20).map(point).collect();
        let motions = ArcFit::new(&points, 1e-3, 1e5).motions();
        assert!(
            motions.iter().all(|motion| motion.shape == Shape::Line),
            "{motions:?}"
        );
    }

    #[test]
    fn a_circle_and_a_helix_are_a_few_arcs() {
        for rise_mm in [0.0, 5.0] {
            let points = helix(rise_mm, 1000);
            let motions = ArcFit::new(&points, 1e-3, 1e5).motions();
            assert!(
                motions.len() <= 4,
                "{} blocks for a rise of {rise_mm} mm: {motions:?}",
                motions.len()
            );
        }
    }
}
