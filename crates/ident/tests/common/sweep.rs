//! How much of a long test runs: a part of its cases in the suite, all of them in `just sweep`.

/// The whole where `just sweep` asks for it by `FEEDWRIGHT_SWEEP`, else the part.
pub(crate) fn part_or_whole<T>(part: T, whole: T) -> T {
    if std::env::var_os("FEEDWRIGHT_SWEEP").is_some() {
        whole
    } else {
        part
    }
}
