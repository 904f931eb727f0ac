//! One small file for each identifier, in the user's cache folder, or in `$FEEDWRIGHT_CACHE` where
//! that is set; where that is empty nothing is kept. A cache that cannot be written costs time,
//! nothing else.

use std::fs::File;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;
use std::time::SystemTime;

use crate::output::{OutputFile, OutputFiles};

/// Bytes that the cache has at most. A model of a machine with those that fit its log has 0.1 to
/// 0.2 MB: room for some hundred machines.
pub(crate) const MOST_BYTES: u64 = 64 << 20;

/// A hash of this program, and its version: in Python the program is the interpreter, which stays
/// when feedwright changes.
static PROGRAM: LazyLock<Option<String>> = LazyLock::new(|| {
    let program = std::env::current_exe().and_then(std::fs::read).ok()?;
    Some(format!(
        "{} {}",
        env!("CARGO_PKG_VERSION"),
        blake3::hash(&program).to_hex()
    ))
});

/// The folder of the cache, where there is one.
pub fn folder() -> Option<PathBuf> {
    match std::env::var_os("FEEDWRIGHT_CACHE") {
        Some(folder) if folder.is_empty() => None,
        Some(folder) => Some(PathBuf::from(folder)),
        None => directories::ProjectDirs::from("", "", "feedwright")
            .map(|dirs| dirs.cache_dir().to_owned()),
    }
}

/// Returns text that distinguishes this program from others that may identify differently; `None`
/// without a cache.
pub(super) fn program() -> Option<&'static str> {
    folder().and_then(|_| PROGRAM.as_deref())
}

/// Returns the text of a file of the cache. Sets its time to the time of this use, so that the file
/// unused for longest can be found.
pub(super) fn read(name: &str) -> Option<String> {
    let path = folder()?.join(name);
    let text = std::fs::read_to_string(&path).ok()?;
    // A cache that is read only keeps its times.
    let _ = File::options()
        .append(true)
        .open(&path)
        .and_then(|file| file.set_modified(SystemTime::now()));
    Some(text)
}

/// Keeps a text.
pub(super) fn write(name: &str, text: &str) {
    if let Some(folder) = folder() {
        let _ = write_to(&folder, name, text);
    }
}

fn write_to(folder: &Path, name: &str, text: &str) -> std::io::Result<()> {
    std::fs::create_dir_all(folder)?;
    let mut kept = OutputFiles::default()
        .start(&folder.join(name))
        .map_err(std::io::Error::other)?;
    kept.write_all(text.as_bytes())?;
    OutputFile::commit_all(vec![kept], &()).map_err(std::io::Error::other)?;
    remove_oldest(folder, MOST_BYTES, name)
}

/// Removes the files that were used longest ago until the others have `most_bytes` at most;
/// `newest` stays. A run that reads one of them meanwhile has it already, or identifies anew.
fn remove_oldest(folder: &Path, most_bytes: u64, newest: &str) -> std::io::Result<()> {
    let mut files = entries(folder)?;
    files.sort_by_key(|file| file.used);
    let mut bytes: u64 = files.iter().map(|file| file.bytes).sum();
    for file in files
        .iter()
        .filter(|file| file.path.file_name().is_some_and(|name| name != newest))
    {
        if bytes <= most_bytes {
            break;
        }
        remove(&file.path)?;
        bytes -= file.bytes;
    }
    Ok(())
}

/// Removes a file that another run may have removed before.
fn remove(path: &Path) -> std::io::Result<()> {
    match std::fs::remove_file(path) {
        Err(error) if error.kind() != std::io::ErrorKind::NotFound => Err(error),
        _ => Ok(()),
    }
}

/// A file of the cache.
#[derive(Debug)]
pub(crate) struct CacheFile {
    pub(crate) path: PathBuf,
    pub(crate) bytes: u64,
    /// Time of the last use.
    pub(crate) used: SystemTime,
}

/// The files of a cache: those with a name that the cache gives. Other files in the folder are not
/// its own.
pub(crate) fn entries(folder: &Path) -> std::io::Result<Vec<CacheFile>> {
    let mut files = Vec::new();
    let found = match std::fs::read_dir(folder) {
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => return Ok(files),
        found => found?,
    };
    for entry in found {
        let path = entry?.path();
        // One that went meanwhile is no entry.
        let Ok(about) = std::fs::metadata(&path) else {
            continue;
        };
        if about.is_file() && is_entry(&path) {
            files.push(CacheFile {
                bytes: about.len(),
                used: about.modified().unwrap_or(SystemTime::UNIX_EPOCH),
                path,
            });
        }
    }
    Ok(files)
}

/// Removes all files of a cache. Returns how many there were.
///
/// # Errors
/// A file that cannot be removed.
pub(crate) fn clear(folder: &Path) -> std::io::Result<usize> {
    let files = entries(folder)?;
    files.iter().try_for_each(|file| remove(&file.path))?;
    Ok(files.len())
}

/// Hexadecimal digits of a BLAKE3 hash.
const HASH_DIGITS: usize = 64;

fn is_entry(path: &Path) -> bool {
    let is_hash =
        |stem: &str| stem.len() == HASH_DIGITS && stem.bytes().all(|byte| byte.is_ascii_hexdigit());
    let ending = path.extension().and_then(|ending| ending.to_str());
    // Earlier versions kept models as TOML.
    matches!(ending, Some("json" | "toml"))
        && path
            .file_stem()
            .and_then(|stem| stem.to_str())
            .is_some_and(is_hash)
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::time::Duration;

    fn name(digit: char) -> String {
        format!("{}.json", digit.to_string().repeat(HASH_DIGITS))
    }

    #[test]
    fn what_was_used_longest_ago_goes_first_and_other_files_stay() {
        let folder = tempfile::tempdir().unwrap();
        let place = |name: &str| folder.path().join(name);
        for (age, digit) in [(3, 'a'), (1, 'b'), (2, 'c')] {
            std::fs::write(place(&name(digit)), [b'x'; 100]).unwrap();
            let file = File::options()
                .append(true)
                .open(place(&name(digit)))
                .unwrap();
            file.set_modified(SystemTime::now() - Duration::from_secs(60 * age))
                .unwrap();
        }
        std::fs::write(place("notes.json"), [b'x'; 1000]).unwrap();
        remove_oldest(folder.path(), 200, &name('b')).unwrap();
        assert_eq!(
            ['a', 'b', 'c'].map(|digit| place(&name(digit)).exists()),
            [false, true, true]
        );
        // The newest stays, however large it is.
        remove_oldest(folder.path(), 0, &name('b')).unwrap();
        assert_eq!(
            ['b', 'c'].map(|digit| place(&name(digit)).exists()),
            [true, false]
        );
        assert_eq!(
            (clear(folder.path()).unwrap(), place("notes.json").exists()),
            (1, true)
        );
        assert_eq!(entries(&place("none")).unwrap().len(), 0);
    }
}
