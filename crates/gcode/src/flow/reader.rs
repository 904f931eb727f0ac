//! A program as an iterator of canonical steps, line by line.

mod plain;
mod calls;

use std::fs;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use crate::canon::{Canon, EventKind};
use crate::dialects::choice;
use crate::dialects::firmware;
use crate::flow::faults::Faults;
use crate::flow::program::Flow;
use crate::flow::statements::statement;
use crate::settings::{Dialect, Settings};
use crate::state::Interpreter;
use crate::state::in_force::ModesInForce;
use crate::text::block::{Block, Style};
use crate::text::codes::Group;
use crate::text::codes::fanuc::{CodeSet, OWN};
use crate::text::diagnostic::{Diagnostic, LineFault, Read, Severity};
use crate::text::input;
use crate::text::lexer::{Cursor, END};
use crate::text::read_error::ReadError;
use crate::text::source::{MAX_LINE_BYTES, Source, SourceLine};

/// Reads a program and hands out its canonical steps as it goes; memory does not grow with the
/// program.
///
/// After a fault the reader goes on with the next line, so that one run shows all faults.
#[derive(Debug)]
pub struct Reader {
    flow: Flow,
    interpreter: Interpreter,
    block: Block,
    style: Style,
    warnings: Vec<Diagnostic>,
    faults: Faults,
    idle_lines: u64,
    motions_seen: u64,
    lines: u64,
    percent: Percent,
    state: ReaderState,
    dialect_reason: &'static str,
}

/// Position of the reader relative to the `%` lines.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Percent {
    /// Nothing but comments so far.
    NotSeen,
    /// The program began with `%` and must end with one.
    Open,
    /// The program began without.
    Absent,
}

/// Faults that a refused motion before them may be the reason of: the position or the mode is not
/// what it was meant to be.
const FOLLOWING: [&str; 4] = [
    "gcode::arc_radius",
    "gcode::no_motion_mode",
    "gcode::compensation",
    "gcode::cycle",
];

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum ReaderState {
    Running,
    Done,
}

impl Reader {
    /// Opens the program in a file.
    ///
    /// # Errors
    /// A file that cannot be read or is no G-code program.
    pub fn open(path: &Path, settings: Settings) -> Result<Self, ReadError> {
        let io_error = |cause| ReadError::Io {
            path: path.to_owned(),
            cause,
        };
        let name: Arc<str> = input::name(path).into();
        if input::is_standard_input(path) {
            let source = Source::from_text(name, input::read(path).map_err(io_error)?);
            return Self::new(source, None, settings);
        }
        if fs::metadata(path).map_err(io_error)?.is_dir() {
            return Err(ReadError::Directory {
                path: path.to_owned(),
            });
        }
        let source =
            Source::from_file(name, fs::File::open(path).map_err(io_error)?).map_err(io_error)?;
        Self::new(source, path.parent().map(Path::to_owned), settings)
    }

    /// Reads the program in `text`; `name` stands for the file in messages.
    ///
    /// # Errors
    /// Text that is no G-code program.
    pub fn from_text(
        name: &str,
        text: impl Into<Vec<u8>>,
        settings: Settings,
    ) -> Result<Self, ReadError> {
        Self::new(Source::from_text(name.into(), text.into()), None, settings)
    }

    fn new(source: Source, folder: Option<PathBuf>, settings: Settings) -> Result<Self, ReadError> {
        let choice = choice::choose(source.head(), &source.name, settings.dialect)?;
        let dialect = choice.dialect;
        let warning = choice.warning.map(|(line, message)| {
            let mut warning = Diagnostic::of_file(
                Severity::Warning,
                "gcode::machine",
                source.name.clone(),
                message,
            );
            warning.line = line;
            warning.hint = Some(
                "--dialect fanuc-mill, fanuc-lathe, haas-lathe or linuxcnc says which".to_owned(),
            );
            warning
        });
        let codes = match dialect {
            _ if dialect.is_lathe() => CodeSet::Lathe,
            _ if dialect.is_fanuc() => CodeSet::Mill,
            _ => CodeSet::Rs274,
        };
        Ok(Self {
            flow: Flow::new(source, folder, &settings),
            interpreter: Interpreter::new(settings, dialect),
            block: Block::new(),
            style: Style {
                printer: dialect == Dialect::Printer,
                points: dialect.is_fanuc(),
                codes,
            },
            warnings: warning.into_iter().collect(),
            faults: Faults::default(),
            idle_lines: 0,
            motions_seen: 0,
            lines: 0,
            percent: Percent::NotSeen,
            state: ReaderState::Running,
            dialect_reason: choice.reason,
        })
    }

    /// The dialect that the program is read as, and why it was chosen.
    pub const fn dialect(&self) -> (Dialect, &'static str) {
        (self.interpreter.dialect, self.dialect_reason)
    }

    /// The modes in force behind the line that the last step came from.
    pub fn modes(&self) -> ModesInForce {
        ModesInForce::of(&self.interpreter)
    }

    /// Text of the lines that were carried out between the step before the last and the last, and
    /// that write offsets or put others in force: G10, G43, G54, G92 and the like, whatever their
    /// values.
    pub fn offset_lines(&self) -> &[String] {
        &self.interpreter.output.offset_lines
    }

    /// Warnings so far, at most as many as [`Settings::max_errors`].
    pub fn warnings(&self) -> &[Diagnostic] {
        &self.warnings
    }

    /// The file's name as the user gave it.
    pub(super) fn name(&mut self) -> Arc<str> {
        self.flow.source().name.clone()
    }

    /// The files of subroutines that were opened so far, in the order in which they were called
    /// first.
    pub fn subroutine_files(&self) -> impl Iterator<Item = &Path> {
        self.flow
            .files
            .iter()
            .filter_map(|file| file.path.as_deref())
    }

    /// Lines carried out so far; those of loops and subroutines count each time.
    pub const fn lines(&self) -> u64 {
        self.lines
    }

    /// Carries out one line.
    fn step(&mut self) -> Result<(), Box<Diagnostic>> {
        let line = match self.flow.source().next_line() {
            Ok(line) => line,
            Err(error) => {
                self.state = ReaderState::Done;
                let message = format!("the program cannot be read on: {error}");
                return Err(self.of_file("gcode::read", message));
            }
        };
        let range = match line {
            SourceLine::End => return self.end_of_file(),
            SourceLine::Text(range) => range,
            SourceLine::TooLong(_) => {
                let fault = LineFault::new(
                    "gcode::line_length",
                    0..1,
                    format!("the line is longer than {MAX_LINE_BYTES} bytes: this is no G-code"),
                );
                return Err(self.diagnose(Severity::Error, *fault));
            }
        };
        self.lines += 1;
        self.interpreter.line = self.flow.source().line;
        let result = self.carry_out(range);
        let result = if self.interpreter.fanuc.capture.is_some() {
            self.end_own_profile(result)
        } else {
            result
        };
        self.interpreter
            .output
            .warnings
            .extend(self.flow.warning.take().map(|warning| *warning));
        if !self.interpreter.output.warnings.is_empty() {
            self.take_warnings();
        }
        if let Err(fault) = result {
            return self.refuse(*fault);
        }
        self.watch()
    }

    /// Reports a fault of the current line. Drops a fault that only follows from the fault of an
    /// earlier line.
    #[cold]
    pub(super) fn refuse(&mut self, fault: LineFault) -> Result<(), Box<Diagnostic>> {
        let follows = self.interpreter.behind_fault && FOLLOWING.contains(&fault.code);
        self.interpreter.assume(&self.block);
        if follows {
            Ok(())
        } else {
            Err(self.diagnose(Severity::Error, fault))
        }
    }

    fn take_warnings(&mut self) {
        for warning in std::mem::take(&mut self.interpreter.output.warnings) {
            let warning = self.diagnose(Severity::Warning, warning);
            self.warn(*warning);
        }
    }

    #[inline]
    pub(super) fn carry_out(&mut self, range: Range<usize>) -> Read<()> {
        self.block.clear();
        if self.flow.is_skipping() {
            return self.flow.passed_line(range, &self.interpreter);
        }
        match self.begin(&range)? {
            Some(at) => self.carry_out_words(range, at),
            None => Ok(()),
        }
    }

    /// Reads what comes before the words of a line. Returns the position of the words, or `None` if
    /// the line has none.
    #[inline]
    fn begin(&mut self, range: &Range<usize>) -> Read<Option<usize>> {
        let Self {
            flow, interpreter, ..
        } = self;
        let bytes = flow.source_ref().bytes(range.clone());
        let mut cursor = Cursor::new(bytes);
        match cursor.peek() {
            END => return Ok(None),
            b'%' => {
                let at = cursor.at..cursor.at + 1;
                return self.percent(at).map(|()| None);
            }
            b'/' => {
                if interpreter.settings.block_delete {
                    return Ok(None);
                }
                cursor.bump();
                if interpreter.dialect.is_fanuc() && cursor.raw().is_ascii_digit() {
                    cursor.bump(); // The level, `/2`.
                }
            }
            _ => {}
        }
        if self.percent == Percent::NotSeen {
            self.percent = Percent::Absent;
        }
        if interpreter.dialect != Dialect::LinuxCnc
            && let Some(command) = firmware::command(bytes, interpreter.dialect)
        {
            if command != firmware::FirmwareCommand::Speaks {
                interpreter
                    .output
                    .warnings
                    .push(*firmware::warning(bytes, command));
            }
            interpreter.event(EventKind::Message {
                text: String::from_utf8_lossy(bytes.trim_ascii()).into_owned(),
            });
            return Ok(None);
        }
        let number = if cursor.eat(b'n') {
            cursor.number()?
        } else {
            0.0
        };
        interpreter.fanuc.block_number = number.round().max(0.0) as u64;
        if cursor.peek() == b'o' || (interpreter.dialect.is_fanuc() && cursor.peek() == b':') {
            let at = cursor.at;
            flow.line(range.clone(), at, interpreter)?;
            return self.end_profile().map(|()| None);
        }
        Ok(Some(cursor.at))
    }

    /// The words of a line, which begin at `at`.
    #[inline]
    fn carry_out_words(&mut self, range: Range<usize>, mut at: usize) -> Read<()> {
        let Self {
            flow,
            interpreter,
            block,
            ..
        } = self;
        if interpreter.dialect.is_fanuc()
            && let Some(statement) = statement(
                Cursor {
                    bytes: flow.source_ref().bytes(range.clone()),
                    at,
                },
                interpreter,
            )?
        {
            match flow.carry_out_statement(statement, &range, interpreter)? {
                Some(rest) => at = rest,
                None => return Ok(()),
            }
        }
        let bytes = flow.source_ref().bytes(range);
        let cursor = Cursor { bytes, at };
        block.read(cursor, interpreter, self.style)?;
        if let Some(comment) = &block.comment {
            interpreter.comment(bytes, comment.clone())?;
        }
        if interpreter.dialect.is_fanuc() {
            interpreter.prepare(block)?;
        }
        if block
            .code(Group::NonModal)
            .is_some_and(|word| word.number == OWN + 650)
        {
            return flow.call_macro(block, interpreter);
        }
        interpreter.output.line_sets_offsets = block.names_offsets();
        interpreter.execute(block)?;
        if interpreter.output.line_sets_offsets {
            interpreter
                .output
                .offset_lines
                .push(String::from_utf8_lossy(bytes).into_owned());
        }
        if let Some(wanted) = interpreter.fanuc.wanted.take() {
            flow.begin_own_profile(*wanted, interpreter)?;
        }
        if let Some(wanted) = interpreter.wanted.take() {
            flow.call_profile(&wanted, interpreter)?;
        }
        for (target, value) in block.assignments.drain(..) {
            interpreter.assign(&target, value)?;
        }
        if block.m.is_empty() {
            Ok(())
        } else {
            self.calls()
        }
    }

    /// A line with `%`: the first opens the program, the next ends it.
    fn percent(&mut self, at: Range<usize>) -> Read<()> {
        match self.percent {
            Percent::NotSeen => self.percent = Percent::Open,
            Percent::Open => {
                self.percent = Percent::Absent;
                let open = self.interpreter.lathe.is_some();
                self.interpreter.end_program();
                self.interpreter.check_pending(at.clone())?;
                self.interpreter.check_profile_end(open, at)?;
            }
            Percent::Absent => {
                let fault = LineFault::new(
                    "gcode::percent",
                    at,
                    "`%` ends the program, but no `%` begins it",
                )
                .hint("write `%` as the first line, too, or M2 instead of this one");
                self.interpreter.output.warnings.push(*fault);
                self.interpreter.end_program();
            }
        }
        Ok(())
    }

    /// The text ends, perhaps without having said so.
    fn end_of_file(&mut self) -> Result<(), Box<Diagnostic>> {
        if let Some((line, message)) = self.flow.unfinished() {
            self.state = ReaderState::Done;
            self.interpreter.end_program();
            self.flow.source().find(line);
            let fault = LineFault::new("gcode::o_word", 0..usize::MAX, message);
            return Err(self.diagnose(
                Severity::Error,
                *fault.hint("write it behind the last line that belongs to it"),
            ));
        }
        if let Err(fault) = self.interpreter.check_pending(0..0) {
            self.interpreter.end_program();
            let mut diagnostic = self.of_file(fault.code, fault.message);
            diagnostic.hint = fault.hint;
            return Err(diagnostic);
        }
        if !self.interpreter.ended {
            let quiet = matches!(self.interpreter.dialect, Dialect::Grbl | Dialect::Printer);
            if !quiet {
                let mut warning = self.of_file(
                    "gcode::program_end",
                    "the program ends without M2, M30 or %".to_owned(),
                );
                warning.severity = Severity::Warning;
                warning.hint = Some(
                    "write M2 on the last line; a control may wait for more without it".to_owned(),
                );
                self.warn(*warning);
            }
            self.interpreter.end_program();
        }
        Ok(())
    }

    /// Stops programs that never end.
    fn watch(&mut self) -> Result<(), Box<Diagnostic>> {
        if self.interpreter.output.motions != self.motions_seen {
            self.motions_seen = self.interpreter.output.motions;
            self.idle_lines = 0;
        }
        self.idle_lines += 1;
        let settings = &self.interpreter.settings;
        let (message, hint) = if self.idle_lines > settings.max_idle_lines {
            (
                format!(
                    "endless loop: {} lines in a row were carried out without a motion",
                    settings.max_idle_lines
                ),
                "does the loop change what it waits for? --max-idle-lines sets the limit",
            )
        } else if self.interpreter.output.motions > settings.max_motions {
            (
                format!("the program has more than {} motions", settings.max_motions),
                "does a loop never end? --max-motions sets the limit",
            )
        } else {
            return Ok(());
        };
        self.state = ReaderState::Done;
        Err(self.diagnose(
            Severity::Error,
            *LineFault::new("gcode::endless", 0..usize::MAX, message).hint(hint),
        ))
    }

    /// The fault with its place; reads the line again, because looking for a subroutine may have
    /// moved the buffer on.
    #[cold]
    fn diagnose(&mut self, severity: Severity, fault: LineFault) -> Box<Diagnostic> {
        let source = self.flow.source();
        let (begin, here) = (source.line_start, source.here());
        let name = source.name.clone();
        let found = source.jump(begin).and_then(|()| source.next_line());
        let bytes = match found {
            Ok(SourceLine::Text(range) | SourceLine::TooLong(range)) => source.bytes(range),
            _ => &[],
        };
        let diagnostic = Diagnostic::of_line(
            severity,
            fault,
            name,
            begin.lines_before.saturating_add(1),
            bytes,
        );
        if source.jump(here).is_err() {
            self.state = ReaderState::Done;
        }
        Box::new(diagnostic)
    }

    pub(super) fn of_file(&mut self, code: &'static str, message: String) -> Box<Diagnostic> {
        Box::new(Diagnostic::of_file(
            Severity::Error,
            code,
            self.flow.source().name.clone(),
            message,
        ))
    }

    /// Returns how often a fault or warning has come up at its place.
    pub(super) fn times(&self, diagnostic: &Diagnostic) -> u64 {
        self.faults.times(diagnostic)
    }

    fn warn(&mut self, warning: Diagnostic) {
        if !self.faults.is_known(&warning)
            && self.warnings.len() < self.interpreter.settings.max_errors
        {
            self.warnings.push(warning);
        }
    }

    /// Returns the closing message after the last line: how many faults were not shown.
    fn rest(&mut self) -> Option<Box<Diagnostic>> {
        let said = self.faults.rest(self.interpreter.settings.max_errors)?;
        Some(self.of_file("gcode::more", said))
    }
}

impl Iterator for Reader {
    type Item = Result<Canon, Diagnostic>;

    #[inline]
    fn next(&mut self) -> Option<Self::Item> {
        self.interpreter.output.offset_lines.clear();
        loop {
            if let Some(canon) = self.interpreter.output.steps.pop_front() {
                return Some(Ok(canon));
            }
            if self.state == ReaderState::Done
                || self.interpreter.ended
                || self.faults.are_hopeless()
            {
                self.state = ReaderState::Done;
                self.warn_of_points();
                let rest = self.rest()?;
                return Some(Err(*rest));
            }
            if let Some(motion) = self.plain_line() {
                return Some(Ok(Canon::Motion(motion)));
            }
            if let Err(diagnostic) = self.step()
                && self
                    .faults
                    .add(&diagnostic, self.interpreter.settings.max_errors)
            {
                return Some(Err(*diagnostic));
            }
        }
    }
}
