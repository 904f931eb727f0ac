//! What every study shares: its items are done on several threads, and its finished work is kept in
//! the store of results that `feedwright sweep` writes, so that an interrupted study continues where
//! it stopped.
//!
//! A result is stored under the hash of everything that it follows from: the executable, what the
//! whole study depends on, and the key of the work. Several processes may work on one folder. A
//! result that cannot be read is computed again.

use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

use feedwright::command::make_folder;
use feedwright::{Store, cache_folder, key_of};
use miette::Result;
use serde::Serialize;
use serde::de::DeserializeOwned;

/// Does the items on a number of threads, each with a worker of its own. The results have the order
/// of the items.
///
/// # Errors
/// The first error of an item; no other item is begun then.
pub(crate) fn each<I: Sync, W, R: Send, E: Send>(
    items: &[I],
    threads: usize,
    worker: impl Fn() -> W + Sync,
    work: impl Fn(&mut W, &I) -> Result<R, E> + Sync,
) -> Result<Vec<R>, E> {
    let next = AtomicUsize::new(0);
    let results = Mutex::new((0..items.len()).map(|_| None).collect::<Vec<_>>());
    let thread = || {
        let mut worker = worker();
        loop {
            let item = next.fetch_add(1, Ordering::Relaxed);
            let Some(input) = items.get(item) else { break };
            let result = work(&mut worker, input);
            if result.is_err() {
                next.store(items.len(), Ordering::Relaxed);
            }
            results.lock().unwrap_or_else(PoisonError::into_inner)[item] = Some(result);
        }
    };
    std::thread::scope(|scope| (0..threads.max(1)).for_each(|_| drop(scope.spawn(thread))));
    let results = results.into_inner().unwrap_or_else(PoisonError::into_inner);
    results.into_iter().flatten().collect()
}

/// Finished work of one study.
#[derive(Debug, Default)]
pub struct Kept {
    store: Option<Store>,
    /// Hash of everything that all work of the study depends on.
    common: String,
    /// Folder to remove when the study is complete.
    removed: Option<PathBuf>,
    found: AtomicUsize,
}

impl Kept {
    /// Keeps nothing.
    pub fn none() -> Self {
        Self::default()
    }

    /// Keeps work in `folder`, or in a folder of the cache that [`Self::complete`] removes. `study`
    /// is everything that all work depends on, apart from the executable.
    ///
    /// # Errors
    /// A named folder that cannot be made.
    pub fn open(folder: Option<&Path>, study: &str) -> Result<Self> {
        let program = std::env::current_exe().and_then(std::fs::read);
        let common = key_of(&[&program.unwrap_or_default(), study.as_bytes()]);
        let cached = || Some(cache_folder()?.join(format!("lab-{common}")));
        let removed = if folder.is_some() { None } else { cached() };
        let store = match (folder, &removed) {
            (Some(folder), _) => {
                make_folder(folder)?;
                Some(Store::new(folder.to_owned()))
            }
            // Without a place in the cache, an interrupted study begins anew.
            (None, cached) => cached.clone().map(Store::new),
        };
        Ok(Self {
            store,
            common,
            removed,
            ..Self::default()
        })
    }

    /// Number of results that were there.
    pub fn found(&self) -> usize {
        self.found.load(Ordering::Relaxed)
    }

    fn address(&self, key: &str) -> String {
        key_of(&[self.common.as_bytes(), key.as_bytes()])
    }

    /// The result of the work with this key; `None` if it is not there.
    pub fn get<T: DeserializeOwned>(&self, key: &str) -> Option<T> {
        let result = self.store.as_ref()?.get(&self.address(key))?;
        self.found.fetch_add(1, Ordering::Relaxed);
        Some(result)
    }

    /// Stores a result. A result that cannot be written costs time after an interruption, nothing
    /// else.
    pub fn put<T: Serialize>(&self, key: &str, result: &T) {
        if let Some(store) = &self.store {
            let _ = store.put(&self.address(key), result);
        }
    }

    /// The result with this key, from the store or from `work`.
    ///
    /// # Errors
    /// As `work`.
    pub fn once<T: Serialize + DeserializeOwned, E>(
        &self,
        key: &str,
        work: impl FnOnce() -> Result<T, E>,
    ) -> Result<T, E> {
        if let Some(result) = self.get(key) {
            return Ok(result);
        }
        let result = work()?;
        self.put(key, &result);
        Ok(result)
    }

    /// Removes the folder of the cache: nothing remains to continue.
    pub fn complete(self) {
        if let Some(folder) = self.removed {
            // The next run finds its work finished if a file stays.
            let _ = std::fs::remove_dir_all(folder);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn work_is_done_once_for_the_same_study_and_again_where_its_file_is_damaged() {
        let folder = tempfile::tempdir().expect("a folder");
        let done = |study: &str, key: &str, result: f64| {
            let kept = Kept::open(Some(folder.path()), study).expect("a folder");
            let result = kept
                .once(key, || Ok::<_, ()>(result))
                .expect("it has no errors");
            let found = kept.found();
            kept.complete();
            (result, found)
        };
        assert_eq!(done("a", "first", 0.1), (0.1, 0));
        assert_eq!(done("a", "first", 2.0), (0.1, 1));
        assert_eq!(done("a", "second", 3.0), (3.0, 0));
        assert_eq!(done("b", "first", 4.0), (4.0, 0));
        for entry in
            glob::glob(&format!("{}/*/*.json", folder.path().display())).expect("a pattern")
        {
            let path = entry.expect("it can be read");
            let text = std::fs::read_to_string(&path).expect("it can be read");
            std::fs::write(path, &text[..text.len() / 2]).expect("it can be written");
        }
        assert_eq!(done("a", "first", 5.0), (5.0, 0));
        let none = Kept::none();
        none.put("first", &1.0);
        assert_eq!(none.get::<f64>("first"), None);
    }
}
