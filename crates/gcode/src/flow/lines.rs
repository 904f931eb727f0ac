//! Lines with O-words, and lines that are passed over, which are looked at only for the O-word that
//! ends the passing.

use crate::flow::owords::{
    Arguments, Head, Keyword, at_o_word, read_arguments, read_head, read_keyword, read_label,
    read_rest, shown,
};
use crate::flow::program::{Flow, Purpose, SubroutineKind};
use crate::flow::statements::ends_loop;
use crate::state::Interpreter;
use crate::text::diagnostic::{LineFault, Read};
use crate::text::expression::Evaluator;
use crate::text::lexer::Cursor;

impl Flow {
    /// Returns what is still open at the end of the file: the line that began it and the message.
    pub(super) fn unfinished(&self) -> Option<(u32, String)> {
        if let Some(skip) = &self.skip {
            if let Some(number) = skip
                .label
                .strip_prefix(b"do")
                .filter(|_| skip.purpose == Purpose::EndOfLoop)
            {
                let number = String::from_utf8_lossy(number);
                return Some((skip.line, format!("DO{number} has no END{number}")));
            }
            let wanted = match skip.purpose {
                Purpose::Branch | Purpose::EndOfBranches => "endif",
                Purpose::Definition => "endsub",
                Purpose::EndOfLoop | Purpose::NextRound => {
                    "end of its loop (endwhile, while or endrepeat)"
                }
            };
            return Some((skip.line, format!("{} has no {wanted}", shown(&skip.label))));
        }
        let frame = self.frames.last()?;
        let wanted = if frame.kind == SubroutineKind::Rs274 {
            "endsub"
        } else {
            "M99"
        };
        Some((
            frame.body.lines_before,
            format!("the subroutine {} has no {wanted}", shown(&frame.label)),
        ))
    }

    /// A line that is passed over: does it end the passing?
    pub(super) fn passed_line(
        &mut self,
        range: std::ops::Range<usize>,
        interpreter: &Interpreter,
    ) -> Read<()> {
        let Some((head, arguments)) = self.passed_head(range, interpreter)? else {
            return Ok(());
        };
        let line = self.source_ref().line;
        let Some(skip) = &mut self.skip else {
            return Ok(());
        };
        match (skip.purpose, head.keyword) {
            (Purpose::Branch, Keyword::ElseIf)
                if arguments.is_some_and(|arguments| arguments.values[0] == 0.0) => {}
            (Purpose::Branch, Keyword::ElseIf | Keyword::Else | Keyword::EndIf)
            | (Purpose::EndOfBranches, Keyword::EndIf)
            | (Purpose::Definition, Keyword::EndSub) => {
                self.skip = None;
            }
            (Purpose::EndOfLoop, Keyword::EndWhile | Keyword::EndRepeat) => self.skip = None,
            // The end of a do: LinuxCNC forgets its `break`.
            (Purpose::EndOfLoop, Keyword::While) => (self.skip, self.broke) = (None, None),
            (Purpose::EndOfLoop | Purpose::NextRound, Keyword::Break) => self.broke = Some(line),
            (Purpose::NextRound, Keyword::EndWhile | Keyword::While | Keyword::EndRepeat) => {
                self.skip = None;
                return self.carry_out(&head, arguments, line);
            }
            _ => {}
        }
        Ok(())
    }

    /// The O-word of a passed line, if it has the label looked for; its arguments where they
    /// matter.
    fn passed_head(
        &self,
        range: std::ops::Range<usize>,
        interpreter: &Interpreter,
    ) -> Read<Option<(Head, Option<Arguments>)>> {
        let Some(skip) = &self.skip else {
            return Ok(None);
        };
        let bytes = self.source_ref().bytes(range);
        if interpreter.dialect.is_fanuc()
            && let Some(head) = ends_loop(bytes, &skip.label)
        {
            return Ok(Some((head, None)));
        }
        let mut cursor = Cursor::new(bytes);
        if !at_o_word(&mut cursor) {
            return Ok(None);
        }
        let mut evaluator = Evaluator::new(cursor, interpreter);
        // A passed line is not executed, so other faults in it do not matter. A missing keyword
        // does: this line may be the one where the passing ends.
        let start = evaluator.cursor.at;
        let Ok(label) = read_label(&mut evaluator) else {
            return Ok(None);
        };
        let keyword = match read_keyword(&mut evaluator.cursor, &label, start) {
            Ok(keyword) => keyword,
            Err(_) if interpreter.dialect.is_fanuc() => return Ok(None),
            Err(fault) => return Err(fault),
        };
        let head = Head {
            label,
            keyword,
            at: start..evaluator.cursor.at,
        };
        if head.label != skip.label {
            if skip.purpose == Purpose::Definition && head.keyword == Keyword::Sub {
                return Err(LineFault::new(
                    "gcode::o_word",
                    head.at,
                    format!("a subroutine is defined inside {}", shown(&skip.label)),
                ));
            }
            return Ok(None);
        }
        let evaluates = matches!(
            (skip.purpose, head.keyword),
            (Purpose::Branch, Keyword::ElseIf) | (Purpose::NextRound, Keyword::While)
        );
        let arguments = if evaluates {
            Some(read_arguments(&mut evaluator, &head)?)
        } else {
            None
        };
        Ok(Some((head, arguments)))
    }

    /// A line that is an O-word: reads it at `at` and carries it out.
    pub(super) fn line(
        &mut self,
        range: std::ops::Range<usize>,
        at: usize,
        interpreter: &mut Interpreter,
    ) -> Read<()> {
        let (head, arguments) = {
            let mut cursor = Cursor::new(self.source_ref().bytes(range));
            cursor.at = at;
            let mut evaluator = Evaluator::new(cursor, &*interpreter);
            let head = read_head(&mut evaluator)?;
            // The condition of an `elseif` behind a taken branch is not evaluated.
            let read = if head.keyword == Keyword::ElseIf {
                Ok(None)
            } else {
                read_arguments(&mut evaluator, &head).and_then(|arguments| {
                    read_rest(&mut evaluator.cursor).map(|()| Some(arguments))
                })
            };
            (head, read)
        };
        let line = self.source_ref().line;
        let arguments = match arguments {
            Ok(arguments) => arguments,
            Err(fault) => {
                self.begin_anyway(&head, line);
                return Err(fault);
            }
        };
        match (head.keyword, arguments) {
            (Keyword::Call, Some(arguments)) => self.call(&head, &arguments, interpreter),
            (Keyword::Return | Keyword::EndSub, Some(arguments)) => {
                self.leave(&head, &arguments, interpreter)
            }
            _ => self.carry_out(&head, arguments, line),
        }
    }
}
