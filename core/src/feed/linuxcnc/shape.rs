//! What segments look like: lines, circles, blends.

use super::limits::NO_DISTANCE_MM;
use crate::path::{Curve, Piece};
use crate::vector::{Vector, add_scaled, cross, dot, norm, scale, sub};

/// Rise by a millimetre of way that is none.
const NO_RISE: f64 = 1e-9;

/// A straight line.
#[derive(Debug, Clone, Copy)]
pub(super) struct LineShape {
    /// Where it begins.
    pub start_mm: Vector,
    /// Its direction.
    pub direction: Vector,
    /// Its length.
    pub length_mm: f64,
}

/// A circle or helix: `center + cos(phi) first + sin(phi) second + rise phi / angle`.
#[derive(Debug, Clone, Copy)]
pub(super) struct CircleShape {
    /// Centre, beside the start.
    pub center_mm: Vector,
    /// From the centre to the start.
    pub first_mm: Vector,
    /// As long, in the direction of travel.
    pub second_mm: Vector,
    /// Unit vector of the axis that it turns about, to the left.
    pub normal: Vector,
    /// Radius.
    pub radius_mm: f64,
    /// Angle turned.
    pub angle: f64,
    /// Way along the axis.
    pub rise_mm: Vector,
}

/// A circular arc between two segments, with what is left of a line that it replaces before it.
#[derive(Debug, Clone, Copy)]
pub(super) struct BlendShape {
    /// Where the arc begins.
    pub start_mm: Vector,
    /// Tangent there.
    pub tangent: Vector,
    /// Length of the line before it.
    pub line_mm: f64,
    /// Centre.
    pub center_mm: Vector,
    /// From the centre to both ends.
    pub ends_mm: [Vector; 2],
    /// Radius at the start.
    pub radius_mm: f64,
    /// Angle turned.
    pub angle: f64,
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
        (length_mm > NO_DISTANCE_MM).then(|| Self { start_mm, direction: scale(1.0 / length_mm, way), length_mm })
    }

    /// A point of it.
    pub(super) fn at(&self, along_mm: f64) -> Vector {
        add_scaled(self.start_mm, along_mm, self.direction)
    }
}

impl CircleShape {
    /// The circle of a piece.
    pub(super) fn of(piece: &Piece) -> Option<Self> {
        let Curve::Arc(arc) = &piece.curve else { return None };
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
            rise_mm: scale(piece.length_mm, rise),
        };
        (shape.angle.is_finite() && shape.angle > 0.0).then_some(shape)
    }

    /// A point of it.
    pub(super) fn at(&self, angle: f64) -> Vector {
        let (sin, cos) = angle.sin_cos();
        std::array::from_fn(|k| {
            self.center_mm[k] + cos * self.first_mm[k] + sin * self.second_mm[k] + angle / self.angle * self.rise_mm[k]
        })
    }

    /// From the axis to a point of it.
    pub(super) fn radial_mm(&self, angle: f64) -> Vector {
        let (sin, cos) = angle.sin_cos();
        add_scaled(scale(cos, self.first_mm), sin, self.second_mm)
    }

    /// Unit tangent.
    pub(super) fn tangent(&self, angle: f64) -> Vector {
        let tangent = add_scaled(cross(self.normal, self.radial_mm(angle)), 1.0 / self.angle, self.rise_mm);
        scale(1.0 / norm(tangent), tangent)
    }

    /// Length.
    pub(super) fn length_mm(&self) -> f64 {
        self.flat_mm().hypot(norm(self.rise_mm))
    }

    /// Length without the rise.
    pub(super) fn flat_mm(&self) -> f64 {
        self.radius_mm * self.angle
    }

    /// Radius of curvature.
    pub(super) fn curvature_radius_mm(&self) -> f64 {
        self.radius_mm + dot(self.rise_mm, self.rise_mm) / self.radius_mm
    }

    /// What is left without a part of its beginning.
    pub(super) fn without_start(&self, angle: f64) -> Self {
        let part = (self.angle - angle) / self.angle;
        let (sin, cos) = angle.sin_cos();
        Self {
            center_mm: add_scaled(self.center_mm, angle / self.angle, self.rise_mm),
            first_mm: self.radial_mm(angle),
            second_mm: add_scaled(scale(cos, self.second_mm), -sin, self.first_mm),
            angle: self.angle - angle,
            rise_mm: scale(part, self.rise_mm),
            ..*self
        }
    }

    /// What is left without a part of its end.
    pub(super) fn without_end(&self, angle: f64) -> Self {
        let part = (self.angle - angle) / self.angle;
        Self { angle: self.angle - angle, rise_mm: scale(part, self.rise_mm), ..*self }
    }
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
        let angle = cos.clamp(-1.0, 1.0).acos();
        let is_arc = radii_mm.iter().all(|mm| *mm > NO_DISTANCE_MM) && angle > 1e-9;
        is_arc.then_some(Self { start_mm, tangent, line_mm, center_mm, ends_mm, radius_mm: radii_mm[0], angle })
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
        let parts = [(self.angle - angle).sin(), angle.sin()].map(|sin| sin / self.angle.sin());
        std::array::from_fn(|k| self.center_mm[k] + parts[0] * self.ends_mm[0][k] + parts[1] * self.ends_mm[1][k])
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
            Self::Circle(circle) => circle.at(along_mm / circle.length_mm() * circle.angle),
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

    /// Whether the acceleration is shared with a normal one.
    pub(super) const fn is_round(&self) -> bool {
        !matches!(self, Self::Line(_))
    }
}
