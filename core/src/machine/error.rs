//! What can be wrong with a machine file, each with its place and, where one is likely, a remedy.

use std::io;
use std::ops::Range;
use std::path::{Path, PathBuf};

use miette::{Diagnostic, NamedSource, SourceSpan};
use thiserror::Error;

use super::BUILT_IN;
use crate::gcode::suggestion::nearest;

/// Why there is no machine.
#[derive(Debug, Error, Diagnostic)]
pub enum MachineError {
    /// The name is none of the built-in machines.
    #[error("no machine is called '{name}'; there is {known}")]
    UnknownName {
        /// As it was given.
        name: String,
        /// The names there are, for people.
        known: String,
        /// Remedy.
        #[help]
        hint: String,
    },
    /// The file cannot be read.
    #[error("cannot read machine file {}: {source}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
        /// Remedy.
        #[help]
        hint: Option<String>,
    },
    /// The file is far larger than any machine file.
    #[error("{} is larger than {limit_bytes} bytes: this is no machine file", path.display())]
    #[diagnostic(help("a machine file is a page of TOML text, like machines/tnv40.toml"))]
    TooLarge {
        /// The file.
        path: PathBuf,
        /// Largest size that is read.
        limit_bytes: u64,
    },
    /// The file is not UTF-8 text.
    #[error("{} is not text: byte 0x{byte:02x} at offset {offset} is not UTF-8", path.display())]
    #[diagnostic(help("a machine file is TOML text in UTF-8; was another file meant?"))]
    NotText {
        /// The file.
        path: PathBuf,
        /// Offset of the first byte that is no text.
        offset: usize,
        /// That byte.
        byte: u8,
    },
    /// The text has faults; all that were found.
    #[error("machine file {file} has {} {}", problems.len(), if problems.len() == 1 { "fault" } else { "faults" })]
    Invalid {
        /// Name of the file, for people.
        file: String,
        /// The text, for carets.
        #[source_code]
        text: NamedSource<String>,
        /// The faults, in the order of the text.
        #[related]
        problems: Vec<Problem>,
    },
}

/// A fault in the text of a machine file.
#[derive(Debug, Clone, PartialEq, Eq, Error, Diagnostic)]
#[error("{message}")]
#[diagnostic(code(machine::file))]
pub struct Problem {
    /// What is wrong: key, value, limit, unit.
    pub message: String,
    /// Line of the text, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// Place in the text.
    #[label("{label}")]
    pub span: SourceSpan,
    /// Short word beside the caret.
    pub label: &'static str,
    /// Remedy.
    #[help]
    pub hint: Option<String>,
}

/// A fault before its line and column are known.
#[derive(Debug)]
pub(super) struct Fault {
    pub(super) at: Range<usize>,
    pub(super) label: &'static str,
    pub(super) message: String,
    pub(super) hint: Option<String>,
}

impl MachineError {
    /// No such built-in machine; `is_file` when a file of that name stands in the current directory.
    pub(super) fn unknown_name(name: &str, is_file: bool) -> Self {
        let names: Vec<&str> = BUILT_IN.iter().map(|(name, _)| *name).collect();
        let hint = if is_file {
            format!("for the file of that name, write ./{name}")
        } else {
            match nearest(name, &names) {
                Some(near) => format!("did you mean '{near}'?"),
                None => "a machine of your own is a file: give its path, ending in .toml".to_owned(),
            }
        };
        Self::UnknownName { name: name.to_owned(), known: names.join(", "), hint }
    }

    /// The operating system does not give the file.
    pub(super) fn unreadable(path: &Path, source: io::Error) -> Self {
        let hint = match source.kind() {
            io::ErrorKind::NotFound => {
                Some("a name without .toml means a built-in machine; 'feedwright machines' lists them".to_owned())
            }
            io::ErrorKind::IsADirectory => Some("give a file of that directory".to_owned()),
            _ => None,
        };
        Self::Unreadable { path: path.to_owned(), source, hint }
    }

    /// The faults of a text, sorted by place.
    pub(super) fn invalid(file: &str, text: &str, mut faults: Vec<Fault>) -> Self {
        faults.sort_by_key(|fault| (fault.at.start, fault.at.end));
        let problems = faults.into_iter().map(|fault| Problem::locate(fault, text)).collect();
        Self::Invalid {
            file: file.to_owned(),
            text: NamedSource::new(file, text.to_owned()).with_language("toml"),
            problems,
        }
    }
}

impl Problem {
    fn locate(fault: Fault, text: &str) -> Self {
        let before = text.get(..fault.at.start).unwrap_or(text);
        let line_start = before.rfind('\n').map_or(0, |newline| newline + 1);
        Self {
            message: fault.message,
            line: before.matches('\n').count() + 1,
            column: before[line_start..].chars().count() + 1,
            span: (fault.at.start, fault.at.len()).into(),
            label: fault.label,
            hint: fault.hint,
        }
    }
}
