//! Coordinate systems and their offsets: G10 L2 and L20, G52, G54 to G59.3, G54.1 P, G92.
//!
//! machine = rotate(program + G92 offset) + coordinate system + tool offset; see
//! [`Frame`](super::frame::Frame). None of these codes moves the machine; they change what its
//! position is called.

use crate::settings::Dialect;
use crate::state::Interpreter;
use crate::state::parameters as numbers;
use crate::text::block::{Block, Word};
use crate::text::codes::fanuc::OWN;
use crate::text::codes::{AXIS_LETTERS, Group, spelled};
use crate::text::diagnostic::{LineFault, Read};

/// Coordinate systems G54 to G59.3.
const SYSTEMS: i64 = 9;

/// Further systems that a control may have.
const MAX_SYSTEMS: i64 = 300;

impl Interpreter {
    /// G54 to G59.3; Fanuc's G54.1 P1 and up are further systems.
    pub(crate) fn coordinate_system(&mut self, block: &Block) -> Read<()> {
        let Some(word) = block.code(Group::Coordinates) else {
            return Ok(());
        };
        let system = match word.number {
            OWN.. => return self.further_system(block, word),
            541 => {
                let message = "G54.1 P (additional coordinate systems) needs offsets that only the control has";
                return Err(LineFault::new("gcode::unsupported", word.at(), message)
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

    /// G92 names the current position; G52 shifts the origin.
    pub(crate) fn shift(&mut self, block: &Block, word: Word) -> Read<()> {
        let printer = self.dialect == Dialect::Printer;
        if let Some(value) = block.get(b'e').filter(|_| printer) {
            self.extruder.at_mm = value * self.modal.unit_mm;
        }
        if !block.has_axes() {
            if printer || (self.dialect.is_fanuc() && block.has(b's')) {
                return Ok(());
            }
            return Err(LineFault::new(
                "gcode::no_axes",
                word.at(),
                format!("{} has no axis word", spelled(word.number)),
            ));
        }
        for (axis, letter) in AXIS_LETTERS.into_iter().enumerate() {
            if let Some(value) = block.get(letter) {
                let value = self.length(block, letter, axis, value)?;
                self.frame.g92[axis] = if word.number == 520 {
                    value
                } else {
                    self.frame.g92[axis] + self.at[axis] - value
                };
            }
        }
        self.parameters.set_nine(numbers::G92_FIRST, self.frame.g92);
        self.parameters.set(numbers::G92_ACTIVE, 1.0);
        self.offsets_changed();
        Ok(())
    }

    /// G92.1 forgets the shift, G92.2 suspends it, G92.3 takes it up again.
    pub(crate) fn shift_mode(&mut self, number: u16) {
        self.frame.g92 = if number == 923 {
            self.parameters.nine(numbers::G92_FIRST)
        } else {
            [0.0; 9]
        };
        if number == 921 {
            self.parameters.set_nine(numbers::G92_FIRST, [0.0; 9]);
        }
        self.parameters
            .set(numbers::G92_ACTIVE, f64::from(u8::from(number == 923)));
        self.offsets_changed();
    }

    /// G10 L2 sets an origin, G10 L20 sets it so that the current position gets the given
    /// coordinates.
    pub(crate) fn set_system(&mut self, block: &Block, by_position: bool) -> Read<()> {
        let system = match self.integer(block, b'p', 0, SYSTEMS)? {
            0 => self.frame.system,
            system => system as usize,
        };
        let first = system_first(system);
        if let Some(rotation) = block.get(b'r') {
            if by_position {
                return Err(LineFault::new(
                    "gcode::g10",
                    block.at(b'r'),
                    "R (rotation) goes with G10 L2, not with L20",
                ));
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
                let turned =
                    frame.rotation_deg != 0.0 && axis < 2 && (block.has(b'x') || block.has(b'y'));
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

    /// `G54.1 P3`, `G154 P3`.
    fn further_system(&mut self, block: &Block, word: Word) -> Read<()> {
        if !block.has(b'p') {
            let message = format!(
                "P (number of the coordinate system) is missing for {}",
                spelled(word.number)
            );
            return Err(
                LineFault::new("gcode::coordinates", word.at(), message).hint("write G54.1 P1")
            );
        }
        let system = SYSTEMS as usize + self.integer(block, b'p', 1, MAX_SYSTEMS)? as usize;
        self.frame.system = system;
        self.load_further_system();
        if !self.fanuc.systems.contains_key(&system) && self.warn_once("gcode::coordinates") {
            let message = format!(
                "the offsets of {} P{} are in the control: they count as 0",
                spelled(word.number),
                system - SYSTEMS as usize
            );
            self.output.warnings.push(
                *LineFault::new("gcode::coordinates", word.at(), message)
                    .hint("G10 L20 P1 X Y Z writes them into the program"),
            );
        }
        Ok(())
    }

    fn load_further_system(&mut self) {
        self.frame.system_offset = self
            .fanuc
            .systems
            .get(&self.frame.system)
            .copied()
            .unwrap_or_default();
        self.frame.rotation_deg = 0.0;
        self.offsets_changed();
    }

    /// `G10 L20 P3 X Y Z`.
    pub(crate) fn set_further_system(&mut self, block: &Block) -> Read<()> {
        let system = SYSTEMS as usize + self.integer(block, b'p', 1, MAX_SYSTEMS)? as usize;
        let mut offset = self.fanuc.systems.get(&system).copied().unwrap_or_default();
        for (axis, letter) in AXIS_LETTERS.into_iter().enumerate() {
            if let Some(value) = block.get(letter) {
                let value = self.length(block, letter, axis, value)?;
                offset[axis] = if self.modal.incremental {
                    offset[axis] + value
                } else {
                    value
                };
            }
        }
        self.fanuc.systems.insert(system, offset);
        if system == self.frame.system {
            self.load_further_system();
        }
        Ok(())
    }
}

/// First parameter of a coordinate system.
pub(super) const fn system_first(system: usize) -> usize {
    numbers::SYSTEM_FIRST + numbers::SYSTEM_STRIDE * (system - 1)
}
