//! Finished work, kept by content: the same work is found, and not done again.
//!
//! A result is kept under the hash of everything that it follows from ([`key_of`]), so any number
//! of processes may use one store. What is missing or cannot be read is done anew.
//!
//! | Result | Folder |
//! |---|---|
//! | job of a sweep | `--out` of `feedwright sweep` |
//! | piece of a long program | beside the corrected program |
//! | identified model | the user's cache, or where the program keeps it that embeds the library |

mod checked_json;
#[cfg(feature = "files")]
mod folder;
mod cache;

#[cfg(feature = "files")]
pub use cache::cache_folder;
pub use cache::{KeptTexts, keep_in};
#[cfg(feature = "files")]
pub(crate) use cache::{MOST_BYTES, user_cache};
pub(crate) use cache::{keep, kept, program_key};
#[cfg(feature = "files")]
pub use folder::Store;
use serde::Serialize;

/// Returns the key of a content, a hash of its JSON; `None` if it has no JSON.
pub(crate) fn content_key(content: &impl Serialize) -> Option<String> {
    let mut hasher = blake3::Hasher::new();
    serde_json::to_writer(&mut hasher, content).ok()?;
    Some(hasher.finalize().to_hex().to_string())
}

/// Returns a name for what depends on these parts.
pub fn key_of(parts: &[&[u8]]) -> String {
    let mut hasher = blake3::Hasher::new();
    for part in parts {
        hasher.update(&(part.len() as u64).to_le_bytes());
        hasher.update(part);
    }
    hasher.finalize().to_hex().to_string()
}
