//! Corners of a profile: an arc that touches both sides (A), or the chord between the points where
//! it would (C).

use crate::geometry::plane::{
    PlaneCurve, PlanePoint, SLACK_MM, add, cross, dot, length, minus, scaled, shifted, unit,
};
use crate::state::lathe::{CornerCut, LatheCycle};
use crate::text::diagnostic::{LineFault, Read};

/// Corners flatter than this need no arc and no new end, rad: their offset ends are less than a
/// nanometre apart at 10 mm.
pub(super) const SMOOTH_RAD: f64 = 1e-10;

impl LatheCycle {
    /// The profile's curves, one for each motion, with its corners cut.
    pub(super) fn cut_corners(&self, curves: Vec<PlaneCurve>) -> Read<Vec<PlaneCurve>> {
        if self.corners.is_empty() {
            return Ok(curves);
        }
        let mut corners = self.corners.iter().peekable();
        let mut cut: Vec<PlaneCurve> = Vec::with_capacity(curves.len() + self.corners.len());
        for (number, mut curve) in curves.into_iter().enumerate() {
            let corner = corners.next_if(|corner| corner.0 + 1 == number);
            if let (Some((_, corner)), Some(before)) = (corner, cut.last_mut()) {
                let line = self.motions[number - 1].line;
                let piece = corner
                    .cut(before, &mut curve)
                    .ok_or_else(|| self.too_large(line, corner))?;
                cut.extend(piece);
            }
            cut.push(curve);
        }
        Ok(cut)
    }

    fn too_large(&self, line: u32, corner: &CornerCut) -> Box<LineFault> {
        let letter = if corner.is_round { 'A' } else { 'C' };
        let message = format!(
            "the corner {letter} of {:.4} mm is larger than the motions beside it",
            corner.radius_mm
        );
        self.refuse(line, &message)
            .hint("a corner needs two sides that are longer than what it takes of them")
    }
}

impl CornerCut {
    /// Shortens both sides of the corner and returns what comes between them: nothing where the
    /// profile goes straight on.
    pub(crate) fn cut(
        &self,
        before: &mut PlaneCurve,
        behind: &mut PlaneCurve,
    ) -> Option<Option<PlaneCurve>> {
        let corner = behind.start();
        let (from, to) = (before.direction(corner), behind.direction(corner));
        let bend = libm::atan2(cross(from, to), dot(from, to));
        if bend.abs() <= SMOOTH_RAD {
            return Some(None);
        }
        let turn = bend.signum();
        let inside = |curve: &PlaneCurve| shifted(curve, turn * self.radius_mm);
        let center = inside(before)?.meet(&inside(behind)?, corner)?;
        let (start, end) = (foot(before, center), foot(behind, center));
        if !before.ends_at(start) || !behind.begins_at(end) {
            return None;
        }
        before.set_end(start);
        behind.set_start(end);
        if [&*before, &*behind]
            .iter()
            .any(|curve| curve.chord() <= SLACK_MM)
        {
            return None;
        }
        Some(Some(if self.is_round {
            PlaneCurve::Arc {
                start,
                end,
                center,
                turn,
            }
        } else {
            PlaneCurve::Line { start, end }
        }))
    }
}

/// The point of the curve nearest to `point`.
pub(super) fn foot(curve: &PlaneCurve, point: PlanePoint) -> PlanePoint {
    match *curve {
        PlaneCurve::Line { start, end } => {
            let along = unit(minus(end, start));
            add(start, scaled(along, dot(minus(point, start), along)))
        }
        PlaneCurve::Arc { start, center, .. } => add(
            center,
            scaled(unit(minus(point, center)), length(minus(start, center))),
        ),
    }
}
