//! The circular arc that blends a corner of lines and circles in one plane.
//!
//! With `theta` half the angle between the two sides of the corner, an arc of radius `R` touches
//! both at `d = R / tan(theta)` from the corner and passes it at `h = R (1 / sin(theta) - 1)`. `h`
//! is bounded by the tolerance, `d` by half of each side; the speed on the arc is `sqrt(a_n R)`,
//! with `a_n = sqrt(3) / 2` of the acceleration. Where that is more than is asked for, `R` is only
//! as large as it has to be. A circle stands for a secant where it curves into the corner, and the
//! centre of the arc is moved until it touches.

use std::f64::consts::{FRAC_PI_2, PI};

use super::limits::{DirectionLimits, GAP_PERIODS, NO_DISTANCE_MM, NORMAL_RATIO, PERIOD_S};
use super::segment::MotionSegment;
use super::shape::{BlendShape, CircleShape, LineShape, SegmentShape};
use crate::vector::{Vector, add_scaled, angle, cross, dot, norm, scale, sub};

/// Angles below this count as zero, rad.
const NO_ANGLE: f64 = 1e-6;

/// The square of the distance of unit vectors that count as parallel.
const PARALLEL: f64 = 1e-12;

/// Shortest arc, mm.
const SHORTEST_MM: f64 = 1e-6;

/// Half the sharpest corner between two circles.
const SHARPEST: f64 = PI / 12.0;

/// Part of a block that a tolerance may be.
const TOLERANCE_PART: f64 = 0.25;

/// Part of the normal acceleration by which an arc may miss the direction of its neighbour.
const KINK_PART: f64 = 0.25;

/// An arc, and what is left of its neighbours.
#[derive(Debug, Clone, Copy)]
pub(super) struct ArcBlend {
    /// The arc.
    pub(crate) shape: BlendShape,
    /// Speed asked for.
    pub(crate) feed_mm_s: f64,
    /// Highest speed.
    pub(crate) highest_mm_s: f64,
    /// Acceleration.
    pub(crate) accel_mm_s2: f64,
    /// Remainder of the segment before; `None` where the arc replaces it.
    pub(crate) before: Option<SegmentShape>,
    /// Remainder of the segment behind.
    pub(crate) after: SegmentShape,
    /// Length cut from the segment before and from the segment behind, mm.
    pub(crate) cut_mm: [f64; 2],
}

/// A corner.
#[derive(Debug, Clone, Copy)]
struct BlendCorner {
    point_mm: Vector,
    /// Tangents, and the directions that stand for them.
    tangents: [Vector; 2],
    directions: [Vector; 2],
    /// Towards the inside, and across the plane.
    inward: Vector,
    across: Vector,
    theta: f64,
}

/// One side of a corner.
#[derive(Debug, Clone, Copy)]
struct CornerSide {
    /// Data of a side that is a circle: the circle, whether it curves into the corner, and how much
    /// of it may be cut.
    circle: Option<(CircleShape, bool, f64)>,
    /// Length of the side that the blend may use, mm.
    length_mm: f64,
}

/// Radius and speeds.
#[derive(Debug, Clone, Copy)]
struct BlendSize {
    tolerance_mm: f64,
    radius_mm: f64,
    touches_mm: f64,
    feed_mm_s: f64,
    planned_mm_s: f64,
    accel_mm_s2: f64,
}

/// The arc between two segments, where there is one.
pub(super) fn arc_blend(
    before: &MotionSegment,
    after: &MotionSegment,
    limits: &DirectionLimits,
) -> Option<ArcBlend> {
    let mut corner = BlendCorner::new(before, after)?;
    let sides = corner.sides(before, after)?;
    let size = corner.size(before, after, &sides, limits)?;
    let center_mm = corner.center(&sides, &size)?;
    // Between two lines, `size` has already bounded the radius by the tolerance.
    let is_round = sides.iter().any(|side| side.circle.is_some());
    if is_round && norm(sub(center_mm, corner.point_mm)) - size.radius_mm > size.tolerance_mm {
        return None;
    }
    let cut = sides.map(|side| match side.circle {
        None => corner.cut_of_line(&sides, &size, center_mm),
        Some((circle, ..)) => angle(
            sub(corner.point_mm, circle.center_mm),
            sub(center_mm, circle.center_mm),
        ),
    });
    for (side, cut) in sides.iter().zip(cut) {
        if side.circle.is_some_and(|(_, _, most)| cut > most) {
            return None;
        }
    }
    let left_mm = before.length_mm - cut[0];
    let is_line = sides[0].circle.is_none();
    let consumes =
        is_line && !before.is_blended_into && left_mm / size.planned_mm_s < GAP_PERIODS * PERIOD_S;
    let first = without(&before.shape, cut[0], false)?;
    let second = without(&after.shape, cut[1], true)?;
    let ends_mm = [first.0, second.0];
    let line_mm = if consumes { left_mm.max(0.0) } else { 0.0 };
    let shape = BlendShape::new(center_mm, ends_mm, corner.tangents[0], line_mm)?;
    corner
        .is_tangent(&shape, &sides, [&first.1, &second.1], &size)
        .then_some(ArcBlend {
            shape,
            feed_mm_s: size.feed_mm_s,
            highest_mm_s: size.planned_mm_s.min(shape.length_mm() / PERIOD_S),
            accel_mm_s2: size.accel_mm_s2,
            before: (!consumes).then_some(first.1),
            after: second.1,
            cut_mm: [first.2, second.2],
        })
}

/// A shape without a part of one end, a length of a line or an angle of a circle: where it is cut,
/// what is left, and the length cut.
fn without(shape: &SegmentShape, cut: f64, at_start: bool) -> Option<(Vector, SegmentShape, f64)> {
    match shape {
        SegmentShape::Line(line) => {
            let length_mm = (line.length_mm - cut).max(0.0);
            let at_mm = if at_start {
                line.at(cut)
            } else {
                line.at(line.length_mm - cut)
            };
            let start_mm = if at_start { at_mm } else { line.start_mm };
            Some((
                at_mm,
                SegmentShape::Line(LineShape {
                    start_mm,
                    length_mm,
                    ..*line
                }),
                cut,
            ))
        }
        SegmentShape::Circle(circle) => {
            let left = if at_start {
                circle.without_start(cut)
            } else {
                circle.without_end(cut)
            };
            let at_mm = if at_start {
                left.at(0.0)
            } else {
                left.at(left.angle)
            };
            (left.angle > 0.0).then_some((
                at_mm,
                SegmentShape::Circle(left),
                circle.length_mm() - left.length_mm(),
            ))
        }
        SegmentShape::Blend(_) => None,
    }
}

impl BlendCorner {
    fn new(before: &MotionSegment, after: &MotionSegment) -> Option<Self> {
        let tangents = [before.shape.tangents()[1], after.shape.tangents()[0]];
        let theta = half_angle(tangents);
        if FRAC_PI_2 - theta < NO_ANGLE || theta < NO_ANGLE {
            return None;
        }
        let unit = |vector: Vector| scale(1.0 / norm(vector), vector);
        Some(Self {
            point_mm: after.shape.at(0.0),
            tangents,
            directions: tangents,
            inward: unit(sub(tangents[1], tangents[0])),
            across: unit(cross(tangents[0], tangents[1])),
            theta,
        })
    }

    /// Both sides; circles that curve into the corner change its directions.
    fn sides(&mut self, before: &MotionSegment, after: &MotionSegment) -> Option<[CornerSide; 2]> {
        let theta = self.theta;
        let mut sides = [CornerSide {
            circle: None,
            length_mm: 0.0,
        }; 2];
        for (i, segment) in [before, after].into_iter().enumerate() {
            sides[i] = match segment.shape {
                SegmentShape::Line(_) => CornerSide {
                    circle: None,
                    length_mm: segment.length_mm.min(0.5 * segment.nominal_mm),
                },
                SegmentShape::Circle(circle) => self.round_side(i, &circle, theta)?,
                SegmentShape::Blend(_) => return None,
            };
        }
        let is_round = sides.iter().all(|side| side.circle.is_some());
        (!is_round || self.theta >= SHARPEST).then_some(sides)
    }

    fn round_side(&mut self, i: usize, circle: &CircleShape, theta: f64) -> Option<CornerSide> {
        let parallel = |sign: f64| {
            let apart = add_scaled(self.across, sign, circle.normal);
            dot(apart, apart) < PARALLEL
        };
        if norm(circle.rise_mm) > 0.0 || !(parallel(1.0) || parallel(-1.0)) {
            return None;
        }
        let center_mm = add_scaled(circle.center_mm, circle.growth_mm(), self.tangents[i]);
        let outward = sub(self.point_mm, center_mm);
        let radius_mm = norm(outward);
        let curves_in = if i == 0 {
            dot(outward, self.tangents[1]) < 0.0
        } else {
            dot(outward, self.tangents[0]) > 0.0
        };
        let part = if i == 0 { 2.0 / 3.0 } else { 1.0 / 3.0 };
        let most = (part * circle.angle).min(if curves_in { theta } else { FRAC_PI_2 });
        if curves_in {
            let from_end = if i == 0 {
                circle.angle - 0.5 * most
            } else {
                0.5 * most
            };
            let secant = scale(
                if i == 0 { 1.0 } else { -1.0 },
                sub(self.point_mm, circle.at(from_end)),
            );
            self.directions[i] = scale(1.0 / norm(secant).max(f64::MIN_POSITIVE), secant);
            self.theta = self.theta.min(theta - 0.25 * most);
        }
        let length_mm = radius_mm
            * if curves_in {
                libm::sin(0.25 * most)
            } else {
                most
            };
        // A spiral counts as the circle that touches it.
        let touching = CircleShape {
            center_mm,
            radius_mm,
            ..*circle
        };
        Some(CornerSide {
            circle: Some((touching, curves_in, most)),
            length_mm,
        })
    }

    fn size(
        &self,
        before: &MotionSegment,
        after: &MotionSegment,
        sides: &[CornerSide; 2],
        limits: &DirectionLimits,
    ) -> Option<BlendSize> {
        let (theta, turn) = (self.theta, PI - 2.0 * self.theta);
        let part_mm = |segment: &MotionSegment| TOLERANCE_PART * segment.nominal_mm;
        let own_mm = |segment: &MotionSegment| {
            if segment.tolerance_mm > 0.0 {
                segment.tolerance_mm
            } else {
                part_mm(segment)
            }
        };
        let tolerance_mm = own_mm(before)
            .min(own_mm(after))
            .min(part_mm(before))
            .min(part_mm(after));
        let [plane_mm_s, accel_mm_s2] = limits.in_plane(self.across);
        let normal_mm_s2 = accel_mm_s2 * NORMAL_RATIO;
        let feed_of = |segment: &MotionSegment| segment.feed_mm_s.min(segment.highest_mm_s);
        let feed_mm_s = feed_of(before).max(feed_of(after));
        let straight = sides.iter().all(|side| side.circle.is_none());
        let axes_mm_s = if straight {
            plane_mm_s.max(self.altitude_mm_s(before, after))
        } else {
            plane_mm_s
        };
        let goal_mm_s = before
            .overridden_mm_s()
            .max(after.overridden_mm_s())
            .min(axes_mm_s);

        let by_tolerance_mm = libm::cos(theta) * tolerance_mm / (1.0 - libm::sin(theta));
        let room_mm = sides[0]
            .length_mm
            .min(sides[1].length_mm)
            .min(by_tolerance_mm);
        let most_mm = libm::tan(theta) * room_mm;
        let planned_mm_s = (normal_mm_s2 * most_mm).sqrt().min(goal_mm_s);
        // As long as a parabolic blend would take.
        let parabolic_mm_s2 = 0.5 * accel_mm_s2;
        let blend_s = (2.0 * parabolic_mm_s2 * room_mm).sqrt().min(planned_mm_s) / parabolic_mm_s2;
        let radius_mm = (planned_mm_s * planned_mm_s / normal_mm_s2)
            .max((blend_s * planned_mm_s / turn).min(most_mm));
        let is_arc = radius_mm > NO_DISTANCE_MM && radius_mm * turn > SHORTEST_MM;
        let touches_mm = radius_mm / libm::tan(theta);
        is_arc.then_some(BlendSize {
            tolerance_mm,
            radius_mm,
            touches_mm,
            feed_mm_s,
            planned_mm_s,
            accel_mm_s2,
        })
    }

    /// The least speed between two velocities on their way from one to the other: the altitude of
    /// the triangle that they make.
    fn altitude_mm_s(&self, before: &MotionSegment, after: &MotionSegment) -> f64 {
        let turn = PI - 2.0 * self.theta;
        let cos = libm::cos(turn.min(0.49 * PI));
        let first = before.highest_mm_s.min(after.highest_mm_s / cos);
        let second = after.highest_mm_s.min(before.highest_mm_s / cos);
        let base = norm(sub(
            scale(second, self.directions[1]),
            scale(first, self.directions[0]),
        ));
        first * second * libm::sin(turn) / base.max(f64::MIN_POSITIVE)
    }

    fn center(&self, sides: &[CornerSide; 2], size: &BlendSize) -> Option<Vector> {
        let reach = |circle: &CircleShape, curves_in: bool| {
            circle.radius_mm
                + if curves_in {
                    -size.radius_mm
                } else {
                    size.radius_mm
                }
        };
        match (sides[0].circle, sides[1].circle) {
            (None, None) => Some(add_scaled(
                self.point_mm,
                size.radius_mm / libm::sin(self.theta),
                self.inward,
            )),
            (Some((first, in_1, _)), Some((second, in_2, _))) => {
                self.between(&first, reach(&first, in_1), &second, reach(&second, in_2))
            }
            (round, other) => {
                let (circle, curves_in, _) = round.or(other)?;
                let along = if round.is_some() {
                    self.directions[1]
                } else {
                    scale(-1.0, self.directions[0])
                };
                let ahead = if round.is_some() {
                    along
                } else {
                    self.directions[0]
                };
                let side = cross(self.across, ahead);
                let to_center = sub(circle.center_mm, self.point_mm);
                let (c_along, c_side) = (dot(to_center, along), dot(to_center, side));
                let square = reach(&circle, curves_in).powi(2) - (size.radius_mm - c_side).powi(2);
                let root = (square >= 0.0).then(|| square.sqrt())?;
                let nearest = (c_along - root).abs().min((c_along + root).abs());
                Some(add_scaled(
                    add_scaled(self.point_mm, nearest, along),
                    size.radius_mm,
                    side,
                ))
            }
        }
    }

    /// The point so far from both centres that is nearer to the corner.
    fn between(
        &self,
        first: &CircleShape,
        d1: f64,
        second: &CircleShape,
        d2: f64,
    ) -> Option<Vector> {
        let apart = sub(second.center_mm, first.center_mm);
        let way = norm(apart);
        let along = (d1 * d1 - d2 * d2 + way * way) / (2.0 * way);
        let square = d1 * d1 - along * along;
        if way <= NO_DISTANCE_MM || square < 0.0 {
            return None;
        }
        let ahead = scale(1.0 / way, apart);
        let foot = add_scaled(first.center_mm, along, ahead);
        let side = scale(square.sqrt(), cross(self.across, ahead));
        let both = [add_scaled(foot, 1.0, side), add_scaled(foot, -1.0, side)];
        let away = both.map(|center| norm(sub(center, self.point_mm)));
        Some(if away[0] < away[1] { both[0] } else { both[1] })
    }

    /// Returns the length of a line that the arc replaces, mm.
    fn cut_of_line(&self, sides: &[CornerSide; 2], size: &BlendSize, center_mm: Vector) -> f64 {
        match (sides[0].circle, sides[1].circle) {
            (None, None) => size.touches_mm,
            (None, _) => -dot(sub(center_mm, self.point_mm), self.directions[0]),
            _ => dot(sub(center_mm, self.point_mm), self.directions[1]),
        }
    }

    /// Returns true if the arc continues in the direction of the circles beside it.
    fn is_tangent(
        &self,
        shape: &BlendShape,
        sides: &[CornerSide; 2],
        left: [&SegmentShape; 2],
        size: &BlendSize,
    ) -> bool {
        let most = NORMAL_RATIO * KINK_PART * size.accel_mm_s2 / (size.planned_mm_s / PERIOD_S);
        let others = [left[0].tangents()[1], left[1].tangents()[0]];
        let radii_mm = shape.ends_mm.map(norm);
        let growth_mm = (radii_mm[1] - radii_mm[0]) / shape.angle;
        (0..2).filter(|&i| sides[i].circle.is_some()).all(|i| {
            let round = cross(self.across, shape.ends_mm[i]);
            angle(
                add_scaled(round, growth_mm / radii_mm[i], shape.ends_mm[i]),
                others[i],
            ) <= most
        })
    }
}

/// Half the angle between the sides of a corner, rad: a right angle if the path goes straight on.
pub(super) fn half_angle([before, after]: [Vector; 2]) -> f64 {
    0.5 * (PI - angle(before, after))
}
