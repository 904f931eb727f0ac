//! Why an output file is not there: what, where, how much room, and what to do.

use std::io;
use std::path::{Path, PathBuf};

use feedwright_sim::Cancelled;
use miette::Diagnostic;
use thiserror::Error;

use super::is_standard_output;

/// An output file cannot be written.
#[derive(Debug, Error, Diagnostic)]
pub enum OutputError {
    /// The target names a directory.
    #[error("cannot write {}: it is a directory", path.display())]
    #[diagnostic(help("add a file name"))]
    IsDirectory {
        /// The target.
        path: PathBuf,
    },
    /// The target is an input of the same run.
    #[error("cannot write {}: it would replace {}, which this run reads", path.display(), input.display())]
    #[diagnostic(help("give the output another name"))]
    IsInput {
        /// The target.
        path: PathBuf,
        /// The input.
        input: PathBuf,
    },
    /// Two outputs of a run have the same target.
    #[error("cannot write {}: another output of this run goes there too", path.display())]
    #[diagnostic(help("give every output a name of its own"))]
    Twice {
        /// The target.
        path: PathBuf,
    },
    /// The work was canceled.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Cancelled(#[from] Cancelled),
    /// The operating system refuses.
    #[error("cannot {step} {}: {source}{}", target(path), room(*free_bytes))]
    Io {
        /// Operation that failed.
        step: FileOperation,
        /// The target.
        path: PathBuf,
        /// Free bytes at the target; known where the disk is full.
        free_bytes: Option<u64>,
        /// Cause.
        source: io::Error,
        /// Remedy.
        #[help]
        hint: Option<String>,
    },
}

/// Operation that the operating system refused.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FileOperation {
    /// Creating the file beside its target.
    Create,
    /// Writing to it.
    Write,
    /// Renaming it to its target.
    Rename,
}

impl std::fmt::Display for FileOperation {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(match self {
            Self::Create => "create",
            Self::Write => "write",
            Self::Rename => "replace",
        })
    }
}

impl OutputError {
    /// An error of the operating system, with the remedy that fits it.
    pub(crate) fn io(step: FileOperation, path: &Path, folder: &Path, source: io::Error) -> Self {
        let (mut free_bytes, mut hint) = (None, None);
        match source.kind() {
            // Some folders exist and take no files.
            io::ErrorKind::NotFound if folder.is_dir() => {}
            io::ErrorKind::StorageFull if is_standard_output(path) => {
                hint =
                    Some("make room where the standard output goes, or write to a file".to_owned());
            }
            // A device has no room of its own, whatever is free around it.
            io::ErrorKind::StorageFull if path.exists() && !path.is_file() => {}
            io::ErrorKind::NotFound => {
                hint = Some(format!(
                    "create the directory first: mkdir -p {}",
                    folder.display()
                ));
            }
            io::ErrorKind::PermissionDenied | io::ErrorKind::ReadOnlyFilesystem => {
                hint = Some(format!(
                    "the file is made in {}, which has to be writable",
                    folder.display()
                ));
            }
            io::ErrorKind::StorageFull | io::ErrorKind::QuotaExceeded => {
                free_bytes = free_bytes_in(folder);
                hint = Some(format!(
                    "make room in {}, or write to another disk; nothing was left behind",
                    folder.display()
                ));
            }
            io::ErrorKind::NotADirectory => {
                hint = Some(format!("{} is a file, not a directory", folder.display()));
            }
            _ => {}
        }
        Self::Io {
            step,
            path: path.to_owned(),
            free_bytes,
            source,
            hint,
        }
    }

    /// The error that [`super::OutputFile`] put into an `io::Error`, out of which writers above it
    /// hand it back; `path` is named where it is some other error.
    pub fn from_io(error: io::Error, path: &Path) -> Self {
        match error.downcast::<Self>() {
            Ok(inner) => inner,
            Err(source) => Self::Io {
                step: FileOperation::Write,
                path: path.to_owned(),
                free_bytes: None,
                source,
                hint: None,
            },
        }
    }
}

/// Returns the name of a target in messages.
fn target(path: &Path) -> String {
    if is_standard_output(path) {
        "the standard output".to_owned()
    } else {
        path.display().to_string()
    }
}

fn room(free_bytes: Option<u64>) -> String {
    free_bytes.map_or_else(String::new, |free| format!("; {free} bytes are free there"))
}

#[cfg(unix)]
fn free_bytes_in(folder: &Path) -> Option<u64> {
    let disk = rustix::fs::statvfs(folder).ok()?;
    disk.f_bavail.checked_mul(disk.f_frsize)
}

#[cfg(not(unix))]
fn free_bytes_in(_folder: &Path) -> Option<u64> {
    None
}
