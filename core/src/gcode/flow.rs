//! Where the next line comes from: subroutines, branches and loops, in the program and in files of subroutines.
//!
//! A definition is stepped over when the flow meets it and entered by a call. Branches not taken are skipped line by line, looking
//! only for the O-word that ends them, so that nothing of a program has to be kept in memory except the places of its subroutines.

use std::collections::HashMap;
use std::fs::File;
use std::io;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use super::diagnostic::{Fault, Read};
use super::expression::Evaluator;
use super::lexer::Cursor;
use super::owords::{Arguments, Head, Keyword, read_arguments, read_head, read_rest, shown};
use super::parameters::LOCALS;
use super::settings::Settings;
use super::source::{Line, Mark, Source};
use super::state::Interpreter;

/// Files of subroutines that stay open. A program uses a handful; each may hold a buffer of 256 KiB.
const MOST_FILES: usize = 100;
/// Subroutines that one file may define.
const MOST_SUBROUTINES: usize = 100_000;

/// How a subroutine is written and called.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Manner {
    /// `O1 sub` ... `O1 endsub`, called by `O1 call`.
    Rs274,
    /// `O1` ... `M99`, called by `M98 P1`.
    Fanuc,
}

/// A file with the places of its subroutines, once somebody has asked for one.
#[derive(Debug)]
struct Unit {
    source: Source,
    path: Option<PathBuf>,
    subroutines: Option<HashMap<Vec<u8>, (Manner, Mark)>>,
}

/// A call under way.
#[derive(Debug)]
struct Frame {
    manner: Manner,
    label: Vec<u8>,
    /// File and line to return to.
    unit: usize,
    back: Mark,
    /// First line of the subroutine and the calls that remain (L of M98).
    body: Mark,
    repeats: u32,
    /// `#1`-`#30` of the caller.
    saved: [f64; LOCALS],
    /// Loops of the caller.
    loops: usize,
}

/// A loop under way.
#[derive(Debug)]
struct Loop {
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
struct Skip {
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

/// The files of a program, the place in them, and the calls and loops under way.
#[derive(Debug)]
pub(super) struct Flow {
    units: Vec<Unit>,
    current: usize,
    folders: Vec<PathBuf>,
    frames: Vec<Frame>,
    loops: Vec<Loop>,
    skip: Option<Skip>,
    max_depth: usize,
}

impl Flow {
    pub(super) fn new(source: Source, folder: Option<PathBuf>, settings: &Settings) -> Self {
        let folders = folder
            .into_iter()
            .chain(settings.subroutine_paths.iter().cloned())
            .collect();
        let unit = Unit {
            source,
            path: None,
            subroutines: None,
        };
        Self {
            units: vec![unit],
            current: 0,
            folders,
            frames: Vec::new(),
            loops: Vec::new(),
            skip: None,
            max_depth: settings.max_depth,
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
        let wanted = if frame.manner == Manner::Fanuc {
            "M99"
        } else {
            "endsub"
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
        let mut cursor = Cursor::new(self.source_ref().bytes(range));
        if !at_o_word(&mut cursor) {
            return Ok(None);
        }
        let mut evaluator = Evaluator::new(cursor, interpreter);
        // Whatever else is wrong in a passed line does not matter: it is not carried out.
        let Ok(head) = read_head(&mut evaluator) else {
            return Ok(None);
        };
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
            let arguments = if head.keyword == Keyword::ElseIf {
                None
            } else {
                Some(read_arguments(&mut evaluator, &head)?)
            };
            if arguments.is_some() {
                read_rest(&mut evaluator.cursor)?;
            }
            (head, arguments)
        };
        let line = self.source_ref().line;
        match (head.keyword, arguments) {
            (Keyword::Call, Some(arguments)) => self.call(&head, &arguments, interpreter),
            (Keyword::Return | Keyword::EndSub, Some(arguments)) => {
                self.leave(&head, &arguments, interpreter)
            }
            _ => self.carry_out(&head, arguments, line),
        }
    }

    /// Branches and loops.
    fn carry_out(&mut self, head: &Head, arguments: Option<Arguments>, line: u32) -> Read<()> {
        let value = arguments.map_or(0.0, |arguments| arguments.values[0]);
        let is_true = value != 0.0;
        match head.keyword {
            Keyword::Number
            | Keyword::EndIf
            | Keyword::Call
            | Keyword::Return
            | Keyword::EndSub => {}
            Keyword::Sub => {
                if self
                    .frames
                    .last()
                    .is_some_and(|frame| frame.manner == Manner::Fanuc && frame.label == head.label)
                {
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
            Keyword::Repeat if value < 0.5 => self.pass(head, Purpose::EndOfLoop, line),
            Keyword::Repeat => self.begin_loop(head, value.round() as u64)?,
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
        self.skip = Some(Skip {
            label: head.label.clone(),
            purpose,
            line,
        });
    }

    fn begin_loop(&mut self, head: &Head, repeats: u64) -> Read<()> {
        let base = self.frames.last().map_or(0, |frame| frame.loops);
        // A loop that was left by a jump ends when it begins anew.
        if let Some(old) = self.loops[base..]
            .iter()
            .position(|turn| turn.label == head.label)
        {
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
        self.loops.push(Loop {
            label: head.label.clone(),
            kind: head.keyword,
            begin,
            body,
            repeats,
        });
        Ok(())
    }

    /// The innermost loop, which must have the label; inner ones that were left behind end.
    fn find_loop(&mut self, head: &Head) -> Read<&mut Loop> {
        let base = self.frames.last().map_or(0, |frame| frame.loops);
        let Some(found) = self.loops[base..]
            .iter()
            .rposition(|turn| turn.label == head.label)
        else {
            let message = format!(
                "{}: no loop {} is under way here",
                head.keyword.spelled(),
                head.shown()
            );
            return Err(Fault::new("gcode::o_word", head.at.clone(), message));
        };
        self.loops.truncate(base + found + 1);
        Ok(&mut self.loops[base + found])
    }

    /// `while` begins a loop, or ends one that began with `do`.
    fn meet_while(&mut self, head: &Head, is_true: bool, line: u32) -> Read<()> {
        let base = self.frames.last().map_or(0, |frame| frame.loops);
        let ends_do = self.loops[base..]
            .iter()
            .any(|turn| turn.label == head.label && turn.kind == Keyword::Do);
        if ends_do {
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
    fn end_round(&mut self, head: &Head) -> Read<()> {
        let turn = self.find_loop(head)?;
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
        self.source()
            .jump(mark)
            .map_err(|error| cannot_read(head.at.clone(), &error))
    }

    /// `O1 call [..]`.
    fn call(
        &mut self,
        head: &Head,
        arguments: &Arguments,
        interpreter: &mut Interpreter,
    ) -> Read<()> {
        let (unit, manner, body) = self.find_subroutine(&head.label, &head.at)?;
        if manner == Manner::Fanuc {
            let number = String::from_utf8_lossy(&head.label).into_owned();
            return Err(Fault::new(
                "gcode::o_word",
                head.at.clone(),
                format!("{} has no `sub`: it is called by M98", head.shown()),
            )
            .hint(format!("write M98 P{number}")));
        }
        self.check_depth(&head.at)?;
        let saved = interpreter.parameters.enter(arguments.values);
        self.enter(
            Frame {
                manner,
                label: head.label.clone(),
                unit: self.current,
                back: self.source_ref().here(),
                body,
                repeats: 0,
                saved,
                loops: self.loops.len(),
            },
            unit,
            &head.at,
        )
        .inspect_err(|_| interpreter.parameters.leave(saved))?;
        interpreter.entered(self.frames.len());
        Ok(())
    }

    /// `M98 P1 L2`.
    pub(super) fn call_number(
        &mut self,
        number: u64,
        times: u32,
        at: &std::ops::Range<usize>,
        interpreter: &mut Interpreter,
    ) -> Read<()> {
        if times == 0 {
            return Ok(());
        }
        let label = number.to_string().into_bytes();
        let (unit, manner, body) = self.find_subroutine(&label, at)?;
        if manner == Manner::Rs274 {
            return Err(Fault::new(
                "gcode::o_word",
                at.clone(),
                format!(
                    "{} has `sub`: it is called by `{} call`, not by M98",
                    shown(&label),
                    shown(&label)
                ),
            ));
        }
        self.check_depth(at)?;
        let frame = Frame {
            manner,
            label,
            unit: self.current,
            back: self.source_ref().here(),
            body,
            repeats: times - 1,
            saved: [0.0; LOCALS],
            loops: self.loops.len(),
        };
        self.enter(frame, unit, at)?;
        interpreter.entered(self.frames.len());
        Ok(())
    }

    fn enter(&mut self, frame: Frame, unit: usize, at: &std::ops::Range<usize>) -> Read<()> {
        self.units[unit]
            .source
            .jump(frame.body)
            .map_err(|error| cannot_read(at.clone(), &error))?;
        self.current = unit;
        self.frames.push(frame);
        Ok(())
    }

    fn check_depth(&self, at: &std::ops::Range<usize>) -> Read<()> {
        if self.frames.len() < self.max_depth {
            return Ok(());
        }
        Err(Fault::new(
            "gcode::depth",
            at.clone(),
            format!(
                "more than {} subroutine calls inside each other",
                self.max_depth
            ),
        )
        .hint("does a subroutine call itself?"))
    }

    /// `endsub`, `return`.
    fn leave(
        &mut self,
        head: &Head,
        arguments: &Arguments,
        interpreter: &mut Interpreter,
    ) -> Read<()> {
        let fault = |message: &str| Err(Fault::new("gcode::o_word", head.at.clone(), message));
        match self.frames.last() {
            None => return fault("this is not inside a subroutine"),
            Some(frame) if frame.manner == Manner::Fanuc => {
                return fault("a subroutine called by M98 ends with M99");
            }
            Some(frame) if head.keyword == Keyword::EndSub && frame.label != head.label => {
                return Err(Fault::new(
                    "gcode::o_word",
                    head.at.clone(),
                    format!("endsub of {} ends {}", head.shown(), shown(&frame.label)),
                ));
            }
            Some(_) => {}
        }
        self.pop_frame(&head.at, interpreter)?;
        interpreter.returned = (arguments.count > 0).then_some(arguments.values[0]);
        Ok(())
    }

    /// M99: returns true where there is nothing to return from.
    pub(super) fn return_number(
        &mut self,
        at: &std::ops::Range<usize>,
        interpreter: &mut Interpreter,
    ) -> Read<bool> {
        let Some(frame) = self.frames.last_mut() else {
            return Ok(true);
        };
        if frame.manner == Manner::Rs274 {
            return Err(Fault::new(
                "gcode::o_word",
                at.clone(),
                "a subroutine with `sub` ends with `endsub` or `return`, not with M99",
            ));
        }
        if frame.repeats > 0 {
            frame.repeats -= 1;
            let body = frame.body;
            self.source()
                .jump(body)
                .map_err(|error| cannot_read(at.clone(), &error))?;
            return Ok(false);
        }
        self.pop_frame(at, interpreter)?;
        Ok(false)
    }

    fn pop_frame(
        &mut self,
        at: &std::ops::Range<usize>,
        interpreter: &mut Interpreter,
    ) -> Read<()> {
        let Some(frame) = self.frames.pop() else {
            return Ok(());
        };
        if frame.manner == Manner::Rs274 {
            interpreter.parameters.leave(frame.saved);
        }
        self.loops.truncate(frame.loops);
        interpreter.left(self.frames.len());
        self.current = frame.unit;
        self.source()
            .jump(frame.back)
            .map_err(|error| cannot_read(at.clone(), &error))
    }

    /// File, manner and first line of a subroutine: in the file under way, in the program, in a file of its name.
    fn find_subroutine(
        &mut self,
        label: &[u8],
        at: &std::ops::Range<usize>,
    ) -> Read<(usize, Manner, Mark)> {
        for unit in [self.current, 0] {
            if let Some((manner, mark)) = self.index(unit, at)?.get(label).copied() {
                return Ok((unit, manner, mark));
            }
        }
        let name = format!("{}.ngc", String::from_utf8_lossy(label));
        let is_plain = Path::new(&name).components().count() == 1 && !name.starts_with('.');
        let path = is_plain
            .then(|| {
                self.folders
                    .iter()
                    .map(|folder| folder.join(&name))
                    .find(|path| path.is_file())
            })
            .flatten();
        let Some(path) = path else {
            let fault = Fault::new(
                "gcode::o_word",
                at.clone(),
                format!("the subroutine {} is defined nowhere", shown(label)),
            );
            return Err(fault.hint(format!(
                "define it in this program, or put {name} into a folder of subroutines"
            )));
        };
        let unit = self.open(&path, at)?;
        match self.index(unit, at)?.get(label).copied() {
            Some((manner, mark)) => Ok((unit, manner, mark)),
            None => Err(Fault::new(
                "gcode::o_word",
                at.clone(),
                format!("{} does not define {}", path.display(), shown(label)),
            )),
        }
    }

    fn open(&mut self, path: &Path, at: &std::ops::Range<usize>) -> Read<usize> {
        if let Some(unit) = self
            .units
            .iter()
            .position(|unit| unit.path.as_deref() == Some(path))
        {
            return Ok(unit);
        }
        if self.units.len() > MOST_FILES {
            return Err(Fault::new(
                "gcode::o_word",
                at.clone(),
                format!("more than {MOST_FILES} files of subroutines"),
            ));
        }
        let name: Arc<str> = path.display().to_string().into();
        let source = File::open(path)
            .and_then(|file| Source::from_file(name, file))
            .map_err(|error| cannot_read(at.clone(), &error))?;
        self.units.push(Unit {
            source,
            path: Some(path.to_owned()),
            subroutines: None,
        });
        Ok(self.units.len() - 1)
    }

    /// The subroutines of a file, found by one pass over it at the first call.
    fn index(
        &mut self,
        unit: usize,
        at: &std::ops::Range<usize>,
    ) -> Read<&HashMap<Vec<u8>, (Manner, Mark)>> {
        let unit = &mut self.units[unit];
        if unit.subroutines.is_none() {
            let here = unit.source.here();
            let line_start = unit.source.line_start;
            let found = find_definitions(&mut unit.source)
                .and_then(|found| unit.source.jump(here).map(|()| found));
            unit.source.line_start = line_start;
            unit.subroutines = Some(found.map_err(|error| cannot_read(at.clone(), &error))?);
        }
        unit.subroutines.as_ref().ok_or_else(|| {
            Fault::new(
                "gcode::o_word",
                at.clone(),
                "the subroutines cannot be found",
            )
        })
    }
}

/// Definitions of subroutines in a file; the first of a label counts.
fn find_definitions(source: &mut Source) -> io::Result<HashMap<Vec<u8>, (Manner, Mark)>> {
    struct NoValues;
    impl super::expression::Values for NoValues {
        fn numbered(&self, _index: usize) -> f64 {
            0.0
        }

        fn named(&self, _name: &[u8]) -> Option<f64> {
            None
        }
    }
    let mut found = HashMap::new();
    source.rewind()?;
    loop {
        let range = match source.next_line()? {
            Line::End => return Ok(found),
            Line::TooLong(_) => continue,
            Line::Text(range) => range,
        };
        let mut cursor = Cursor::new(source.bytes(range));
        if !at_o_word(&mut cursor) {
            continue;
        }
        let Ok(head) = read_head(&mut Evaluator::new(cursor, &NoValues)) else {
            continue;
        };
        let manner = match head.keyword {
            Keyword::Sub => Manner::Rs274,
            Keyword::Number => Manner::Fanuc,
            _ => continue,
        };
        if found.len() < MOST_SUBROUTINES {
            found.entry(head.label).or_insert((manner, source.here()));
        }
    }
}

/// Whether the line is an O-word; steps over its line number.
fn at_o_word(cursor: &mut Cursor<'_>) -> bool {
    if cursor.peek() == b'/' {
        cursor.bump();
    }
    if cursor.eat(b'n') && cursor.number().is_err() {
        return false;
    }
    cursor.peek() == b'o'
}

#[cold]
fn cannot_read(at: std::ops::Range<usize>, error: &io::Error) -> Box<Fault> {
    Fault::new(
        "gcode::read",
        at,
        format!("the program cannot be read on: {error}"),
    )
}
