//! JSON objects with a checksum in front, so that a damaged one is found:
//! `{"check":"0123456789abcdef",...}`.
//!
//! The checksum is the beginning of the BLAKE3 hash of all that stands behind it.

/// Hexadecimal digits of a checksum: 64 bits find what a disk or an editor does.
const DIGITS: usize = 16;
const BEGIN: &str = "{\"check\":\"";
const BETWEEN: &str = "\",";

/// The text of an object that has at least one key, with its checksum.
pub fn with_check(object: &str) -> String {
    let rest = object.strip_prefix('{').unwrap_or(object);
    format!("{BEGIN}{}{BETWEEN}{rest}", checksum(rest))
}

/// The text of the object without its checksum; nothing where the two do not agree.
pub fn checked(text: &str) -> Option<String> {
    let (check, rest) = text
        .trim_end()
        .strip_prefix(BEGIN)?
        .split_at_checked(DIGITS)?;
    let rest = rest.strip_prefix(BETWEEN)?;
    (checksum(rest) == check).then(|| format!("{{{rest}"))
}

fn checksum(text: &str) -> String {
    blake3::hash(text.as_bytes()).to_hex()[..DIGITS].to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_wrong_bit_is_found() {
        let object = "{\"a\":0.125,\"b\":[1,2]}";
        let kept = with_check(object);
        assert_eq!(checked(&format!("{kept}\n")).as_deref(), Some(object));
        assert!(serde_json::from_str::<serde_json::Value>(&kept).is_ok());
        for at in 0..kept.len() {
            let mut bytes = kept.clone().into_bytes();
            bytes[at] ^= 1;
            assert_eq!(
                String::from_utf8(bytes)
                    .ok()
                    .and_then(|text| checked(&text)),
                None,
                "byte {at}"
            );
        }
        assert_eq!((checked(object), checked("")), (None, None));
    }
}
