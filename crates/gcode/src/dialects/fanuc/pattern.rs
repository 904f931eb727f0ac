//! G73: the profile itself, several times, ever closer.
//!
//! Pass n of N is moved by the allowance U W and by (N - n)/(N - 1) of the U W of the first block.
//! Each begins at the start of the cycle, moved alike.

use crate::canon::{MotionKind, Shape};
use crate::geometry::plane::PlaneArc;
use crate::motion::feed::Speed;
use crate::state::Interpreter;
use crate::state::capture::Capture;
use crate::state::frame::Position;
use crate::text::diagnostic::Read;

/// Motions of all passes: they are held in memory until they are read.
const MAX_MOTIONS: usize = 100_000;

impl Interpreter {
    pub(super) fn cut_pattern(
        &mut self,
        capture: &Capture,
        shift_mm: [f64; 2],
        passes: u32,
        allowance_mm: [f64; 2],
    ) -> Read<()> {
        let wanted = &capture.wanted;
        if capture.motions.len() * passes as usize > MAX_MOTIONS {
            let message = format!(
                "{passes} passes along {} motions; the product may be {MAX_MOTIONS}",
                capture.motions.len()
            );
            return Err(capture.refuse(wanted.line, &message));
        }
        for pass in 1..=passes {
            let share = if passes == 1 {
                0.0
            } else {
                f64::from(passes - pass) / f64::from(passes - 1)
            };
            let moved = |point: [f64; 3]| {
                let mut position: Position = wanted.start;
                position[0] = point[0] + share * shift_mm[0] + allowance_mm[0];
                position[2] = point[2] + share * shift_mm[1] + allowance_mm[1];
                position
            };
            let start = moved([wanted.start[0], wanted.start[1], wanted.start[2]]);
            self.line_to(&wanted.block, start, Speed::Rapid, 0.0)?;
            for motion in &capture.motions {
                let end = moved(motion.end_mm);
                match &motion.shape {
                    Shape::Arc {
                        center_mm, turns, ..
                    } => {
                        let [middle, target] =
                            [moved(*center_mm), end].map(|point| self.frame.to_program(&point));
                        let round = PlaneArc {
                            center: [middle[2], middle[0]],
                            turns: *turns,
                        };
                        self.arc_to(&wanted.block, &target, round, 0.0)?;
                    }
                    _ if motion.kind == MotionKind::Rapid => {
                        self.line_to(&wanted.block, end, Speed::Rapid, 0.0)?;
                    }
                    _ => self.line_to(&wanted.block, end, Speed::Programmed, 0.0)?,
                }
            }
        }
        self.line_to(&wanted.block, wanted.start, Speed::Rapid, 0.0)
    }
}
