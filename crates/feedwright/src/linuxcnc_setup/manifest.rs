//! Writes the copies, and takes them away again. A manifest beside them has the checksum of each,
//! so that nothing is replaced or removed that was changed by hand. All files take their places
//! together, or none does.

use std::fmt::Write as _;
use std::fs;
use std::io::{ErrorKind, Write as _};
use std::path::{Path, PathBuf};

use feedwright_sim::Watch;

use super::error::LinuxcncSetupError;
use super::names::SetupNames;
use crate::output::{OutputError, OutputFile, OutputFiles};

/// A file to write.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct SetupFile {
    pub(crate) path: PathBuf,
    pub(crate) bytes: Vec<u8>,
}

/// Names and checksums of the files that an earlier setup wrote.
type Written = Vec<(String, String)>;

/// Writes the files and the manifest; files that are as wanted stay untouched. Returns all files in
/// their order.
pub(super) fn write(
    names: &SetupNames,
    files: Vec<SetupFile>,
    replace: bool,
    watch: &dyn Watch,
) -> Result<Vec<PathBuf>, LinuxcncSetupError> {
    let before = read(names)?.unwrap_or_default();
    if !replace {
        check(names, &before, &files)?;
    }
    let mut text = format!(
        "# Written by feedwright linuxcnc setup {}: checksums and names.\n",
        names.original
    );
    for SetupFile { path, bytes } in &files {
        let _ = writeln!(text, "{} {}", checksum(bytes), name_of(path));
    }
    let paths = files.iter().map(|file| file.path.clone()).collect();
    let manifest = SetupFile {
        path: names.path(&names.manifest),
        bytes: text.into_bytes(),
    };
    let mut outputs = OutputFiles::new(None);
    let mut started = Vec::new();
    // The manifest comes first: a process that is killed leaves no file that it does not list.
    for SetupFile { path, bytes } in std::iter::once(manifest).chain(files) {
        if fs::read(&path).is_ok_and(|there| there == bytes) {
            continue;
        }
        let mut file = outputs.start(&path)?;
        file.write_all(&bytes)
            .map_err(|error| OutputError::from_io(error, &path))?;
        started.push(file);
    }
    OutputFile::commit_all(started, watch)?;
    Ok(paths)
}

/// Refuses to replace what setup did not write, or what was changed since.
fn check(
    names: &SetupNames,
    before: &Written,
    files: &[SetupFile],
) -> Result<(), LinuxcncSetupError> {
    let mut changed = Vec::new();
    for SetupFile { path, bytes } in files {
        let Ok(there) = fs::read(path) else { continue };
        let listed = before.iter().find(|(name, _)| *name == name_of(path));
        match listed {
            _ if there == *bytes => {}
            Some((_, sum)) if *sum == checksum(&there) => {}
            Some(_) => changed.push(path.clone()),
            None => return Err(LinuxcncSetupError::InTheWay { path: path.clone() }),
        }
    }
    let manifest = names.path(&names.manifest);
    if before.is_empty() && manifest.exists() {
        return Err(LinuxcncSetupError::InTheWay { path: manifest });
    }
    if changed.is_empty() {
        Ok(())
    } else {
        Err(LinuxcncSetupError::ChangedByHand { paths: changed })
    }
}

/// Removes what setup wrote: the removed files, and those that stay because they were changed.
pub(super) fn undo(names: &SetupNames) -> Result<[Vec<PathBuf>; 2], LinuxcncSetupError> {
    let manifest = names.path(&names.manifest);
    let Some(written) = read(names)? else {
        return Err(LinuxcncSetupError::NothingToUndo { path: manifest });
    };
    let [mut removed, mut kept] = [Vec::new(), Vec::new()];
    // The INI file, which is the last, goes first: what is left cannot be started.
    for (name, sum) in written.iter().rev() {
        let path = names.path(name);
        match fs::read(&path) {
            Ok(there) if checksum(&there) == *sum => {
                remove(&path)?;
                removed.push(path);
            }
            Ok(_) => kept.push(path),
            Err(_) => {}
        }
    }
    remove(&manifest)?;
    removed.push(manifest);
    Ok([removed, kept])
}

fn remove(path: &Path) -> Result<(), LinuxcncSetupError> {
    fs::remove_file(path).map_err(|source| LinuxcncSetupError::Removing {
        path: path.to_owned(),
        source,
    })
}

/// The manifest, if there is one.
fn read(names: &SetupNames) -> Result<Option<Written>, LinuxcncSetupError> {
    let path = names.path(&names.manifest);
    let text = match fs::read_to_string(&path) {
        Ok(text) => text,
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(None),
        Err(error) => return Err(LinuxcncSetupError::unreadable(&path, None, error)),
    };
    // Only names of files beside the manifest: nothing else is ever removed.
    let entry = |line: &str| {
        let (sum, name) = line.split_once(' ')?;
        (!line.starts_with('#') && name_of(Path::new(name)) == name)
            .then(|| (name.to_owned(), sum.to_owned()))
    };
    Ok(Some(text.lines().filter_map(entry).collect()))
}

fn checksum(bytes: &[u8]) -> String {
    blake3::hash(bytes).to_hex()[..32].to_owned()
}

fn name_of(path: &Path) -> String {
    path.file_name()
        .map_or_else(String::new, |name| name.to_string_lossy().into_owned())
}
