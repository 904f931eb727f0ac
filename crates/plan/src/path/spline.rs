//! Rational B-splines (NURBS) of any degree up to [`MAX_DEGREE`], as smooth curves.
//!
//! Each span between two knots becomes a rational Bezier curve in homogeneous coordinates `(w x, w
//! y, w z, w)`: its control points are the blossom of the span's polynomial at the span's ends (L.
//! Ramshaw, Blossoming: a connect-the-dots approach to splines, 1987), evaluated by de Casteljau's
//! scheme, which is stable for any degree. With `A` the homogeneous position and `w` the weight,
//!
//! `C = A / w`, `C' = (A' - w' C) / w`, `C'' = (A'' - 2 w' C' - w'' C) / w`, `C''' = (A''' - 3 w'
//! C'' - 3 w'' C' - w''' C) / w`
//!
//! Where the direction jumps between two spans (a knot of full multiplicity, or control points that
//! coincide) the spline has a corner, and is cut into several curves there.

use feedwright_gcode::canon::Spline;

use super::PathError;
use super::smooth::{Jet, Parametric, Smooth};
use super::{MAX_COORDINATE_MM, MIN_LENGTH_MM};
use crate::vector::{Vector, add_scaled, angle, distance, norm, scale, sub};

/// Highest degree: a cut that no program reaches, so that evaluation needs no memory but the
/// stack's.
pub(crate) const MAX_DEGREE: usize = 15;

/// Directions that differ by more than this between two spans make a corner: rounding of control
/// points turns them by less, and what it leaves is counted with the joint as any other turn.
const CORNER_RAD: f64 = 1e-6;

/// Homogeneous point: x w, y w, z w, w.
type Homogeneous = [f64; 4];

/// Bezier curves in a row, `degree + 1` control points each.
#[derive(Debug)]
struct Beziers {
    degree: usize,
    points: Vec<Homogeneous>,
}

/// The smooth curves of a spline, in order, each with its start.
pub(super) fn curves(spline: &Spline, line: u32) -> Result<Vec<(Vector, Smooth)>, PathError> {
    check(spline).map_err(|what| PathError::Spline { line, what })?;
    let degree = spline.degree;
    let mut runs: Vec<Beziers> = Vec::new();
    for span in degree..spline.control_mm.len() {
        if spline.knots[span] < spline.knots[span + 1] {
            let bezier = Beziers {
                degree,
                points: bezier(spline, span),
            };
            if bezier.polygon_mm() < MIN_LENGTH_MM {
                continue;
            }
            match runs.last_mut() {
                Some(run) if angle(run.end_direction(), bezier.start_direction()) < CORNER_RAD => {
                    run.points.extend(bezier.points);
                }
                _ => runs.push(bezier),
            }
        }
    }
    let start = |run: Beziers| (run.jet(0, 0.0).position_mm, Smooth::new(Box::new(run)));
    Ok(runs.into_iter().map(start).collect())
}

/// Says what is wrong with a spline.
fn check(spline: &Spline) -> Result<(), String> {
    let Spline {
        degree,
        knots,
        control_mm,
        weights,
    } = spline;
    if !(1..=MAX_DEGREE).contains(degree) {
        return Err(format!(
            "spline of degree {degree}, it must be 1 to {MAX_DEGREE}"
        ));
    }
    let count = control_mm.len();
    if count <= *degree {
        return Err(format!(
            "spline of degree {degree} with {count} control points, it needs {}",
            degree + 1
        ));
    }
    if knots.len() != count + degree + 1 {
        return Err(format!(
            "spline with {} knots, it needs {}",
            knots.len(),
            count + degree + 1
        ));
    }
    if weights.len() != count {
        return Err(format!(
            "spline with {} weights for {count} control points",
            weights.len()
        ));
    }
    if let Some(value) = control_mm
        .iter()
        .flatten()
        .find(|x| !(-MAX_COORDINATE_MM..=MAX_COORDINATE_MM).contains(*x))
    {
        return Err(format!(
            "spline with a coordinate of {value} mm, limit {MAX_COORDINATE_MM:e} mm"
        ));
    }
    // Beyond these, products of weights and coordinates lose all digits.
    if let Some(weight) = weights
        .iter()
        .find(|weight| !(1e-9..=1e9).contains(*weight))
    {
        return Err(format!(
            "spline with a weight of {weight}, it must be 1e-9 to 1e9"
        ));
    }
    if knots.iter().any(|knot| !knot.is_finite()) || knots.windows(2).any(|pair| pair[0] > pair[1])
    {
        return Err("spline whose knots do not ascend".to_owned());
    }
    // A knot of multiplicity degree + 1 inside cuts the curve in two, with a gap.
    let inner = &knots[1..knots.len() - 1];
    if let Some(same) = inner
        .windows(degree + 1)
        .find(|same| same[0] == same[*degree])
    {
        return Err(format!(
            "spline with a gap: knot {} stands more than {degree} times",
            same[0]
        ));
    }
    if knots[*degree] >= knots[count] {
        return Err("spline without length: all its knots are equal".to_owned());
    }
    Ok(())
}

/// Control points of the Bezier curve of one span: point `j` is the blossom at `degree - j` times
/// the span's start and `j` times its end.
fn bezier(spline: &Spline, span: usize) -> Vec<Homogeneous> {
    let degree = spline.degree;
    let knots = &spline.knots;
    let (lo, hi) = (knots[span], knots[span + 1]);
    (0..=degree)
        .map(|j| {
            let mut points = [[0.0; 4]; MAX_DEGREE + 1];
            for i in 0..=degree {
                let index = span - degree + i;
                let [x, y, z] = spline.control_mm[index];
                let w = spline.weights[index];
                points[i] = [w * x, w * y, w * z, w];
            }
            for level in 1..=degree {
                let u = if level <= j { hi } else { lo };
                for i in (level..=degree).rev() {
                    let (a, b) = (knots[span - degree + i], knots[span + 1 + i - level]);
                    points[i] = mix(points[i - 1], points[i], (u - a) / (b - a));
                }
            }
            points[degree]
        })
        .collect()
}

#[inline]
fn mix(a: Homogeneous, b: Homogeneous, t: f64) -> Homogeneous {
    [0, 1, 2, 3].map(|k| (1.0 - t) * a[k] + t * b[k])
}

#[inline]
fn minus(a: Homogeneous, b: Homogeneous) -> Homogeneous {
    [0, 1, 2, 3].map(|k| a[k] - b[k])
}

fn project(point: Homogeneous) -> Vector {
    let [x, y, z, w] = point;
    [x / w, y / w, z / w]
}

impl Beziers {
    /// Length of the control polygon: the curve is no longer.
    fn polygon_mm(&self) -> f64 {
        self.points
            .windows(2)
            .map(|pair| distance(project(pair[0]), project(pair[1])))
            .sum()
    }

    /// Direction at the start: to the first control point that is not the start.
    fn start_direction(&self) -> Vector {
        let start = project(self.points[0]);
        direction(self.points.iter().map(|point| sub(project(*point), start)))
    }

    /// Direction at the end: from the last control point that is not the end.
    fn end_direction(&self) -> Vector {
        let end = project(self.points[self.points.len() - 1]);
        direction(
            self.points
                .iter()
                .rev()
                .map(|point| sub(end, project(*point))),
        )
    }
}

/// The first of some vectors that is not zero; rounding leaves control points that should coincide
/// 1e-13 mm apart.
fn direction(mut vectors: impl Iterator<Item = Vector>) -> Vector {
    vectors
        .find(|vector| norm(*vector) > MIN_LENGTH_MM)
        .unwrap_or([0.0; 3])
}

impl Parametric for Beziers {
    fn spans(&self) -> usize {
        self.points.len() / (self.degree + 1)
    }

    #[inline]
    fn jet(&self, span: usize, u: f64) -> Jet {
        let degree = self.degree;
        let from = span * (degree + 1);
        let mut points = [[0.0; 4]; MAX_DEGREE + 1];
        points[..=degree].copy_from_slice(&self.points[from..=from + degree]);
        // Down to three points (two for a line), whose differences are the derivatives.
        for left in (2.min(degree)..degree).rev() {
            for i in 0..=left {
                points[i] = mix(points[i], points[i + 1], u);
            }
        }
        let n = degree as f64;
        let (low, high, bend) = if degree >= 2 {
            let bend = minus(minus(points[2], points[1]), minus(points[1], points[0]));
            (
                mix(points[0], points[1], u),
                mix(points[1], points[2], u),
                bend.map(|x| n * (n - 1.0) * x),
            )
        } else {
            (points[0], points[1], [0.0; 4])
        };
        let value = mix(low, high, u);
        let slope = minus(high, low).map(|x| n * x);
        let w = 1.0 / value[3];
        let xyz = |point: Homogeneous| [point[0], point[1], point[2]];
        let position_mm = scale(w, xyz(value));
        let first = scale(w, add_scaled(xyz(slope), -slope[3], position_mm));
        let second = add_scaled(
            add_scaled(xyz(bend), -2.0 * slope[3], first),
            -bend[3],
            position_mm,
        );
        Jet {
            position_mm,
            first,
            second: scale(w, second),
        }
    }

    fn third(&self, span: usize, u: f64) -> Vector {
        let degree = self.degree;
        let from = span * (degree + 1);
        let mut points = [[0.0; 4]; MAX_DEGREE + 1];
        points[..=degree].copy_from_slice(&self.points[from..=from + degree]);
        // A, A', A'', A''': the control points of a derivative are differences of those before.
        let mut derivatives = [[0.0; 4]; 4];
        for (order, value) in derivatives.iter_mut().enumerate().take(degree.min(3) + 1) {
            let left = degree - order;
            let mut scheme = points;
            for level in (0..left).rev() {
                for i in 0..=level {
                    scheme[i] = mix(scheme[i], scheme[i + 1], u);
                }
            }
            *value = scheme[0];
            for i in 0..left {
                points[i] = minus(points[i + 1], points[i]).map(|x| left as f64 * x);
            }
        }
        let [value, slope, bend, [x, y, z, twist]] = derivatives;
        let Jet {
            position_mm,
            first,
            second,
        } = self.jet(span, u);
        let third = add_scaled([x, y, z], -3.0 * slope[3], second);
        let third = add_scaled(
            add_scaled(third, -3.0 * bend[3], first),
            -twist,
            position_mm,
        );
        scale(1.0 / value[3], third)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn spline(degree: usize, knots: &[f64], control: &[[f64; 2]], weights: &[f64]) -> Spline {
        Spline {
            degree,
            knots: knots.to_vec(),
            control_mm: control.iter().map(|[x, y]| [*x, *y, 0.0]).collect(),
            weights: weights.to_vec(),
        }
    }

    #[test]
    fn a_quarter_circle_is_one() {
        let w = 0.5f64.sqrt();
        let quarter = spline(
            2,
            &[0.0, 0.0, 0.0, 1.0, 1.0, 1.0],
            &[[10.0, 0.0], [10.0, 10.0], [0.0, 10.0]],
            &[1.0, w, 1.0],
        );
        let curves = curves(&quarter, 1).unwrap();
        let curve = &curves[0].1;
        assert!((curve.length_mm() - 5.0 * std::f64::consts::PI).abs() < 1e-9);
        for i in 0..=100 {
            let s_mm = curve.length_mm() * f64::from(i) / 100.0;
            let angle = s_mm / 10.0;
            let at = curve.at(s_mm);
            assert!(
                distance(
                    at.position_mm,
                    [10.0 * libm::cos(angle), 10.0 * libm::sin(angle), 0.0]
                ) < 1e-9
            );
            assert!(distance(at.tangent, [-libm::sin(angle), libm::cos(angle), 0.0]) < 1e-10);
            assert!((curve.curvature(s_mm) - 0.1).abs() < 1e-12);
        }
    }

    #[test]
    fn degree_one_is_a_polygon() {
        let polygon = spline(
            1,
            &[0.0, 0.0, 1.0, 5.0, 5.0],
            &[[0.0, 0.0], [3.0, 4.0], [3.0, 10.0]],
            &[1.0, 2.0, 1.0],
        );
        let curves = curves(&polygon, 1).unwrap();
        assert_eq!(curves.len(), 2);
        assert!((curves[0].1.length_mm() - 5.0).abs() < 1e-10);
        assert!((curves[1].1.length_mm() - 6.0).abs() < 1e-10);
        assert!(distance(curves[1].1.at(3.0).position_mm, [3.0, 7.0, 0.0]) < 1e-10);
    }

    #[test]
    fn a_full_knot_inside_is_a_corner() {
        let two = spline(
            2,
            &[0.0, 0.0, 0.0, 1.0, 1.0, 2.0, 2.0, 2.0],
            &[[0.0, 0.0], [1.0, 0.0], [2.0, 1.0], [2.0, 3.0], [0.0, 3.0]],
            &[1.0; 5],
        );
        assert_eq!(curves(&two, 1).unwrap().len(), 2);
    }

    #[test]
    fn coinciding_control_points_end_in_a_direction() {
        // |C'| is zero at both ends.
        let lazy = spline(
            3,
            &[0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0],
            &[[0.0, 0.0], [0.0, 0.0], [6.0, 8.0], [6.0, 8.0]],
            &[1.0; 4],
        );
        let curves = curves(&lazy, 1).unwrap();
        let curve = &curves[0].1;
        assert!((curve.length_mm() - 10.0).abs() < 1e-9);
        for s_mm in [0.0, 1e-9, 0.3, 5.0, 10.0 - 1e-9, 10.0] {
            let at = curve.at(s_mm);
            assert!(
                distance(at.position_mm, [0.6 * s_mm, 0.8 * s_mm, 0.0]) < 1e-9,
                "{s_mm}: {at:?}"
            );
            assert!(
                distance(at.tangent, [0.6, 0.8, 0.0]) < 1e-9,
                "{s_mm}: {at:?}"
            );
        }
    }

    #[test]
    fn what_is_no_spline_is_refused() {
        let control = [[0.0, 0.0], [1.0, 0.0], [2.0, 1.0], [3.0, 1.0]];
        let knots = [0.0, 0.0, 0.0, 1.0, 2.0, 2.0, 2.0];
        assert!(curves(&spline(2, &knots, &control, &[1.0; 4]), 1).is_ok());
        for bad in [
            spline(0, &knots, &control, &[1.0; 4]),
            spline(16, &knots, &control, &[1.0; 4]),
            spline(2, &knots[1..], &control, &[1.0; 4]),
            spline(2, &knots, &control[1..], &[1.0; 4]),
            spline(2, &knots, &control, &[1.0; 3]),
            spline(2, &knots, &control, &[1.0, 0.0, 1.0, 1.0]),
            spline(2, &knots, &control, &[1.0, -1.0, 1.0, 1.0]),
            spline(2, &knots, &control, &[1.0, f64::NAN, 1.0, 1.0]),
            spline(2, &[0.0, 0.0, 0.0, 2.0, 1.0, 2.0, 2.0], &control, &[1.0; 4]),
            spline(2, &[0.0, 0.0, 1.0, 1.0, 1.0, 2.0, 2.0], &control, &[1.0; 4]),
            spline(2, &[1.0; 7], &control, &[1.0; 4]),
            spline(
                2,
                &[0.0, 0.0, 0.0, f64::NAN, 2.0, 2.0, 2.0],
                &control,
                &[1.0; 4],
            ),
            spline(
                2,
                &knots,
                &[[0.0, 0.0], [1e10, 0.0], [2.0, 1.0], [3.0, 1.0]],
                &[1.0; 4],
            ),
        ] {
            let error = curves(&bad, 5).unwrap_err();
            assert!(
                matches!(error, PathError::Spline { line: 5, .. }),
                "{error}"
            );
        }
    }
}
