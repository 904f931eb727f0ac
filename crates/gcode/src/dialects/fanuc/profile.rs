//! The blocks N(P) to N(Q) that G70 to G73 refer to: what they may hold, and the cycle behind them.
//!
//! For G71 to G73 they are read once without being cut: their motions are kept, their other words
//! mean nothing. Then the tool is back where the cycle began, and the cycle cuts. G70 cuts the
//! blocks as they are and goes back to where it began.

use crate::dialects::fanuc::words::PLANE_WORDS;
use crate::motion::feed::Speed;
use crate::state::Interpreter;
use crate::state::capture::{Capture, ProfileWork};
use crate::text::block::Block;
use crate::text::codes::spelled;
use crate::text::diagnostic::{LineFault, Read};

impl Interpreter {
    /// Remembers what the first block of a profile has, and refuses what no profile can have.
    pub(super) fn check_profile_block(&mut self, block: &Block) -> Read<()> {
        let Some(capture) = &mut self.fanuc.capture else {
            return Ok(());
        };
        if capture.motions.is_empty() {
            capture.first_words |= block.set & PLANE_WORDS;
        }
        let Some(word) = block
            .m
            .iter()
            .find(|word| matches!(word.number, 2 | 30 | 97 | 98 | 99))
        else {
            return Ok(());
        };
        let message = format!(
            "M{} stands inside the profile of {}",
            word.number,
            spelled(capture.wanted.code)
        );
        Err(LineFault::new("gcode::lathe", word.at(), message)
            .hint("a profile has G0 to G3 alone, up to its block Q"))
    }

    /// Carries out a cycle whose profile has been read.
    pub(crate) fn cut_own_profile(&mut self, capture: &Capture) -> Read<()> {
        let wanted = &capture.wanted;
        self.line = wanted.line;
        if matches!(wanted.work, ProfileWork::Finish) {
            return self.go(
                &wanted.block,
                self.frame.to_program(&wanted.start),
                Speed::Rapid,
            );
        }
        // Reading the profile has moved the reader, and not the tool.
        self.modal = wanted.modal.clone();
        self.here = wanted.start;
        self.at = self.frame.to_program(&self.here);
        if let Some((line, message)) = capture.fault {
            return Err(capture.refuse(line, message));
        }
        if capture.motions.len() < 2 {
            return Err(capture
                .refuse(wanted.line, "it has no motion behind the one that leads to it")
                .hint("the first block leads from the start of the cycle to the profile, the others are the profile"));
        }
        let cut = match wanted.work {
            ProfileWork::Pattern {
                shift_mm,
                passes,
                allowance_mm,
            } => self.cut_pattern(capture, shift_mm, passes, allowance_mm),
            _ => self.rough_own_profile(capture),
        };
        self.at = self.frame.to_program(&self.here);
        cut
    }
}
