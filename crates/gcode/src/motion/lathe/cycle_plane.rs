//! The plane of a lathe cycle: which axes, and which way; and motions along its lines and arcs.
//!
//! Coordinates, mm: the first grows along the passes, the second grows from the finished part to
//! the stock's surface.

use crate::canon::{Motion, Shape};
use crate::geometry::plane::{PlaneArc, PlaneCurve, PlanePoint, SLACK_MM, length, minus};
use crate::motion::feed::Speed;
use crate::state::Interpreter;
use crate::state::frame::Position;
use crate::text::block::Block;
use crate::text::diagnostic::Read;

/// An arc that ends closer to its start, mm, would be read as a full turn (8e-9) or nearly.
const SHORT_ARC_MM: f64 = 1e-7;

/// The cycle's plane: which axes, and which way.
#[derive(Debug, Clone, Copy)]
pub(crate) struct CyclePlane {
    /// Axis along the passes, and of their depth.
    pub(crate) axes: [usize; 2],
    pub(crate) signs: [f64; 2],
}

impl CyclePlane {
    pub(crate) fn of(self, point: [f64; 3]) -> PlanePoint {
        std::array::from_fn(|n| self.signs[n] * point[self.axes[n]])
    }

    /// The machine position of a point; the other axes stay.
    fn position(self, point: PlanePoint, like: &Position) -> Position {
        let mut position = *like;
        for n in 0..2 {
            position[self.axes[n]] = self.signs[n] * point[n];
        }
        position
    }

    /// Converts the turn of an arc from the cycle's plane to G18 (Z, then X), where 1 is
    /// counter-clockwise.
    fn turns(self, turn: f64) -> f64 {
        let exchanged = if self.axes == [2, 0] { 1.0 } else { -1.0 };
        turn * exchanged * self.signs[0] * self.signs[1]
    }

    /// A motion of a profile: a line, or an arc of up to one turn.
    pub(crate) fn curve(self, motion: &Motion) -> PlaneCurve {
        let (start, end) = (self.of(motion.start_mm), self.of(motion.end_mm));
        match &motion.shape {
            Shape::Arc {
                center_mm, turns, ..
            } => PlaneCurve::Arc {
                start,
                end,
                center: self.of(*center_mm),
                turn: self.turns(f64::from(*turns)),
            },
            _ => PlaneCurve::Line { start, end },
        }
    }
}

/// Returns the sign of a distance, or `None` if it is 0 up to `SLACK_MM`.
pub(crate) fn clear(way: f64) -> Option<f64> {
    (way.abs() > SLACK_MM).then(|| way.signum())
}

impl Interpreter {
    /// Moves straight to a point of the cycle's plane; `start_like` has the axes that stay.
    pub(crate) fn pass_line(
        &mut self,
        block: &Block,
        start_like: &Position,
        plane: CyclePlane,
        point: PlanePoint,
        speed: Speed,
    ) -> Read<()> {
        self.line_to(block, plane.position(point, start_like), speed, 0.0)
    }

    /// Cuts along a curve.
    pub(crate) fn pass_curve(
        &mut self,
        block: &Block,
        start_like: &Position,
        plane: CyclePlane,
        curve: &PlaneCurve,
    ) -> Read<()> {
        match *curve {
            // A piece of an arc that is too short to distinguish from a full circle deviates from a
            // straight line by no more than its length.
            PlaneCurve::Arc {
                start,
                end,
                center,
                turn,
            } if length(minus(end, start)) > SHORT_ARC_MM => {
                let [middle, target] = [center, end]
                    .map(|point| self.frame.to_program(&plane.position(point, start_like)));
                let turns = if plane.turns(turn) > 0.0 { 1 } else { -1 };
                let round = PlaneArc {
                    center: [middle[2], middle[0]],
                    turns,
                };
                self.arc_to(block, &target, round, 0.0)
            }
            PlaneCurve::Line { end, .. } | PlaneCurve::Arc { end, .. } => {
                self.pass_line(block, start_like, plane, end, Speed::Programmed)
            }
        }
    }
}
