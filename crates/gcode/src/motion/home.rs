//! G28 and G30.

use crate::motion::feed::Speed;
use crate::settings::Dialect;
use crate::state::Interpreter;
use crate::text::block::Block;
use crate::text::codes::AXIS_LETTERS;
use crate::text::diagnostic::Read;

impl Interpreter {
    /// G28, G30: over the point on the line to the stored position, in machine coordinates.
    pub(crate) fn go_home(&mut self, block: &Block, home: usize) -> Read<()> {
        if self.dialect == Dialect::Printer {
            return self.home_printer(block);
        }
        let target = self.target(block)?;
        if block.has_axes() {
            self.line_to(block, self.frame.to_machine(&target), Speed::Rapid, 0.0)?;
        }
        // The axes are those of the program: in a rotated system, Y alone moves X and Y of the
        // machine.
        let stored = self.frame.to_program(&self.parameters.nine(home));
        let mut goal = target;
        for (axis, letter) in AXIS_LETTERS.into_iter().enumerate() {
            if block.has(letter) || !block.has_axes() {
                goal[axis] = stored[axis];
            }
        }
        self.line_to(block, self.frame.to_machine(&goal), Speed::Rapid, 0.0)?;
        self.at = goal;
        Ok(())
    }

    /// Printers: G28 finds the end stops of the named axes, or of all; they are at 0.
    fn home_printer(&mut self, block: &Block) -> Read<()> {
        let mut machine = self.here;
        for (axis, letter) in AXIS_LETTERS.into_iter().enumerate().take(3) {
            if block.has(letter) || !block.has_axes() {
                machine[axis] = 0.0;
                self.frame.g92[axis] = 0.0;
            }
        }
        self.line_to(block, machine, Speed::Rapid, 0.0)?;
        self.offsets_changed();
        Ok(())
    }
}
