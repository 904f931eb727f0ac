//! Why a LinuxCNC configuration cannot be read or its copies cannot be written.

use std::io;
use std::path::{Path, PathBuf};

use feedwright_sim::MachineError;
use miette::Diagnostic;
use thiserror::Error;

use crate::output::OutputError;

/// Reasons why there is no wiring.
#[derive(Debug, Error, Diagnostic)]
pub enum LinuxcncSetupError {
    /// A file of the configuration cannot be read.
    #[error("cannot read {}{}: {source}", path.display(), named_in(named.as_deref()))]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// Place that names the file, if another file does.
        named: Option<String>,
        /// Cause.
        source: io::Error,
        /// Remedy.
        #[help]
        hint: String,
    },
    /// A line of the configuration is not understood.
    #[error("{place}: {message}")]
    Line {
        /// File and line.
        place: String,
        /// Description of the mistake.
        message: String,
        /// Remedy.
        #[help]
        hint: String,
    },
    /// Copies were changed by hand.
    #[error("changed by hand since the last setup: {}", paths.iter().map(|path| path.display().to_string()).collect::<Vec<_>>().join(", "))]
    #[diagnostic(help("rename what you want to keep, or replace all with --replace"))]
    ChangedByHand {
        /// The files.
        paths: Vec<PathBuf>,
    },
    /// Files with the names of the copies are there, and no setup wrote them.
    #[error("{} is there already, and setup did not write it", path.display())]
    #[diagnostic(help("rename it, or replace it with --replace"))]
    InTheWay {
        /// The file.
        path: PathBuf,
    },
    /// No earlier setup to undo was found.
    #[error("nothing to undo: there is no {}", path.display())]
    #[diagnostic(help("name the INI file that setup was given, not the copy"))]
    NothingToUndo {
        /// The manifest.
        path: PathBuf,
    },
    /// A copy cannot be removed.
    #[error("cannot remove {}: {source}", path.display())]
    Removing {
        /// The file.
        path: PathBuf,
        /// Cause.
        source: io::Error,
    },
    /// The machine that stands in for drives is not known.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Machine(#[from] MachineError),
    /// A copy cannot be written.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Output(#[from] OutputError),
}

impl LinuxcncSetupError {
    /// A file that cannot be read; `named` is where it is named.
    pub(super) fn unreadable(path: &Path, named: Option<String>, source: io::Error) -> Self {
        let hint = match source.kind() {
            io::ErrorKind::NotFound if named.is_some() => {
                "LinuxCNC does not find it either: correct the name"
            }
            io::ErrorKind::NotFound => "name the INI file of the configuration, with its folder",
            io::ErrorKind::IsADirectory => "name the INI file in it",
            _ => "make it readable, for example with chmod u+r",
        };
        Self::Unreadable {
            path: path.to_owned(),
            named,
            source,
            hint: hint.to_owned(),
        }
    }
}

fn named_in(place: Option<&str>) -> String {
    place.map_or_else(String::new, |place| format!(", named in {place}"))
}
