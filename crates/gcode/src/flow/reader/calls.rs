//! Where the program goes on behind M97, M98 and M99, and behind the profile of a lathe cycle.

use crate::flow::reader::Reader;
use crate::settings::Dialect;
use crate::text::diagnostic::{LineFault, Read, Severity, Short};

impl Reader {
    /// A subroutine has perhaps returned to the lathe cycle whose profile it is; faults are the
    /// cycle's.
    pub(super) fn end_profile(&mut self) -> Read<()> {
        let Self {
            flow, interpreter, ..
        } = self;
        let Some(lathe) = interpreter
            .lathe
            .take_if(|lathe| interpreter.calls.level <= lathe.level)
        else {
            return Ok(());
        };
        flow.source().line_start = lathe.mark;
        interpreter.finish_lathe(&lathe)
    }

    /// The line that was read may be the last of a profile; without its faults the cycle is carried
    /// out.
    pub(super) fn end_own_profile(&mut self, result: Read<()>) -> Read<()> {
        let number = std::mem::take(&mut self.interpreter.fanuc.block_number);
        let Some(capture) = self
            .interpreter
            .fanuc
            .capture
            .take_if(|capture| capture.last() == number)
        else {
            return result;
        };
        let Self {
            flow, interpreter, ..
        } = self;
        result?;
        interpreter.check_pending(0..usize::MAX)?;
        flow.end_own_profile(&capture, interpreter)
    }

    /// M98 and M99 come after all else of their line.
    pub(super) fn calls(&mut self) -> Read<()> {
        let Self {
            flow,
            interpreter,
            block,
            ..
        } = self;
        for word in &block.m {
            let at = word.at();
            match word.number {
                98 => {
                    let Some(number) = block.get(b'p') else {
                        return Err(LineFault::new(
                            "gcode::m98",
                            at,
                            "M98 calls a subroutine, but P with its number is missing",
                        )
                        .hint("write M98 P1000 to call O1000"));
                    };
                    let times = if block.has(b'l') {
                        interpreter.integer(block, b'l', 0, i64::from(u32::MAX))?
                    } else {
                        1
                    };
                    if !(0.0..1e15).contains(&number) {
                        return Err(LineFault::new(
                            "gcode::m98",
                            block.at(b'p'),
                            format!("P{} is no number of a subroutine", Short(number)),
                        ));
                    }
                    let number = number.round() as u64;
                    let called = flow.call_number(number, times as u32, &at, interpreter);
                    // Fanuc: `M98 P30100` calls O100 three times, where there is no O30100.
                    let counts = interpreter.dialect.is_fanuc() && !block.has(b'l');
                    match called {
                        Err(fault) if counts && (10_000..100_000_000).contains(&number) => flow
                            .call_number(
                                number % 10_000,
                                (number / 10_000) as u32,
                                &at,
                                interpreter,
                            )
                            .map_err(|_| fault)?,
                        called => called?,
                    }
                }
                97 if interpreter.dialect.is_fanuc() => flow.call_block(block, &at, interpreter)?,
                99 if block.has(b'p') && interpreter.dialect.is_fanuc() => {
                    let number = interpreter.integer(block, b'p', 1, 99_999_999)? as u64;
                    flow.return_number(&at, interpreter)?;
                    flow.go_to_block(number, "M99 P", &block.at(b'p'))?;
                }
                99 if block.has(b'p') && interpreter.dialect != Dialect::Printer => {
                    return Err(LineFault::new(
                        "gcode::unsupported",
                        block.at(b'p'),
                        "M99 P goes on at another line than the one behind the call, which is not read",
                    )
                    .hint("write M99 alone"));
                }
                // A control would begin again for the next part.
                99 if flow.return_number(&at, interpreter)? => interpreter.end_program(),
                _ => {}
            }
        }
        Ok(())
    }

    /// Lengths without a decimal point mean something else on some controls.
    pub(super) fn warn_of_points(&mut self) {
        if let Some((line, message, hint)) = self.interpreter.warning_of_points() {
            let mut warning = self.of_file("gcode::increment", message);
            (warning.severity, warning.line, warning.hint) =
                (Severity::Warning, line, Some(hint.to_owned()));
            self.warn(*warning);
        }
    }
}
