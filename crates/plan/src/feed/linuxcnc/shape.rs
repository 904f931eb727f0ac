//! What segments look like: lines, circles, blends.

use super::limits::NO_DISTANCE_MM;
use crate::path::{Curve, Piece};
use crate::vector::{Vector, add_scaled, cross, dot, norm, scale, sub};

/// An arc that rises less than this per millimeter of path counts as flat, mm/mm.
const NO_RISE: f64 = 1e-9;

/// A straight line.
#[derive(Debug, Clone, Copy)]
pub(super) struct LineShape {
    /// Start point.
    pub(crate) start_mm: Vector,
    /// Its direction.
    pub(crate) direction: Vector,
    /// Its length.
    pub(crate) length_mm: f64,
}

/// A circle, helix or spiral: `center + (1 + growth phi / angle) (cos(phi) first + sin(phi)
/// second) + rise phi / angle`.
#[derive(Debug, Clone, Copy)]
pub(super) struct CircleShape {
    /// Centre, beside the start.
    pub(crate) center_mm: Vector,
    /// Vector from the center to the start.
    pub(crate) first_mm: Vector,
    /// Vector of the same length in the direction of travel at the start.
    pub(crate) second_mm: Vector,
    /// Unit vector of the axis that it turns about, to the left.
    pub(crate) normal: Vector,
    /// Radius at the start.
    pub(crate) radius_mm: f64,
    /// Angle turned.
    pub(crate) angle: f64,
    /// Growth of the radius over the whole angle, as a part of the radius at the start.
    pub(crate) growth: f64,
    /// Way along the axis.
    pub(crate) rise_mm: Vector,
    /// Rounding error at its end, mm: from the computed end to the programmed end.
    pub(crate) left_over_mm: Vector,
}

/// A circular arc between two segments, with what is left of a line that it replaces before it.
#[derive(Debug, Clone, Copy)]
pub(super) struct BlendShape {
    /// Start point of the arc.
    pub(crate) start_mm: Vector,
    /// Tangent there.
    pub(crate) tangent: Vector,
    /// Length of the line before it.
    pub(crate) line_mm: f64,
    /// Centre.
    pub(crate) center_mm: Vector,
    /// Vectors from the center to both ends.
    pub(crate) ends_mm: [Vector; 2],
    /// Radius at the start.
    pub(crate) radius_mm: f64,
    /// Angle turned.
    pub(crate) angle: f64,
}

/// The curve of a segment.
#[derive(Debug, Clone, Copy)]
pub(super) enum SegmentShape {
    /// Straight.
    Line(LineShape),
    /// Circle of the program.
    Circle(CircleShape),
    /// Arc that blends a corner.
    Blend(BlendShape),
}

impl LineShape {
    /// The line between two points.
    pub(super) fn new(start_mm: Vector, end_mm: Vector) -> Option<Self> {
        let way = sub(end_mm, start_mm);
        let length_mm = norm(way);
        (length_mm > NO_DISTANCE_MM).then(|| Self {
            start_mm,
            direction: scale(1.0 / length_mm, way),
            length_mm,
        })
    }

    /// A point of it.
    pub(super) fn at(&self, along_mm: f64) -> Vector {
        add_scaled(self.start_mm, along_mm, self.direction)
    }
}

impl CircleShape {
    /// The circle of a piece.
    pub(super) fn of(piece: &Piece) -> Option<Self> {
        let Curve::Arc(arc) = &piece.curve else {
            return None;
        };
        let at_start = piece.curve.derivatives(0.0);
        let (inward, backward) = (at_start.second_1_mm, at_start.third_1_mm2);
        let inward = scale(1.0 / norm(inward), inward);
        let forward = scale(-1.0 / norm(backward), backward);
        let radius_mm = arc.radius_mm();
        let in_plane = dot(at_start.first, forward);
        let rise = add_scaled(at_start.first, -in_plane, forward);
        // Rounding is no helix.
        let rise = if norm(rise) < NO_RISE { [0.0; 3] } else { rise };
        let shape = Self {
            center_mm: add_scaled(piece.start_mm, radius_mm, inward),
            first_mm: scale(-radius_mm, inward),
            second_mm: scale(radius_mm, forward),
            normal: cross(forward, inward),
            radius_mm,
            angle: in_plane * piece.length_mm / radius_mm,
            growth: 0.0,
            rise_mm: scale(piece.length_mm, rise),
            left_over_mm: [0.0; 3],
        };
        (shape.angle.is_finite() && shape.angle > 0.0).then_some(shape)
    }

    /// The spiral of which circles are the parts, each turning by as much: the one through the
    /// beginning, a joint, and the end.
    pub(super) fn spiral(parts: &[Self]) -> Option<Self> {
        let (first, last) = (parts.first()?, parts.last()?);
        let half = parts.len() / 2;
        let (joint, share) = (parts.get(half)?, half as f64 / parts.len() as f64);
        let (angle, rise_mm) = parts.iter().fold((0.0, [0.0; 3]), |(angle, rise), part| {
            (angle + part.angle, add_scaled(rise, 1.0, part.rise_mm))
        });
        if half == 0 {
            return Some(*first);
        }
        // In the plane, with complex numbers, from the beginning: c = (p_m - s e / E p_N) / (1 - e
        // (1 - s) - s e / E).
        let frame = [
            scale(1.0 / first.radius_mm, first.first_mm),
            scale(1.0 / first.radius_mm, first.second_mm),
        ];
        let start_mm = first.at(0.0);
        let seen = |point: Vector| frame.map(|axis| dot(sub(point, start_mm), axis));
        let (middle, end) = (seen(joint.at(0.0)), seen(last.at(last.angle)));
        let turn = |angle: f64, size: f64| [size * libm::cos(angle), size * libm::sin(angle)];
        let back = turn((share - 1.0) * angle, share);
        let there = turn(share * angle, 1.0 - share);
        let divisor = [1.0 - there[0] - back[0], -there[1] - back[1]];
        let moved = times(back, end);
        let center = over([middle[0] - moved[0], middle[1] - moved[1]], divisor)?;
        let center_mm = add_scaled(
            add_scaled(start_mm, center[0], frame[0]),
            center[1],
            frame[1],
        );
        let first_mm = sub(start_mm, center_mm);
        let radius_mm = norm(first_mm);
        let end_radius_mm = libm::hypot(end[0] - center[0], end[1] - center[1]);
        let second_mm = cross(first.normal, first_mm);
        let growth = end_radius_mm / radius_mm - 1.0;
        let shape = Self {
            center_mm,
            first_mm,
            second_mm,
            radius_mm,
            angle,
            growth,
            rise_mm,
            ..*first
        };
        let left_over_mm = sub(last.at(last.angle), shape.at(angle));
        growth.is_finite().then_some(Self {
            left_over_mm,
            ..shape
        })
    }

    /// A point of it.
    pub(super) fn at(&self, angle: f64) -> Vector {
        let radial = self.radial_mm(angle);
        let part = angle / self.angle;
        std::array::from_fn(|k| {
            self.center_mm[k] + radial[k] + part * (self.rise_mm[k] + self.left_over_mm[k])
        })
    }

    /// Returns the vector from the axis to a point of the circle.
    pub(super) fn radial_mm(&self, angle: f64) -> Vector {
        let (sin, cos) = libm::sincos(angle);
        scale(
            1.0 + self.growth * angle / self.angle,
            add_scaled(scale(cos, self.first_mm), sin, self.second_mm),
        )
    }

    /// Unit tangent.
    pub(super) fn tangent(&self, angle: f64) -> Vector {
        let radial = self.radial_mm(angle);
        let round = add_scaled(cross(self.normal, radial), 1.0 / self.angle, self.rise_mm);
        let tangent = add_scaled(round, self.growth_mm() / norm(radial), radial);
        scale(1.0 / norm(tangent), tangent)
    }

    /// Growth of the radius per radian, mm.
    pub(super) fn growth_mm(&self) -> f64 {
        self.growth * self.radius_mm / self.angle
    }

    /// Radius at the end.
    pub(super) fn end_radius_mm(&self) -> f64 {
        self.radius_mm * (1.0 + self.growth)
    }

    /// Length.
    pub(super) fn length_mm(&self) -> f64 {
        libm::hypot(self.flat_mm(), norm(self.rise_mm))
    }

    /// Ways in a radian at both ends; between them LinuxCNC takes them to change evenly.
    fn slopes_mm(&self) -> [f64; 2] {
        [self.radius_mm, self.end_radius_mm()].map(|mm| libm::hypot(mm, self.growth_mm()))
    }

    /// Length without the rise.
    pub(super) fn flat_mm(&self) -> f64 {
        let [start, end] = self.slopes_mm();
        0.5 * self.angle * (start + end)
    }

    /// Angle after a part of the length.
    pub(super) fn angle_after(&self, part: f64) -> f64 {
        let [start, end] = self.slopes_mm();
        let along_mm = part * self.flat_mm();
        let square = start * start + 2.0 * (end - start) / self.angle * along_mm;
        2.0 * along_mm / (start + square.max(0.0).sqrt())
    }

    /// Radius of curvature.
    pub(super) fn curvature_radius_mm(&self) -> f64 {
        let growth = self.growth_mm().powi(2);
        let inner = growth + self.radius_mm * self.radius_mm;
        let flat_mm = inner * inner.sqrt() / (inner + growth);
        flat_mm + dot(self.rise_mm, self.rise_mm) / flat_mm
    }

    /// Returns the remainder without a part of the beginning.
    pub(super) fn without_start(&self, angle: f64) -> Self {
        let part = (self.angle - angle) / self.angle;
        let first_mm = self.radial_mm(angle);
        let radius_mm = norm(first_mm);
        Self {
            center_mm: add_scaled(
                self.center_mm,
                1.0 - part,
                add_scaled(self.rise_mm, 1.0, self.left_over_mm),
            ),
            first_mm,
            second_mm: cross(self.normal, first_mm),
            radius_mm,
            angle: self.angle - angle,
            growth: self.end_radius_mm() / radius_mm - 1.0,
            rise_mm: scale(part, self.rise_mm),
            left_over_mm: scale(part, self.left_over_mm),
            ..*self
        }
    }

    /// Returns the remainder without a part of the end.
    pub(super) fn without_end(&self, angle: f64) -> Self {
        let part = (self.angle - angle) / self.angle;
        let [rise_mm, left_over_mm] = [self.rise_mm, self.left_over_mm].map(|way| scale(part, way));
        Self {
            angle: self.angle - angle,
            growth: part * self.growth,
            rise_mm,
            left_over_mm,
            ..*self
        }
    }
}

/// Product and quotient of complex numbers.
fn times(a: [f64; 2], b: [f64; 2]) -> [f64; 2] {
    [a[0] * b[0] - a[1] * b[1], a[0] * b[1] + a[1] * b[0]]
}

fn over(a: [f64; 2], b: [f64; 2]) -> Option<[f64; 2]> {
    let square = b[0] * b[0] + b[1] * b[1];
    (square > 0.0).then(|| times(a, [b[0] / square, -b[1] / square]))
}

impl BlendShape {
    /// The arc about a centre between two points, behind so much of a line.
    pub(super) fn new(
        center_mm: Vector,
        [start_mm, end_mm]: [Vector; 2],
        tangent: Vector,
        line_mm: f64,
    ) -> Option<Self> {
        let ends_mm = [sub(start_mm, center_mm), sub(end_mm, center_mm)];
        let radii_mm = ends_mm.map(norm);
        let cos = dot(ends_mm[0], ends_mm[1]) / (radii_mm[0] * radii_mm[1]);
        let angle = libm::acos(cos.clamp(-1.0, 1.0));
        let is_arc = radii_mm.iter().all(|mm| *mm > NO_DISTANCE_MM) && angle > 1e-9;
        is_arc.then_some(Self {
            start_mm,
            tangent,
            line_mm,
            center_mm,
            ends_mm,
            radius_mm: radii_mm[0],
            angle,
        })
    }

    /// Length, with the line before it.
    pub(super) fn length_mm(&self) -> f64 {
        self.line_mm + self.radius_mm * self.angle
    }

    /// A point of it.
    pub(super) fn at(&self, along_mm: f64) -> Vector {
        let on_arc_mm = along_mm - self.line_mm;
        if on_arc_mm <= 0.0 {
            return add_scaled(self.start_mm, on_arc_mm, self.tangent);
        }
        let angle = on_arc_mm / self.radius_mm;
        let parts = [libm::sin(self.angle - angle), libm::sin(angle)]
            .map(|sin| sin / libm::sin(self.angle));
        std::array::from_fn(|k| {
            self.center_mm[k] + parts[0] * self.ends_mm[0][k] + parts[1] * self.ends_mm[1][k]
        })
    }
}

impl SegmentShape {
    /// Length.
    pub(super) fn length_mm(&self) -> f64 {
        match self {
            Self::Line(line) => line.length_mm,
            Self::Circle(circle) => circle.length_mm(),
            Self::Blend(blend) => blend.length_mm(),
        }
    }

    /// The point after `along_mm`.
    pub(super) fn at(&self, along_mm: f64) -> Vector {
        match self {
            Self::Line(line) => line.at(along_mm),
            Self::Circle(circle) => circle.at(circle.angle_after(along_mm / circle.length_mm())),
            Self::Blend(blend) => blend.at(along_mm),
        }
    }

    /// Unit tangents at both ends; a blend touches its neighbours.
    pub(super) fn tangents(&self) -> [Vector; 2] {
        match self {
            Self::Line(line) => [line.direction; 2],
            Self::Circle(circle) => [circle.tangent(0.0), circle.tangent(circle.angle)],
            Self::Blend(blend) => {
                let normal = cross(blend.ends_mm[0], blend.ends_mm[1]);
                blend.ends_mm.map(|end| {
                    let tangent = cross(normal, end);
                    scale(1.0 / norm(tangent).max(f64::MIN_POSITIVE), tangent)
                })
            }
        }
    }

    /// Returns true if the acceleration is shared with a normal one.
    pub(super) const fn is_round(&self) -> bool {
        !matches!(self, Self::Line(_))
    }
}
