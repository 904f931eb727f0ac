//! Assignments, messages, and what a subroutine call saves.

use std::ops::Range;

use super::block::Block;
use super::canon::EventKind;
use super::diagnostic::{Fault, Read};
use super::expression::{Evaluator, Target, Values};
use super::lexer::Cursor;
use super::parameters as numbers;
use super::settings::Dialect;
use super::state::{Frame, Interpreter, Modal};

/// Modes that M70 or M73 has put away.
#[derive(Debug, Clone)]
pub(super) struct Saved {
    modal: Modal,
    frame: Frame,
    /// Whether G92 was in effect.
    shifted: bool,
    /// M73: they come back when the subroutine returns.
    automatic: bool,
    level: usize,
}

impl Interpreter {
    /// `#target = value`, in effect from the next line on.
    pub(super) fn assign(&mut self, target: &Target, value: f64) -> Read<()> {
        let read_only =
            |name: &str| Err(Fault::new("gcode::parameter", 0..usize::MAX, format!("{name} can only be read")));
        match target {
            Target::Numbered(index @ (5400..=5413 | 5420..=5428)) => {
                return read_only(&format!("#{index}"));
            }
            Target::Numbered(3000) if self.dialect.is_fanuc() => {
                let message = format!("the program stops here with alarm {value} (#3000)");
                return Err(
                    Fault::new("gcode::alarm", 0..usize::MAX, message).hint("the macro refuses what it was given")
                );
            }
            Target::Numbered(index) => self.parameters.set(*index, value),
            Target::Named(name) => {
                let shown = String::from_utf8_lossy(name);
                if self.parameters.named(name).is_none()
                    && (self.named(name).is_some() || name.starts_with(b"_ini[") || name.starts_with(b"_hal["))
                {
                    return read_only(&format!("#<{shown}>"));
                }
                if !self.parameters.set_named(name, value) {
                    return Err(Fault::new(
                        "gcode::parameter",
                        0..usize::MAX,
                        format!("no room for #<{shown}>: the program has too many named parameters"),
                    ));
                }
            }
        }
        Ok(())
    }

    /// Comments that speak to the operator, at the bytes `at` of the line; one in brackets can end the program.
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
            let message = format!("the program gives itself up here: {}", self.with_values(rest).trim());
            self.end_program();
            return Err(Fault::new("gcode::abort", at, message)
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
            let digits = text[at + 1..].iter().take_while(|byte| byte.is_ascii_digit()).count();
            let mut cursor = Cursor::new(if digits > 0 { &text[..=at + digits] } else { text });
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

    /// A subroutine has been entered.
    pub(super) fn entered(&mut self, level: usize) {
        self.call_level = level;
        self.returned = None;
    }

    /// A subroutine has returned to `level`.
    pub(super) fn left(&mut self, level: usize) {
        self.call_level = level;
        while let Some(saved) = self.saved.pop_if(|saved| saved.level > level) {
            if saved.automatic {
                self.restore(&saved);
            }
        }
        self.returned = None;
    }

    /// M70, M73: puts the modes away; one set for each call level.
    pub(super) fn save_modes(&mut self, automatic: bool) {
        let saved = Saved {
            modal: self.modal.clone(),
            frame: self.frame.clone(),
            shifted: self.is_shifted(),
            automatic,
            level: self.call_level,
        };
        self.forget_modes();
        self.saved.push(saved);
    }

    /// M71.
    pub(super) fn forget_modes(&mut self) {
        let level = self.call_level;
        self.saved.pop_if(|saved| saved.level == level);
    }

    /// M72.
    pub(super) fn restore_modes(&mut self, block: &Block) -> Read<()> {
        let level = self.call_level;
        if let Some(saved) = self.saved.last().filter(|saved| saved.level == level).cloned() {
            self.restore(&saved);
        } else if self.dialect == Dialect::LinuxCnc {
            return Err(Fault::new(
                "gcode::m_code",
                block.whole(),
                "M72 brings modes back that no M70 or M73 has put away",
            )
            .hint("write M70 before it, in the same subroutine"));
        }
        Ok(())
    }

    fn is_shifted(&self) -> bool {
        self.parameters.get(numbers::G92_ACTIVE) != 0.0
    }

    /// Modes come back; a motion mode does not, and offsets that G10 and G92 have changed stay. Whether G92 is in effect comes
    /// back, as if G92.2 or G92.3 stood there.
    fn restore(&mut self, saved: &Saved) {
        let motion = self.modal.motion;
        self.modal = saved.modal.clone();
        self.modal.motion = motion;
        self.frame.system = saved.frame.system;
        self.frame.tool = saved.frame.tool;
        self.load_system();
        if self.is_shifted() != saved.shifted {
            self.shift_mode(if saved.shifted { 923 } else { 922 });
        }
    }
}
