//! Finished work, line by line on disk: what was interrupted goes on where it was, and what is there is not done again.
//!
//! A row is known by its key. A line that cannot be read, such as the last of a run that was killed, or whose checksum is wrong, is
//! worked out anew.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, Write};
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use feedwright::{checked, with_check};
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};

/// A line of the file.
#[derive(Serialize, Deserialize)]
struct Record<T> {
    key: String,
    row: T,
}

/// What earlier runs have left, and the file to which this one adds.
#[derive(Debug)]
pub struct Journal<T> {
    file: Option<(PathBuf, Mutex<File>)>,
    rows: BTreeMap<String, T>,
    damaged: usize,
}

impl<T: Serialize + DeserializeOwned> Journal<T> {
    /// Keeps nothing.
    pub const fn none() -> Self {
        Self { file: None, rows: BTreeMap::new(), damaged: 0 }
    }

    /// The journal in a file; what an earlier run has left there is known.
    ///
    /// # Errors
    /// Where it cannot be written to.
    pub fn open(path: &Path) -> io::Result<Self> {
        if let Some(folder) = path.parent() {
            std::fs::create_dir_all(folder)?;
        }
        let text = String::from_utf8_lossy(&std::fs::read(path).unwrap_or_default()).into_owned();
        let (rows, damaged) = Self::rows_of(&text);
        let mut file = File::options().append(true).create(true).open(path)?;
        if !text.is_empty() && !text.ends_with('\n') {
            file.write_all(b"\n")?;
        }
        Ok(Self { file: Some((path.to_owned(), Mutex::new(file))), rows, damaged })
    }

    /// What a journal holds; nothing is added to it.
    ///
    /// # Errors
    /// Where it cannot be read.
    pub fn read(path: &Path) -> io::Result<Self> {
        let (rows, damaged) = Self::rows_of(&String::from_utf8_lossy(&std::fs::read(path)?));
        Ok(Self { file: None, rows, damaged })
    }

    /// The rows of a text, and how many lines are damaged; half a line at the end is not, but unfinished.
    fn rows_of(text: &str) -> (BTreeMap<String, T>, usize) {
        let (mut rows, mut damaged) = (BTreeMap::new(), 0);
        for line in text.split_inclusive('\n').filter(|line| !line.trim().is_empty()) {
            match checked(line).and_then(|line| serde_json::from_str(&line).ok()) {
                Some(Record { key, row }) => {
                    rows.insert(key, row);
                }
                None => damaged += usize::from(line.ends_with('\n')),
            }
        }
        (rows, damaged)
    }

    /// Number of damaged lines: unreadable, or with a wrong checksum. An unfinished last line does
    /// not count.
    pub const fn damaged(&self) -> usize {
        self.damaged
    }

    /// Knows what another one holds, too.
    pub fn take_over(&mut self, other: Self) {
        self.rows.extend(other.rows);
        self.damaged += other.damaged;
    }

    /// What an earlier run has left under a key.
    pub fn get(&self, key: &str) -> Option<&T> {
        self.rows.get(key)
    }

    /// All that earlier runs have left.
    pub fn rows(&self) -> impl Iterator<Item = &T> {
        self.rows.values()
    }

    /// Writes a row down. A journal that cannot be written costs time after an interruption, nothing else.
    pub fn add(&self, key: &str, row: &T) {
        let line = serde_json::to_string(&Record { key: key.to_owned(), row });
        let file = self.file.as_ref().and_then(|(_, file)| file.lock().ok());
        if let (Some(mut file), Ok(line)) = (file, line) {
            // In one piece, so that two runs may share a journal.
            let _ = file.write_all(format!("{}\n", with_check(&line)).as_bytes());
        }
    }

    /// Removes the file: the work is complete, and nothing is left to go on with.
    pub fn remove(self) {
        if let Some((path, _)) = self.file {
            // What stays is found complete by the next run.
            let _ = std::fs::remove_file(path);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_a_line_is_not_known_and_does_not_spoil_the_next() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("new/journal.jsonl");
        let journal = Journal::open(&path).expect("a journal");
        journal.add("first", &1);
        journal.add("second", &2);
        let text = std::fs::read_to_string(&path).expect("it was written");
        std::fs::write(&path, &text[..text.len() - 3]).expect("it can be written");
        let again = Journal::open(&path).expect("a journal");
        assert_eq!(again.damaged(), 0);
        assert_eq!((again.get("first"), again.get("second")), (Some(&1), None));
        again.add("third", &3);
        let last: Journal<i32> = Journal::open(&path).expect("a journal");
        assert_eq!(last.rows().collect::<Vec<_>>(), [&1, &3]);
        last.remove();
        assert!(!path.exists());
        let spoiled = Journal::open(&path).expect("a journal");
        spoiled.add("fourth", &44);
        spoiled.add("fifth", &5);
        let text = std::fs::read_to_string(&path).expect("it was written");
        std::fs::write(&path, text.replace("44", "45")).expect("it can be written");
        let found: Journal<i32> = Journal::open(&path).expect("a journal");
        assert_eq!((found.get("fourth"), found.get("fifth"), found.damaged()), (None, Some(&5), 1));
        let none = Journal::none();
        none.add("first", &1);
        assert_eq!(none.get("first"), None);
    }
}
