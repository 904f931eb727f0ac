//! Motions other than G0-G3, by their files; spindle modes.

use super::block::Block;
use super::codes::{Group, spelled};
use super::diagnostic::{Fault, Read};
use super::fanuc;
use super::settings::Dialect;
use super::state::Interpreter;

impl Interpreter {
    /// Carries out a motion code other than G0-G3 and G80.
    pub(super) fn special_motion(&mut self, block: &Block, code: u16) -> Read<()> {
        if self.compensates() && !matches!(code, 50..=53) {
            let message = format!("{} cannot run with cutter compensation", spelled(code));
            return Err(Fault::new("gcode::compensation", block.whole(), message).hint("end it with G40 first"));
        }
        match code {
            50 | 51 => self.bezier(block, code),
            52 => self.nurbs_point(block),
            53 => self.nurbs_end(block),
            62 => self.nurbs_with_knots(block),
            fanuc::OWN.. => self.own_motion(block, code),
            330 | 331 => self.synchronized(block, code),
            382..=385 => self.probe(block),
            730 | 740 | 810..=890 => self.cycle(block, code),
            760 => self.thread(block),
            _ => self.lathe_cycle(block, code),
        }
    }

    /// G96 with its highest speed, G97.
    pub(super) fn spindle_mode(&mut self, block: &Block) -> Read<()> {
        if let Some(word) = block.code(Group::SpindleMode) {
            if block.get(b'd').is_some_and(|most| most < 0.0) {
                return Err(Fault::new(
                    "gcode::spindle",
                    block.at(b'd'),
                    "the highest spindle speed D must not be negative",
                ));
            }
            if word.number == 960 && !block.has(b's') && self.dialect == Dialect::LinuxCnc {
                return Err(Fault::new(
                    "gcode::spindle",
                    word.at(),
                    "G96 (constant surface speed) needs the speed S on its line",
                )
                .hint("write G96 S100 with metres per minute, in G20 feet per minute"));
            }
            if self.dialect.is_fanuc() {
                self.own_spindle_mode(block, word)?;
            }
            let highest = block.get(b'd').unwrap_or(self.highest_rpm());
            self.modal.constant_surface = (word.number == 960).then_some(highest);
        }
        Ok(())
    }
}
