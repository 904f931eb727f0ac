//! What is wrong with a program and where: one [`Diagnostic`] per fault, shown by miette with the
//! line and a caret.
//!
//! A diagnostic carries an excerpt of its own line, so that showing it needs neither the file nor a
//! copy of the program.

use std::fmt;
use std::ops::Range;
use std::sync::Arc;

use miette::{LabeledSpan, MietteError, MietteSpanContents, SourceCode, SourceSpan, SpanContents};

use crate::text::visible::visible;

/// Longest excerpt of a line that a diagnostic keeps, bytes: a row of a terminal, so that the caret
/// stands below its fault.
const EXCERPT_BYTES: usize = 100;
/// Mark where an excerpt is cut.
const CUT: &str = "…";

/// Severity of a diagnostic.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Severity {
    /// The program must not run.
    Error,
    /// The program runs, but something deserves a look.
    Warning,
}

/// One fault of a program.
#[derive(Debug, Clone, PartialEq)]
pub struct Diagnostic {
    /// Error or warning.
    pub severity: Severity,
    /// Stable short name of the kind of fault, such as `gcode::arc_radius`.
    pub code: &'static str,
    /// File as the user named it.
    pub file: Arc<str>,
    /// Line, from 1; 0 where the fault belongs to the file as a whole.
    pub line: u32,
    /// Column in characters, from 1; 0 where the fault belongs to the line or the file as a whole.
    pub column: u32,
    /// Length of the faulty text in characters.
    pub span: u32,
    /// Description of the fault, with value, limit and unit. Hidden characters of the program are
    /// visible here and in the hint: see [`visible`].
    pub message: String,
    /// Likely remedy.
    pub hint: Option<String>,
    /// Excerpt of the line, likewise; empty where there is no line.
    pub text: String,
    /// The fault's bytes within `text`.
    mark: Range<usize>,
}

impl Diagnostic {
    /// A fault of the file as a whole.
    pub(crate) fn of_file(
        severity: Severity,
        code: &'static str,
        file: Arc<str>,
        message: String,
    ) -> Self {
        let message = visible(&message).into_owned();
        Self {
            severity,
            code,
            file,
            line: 0,
            column: 0,
            span: 0,
            message,
            hint: None,
            text: String::new(),
            mark: 0..0,
        }
    }

    /// The fault `fault` of the line `bytes`.
    pub(crate) fn of_line(
        severity: Severity,
        fault: LineFault,
        file: Arc<str>,
        line: u32,
        bytes: &[u8],
    ) -> Self {
        let start = fault.at.start.min(bytes.len());
        let end = fault.at.end.clamp(start, bytes.len());
        // The window begins a third of the excerpt before the fault, so that the caret keeps some
        // context on both sides.
        let from = if bytes.len() <= EXCERPT_BYTES {
            0
        } else {
            start.saturating_sub(EXCERPT_BYTES / 3)
        };
        let to = bytes.len().min(from + EXCERPT_BYTES);
        let before = if from > 0 { CUT } else { "" }.to_owned() + &printable(&bytes[from..start]);
        let inside = printable(&bytes[start..end.min(to)]);
        let after = printable(&bytes[end.min(to)..to]) + if to < bytes.len() { CUT } else { "" };
        let column = 1 + String::from_utf8_lossy(&bytes[..start]).chars().count();
        let span = String::from_utf8_lossy(&bytes[start..end]).chars().count();
        let mark = before.len()..before.len() + inside.len();
        Self {
            severity,
            code: fault.code,
            file,
            line,
            column: u32::try_from(column).unwrap_or(u32::MAX),
            span: u32::try_from(span).unwrap_or(u32::MAX),
            message: visible(&fault.message).into_owned(),
            hint: fault.hint.map(|hint| visible(&hint).into_owned()),
            text: before + &inside + &after,
            mark,
        }
    }
}

/// The bytes as one row of text: what is not UTF-8 becomes U+FFFD.
fn printable(bytes: &[u8]) -> String {
    visible(&String::from_utf8_lossy(bytes)).into_owned()
}

impl fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        // Where there is no line to show, nothing else names the file.
        if self.line == 0 {
            write!(f, "{}: ", visible(&self.file))?;
        }
        f.write_str(&self.message)
    }
}

impl std::error::Error for Diagnostic {}

impl miette::Diagnostic for Diagnostic {
    fn code<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        Some(Box::new(self.code))
    }

    fn severity(&self) -> Option<miette::Severity> {
        Some(match self.severity {
            Severity::Error => miette::Severity::Error,
            Severity::Warning => miette::Severity::Warning,
        })
    }

    fn help<'a>(&'a self) -> Option<Box<dyn fmt::Display + 'a>> {
        self.hint
            .as_ref()
            .map(|hint| Box::new(hint) as Box<dyn fmt::Display>)
    }

    fn source_code(&self) -> Option<&dyn SourceCode> {
        (self.line > 0).then_some(self as &dyn SourceCode)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        (self.line > 0).then(|| {
            let span: SourceSpan = (self.mark.start, self.mark.len().max(1)).into();
            Box::new(std::iter::once(LabeledSpan::new_primary_with_span(
                None, span,
            ))) as Box<dyn Iterator<Item = LabeledSpan>>
        })
    }
}

impl SourceCode for Diagnostic {
    fn read_span<'a>(
        &'a self,
        span: &SourceSpan,
        _context_lines_before: usize,
        _context_lines_after: usize,
    ) -> Result<Box<dyn SpanContents<'a> + 'a>, MietteError> {
        if span.offset() > self.text.len() {
            return Err(MietteError::OutOfBounds);
        }
        // miette counts lines from 0 and shows the column of the contents' first byte.
        Ok(Box::new(MietteSpanContents::new_named(
            visible(&self.file).into_owned(),
            self.text.as_bytes(),
            (0, self.text.len()).into(),
            self.line.saturating_sub(1) as usize,
            self.column.saturating_sub(1) as usize,
            1,
        )))
    }
}

/// Beyond these magnitudes a number in a message has an exponent instead of hundreds of digits. No
/// length, feed or time of a program lies outside, so that sensible values are shown as they were
/// written.
const WRITTEN_OUT: Range<f64> = 1e-7..1e15;

/// A number as messages show it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Short(pub(crate) f64);

impl fmt::Display for Short {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(value) = *self;
        if value == 0.0 || WRITTEN_OUT.contains(&value.abs()) {
            write!(f, "{value}")
        } else {
            write!(f, "{value:.3e}")
        }
    }
}

/// A fault found while a line is read: the place is known only within the line.
#[derive(Debug)]
pub(crate) struct LineFault {
    pub(crate) code: &'static str,
    pub(super) at: Range<usize>,
    pub(crate) message: String,
    pub(crate) hint: Option<String>,
}

/// Result of reading something within a line; boxed, because the success path must stay small and
/// fast.
pub(crate) type Read<T> = Result<T, Box<LineFault>>;

impl LineFault {
    /// A fault at the bytes `at` of the line.
    #[cold]
    pub(crate) fn new(
        code: &'static str,
        at: Range<usize>,
        message: impl Into<String>,
    ) -> Box<Self> {
        Box::new(Self {
            code,
            at,
            message: message.into(),
            hint: None,
        })
    }

    /// Adds the likely remedy.
    pub(crate) fn hint(mut self: Box<Self>, hint: impl Into<String>) -> Box<Self> {
        self.hint = Some(hint.into());
        self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_shown_as_written_or_short() {
        let shown = |value: f64| Short(value).to_string();
        assert_eq!(
            [0.0, -1.5, 999_999_999.0, 0.0001].map(shown),
            ["0", "-1.5", "999999999", "0.0001"]
        );
        assert_eq!(
            [1e300, -1.23456e20, 1e-300].map(shown),
            ["1.000e300", "-1.235e20", "1.000e-300"]
        );
    }
}
