//! Refuses words that no code of the line gives a meaning to.

use crate::settings::Dialect;
use crate::state::Interpreter;
use crate::text::block::Block;
use crate::text::codes::{self, ALWAYS, Group};
use crate::text::diagnostic::{LineFault, Read};
use crate::text::lexer::NO_EXPONENT;

impl Interpreter {
    /// Refuses words that no code of the line gives a meaning to.
    pub(super) fn check_words(&self, block: &Block, motion: Option<u16>) -> Read<()> {
        if let Some(code @ 700..=722) = motion {
            self.check_lathe_words(block, code)?;
        }
        let mut known = ALWAYS;
        if self.dialect == Dialect::Printer {
            known |= codes::bit(b'e');
        }
        for word in &block.g {
            known |= codes::find(word.number).map_or(0, |code| code.letters);
        }
        for word in &block.m {
            known |= self.m_letters(word.number);
        }
        if block.has(b's') {
            known |= codes::bit(b'$');
        }
        if let Some(code) = motion.and_then(codes::find) {
            known |= code.letters;
        }
        let unknown = block.set & !known;
        if unknown == 0 {
            return Ok(());
        }
        let slot = unknown.trailing_zeros() as usize;
        let at = block.at_any(unknown);
        let word = codes::letter(slot);
        if unknown & codes::AXES != 0 {
            return Err(self.axes_without_motion(block, motion));
        }
        let with = motion.map_or_else(|| "this line".to_owned(), codes::spelled);
        let fault = LineFault::new(
            "gcode::unused_word",
            at,
            format!("{word} has no meaning with {with}"),
        );
        Err(match word {
            'E' if block.exponent => fault.hint(NO_EXPONENT),
            'E' => fault.hint("E pushes filament on 3D printers: choose the printer's dialect for its programs"),
            'K' if matches!(motion, Some(810..=890)) => {
                fault.hint("K is how often Fanuc repeats a cycle: LinuxCNC's word is L, or choose --dialect fanuc")
            }
            'I' | 'J' | 'K' => fault.hint("I, J and K are the centre of an arc: write G2 or G3 on this line"),
            'R' if matches!(motion, Some(0 | 10)) => {
                fault.hint("R is the radius of an arc (G2, G3) or a height of a cycle (G81 to G89)")
            }
            _ => fault,
        })
    }

    #[cold]
    pub(super) fn axes_without_motion(&self, block: &Block, motion: Option<u16>) -> Box<LineFault> {
        let at = block.at_any(codes::AXES);
        if motion == Some(800) && block.code(Group::Motion).is_some() {
            return LineFault::new(
                "gcode::no_motion_mode",
                at,
                "G80 ends motion modes and takes no axis words",
            )
            .hint("write G0 or G1 with them on the next line");
        }
        LineFault::new(
            "gcode::no_motion_mode",
            at,
            "axis words, but no code such as G0 or G1 says how to move",
        )
        .hint("write G0, G1, G2 or G3 on this line or one before it")
    }
}
