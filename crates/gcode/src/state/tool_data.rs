//! The tool in the spindle and its offsets: G43, G49, M6, and the tool table by G10.

use crate::state::Interpreter;
use crate::state::frame::Position;
use crate::state::offsets::system_first;
use crate::state::parameters as numbers;
use crate::text::block::{Block, Word};
use crate::text::codes::{AXIS_LETTERS, Group, bit};
use crate::text::diagnostic::{LineFault, Read};

impl Interpreter {
    /// G43, G43.1, G43.2, G49.
    pub(crate) fn tool_length(&mut self, block: &Block) -> Read<()> {
        let Some(word) = block.code(Group::ToolLength) else {
            return Ok(());
        };
        match word.number {
            490 => self.frame.tool = [0.0; 9],
            431 => {
                for (axis, letter) in AXIS_LETTERS.into_iter().enumerate() {
                    if let Some(value) = block.get(letter) {
                        self.frame.tool[axis] = self.length(block, letter, axis, value)?;
                    }
                }
            }
            number => {
                let offset = self.tool_offset(block, word)?;
                let base = if number == 432 {
                    self.frame.tool
                } else {
                    [0.0; 9]
                };
                self.frame.tool = std::array::from_fn(|axis| base[axis] + offset[axis]);
            }
        }
        self.offsets_changed();
        Ok(())
    }

    fn tool_offset(&mut self, block: &Block, word: Word) -> Read<Position> {
        let number = if block.has(b'h') {
            self.integer(block, b'h', 0, 999_999)? as u32
        } else {
            self.tool.number
        };
        if word.number == 432 && !block.has(b'h') {
            let mut offset = [0.0; 9];
            for (axis, letter) in AXIS_LETTERS.into_iter().enumerate() {
                if let Some(value) = block.get(letter) {
                    offset[axis] = self.length(block, letter, axis, value)?;
                }
            }
            return Ok(offset);
        }
        if let Some(tool) = self.settings.tools.get(number) {
            return Ok(tool.offset);
        }
        if number != 0 && !self.settings.tools.tools.is_empty() {
            let at = if block.has(b'h') {
                block.at(b'h')
            } else {
                word.at()
            };
            return Err(LineFault::new(
                "gcode::tool",
                at,
                format!("tool {number} is not in the tool table"),
            ));
        }
        if number != 0 {
            let at = if block.has(b'h') {
                block.at(b'h')
            } else {
                word.at()
            };
            let message =
                format!("tool {number} is not in the tool table: its length counts as 0 mm");
            let fault = LineFault::new("gcode::tool", at, message);
            self.output.warnings.push(*fault.hint(
                "give a tool table with --tool-table, or nothing if the program's Z is the tip",
            ));
        }
        Ok([0.0; 9])
    }

    /// The changer has put a tool into the spindle.
    pub(crate) fn load_tool(&mut self, number: u32) {
        self.tool.number = number;
        let tool = self.settings.tools.get(number).copied().unwrap_or_default();
        self.parameters.set(numbers::TOOL_FIRST, f64::from(number));
        self.parameters
            .set_nine(numbers::TOOL_FIRST + 1, tool.offset);
        let rest = [
            tool.diameter_mm,
            tool.front_angle_deg,
            tool.back_angle_deg,
            f64::from(tool.orientation),
        ];
        for (n, value) in rest.into_iter().enumerate() {
            self.parameters.set(numbers::TOOL_FIRST + 10 + n, value);
        }
    }

    /// Fanuc and Haas: L10 is the length of tool P, L12 its radius, L11 and L13 the wear of both,
    /// which is added; in G91 R is added to what is there.
    pub(crate) fn set_tool_part(&mut self, block: &Block, kind: i64) -> Read<()> {
        let number = self.integer(block, b'p', 1, 999_999)? as u32;
        let Some(value) = block.get(b'r') else {
            return Err(LineFault::new(
                "gcode::g10",
                block.whole(),
                format!("G10 L{kind} has no R, the value to set"),
            ));
        };
        let value = value * self.modal.unit_mm;
        let mut tool = self.settings.tools.get(number).copied().unwrap_or_default();
        let adds = self.modal.incremental;
        let set = |old: f64| if adds { old + value } else { value };
        match kind {
            10 => tool.offset[2] = set(tool.offset[2] - tool.wear_mm[0]) + tool.wear_mm[0],
            12 => {
                tool.diameter_mm =
                    2.0 * (set(0.5 * tool.diameter_mm - tool.wear_mm[1]) + tool.wear_mm[1]);
            }
            11 => {
                let wear = set(tool.wear_mm[0]);
                tool.offset[2] += wear - tool.wear_mm[0];
                tool.wear_mm[0] = wear;
            }
            _ => {
                let wear = set(tool.wear_mm[1]);
                tool.diameter_mm += 2.0 * (wear - tool.wear_mm[1]);
                tool.wear_mm[1] = wear;
            }
        }
        self.settings.tools.tools.insert(number, tool);
        if number == self.tool.number {
            self.load_tool(number);
        }
        Ok(())
    }

    /// G10 L1 sets a tool's offsets, L10 and L11 set them so that the current position gets the
    /// given coordinates.
    pub(crate) fn set_tool(&mut self, block: &Block, kind: i64) -> Read<()> {
        let number = self.integer(block, b'p', 1, 999_999)? as u32;
        let mut tool = self.settings.tools.get(number).copied().unwrap_or_default();
        let mut frame = self.frame.clone();
        frame.tool = [0.0; 9];
        if kind == 11 {
            // As seen from G59.3, without G92.
            let first = system_first(9);
            frame.system_offset = self.parameters.nine(first);
            frame.rotation_deg = self.parameters.get(first + 9);
            frame.g92 = [0.0; 9];
        }
        let bare = frame.to_program(&self.here);
        let mut named = bare;
        for (axis, letter) in AXIS_LETTERS.into_iter().enumerate() {
            if let Some(value) = block.get(letter) {
                named[axis] = self.length(block, letter, axis, value)?;
            }
        }
        let shifted = frame.to_machine(&named);
        for (axis, letter) in AXIS_LETTERS.into_iter().enumerate() {
            if block.has(letter) {
                tool.offset[axis] = if kind == 1 {
                    named[axis]
                } else {
                    self.here[axis] - shifted[axis]
                };
            }
        }
        if let Some(radius) = block.get(b'r') {
            tool.diameter_mm = 2.0 * radius * self.modal.unit_mm;
        }
        tool.front_angle_deg = block.get(b'i').unwrap_or(tool.front_angle_deg);
        tool.back_angle_deg = block.get(b'j').unwrap_or(tool.back_angle_deg);
        if block.set & bit(b'q') != 0 {
            tool.orientation = self.integer(block, b'q', 0, 9)? as u8;
        }
        self.settings.tools.tools.insert(number, tool);
        if number == self.tool.number {
            self.load_tool(number);
        }
        Ok(())
    }
}
