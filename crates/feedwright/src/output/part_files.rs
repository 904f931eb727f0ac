//! Unfinished files, in the folders of their targets: `.feedwright-XXXXXX.part`.
//!
//! The process that writes a file locks it. If that process is killed, its files stay and the
//! system releases their locks. The next process that writes into the same folder removes the files
//! that no process holds.

use std::ffi::OsStr;
use std::fs::{self, File};
use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Mutex, MutexGuard, PoisonError};

use tempfile::TempPath;

const PREFIX: &str = ".feedwright-";
const SUFFIX: &str = ".part";
/// Attempts to create a file. An attempt fails if another process removes the file before it is
/// locked.
const ATTEMPTS: usize = 8;

/// The files that this process began. Whoever holds the lock decides what becomes of them.
static BEGUN: Mutex<Vec<PathBuf>> = Mutex::new(Vec::new());

/// Keeps the files under way as they are until the guard is dropped.
pub(super) fn held() -> MutexGuard<'static, Vec<PathBuf>> {
    BEGUN.lock().unwrap_or_else(PoisonError::into_inner)
}

/// A file under way.
pub(super) struct PartFile {
    path: TempPath,
    /// Holds the lock.
    _lock: File,
}

impl PartFile {
    /// One for a target in a folder, and the file to write to; what earlier processes left there is
    /// removed.
    pub(super) fn create(target: &Path, folder: &Path) -> io::Result<(File, Self)> {
        remove_abandoned(folder);
        for _ in 0..ATTEMPTS {
            let (file, path) = create_beside(target, folder)?;
            let lock = file.try_clone()?;
            hold(&lock);
            if path.exists() {
                held().push(path.to_path_buf());
                return Ok((file, Self { path, _lock: lock }));
            }
        }
        Err(io::Error::other(
            "the file is removed by another process each time",
        ))
    }

    /// Moves it to its target.
    pub(super) fn persist(self, target: &Path) -> io::Result<()> {
        self.path.persist(target).map_err(|failed| failed.error)
    }
}

/// The error without the name of the hidden file, which the user did not choose.
fn of_the_system(error: io::Error) -> io::Error {
    let text = error.to_string();
    match text.split_once(" at path ") {
        Some((what, _)) => io::Error::new(error.kind(), what.to_owned()),
        None => error,
    }
}

fn create_beside(target: &Path, folder: &Path) -> io::Result<(File, TempPath)> {
    let mut builder = tempfile::Builder::new();
    builder.prefix(PREFIX).suffix(SUFFIX);
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // A file that is replaced keeps its permissions; a new one gets what the user's umask
        // leaves.
        let mode = fs::metadata(target).map_or(0o666, |found| found.permissions().mode());
        builder.permissions(fs::Permissions::from_mode(mode & 0o777));
    }
    #[cfg(not(unix))]
    let _ = target;
    Ok(builder
        .tempfile_in(folder)
        .map_err(of_the_system)?
        .into_parts())
}

/// Removes the files under way that no process holds. What cannot be looked at, or removed, stays.
pub(crate) fn remove_abandoned(folder: &Path) {
    let Ok(entries) = fs::read_dir(folder) else {
        return;
    };
    for entry in entries.flatten() {
        let is_ours =
            is_part(&entry.file_name()) && entry.file_type().is_ok_and(|kind| kind.is_file());
        if is_ours && File::open(entry.path()).is_ok_and(|file| is_abandoned(&file)) {
            let _ = fs::remove_file(entry.path());
        }
    }
}

fn is_part(name: &OsStr) -> bool {
    name.to_str()
        .is_some_and(|name| name.starts_with(PREFIX) && name.ends_with(SUFFIX))
}

/// Holds a file. Where the file system has no locks, nothing is removed either.
#[cfg(unix)]
fn hold(file: &File) {
    let _ = rustix::fs::flock(file, rustix::fs::FlockOperation::LockExclusive);
}

#[cfg(unix)]
fn is_abandoned(file: &File) -> bool {
    rustix::fs::flock(file, rustix::fs::FlockOperation::NonBlockingLockExclusive).is_ok()
}

#[cfg(not(unix))]
fn hold(_: &File) {}

#[cfg(not(unix))]
fn is_abandoned(_: &File) -> bool {
    false
}
