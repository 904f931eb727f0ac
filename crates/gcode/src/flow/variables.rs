//! Assignments and messages.

use std::ops::Range;

use crate::canon::EventKind;
use crate::state::Interpreter;
use crate::text::diagnostic::{LineFault, Read};
use crate::text::expression::{Evaluator, ParameterSource, Target};
use crate::text::lexer::Cursor;

impl Interpreter {
    /// `#target = value`, in effect from the next line on.
    pub(super) fn assign(&mut self, target: &Target, value: f64) -> Read<()> {
        let read_only = |name: &str| {
            Err(LineFault::new(
                "gcode::parameter",
                0..usize::MAX,
                format!("{name} can only be read"),
            ))
        };
        match target {
            Target::Numbered(index @ (5400..=5413 | 5420..=5428)) => {
                return read_only(&format!("#{index}"));
            }
            Target::Numbered(3000) if self.dialect.is_fanuc() => {
                let message = format!("the program stops here with alarm {value} (#3000)");
                return Err(LineFault::new("gcode::alarm", 0..usize::MAX, message)
                    .hint("the macro refuses what it was given"));
            }
            Target::Numbered(index) => self.parameters.set(*index, value),
            Target::Named(name) => {
                let shown = String::from_utf8_lossy(name);
                if self.parameters.named(name).is_none()
                    && (self.named(name).is_some()
                        || name.starts_with(b"_ini[")
                        || name.starts_with(b"_hal["))
                {
                    return read_only(&format!("#<{shown}>"));
                }
                if !self.parameters.set_named(name, value) {
                    return Err(LineFault::new(
                        "gcode::parameter",
                        0..usize::MAX,
                        format!(
                            "no room for #<{shown}>: the program has too many named parameters"
                        ),
                    ));
                }
            }
        }
        Ok(())
    }

    /// Comments that speak to the operator, at the bytes `at` of the line; one in brackets can end
    /// the program.
    #[cold]
    pub(super) fn comment(&mut self, line: &[u8], at: Range<usize>) -> Read<()> {
        let in_brackets = at.start > 0 && line[at.start - 1] == b'(';
        let text = line[at.clone()].trim_ascii();
        let after = |keyword: &[u8]| -> Option<&[u8]> {
            let (start, rest) = text.split_at_checked(keyword.len())?;
            (start.eq_ignore_ascii_case(keyword)).then_some(rest)
        };
        let text = if let Some(rest) = after(b"msg,") {
            String::from_utf8_lossy(rest).into_owned()
        } else if let Some(rest) = after(b"print,").or_else(|| after(b"debug,")) {
            self.with_values(rest)
        } else if let Some(rest) = after(b"abort,").filter(|_| in_brackets) {
            let message = format!(
                "the program gives itself up here: {}",
                self.with_values(rest).trim()
            );
            self.end_program();
            return Err(LineFault::new("gcode::abort", at, message)
                .hint("(abort, ...) ends a program on LinuxCNC; what it asks for is in its text"));
        } else {
            return Ok(());
        };
        self.event(EventKind::Message { text });
        Ok(())
    }

    /// The text with the values of its parameters.
    fn with_values(&self, text: &[u8]) -> String {
        let mut shown = Vec::new();
        let mut at = 0;
        while let Some(&byte) = text.get(at) {
            if byte != b'#' {
                shown.push(byte);
                at += 1;
                continue;
            }
            // A blank ends the number of a parameter here, though not in a line.
            let digits = text[at + 1..]
                .iter()
                .take_while(|byte| byte.is_ascii_digit())
                .count();
            let mut cursor = Cursor::new(if digits > 0 {
                &text[..=at + digits]
            } else {
                text
            });
            cursor.at = at;
            let mut evaluator = Evaluator::new(cursor, self);
            match evaluator.value() {
                Ok(value) => shown.extend_from_slice(format!("{value:.6}").as_bytes()),
                Err(_) => shown.extend_from_slice(b"######"),
            }
            at = evaluator.cursor.at.max(at + 1);
        }
        String::from_utf8_lossy(&shown).into_owned()
    }
}
