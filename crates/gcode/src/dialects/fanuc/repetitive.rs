//! G70 to G76 of lathes: what their blocks ask for.
//!
//! A cycle has two blocks, `G71 U2. R0.5` and `G71 P100 Q200 U0.4 W0.1 F0.25`; the words of the
//! first stay until they are written anew. Older controls and Haas write one block, with the depth
//! of a pass in D.

use crate::dialects::fanuc::words::PLANE_WORDS;
use crate::state::Interpreter;
use crate::state::capture::{ProfileBlocks, ProfileWork};
use crate::text::block::{Block, Word};
use crate::text::codes::fanuc::OWN;
use crate::text::codes::spelled;
use crate::text::diagnostic::{LineFault, Read, Short};

/// Escape where a program has none: a setting of the control, away from the part.
const ESCAPE_MM: f64 = 0.5;

impl Interpreter {
    pub(super) fn repetitive_cycle(&mut self, block: &Block, word: Word) -> Read<()> {
        if self.fanuc.capture.is_some() {
            let message = format!(
                "{} stands inside the profile of another cycle",
                spelled(word.number)
            );
            return Err(LineFault::new("gcode::lathe", word.at(), message));
        }
        let is_second = block.has(b'p') && block.has(b'q');
        match word.number % OWN {
            700 => self.want_profile(block, word, ProfileWork::Finish),
            710 | 720 if is_second => {
                let work = self.roughing_words(block, word)?;
                self.want_profile(block, word, work)
            }
            730 if is_second => {
                let Some((shift_mm, passes)) = self.fanuc.repetitive.pattern else {
                    return Err(LineFault::new(
                        "gcode::lathe",
                        word.at(),
                        "G73 has no first block: how far it begins off the profile is not known",
                    )
                    .hint("write G73 U5. W2. R4 before it: 5 mm along X, 2 mm along Z, 4 passes"));
                };
                let allowance_mm = self.allowance(block)?;
                self.want_profile(
                    block,
                    word,
                    ProfileWork::Pattern {
                        shift_mm,
                        passes,
                        allowance_mm,
                    },
                )
            }
            710 => self.first_roughing(block, word, b'u', 0),
            720 => self.first_roughing(block, word, b'w', 1),
            730 => self.first_pattern(block, word),
            740 | 750 if block.set & PLANE_WORDS == 0 => {
                self.fanuc.repetitive.back_mm = self.not_negative(block, b'r')?.unwrap_or(0.0);
                Ok(())
            }
            740 | 750 => self.grooving_cycle(block, word),
            _ if block.set & PLANE_WORDS == 0 => self.first_threading(block),
            _ => self.threading_cycle(block, word),
        }
    }

    /// `G71 U2. R0.5`, `G72 W2. R0.5`.
    fn first_roughing(&mut self, block: &Block, word: Word, letter: u8, row: usize) -> Read<()> {
        if let Some(depth_mm) = self.distance_word(block, letter)? {
            self.fanuc.repetitive.depth_mm[row] = Some(Self::above_zero(
                block,
                letter,
                depth_mm,
                "depth of a pass",
            )?);
        } else if !block.has(b'r') {
            let name = char::from(letter).to_ascii_uppercase();
            let message = format!(
                "{} has neither P and Q (blocks of the profile) nor {name} (depth of a pass)",
                spelled(word.number)
            );
            return Err(LineFault::new("gcode::lathe", word.at(), message)
                .hint("write G71 U2. R0.5 and then G71 P100 Q200 U0.4 W0.1 F0.25"));
        }
        if let Some(escape_mm) = self.not_negative(block, b'r')? {
            self.fanuc.repetitive.escape_mm = Some(escape_mm);
        }
        Ok(())
    }

    /// `G71 P100 Q200 U0.4 W0.1`, and D of a cycle in one block.
    fn roughing_words(&mut self, block: &Block, word: Word) -> Read<ProfileWork> {
        let row = usize::from(word.number % OWN == 720);
        if let Some(letter) = [b'i', b'k'].into_iter().find(|&letter| block.has(letter)) {
            let message = format!(
                "{} of {} is not read",
                char::from(letter).to_ascii_uppercase(),
                spelled(word.number)
            );
            return Err(
                LineFault::new("gcode::unsupported", block.at(letter), message)
                    .hint("it is an allowance of the last roughing pass; U and W are those of all"),
            );
        }
        if let Some(value) = block.get(b'd') {
            let depth_mm = self.micrometres(block, b'd', value);
            self.fanuc.repetitive.depth_mm[row] =
                Some(Self::above_zero(block, b'd', depth_mm, "depth of a pass")?);
        }
        let Some(depth_mm) = self.fanuc.repetitive.depth_mm[row] else {
            let message = format!(
                "the depth of a pass of {} is nowhere: it is a parameter of the control",
                spelled(word.number)
            );
            let first = if row == 0 {
                "G71 U2. R0.5"
            } else {
                "G72 W2. R0.5"
            };
            return Err(LineFault::new("gcode::lathe", word.at(), message)
                .hint(format!("write {first} before it, or D on it")));
        };
        let escape_mm = self.fanuc.repetitive.escape_mm.unwrap_or(ESCAPE_MM);
        Ok(ProfileWork::Rough {
            is_facing: row == 1,
            depth_mm,
            escape_mm,
            allowance_mm: self.allowance(block)?,
        })
    }

    /// U (a diameter) and W of a second block, mm along X and Z.
    fn allowance(&self, block: &Block) -> Read<[f64; 2]> {
        let along = |letter: u8, axis| {
            block
                .get(letter)
                .map_or(Ok(0.0), |value| self.length(block, letter, axis, value))
        };
        Ok([along(b'u', 0)?, along(b'w', 2)?])
    }

    /// `G73 U5. W2. R4`.
    fn first_pattern(&mut self, block: &Block, word: Word) -> Read<()> {
        let shift_mm = [
            self.distance_word(block, b'u')?.unwrap_or(0.0),
            self.distance_word(block, b'w')?.unwrap_or(0.0),
        ];
        let Some(passes) = block.get(b'r') else {
            return Err(LineFault::new(
                "gcode::lathe",
                word.at(),
                "R (number of passes) is missing for G73",
            )
            .hint("write G73 U5. W2. R4 and then G73 P100 Q200 U0.4 W0.1 F0.25"));
        };
        if !(1.0..=999.0).contains(&passes) || passes.fract() != 0.0 {
            let message = format!("R{} of G73 is no number of passes: 1 to 999", Short(passes));
            return Err(LineFault::new("gcode::lathe", block.at(b'r'), message));
        }
        self.fanuc.repetitive.pattern = Some((shift_mm, passes as u32));
        Ok(())
    }

    /// Asks the reader for the blocks P to Q.
    fn want_profile(&mut self, block: &Block, word: Word, work: ProfileWork) -> Read<()> {
        let mut numbers = [0; 2];
        for (number, letter) in numbers.iter_mut().zip([b'p', b'q']) {
            if !block.has(letter) {
                let name = char::from(letter).to_ascii_uppercase();
                let message = format!(
                    "{name} (number of a block of the profile) is missing for {}",
                    spelled(word.number)
                );
                return Err(LineFault::new("gcode::lathe", word.at(), message)
                    .hint("write P100 Q200 for the blocks N100 to N200"));
            }
            *number = self.integer(block, letter, 1, 99_999_999)? as u64;
        }
        self.fanuc.wanted = Some(Box::new(ProfileBlocks {
            numbers,
            work,
            code: word.number,
            block: block.clone(),
            line: self.line,
            start: self.here,
            modal: self.modal.clone(),
        }));
        Ok(())
    }
}
