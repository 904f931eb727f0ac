//! Long work in parts, on several threads. Finished parts are kept in a folder, so that a run that
//! was killed can continue. Where they cannot be written, because the disk is full or a file is in
//! the place of the folder, the work goes on without.

#[cfg(feature = "files")]
use std::path::Path;
use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};
use std::thread;

use serde::Serialize;
use serde::de::DeserializeOwned;

#[cfg(feature = "files")]
use crate::store::{Store, key_of};

/// Increase it whenever the same work has another result.
#[cfg(feature = "files")]
const FORMAT: u32 = 3;

/// Does work in parts.
pub(super) struct Workers {
    threads: usize,
    /// Store of finished parts, and the key of all that the work depends on.
    #[cfg(feature = "files")]
    finished: Option<(Store, String)>,
    /// True where a part could not be written.
    is_lost: AtomicBool,
}

impl Workers {
    /// Creates workers that keep nothing.
    pub(super) fn new(threads: usize) -> Self {
        Self {
            threads,
            #[cfg(feature = "files")]
            finished: None,
            is_lost: AtomicBool::new(false),
        }
    }

    /// Creates workers that keep finished parts in a folder, and continue with the parts that it
    /// has. `work` is the key of all that the work depends on.
    #[cfg(feature = "files")]
    pub(super) fn keeping(threads: usize, folder: &Path, work: String) -> Self {
        Self {
            finished: Some((Store::new(folder.to_owned()), work)),
            ..Self::new(threads)
        }
    }

    /// Returns true if a finished part could not be kept.
    pub(super) fn is_lost(&self) -> bool {
        self.is_lost.load(Ordering::Relaxed)
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

    /// Returns the result of a part, from the store if the store has it.
    fn kept<T: Serialize + DeserializeOwned, E>(
        &self,
        name: &str,
        work: impl FnOnce() -> Result<T, E>,
    ) -> Result<T, E> {
        #[cfg(feature = "files")]
        if let Some((store, all)) = &self.finished {
            let version = env!("CARGO_PKG_VERSION");
            let key = key_of(&[
                &FORMAT.to_le_bytes(),
                version.as_bytes(),
                all.as_bytes(),
                name.as_bytes(),
            ]);
            if let Some(found) = store.get(&key) {
                return Ok(found);
            }
            let result = work()?;
            let is_lost = store.put(&key, &result).is_err();
            self.is_lost.fetch_or(is_lost, Ordering::Relaxed);
            return Ok(result);
        }
        #[cfg(not(feature = "files"))]
        let _ = name;
        work()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Does three parts, and returns their results and how many were not found in the folder.
    fn done(folder: &Path, work: &str, threads: usize) -> (Vec<f64>, usize) {
        let anew = AtomicUsize::new(0);
        let workers = Workers::keeping(threads, folder, work.to_owned());
        let part = |part: usize| {
            anew.fetch_add(1, Ordering::Relaxed);
            Ok::<f64, ()>(1.0 / (3.0 + part as f64))
        };
        let all = workers.each("piece", 3, threads, part).unwrap();
        assert_eq!(workers.is_lost(), !folder.is_dir());
        (all, anew.into_inner())
    }

    #[test]
    fn finished_parts_are_found_again_to_the_bit_unless_they_are_of_other_work() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("kept");
        let all = vec![1.0 / 3.0, 0.25, 0.2];
        assert_eq!(done(&path, "a", 2), (all.clone(), 3));
        assert_eq!(done(&path, "a", 1), (all.clone(), 0));
        assert_eq!(done(&path, "b", 1), (all, 3));
        Store::new(path.clone()).clear().unwrap();
        assert!(!path.exists());
    }

    #[test]
    fn a_part_that_ends_anywhere_or_was_changed_is_done_anew() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("kept");
        let all = done(&path, "a", 1).0;
        let file = &Store::new(path.clone()).files().unwrap()[1].path;
        let whole = std::fs::read(file).unwrap();
        for length in 0..whole.len() {
            std::fs::write(file, &whole[..length]).unwrap();
            assert_eq!(done(&path, "a", 1), (all.clone(), 1), "{length} bytes");
            assert_eq!(std::fs::read(file).unwrap(), whole, "{length} bytes");
        }
        let text = String::from_utf8(whole).unwrap();
        std::fs::write(file, text.replace("0.", "0.1")).unwrap();
        assert_eq!(done(&path, "a", 1), (all, 1));
    }

    #[test]
    fn a_file_of_something_else_stays_as_it_is() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("kept");
        std::fs::write(&path, "G0 X1\n").unwrap();
        assert_eq!(done(&path, "a", 1).1, 3);
        assert_eq!(std::fs::read_to_string(&path).unwrap(), "G0 X1\n");
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
