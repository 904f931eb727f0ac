//! Long work in parts: on several threads, and kept in a file, so that a run that was killed can
//! continue.
//!
//! The file has a line of JSON for each finished part, with a checksum. The first line says what
//! the file is and which work it belongs to. A line that is not complete, and all behind it, counts
//! as not finished. A file of other work is begun anew. A file that is something else stays as it
//! is, and nothing is kept. The same holds where the file cannot be written: the disk is full, or
//! another process has the file.

use std::collections::HashMap;
use std::fmt;
use std::fs::{File, TryLockError};
use std::io::{BufRead, BufReader, Read, Seek, SeekFrom, Write};
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::thread;
use std::time::Duration;

use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

use crate::checked_json::{checked, with_check};

/// Format of the file. Increase it whenever the same work has another result.
const FORMAT: u32 = 2;
const ABOUT: &str = "finished parts of a feedwright correct that has not ended; the same command goes on with them; may be deleted";

/// Number of tries for a lock that another process holds, and the wait between them.
const LOCK_TRIES: u32 = 20;
const LOCK_WAIT: Duration = Duration::from_millis(10);

/// The first line of the file.
#[derive(Serialize, Deserialize, PartialEq)]
struct KeptHead {
    about: String,
    format: u32,
    version: String,
    /// Hash of all that the work depends on.
    work: String,
}

impl KeptHead {
    /// Parses a line; none if the checksum does not match or the line is not a head.
    fn of(line: &str) -> Option<Self> {
        serde_json::from_str(&checked(line)?).ok()
    }
}

/// A finished part.
#[derive(Serialize, Deserialize)]
struct KeptPart<T> {
    part: String,
    result: T,
}

/// Reason why parts of a file are not used, or no parts are kept.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum KeptFault {
    /// The file belongs to other work.
    OtherWork,
    /// A line was changed after it was written.
    Damaged,
    /// The file is not a file of finished parts.
    Foreign,
    /// The file cannot be opened or written, or another process uses it.
    Unwritable,
}

impl fmt::Display for KeptFault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::OtherWork => "belongs to another program, machine, option or version; all pieces were corrected anew",
            Self::Damaged => "is damaged; the pieces from the damaged line on were corrected anew",
            Self::Foreign => "holds no pieces of feedwright; it stays as it is, and no piece was kept for another run",
            Self::Unwritable => "cannot be written, or another run uses it; pieces were not kept for another run",
        })
    }
}

/// Does work in parts.
pub(super) struct Workers {
    threads: usize,
    /// Lines of the parts that an earlier run finished, by their name.
    found: HashMap<String, String>,
    /// File for finished parts.
    file: Mutex<Option<File>>,
    /// Fault of the file when it was opened.
    fault: Option<KeptFault>,
    /// True where a part could not be written.
    is_lost: AtomicBool,
}

impl Workers {
    /// Creates workers that keep nothing.
    pub(super) fn new(threads: usize) -> Self {
        Self {
            threads,
            found: HashMap::new(),
            file: Mutex::new(None),
            fault: None,
            is_lost: AtomicBool::new(false),
        }
    }

    /// Creates workers that keep finished parts in a file, and continue with the parts that it has.
    /// `work` is a hash of all that the work depends on.
    pub(super) fn keeping(threads: usize, path: &Path, work: &str) -> Self {
        let head = KeptHead {
            about: ABOUT.to_owned(),
            format: FORMAT,
            version: env!("CARGO_PKG_VERSION").to_owned(),
            work: work.to_owned(),
        };
        match opened(path, &head) {
            Ok((found, file, fault)) => Self {
                found,
                file: Mutex::new(Some(file)),
                fault,
                ..Self::new(threads)
            },
            Err(fault) => Self {
                fault: Some(fault),
                ..Self::new(threads)
            },
        }
    }

    /// Returns the fault of the file, if it has one.
    pub(super) fn fault(&self) -> Option<KeptFault> {
        self.fault.or_else(|| {
            self.is_lost
                .load(Ordering::Relaxed)
                .then_some(KeptFault::Unwritable)
        })
    }

    /// Returns the results of `count` parts in their order, for any number of threads, which is at
    /// most `threads`. Parts are kept by the name of the work and their number.
    ///
    /// # Errors
    /// The error of the first part that failed. No part starts after that.
    pub(super) fn each<T, E>(
        &self,
        name: &str,
        count: usize,
        threads: usize,
        work: impl Fn(usize) -> Result<T, E> + Sync,
    ) -> Result<Vec<T>, E>
    where
        T: Serialize + DeserializeOwned + Send,
        E: Send,
    {
        let (next, failed) = (AtomicUsize::new(0), AtomicBool::new(false));
        let results: Mutex<Vec<Option<Result<T, E>>>> =
            Mutex::new((0..count).map(|_| None).collect());
        let run = || loop {
            let part = next.fetch_add(1, Ordering::Relaxed);
            if part >= count || failed.load(Ordering::Relaxed) {
                return;
            }
            let result = self.kept(&format!("{name} {part}"), || work(part));
            failed.fetch_or(result.is_err(), Ordering::Relaxed);
            results.lock().unwrap_or_else(PoisonError::into_inner)[part] = Some(result);
        };
        thread::scope(|scope| {
            for _ in 1..self.threads.min(threads).min(count) {
                scope.spawn(run);
            }
            run();
        });
        results
            .into_inner()
            .unwrap_or_else(PoisonError::into_inner)
            .into_iter()
            .flatten()
            .collect()
    }

    /// Returns the result of a part, from the file if the file has it.
    fn kept<T: Serialize + DeserializeOwned, E>(
        &self,
        name: &str,
        work: impl FnOnce() -> Result<T, E>,
    ) -> Result<T, E> {
        let found = self
            .found
            .get(name)
            .and_then(|text| serde_json::from_str::<KeptPart<T>>(text).ok());
        if let Some(found) = found {
            return Ok(found.result);
        }
        let result = work()?;
        let mut file = self.file.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some(open) = file.as_mut() {
            let part = KeptPart {
                part: name.to_owned(),
                result: &result,
            };
            if append(open, &part).is_err() {
                *file = None;
                self.is_lost.store(true, Ordering::Relaxed);
            }
        }
        Ok(result)
    }
}

/// Returns true if a file keeps finished parts.
pub(super) fn keeps_parts(path: &Path) -> bool {
    let mut first = String::new();
    let read = File::open(path).and_then(|file| BufReader::new(file).read_line(&mut first));
    let head = read.ok().and_then(|_| KeptHead::of(&first));
    head.is_some_and(|head| head.about == ABOUT)
}

/// Removes a file that keeps finished parts. Other files stay.
///
/// # Errors
/// A file that cannot be removed.
pub(super) fn forget(path: &Path) -> std::io::Result<()> {
    if keeps_parts(path) {
        std::fs::remove_file(path)
    } else {
        Ok(())
    }
}

/// Appends a line to the file; if it does not fit, the file keeps none of it.
fn append(file: &mut File, line: &impl Serialize) -> std::io::Result<()> {
    let end = file.seek(SeekFrom::End(0))?;
    let line = format!("{}\n", with_check(&serde_json::to_string(line)?));
    let written = file
        .write_all(line.as_bytes())
        .and_then(|()| file.sync_data());
    written.inspect_err(|_| {
        // If this fails too, the checksum reveals the torn line.
        let _ = file.set_len(end);
    })
}

/// Finished parts of a file by their names, the file, and the reason why some are missing.
type OpenedParts = (HashMap<String, String>, File, Option<KeptFault>);

/// Opens a file of finished parts, and starts it anew if it has no parts.
///
/// # Errors
/// A file that holds something else, and one that cannot be opened or locked.
fn opened(path: &Path, head: &KeptHead) -> Result<OpenedParts, KeptFault> {
    let unwritable = |_: std::io::Error| KeptFault::Unwritable;
    let mut file = File::options()
        .read(true)
        .write(true)
        .create(true)
        .truncate(false)
        .open(path)
        .map_err(unwritable)?;
    lock(&file).map_err(|_| KeptFault::Unwritable)?;
    let mut text = String::new();
    file.read_to_string(&mut text)
        .map_err(|_| KeptFault::Foreign)?;
    let first = text.split_inclusive('\n').next().unwrap_or_default();
    let begun = KeptHead::of(first).filter(|_| first.ends_with('\n'));
    let is_ours = begun.as_ref().is_some_and(|begun| begun.about == ABOUT);
    if !is_ours && !text.is_empty() && !is_torn_head(&text) {
        return Err(KeptFault::Foreign);
    }
    let mut fault = begun
        .as_ref()
        .filter(|begun| *begun != head)
        .map(|_| KeptFault::OtherWork);
    let mut found = HashMap::new();
    let mut good = 0;
    if is_ours && fault.is_none() {
        good = first.len();
        for line in text[good..].split_inclusive('\n') {
            let part = checked(line).filter(|_| line.ends_with('\n'));
            let Some((name, part)) = part.and_then(|part| Some((name_of(&part)?, part))) else {
                // A run that was killed leaves a line without an end.
                fault = line.ends_with('\n').then_some(KeptFault::Damaged);
                break;
            };
            found.insert(name, part);
            good += line.len();
        }
    }
    file.set_len(good as u64).map_err(unwritable)?;
    if good == 0 {
        append(&mut file, head).map_err(unwritable)?;
    }
    Ok((found, file, fault))
}

/// Locks a file for this run. A process that is just being started holds earlier locks for a
/// moment.
fn lock(file: &File) -> Result<(), TryLockError> {
    for _ in 0..LOCK_TRIES {
        if file.try_lock().is_ok() {
            return Ok(());
        }
        thread::sleep(LOCK_WAIT);
    }
    file.try_lock()
}

/// Returns true if the first line is incomplete: a run was killed, or the disk was full, while it
/// was written.
fn is_torn_head(text: &str) -> bool {
    text.len() < 2 * ABOUT.len() + 200
        && !text.contains('\n')
        && with_check("{}").starts_with(&text[..text.len().min(10)])
}

fn name_of(part: &str) -> Option<String> {
    serde_json::from_str::<KeptPart<serde::de::IgnoredAny>>(part)
        .ok()
        .map(|part| part.part)
}

/// Hashes what is printed.
struct HashedText(blake3::Hasher);

impl fmt::Write for HashedText {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        self.0.update(text.as_bytes());
        Ok(())
    }
}

/// Returns a hash of the printed form of some values, as hexadecimal digits.
pub(super) fn hash_of(values: fmt::Arguments<'_>) -> String {
    let mut text = HashedText(blake3::Hasher::new());
    // Writing to a hash does not fail.
    let _ = fmt::Write::write_fmt(&mut text, values);
    text.0.finalize().to_hex().to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Does three parts, and returns their results and how many were not found in the file.
    fn done(path: &Path, work: &str, threads: usize) -> (Vec<f64>, usize) {
        let anew = AtomicUsize::new(0);
        let workers = Workers::keeping(threads, path, work);
        let part = |part: usize| {
            anew.fetch_add(1, Ordering::Relaxed);
            Ok::<f64, ()>(1.0 / (3.0 + part as f64))
        };
        (
            workers.each("piece", 3, threads, part).unwrap(),
            anew.into_inner(),
        )
    }

    #[test]
    fn finished_parts_are_found_again_to_the_bit_unless_they_are_of_other_work() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("kept");
        let all = vec![1.0 / 3.0, 0.25, 0.2];
        assert_eq!(done(&path, "a", 2), (all.clone(), 3));
        assert_eq!(done(&path, "a", 1), (all.clone(), 0));
        assert_eq!(done(&path, "b", 1), (all.clone(), 3));
        assert_eq!(done(&path, "a", 1), (all, 3));
        forget(&path).unwrap();
        assert!(!path.exists());
    }

    #[test]
    fn a_file_that_ends_anywhere_gives_the_same_results() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("kept");
        let (all, _) = done(&path, "a", 1);
        let whole = std::fs::read(&path).unwrap();
        let line_ends: Vec<usize> = (0..whole.len()).filter(|&at| whole[at] == b'\n').collect();
        for length in 0..whole.len() {
            std::fs::write(&path, &whole[..length]).unwrap();
            let finished = line_ends
                .iter()
                .filter(|&&end| end < length)
                .count()
                .saturating_sub(1);
            assert_eq!(
                done(&path, "a", 1),
                (all.clone(), 3 - finished),
                "{length} bytes"
            );
            assert_eq!(std::fs::read(&path).unwrap(), whole, "{length} bytes");
        }
    }

    #[test]
    fn a_file_of_something_else_stays_as_it_is() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("kept");
        for text in ["G0 X1\n", "{\"check\":\"0123456789abcdef\",\"mine\":1}\n"] {
            std::fs::write(&path, text).unwrap();
            assert_eq!(done(&path, "a", 1).1, 3);
            forget(&path).unwrap();
            assert_eq!(std::fs::read_to_string(&path).unwrap(), text);
        }
    }

    #[test]
    fn a_line_that_was_changed_is_not_taken_and_the_fault_is_told() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("kept");
        let (all, _) = done(&path, "a", 1);
        let fault = |work: &str| Workers::keeping(1, &path, work).fault();
        assert_eq!(fault("a"), None);
        let text = std::fs::read_to_string(&path).unwrap();
        assert_eq!(text.matches("0.25").count(), 1);
        std::fs::write(&path, text.replace("0.25", "0.75")).unwrap();
        assert_eq!(fault("a"), Some(KeptFault::Damaged));
        assert_eq!(done(&path, "a", 1), (all, 2));
        assert_eq!(fault("b"), Some(KeptFault::OtherWork));
        std::fs::write(&path, "G0 X1\n").unwrap();
        assert_eq!(fault("b"), Some(KeptFault::Foreign));
        assert_eq!(
            Workers::keeping(1, folder.path(), "a").fault(),
            Some(KeptFault::Unwritable)
        );
    }

    #[test]
    fn the_first_part_that_fails_ends_the_work() {
        let begun = AtomicUsize::new(0);
        let part = |part: usize| {
            begun.fetch_add(1, Ordering::Relaxed);
            if part < 2 { Ok(part) } else { Err(part) }
        };
        assert_eq!(Workers::new(1).each("piece", 100, 1, part), Err(2));
        assert_eq!(begun.into_inner(), 3);
    }
}
