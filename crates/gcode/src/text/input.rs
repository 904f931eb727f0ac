//! Files that are read, and `-`, which stands for the standard input.
//!
//! The standard input can be read once and programs are read several times, so it is kept in
//! memory; the same bytes are handed out each time. `./-` is a file of that name.

use std::fs;
use std::io::{self, Read};
use std::path::Path;
use std::sync::OnceLock;

use crate::text::visible::visible;

/// Path that stands for the standard input.
const STANDARD_INPUT: &str = "-";

/// Bytes read from the standard input, or the error.
static KEPT: OnceLock<Result<Vec<u8>, (io::ErrorKind, String)>> = OnceLock::new();

/// Returns true if a path stands for the standard input.
pub fn is_standard_input(path: &Path) -> bool {
    path.as_os_str() == STANDARD_INPUT
}

/// A path as messages have it, without what is hidden in it.
pub fn name(path: &Path) -> String {
    if is_standard_input(path) {
        "standard input".to_owned()
    } else {
        visible(&path.display().to_string()).into_owned()
    }
}

/// All bytes of a file, or of the standard input.
///
/// # Errors
/// Where the operating system refuses.
pub fn read(path: &Path) -> io::Result<Vec<u8>> {
    if is_standard_input(path) {
        standard_input().map(<[u8]>::to_vec)
    } else {
        fs::read(path)
    }
}

/// All bytes of the standard input.
///
/// # Errors
/// Where the operating system refuses.
pub fn standard_input() -> io::Result<&'static [u8]> {
    let kept = KEPT.get_or_init(|| {
        let mut bytes = Vec::new();
        match io::stdin().lock().read_to_end(&mut bytes) {
            Ok(_) => Ok(bytes),
            Err(error) => Err((error.kind(), error.to_string())),
        }
    });
    match kept {
        Ok(bytes) => Ok(bytes),
        Err((kind, message)) => Err(io::Error::new(*kind, message.clone())),
    }
}
