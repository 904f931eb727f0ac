//! Why a file is no log that can be used.

use std::io;
use std::path::{Path, PathBuf};

use feedwright_sim::Cancelled;
use miette::Diagnostic;
use thiserror::Error;

/// Why there is no log.
#[derive(Debug, Error, Diagnostic)]
pub enum LogError {
    /// The file cannot be read.
    #[error("cannot read log {}: {source}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// Why.
        source: io::Error,
        /// Remedy.
        #[help]
        hint: Option<&'static str>,
    },
    /// The file is in no supported format, or it is damaged or incomplete.
    #[error("{}{}: {message}", path.display(), line_of(*line))]
    Format {
        /// The file.
        path: PathBuf,
        /// Line of the text, from 1, where it is text.
        line: Option<u64>,
        /// Description of the error.
        message: String,
        /// Remedy.
        #[help]
        hint: String,
    },
    /// It is not known which column is what.
    #[error("{}: {message}", path.display())]
    Columns {
        /// The file.
        path: PathBuf,
        /// Description of the missing or wrong assignment.
        message: String,
        /// Remedy: how to assign the columns with `--columns`.
        #[help]
        hint: String,
    },
    /// The record is readable, but no servo model can be made of it.
    #[error("{} is refused: {}", path.display(), listed(refusals))]
    Refused {
        /// The file.
        path: PathBuf,
        /// Every reason that was found.
        #[related]
        refusals: Vec<Refusal>,
    },
    /// It does not belong to the log before it.
    #[error("{}: {message}", path.display())]
    Apart {
        /// The file.
        path: PathBuf,
        /// Description of the difference.
        message: String,
        /// Remedy.
        #[help]
        hint: String,
    },
    /// The reading was ended from outside.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Cancelled(#[from] Cancelled),
}

/// One reason for which a record is refused.
#[derive(Debug, Clone, PartialEq, Eq, Error, Diagnostic)]
#[error("{message}")]
pub struct Refusal {
    /// Reason of the refusal.
    pub reason: RefusalReason,
    /// Place, value, limit, unit.
    pub message: String,
    /// Remedy.
    #[help]
    pub hint: String,
}

/// Reasons for which a record is refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum RefusalReason {
    /// Too few samples a second.
    TooSlow,
    /// Too few digits.
    TooCoarse,
    /// The actual position is constant or a copy of the command.
    FeedbackNotConnected,
    /// The actual position leads the command.
    Swapped,
    /// The actual position follows the command of another axis, or does not follow its own command.
    Mixed,
    /// Nothing moves.
    Constant,
    /// A value is no number.
    NotANumber,
    /// Time runs backward or stands still.
    Backward,
    /// Too few samples.
    TooShort,
}

impl LogError {
    /// A file that the system does not hand out.
    pub(super) fn unreadable(source: io::Error) -> Self {
        let hint = match source.kind() {
            io::ErrorKind::IsADirectory => Some("name a file in it"),
            io::ErrorKind::NotFound => {
                Some("name the file that the recorder wrote, with its folder")
            }
            _ => None,
        };
        Self::Unreadable {
            path: PathBuf::new(),
            source,
            hint,
        }
    }

    /// A file that is not what it should be.
    pub(super) fn format(
        line: Option<u64>,
        message: impl Into<String>,
        hint: impl Into<String>,
    ) -> Self {
        Self::Format {
            path: PathBuf::new(),
            line,
            message: message.into(),
            hint: hint.into(),
        }
    }

    /// Columns that are missing.
    pub(super) fn columns(message: impl Into<String>, hint: impl Into<String>) -> Self {
        Self::Columns {
            path: PathBuf::new(),
            message: message.into(),
            hint: hint.into(),
        }
    }

    /// A log of something else than the one before it.
    pub(super) fn apart(message: String, hint: &str) -> Self {
        Self::Apart {
            path: PathBuf::new(),
            message,
            hint: hint.to_owned(),
        }
    }

    /// A record that is refused.
    pub(super) fn refused(refusals: impl Into<Vec<Refusal>>) -> Self {
        Self::Refused {
            path: PathBuf::new(),
            refusals: refusals.into(),
        }
    }

    /// The same error of a file: readers report errors without it, and the place where the file was
    /// opened adds it.
    pub(super) fn in_file(mut self, file: &Path) -> Self {
        match &mut self {
            Self::Unreadable { path, .. }
            | Self::Format { path, .. }
            | Self::Columns { path, .. }
            | Self::Refused { path, .. }
            | Self::Apart { path, .. } => file.clone_into(path),
            Self::Cancelled(_) => {}
        }
        self
    }

    /// The reasons for which a record is refused; none where the file is at fault.
    pub fn reasons(&self) -> Vec<RefusalReason> {
        match self {
            Self::Refused { refusals, .. } => {
                refusals.iter().map(|refusal| refusal.reason).collect()
            }
            _ => Vec::new(),
        }
    }
}

impl Refusal {
    /// One reason.
    pub(super) fn new(
        reason: RefusalReason,
        message: impl Into<String>,
        hint: impl Into<String>,
    ) -> Self {
        Self {
            reason,
            message: message.into(),
            hint: hint.into(),
        }
    }
}

fn line_of(line: Option<u64>) -> String {
    line.map_or_else(String::new, |line| format!(", line {line}"))
}

/// Returns the message of a single reason; several are listed below the error.
fn listed(refusals: &[Refusal]) -> String {
    match refusals {
        [only] => only.message.clone(),
        several => format!("{} reasons", several.len()),
    }
}
