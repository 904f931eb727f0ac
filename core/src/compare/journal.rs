//! Finished work of a comparison, line by line on disk: what was interrupted goes on where it was.
//!
//! A journal belongs to its options and to the program that made it, both part of its name; it is removed when the
//! comparison is complete. A line that cannot be read, such as the last of a run that was killed, is worked out anew.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use serde::{Deserialize, Serialize};

use super::Competitor;
use super::table::Row;
use super::tuning::Tuned;
use crate::machine::Machine;

#[derive(Serialize, Deserialize)]
enum Line {
    Tuned(Tuned),
    Row(Row),
}

/// The journal of one comparison: what an earlier run has left, and the file to which this one adds.
#[derive(Debug, Default)]
pub struct Journal {
    file: Option<(PathBuf, Mutex<File>)>,
    rows: BTreeMap<[String; 3], Row>,
    tuned: BTreeMap<String, Tuned>,
}

impl Journal {
    /// Keeps nothing.
    pub fn none() -> Self {
        Self::default()
    }

    /// The journal in `folder` for this key; what an earlier run has left there is known.
    ///
    /// # Errors
    /// Where the folder cannot be written to.
    pub fn open(folder: &Path, key: &str) -> std::io::Result<Self> {
        std::fs::create_dir_all(folder)?;
        let path = folder.join(format!("compare-{key}.jsonl"));
        let mut journal = Self::default();
        let text = std::fs::read_to_string(&path).unwrap_or_default();
        for line in text.lines() {
            match serde_json::from_str(line) {
                Ok(Line::Row(row)) => {
                    journal.rows.insert(place(&row), row);
                }
                Ok(Line::Tuned(tuned)) => {
                    journal.tuned.insert(tuned.controller.clone(), tuned);
                }
                Err(_) => {}
            }
        }
        let mut file = File::options().append(true).create(true).open(&path)?;
        if !text.is_empty() && !text.ends_with('\n') {
            file.write_all(b"\n")?;
        }
        journal.file = Some((path, Mutex::new(file)));
        Ok(journal)
    }

    /// Rows that an earlier run has left.
    pub fn known(&self) -> usize {
        self.rows.len()
    }

    pub(super) fn row(&self, contour: &str, machine: &Machine, competitor: &Competitor) -> Option<Row> {
        self.rows.get(&[contour.to_owned(), machine.name.clone(), competitor.name()]).cloned()
    }

    pub(super) fn tuned(&self, controller: &str) -> Option<Tuned> {
        self.tuned.get(controller).cloned()
    }

    pub(super) fn add(&self, row: &Row) {
        self.write(&Line::Row(row.clone()));
    }

    pub(super) fn add_tuned(&self, tuned: &Tuned) {
        self.write(&Line::Tuned(tuned.clone()));
    }

    /// The comparison is complete: nothing is left to go on with.
    pub fn remove(self) {
        if let Some((path, _)) = self.file {
            // What stays is found complete by the next run.
            let _ = std::fs::remove_file(path);
        }
    }

    /// A journal that cannot be written costs time after an interruption, nothing else.
    fn write(&self, line: &Line) {
        let file = self.file.as_ref().and_then(|(_, file)| file.lock().ok());
        if let (Some(mut file), Ok(mut text)) = (file, serde_json::to_string(line)) {
            text.push('\n');
            let _ = file.write_all(text.as_bytes());
        }
    }
}

fn place(row: &Row) -> [String; 3] {
    [row.contour.clone(), row.machine.clone(), row.controller.clone()]
}
