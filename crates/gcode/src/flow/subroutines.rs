//! Subroutines: finding them, calling them, returning from them.
//!
//! `O1 sub` ... `O1 endsub` has parameters of its own and is called by `O1 call [..]`; `O1` ...
//! `M99` shares them and is called by `M98 P1`. A subroutine is looked for in the file under way,
//! in the program, and in a file of its name.

use std::collections::HashMap;
use std::fs::File;
use std::io;
use std::path::Path;
use std::sync::Arc;

use crate::flow::owords::{Arguments, Head, Keyword, at_o_word, read_head, shown};
use crate::flow::program::{Call, Flow, ProgramFile, SubroutineKind, cannot_read};
use crate::state::Interpreter;
use crate::state::lathe::ProfileCall;
use crate::state::parameters::{LOCALS, MACRO_LOCALS};
use crate::text::diagnostic::{LineFault, Read};
use crate::text::expression::{Evaluator, NoParameters};
use crate::text::lexer::Cursor;
use crate::text::source::{Mark, Source, SourceLine};

/// Files of subroutines that stay open. A program uses a handful; each may hold a buffer of 256
/// KiB.
const MAX_FILES: usize = 100;
/// Subroutines that one file may define.
const MAX_SUBROUTINES: usize = 100_000;

impl Flow {
    /// `O1 call [..]`.
    pub(super) fn call(
        &mut self,
        head: &Head,
        arguments: &Arguments,
        interpreter: &mut Interpreter,
    ) -> Read<()> {
        let (file, kind, body) = self.find_subroutine(&head.label, &head.at)?;
        if kind == SubroutineKind::Fanuc {
            let number = String::from_utf8_lossy(&head.label).into_owned();
            return Err(LineFault::new(
                "gcode::o_word",
                head.at.clone(),
                format!("{} has no `sub`: it is called by M98", head.shown()),
            )
            .hint(format!("write M98 P{number}")));
        }
        self.check_depth(&head.at)?;
        let saved = interpreter.parameters.enter(&arguments.values);
        self.enter(
            Call {
                kind,
                label: head.label.clone(),
                file: self.current,
                back: self.source_ref().here(),
                body,
                repeats: 0,
                saved,
                arguments: None,
                loops: self.loops.len(),
            },
            file,
            &head.at,
        )
        .inspect_err(|_| interpreter.parameters.leave(&saved[..LOCALS]))?;
        interpreter.entered(self.frames.len());
        Ok(())
    }

    /// The profile of a lathe cycle: a call without arguments.
    pub(super) fn call_profile(
        &mut self,
        wanted: &ProfileCall,
        interpreter: &mut Interpreter,
    ) -> Read<()> {
        let head = Head {
            label: wanted.label.clone(),
            keyword: Keyword::Call,
            at: wanted.at.clone(),
        };
        let arguments = Arguments {
            values: [0.0; LOCALS],
            count: 0,
        };
        if let Some(lathe) = &mut interpreter.lathe {
            lathe.mark = self.source_ref().line_start;
        }
        self.call(&head, &arguments, interpreter)
            .inspect_err(|_| interpreter.lathe = None)
    }

    /// `M98 P1 L2`.
    pub(super) fn call_number(
        &mut self,
        number: u64,
        times: u32,
        at: &std::ops::Range<usize>,
        interpreter: &mut Interpreter,
    ) -> Read<()> {
        self.call_with(number, times, at, interpreter, None)
    }

    /// M98, or G65 with its arguments.
    pub(super) fn call_with(
        &mut self,
        number: u64,
        times: u32,
        at: &std::ops::Range<usize>,
        interpreter: &mut Interpreter,
        arguments: Option<Box<[f64; MACRO_LOCALS]>>,
    ) -> Read<()> {
        if times == 0 {
            return Ok(());
        }
        let label = number.to_string().into_bytes();
        let (file, kind, body) = self.find_subroutine(&label, at)?;
        if kind == SubroutineKind::Rs274 {
            return Err(LineFault::new(
                "gcode::o_word",
                at.clone(),
                format!(
                    "{} has `sub`: it is called by `{} call`, not by M98",
                    shown(&label),
                    shown(&label)
                ),
            ));
        }
        let Some(arguments) = arguments else {
            return self.enter_lines(label, kind, (file, body), times, at, interpreter);
        };
        self.enter_lines(
            label,
            SubroutineKind::Macro,
            (file, body),
            times,
            at,
            interpreter,
        )?;
        let saved = interpreter.parameters.enter(&arguments[..]);
        if let Some(frame) = self.frames.last_mut() {
            (frame.saved, frame.arguments) = (saved, Some(arguments));
        }
        Ok(())
    }

    /// Goes on at lines that M99 ends.
    pub(super) fn enter_lines(
        &mut self,
        label: Vec<u8>,
        kind: SubroutineKind,
        (file, body): (usize, Mark),
        times: u32,
        at: &std::ops::Range<usize>,
        interpreter: &mut Interpreter,
    ) -> Read<()> {
        self.check_depth(at)?;
        let frame = Call {
            kind,
            label,
            file: self.current,
            back: self.source_ref().here(),
            body,
            repeats: times - 1,
            saved: [0.0; MACRO_LOCALS],
            arguments: None,
            loops: self.loops.len(),
        };
        self.enter(frame, file, at)?;
        interpreter.entered(self.frames.len());
        Ok(())
    }

    fn enter(&mut self, frame: Call, file: usize, at: &std::ops::Range<usize>) -> Read<()> {
        self.files[file]
            .source
            .jump(frame.body)
            .map_err(|error| cannot_read(at.clone(), &error))?;
        self.current = file;
        self.frames.push(frame);
        Ok(())
    }

    fn check_depth(&self, at: &std::ops::Range<usize>) -> Read<()> {
        if self.frames.len() < self.max_depth {
            return Ok(());
        }
        Err(LineFault::new(
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
    pub(super) fn leave(
        &mut self,
        head: &Head,
        arguments: &Arguments,
        interpreter: &mut Interpreter,
    ) -> Read<()> {
        let fault = |message: &str| Err(LineFault::new("gcode::o_word", head.at.clone(), message));
        match self.frames.last() {
            None => return fault("this is not inside a subroutine"),
            Some(frame) if frame.kind != SubroutineKind::Rs274 => {
                return fault("a subroutine called by M98 ends with M99");
            }
            Some(frame) if head.keyword == Keyword::EndSub && frame.label != head.label => {
                return Err(LineFault::new(
                    "gcode::o_word",
                    head.at.clone(),
                    format!("endsub of {} ends {}", head.shown(), shown(&frame.label)),
                ));
            }
            Some(_) => {}
        }
        self.pop_frame(&head.at, interpreter)?;
        interpreter.calls.returned = (arguments.count > 0).then_some(arguments.values[0]);
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
        if frame.kind == SubroutineKind::Rs274 {
            return Err(LineFault::new(
                "gcode::o_word",
                at.clone(),
                "a subroutine with `sub` ends with `endsub` or `return`, not with M99",
            ));
        }
        if frame.repeats > 0 {
            frame.repeats -= 1;
            let body = frame.body;
            if let Some(arguments) = &frame.arguments {
                interpreter.parameters.set_locals(&arguments[..]);
            }
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
        match frame.kind {
            SubroutineKind::Rs274 => interpreter.parameters.leave(&frame.saved[..LOCALS]),
            SubroutineKind::Macro => interpreter.parameters.leave(&frame.saved),
            SubroutineKind::Fanuc => {}
        }
        self.loops.truncate(frame.loops);
        interpreter.left(self.frames.len());
        self.current = frame.file;
        self.source()
            .jump(frame.back)
            .map_err(|error| cannot_read(at.clone(), &error))
    }

    /// File, manner and first line of a subroutine: in the file under way, in the program, in a
    /// file of its name.
    fn find_subroutine(
        &mut self,
        label: &[u8],
        at: &std::ops::Range<usize>,
    ) -> Read<(usize, SubroutineKind, Mark)> {
        for file in [self.current, 0] {
            if let Some((kind, mark)) = self.index(file, at)?.get(label).copied() {
                return Ok((file, kind, mark));
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
            let fault = LineFault::new(
                "gcode::o_word",
                at.clone(),
                format!("the subroutine {} is defined nowhere", shown(label)),
            );
            return Err(fault.hint(format!(
                "define it in this program, or put {name} into a folder of subroutines"
            )));
        };
        let file = self.open(&path, at)?;
        match self.index(file, at)?.get(label).copied() {
            Some((kind, mark)) => Ok((file, kind, mark)),
            None => Err(LineFault::new(
                "gcode::o_word",
                at.clone(),
                format!("{} does not define {}", path.display(), shown(label)),
            )),
        }
    }

    fn open(&mut self, path: &Path, at: &std::ops::Range<usize>) -> Read<usize> {
        if let Some(file) = self
            .files
            .iter()
            .position(|file| file.path.as_deref() == Some(path))
        {
            return Ok(file);
        }
        if self.files.len() > MAX_FILES {
            return Err(LineFault::new(
                "gcode::o_word",
                at.clone(),
                format!("more than {MAX_FILES} files of subroutines"),
            ));
        }
        let name: Arc<str> = path.display().to_string().into();
        let source = File::open(path)
            .and_then(|file| Source::from_file(name, file))
            .map_err(|error| cannot_read(at.clone(), &error))?;
        self.files.push(ProgramFile {
            source,
            path: Some(path.to_owned()),
            subroutines: None,
        });
        Ok(self.files.len() - 1)
    }

    /// The subroutines of a file, found by one pass over it at the first call.
    fn index(
        &mut self,
        file: usize,
        at: &std::ops::Range<usize>,
    ) -> Read<&HashMap<Vec<u8>, (SubroutineKind, Mark)>> {
        let file = &mut self.files[file];
        if file.subroutines.is_none() {
            let here = file.source.here();
            let line_start = file.source.line_start;
            let found = find_definitions(&mut file.source)
                .and_then(|found| file.source.jump(here).map(|()| found));
            file.source.line_start = line_start;
            file.subroutines = Some(found.map_err(|error| cannot_read(at.clone(), &error))?);
        }
        file.subroutines.as_ref().ok_or_else(|| {
            LineFault::new(
                "gcode::o_word",
                at.clone(),
                "the subroutines cannot be found",
            )
        })
    }
}

/// Definitions of subroutines in a file; the first of a label counts.
fn find_definitions(source: &mut Source) -> io::Result<HashMap<Vec<u8>, (SubroutineKind, Mark)>> {
    let mut found = HashMap::new();
    source.rewind()?;
    loop {
        let range = match source.next_line()? {
            SourceLine::End => return Ok(found),
            SourceLine::TooLong(_) => continue,
            SourceLine::Text(range) => range,
        };
        let mut cursor = Cursor::new(source.bytes(range));
        if !at_o_word(&mut cursor) {
            continue;
        }
        let Ok(head) = read_head(&mut Evaluator::new(cursor, &NoParameters)) else {
            continue;
        };
        let kind = match head.keyword {
            Keyword::Sub => SubroutineKind::Rs274,
            Keyword::Number => SubroutineKind::Fanuc,
            _ => continue,
        };
        if found.len() < MAX_SUBROUTINES {
            found.entry(head.label).or_insert((kind, source.here()));
        }
    }
}
