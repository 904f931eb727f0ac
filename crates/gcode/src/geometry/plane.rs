//! Points, lines and arcs of a plane, as far as cutter compensation and the cycles of lathes need
//! them.

/// A point or a vector.
pub(crate) type PlanePoint = [f64; 2];

pub(crate) fn add(a: PlanePoint, b: PlanePoint) -> PlanePoint {
    [a[0] + b[0], a[1] + b[1]]
}

pub(crate) fn minus(a: PlanePoint, b: PlanePoint) -> PlanePoint {
    [a[0] - b[0], a[1] - b[1]]
}

pub(crate) fn scaled(a: PlanePoint, by: f64) -> PlanePoint {
    [a[0] * by, a[1] * by]
}

pub(crate) fn dot(a: PlanePoint, b: PlanePoint) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

pub(crate) fn cross(a: PlanePoint, b: PlanePoint) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

pub(crate) fn length(a: PlanePoint) -> f64 {
    libm::hypot(a[0], a[1])
}

/// The vector at length 1; zero stays zero.
pub(crate) fn unit(a: PlanePoint) -> PlanePoint {
    let length = length(a);
    if length > 0.0 {
        scaled(a, 1.0 / length)
    } else {
        a
    }
}

/// The vector turned left by a quarter.
pub(crate) fn left_of(a: PlanePoint) -> PlanePoint {
    [-a[1], a[0]]
}

/// Slack of a comparison of lengths, mm: far below anything cut, far above rounding.
pub(crate) const SLACK_MM: f64 = 1e-9;

/// The same for angles, rad.
const SLACK_RAD: f64 = 1e-9;

/// A line or an arc.
#[derive(Debug, Clone, Copy)]
pub(crate) enum PlaneCurve {
    Line {
        start: PlanePoint,
        end: PlanePoint,
    },
    /// `turn` is 1 counter-clockwise, -1 clockwise; up to one full turn. Where start and end are
    /// not equally far from the centre, it counts as a circle through the end.
    Arc {
        start: PlanePoint,
        end: PlanePoint,
        center: PlanePoint,
        turn: f64,
    },
}

impl PlaneCurve {
    pub(crate) const fn start(&self) -> PlanePoint {
        match *self {
            Self::Line { start, .. } | Self::Arc { start, .. } => start,
        }
    }

    pub(crate) const fn end(&self) -> PlanePoint {
        match *self {
            Self::Line { end, .. } | Self::Arc { end, .. } => end,
        }
    }

    pub(crate) const fn set_start(&mut self, point: PlanePoint) {
        match self {
            Self::Line { start, .. } | Self::Arc { start, .. } => *start = point,
        }
    }

    pub(crate) const fn set_end(&mut self, point: PlanePoint) {
        match self {
            Self::Line { end, .. } | Self::Arc { end, .. } => *end = point,
        }
    }

    /// Returns the difference between the distances of two points from the center of an arc, mm; 0
    /// for a line.
    pub(crate) fn off_mm(&self, point: PlanePoint, other: PlanePoint) -> f64 {
        match *self {
            Self::Line { .. } => 0.0,
            Self::Arc { center, .. } => {
                (length(minus(point, center)) - length(minus(other, center))).abs()
            }
        }
    }

    /// Distance from start to end.
    pub(crate) fn chord(&self) -> f64 {
        length(minus(self.end(), self.start()))
    }

    /// Direction at a point of the curve.
    pub(crate) fn direction(&self, at: PlanePoint) -> PlanePoint {
        match *self {
            Self::Line { start, end } => unit(minus(end, start)),
            Self::Arc { center, turn, .. } => scaled(left_of(unit(minus(at, center))), turn),
        }
    }

    /// Returns the point where this curve can end and the other begin: the intersection nearest to
    /// a point. Of two equally near ones, it is the first along `other`.
    pub(crate) fn meet(&self, other: &Self, near: PlanePoint) -> Option<PlanePoint> {
        let candidates = self.candidates(other);
        let fits = |point: &PlanePoint| self.ends_at(*point) && other.begins_at(*point);
        let away = |point: &PlanePoint| length(minus(*point, near));
        match candidates {
            // Both as near: a line that turns back into an arc. The arc is entered as early as it
            // can be.
            [Some(a), Some(b)]
                if fits(&a) && fits(&b) && (away(&a) - away(&b)).abs() < SLACK_MM =>
            {
                Some(if other.way_to(a) <= other.way_to(b) {
                    a
                } else {
                    b
                })
            }
            _ => candidates
                .into_iter()
                .flatten()
                .filter(fits)
                .min_by(|a, b| away(a).total_cmp(&away(b))),
        }
    }

    /// Returns the first point along `other` where the two curves cross between their ends.
    pub(crate) fn first_crossing(&self, other: &Self) -> Option<PlanePoint> {
        let on_both = |point: &PlanePoint| {
            [self, other]
                .iter()
                .all(|curve| curve.ends_at(*point) && curve.begins_at(*point))
        };
        let candidates = self.candidates(other).into_iter().flatten().filter(on_both);
        candidates.min_by(|a, b| other.way_to(*a).total_cmp(&other.way_to(*b)))
    }

    /// Returns the intersections of the lines or circles that the curves lie on.
    fn candidates(&self, other: &Self) -> [Option<PlanePoint>; 2] {
        match (*self, *other) {
            (Self::Line { start: a, end: b }, Self::Line { start: c, end: d }) => {
                line_line(a, minus(b, a), c, minus(d, c))
            }
            (
                Self::Line { start, end },
                Self::Arc {
                    end: on, center, ..
                },
            )
            | (
                Self::Arc {
                    end: on, center, ..
                },
                Self::Line { start, end },
            ) => line_circle(
                start,
                unit(minus(end, start)),
                center,
                length(minus(on, center)),
            ),
            (
                Self::Arc {
                    end: a, center: c, ..
                },
                Self::Arc {
                    end: b, center: d, ..
                },
            ) => circle_circle(c, length(minus(a, c)), d, length(minus(b, d))),
        }
    }

    /// Returns the distance of a point along the curve, mm or rad.
    pub(crate) fn way_to(&self, point: PlanePoint) -> f64 {
        match *self {
            Self::Line { start, end } => dot(minus(point, start), unit(minus(end, start))),
            Self::Arc {
                start,
                center,
                turn,
                ..
            } => sweep_within(start, point, center, turn),
        }
    }

    /// The curve moved by a vector.
    pub(crate) fn moved(&self, by: PlanePoint) -> Self {
        match *self {
            Self::Line { start, end } => Self::Line {
                start: add(start, by),
                end: add(end, by),
            },
            Self::Arc {
                start,
                end,
                center,
                turn,
            } => Self::Arc {
                start: add(start, by),
                end: add(end, by),
                center: add(center, by),
                turn,
            },
        }
    }

    /// Curvature, positive to the left.
    pub(crate) fn bend(&self) -> f64 {
        match *self {
            Self::Line { .. } => 0.0,
            Self::Arc {
                start,
                center,
                turn,
                ..
            } => turn / length(minus(start, center)),
        }
    }

    /// Returns true if the curve, shortened at its end, can end at `point`.
    pub(crate) fn ends_at(&self, point: PlanePoint) -> bool {
        match *self {
            Self::Line { start, end } => {
                dot(minus(point, start), unit(minus(end, start))) >= -SLACK_MM
            }
            Self::Arc {
                start,
                end,
                center,
                turn,
            } => {
                let sweep = sweep(start, end, center, turn);
                let to_point = sweep_within(start, point, center, turn);
                to_point <= sweep + SLACK_RAD
            }
        }
    }

    /// Returns true if the curve, shortened at its start, can begin at `point`.
    pub(crate) fn begins_at(&self, point: PlanePoint) -> bool {
        match *self {
            Self::Line { start, end } => Self::Line {
                start: end,
                end: start,
            }
            .ends_at(point),
            Self::Arc {
                start,
                end,
                center,
                turn,
            } => Self::Arc {
                start: end,
                end: start,
                center,
                turn: -turn,
            }
            .ends_at(point),
        }
    }
}

/// Angle from start to end in the sense of `turn`, above 0 and up to a full turn.
pub(crate) fn sweep(start: PlanePoint, end: PlanePoint, center: PlanePoint, turn: f64) -> f64 {
    let angle = sweep_within(start, end, center, turn);
    if angle < SLACK_RAD {
        std::f64::consts::TAU
    } else {
        angle
    }
}

/// The same from 0.
fn sweep_within(start: PlanePoint, end: PlanePoint, center: PlanePoint, turn: f64) -> f64 {
    let (a, b) = (minus(start, center), minus(end, center));
    let angle = turn * libm::atan2(cross(a, b), dot(a, b));
    if angle < -SLACK_RAD {
        angle + std::f64::consts::TAU
    } else {
        angle.max(0.0)
    }
}

fn line_line(
    a: PlanePoint,
    along: PlanePoint,
    c: PlanePoint,
    other: PlanePoint,
) -> [Option<PlanePoint>; 2] {
    let determinant = cross(along, other);
    if determinant == 0.0 {
        return [None, None];
    }
    let t = cross(minus(c, a), other) / determinant;
    [Some(add(a, scaled(along, t))), None]
}

fn line_circle(
    a: PlanePoint,
    along: PlanePoint,
    center: PlanePoint,
    radius: f64,
) -> [Option<PlanePoint>; 2] {
    let foot = add(a, scaled(along, dot(minus(center, a), along)));
    let distance = length(minus(center, foot));
    if distance > radius + SLACK_MM {
        return [None, None];
    }
    let half = (radius * radius - distance * distance).max(0.0).sqrt();
    [
        Some(add(foot, scaled(along, half))),
        Some(add(foot, scaled(along, -half))),
    ]
}

fn circle_circle(c: PlanePoint, r: f64, d: PlanePoint, q: f64) -> [Option<PlanePoint>; 2] {
    let apart = minus(d, c);
    let distance = length(apart);
    if distance == 0.0 || distance > r + q + SLACK_MM || distance < (r - q).abs() - SLACK_MM {
        return [None, None];
    }
    let x = (distance * distance + r * r - q * q) / (2.0 * distance);
    let y = (r * r - x * x).max(0.0).sqrt();
    let along = unit(apart);
    let foot = add(c, scaled(along, x));
    [
        Some(add(foot, scaled(left_of(along), y))),
        Some(add(foot, scaled(left_of(along), -y))),
    ]
}

/// An arc in the plane's own two coordinates.
#[derive(Debug, Clone, Copy)]
pub(crate) struct PlaneArc {
    pub(crate) center: [f64; 2],
    /// Turns as in [`Shape::Arc`](crate::canon::Shape::Arc).
    pub(crate) turns: i32,
}

/// The curve moved to its left; an arc that would vanish does not exist.
pub(crate) fn shifted(curve: &PlaneCurve, by: f64) -> Option<PlaneCurve> {
    Some(match *curve {
        PlaneCurve::Line { start, end } => {
            let shift = scaled(left_of(unit(minus(end, start))), by);
            PlaneCurve::Line {
                start: add(start, shift),
                end: add(end, shift),
            }
        }
        PlaneCurve::Arc {
            start,
            end,
            center,
            turn,
        } => {
            let out = |point: PlanePoint| {
                let ray = minus(point, center);
                let radius = length(ray);
                (radius - turn * by > SLACK_MM)
                    .then(|| add(center, scaled(ray, (radius - turn * by) / radius)))
            };
            PlaneCurve::Arc {
                start: out(start)?,
                end: out(end)?,
                center,
                turn,
            }
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn curves_meet_where_they_should() {
        let floor = PlaneCurve::Line {
            start: [0.0, 0.0],
            end: [4.0, 0.0],
        };
        let wall = PlaneCurve::Line {
            start: [3.0, -1.0],
            end: [3.0, 5.0],
        };
        assert_eq!(floor.meet(&wall, [0.0, 0.0]).unwrap(), [3.0, 0.0]);
        let circle = PlaneCurve::Arc {
            start: [5.0, 0.0],
            end: [0.0, 5.0],
            center: [0.0, 0.0],
            turn: 1.0,
        };
        assert_eq!(
            floor
                .meet(
                    &PlaneCurve::Arc {
                        start: [3.0, 0.0],
                        end: [0.0, 3.0],
                        center: [0.0, 0.0],
                        turn: 1.0
                    },
                    [4.0, 1.0]
                )
                .unwrap(),
            [3.0, 0.0]
        );
        let other = PlaneCurve::Arc {
            start: [1.0, 0.0],
            end: [6.0, 5.0],
            center: [6.0, 0.0],
            turn: -1.0,
        };
        let point = circle.meet(&other, [3.0, 9.0]).unwrap();
        assert!((point[0] - 3.0).abs() < 1e-12 && (point[1] - 4.0).abs() < 1e-12);
        assert!(circle.ends_at(point) && !circle.ends_at([3.0, -4.0]));
        assert!(floor.begins_at([1.0, 0.0]) && !floor.begins_at([4.5, 0.0]));
        // A spiral's end is what the next motion meets.
        let spiral = PlaneCurve::Arc {
            start: [3.5, 0.0],
            end: [0.0, 3.0],
            center: [0.0, 0.0],
            turn: 1.0,
        };
        assert_eq!(
            spiral
                .meet(
                    &PlaneCurve::Line {
                        start: [0.0, 0.0],
                        end: [0.0, 9.0]
                    },
                    [0.0, 3.0]
                )
                .unwrap(),
            [0.0, 3.0]
        );
        let PlaneCurve::Arc { center, end, .. } = spiral.moved([1.0, 2.0]) else {
            panic!("an arc stays an arc")
        };
        assert_eq!((center, end), ([1.0, 2.0], [1.0, 5.0]));
    }
}
