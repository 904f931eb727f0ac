//! G0 and G1.

use crate::motion::feed::Speed;
use crate::settings::Dialect;
use crate::state::Interpreter;
use crate::state::frame::Position;
use crate::text::block::Block;
use crate::text::codes::Group;
use crate::text::diagnostic::Read;

impl Interpreter {
    /// G0 and G1.
    pub(crate) fn straight(&mut self, block: &Block, code: u16) -> Read<()> {
        let extruder_mm = self.extruder_word(block);
        if !block.has_axes() && extruder_mm == 0.0 {
            return Ok(());
        }
        let is_g53 = block
            .code(Group::NonModal)
            .is_some_and(|word| word.number == 530);
        let target = if is_g53 {
            self.machine_target(block)?
        } else {
            self.target(block)?
        };
        // Printers move at F with G0 too; G53 of Fanuc is always a rapid.
        let is_feed = (code == 10 && !(is_g53 && self.dialect.is_fanuc()))
            || (self.dialect == Dialect::Printer && self.modal.feed > 0.0);
        self.straight_as(block, &target, is_feed, extruder_mm)
    }

    /// Straight to a point in program coordinates, beside it under cutter compensation.
    pub(crate) fn straight_as(
        &mut self,
        block: &Block,
        target: &Position,
        is_feed: bool,
        extruder_mm: f64,
    ) -> Read<()> {
        if self.compensated_straight(block, target, is_feed)? {
            return Ok(());
        }
        let machine = self.frame.to_machine(target);
        let speed = if is_feed {
            Speed::Programmed
        } else {
            Speed::Rapid
        };
        let fed = self.line_to(block, machine, speed, extruder_mm);
        self.at = *target;
        if self.behind_fault {
            // Known again once a line names where it goes.
            self.behind_fault = self.modal.incremental
                || !(block.has(b'x')
                    && block.has(if self.dialect.is_lathe() { b'z' } else { b'y' }));
        }
        fed
    }
}
