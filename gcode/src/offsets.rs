//! Coordinate systems and offsets: G10, G28, G30, G43, G49, G52, G54-G59.3, G92, and the tool in the spindle.
//!
//! machine = rotate(program + G92 offset) + coordinate system + tool offset; see [`super::state::Frame`]. None of these codes moves the
//! machine (except G28 and G30); they change what its position is called.

use super::block::{Block, Word};
use super::codes::{AXIS_LETTERS, Group, bit, spelled};
use super::diagnostic::{Fault, Read};
use super::fanuc;
use super::parameters as numbers;
use super::settings::Dialect;
use super::state::{Interpreter, Position};
use super::travel::Speed;

/// Coordinate systems G54 to G59.3.
const SYSTEMS: i64 = 9;

impl Interpreter {
    /// G54 to G59.3; Fanuc's G54.1 P1 and up are further systems.
    pub(super) fn coordinate_system(&mut self, block: &Block) -> Read<()> {
        let Some(word) = block.code(Group::Coordinates) else {
            return Ok(());
        };
        let system = match word.number {
            fanuc::OWN.. => return self.further_system(block, word),
            541 => {
                let message = "G54.1 P (additional coordinate systems) needs offsets that only the control has";
                return Err(Fault::new("gcode::unsupported", word.at(), message)
                    .hint("use G54 to G59, or write the offsets with G10 L2"));
            }
            number @ 591..=593 => usize::from(number - 584),
            number => usize::from(number - 530) / 10,
        };
        self.parameters.set(numbers::SYSTEM, system as f64);
        // LinuxCNC does not look again at the parameters of the system that is active already.
        if self.dialect != Dialect::LinuxCnc || system != self.frame.system {
            self.frame.system = system;
            self.load_system();
        }
        Ok(())
    }

    /// Takes the offsets of the active system from the parameters.
    pub(super) fn load_system(&mut self) {
        if self.frame.system > SYSTEMS as usize {
            return self.load_further_system();
        }
        let first = system_first(self.frame.system);
        self.frame.system_offset = self.parameters.nine(first);
        self.frame.rotation_deg = self.parameters.get(first + 9);
        self.offsets_changed();
    }

    /// G43, G43.1, G43.2, G49.
    pub(super) fn tool_length(&mut self, block: &Block) -> Read<()> {
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
                let base = if number == 432 { self.frame.tool } else { [0.0; 9] };
                self.frame.tool = std::array::from_fn(|axis| base[axis] + offset[axis]);
            }
        }
        self.offsets_changed();
        Ok(())
    }

    fn tool_offset(&mut self, block: &Block, word: Word) -> Read<Position> {
        let number = if block.has(b'h') { self.integer(block, b'h', 0, 999_999)? as u32 } else { self.tool };
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
            let at = if block.has(b'h') { block.at(b'h') } else { word.at() };
            return Err(Fault::new("gcode::tool", at, format!("tool {number} is not in the tool table")));
        }
        if number != 0 {
            let at = if block.has(b'h') { block.at(b'h') } else { word.at() };
            let message = format!("tool {number} is not in the tool table: its length counts as 0 mm");
            let fault = Fault::new("gcode::tool", at, message);
            self.warnings
                .push(*fault.hint("give a tool table with --tool-table, or nothing if the program's Z is the tip"));
        }
        Ok([0.0; 9])
    }

    /// The changer has put a tool into the spindle.
    pub(super) fn load_tool(&mut self, number: u32) {
        self.tool = number;
        let tool = self.settings.tools.get(number).copied().unwrap_or_default();
        self.parameters.set(numbers::TOOL_FIRST, f64::from(number));
        self.parameters.set_nine(numbers::TOOL_FIRST + 1, tool.offset);
        let rest = [tool.diameter_mm, tool.front_angle_deg, tool.back_angle_deg, f64::from(tool.orientation)];
        for (n, value) in rest.into_iter().enumerate() {
            self.parameters.set(numbers::TOOL_FIRST + 10 + n, value);
        }
    }

    /// Codes that act once.
    pub(super) fn non_modal(&mut self, block: &Block) -> Read<()> {
        let Some(word) = block.code(Group::NonModal) else {
            return Ok(());
        };
        if !self.dialect.is_fanuc()
            && matches!(word.number, 280 | 300 | 520 | 920 | 100)
            && block.code(Group::Motion).is_some_and(|motion| motion.number != 800)
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
            fanuc::OWN.. => self.own_non_modal(block, word),
            921..=923 => {
                self.shift_mode(word.number);
                Ok(())
            }
            _ => Ok(()),
        }
    }

    /// G28, G30: over the point on the line to the stored position, in machine coordinates.
    fn go_home(&mut self, block: &Block, home: usize) -> Read<()> {
        if self.dialect == Dialect::Printer {
            return self.home_printer(block);
        }
        let target = self.target(block)?;
        if block.has_axes() {
            self.line_to(block, self.frame.to_machine(&target), Speed::Rapid, 0.0)?;
        }
        // The axes are those of the program: in a rotated system, Y alone moves X and Y of the machine.
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

    /// G92 names the current position; G52 shifts the origin.
    fn shift(&mut self, block: &Block, word: Word) -> Read<()> {
        let printer = self.dialect == Dialect::Printer;
        if let Some(value) = block.get(b'e').filter(|_| printer) {
            self.extruder_mm = value * self.modal.unit_mm;
        }
        if !block.has_axes() {
            if printer || (self.dialect.is_fanuc() && block.has(b's')) {
                return Ok(());
            }
            return Err(Fault::new("gcode::no_axes", word.at(), format!("{} has no axis word", spelled(word.number))));
        }
        for (axis, letter) in AXIS_LETTERS.into_iter().enumerate() {
            if let Some(value) = block.get(letter) {
                let value = self.length(block, letter, axis, value)?;
                self.frame.g92[axis] =
                    if word.number == 520 { value } else { self.frame.g92[axis] + self.at[axis] - value };
            }
        }
        self.parameters.set_nine(numbers::G92_FIRST, self.frame.g92);
        self.parameters.set(numbers::G92_ACTIVE, 1.0);
        self.offsets_changed();
        Ok(())
    }

    /// G92.1 forgets the shift, G92.2 suspends it, G92.3 takes it up again.
    pub(super) fn shift_mode(&mut self, number: u16) {
        self.frame.g92 = if number == 923 { self.parameters.nine(numbers::G92_FIRST) } else { [0.0; 9] };
        if number == 921 {
            self.parameters.set_nine(numbers::G92_FIRST, [0.0; 9]);
        }
        self.parameters.set(numbers::G92_ACTIVE, f64::from(u8::from(number == 923)));
        self.offsets_changed();
    }

    /// G10: coordinate systems (L2, L20) and the tool table (L1, L10, L11).
    fn set_data(&mut self, block: &Block, word: Word) -> Read<()> {
        if !block.has(b'l') || !block.has(b'p') {
            return Err(Fault::new(
                "gcode::g10",
                word.at(),
                "G10 needs L (what to set) and P (of which system or tool)",
            ));
        }
        match self.integer(block, b'l', 0, 99)? {
            20 if self.dialect.is_fanuc() => self.set_further_system(block),
            2 if self.dialect.is_fanuc() && block.get(b'p') == Some(0.0) => Err(Fault::new(
                "gcode::unsupported",
                block.at(b'p'),
                "G10 L2 P0 (the offset of all systems) is not read",
            )
            .hint("write the offsets of G54 to G59 with P1 to P6")),
            2 => self.set_system(block, false),
            20 => self.set_system(block, true),
            kind @ 10..=13 if self.dialect.is_fanuc() => self.set_tool_part(block, kind),
            kind @ (1 | 10 | 11) => self.set_tool(block, kind),
            other => Err(Fault::new(
                "gcode::g10",
                block.at(b'l'),
                format!("G10 L{other} does not exist: L1, L2, L10, L11, L20 do"),
            )),
        }
    }

    /// G10 L2 sets an origin, G10 L20 sets it so that the current position gets the given coordinates.
    fn set_system(&mut self, block: &Block, by_position: bool) -> Read<()> {
        let system = match self.integer(block, b'p', 0, SYSTEMS)? {
            0 => self.frame.system,
            system => system as usize,
        };
        let first = system_first(system);
        if let Some(rotation) = block.get(b'r') {
            if by_position {
                return Err(Fault::new("gcode::g10", block.at(b'r'), "R (rotation) goes with G10 L2, not with L20"));
            }
            self.parameters.set(first + 9, rotation);
        }
        let mut frame = self.frame.clone();
        frame.system_offset = [0.0; 9];
        frame.rotation_deg = self.parameters.get(first + 9);
        let mut wanted = self.frame.clone();
        wanted.system_offset = self.parameters.nine(first);
        wanted.rotation_deg = frame.rotation_deg;
        let mut named = wanted.to_program(&self.here);
        let mut offset = self.parameters.nine(first);
        for (axis, letter) in AXIS_LETTERS.into_iter().enumerate() {
            if let Some(value) = block.get(letter) {
                let value = self.length(block, letter, axis, value)?;
                named[axis] = value;
                // G91 means nothing to LinuxCNC's G10 L2; on Fanuc the value is added.
                let added = self.modal.incremental && !by_position && self.dialect.is_fanuc();
                offset[axis] = if added { offset[axis] + value } else { value };
            }
        }
        if by_position {
            // The origin that gives the current position these coordinates.
            let from_zero = frame.to_machine(&named);
            for (axis, letter) in AXIS_LETTERS.into_iter().enumerate() {
                let turned = frame.rotation_deg != 0.0 && axis < 2 && (block.has(b'x') || block.has(b'y'));
                offset[axis] = if block.has(letter) || turned {
                    self.here[axis] - from_zero[axis]
                } else {
                    wanted.system_offset[axis]
                };
            }
        }
        self.parameters.set_nine(first, offset);
        if system == self.frame.system {
            self.load_system();
        }
        Ok(())
    }

    /// Fanuc and Haas: L10 is the length of tool P, L12 its radius, L11 and L13 the wear of both, which is added; in G91 R is added to what
    /// is there.
    fn set_tool_part(&mut self, block: &Block, kind: i64) -> Read<()> {
        let number = self.integer(block, b'p', 1, 999_999)? as u32;
        let Some(value) = block.get(b'r') else {
            return Err(Fault::new("gcode::g10", block.whole(), format!("G10 L{kind} has no R, the value to set")));
        };
        let value = value * self.modal.unit_mm;
        let mut tool = self.settings.tools.get(number).copied().unwrap_or_default();
        let adds = self.modal.incremental;
        let set = |old: f64| if adds { old + value } else { value };
        match kind {
            10 => tool.offset[2] = set(tool.offset[2] - tool.wear_mm[0]) + tool.wear_mm[0],
            12 => tool.diameter_mm = 2.0 * (set(0.5 * tool.diameter_mm - tool.wear_mm[1]) + tool.wear_mm[1]),
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
        if number == self.tool {
            self.load_tool(number);
        }
        Ok(())
    }

    /// G10 L1 sets a tool's offsets, L10 and L11 set them so that the current position gets the given coordinates.
    fn set_tool(&mut self, block: &Block, kind: i64) -> Read<()> {
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
                tool.offset[axis] = if kind == 1 { named[axis] } else { self.here[axis] - shifted[axis] };
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
        if number == self.tool {
            self.load_tool(number);
        }
        Ok(())
    }
}

/// First parameter of a coordinate system.
const fn system_first(system: usize) -> usize {
    numbers::SYSTEM_FIRST + numbers::SYSTEM_STRIDE * (system - 1)
}
