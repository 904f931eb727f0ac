//! Where the words of a block lead, in program coordinates.

use crate::state::Interpreter;
use crate::state::frame::Position;
use crate::text::block::Block;
use crate::text::codes::{AXIS_LETTERS, bit};
use crate::text::diagnostic::{LineFault, Read};

/// Words of steps: letter, axis, and the word that gives the same axis as a coordinate.
const STEPS: [(u8, usize, u8); 2] = [(b'u', 0, b'x'), (b'w', 2, b'z')];

impl Interpreter {
    /// Returns the target of the axis words, in program coordinates.
    #[inline]
    pub(crate) fn target(&self, block: &Block) -> Read<Position> {
        let mut target = self.at;
        if block.set & (bit(b'@') | bit(b'^')) != 0 {
            self.polar_target(block, &mut target)?;
        }
        if self.fanuc.is_polar {
            self.own_polar(block, &mut target)?;
        }
        for (axis, letter) in AXIS_LETTERS.into_iter().enumerate() {
            if let Some(value) = block.get(letter) {
                if axis < 2 && self.fanuc.is_polar {
                    continue;
                }
                if axis >= 6 && self.dialect.is_lathe() {
                    target[axis - 6] = self.stepped(block, letter, axis - 6, value)?;
                    continue;
                }
                if self.lathe.is_some() && matches!(letter, b'a' | b'c' | b'u' | b'w') {
                    continue;
                }
                let value = self.length(block, letter, axis, value)?;
                target[axis] = if self.modal.incremental {
                    self.at[axis] + value
                } else {
                    value
                };
            }
        }
        if self.lathe.is_some() {
            self.profile_steps(block, &mut target)?;
        }
        self.check_range(block, &target)?;
        Ok(target)
    }

    /// G53: the words are machine coordinates.
    pub(super) fn machine_target(&self, block: &Block) -> Read<Position> {
        if self.modal.incremental {
            return Err(LineFault::new(
                "gcode::g53",
                block.whole(),
                "G53 means machine coordinates, which G91 (distances) cannot give",
            )
            .hint("write G90 before it"));
        }
        // Behind G40 the tool stands beside the contour, and every motion starts from the contour.
        let mut machine = if self.carried.left_compensation {
            self.frame.to_machine(&self.at)
        } else {
            self.here
        };
        for (axis, letter) in AXIS_LETTERS.into_iter().enumerate() {
            if let Some(value) = block.get(letter) {
                machine[axis] = self.length(block, letter, axis, value)?;
            }
        }
        Ok(self.frame.to_program(&machine))
    }

    /// Many small steps must not creep beyond the limit either.
    fn check_range(&self, block: &Block, target: &Position) -> Read<()> {
        let limit = self.settings.coordinate_limit_mm;
        for axis in [0, 1, 2, 6, 7, 8] {
            if target[axis].is_nan() || target[axis].abs() > limit {
                return Err(self.too_far(block, AXIS_LETTERS[axis], target[axis]));
            }
        }
        Ok(())
    }

    /// `@` radius and `^` angle about the origin of the XY plane.
    #[cold]
    fn polar_target(&self, block: &Block, target: &mut Position) -> Read<()> {
        let at = block.at_any(bit(b'@') | bit(b'^'));
        if block.set & (bit(b'x') | bit(b'y')) != 0 {
            return Err(LineFault::new(
                "gcode::polar",
                at,
                "polar coordinates @ and ^ exclude X and Y",
            ));
        }
        let [first, second, _] = self.modal.plane.axes();
        let (old_radius, old_angle) = (
            libm::hypot(self.at[0], self.at[1]),
            libm::atan2(self.at[1], self.at[0]).to_degrees(),
        );
        if [first, second] != [0, 1] {
            return Err(LineFault::new(
                "gcode::polar",
                at,
                "polar coordinates need the XY plane G17",
            ));
        }
        let radius = block.get(b'@').map(|radius| radius * self.modal.unit_mm);
        let angle = block.get(b'^');
        if self.modal.incremental && old_radius == 0.0 {
            let message = "in G91, polar coordinates have no direction at the origin";
            return Err(
                LineFault::new("gcode::polar", at, message).hint("write this motion in G90")
            );
        }
        if angle.is_none() && old_radius == 0.0 {
            return Err(LineFault::new(
                "gcode::polar",
                at,
                "at the origin the angle ^ is needed",
            ));
        }
        let (radius, angle) = if self.modal.incremental {
            (
                old_radius + radius.unwrap_or(0.0),
                old_angle + angle.unwrap_or(0.0),
            )
        } else {
            (radius.unwrap_or(old_radius), angle.unwrap_or(old_angle))
        };
        let (sin, cos) = libm::sincos(angle.to_radians());
        [target[0], target[1]] = [radius * cos, radius * sin];
        Ok(())
    }

    /// Sets the target from X (a radius) and Y (an angle) of G16.
    fn own_polar(&self, block: &Block, target: &mut Position) -> Read<()> {
        if !block.has(b'x') && !block.has(b'y') {
            return Ok(());
        }
        if self.modal.incremental && block.has(b'x') {
            return Err(LineFault::new(
                "gcode::polar",
                block.at(b'x'),
                "a radius in G91 counts from where the tool is, which is not read",
            )
            .hint("write the radius in G90; the angle may be a distance"));
        }
        let old_radius = libm::hypot(self.at[0], self.at[1]);
        let radius = match block.get(b'x') {
            Some(value) => self.length(block, b'x', 1, value)?,
            None => old_radius,
        };
        let old_angle = libm::atan2(self.at[1], self.at[0]).to_degrees();
        let angle = match block.get(b'y') {
            Some(angle) if self.modal.incremental => old_angle + angle,
            Some(angle) => angle,
            None if old_radius == 0.0 => {
                return Err(LineFault::new(
                    "gcode::polar",
                    block.at(b'x'),
                    "Y (the angle) is missing: the tool is at the origin",
                )
                .hint("with G16, X is a radius and Y an angle in degrees"));
            }
            None => old_angle,
        };
        let (sin, cos) = libm::sincos(angle.to_radians());
        (target[0], target[1]) = (radius * cos, radius * sin);
        Ok(())
    }

    /// Returns the target along X, Y or Z of a distance U, V or W. Fails if the line also has X, Y
    /// or Z.
    fn stepped(&self, block: &Block, letter: u8, axis: usize, value: f64) -> Read<f64> {
        let place = b"xyz"[axis];
        if block.has(place) {
            let [step, place] =
                [letter, place].map(|letter| char::from(letter).to_ascii_uppercase());
            let message =
                format!("{step} and {place} on one line: {step} is a distance along {place}");
            return Err(LineFault::new("gcode::repeated", block.at(letter), message)
                .hint("write one of the two"));
        }
        Ok(self.at[axis] + self.length(block, place, axis, value)?)
    }

    /// Adds the steps of a block inside a profile to where it goes.
    #[cold]
    fn profile_steps(&self, block: &Block, target: &mut Position) -> Read<()> {
        for (letter, axis, coordinate) in STEPS {
            let Some(value) = block.get(letter) else {
                continue;
            };
            if block.has(coordinate) {
                let [step, place] =
                    [letter, coordinate].map(|letter| char::from(letter).to_ascii_uppercase());
                let message = format!(
                    "{step} and {place} in one block of a profile: {step} is a step along {place}"
                );
                return Err(LineFault::new("gcode::lathe", block.at(letter), message)
                    .hint("write one of the two"));
            }
            target[axis] = self.at[axis] + self.length(block, coordinate, axis, value)?;
        }
        Ok(())
    }

    /// Filament that the line pushes, mm.
    #[inline]
    pub(super) fn extruder_word(&mut self, block: &Block) -> f64 {
        let Some(value) = block.get(b'e') else {
            return 0.0;
        };
        let value = value * self.modal.unit_mm;
        let pushed = if self.extruder.is_relative {
            value
        } else {
            value - self.extruder.at_mm
        };
        self.extruder.at_mm += pushed;
        pushed
    }
}
