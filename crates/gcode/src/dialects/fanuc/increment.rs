//! Lengths without a decimal point: least increments where the control counts so (`--increment`),
//! whole units where it does not.

use crate::state::Interpreter;
use crate::text::block::Block;
use crate::text::codes::fanuc::{LATHE_OWN, OWN};
use crate::text::codes::{Group, bit, letter, slot};
use crate::text::diagnostic::Short;

/// Letters of lengths and angles.
const LENGTHS: &[u8] = b"xyzuvwabcrijkq";

impl Interpreter {
    /// Counts the lengths of a line in least increments, or keeps an eye on those without a point.
    pub(super) fn count_increments(&mut self, block: &mut Block) {
        // The unit of the line itself.
        let is_inch = block
            .code(Group::Units)
            .map_or(self.modal.unit_mm != 1.0, |word| word.number == 200);
        let lengths = self.lengths(block) & block.set & !block.pointed & !block.computed;
        if let (Some(corner), Some(increment)) = (&mut block.corner, self.settings.increment)
            && !corner.has_point
        {
            corner.value *= increment.units(is_inch);
        }
        let with_point = block.set & block.pointed != 0;
        let points = &mut self.fanuc.points;
        points.has_point |= with_point;
        for &name in LENGTHS {
            if lengths & bit(name) == 0 {
                continue;
            }
            let value = block.get(name).unwrap_or(0.0);
            if let Some(increment) = self.settings.increment {
                let is_angle = matches!(name, b'a' | b'b' | b'c');
                block.put(name, value * increment.units(is_inch && !is_angle));
            } else if value != 0.0 {
                points.count += 1;
                if points.first.is_none() {
                    let shown = format!("{}{}", letter(slot(name)), Short(value));
                    points.first = Some((self.line, shown, value));
                }
            }
        }
    }

    /// Letters of the line that are lengths or angles and no counts.
    fn lengths(&self, block: &Block) -> u32 {
        let mut letters = LENGTHS.iter().fold(0, |set, &letter| set | bit(letter));
        let motion = block
            .code(Group::Motion)
            .map_or(self.modal.motion, |word| word.number);
        let other = block.code(Group::NonModal).map(|word| word.number);
        if matches!(motion % OWN, 730 | 740 | 810..=890) && !block.has(b'i') {
            letters &= !bit(b'k'); // Repeats.
        }
        match other {
            // A time; arguments, which have units of their own; a number.
            Some(code) if matches!(code % OWN, 40 | 650) => 0,
            Some(code) if code >= LATHE_OWN && matches!(code % OWN, 700..=760) => {
                // Counted by the cycles themselves, or not at all.
                let counted = bit(b'q') | bit(b'i') | bit(b'k') | bit(b'a');
                let number = matches!(code % OWN, 730 | 760)
                    && !block.has(b'z')
                    && !block.has(b'p') | (code % OWN == 760);
                letters & !counted & if number { !bit(b'r') } else { u32::MAX }
            }
            Some(100) => letters & !bit(b'q'),
            _ => letters,
        }
    }

    /// Returns the warning about decimal points for the end of a program, once: line, message and
    /// hint.
    pub(crate) fn warning_of_points(&mut self) -> Option<(u32, String, &'static str)> {
        let points = std::mem::take(&mut self.fanuc.points);
        let (line, word, value) = points.first?;
        let small = Short(value * 1e-3);
        let message = if points.has_point {
            let count = points.count;
            let lengths = if count == 1 {
                "one length has".to_owned()
            } else {
                format!("{count} lengths have")
            };
            format!(
                "{lengths} no decimal point; the first, {word}, is read as {} and not as {small}",
                Short(value)
            )
        } else {
            format!(
                "no length of the program has a decimal point: {word} is read as {} and not as {small}",
                Short(value)
            )
        };
        Some((
            line,
            message,
            "--increment 0.001mm reads them as the least increments of a control that counts so",
        ))
    }
}
