//! Words of lengths in the cycles of lathes.

use crate::state::Interpreter;
use crate::text::block::Block;
use crate::text::codes::bit;
use crate::text::diagnostic::{LineFault, Read, Short};

/// X, Z, U and W.
pub(super) const PLANE_WORDS: u32 = bit(b'x') | bit(b'z') | bit(b'u') | bit(b'w');

impl Interpreter {
    /// A word in least increments where it has no decimal point: P, Q and D of the cycles of
    /// lathes, mm.
    pub(super) fn micrometres(&self, block: &Block, letter: u8, value: f64) -> f64 {
        let increment = if self.modal.unit_mm == 1.0 {
            1e-3
        } else {
            1e-4
        };
        value
            * if block.has_point(letter) {
                1.0
            } else {
                increment
            }
            * self.modal.unit_mm
    }

    /// A word that must be above zero.
    pub(super) fn above_zero(block: &Block, letter: u8, value_mm: f64, what: &str) -> Read<f64> {
        if value_mm > 0.0 {
            return Ok(value_mm);
        }
        let name = char::from(letter).to_ascii_uppercase();
        let message = format!(
            "{name} = {} mm ({what}) must be above 0 mm",
            Short(value_mm)
        );
        Err(LineFault::new("gcode::lathe", block.at(letter), message)
            .hint("it is a depth, without a sign"))
    }

    /// A length that is no coordinate, mm, within the limit of coordinates.
    pub(super) fn distance_word(&self, block: &Block, letter: u8) -> Read<Option<f64>> {
        block
            .get(letter)
            .map(|value| self.length(block, letter, 2, value))
            .transpose()
    }

    /// A length of at least 0, mm.
    pub(super) fn not_negative(&self, block: &Block, letter: u8) -> Read<Option<f64>> {
        let value = self.distance_word(block, letter)?;
        if let Some(mm) = value.filter(|&mm| mm < 0.0) {
            let name = char::from(letter).to_ascii_uppercase();
            let message = format!(
                "{name} = {} mm is negative; the smallest is 0 mm",
                Short(mm)
            );
            return Err(LineFault::new("gcode::lathe", block.at(letter), message));
        }
        Ok(value)
    }

    /// A word of whole least increments, or of a length with a decimal point, mm and not negative.
    pub(super) fn increments(&self, block: &Block, letter: u8) -> Read<Option<f64>> {
        let Some(value) = block.get(letter) else {
            return Ok(None);
        };
        let mm = self.micrometres(block, letter, value);
        if (0.0..=self.settings.coordinate_limit_mm).contains(&mm) {
            return Ok(Some(mm));
        }
        let name = char::from(letter).to_ascii_uppercase();
        let limit = self.settings.coordinate_limit_mm;
        let message = format!("{name} = {} mm is out of range: 0 to {limit} mm", Short(mm));
        Err(
            LineFault::new("gcode::lathe", block.at(letter), message).hint(
                if self.modal.unit_mm == 1.0 {
                    "without a decimal point it counts 0.001 mm"
                } else {
                    "without a decimal point it counts 0.0001 inch"
                },
            ),
        )
    }
}
