//! Blocks by their numbers: `N100` of a jump, a profile or M97, in the program or subprogram under
//! way.

use std::ops::Range;

use crate::flow::program::{Flow, Found, cannot_read};
use crate::text::diagnostic::Read;
use crate::text::lexer::Cursor;
use crate::text::source::{Mark, SourceLine};

/// Places that are remembered; a program that jumps to more begins anew.
const MAX_PLACES: usize = 100_000;

impl Flow {
    /// The line with the number `N`: the next from here on in the program or subprogram under way,
    /// or else its first.
    pub(super) fn find_block(&mut self, number: u64, at: &Range<usize>) -> Read<Option<Mark>> {
        self.find_blocks(number, at)
            .map(|found| found.behind.or(found.before))
    }

    /// The first lines with a number before here and from here on, in the program or subprogram
    /// under way.
    pub(super) fn find_blocks(&mut self, number: u64, at: &Range<usize>) -> Read<Found> {
        let (here, line_start) = (self.source_ref().here(), self.source_ref().line_start);
        let key = (self.current, here.offset, number);
        if let Some(&found) = self.places.0.get(&key) {
            return Ok(found);
        }
        let found = self.scan(number, here.offset);
        self.jump_to(here, at)?;
        self.source().line_start = line_start;
        let found = found.map_err(|error| cannot_read(at.clone(), &error))?;
        if self.places.0.len() >= MAX_PLACES {
            self.places.0.clear();
        }
        self.places.0.insert(key, found);
        Ok(found)
    }

    fn scan(&mut self, number: u64, here: u64) -> std::io::Result<Found> {
        let source = self.source();
        source.rewind()?;
        let mut found = Found::default();
        loop {
            let range = match source.next_line()? {
                SourceLine::End => return Ok(found),
                SourceLine::TooLong(_) => continue,
                SourceLine::Text(range) => range,
            };
            let begin = source.line_start;
            match Label::of(source.bytes(range)) {
                // Another program begins.
                Label::Program if begin.offset < here => found = Found::default(),
                Label::Program => return Ok(found),
                Label::Block(label) if label == number && begin.offset >= here => {
                    return Ok(Found {
                        behind: Some(begin),
                        ..found
                    });
                }
                Label::Block(label) if label == number => {
                    found.before = found.before.or(Some(begin));
                }
                _ => {}
            }
        }
    }
}

/// Label at the beginning of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Label {
    Program,
    Block(u64),
    Nothing,
}

impl Label {
    pub(super) fn of(line: &[u8]) -> Self {
        let mut cursor = Cursor::new(line);
        if cursor.eat(b'/') && cursor.raw().is_ascii_digit() {
            cursor.bump();
        }
        match cursor.peek() {
            b'o' | b':' => Self::Program,
            b'n' => {
                cursor.bump();
                cursor.number().map_or(Self::Nothing, |number| {
                    Self::Block(number.round().max(0.0) as u64)
                })
            }
            _ => Self::Nothing,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn labels_stand_first() {
        assert_eq!(Label::of(b"N100 G1 X5"), Label::Block(100));
        assert_eq!(Label::of(b"/2 N0100G1"), Label::Block(100));
        assert_eq!(Label::of(b" :1000"), Label::Program);
        assert_eq!(Label::of(b"O1000 (PART)"), Label::Program);
        assert_eq!(Label::of(b"G1 X5 (N100)"), Label::Nothing);
    }
}
