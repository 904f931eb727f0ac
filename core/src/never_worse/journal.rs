//! Finished cuts, line by line on disk: what was interrupted goes on where it was, and what is the same is not cut again.
//!
//! A journal belongs to the program that made it, which is part of its name; a cut in it is known by the content of path
//! and machine. A line that cannot be read, such as the last of a run that was killed, is worked out anew.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::Mutex;

use serde::{Deserialize, Serialize};

use super::cut::Row;
use super::{Job, Options};
use crate::identify::cache::key_of;

#[derive(Serialize, Deserialize)]
struct Line {
    key: String,
    row: Row,
}

/// What earlier runs have left, and the file to which this one adds.
#[derive(Debug, Default)]
pub struct Journal {
    file: Option<Mutex<File>>,
    rows: BTreeMap<String, Row>,
}

/// What a cut depends on, apart from the program that makes it.
pub(super) fn key(job: &Job, options: &Options) -> String {
    let machine = serde_json::json!(*job.machine).to_string();
    let Options { controller, set, seed, .. } = options;
    let (seed, set_json) = (seed.to_le_bytes(), serde_json::json!(set).to_string());
    let mut parts = vec![job.program.key.as_bytes(), machine.as_bytes(), controller.name.as_bytes(), &seed];
    if !set.is_empty() {
        parts.push(set_json.as_bytes());
    }
    key_of(&parts)
}

impl Journal {
    /// Keeps nothing.
    pub fn none() -> Self {
        Self::default()
    }

    /// The journal of a version in a folder.
    pub fn place(folder: &Path, version: &str) -> PathBuf {
        folder.join(format!("never-worse-{version}.jsonl"))
    }

    /// The journal in a file; what an earlier run has left there is known.
    ///
    /// # Errors
    /// Where it cannot be written to.
    pub fn open(path: &Path) -> std::io::Result<Self> {
        if let Some(folder) = path.parent() {
            std::fs::create_dir_all(folder)?;
        }
        let text = std::fs::read_to_string(path).unwrap_or_default();
        let lines = text.lines().filter_map(|line| serde_json::from_str(line).ok());
        let rows = lines.map(|Line { key, row }| (key, row)).collect();
        let mut file = File::options().append(true).create(true).open(path)?;
        if !text.is_empty() && !text.ends_with('\n') {
            file.write_all(b"\n")?;
        }
        Ok(Self { file: Some(Mutex::new(file)), rows })
    }

    /// The row of a job, under the names that program and machine have now.
    pub(super) fn row(&self, key: &str, job: &Job) -> Option<Row> {
        let (program, machine) = (job.program.name.clone(), job.machine.name.clone());
        self.rows.get(key).map(|row| Row { program, machine, ..row.clone() })
    }

    /// A journal that cannot be written costs time after an interruption, nothing else.
    pub(super) fn add(&self, key: &str, row: &Row) {
        let line = serde_json::to_string(&Line { key: key.to_owned(), row: row.clone() });
        let file = self.file.as_ref().and_then(|file| file.lock().ok());
        if let (Some(mut file), Ok(line)) = (file, line) {
            // In one piece, so that two runs may share a journal.
            let _ = file.write_all(format!("{line}\n").as_bytes());
        }
    }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::controllers::{BASELINE, Entry};
    use crate::machine::Machine;
    use crate::never_worse::program::{Length, Program};
    use crate::never_worse::{jobs, sweep};

    #[test]
    fn what_was_cut_is_not_cut_again_and_half_a_line_does_no_harm() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = Journal::place(folder.path(), "version");
        let machine = Machine::load("tnv40".as_ref()).expect("built in");
        let length = Length { machine: &machine, limit_s: 10.0 };
        let programs = ["G21 F1200\nG1 X5\nG1 Y5\nM2\n", "G21 F1200\nG1 X-5\nM2\n"]
            .map(|text| Program::from_text("lines", text, length).expect("a program"));
        let jobs = jobs(programs.to_vec(), vec![machine.clone()]);
        let options =
            Options { controller: Entry::find(BASELINE).expect("in the table"), set: Vec::new(), seed: 1, threads: 2 };
        let swept = |jobs: &[Job]| {
            sweep(jobs, &options, &Journal::open(&path).expect("a journal"), &()).expect("nobody ends it")
        };
        let first = swept(&jobs);
        let mut text = std::fs::read_to_string(&path).expect("it was written");
        let second_line = text.find('\n').expect("two lines") + 1;
        text.truncate(second_line + 40);
        std::fs::write(&path, text).expect("it can be written");
        let again = swept(&jobs);
        assert_eq!((first.known, again.known), (0, 1));
        assert_eq!(first.rows, again.rows);
        let renamed = Job {
            program: Arc::new(Program { name: "other".to_owned(), ..(*jobs[0].program).clone() }),
            ..jobs[0].clone()
        };
        let named = swept(&[renamed]).rows;
        assert_eq!((named[0].program.as_str(), &named[0].open_loop), ("other", &first.rows[0].open_loop));
    }
}
