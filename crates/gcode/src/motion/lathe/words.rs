//! Words that only a profile has: steps by U and W, corners by A (rounded) and C (cut straight).

use crate::state::Interpreter;
use crate::state::lathe::CornerCut;
use crate::text::block::Block;
use crate::text::codes::{Group, bit, spelled};
use crate::text::diagnostic::{LineFault, Read};

impl Interpreter {
    /// Refuses the cycles of Fanuc and Haas by name: the same codes, whose P and Q are the first
    /// and the last block of the profile.
    #[cold]
    pub(crate) fn check_lathe_words(&self, block: &Block, code: u16) -> Read<()> {
        let theirs = block.has(b'u') || block.has(b'w') || (block.has(b'p') && code != 700);
        if !theirs && !self.dialect.is_fanuc() {
            return Ok(());
        }
        let at = block
            .code(Group::Motion)
            .map_or(block.whole(), |word| word.at());
        let message = format!(
            "{} of Fanuc and Haas (P and Q are blocks, U and W allowances) is a cycle of their lathes",
            spelled(code)
        );
        Err(LineFault::new("gcode::unsupported", at, message).hint(
            "--dialect fanuc-lathe or haas-lathe reads it; Q of LinuxCNC's cycle names a subroutine with the profile",
        ))
    }

    /// Keeps the corner word of a motion inside a profile; it belongs to the corner behind the
    /// motion.
    #[cold]
    pub(crate) fn corner_word(&mut self, block: &Block) -> Read<()> {
        let corner = self.corner_of(block)?;
        if let Some(lathe) = &mut self.lathe {
            lathe.corner = corner;
        }
        Ok(())
    }

    fn corner_of(&self, block: &Block) -> Read<Option<CornerCut>> {
        let refuse = |at, message: String| LineFault::new("gcode::lathe", at, message);
        if block.has(b'a') && block.has(b'c') {
            let message =
                "A and C in one block of a profile: a corner is rounded by A or cut straight by C"
                    .to_owned();
            return Err(
                refuse(block.at_any(bit(b'a') | bit(b'c')), message).hint("write one of the two")
            );
        }
        let letter = if block.has(b'a') { b'a' } else { b'c' };
        let Some(value) = block.get(letter) else {
            return Ok(None);
        };
        if block.code(Group::NonModal).is_some() {
            let message =
                "a block of a profile with a corner has no other codes than G0 to G3".to_owned();
            return Err(refuse(block.at(letter), message));
        }
        // Along Z, a length is one in diameter mode, too.
        let radius_mm = self.length(block, letter, 2, value)?.abs();
        Ok((radius_mm > 0.0).then_some(CornerCut {
            radius_mm,
            is_round: letter == b'a',
        }))
    }
}
