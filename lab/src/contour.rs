//! The closed-form contours of the benchmark, exact and by arc length.
//!
//! | Name | Definition, mm, `a` from 0 to 2 pi |
//! |---|---|
//! | circle | `R (1 - cos a, sin a)`, R = 10 (Lee, Cho, Jeon 2005, eq. 11) |
//! | ellipse | `(20 cos a, 10 sin a)` |
//! | eight | `(15 sin a, 10 sin 2a)` |
//! | star | `(12 + 4 cos 5a) (cos a, sin a)` |
//! | square | 20 x 20, sharp corners, counter-clockwise |
//! | butterfly | NURBS of Yeh and Hsu (2002), see `butterfly.rs` |
//! | line-line-circle | (0,0) (40,30) (60,30), then a full circle about (90,30), counter-clockwise |

use feedwright_gcode::canon::{
    AuxiliaryAxes, Canon, Corner, Motion, MotionKind, Plane, Shape, Spline,
};
use feedwright_plan::vector::scale;

use feedwright_plan::{
    Curve, Jet, MIN_FEED_MM_S, Parametric, PathError, Piece, Pieces, Smooth, Step,
};

use crate::butterfly::butterfly;
use std::f64::consts::TAU;
use std::sync::Arc;

/// A contour with a name.
#[derive(Debug, Clone, Copy)]
pub struct Contour {
    /// Name.
    pub name: &'static str,
    /// Description, for lists.
    pub about: &'static str,
    outline: Outline,
}

#[derive(Debug, Clone, Copy)]
enum Outline {
    /// Corner points.
    Polygon(&'static [[f64; 2]]),
    /// Corner points, then a full turn about a centre; negative is clockwise.
    Circle(&'static [[f64; 2]], [f64; 2], i32),
    /// A closed curve, and its third derivative.
    Curve(fn(f64) -> Jet, fn(f64) -> [f64; 3]),
    /// A NURBS.
    Spline(fn() -> Spline),
}

const fn named(name: &'static str, about: &'static str, outline: Outline) -> Contour {
    Contour {
        name,
        about,
        outline,
    }
}

const SQUARE: &[[f64; 2]] = &[
    [0.0, 0.0],
    [20.0, 0.0],
    [20.0, 20.0],
    [0.0, 20.0],
    [0.0, 0.0],
];
const LINES: &[[f64; 2]] = &[[0.0, 0.0], [40.0, 30.0], [60.0, 30.0]];
const CIRCLE: Outline = Outline::Circle(&[[0.0, 0.0]], [10.0, 0.0], -1);

/// All contours.
pub const CONTOURS: &[Contour] = &[
    named(
        "circle",
        "circle of radius 10 mm, from the origin, clockwise",
        CIRCLE,
    ),
    named(
        "ellipse",
        "half axes 20 and 10 mm",
        Outline::Curve(ellipse, ellipse_third),
    ),
    named(
        "eight",
        "figure of eight, 30 x 20 mm",
        Outline::Curve(eight, eight_third),
    ),
    named(
        "star",
        "five soft points, radius 8 to 16 mm",
        Outline::Curve(star, star_third),
    ),
    named(
        "butterfly",
        "NURBS with sharp tips, 103 x 62 mm",
        Outline::Spline(butterfly),
    ),
    named(
        "square",
        "20 x 20 mm, sharp corners",
        Outline::Polygon(SQUARE),
    ),
    named(
        "line-line-circle",
        "two lines and a circle of radius 30 mm",
        Outline::Circle(LINES, [90.0, 30.0], 1),
    ),
];

/// Corner mode of the contours: corners are taken at the speed that the machine's limits allow.
pub const CORNER: Corner = Corner::Continuous {
    tolerance_mm: None,
    merge_mm: None,
};

/// Placement of a contour: scaled, and turned about the origin.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placement {
    /// Factor on all lengths.
    pub scale: f64,
    /// Counter-clockwise, rad.
    pub turn_rad: f64,
}

impl Placement {
    /// Contour at the place where it is defined.
    pub const NONE: Self = Self {
        scale: 1.0,
        turn_rad: 0.0,
    };

    /// A vector, scaled and turned. Where nothing is to be done it keeps its bits.
    fn of(self, vector: [f64; 3]) -> [f64; 3] {
        if self == Self::NONE {
            return vector;
        }
        let [x, y, z] = scale(self.scale, vector);
        let (sin, cos) = (libm::sin(self.turn_rad), libm::cos(self.turn_rad));
        [cos * x - sin * y, sin * x + cos * y, z]
    }
}

/// The contour of that name.
pub fn contour(name: &str) -> Option<&'static Contour> {
    CONTOURS.iter().find(|contour| contour.name == name)
}

impl Contour {
    /// Returns true if the contour has no corners.
    pub fn is_smooth(&self) -> bool {
        match self.outline {
            Outline::Polygon(_) => false,
            Outline::Circle(points, ..) => points.len() == 1,
            Outline::Curve(..) | Outline::Spline(_) => true,
        }
    }

    /// Returns the contour as steps of a path, all cutting at `feed_mm_s`, with corners taken as
    /// `corner` says. Lines count from 1.
    ///
    /// # Errors
    /// Fails if `feed_mm_s` is below [`MIN_FEED_MM_S`] or not finite.
    pub fn steps(&self, feed_mm_s: f64, corner: Corner) -> Result<Vec<Step>, PathError> {
        self.placed_steps(Placement::NONE, feed_mm_s, corner)
    }

    /// Returns the steps of [`Contour::steps`], scaled and turned by `place`.
    ///
    /// # Errors
    /// Fails if `feed_mm_s` is below [`MIN_FEED_MM_S`] or not finite.
    pub fn placed_steps(
        &self,
        place: Placement,
        feed_mm_s: f64,
        corner: Corner,
    ) -> Result<Vec<Step>, PathError> {
        if !(MIN_FEED_MM_S..=f64::MAX).contains(&feed_mm_s) {
            return Err(PathError::Feed { line: 1, feed_mm_s });
        }
        if let Some(canon) = self.lines_and_arcs(place, feed_mm_s, corner) {
            return Pieces::new(canon.into_iter()).collect();
        }
        match self.outline {
            // Made above.
            Outline::Polygon(_) | Outline::Circle(..) => Ok(Vec::new()),
            Outline::Spline(spline) => {
                let mut spline = spline();
                for point_mm in &mut spline.control_mm {
                    *point_mm = place.of(*point_mm);
                }
                let ends_mm = [0, spline.control_mm.len() - 1].map(|i| spline.control_mm[i]);
                let shape = Shape::Spline(Arc::new(spline));
                let motion = motion(1, ends_mm, shape, feed_mm_s, corner);
                Pieces::new(std::iter::once(motion)).collect()
            }
            Outline::Curve(jet, third) => {
                let smooth = Smooth::new(Box::new(Closed { jet, third, place }));
                Ok(vec![Step::Piece(Piece {
                    start_mm: place.of(jet(0.0).position_mm),
                    length_mm: smooth.length_mm(),
                    curve: Curve::Smooth(Arc::new(smooth)),
                    s_mm: 0.0,
                    line: 1,
                    cutting: true,
                    feed_mm_s,
                    corner,
                    turn_deg_mm: 0.0,
                    further_mm_mm: 0.0,
                })])
            }
        }
    }

    /// The motions of a contour that is made of straight lines and full circles; none of others.
    pub fn lines_and_arcs(
        &self,
        place: Placement,
        feed_mm_s: f64,
        corner: Corner,
    ) -> Option<Vec<Canon>> {
        match self.outline {
            Outline::Polygon(points) => Some(lines(points, place, feed_mm_s, corner)),
            Outline::Circle(points, center, turns) => {
                let mut canon = lines(points, place, feed_mm_s, corner);
                let at = place.of(space(points[points.len() - 1]));
                let shape = Shape::Arc {
                    plane: Plane::Xy,
                    center_mm: place.of(space(center)),
                    turns,
                };
                canon.push(motion(
                    points.len() as u32,
                    [at; 2],
                    shape,
                    feed_mm_s,
                    corner,
                ));
                Some(canon)
            }
            Outline::Curve(..) | Outline::Spline(_) => None,
        }
    }
}

fn space(point: [f64; 2]) -> [f64; 3] {
    [point[0], point[1], 0.0]
}

fn lines(points: &[[f64; 2]], place: Placement, feed_mm_s: f64, corner: Corner) -> Vec<Canon> {
    let line = |(ends, line): (&[[f64; 2]], u32)| {
        let ends_mm = [ends[0], ends[1]].map(|end| place.of(space(end)));
        motion(line, ends_mm, Shape::Line, feed_mm_s, corner)
    };
    points.windows(2).zip(1..).map(line).collect()
}

/// A motion that cuts.
pub fn motion(
    line: u32,
    [start_mm, end_mm]: [[f64; 3]; 2],
    shape: Shape,
    feed_mm_s: f64,
    corner: Corner,
) -> Canon {
    Canon::Motion(Motion {
        line,
        kind: MotionKind::Feed,
        start_mm,
        end_mm,
        shape,
        feed_mm_s,
        corner,
        others: AuxiliaryAxes::default(),
    })
}

/// Spans of a closed curve. With 16 of them, the symmetry of the curve does not mislead the first
/// test of a cell.
const SPANS: usize = 16;

/// A closed curve over the angle `a`.
struct Closed {
    jet: fn(f64) -> Jet,
    third: fn(f64) -> [f64; 3],
    place: Placement,
}

impl std::fmt::Debug for Closed {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str("Closed")
    }
}

impl Parametric for Closed {
    fn spans(&self) -> usize {
        SPANS
    }

    fn jet(&self, span: usize, u: f64) -> Jet {
        let per_span = TAU / SPANS as f64;
        let jet = (self.jet)(per_span * (span as f64 + u));
        Jet {
            position_mm: self.place.of(jet.position_mm),
            first: self.place.of(scale(per_span, jet.first)),
            second: self.place.of(scale(per_span * per_span, jet.second)),
        }
    }

    fn third(&self, span: usize, u: f64) -> [f64; 3] {
        let per_span = TAU / SPANS as f64;
        let third = (self.third)(per_span * (span as f64 + u));
        self.place.of(scale(per_span.powi(3), third))
    }
}

fn ellipse(a: f64) -> Jet {
    let (sin, cos) = libm::sincos(a);
    Jet {
        position_mm: [20.0 * cos, 10.0 * sin, 0.0],
        first: [-20.0 * sin, 10.0 * cos, 0.0],
        second: [-20.0 * cos, -10.0 * sin, 0.0],
    }
}

fn ellipse_third(a: f64) -> [f64; 3] {
    [20.0 * libm::sin(a), -10.0 * libm::cos(a), 0.0]
}

fn eight(a: f64) -> Jet {
    let (sin, cos) = libm::sincos(a);
    let (sin2, cos2) = (2.0 * sin * cos, 1.0 - 2.0 * sin * sin);
    Jet {
        position_mm: [15.0 * sin, 10.0 * sin2, 0.0],
        first: [15.0 * cos, 20.0 * cos2, 0.0],
        second: [-15.0 * sin, -40.0 * sin2, 0.0],
    }
}

fn eight_third(a: f64) -> [f64; 3] {
    [-15.0 * libm::cos(a), -80.0 * libm::cos(2.0 * a), 0.0]
}

fn star(a: f64) -> Jet {
    let (sin, cos) = libm::sincos(a);
    // (cos a + i sin a)^5, which is several times faster than another sine and cosine.
    let (cos2, sin2) = (cos * cos - sin * sin, 2.0 * cos * sin);
    let (cos4, sin4) = (cos2 * cos2 - sin2 * sin2, 2.0 * cos2 * sin2);
    let (cos5, sin5) = (cos4 * cos - sin4 * sin, sin4 * cos + cos4 * sin);
    let r = 12.0 + 4.0 * cos5;
    let dr = -20.0 * sin5;
    let ddr = -100.0 * cos5;
    let (inward, around) = (ddr - r, 2.0 * dr);
    Jet {
        position_mm: [r * cos, r * sin, 0.0],
        first: [dr * cos - r * sin, dr * sin + r * cos, 0.0],
        second: [
            inward * cos - around * sin,
            inward * sin + around * cos,
            0.0,
        ],
    }
}

fn star_third(a: f64) -> [f64; 3] {
    let (sin, cos) = libm::sincos(a);
    let (sin5, cos5) = libm::sincos(5.0 * a);
    let (r, dr, ddr, dddr) = (12.0 + 4.0 * cos5, -20.0 * sin5, -100.0 * cos5, 500.0 * sin5);
    let (inward, around) = (dddr - 3.0 * dr, 3.0 * ddr - r);
    let (x, y) = (inward * cos - around * sin, inward * sin + around * cos);
    [x, y, 0.0]
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Length and places of the first piece follow the placement; of a smooth curve to what its arc
    /// length is exact to.
    #[test]
    fn a_contour_elsewhere_is_the_same_scaled_and_turned() {
        let place = Placement {
            scale: 1.5,
            turn_rad: 2.0,
        };
        for contour in CONTOURS {
            let here = contour.steps(50.0, CORNER).unwrap();
            let there = contour.placed_steps(place, 50.0, CORNER).unwrap();
            let (Some(Step::Piece(a)), Some(Step::Piece(b))) = (here.first(), there.first()) else {
                panic!("{}", contour.name)
            };
            let name = contour.name;
            assert!((1.5 * a.length_mm - b.length_mm).abs() < 1e-7, "{name}");
            for part in [0.0, 0.3, 1.0] {
                let wanted = place.of(a.curve.at(part * a.length_mm).position_mm);
                let found = b.curve.at(part * b.length_mm).position_mm;
                let is_there = (0..2).all(|k| (wanted[k] - found[k]).abs() < 1e-7);
                assert!(is_there, "{name}: {wanted:?} {found:?}");
            }
        }
    }
}
