//! Motions other than G0-G3, cutter compensation, spindle modes.

use super::arc::Round;
use super::block::Block;
use super::codes::{Group, spelled};
use super::diagnostic::{Fault, Read};
use super::expression::Target;
use super::state::{Interpreter, Position};

impl Interpreter {
    pub(super) fn special_motion(&mut self, block: &Block, code: u16) -> Read<()> {
        let at = block
            .code(Group::Motion)
            .map_or(block.whole(), |word| word.at());
        Err(Fault::new(
            "gcode::unsupported",
            at,
            format!("{} is not read yet", spelled(code)),
        ))
    }

    pub(super) fn compensation_mode(&mut self, block: &Block) -> Read<()> {
        match block.code(Group::CutterCompensation) {
            Some(word) if word.number != 400 => Err(Fault::new(
                "gcode::unsupported",
                word.at(),
                format!("{} is not read yet", spelled(word.number)),
            )),
            _ => Ok(()),
        }
    }

    pub(super) fn compensated_straight(
        &mut self,
        _block: &Block,
        _target: &Position,
        _is_feed: bool,
    ) -> Read<bool> {
        Ok(false)
    }

    pub(super) fn compensated_arc(
        &mut self,
        _block: &Block,
        _target: &Position,
        _round: Round,
    ) -> Read<bool> {
        Ok(false)
    }

    pub(super) fn spindle_mode(&mut self, block: &Block) -> Read<()> {
        if let Some(word) = block.code(Group::SpindleMode) {
            self.modal.constant_surface =
                (word.number == 960).then(|| block.get(b'd').unwrap_or(0.0));
        }
        Ok(())
    }

    pub(super) fn assign(&mut self, target: &Target, value: f64) -> Read<()> {
        match target {
            Target::Numbered(index) => self.parameters.set(*index, value),
            Target::Named(name) => {
                if !self.parameters.set_named(name, value) {
                    return Err(Fault::new(
                        "gcode::parameter",
                        0..1,
                        "the program has too many named parameters",
                    ));
                }
            }
        }
        Ok(())
    }
}
