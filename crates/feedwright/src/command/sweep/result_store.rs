//! The folder of results: `ab/abcdef….json`, each written once and as a whole.

use std::io::Write;
use std::path::{Path, PathBuf};

use miette::{IntoDiagnostic, Result, WrapErr, miette};
use serde_json::Value;

use crate::command::streams::make_folder;
use crate::output::{FileOperation, OutputError, OutputFile, OutputFiles};
use crate::results_format::spelled_out;

/// Digits of an address that name the folder of its file.
const FOLDER_DIGITS: usize = 2;

/// A folder of results.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ResultStore {
    folder: PathBuf,
}

impl ResultStore {
    /// The results in a folder, which is made if it is not there.
    ///
    /// # Errors
    /// A folder that cannot be made.
    pub fn create(folder: &Path) -> Result<Self> {
        make_folder(folder)?;
        Ok(Self {
            folder: folder.to_owned(),
        })
    }

    /// The results in a folder that is there.
    ///
    /// # Errors
    /// A folder that is not there.
    pub fn open(folder: &Path) -> Result<Self> {
        if folder.is_dir() {
            return Ok(Self {
                folder: folder.to_owned(),
            });
        }
        Err(miette!(
            help = "name the folder that `feedwright sweep --out` wrote",
            "{}: there is no such folder",
            folder.display()
        ))
    }

    fn path(&self, address: &str) -> PathBuf {
        self.folder
            .join(&address[..FOLDER_DIGITS])
            .join(format!("{address}.json"))
    }

    /// Returns the stored result; `None` if its file is missing or damaged.
    pub fn get(&self, address: &str) -> Option<Value> {
        read(&self.path(address))
            .ok()
            .filter(|result| result["address"] == address)
    }

    /// Writes a result. It is on the disk when this returns.
    ///
    /// # Errors
    /// What the operating system says, such as a full disk; nothing is left behind.
    pub fn put(&self, address: &str, result: &Value) -> Result<()> {
        let path = self.path(address);
        let folder = path.parent().unwrap_or(&self.folder);
        std::fs::create_dir_all(folder)
            .map_err(|error| OutputError::io(FileOperation::Create, &path, &self.folder, error))?;
        let mut file = OutputFiles::default().start(&path)?;
        file.write_all(format!("{}\n", spelled_out(&result.to_string())).as_bytes())
            .map_err(|error| OutputError::from_io(error, &path))?;
        file.sync()?;
        // The last word is the caller's, which ends before a job or after it.
        Ok(OutputFile::commit_all(vec![file], &())?)
    }

    /// The files of all results, sorted by their addresses.
    ///
    /// # Errors
    /// A folder that cannot be read.
    pub(super) fn files(&self) -> Result<Vec<PathBuf>> {
        let mut files = Vec::new();
        for folder in entries(&self.folder)?
            .into_iter()
            .filter(|path| has_digits(path, FOLDER_DIGITS) && path.is_dir())
        {
            let is_result = |path: &PathBuf| {
                path.extension().is_some_and(|end| end == "json") && has_digits(path, 64)
            };
            files.extend(entries(&folder)?.into_iter().filter(is_result));
        }
        Ok(files)
    }
}

/// The result in a file.
pub(super) fn read(path: &Path) -> Result<Value> {
    let shown = || path.display().to_string();
    let bytes = std::fs::read(path).into_diagnostic().wrap_err_with(shown)?;
    serde_json::from_slice(&bytes)
        .into_diagnostic()
        .wrap_err_with(shown)
}

fn entries(folder: &Path) -> Result<Vec<PathBuf>> {
    let found = folder
        .read_dir()
        .and_then(|entries| entries.map(|entry| Ok(entry?.path())).collect());
    let mut found: Vec<PathBuf> = found.map_err(|error: std::io::Error| {
        miette!("{}: the folder cannot be read: {error}", folder.display())
    })?;
    found.sort();
    Ok(found)
}

/// Returns true if the name without its ending consists of exactly `digits` hexadecimal digits.
fn has_digits(path: &Path, digits: usize) -> bool {
    let stem = path
        .file_stem()
        .and_then(|stem| stem.to_str())
        .unwrap_or_default();
    stem.len() == digits && stem.bytes().all(|byte| byte.is_ascii_hexdigit())
}
