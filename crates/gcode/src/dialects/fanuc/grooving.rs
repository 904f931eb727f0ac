//! G74 (along Z) and G75 (along X): pecks in one direction, steps in the other.
//!
//! Each peck goes Q (G75: P) deeper than the one before and back by R of the first block. At the
//! bottom the tool moves aside by R of the second block, against the step, and returns in a rapid;
//! then it steps by P (G75: Q). P and Q count least increments where they have no decimal point; P
//! is a radius.

use crate::motion::feed::Speed;
use crate::state::Interpreter;
use crate::text::block::{Block, Word};
use crate::text::codes::fanuc::OWN;
use crate::text::codes::spelled;
use crate::text::diagnostic::{LineFault, Read};

/// Pecks of one block, and motions: they are held in memory until they are read. At constant
/// surface speed a peck can be some hundred motions.
const MAX_PECKS: f64 = 1e5;
const MAX_MOTIONS: usize = 400_000;

impl Interpreter {
    pub(super) fn grooving_cycle(&mut self, block: &Block, word: Word) -> Read<()> {
        let end = self.target(block)?;
        let start = self.at;
        // Axis of the pecks, with its word, and of the steps.
        let [(deep, peck), (aside, step)] = if word.number % OWN == 740 {
            [(2, b'q'), (0, b'p')]
        } else {
            [(0, b'p'), (2, b'q')]
        };
        let older = [b'i', 0, b'k'];
        let increment = |letter: u8, axis: usize| -> Read<Option<f64>> {
            Ok(self
                .increments(block, letter)?
                .or(self.increments(block, older[axis])?))
        };
        let (depth, width) = (end[deep] - start[deep], end[aside] - start[aside]);
        let peck_mm = increment(peck, deep)?
            .filter(|&mm| mm > 0.0)
            .unwrap_or(depth.abs());
        let step_mm = increment(step, aside)?.filter(|&mm| mm > 0.0);
        let relief_mm = self
            .not_negative(block, b'r')?
            .or(self.increments(block, b'd')?)
            .unwrap_or(0.0);
        if depth == 0.0 {
            let message = format!(
                "{} cuts nothing: it ends at the {} where it begins",
                spelled(word.number),
                ["X", "Y", "Z"][deep]
            );
            return Err(LineFault::new("gcode::lathe", block.whole(), message)
                .hint("X and Z are the bottom of the last groove"));
        }
        let steps = match step_mm {
            _ if width == 0.0 => 0.0,
            Some(step_mm) => (width.abs() / step_mm - 1e-9).ceil(),
            None => {
                let name = char::from(step).to_ascii_uppercase();
                let message = format!(
                    "{name} (step from groove to groove) is missing for {}",
                    spelled(word.number)
                );
                return Err(LineFault::new("gcode::lathe", word.at(), message)
                    .hint("without a decimal point it counts 0.001 mm: 2000 is 2 mm"));
            }
        };
        let pecks = (depth.abs() / peck_mm - 1e-9).ceil();
        if (steps + 1.0) * pecks > MAX_PECKS {
            let message = format!(
                "{:.0} pecks in one block; it may have {MAX_PECKS}",
                (steps + 1.0) * pecks
            );
            return Err(LineFault::new("gcode::lathe", word.at(), message)
                .hint("P and Q count 0.001 mm (0.0001 inch) without a decimal point"));
        }
        let mut groove = 0.0;
        while groove <= steps {
            let place = if groove == steps {
                end[aside]
            } else {
                start[aside] + width.signum() * groove * step_mm.unwrap_or(0.0)
            };
            self.along(
                block,
                aside,
                if steps == 0.0 { start[aside] } else { place },
                Speed::Rapid,
            )?;
            self.peck_groove(block, deep, [start[deep], end[deep]], peck_mm)?;
            if relief_mm > 0.0 && steps > 0.0 {
                self.along(
                    block,
                    aside,
                    place - width.signum() * relief_mm,
                    Speed::Rapid,
                )?;
            }
            self.along(block, deep, start[deep], Speed::Rapid)?;
            groove += 1.0;
        }
        self.along(block, aside, start[aside], Speed::Rapid)
    }

    fn peck_groove(
        &mut self,
        block: &Block,
        axis: usize,
        [from, to]: [f64; 2],
        peck_mm: f64,
    ) -> Read<()> {
        let sense = (to - from).signum();
        let back_mm = self.fanuc.repetitive.back_mm;
        let mut pecks = 1.0;
        while pecks * peck_mm < (to - from).abs() - 1e-9 {
            if self.output.steps.len() > MAX_MOTIONS {
                let message = format!(
                    "more than {MAX_MOTIONS} motions in one block, at constant surface speed (G96)"
                );
                return Err(LineFault::new("gcode::lathe", block.whole(), message)
                    .hint("G97, or a bound on the spindle (G50 S...), makes fewer of them"));
            }
            let depth = from + sense * pecks * peck_mm;
            self.along(block, axis, depth, Speed::Programmed)?;
            self.along(block, axis, depth - sense * back_mm, Speed::Rapid)?;
            pecks += 1.0;
        }
        self.along(block, axis, to, Speed::Programmed)
    }
}
