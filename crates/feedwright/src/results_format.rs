//! What each JSON result says of itself: the format, and the version that wrote it.

use serde_json::Value;

/// The format of the JSON results, as docs/json.md has it. It is raised whenever a key goes or changes its meaning; new keys may
/// come without.
pub const RESULTS_FORMAT: u32 = 1;

/// A result, an object, with its format and version.
pub(crate) fn stamped(mut result: Value) -> Value {
    result["format"] = RESULTS_FORMAT.into();
    result["version"] = env!("CARGO_PKG_VERSION").into();
    result
}
