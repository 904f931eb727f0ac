//! What an unknown name was probably meant to be.

/// Two names further apart than this (Jaro-Winkler, 1 is equal) share little more than letters: no
/// suggestion then.
const SIMILARITY: f64 = 0.75;

/// The candidate, in lower case, that `word` was probably meant to be.
pub fn nearest<'a>(word: &str, candidates: &[&'a str]) -> Option<&'a str> {
    candidates
        .iter()
        .map(|candidate| {
            (
                strsim::jaro_winkler(&word.to_lowercase(), candidate),
                *candidate,
            )
        })
        .filter(|(similarity, _)| *similarity >= SIMILARITY)
        .max_by(|a, b| a.0.total_cmp(&b.0))
        .map(|(_, candidate)| candidate)
}
