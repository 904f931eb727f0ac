//! Folder of results: `ab/abcdef….json`, each written beside its place and renamed.

use std::fs::File;
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::time::SystemTime;

use serde::Serialize;
use serde::de::DeserializeOwned;

use super::checked_json::{result_of, text_of};
use crate::output::{FileOperation, OutputError, OutputFile, OutputFiles, remove_abandoned};

/// Digits of a key that name the folder of its file.
const FOLDER_DIGITS: usize = 2;
/// Digits of a key: those of a BLAKE3 hash.
const KEY_DIGITS: usize = 64;

/// Folder of results.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Store {
    folder: PathBuf,
    /// Most bytes of a cache; `None` keeps all.
    most_bytes: Option<u64>,
}

/// File of a result.
#[derive(Debug)]
pub(crate) struct StoredFile {
    pub(crate) path: PathBuf,
    pub(crate) bytes: u64,
    /// Time of the last use in a cache, of the writing elsewhere.
    pub(crate) used: SystemTime,
}

impl Store {
    /// Creates a store that keeps everything in `folder`, which is made with the first result.
    pub const fn new(folder: PathBuf) -> Self {
        Self {
            folder,
            most_bytes: None,
        }
    }

    /// Creates a store in which what was not used for longest makes room for what is new.
    pub(super) const fn cache(folder: PathBuf, most_bytes: u64) -> Self {
        Self {
            folder,
            most_bytes: Some(most_bytes),
        }
    }

    /// Returns the folder.
    pub(crate) fn folder(&self) -> &Path {
        &self.folder
    }

    fn path(&self, key: &str) -> PathBuf {
        let place = key.get(..FOLDER_DIGITS).unwrap_or_default();
        self.folder.join(place).join(format!("{key}.json"))
    }

    /// Returns the result with a key; `None` if it is missing or damaged.
    pub fn get<T: DeserializeOwned>(&self, key: &str) -> Option<T> {
        result_of(&self.text(key)?)
    }

    /// Keeps a result. It is on the disk when this returns.
    ///
    /// # Errors
    /// Fails if the operating system refuses it, for example because the disk is full. Nothing is left
    /// behind then.
    pub fn put(&self, key: &str, result: &impl Serialize) -> Result<(), OutputError> {
        let path = self.path(key);
        let text = text_of(result).map_err(|error| OutputError::from_io(error.into(), &path))?;
        self.put_text(key, &text)
    }

    /// Returns the text with a key, as it was written.
    pub(crate) fn text(&self, key: &str) -> Option<String> {
        let path = self.path(key);
        let text = std::fs::read_to_string(&path).ok()?;
        if self.most_bytes.is_some() {
            // A cache that is read only keeps its times.
            let _ = File::options()
                .append(true)
                .open(&path)
                .and_then(|file| file.set_modified(SystemTime::now()));
        }
        Some(text)
    }

    /// Writes a text, as [`Self::put`] writes a result.
    pub(crate) fn put_text(&self, key: &str, text: &str) -> Result<(), OutputError> {
        let path = self.path(key);
        let failed = |error| OutputError::io(FileOperation::Create, &path, &self.folder, error);
        std::fs::create_dir_all(path.parent().unwrap_or(&self.folder)).map_err(failed)?;
        let mut file = OutputFiles::default().start(&path)?;
        file.write_all(text.as_bytes())
            .map_err(|error| OutputError::from_io(error, &path))?;
        file.sync()?;
        // The last word is the caller's, which ends before a result or after it.
        OutputFile::commit_all(vec![file], &())?;
        match self.most_bytes {
            Some(most_bytes) => self.remove_oldest(most_bytes, &path).map_err(failed),
            None => Ok(()),
        }
    }

    /// Returns the files of all results, sorted by their keys. Other files in the folder are not
    /// its own.
    ///
    /// # Errors
    /// A folder that cannot be read.
    pub(crate) fn files(&self) -> io::Result<Vec<StoredFile>> {
        let mut files = Vec::new();
        for folder in self.folders()? {
            for path in entries(&folder)? {
                let is_result = path.extension().is_some_and(|end| end == "json")
                    && has_digits(&path, KEY_DIGITS);
                // One that went meanwhile is no result.
                let Ok(about) = std::fs::metadata(&path) else {
                    continue;
                };
                if is_result && about.is_file() {
                    files.push(StoredFile {
                        bytes: about.len(),
                        used: about.modified().unwrap_or(SystemTime::UNIX_EPOCH),
                        path,
                    });
                }
            }
        }
        Ok(files)
    }

    /// Returns the folders of the files.
    fn folders(&self) -> io::Result<Vec<PathBuf>> {
        let mut folders = entries(&self.folder)?;
        folders.retain(|path| has_digits(path, FOLDER_DIGITS) && path.is_dir());
        Ok(folders)
    }

    /// Removes all results, and the folders that are empty then. Returns how many results there
    /// were.
    ///
    /// # Errors
    /// A file that cannot be removed.
    pub(crate) fn clear(&self) -> io::Result<usize> {
        let files = self.files()?;
        files.iter().try_for_each(|file| remove(&file.path))?;
        for folder in self.folders()? {
            remove_abandoned(&folder);
            // One with other files stays.
            let _ = std::fs::remove_dir(folder);
        }
        let _ = std::fs::remove_dir(&self.folder);
        Ok(files.len())
    }

    /// Removes the results that were used longest ago until the others have `most_bytes` at most;
    /// `newest` stays. A run that reads one of them meanwhile has it already, or makes it anew.
    fn remove_oldest(&self, most_bytes: u64, newest: &Path) -> io::Result<()> {
        let mut files = self.files()?;
        files.sort_by_key(|file| file.used);
        let mut bytes: u64 = files.iter().map(|file| file.bytes).sum();
        for file in files.iter().filter(|file| file.path != newest) {
            if bytes <= most_bytes {
                break;
            }
            remove(&file.path)?;
            bytes -= file.bytes;
        }
        Ok(())
    }
}

/// Removes a file that another run may have removed before.
fn remove(path: &Path) -> io::Result<()> {
    match std::fs::remove_file(path) {
        Err(error) if error.kind() != ErrorKind::NotFound => Err(error),
        _ => Ok(()),
    }
}

/// Sorted paths of a folder; none if there is no such folder.
fn entries(folder: &Path) -> io::Result<Vec<PathBuf>> {
    let found = match folder.read_dir() {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(vec![]),
        found => found?,
    };
    let mut found: Vec<PathBuf> = found
        .map(|entry| Ok(entry?.path()))
        .collect::<io::Result<_>>()?;
    found.sort();
    Ok(found)
}

/// Returns true if the name without its ending consists of exactly `digits` hexadecimal digits.
fn has_digits(path: &Path, digits: usize) -> bool {
    let stem = path.file_stem().and_then(|stem| stem.to_str());
    stem.is_some_and(|stem| {
        stem.len() == digits && stem.bytes().all(|byte| byte.is_ascii_hexdigit())
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::store::key_of;
    use std::process::{Command, Stdio};
    use std::time::Duration;

    fn key(digit: char) -> String {
        digit.to_string().repeat(KEY_DIGITS)
    }

    #[test]
    fn what_was_used_longest_ago_goes_first_and_other_files_stay() {
        let folder = tempfile::tempdir().unwrap();
        let store = Store::new(folder.path().to_owned());
        for (age, digit) in [(3, 'a'), (1, 'b'), (2, 'c')] {
            store.put_text(&key(digit), &"x".repeat(100)).unwrap();
            let file = File::options()
                .append(true)
                .open(store.path(&key(digit)))
                .unwrap();
            file.set_modified(SystemTime::now() - Duration::from_secs(60 * age))
                .unwrap();
        }
        let notes = folder.path().join("aa/notes.json");
        std::fs::write(&notes, [b'x'; 1000]).unwrap();
        let are_there = |digits: &[char]| -> Vec<bool> {
            let is_there = |&digit: &char| store.text(&key(digit)).is_some();
            digits.iter().map(is_there).collect()
        };
        let newest = store.path(&key('b'));
        store.remove_oldest(200, &newest).unwrap();
        assert_eq!(are_there(&['a', 'b', 'c']), [false, true, true]);
        // The newest stays, however large it is.
        store.remove_oldest(0, &newest).unwrap();
        assert_eq!(are_there(&['b', 'c']), [true, false]);
        assert_eq!((store.clear().unwrap(), notes.exists()), (1, true));
        let none = Store::new(folder.path().join("none"));
        assert_eq!(none.files().unwrap().len(), 0);
    }

    #[test]
    fn a_cache_keeps_within_its_bytes_and_what_is_cleared_leaves_no_folder() {
        let folder = tempfile::tempdir().unwrap();
        let place = folder.path().join("cache");
        let cache = Store::cache(place.clone(), 150);
        for digit in ['a', 'b'] {
            cache.put_text(&key(digit), &"x".repeat(100)).unwrap();
        }
        assert_eq!(cache.text(&key('a')), None);
        assert_eq!((cache.clear().unwrap(), place.exists()), (1, false));
    }

    const WRITES_IN: &str = "FEEDWRIGHT_TEST_WRITES_IN";
    /// Least bytes of a result: a process that writes is killed within a write.
    const LENGTH: usize = 1 << 20;
    /// Results that a process writes at most, and processes.
    const MOST: usize = 100;
    const KILLED: u64 = 12;

    fn numbered(number: usize) -> (String, String) {
        (
            key_of(&[&number.to_le_bytes()]),
            number.to_string().repeat(LENGTH),
        )
    }

    /// Starts itself as another process, which writes results until it is killed.
    #[test]
    fn nothing_half_is_read_where_a_process_was_killed_while_it_wrote() {
        if let Some(folder) = std::env::var_os(WRITES_IN) {
            let store = Store::new(folder.into());
            for (key, result) in (0..MOST).map(numbered) {
                store.put(&key, &result).unwrap();
            }
            return;
        }
        let folder = tempfile::tempdir().unwrap();
        let store = Store::new(folder.path().join("results"));
        let this = std::thread::current().name().unwrap().to_owned();
        for wait_ms in 0..KILLED {
            let mut writer = Command::new(std::env::current_exe().unwrap())
                .args(["--exact", &this])
                .env(WRITES_IN, &store.folder)
                .stdout(Stdio::null())
                .spawn()
                .unwrap();
            while store.files().unwrap().is_empty() {
                assert_eq!(writer.try_wait().unwrap(), None);
                std::thread::sleep(Duration::from_millis(1));
            }
            std::thread::sleep(Duration::from_millis(wait_ms));
            writer.kill().unwrap();
            writer.wait().unwrap();
            let written = store.files().unwrap().len();
            for (key, result) in (0..written).map(numbered) {
                assert_eq!(store.get(&key), Some(result));
            }
            assert_eq!(store.clear().unwrap(), written);
            assert!(!store.folder.exists(), "a file was left");
        }
    }
}
