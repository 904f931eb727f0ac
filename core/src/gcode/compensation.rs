//! Cutter compensation.

use super::arc::Round;
use super::block::Block;
use super::codes::{Group, spelled};
use super::diagnostic::{Fault, Read};
use super::state::{Interpreter, Position};

impl Interpreter {
    /// Whether cutter compensation is on.
    pub(super) fn compensates(&self) -> bool {
        false
    }

    pub(super) fn compensation_mode(&mut self, block: &Block) -> Read<()> {
        match block.code(Group::CutterCompensation) {
            Some(word) if word.number != 400 => {
                Err(Fault::new("gcode::unsupported", word.at(), format!("{} is not read yet", spelled(word.number))))
            }
            _ => Ok(()),
        }
    }

    pub(super) fn compensated_straight(&mut self, _block: &Block, _target: &Position, _is_feed: bool) -> Read<bool> {
        Ok(false)
    }

    pub(super) fn compensated_arc(&mut self, _block: &Block, _target: &Position, _round: Round) -> Read<bool> {
        Ok(false)
    }
}
