//! One small file for each identifier, in the user's cache folder, or in `$FEEDWRIGHT_CACHE` where that is set; where that is
//! empty nothing is kept. A cache that cannot be written costs time, nothing else.

use std::io::Write;
use std::path::{Path, PathBuf};
use std::sync::LazyLock;

use crate::output::{OutputFile, OutputFiles};

/// A hash of this program.
static PROGRAM: LazyLock<Option<String>> = LazyLock::new(|| {
    let program = std::env::current_exe().and_then(std::fs::read).ok()?;
    Some(blake3::hash(&program).to_hex().to_string())
});

/// The folder of the cache, where there is one.
pub fn folder() -> Option<PathBuf> {
    match std::env::var_os("FEEDWRIGHT_CACHE") {
        Some(folder) if folder.is_empty() => None,
        Some(folder) => Some(PathBuf::from(folder)),
        None => directories::ProjectDirs::from("", "", "feedwright").map(|dirs| dirs.cache_dir().to_owned()),
    }
}

/// What tells this program from others that may identify otherwise, where there is a cache.
pub(super) fn program() -> Option<&'static str> {
    folder().and_then(|_| PROGRAM.as_deref())
}

/// The text of a file of the cache.
pub(super) fn read(name: &str) -> Option<String> {
    std::fs::read_to_string(folder()?.join(name)).ok()
}

/// Keeps a text.
pub(super) fn write(name: &str, text: &str) {
    if let Some(folder) = folder() {
        let _ = write_to(&folder, name, text);
    }
}

fn write_to(folder: &Path, name: &str, text: &str) -> std::io::Result<()> {
    std::fs::create_dir_all(folder)?;
    let mut kept = OutputFiles::default().start(&folder.join(name)).map_err(std::io::Error::other)?;
    kept.write_all(text.as_bytes())?;
    OutputFile::commit_all(vec![kept], &()).map_err(std::io::Error::other)
}
