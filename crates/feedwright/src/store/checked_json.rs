//! Text of a result, with a checksum in front, so that a damaged one is found:
//! `{"check":"0123456789abcdef","result":...}`.
//!
//! The checksum is the beginning of the BLAKE3 hash of all that stands behind it.

use serde::Serialize;
use serde::de::DeserializeOwned;

/// Hexadecimal digits of a checksum: 64 bits find what a disk or an editor does.
const DIGITS: usize = 16;
const BEGIN: &str = "{\"check\":\"";
const BETWEEN: &str = "\",\"result\":";

/// Returns the text of a result.
pub(super) fn text_of(result: &impl Serialize) -> serde_json::Result<String> {
    let rest = serde_json::to_string(result)? + "}";
    Ok(format!("{BEGIN}{}{BETWEEN}{rest}", checksum(&rest)))
}

/// Returns the result of a text; `None` if the text is damaged or holds something else.
pub(super) fn result_of<T: DeserializeOwned>(text: &str) -> Option<T> {
    let (check, rest) = text.strip_prefix(BEGIN)?.split_at_checked(DIGITS)?;
    let rest = rest.strip_prefix(BETWEEN)?;
    if checksum(rest) != check {
        return None;
    }
    serde_json::from_str(rest.strip_suffix('}')?).ok()
}

fn checksum(text: &str) -> String {
    blake3::hash(text.as_bytes()).to_hex()[..DIGITS].to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_wrong_bit_is_found() {
        let result = serde_json::json!({ "a": 0.125, "b": [1, 2] });
        let kept = text_of(&result).unwrap();
        assert_eq!(result_of(&kept), Some(result));
        assert!(serde_json::from_str::<serde_json::Value>(&kept).is_ok());
        let read = |text: &str| result_of::<serde_json::Value>(text);
        for at in 0..kept.len() {
            let mut bytes = kept.clone().into_bytes();
            bytes[at] ^= 1;
            let found = String::from_utf8(bytes).ok().and_then(|text| read(&text));
            assert_eq!((found, read(&kept[..at])), (None, None), "byte {at}");
        }
    }
}
