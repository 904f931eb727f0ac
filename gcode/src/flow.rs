//! Where the next line comes from: subroutines, branches and loops, in the program and in files of subroutines.
//!
//! A definition is stepped over when the flow meets it and entered by a call. Branches not taken are skipped line by line, looking
//! only for the O-word that ends them, so that nothing of a program has to be kept in memory except the places of its subroutines.

use std::collections::HashMap;
use std::io;
use std::path::PathBuf;

use super::diagnostic::{Fault, Read};
use super::expression::Evaluator;
use super::fanuc::labels::Places;
use super::fanuc::macros;
use super::lexer::Cursor;
use super::owords::{Arguments, Head, Keyword, read_arguments, read_head, read_keyword, read_label, read_rest, shown};
use super::settings::Settings;
use super::source::{Mark, Source};
use super::state::Interpreter;
use super::subroutines::{Frame, Manner, Unit};

/// A loop under way.
#[derive(Debug)]
pub(super) struct Loop {
    label: Vec<u8>,
    kind: Keyword,
    /// The line of its O-word.
    begin: Mark,
    /// The line behind it.
    body: Mark,
    repeats: u64,
}

/// Lines that are passed over.
#[derive(Debug)]
pub(super) struct Skip {
    label: Vec<u8>,
    purpose: Purpose,
    /// The line that began it, for the message when its end is missing.
    line: u32,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Purpose {
    /// A false `if`: up to a true `elseif`, `else`, `endif`.
    Branch,
    /// Behind a branch that was taken: up to `endif`.
    EndOfBranches,
    Definition,
    /// Out of a loop.
    EndOfLoop,
    /// `continue`: to the end of the loop, which is then carried out.
    NextRound,
}

/// Labels of branches and loops that are remembered, far more than anybody writes by hand; what comes then is not checked.
const MOST_LABELS: usize = 100_000;

/// The files of a program, the place in them, and the calls and loops under way.
#[derive(Debug)]
pub(super) struct Flow {
    pub(super) units: Vec<Unit>,
    pub(super) current: usize,
    pub(super) folders: Vec<PathBuf>,
    pub(super) frames: Vec<Frame>,
    pub(super) loops: Vec<Loop>,
    pub(super) skip: Option<Skip>,
    pub(super) max_depth: usize,
    /// Lines of the branches and loops met so far, by file, subroutine and label; and room for such a key.
    labels: HashMap<Vec<u8>, u32>,
    key: Vec<u8>,
    /// Blocks that were looked for by their numbers.
    pub(super) places: Places,
}

impl Flow {
    pub(super) fn new(source: Source, folder: Option<PathBuf>, settings: &Settings) -> Self {
        let folders = folder.into_iter().chain(settings.subroutine_paths.iter().cloned()).collect();
        let unit = Unit { source, path: None, subroutines: None };
        Self {
            units: vec![unit],
            current: 0,
            folders,
            frames: Vec::new(),
            loops: Vec::new(),
            skip: None,
            max_depth: settings.max_depth,
            labels: HashMap::new(),
            key: Vec::new(),
            places: Places::default(),
        }
    }

    /// The file under way.
    #[inline]
    pub(super) fn source(&mut self) -> &mut Source {
        &mut self.units[self.current].source
    }

    /// The file under way.
    pub(super) fn source_ref(&self) -> &Source {
        &self.units[self.current].source
    }

    /// Whether lines are passed over.
    #[inline]
    pub(super) const fn is_skipping(&self) -> bool {
        self.skip.is_some()
    }

    /// What the end of the file leaves open: the line that began it and the message.
    pub(super) fn unfinished(&self) -> Option<(u32, String)> {
        if let Some(skip) = &self.skip {
            if let Some(number) = skip.label.strip_prefix(b"do").filter(|_| skip.purpose == Purpose::EndOfLoop) {
                let number = String::from_utf8_lossy(number);
                return Some((skip.line, format!("DO{number} has no END{number}")));
            }
            let wanted = match skip.purpose {
                Purpose::Branch | Purpose::EndOfBranches => "endif",
                Purpose::Definition => "endsub",
                Purpose::EndOfLoop | Purpose::NextRound => "end of its loop (endwhile, while or endrepeat)",
            };
            return Some((skip.line, format!("{} has no {wanted}", shown(&skip.label))));
        }
        let frame = self.frames.last()?;
        let wanted = if frame.manner == Manner::Rs274 { "endsub" } else { "M99" };
        Some((frame.body.lines_before, format!("the subroutine {} has no {wanted}", shown(&frame.label))))
    }

    /// A line that is passed over: does it end the passing?
    pub(super) fn passed_line(&mut self, range: std::ops::Range<usize>, interpreter: &Interpreter) -> Read<()> {
        let Some((head, arguments)) = self.passed_head(range, interpreter)? else {
            return Ok(());
        };
        let line = self.source_ref().line;
        let Some(skip) = &mut self.skip else {
            return Ok(());
        };
        match (skip.purpose, head.keyword) {
            (Purpose::Branch, Keyword::ElseIf) if arguments.is_some_and(|arguments| arguments.values[0] == 0.0) => {}
            (Purpose::Branch, Keyword::ElseIf | Keyword::Else | Keyword::EndIf)
            | (Purpose::EndOfBranches, Keyword::EndIf)
            | (Purpose::Definition, Keyword::EndSub) => {
                self.skip = None;
            }
            (Purpose::EndOfLoop, Keyword::EndWhile | Keyword::While | Keyword::EndRepeat) => {
                self.skip = None;
            }
            (Purpose::NextRound, Keyword::EndWhile | Keyword::While | Keyword::EndRepeat) => {
                self.skip = None;
                return self.carry_out(&head, arguments, line);
            }
            _ => {}
        }
        Ok(())
    }

    /// The O-word of a passed line, if it has the label looked for; its arguments where they matter.
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
            && let Some(head) = macros::ends_loop(bytes, &skip.label)
        {
            return Ok(Some((head, None)));
        }
        let mut cursor = Cursor::new(bytes);
        if !at_o_word(&mut cursor) {
            return Ok(None);
        }
        let mut evaluator = Evaluator::new(cursor, interpreter);
        // Whatever else is wrong in a passed line does not matter, for it is not carried out; a missing keyword may be that of the
        // line where the passing ends.
        let start = evaluator.cursor.at;
        let Ok(label) = read_label(&mut evaluator) else {
            return Ok(None);
        };
        let keyword = match read_keyword(&mut evaluator.cursor, &label, start) {
            Ok(keyword) => keyword,
            Err(_) if interpreter.dialect.is_fanuc() => return Ok(None),
            Err(fault) => return Err(fault),
        };
        let head = Head { label, keyword, at: start..evaluator.cursor.at };
        if head.label != skip.label {
            if skip.purpose == Purpose::Definition && head.keyword == Keyword::Sub {
                return Err(Fault::new(
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
        let arguments = if evaluates { Some(read_arguments(&mut evaluator, &head)?) } else { None };
        Ok(Some((head, arguments)))
    }

    /// A line that is an O-word: reads it at `at` and carries it out.
    pub(super) fn line(&mut self, range: std::ops::Range<usize>, at: usize, interpreter: &mut Interpreter) -> Read<()> {
        let (head, arguments) = {
            let mut cursor = Cursor::new(self.source_ref().bytes(range));
            cursor.at = at;
            let mut evaluator = Evaluator::new(cursor, &*interpreter);
            let head = read_head(&mut evaluator)?;
            // The condition of an `elseif` behind a taken branch is not evaluated.
            let read = if head.keyword == Keyword::ElseIf {
                Ok(None)
            } else {
                read_arguments(&mut evaluator, &head)
                    .and_then(|arguments| read_rest(&mut evaluator.cursor).map(|()| Some(arguments)))
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
            (Keyword::Return | Keyword::EndSub, Some(arguments)) => self.leave(&head, &arguments, interpreter),
            _ => self.carry_out(&head, arguments, line),
        }
    }

    /// A branch or loop with a faulty condition begins all the same: its end is no fault. The branch is read, the loop passed over.
    #[cold]
    fn begin_anyway(&mut self, head: &Head, line: u32) {
        // Behind one fault, another in the same line is not told.
        let _ = match head.keyword {
            Keyword::If => self.take_label(head, line),
            Keyword::Repeat => self.take_label(head, line).map(|()| self.pass(head, Purpose::EndOfLoop, line)),
            Keyword::While if self.ends_do(head) => self.find_loop(head).map(|_| ()).map(|()| drop(self.loops.pop())),
            Keyword::While => self.take_label(head, line).map(|()| self.pass(head, Purpose::EndOfLoop, line)),
            _ => Ok(()),
        };
    }

    /// Branches and loops.
    fn carry_out(&mut self, head: &Head, arguments: Option<Arguments>, line: u32) -> Read<()> {
        let value = arguments.map_or(0.0, |arguments| arguments.values[0]);
        let is_true = value != 0.0;
        match head.keyword {
            Keyword::Sub | Keyword::If | Keyword::Do | Keyword::Repeat => self.take_label(head, line)?,
            Keyword::While if !self.ends_do(head) => self.take_label(head, line)?,
            Keyword::ElseIf | Keyword::Else | Keyword::EndIf => self.find_label(head)?,
            _ => {}
        }
        match head.keyword {
            Keyword::Number | Keyword::EndIf | Keyword::Call | Keyword::Return | Keyword::EndSub => {}
            Keyword::Sub => {
                if self.frames.last().is_some_and(|frame| frame.manner == Manner::Fanuc && frame.label == head.label) {
                    return Err(Fault::new(
                        "gcode::o_word",
                        head.at.clone(),
                        "a subroutine with `sub` is called by `call`, not by M98",
                    ));
                }
                if !self.frames.is_empty() {
                    return Err(Fault::new(
                        "gcode::o_word",
                        head.at.clone(),
                        "a subroutine is defined inside a subroutine",
                    ));
                }
                self.pass(head, Purpose::Definition, line);
            }
            Keyword::If if !is_true => self.pass(head, Purpose::Branch, line),
            Keyword::If => {}
            Keyword::ElseIf | Keyword::Else => self.pass(head, Purpose::EndOfBranches, line),
            Keyword::While => return self.meet_while(head, is_true, line),
            Keyword::Do => self.begin_loop(head, 0)?,
            Keyword::Repeat if value.round_ties_even() < 1.0 => self.pass(head, Purpose::EndOfLoop, line),
            Keyword::Repeat => self.begin_loop(head, value.round_ties_even() as u64)?,
            Keyword::EndWhile | Keyword::EndRepeat => return self.end_round(head),
            Keyword::Break => {
                self.find_loop(head)?;
                self.loops.pop();
                self.pass(head, Purpose::EndOfLoop, line);
            }
            Keyword::Continue => {
                let turn = self.find_loop(head)?;
                if turn.kind == Keyword::While {
                    return self.end_round(head);
                }
                self.pass(head, Purpose::NextRound, line);
            }
        }
        Ok(())
    }

    fn pass(&mut self, head: &Head, purpose: Purpose, line: u32) {
        self.skip = Some(Skip { label: head.label.clone(), purpose, line });
    }

    /// Passes a loop over whose condition does not hold.
    pub(super) fn pass_loop(&mut self, head: &Head, line: u32) {
        self.pass(head, Purpose::EndOfLoop, line);
    }

    /// A line of the source under way as text.
    pub(super) fn text_of_line(&self, range: std::ops::Range<usize>) -> String {
        String::from_utf8_lossy(self.source_ref().bytes(range).trim_ascii()).into_owned()
    }

    pub(super) fn begin_loop(&mut self, head: &Head, repeats: u64) -> Read<()> {
        let base = self.frames.last().map_or(0, |frame| frame.loops);
        // A loop that was left by a jump ends when it begins anew.
        if let Some(old) = self.loops[base..].iter().position(|turn| turn.label == head.label) {
            self.loops.truncate(base + old);
        }
        if self.loops.len() >= base + self.max_depth {
            return Err(Fault::new(
                "gcode::depth",
                head.at.clone(),
                format!("more than {} loops inside each other", self.max_depth),
            ));
        }
        let source = self.source_ref();
        let (begin, body) = (source.line_start, source.here());
        self.loops.push(Loop { label: head.label.clone(), kind: head.keyword, begin, body, repeats });
        Ok(())
    }

    /// The innermost loop, which must have the label; inner ones that were left behind end.
    fn find_loop(&mut self, head: &Head) -> Read<&mut Loop> {
        let base = self.frames.last().map_or(0, |frame| frame.loops);
        let Some(found) = self.loops[base..].iter().rposition(|turn| turn.label == head.label) else {
            let message = format!("{}: no loop {} is under way here", head.keyword.spelled(), head.shown());
            return Err(Fault::new("gcode::o_word", head.at.clone(), message));
        };
        self.loops.truncate(base + found + 1);
        Ok(&mut self.loops[base + found])
    }

    /// Whether a `while` ends a loop that began with `do`.
    fn ends_do(&self, head: &Head) -> bool {
        let base = self.frames.last().map_or(0, |frame| frame.loops);
        self.loops[base..].iter().any(|turn| turn.label == head.label && turn.kind == Keyword::Do)
    }

    /// A definition is met, or a branch or a loop begins: its label must not be that of another in the same subroutine.
    fn take_label(&mut self, head: &Head, line: u32) -> Read<()> {
        self.label_key(head);
        match self.labels.get(&self.key) {
            Some(&other) if other != line => {
                let message = format!("the label {} is that of line {other} already", head.shown());
                Err(Fault::new("gcode::o_word", head.at.clone(), message)
                    .hint("give every subroutine, branch and loop a number of its own"))
            }
            Some(_) => Ok(()),
            None => {
                if self.labels.len() < MOST_LABELS {
                    self.labels.insert(self.key.clone(), line);
                }
                Ok(())
            }
        }
    }

    /// A branch goes on or ends: it must have begun.
    fn find_label(&mut self, head: &Head) -> Read<()> {
        self.label_key(head);
        if self.labels.contains_key(&self.key) || self.labels.len() == MOST_LABELS {
            return Ok(());
        }
        let message = format!("{}: no `{} if` stands before it", head.keyword.spelled(), head.shown());
        Err(Fault::new("gcode::o_word", head.at.clone(), message))
    }

    fn label_key(&mut self, head: &Head) {
        self.key.clear();
        self.key.extend_from_slice(&self.current.to_le_bytes());
        if let Some(frame) = self.frames.last() {
            self.key.extend_from_slice(&frame.label);
        }
        // A subroutine may share its number with a branch or a loop.
        self.key.push(if head.keyword == Keyword::Sub { b'<' } else { b'>' });
        self.key.extend_from_slice(&head.label);
    }

    /// `while` begins a loop, or ends one that began with `do`.
    fn meet_while(&mut self, head: &Head, is_true: bool, line: u32) -> Read<()> {
        if self.ends_do(head) {
            let body = self.find_loop(head)?.body;
            if is_true {
                return self.jump(body, head);
            }
            self.loops.pop();
            return Ok(());
        }
        if is_true {
            return self.begin_loop(head, 0);
        }
        self.pass(head, Purpose::EndOfLoop, line);
        Ok(())
    }

    /// `endwhile`, `endrepeat`.
    pub(super) fn end_round(&mut self, head: &Head) -> Read<()> {
        let turn = self.find_loop(head)?;
        let ends = match head.keyword {
            Keyword::EndWhile => Keyword::While,
            Keyword::EndRepeat => Keyword::Repeat,
            _ => turn.kind, // `continue` ends any round.
        };
        if turn.kind != ends {
            let (end, kind) = (head.keyword.spelled(), turn.kind.spelled());
            let message = format!("{end} ends no `{} {kind}`", head.shown());
            return Err(Fault::new("gcode::o_word", head.at.clone(), message));
        }
        match turn.kind {
            Keyword::Repeat => {
                turn.repeats -= 1;
                let (repeats, body) = (turn.repeats, turn.body);
                if repeats > 0 {
                    return self.jump(body, head);
                }
                self.loops.pop();
                Ok(())
            }
            _ => {
                let begin = turn.begin;
                self.loops.pop();
                self.jump(begin, head)
            }
        }
    }

    fn jump(&mut self, mark: Mark, head: &Head) -> Read<()> {
        self.source().jump(mark).map_err(|error| cannot_read(head.at.clone(), &error))
    }
}

/// Whether the line is an O-word; steps over its line number.
pub(super) fn at_o_word(cursor: &mut Cursor<'_>) -> bool {
    if cursor.peek() == b'/' {
        cursor.bump();
    }
    if cursor.eat(b'n') && cursor.number().is_err() {
        return false;
    }
    matches!(cursor.peek(), b'o' | b':')
}

#[cold]
pub(super) fn cannot_read(at: std::ops::Range<usize>, error: &io::Error) -> Box<Fault> {
    Fault::new("gcode::read", at, format!("the program cannot be read on: {error}"))
}
