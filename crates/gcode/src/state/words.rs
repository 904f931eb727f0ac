//! Values of words: whole numbers, lengths, seconds.

use crate::state::Interpreter;
use crate::text::block::Block;
use crate::text::codes;
use crate::text::diagnostic::{LineFault, Read, Short};
use crate::text::expression::INTEGER_WITHIN;

impl Interpreter {
    /// A word that must hold an integer within limits.
    pub(crate) fn integer(&self, block: &Block, letter: u8, low: i64, high: i64) -> Read<i64> {
        let value = block.get(letter).unwrap_or(0.0);
        let name = codes::letter(codes::slot(letter));
        let at = block.at(letter);
        if (value - value.round()).abs() > INTEGER_WITHIN {
            return Err(LineFault::new(
                "gcode::integer",
                at,
                format!("{name}{} is not an integer", Short(value)),
            ));
        }
        let rounded = value.round() as i64;
        if !(low..=high).contains(&rounded) {
            return Err(LineFault::new(
                "gcode::range",
                at,
                format!(
                    "{name}{} is out of range: {low} to {high}",
                    Short(value.round())
                ),
            ));
        }
        Ok(rounded)
    }

    /// Seconds of the time P of a dwell. Fanuc and Haas count milliseconds where it has no decimal
    /// point.
    pub(crate) const fn seconds(&self, block: &Block, time: f64) -> f64 {
        if self.dialect.is_fanuc() && !block.has_point(b'p') {
            time * 1e-3
        } else {
            time
        }
    }

    /// Value of an axis word in mm or degrees.
    #[inline]
    pub(crate) fn length(&self, block: &Block, letter: u8, axis: usize, value: f64) -> Read<f64> {
        let scaled = match axis {
            3..=5 => value,
            0 if self.modal.diameter => 0.5 * value * self.modal.unit_mm,
            _ => value * self.modal.unit_mm,
        };
        if scaled.is_nan() || scaled.abs() > self.settings.coordinate_limit_mm {
            return Err(self.too_far(block, letter, scaled));
        }
        Ok(scaled)
    }

    #[cold]
    pub(crate) fn too_far(&self, block: &Block, letter: u8, value: f64) -> Box<LineFault> {
        let name = char::from(letter).to_ascii_uppercase();
        let limit = self.settings.coordinate_limit_mm;
        let unit = if matches!(letter, b'a' | b'b' | b'c') {
            "degrees"
        } else {
            "mm"
        };
        let message = format!(
            "{name} = {} {unit} is beyond the limit of {limit} {unit}",
            Short(value)
        );
        LineFault::new("gcode::coordinate", block.at(letter), message).hint(
            if self.modal.unit_mm == 1.0 {
                "is a decimal point missing?"
            } else {
                "is a decimal point missing? G20 is active: lengths are inches"
            },
        )
    }
}
