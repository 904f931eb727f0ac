//! Coordinates of Fanuc and Haas: G68 turns them, G16 makes X a radius and Y an angle.

use crate::canon::Plane;
use crate::state::Interpreter;
use crate::state::frame::Turn;
use crate::text::block::{Block, Word};
use crate::text::codes::fanuc::OWN;
use crate::text::codes::{Group, bit};
use crate::text::diagnostic::{LineFault, Read};

impl Interpreter {
    /// G15, G16, G68, G69.
    pub(crate) fn own_modes(&mut self, block: &Block) -> Read<()> {
        if let Some(word) = block.code(Group::Polar) {
            self.fanuc.is_polar = word.number % OWN == 160;
        }
        if let Some(word) = block.code(Group::Rotation) {
            self.frame.turn = None;
            self.offsets_changed();
            if word.number % OWN == 680 {
                self.turn(block, word)?;
            }
        }
        if (self.fanuc.is_polar || self.frame.turn.is_some()) && self.modal.plane != Plane::Xy {
            let what = if self.fanuc.is_polar { "G16" } else { "G68" };
            return Err(LineFault::new(
                "gcode::unsupported",
                block.whole(),
                format!("{what} outside G17 is not read"),
            )
            .hint("write G17 before it, and G15 or G69 before another plane"));
        }
        Ok(())
    }

    /// `G68 X0 Y0 R30.`: turns what follows about a point.
    fn turn(&mut self, block: &Block, word: Word) -> Read<()> {
        let other = block.set & (bit(b'z') | bit(b'a') | bit(b'b') | bit(b'c'));
        if other != 0 {
            return Err(LineFault::new(
                "gcode::unsupported",
                block.at_any(other),
                "G68 in space is not read",
            )
            .hint("G68 X Y R turns in the XY plane"));
        }
        let Some(angle_deg) = block.get(b'r') else {
            return Err(LineFault::new(
                "gcode::rotation",
                word.at(),
                "R (angle in degrees) is missing for G68",
            )
            .hint("write G68 X0 Y0 R30."));
        };
        let mut center = [self.at[0], self.at[1]];
        for (axis, letter) in [(0, b'x'), (1, b'y')] {
            if let Some(value) = block.get(letter) {
                let value = self.length(block, letter, axis, value)?;
                center[axis] = if self.modal.incremental {
                    center[axis] + value
                } else {
                    value
                };
            }
        }
        self.frame.turn = Some(Turn { center, angle_deg });
        self.offsets_changed();
        Ok(())
    }
}
