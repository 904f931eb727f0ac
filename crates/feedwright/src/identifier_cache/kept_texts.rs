//! Where texts are kept: in files, or where the program keeps them that embeds the library.

use std::sync::OnceLock;

use super::files;

/// Keeps texts by name. What another version of the library kept must not be found.
pub trait KeptTexts: Sync {
    /// The text with a name, where it is there.
    fn read(&self, name: &str) -> Option<String>;
    /// Keeps a text.
    fn write(&self, name: &str, text: &str);
}

static ELSEWHERE: OnceLock<&'static dyn KeptTexts> = OnceLock::new();

/// Keeps what is identified in `texts` from now on, not in files. The first call counts.
pub fn keep_in(texts: &'static dyn KeptTexts) {
    let _ = ELSEWHERE.set(texts);
}

/// Returns text that distinguishes this program from others that may identify differently; `None`
/// if nothing is kept.
pub(super) fn program() -> Option<&'static str> {
    if ELSEWHERE.get().is_some() {
        Some("")
    } else {
        files::program()
    }
}

pub(super) fn read(name: &str) -> Option<String> {
    ELSEWHERE
        .get()
        .map_or_else(|| files::read(name), |texts| texts.read(name))
}

pub(super) fn write(name: &str, text: &str) {
    match ELSEWHERE.get() {
        Some(texts) => texts.write(name, text),
        None => files::write(name, text),
    }
}
