//! What a test says that cannot be made here.

/// Prints that a test is skipped because a program is missing. If `CI` is set, it panics instead:
/// the output of a passing test would go unread.
#[track_caller]
pub(crate) fn missing(what: &str) {
    let ci = std::env::var_os("CI").is_some_and(|value| !value.is_empty());
    assert!(!ci, "{what}, and CI is set: no test may be left out");
    eprintln!("SKIPPED: {what}");
}
