//! Codes that act once: G10, G28, G30, G52, G92, and those of Fanuc and Haas.

use crate::state::Interpreter;
use crate::state::parameters as numbers;
use crate::text::block::{Block, Word};
use crate::text::codes::Group;
use crate::text::codes::fanuc::OWN;
use crate::text::diagnostic::{LineFault, Read};

impl Interpreter {
    /// Codes that act once.
    pub(super) fn non_modal(&mut self, block: &Block) -> Read<()> {
        let Some(word) = block.code(Group::NonModal) else {
            return Ok(());
        };
        if !self.dialect.is_fanuc()
            && matches!(word.number, 280 | 300 | 520 | 920 | 100)
            && block
                .code(Group::Motion)
                .is_some_and(|motion| motion.number != 800)
            && block.has_axes()
        {
            return Ok(()); // The motion refuses the line.
        }
        match word.number {
            100 => self.set_data(block, word),
            280 => self.go_home(block, numbers::HOME_1),
            300 => self.go_home(block, numbers::HOME_2),
            281 => {
                self.parameters.set_nine(numbers::HOME_1, self.here);
                Ok(())
            }
            301 => {
                self.parameters.set_nine(numbers::HOME_2, self.here);
                Ok(())
            }
            520 | 920 => self.shift(block, word),
            OWN.. => self.own_non_modal(block, word),
            921..=923 => {
                self.shift_mode(word.number);
                Ok(())
            }
            _ => Ok(()),
        }
    }

    /// G10: coordinate systems (L2, L20) and the tool table (L1, L10, L11).
    fn set_data(&mut self, block: &Block, word: Word) -> Read<()> {
        if !block.has(b'l') || !block.has(b'p') {
            return Err(LineFault::new(
                "gcode::g10",
                word.at(),
                "G10 needs L (what to set) and P (of which system or tool)",
            ));
        }
        match self.integer(block, b'l', 0, 99)? {
            20 if self.dialect.is_fanuc() => self.set_further_system(block),
            2 if self.dialect.is_fanuc() && block.get(b'p') == Some(0.0) => Err(LineFault::new(
                "gcode::unsupported",
                block.at(b'p'),
                "G10 L2 P0 (the offset of all systems) is not read",
            )
            .hint("write the offsets of G54 to G59 with P1 to P6")),
            2 => self.set_system(block, false),
            20 => self.set_system(block, true),
            kind @ 10..=13 if self.dialect.is_fanuc() => self.set_tool_part(block, kind),
            kind @ (1 | 10 | 11) => self.set_tool(block, kind),
            other => Err(LineFault::new(
                "gcode::g10",
                block.at(b'l'),
                format!("G10 L{other} does not exist: L1, L2, L10, L11, L20 do"),
            )),
        }
    }
}
