//! To the first block of a profile of Fanuc's lathe cycles, and behind its last one.

use crate::flow::program::{Flow, cannot_read};
use crate::state::Interpreter;
use crate::state::capture::{Capture, ProfileBlocks, ProfileWork};
use crate::text::codes::spelled;
use crate::text::diagnostic::{LineFault, Read};
use crate::text::lexer::{Cursor, END};
use crate::text::source::SourceLine;

impl Flow {
    /// Goes to the first block of the profile that a cycle wants.
    pub(super) fn begin_own_profile(
        &mut self,
        wanted: ProfileBlocks,
        interpreter: &mut Interpreter,
    ) -> Read<()> {
        let [first, last] = wanted.numbers;
        let at = wanted.block.at(b'p');
        let missing = |letter: char, number: u64| {
            let message = format!("{letter}{number}: there is no block N{number} in this program");
            LineFault::new(
                "gcode::lathe",
                wanted.block.at(letter.to_ascii_lowercase() as u8),
                message,
            )
            .hint("P and Q are the numbers N of the first and the last block of the profile")
        };
        let (mark, here) = (self.source_ref().line_start, self.source_ref().here());
        let found = self.find_blocks(first, &at)?;
        if let (Some(before), Some(behind)) = (found.before, found.behind) {
            let [one, other] = [before, behind].map(|mark| mark.lines_before + 1);
            let message = format!(
                "P{first} is on line {one} and on line {other}: which of them is meant differs between controls"
            );
            return Err(LineFault::new("gcode::lathe", at, message)
                .hint("give the blocks of every profile numbers of their own"));
        }
        let begin = found
            .behind
            .or(found.before)
            .ok_or_else(|| missing('P', first))?;
        self.jump_to(begin, &at)?;
        let end = self.find_block(last, &at);
        self.jump_to(here, &at)?;
        let end = end?.ok_or_else(|| missing('Q', last))?;
        if end.offset < begin.offset {
            let message = format!(
                "Q{last} (line {}) stands before P{first} (line {})",
                end.lines_before + 1,
                begin.lines_before + 1
            );
            return Err(LineFault::new(
                "gcode::lathe",
                wanted.block.at(b'q'),
                message,
            ));
        }
        let is_finish = matches!(wanted.work, ProfileWork::Finish);
        let is_behind = begin.offset >= here.offset;
        if is_behind && !is_finish && self.next_code_line(&at)? != Some(begin.lines_before) {
            let message = format!(
                "there are blocks between {} and its profile, which begins with N{first}",
                spelled(wanted.code)
            );
            return Err(LineFault::new("gcode::lathe", at, message)
                .hint("the profile stands right behind its first cycle"));
        }
        self.jump_to(begin, &at)?;
        let back = (is_finish || !is_behind).then_some(here);
        interpreter.fanuc.capture = Some(Box::new(Capture {
            wanted,
            motions: Vec::new(),
            first_words: 0,
            mark,
            back,
            fault: None,
        }));
        Ok(())
    }

    /// The last block of the profile has been read: carries the cycle out. Faults are those of the
    /// cycle's line.
    pub(super) fn end_own_profile(
        &mut self,
        capture: &Capture,
        interpreter: &mut Interpreter,
    ) -> Read<()> {
        if let Some(back) = capture.back {
            self.jump_to(back, &capture.wanted.block.at(b'p'))?;
        }
        self.source().line_start = capture.mark;
        interpreter.cut_own_profile(capture)
    }

    /// Number of the line before the next one that is neither blank nor a comment; stays where it
    /// is.
    fn next_code_line(&mut self, at: &std::ops::Range<usize>) -> Read<Option<u32>> {
        let (here, line_start) = (self.source_ref().here(), self.source_ref().line_start);
        let found = loop {
            let range = match self
                .source()
                .next_line()
                .map_err(|error| cannot_read(at.clone(), &error))?
            {
                SourceLine::End => break None,
                SourceLine::TooLong(range) | SourceLine::Text(range) => range,
            };
            let mut cursor = Cursor::new(self.source_ref().bytes(range));
            if !matches!(cursor.peek(), END | b'(' | b';') {
                break Some(self.source_ref().line - 1);
            }
        };
        self.jump_to(here, at)?;
        self.source().line_start = line_start;
        Ok(found)
    }
}
