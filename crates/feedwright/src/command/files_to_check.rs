//! The files that `feedwright check` is asked about: folders become the programs in them, and no
//! file comes twice.

use std::collections::BTreeSet;
use std::io;
use std::path::{Path, PathBuf};

/// Endings of programs in a folder. A file that is named itself may have any.
const ENDINGS: [&str; 5] = ["ngc", "nc", "gcode", "tap", "cnc"];
/// Folders inside each other. Real trees have a dozen.
const MAX_DEPTH: usize = 64;

/// Files that `feedwright check` reads, with remarks and faults from the search for them.
#[derive(Debug, Default)]
pub struct FilesToCheck {
    /// Files, in the order of the arguments, those of a folder by name.
    pub files: Vec<PathBuf>,
    /// Remarks for people about the files that were left out.
    pub(crate) remarks: Vec<String>,
    /// Folders that cannot be looked into, or that hold nothing to check.
    pub faults: Vec<String>,
    seen: BTreeSet<PathBuf>,
}

impl FilesToCheck {
    /// Looks up what `arguments` name.
    pub fn find(arguments: &[PathBuf]) -> Self {
        let mut found = Self::default();
        for argument in arguments {
            if argument.is_dir() {
                found.folder(argument);
            } else if !found.add(argument) {
                found.remarks.push(format!(
                    "{}: named before, checked once",
                    argument.display()
                ));
            }
        }
        found
    }

    /// Adds a file that is not there yet under another name.
    fn add(&mut self, file: &Path) -> bool {
        // A file that does not exist has no other name; reading it will say what is wrong.
        let name = file.canonicalize().unwrap_or_else(|_| file.to_owned());
        let is_new = self.seen.insert(name);
        if is_new {
            self.files.push(file.to_owned());
        }
        is_new
    }

    /// Adds the programs in a folder and below it.
    fn folder(&mut self, folder: &Path) {
        let before = self.files.len();
        let mut left_out = LeftOut::default();
        if let Err((path, error)) = self.walk(folder, 0, &mut left_out) {
            self.faults.push(format!(
                "{}: the folder cannot be read: {error}",
                path.display()
            ));
            return;
        }
        let programs = self.files.len() - before;
        let name = folder.display();
        if programs == 0 && left_out.before == 0 {
            let endings = ENDINGS.map(|ending| format!(".{ending}")).join(" ");
            self.faults.push(format!(
                "{name}: the folder holds no program; the endings are {endings}"
            ));
            return;
        }
        let skipped = left_out.skipped();
        if !skipped.is_empty() {
            self.remarks
                .push(format!("{name}: {programs} programs; left out: {skipped}"));
        }
    }

    fn walk(
        &mut self,
        folder: &Path,
        depth: usize,
        left_out: &mut LeftOut,
    ) -> Result<(), (PathBuf, io::Error)> {
        let fault = |error| (folder.to_owned(), error);
        if depth > MAX_DEPTH {
            return Err(fault(io::Error::other(format!(
                "more than {MAX_DEPTH} folders inside each other"
            ))));
        }
        let mut entries: Vec<_> = folder
            .read_dir()
            .map_err(fault)?
            .collect::<Result<_, _>>()
            .map_err(fault)?;
        entries.sort_by_key(std::fs::DirEntry::file_name);
        for entry in entries {
            let path = entry.path();
            // A link to a folder may lead in a circle; a link to a file is that file.
            if entry.file_type().map_err(fault)?.is_dir() {
                self.walk(&path, depth + 1, left_out)?;
            } else if path.is_dir() {
                left_out.links += 1;
            } else if !is_program(&path) {
                left_out.endings += 1;
            } else if !self.add(&path) {
                left_out.before += 1;
            }
        }
        Ok(())
    }
}

/// Counts of the files and folders in a folder that are not checked.
#[derive(Debug, Default)]
struct LeftOut {
    endings: usize,
    links: usize,
    before: usize,
}

impl LeftOut {
    fn skipped(&self) -> String {
        let counts = [
            (self.endings, "other endings"),
            (self.links, "linked folders"),
            (self.before, "named before"),
        ];
        let reported = counts
            .iter()
            .filter(|(count, _)| *count > 0)
            .map(|(count, what)| format!("{what} {count}"));
        reported.collect::<Vec<_>>().join(", ")
    }
}

fn is_program(file: &Path) -> bool {
    let ending = file
        .extension()
        .and_then(|ending| ending.to_str())
        .unwrap_or_default();
    ENDINGS
        .iter()
        .any(|known| known.eq_ignore_ascii_case(ending))
}
