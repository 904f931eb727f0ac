//! Results that any later run may use: in the user's cache, or where the program keeps them that
//! embeds the library.
//!
//! The cache is the folder `$FEEDWRIGHT_CACHE` where that is set; where that is empty nothing is
//! kept.

#[cfg(feature = "files")]
use std::path::PathBuf;
use std::sync::OnceLock;

use serde::Serialize;
use serde::de::DeserializeOwned;

use super::checked_json::{result_of, text_of};
use super::content_key;
#[cfg(feature = "files")]
use super::folder::Store;

/// Bytes that the cache has at most. A model of a machine with those that fit its log has 0.1 to
/// 0.2 MB: room for some hundred machines.
#[cfg(feature = "files")]
pub(crate) const MOST_BYTES: u64 = 64 << 20;

/// Keeps texts by key. What another version of the library kept must not be found.
pub trait KeptTexts: Sync {
    /// Returns the text with a key, where it is there.
    fn read(&self, key: &str) -> Option<String>;
    /// Keeps a text.
    fn write(&self, key: &str, text: &str);
}

#[cfg(feature = "files")]
impl KeptTexts for Store {
    fn read(&self, key: &str) -> Option<String> {
        self.text(key)
    }

    /// A cache that cannot be written costs time, nothing else.
    fn write(&self, key: &str, text: &str) {
        let _ = self.put_text(key, text);
    }
}

static ELSEWHERE: OnceLock<&'static dyn KeptTexts> = OnceLock::new();

/// Keeps what is identified in `texts` from now on, not in files. The first call counts.
pub fn keep_in(texts: &'static dyn KeptTexts) {
    let _ = ELSEWHERE.set(texts);
}

/// Returns the folder of the cache, where there is one.
#[cfg(feature = "files")]
pub fn cache_folder() -> Option<PathBuf> {
    match std::env::var_os("FEEDWRIGHT_CACHE") {
        Some(folder) if folder.is_empty() => None,
        Some(folder) => Some(PathBuf::from(folder)),
        None => directories::ProjectDirs::from("", "", "feedwright")
            .map(|dirs| dirs.cache_dir().to_owned()),
    }
}

/// Returns the user's cache, where there is one.
#[cfg(feature = "files")]
pub(crate) fn user_cache() -> Option<Store> {
    Some(Store::cache(cache_folder()?, MOST_BYTES))
}

/// Calls a function with the texts of all runs, where there are any.
fn with_texts<T>(call: impl FnOnce(&dyn KeptTexts) -> T) -> Option<T> {
    if let Some(texts) = ELSEWHERE.get() {
        return Some(call(*texts));
    }
    #[cfg(feature = "files")]
    let called = user_cache().map(|cache| call(&cache));
    #[cfg(not(feature = "files"))]
    let called = None;
    called
}

/// Returns text that distinguishes this program from others that may identify differently; `None`
/// if nothing is kept.
fn program() -> Option<&'static str> {
    /// A hash of this program, and its version: in Python the program is the interpreter, which
    /// stays when feedwright changes.
    #[cfg(feature = "files")]
    static PROGRAM: std::sync::LazyLock<Option<String>> = std::sync::LazyLock::new(|| {
        let program = std::env::current_exe().and_then(std::fs::read).ok()?;
        let hash = blake3::hash(&program).to_hex();
        Some(format!("{} {hash}", env!("CARGO_PKG_VERSION")))
    });
    if ELSEWHERE.get().is_some() {
        return Some("");
    }
    #[cfg(feature = "files")]
    let program = cache_folder().and_then(|_| PROGRAM.as_deref());
    #[cfg(not(feature = "files"))]
    let program = None;
    program
}

/// Returns the key of what this program makes of a content; `None` if nothing is kept.
pub(crate) fn program_key(content: &impl Serialize) -> Option<String> {
    content_key(&(program()?, content))
}

/// Returns the result that is kept with a key; `None` if it is missing or damaged.
pub(crate) fn kept<T: DeserializeOwned>(key: &str) -> Option<T> {
    result_of(&with_texts(|texts| texts.read(key))??)
}

/// Keeps a result. One that cannot be kept costs time, nothing else.
pub(crate) fn keep(key: &str, result: &impl Serialize) {
    if let Ok(text) = text_of(result) {
        with_texts(|texts| texts.write(key, &text));
    }
}
