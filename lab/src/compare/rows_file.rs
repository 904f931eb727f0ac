//! Files of rows that the user names: journals that say of which comparison and by which program they are.

use std::io;
use std::path::{Path, PathBuf};

use miette::Diagnostic;
use thiserror::Error;

use super::options::RowsStamp;
use super::units::Finished;
use crate::journal::Journal;

/// Under which a journal has its stamp.
const STAMP_KEY: &str = "stamp";

/// Why a file of rows cannot be used.
#[derive(Debug, Error, Diagnostic)]
pub enum RowsError {
    /// It cannot be read or written.
    #[error("{}: {fault}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// Why.
        fault: io::Error,
    },
    /// It is something else.
    #[error("{} is no file of rows", path.display())]
    #[diagnostic(help("'feedwright-lab compare --rows FILE' makes one; nothing was written to this one"))]
    NoRows {
        /// The file.
        path: PathBuf,
    },
    /// Its rows are of another comparison.
    #[error("{} holds rows of other options", path.display())]
    #[diagnostic(help(
        "give the same --only, --work, --part, --machine, --knowledge, --seed, --seeds, --tuning, --set and --at-tolerance as for its \
         rows, or another file"
    ))]
    OtherOptions {
        /// The file.
        path: PathBuf,
    },
    /// Its rows were made by another program.
    #[error("{} holds rows that another build of feedwright made", path.display())]
    #[diagnostic(help("use the program that made them, or make them anew in another file"))]
    OtherProgram {
        /// The file.
        path: PathBuf,
    },
}

/// Opens a file of rows to go on with, or begins one.
///
/// # Errors
/// A file that cannot be written, and one with anything else than rows of this comparison and program.
pub fn open(path: &Path, stamp: &RowsStamp) -> Result<Journal<Finished>, RowsError> {
    let fault = |fault| RowsError::File { path: path.to_owned(), fault };
    let is_new = match std::fs::metadata(path) {
        Ok(file) => file.len() == 0,
        Err(error) if error.kind() == io::ErrorKind::NotFound => true,
        Err(error) => return Err(fault(error)),
    };
    if !is_new {
        check(path, &Journal::read(path).map_err(fault)?, stamp)?;
    }
    let journal = Journal::open(path).map_err(fault)?;
    if is_new {
        journal.add(STAMP_KEY, &Finished::Stamp(stamp.clone()));
    }
    Ok(journal)
}

/// The rows of several files.
///
/// # Errors
/// A file that cannot be read, and one with anything else than rows of this comparison and program.
pub fn read_all(paths: &[PathBuf], stamp: &RowsStamp) -> Result<Journal<Finished>, RowsError> {
    let mut all = Journal::none();
    for path in paths {
        let journal = Journal::read(path).map_err(|fault| RowsError::File { path: path.clone(), fault })?;
        check(path, &journal, stamp)?;
        all.take_over(journal);
    }
    Ok(all)
}

fn check(path: &Path, journal: &Journal<Finished>, stamp: &RowsStamp) -> Result<(), RowsError> {
    let path = path.to_owned();
    match journal.get(STAMP_KEY) {
        Some(Finished::Stamp(found)) if found.options != stamp.options => Err(RowsError::OtherOptions { path }),
        Some(Finished::Stamp(found)) if found.program != stamp.program => Err(RowsError::OtherProgram { path }),
        Some(Finished::Stamp(_)) => Ok(()),
        _ => Err(RowsError::NoRows { path }),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stamp(options: &str, program: &str) -> RowsStamp {
        RowsStamp { options: options.to_owned(), program: program.to_owned() }
    }

    #[test]
    fn rows_of_other_options_or_of_another_program_are_refused_and_foreign_files_are_left_alone() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("rows.jsonl");
        drop(open(&path, &stamp("a", "p")).unwrap());
        drop(open(&path, &stamp("a", "p")).unwrap());
        assert!(matches!(open(&path, &stamp("b", "p")), Err(RowsError::OtherOptions { .. })));
        assert!(matches!(open(&path, &stamp("a", "q")), Err(RowsError::OtherProgram { .. })));
        assert!(read_all(std::slice::from_ref(&path), &stamp("a", "p")).is_ok());
        let part = folder.path().join("part.ngc");
        std::fs::write(&part, "G1 X1 F1").unwrap();
        assert!(matches!(open(&part, &stamp("a", "p")), Err(RowsError::NoRows { .. })));
        assert_eq!(std::fs::read_to_string(&part).unwrap(), "G1 X1 F1");
        let none = folder.path().join("none.jsonl");
        assert!(matches!(read_all(&[none], &stamp("a", "p")), Err(RowsError::File { .. })));
    }
}
