//! Faults of a file of TOML text, each with its place and, where one is likely, a remedy.

use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};

use feedwright_gcode::visible;
use miette::{Diagnostic, LabeledSpan, NamedSource, SourceSpan};
use thiserror::Error;

/// Kind of file, for messages.
#[derive(Debug, PartialEq, Eq)]
pub struct Kind {
    /// Name, as in "cannot read machine file".
    pub name: &'static str,
    /// Description of such a file, as a hint.
    pub is: &'static str,
    /// Code of its faults.
    pub code: &'static str,
    /// Hint on where to find such a file, for a file that does not exist.
    pub where_to_find: &'static str,
}

/// Reason why a file cannot be used.
#[derive(Debug, Error, Diagnostic)]
pub enum FileError {
    /// The file cannot be read.
    #[error("cannot read {} {}: {source}", kind.name, path.display())]
    Unreadable {
        /// Expected kind of file.
        kind: &'static Kind,
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
        /// Remedy.
        #[help]
        hint: Option<&'static str>,
    },
    /// The file is far larger than any of its kind.
    #[error("{} is larger than {limit_bytes} bytes: this is no {}", path.display(), kind.name)]
    TooLarge {
        /// Expected kind of file.
        kind: &'static Kind,
        /// The file.
        path: PathBuf,
        /// Largest size that is read.
        limit_bytes: u64,
        /// Remedy.
        #[help]
        hint: &'static str,
    },
    /// The file is not UTF-8 text.
    #[error("{} is not text: byte 0x{byte:02x} at offset {offset} is not UTF-8", path.display())]
    NotText {
        /// The file.
        path: PathBuf,
        /// Offset of the first byte that is no text.
        offset: usize,
        /// Value of that byte.
        byte: u8,
        /// Remedy.
        #[help]
        hint: String,
    },
    /// The text has faults; all that were found.
    #[error("{} {} has {} {}", kind.name, text.name(), problems.len(), if problems.len() == 1 { "fault" } else { "faults" })]
    Invalid {
        /// Expected kind of file.
        kind: &'static Kind,
        /// The text with the name of the file, for carets.
        #[source_code]
        text: NamedSource<String>,
        /// The faults, in the order of the text.
        #[related]
        problems: Vec<Problem>,
    },
}

/// A fault in the text of a file.
#[derive(Debug, Clone, PartialEq, Eq, Error)]
#[error("{message}")]
pub struct Problem {
    /// Code of the kind of file.
    pub code: &'static str,
    /// Message: key, value, limit, unit.
    pub message: String,
    /// Line of the text, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// Place in the text.
    pub(crate) span: SourceSpan,
    /// Short label below the place.
    pub(crate) label: &'static str,
    /// Remedy, where there is one.
    pub hint: Option<String>,
}

/// A fault before its line and column are known.
#[derive(Debug)]
pub struct Fault {
    /// Bytes of the text that it is about.
    pub at: Range<usize>,
    /// Short label below the place.
    pub label: &'static str,
    /// Message: key, value, limit, unit.
    pub message: String,
    /// Remedy, where there is one.
    pub hint: Option<String>,
}

impl Diagnostic for Problem {
    fn code<'a>(&'a self) -> Option<Box<dyn std::fmt::Display + 'a>> {
        Some(Box::new(self.code))
    }

    fn help<'a>(&'a self) -> Option<Box<dyn std::fmt::Display + 'a>> {
        self.hint
            .as_ref()
            .map(|hint| Box::new(hint) as Box<dyn std::fmt::Display>)
    }

    fn labels(&self) -> Option<Box<dyn Iterator<Item = LabeledSpan> + '_>> {
        let label = LabeledSpan::new_with_span(Some(self.label.to_owned()), self.span);
        Some(Box::new(std::iter::once(label)))
    }
}

impl FileError {
    /// The operating system does not give the file.
    pub(crate) fn unreadable(kind: &'static Kind, path: &Path, source: io::Error) -> Self {
        let hint = match source.kind() {
            io::ErrorKind::NotFound => Some(kind.where_to_find),
            io::ErrorKind::IsADirectory => Some("give a file of that directory"),
            _ => None,
        };
        Self::Unreadable {
            kind,
            path: path.to_owned(),
            source,
            hint,
        }
    }

    /// The faults of a text, sorted by place.
    pub fn invalid(kind: &'static Kind, file: &str, text: &str, mut faults: Vec<Fault>) -> Self {
        faults.sort_by_key(|fault| (fault.at.start, fault.at.end));
        let problems = faults
            .into_iter()
            .map(|fault| Problem::locate(kind, fault, text))
            .collect();
        Self::Invalid {
            kind,
            text: NamedSource::new(visible(file), shown(text)).with_language("toml"),
            problems,
        }
    }
}

/// A text line for line, without what is hidden in it.
fn shown(text: &str) -> String {
    text.split('\n').map(visible).collect::<Vec<_>>().join("\n")
}

impl Problem {
    fn locate(kind: &Kind, fault: Fault, text: &str) -> Self {
        let before = text.get(..fault.at.start).unwrap_or(text);
        let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
        Self {
            code: kind.code,
            message: visible(&fault.message).into_owned(),
            line: before.matches('\n').count() + 1,
            column: before[line_start..].chars().count() + 1,
            // In the text as it is shown.
            span: (
                shown(before).len(),
                text.get(fault.at).map_or(0, |at| shown(at).len()),
            )
                .into(),
            label: fault.label,
            hint: fault.hint.map(|hint| visible(&hint).into_owned()),
        }
    }
}
