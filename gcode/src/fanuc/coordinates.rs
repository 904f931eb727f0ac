//! Coordinates of Fanuc and Haas: G68 turns them, G16 makes X a radius and Y an angle, G54.1 P and G154 P are further systems.

use super::super::block::{Block, Word};
use super::super::canon::Plane;
use super::super::codes::{AXIS_LETTERS, Group, bit, spelled};
use super::super::diagnostic::{Fault, Read};
use super::super::state::{Interpreter, Position, Turn};

/// Further systems that a control may have.
const MOST_SYSTEMS: i64 = 300;
/// Systems that LinuxCNC has, too: the further ones are counted from here.
const SYSTEMS: usize = 9;

impl Interpreter {
    /// G15, G16, G68, G69.
    pub(crate) fn own_modes(&mut self, block: &Block) -> Read<()> {
        if let Some(word) = block.code(Group::Polar) {
            self.fanuc.is_polar = word.number % super::OWN == 160;
        }
        if let Some(word) = block.code(Group::Rotation) {
            self.frame.turn = None;
            self.offsets_changed();
            if word.number % super::OWN == 680 {
                self.turn(block, word)?;
            }
        }
        if (self.fanuc.is_polar || self.frame.turn.is_some()) && self.modal.plane != Plane::Xy {
            let what = if self.fanuc.is_polar { "G16" } else { "G68" };
            return Err(Fault::new("gcode::unsupported", block.whole(), format!("{what} outside G17 is not read"))
                .hint("write G17 before it, and G15 or G69 before another plane"));
        }
        Ok(())
    }

    /// `G68 X0 Y0 R30.`: turns what follows about a point.
    fn turn(&mut self, block: &Block, word: Word) -> Read<()> {
        let other = block.set & (bit(b'z') | bit(b'a') | bit(b'b') | bit(b'c'));
        if other != 0 {
            return Err(Fault::new("gcode::unsupported", block.at_any(other), "G68 in space is not read")
                .hint("G68 X Y R turns in the XY plane"));
        }
        let Some(angle_deg) = block.get(b'r') else {
            return Err(Fault::new("gcode::rotation", word.at(), "R (angle in degrees) is missing for G68")
                .hint("write G68 X0 Y0 R30."));
        };
        let mut center = [self.at[0], self.at[1]];
        for (axis, letter) in [(0, b'x'), (1, b'y')] {
            if let Some(value) = block.get(letter) {
                let value = self.length(block, letter, axis, value)?;
                center[axis] = if self.modal.incremental { center[axis] + value } else { value };
            }
        }
        self.frame.turn = Some(Turn { center, angle_deg });
        self.offsets_changed();
        Ok(())
    }

    /// Where X (a radius) and Y (an angle) of G16 lead.
    pub(crate) fn own_polar(&self, block: &Block, target: &mut Position) -> Read<()> {
        if !block.has(b'x') && !block.has(b'y') {
            return Ok(());
        }
        if self.modal.incremental && block.has(b'x') {
            return Err(Fault::new(
                "gcode::polar",
                block.at(b'x'),
                "a radius in G91 counts from where the tool is, which is not read",
            )
            .hint("write the radius in G90; the angle may be a distance"));
        }
        let old_radius = self.at[0].hypot(self.at[1]);
        let radius = match block.get(b'x') {
            Some(value) => self.length(block, b'x', 1, value)?,
            None => old_radius,
        };
        let old_angle = self.at[1].atan2(self.at[0]).to_degrees();
        let angle = match block.get(b'y') {
            Some(angle) if self.modal.incremental => old_angle + angle,
            Some(angle) => angle,
            None if old_radius == 0.0 => {
                return Err(Fault::new(
                    "gcode::polar",
                    block.at(b'x'),
                    "Y (the angle) is missing: the tool is at the origin",
                )
                .hint("with G16, X is a radius and Y an angle in degrees"));
            }
            None => old_angle,
        };
        let (sin, cos) = angle.to_radians().sin_cos();
        (target[0], target[1]) = (radius * cos, radius * sin);
        Ok(())
    }

    /// `G54.1 P3`, `G154 P3`.
    pub(crate) fn further_system(&mut self, block: &Block, word: Word) -> Read<()> {
        if !block.has(b'p') {
            let message = format!("P (number of the coordinate system) is missing for {}", spelled(word.number));
            return Err(Fault::new("gcode::coordinates", word.at(), message).hint("write G54.1 P1"));
        }
        let system = SYSTEMS + self.integer(block, b'p', 1, MOST_SYSTEMS)? as usize;
        self.frame.system = system;
        self.load_further_system();
        if !self.fanuc.systems.contains_key(&system) && self.warn_once("gcode::coordinates") {
            let message = format!(
                "the offsets of {} P{} are in the control: they count as 0",
                spelled(word.number),
                system - SYSTEMS
            );
            self.warnings.push(
                *Fault::new("gcode::coordinates", word.at(), message)
                    .hint("G10 L20 P1 X Y Z writes them into the program"),
            );
        }
        Ok(())
    }

    pub(crate) fn load_further_system(&mut self) {
        self.frame.system_offset = self.fanuc.systems.get(&self.frame.system).copied().unwrap_or_default();
        self.frame.rotation_deg = 0.0;
        self.offsets_changed();
    }

    /// `G10 L20 P3 X Y Z`.
    pub(crate) fn set_further_system(&mut self, block: &Block) -> Read<()> {
        let system = SYSTEMS + self.integer(block, b'p', 1, MOST_SYSTEMS)? as usize;
        let mut offset = self.fanuc.systems.get(&system).copied().unwrap_or_default();
        for (axis, letter) in AXIS_LETTERS.into_iter().enumerate() {
            if let Some(value) = block.get(letter) {
                let value = self.length(block, letter, axis, value)?;
                offset[axis] = if self.modal.incremental { offset[axis] + value } else { value };
            }
        }
        self.fanuc.systems.insert(system, offset);
        if system == self.frame.system {
            self.load_further_system();
        }
        Ok(())
    }
}
