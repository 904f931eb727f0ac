//! Decimal numbers out of bytes.
//!
//! A log of ten million rows has a hundred million numbers, nearly all of them short: up to 15
//! digits are a whole number times a power of ten that both are exact in binary, and so is their
//! product or quotient rounded once (Clinger 1990, How to read floating point numbers accurately).
//! Whatever is longer takes the long way.

/// Powers of ten that are exact.
const EXACT: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16,
    1e17, 1e18, 1e19, 1e20, 1e21, 1e22,
];
/// Digits of which every whole number is exact.
const EXACT_DIGITS: u32 = 15;

/// Parses the number in a field; spaces and quotes around it are allowed. Returns [`f64::NAN`] for
/// an empty field and for `nan`, and `None` for anything else that is not a number.
pub(super) fn parse(field: &[u8], point: u8) -> Option<f64> {
    let field = trimmed(field);
    if field.is_empty() {
        return Some(f64::NAN);
    }
    short(field, point).or_else(|| long(field, point))
}

/// Removes surrounding spaces and quotes.
pub(super) fn trimmed(field: &[u8]) -> &[u8] {
    let field = field.trim_ascii();
    match field {
        [b'"', inner @ .., b'"'] => inner.trim_ascii(),
        _ => field,
    }
}

/// Digits, perhaps with a sign and a decimal point; none where it is anything else or too long.
#[inline]
fn short(field: &[u8], point: u8) -> Option<f64> {
    let (is_negative, digits) = match field {
        [b'-', rest @ ..] => (true, rest),
        [b'+', rest @ ..] => (false, rest),
        _ => (false, field),
    };
    let (mut whole, mut count, mut behind) = (0_u64, 0_u32, None);
    for &byte in digits {
        let digit = byte.wrapping_sub(b'0');
        if digit < 10 {
            whole = whole * 10 + u64::from(digit);
            // Zeros in front are not digits of the number.
            count += u32::from(whole > 0);
            behind = behind.map(|places: usize| places + 1);
            if count > EXACT_DIGITS {
                return None;
            }
        } else if byte == point && behind.is_none() {
            behind = Some(0);
        } else {
            return None;
        }
    }
    let places = behind.unwrap_or(0);
    let has_digit = digits.len() > usize::from(behind.is_some());
    let value = whole as f64 / *EXACT.get(places).filter(|_| has_digit)?;
    Some(if is_negative { -value } else { value })
}

/// Anything that the standard library reads.
fn long(field: &[u8], point: u8) -> Option<f64> {
    let text = std::str::from_utf8(field).ok()?;
    if point == b'.' {
        return text.parse().ok();
    }
    if text.contains('.') {
        return None;
    }
    text.replacen(char::from(point), ".", 1).parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_those_of_the_standard_library() {
        for text in [
            "0",
            "-0",
            "1",
            "+1.5",
            "-0.0001",
            "123456789012345",
            "1234567890123456789",
            "0.1",
            "0.30000000000000004",
            "1e-3",
            "1.28E-4",
            "-29536.602942",
            "00000000000000000001.5",
            "5.",
            ".5",
            "0.000000000000000000000001",
            "inf",
        ] {
            let expected: f64 = text.parse().unwrap();
            assert_eq!(
                parse(text.as_bytes(), b'.').map(f64::to_bits),
                Some(expected.to_bits()),
                "{text}"
            );
        }
        for text in ["x", "1.2.3", "-", ".", "+", "1,5", "0x10", "1 2", "--1"] {
            assert_eq!(parse(text.as_bytes(), b'.'), None, "{text}");
        }
    }

    #[test]
    fn a_comma_is_a_point_where_it_is_said() {
        assert_eq!(parse(b" \"-1,25\" ", b','), Some(-1.25));
        assert_eq!(parse(b"1,5e-3", b','), Some(1.5e-3));
        assert_eq!(parse(b"1.5", b','), None);
        assert!(parse(b"  ", b',').is_some_and(f64::is_nan));
    }
}
