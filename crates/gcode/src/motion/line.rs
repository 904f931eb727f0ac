//! Straight to a point, whatever code asks for it.

use crate::canon::Shape;
use crate::motion::feed::{Speed, distance, others, turns_only};
use crate::state::Interpreter;
use crate::state::frame::Position;
use crate::text::block::Block;
use crate::text::diagnostic::Read;

impl Interpreter {
    /// Moves straight to `machine`; the programmed position is the caller's business.
    #[inline]
    pub(crate) fn line_to(
        &mut self,
        block: &Block,
        machine: Position,
        speed: Speed,
        extruder_mm: f64,
    ) -> Read<()> {
        let start = std::mem::replace(&mut self.here, machine);
        let others = others(&start, &machine, extruder_mm);
        if others.is_none() && start[..3] == machine[..3] {
            return Ok(());
        }
        if speed == Speed::Programmed && self.follows_surface() && extruder_mm == 0.0 {
            return self.line_at_surface_speed(block, &start);
        }
        let feed_mm_s = match speed {
            Speed::Rapid => 0.0,
            Speed::Programmed => {
                let feed = self.feed_for(block, distance(&start, &machine))?;
                if turns_only(&start, &machine) {
                    feed / self.modal.feed_unit_mm
                } else {
                    feed
                }
            }
        };
        self.push_motion(speed, &start, Shape::Line, feed_mm_s, others);
        Ok(())
    }

    /// Straight along one axis.
    pub(crate) fn along(&mut self, block: &Block, axis: usize, to: f64, speed: Speed) -> Read<()> {
        let mut target = self.at;
        target[axis] = to;
        self.go(block, target, speed)
    }

    /// Straight to a point in program coordinates.
    pub(crate) fn go(&mut self, block: &Block, target: Position, speed: Speed) -> Read<()> {
        self.at = target;
        self.line_to(block, self.frame.to_machine(&target), speed, 0.0)
    }
}
