//! The bytes of one line as RS-274 sees them: blanks mean nothing outside comments, and case does
//! not matter.
//!
//! Numbers are decimal without exponent: digits, one point, a sign. Up to 15 significant digits
//! (and any mantissa below 2^53 with at most 22 decimals) the value is exact arithmetic: integer
//! divided by a power of ten, both exact in f64, is correctly rounded (W. D. Clinger, How to read
//! floating point numbers accurately, 1990). Longer ones go through `str::parse`.

use crate::text::characters::not_ascii;
use crate::text::diagnostic::{LineFault, Read};

/// Byte that [`Cursor::peek`] returns behind the last byte. No line contains it.
pub(crate) const END: u8 = b'\n';

/// Powers of ten that f64 holds exactly.
pub(crate) const EXACT_POWERS: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16,
    1e17, 1e18, 1e19, 1e20, 1e21, 1e22,
];
/// Largest mantissa below which every integer is exact in f64.
const EXACT_MANTISSA: u64 = 1 << 53;
/// Digits that always fit a u64.
const SAFE_DIGITS: usize = 19;

/// Message for a number with an exponent.
pub(crate) const NO_EXPONENT: &str =
    "G-code has no exponents: write the digits out, 1500 for 1.5e3 and 0.0015 for 1.5e-3";

/// A place in a line.
#[derive(Debug, Clone)]
pub(crate) struct Cursor<'a> {
    pub(crate) bytes: &'a [u8],
    pub(crate) at: usize,
}

impl<'a> Cursor<'a> {
    pub(crate) const fn new(bytes: &'a [u8]) -> Self {
        Self { bytes, at: 0 }
    }

    /// The byte under the cursor as it stands, [`END`] behind the last.
    #[inline]
    pub(crate) fn raw(&self) -> u8 {
        self.bytes.get(self.at).copied().unwrap_or(END)
    }

    /// Moves to the next byte that is no blank and returns it in lower case.
    #[inline]
    pub(crate) fn peek(&mut self) -> u8 {
        loop {
            let byte = self.raw();
            if !is_blank(byte) {
                return byte.to_ascii_lowercase();
            }
            self.at += 1;
        }
    }

    /// Steps over the byte that `peek` showed.
    #[inline]
    pub(crate) fn bump(&mut self) {
        self.at = (self.at + 1).min(self.bytes.len());
    }

    /// Steps over `wanted` if it comes next.
    #[inline]
    pub(crate) fn eat(&mut self, wanted: u8) -> bool {
        let found = self.peek() == wanted;
        if found {
            self.bump();
        }
        found
    }

    /// Steps over the lower-case word `wanted` if it comes next, blanks inside it allowed.
    pub(crate) fn eat_word(&mut self, wanted: &[u8]) -> bool {
        let before = self.at;
        for &byte in wanted {
            if !self.eat(byte) {
                self.at = before;
                return false;
            }
        }
        true
    }

    /// Returns true if an `e` under the cursor looks like an exponent: between a digit or point and
    /// a digit or sign.
    pub(super) fn is_exponent(&self) -> bool {
        let before = self
            .at
            .checked_sub(1)
            .and_then(|before| self.bytes.get(before));
        let after = self.bytes.get(self.at + 1);
        self.raw().eq_ignore_ascii_case(&b'e')
            && before.is_some_and(|byte| byte.is_ascii_digit() || *byte == b'.')
            && after.is_some_and(|byte| byte.is_ascii_digit() || matches!(byte, b'+' | b'-'))
    }

    /// Returns true if a number follows the `$` under the cursor. The `$` then selects a spindle.
    pub(super) fn is_spindle(&self) -> bool {
        let after = self.bytes[self.at..]
            .iter()
            .skip(1)
            .find(|byte| !is_blank(**byte));
        after.is_some_and(|byte| byte.is_ascii_digit() || *byte == b'-')
    }

    /// The bytes to the end of the line.
    pub(super) fn rest(&self) -> &'a [u8] {
        &self.bytes[self.at.min(self.bytes.len())..]
    }

    /// Steps to the end of the line.
    pub(super) fn finish(&mut self) {
        self.at = self.bytes.len();
    }

    /// An unsigned or signed decimal number.
    #[inline]
    pub(crate) fn number(&mut self) -> Read<f64> {
        let first = self.peek();
        let start = self.at;
        let negative = first == b'-';
        if negative || first == b'+' {
            self.bump();
        }
        let (mut mantissa, mut digits, mut decimals) = (0u64, 0usize, 0usize);
        let mut point = false;
        loop {
            let byte = self.raw();
            if byte.is_ascii_digit() {
                mantissa = mantissa
                    .wrapping_mul(10)
                    .wrapping_add(u64::from(byte - b'0'));
                digits += 1;
                decimals += usize::from(point);
            } else if byte == b'.' && !point {
                point = true;
            } else if is_blank(byte) {
                let blank = self.at;
                let next = self.peek();
                if !next.is_ascii_digit() && (next != b'.' || point) {
                    self.at = blank;
                    break;
                }
                continue;
            } else {
                break;
            }
            self.at += 1;
        }
        if digits == 0 {
            return Err(self.not_a_number(start));
        }
        let value =
            if digits <= SAFE_DIGITS && mantissa <= EXACT_MANTISSA && decimals < EXACT_POWERS.len()
            {
                mantissa as f64 / EXACT_POWERS[decimals]
            } else {
                self.long_number(start)?
            };
        Ok(if negative { -value } else { value })
    }

    /// A number with more digits than exact arithmetic holds; the sign is left out.
    #[cold]
    fn long_number(&self, start: usize) -> Read<f64> {
        let digits: String = self.bytes[start..self.at]
            .iter()
            .filter(|byte| byte.is_ascii_digit() || **byte == b'.')
            .map(|&byte| char::from(byte))
            .collect();
        match digits.parse::<f64>() {
            Ok(value) if value.is_finite() => Ok(value),
            _ => Err(LineFault::new(
                "gcode::number",
                start..self.at,
                "a number this long is beyond what any control can hold",
            )),
        }
    }

    #[cold]
    fn not_a_number(&mut self, start: usize) -> Box<LineFault> {
        let found = self.peek();
        if !self.raw().is_ascii() {
            return not_ascii(self.bytes, self.at);
        }
        let what = if found == END {
            "the end of the line".to_owned()
        } else {
            format!("`{}`", shown(self.raw()))
        };
        let end = if found == END { self.at } else { self.at + 1 };
        LineFault::new(
            "gcode::number",
            start..end.max(start),
            format!("a number is missing: {what} stands in its place"),
        )
    }
}

/// Blank to RS-274; the carriage return belongs to line ends of other systems.
#[inline]
pub(crate) const fn is_blank(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | b'\r')
}

/// A byte as a message shows it.
pub(super) fn shown(byte: u8) -> String {
    if byte.is_ascii_graphic() {
        char::from(byte).to_string()
    } else {
        format!("byte {byte:#04x}")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blanks_inside_numbers_are_ignored() {
        assert_eq!(Cursor::new(b" 1 2 . 5 X").number().unwrap(), 12.5);
        assert_eq!(Cursor::new(b"- .5").number().unwrap(), -0.5);
        assert_eq!(Cursor::new(b"+7.").number().unwrap(), 7.0);
    }

    #[test]
    fn exponents_do_not_exist() {
        let mut cursor = Cursor::new(b"1e3");
        assert_eq!(cursor.number().unwrap(), 1.0);
        assert_eq!(cursor.peek(), b'e');
    }

    #[test]
    fn long_numbers_round_correctly() {
        for text in [
            "0.1000000000000000055511151231257827",
            "123456789012345678901234",
            "9007199254740993",
            "0.30000000000000004",
        ] {
            assert_eq!(
                Cursor::new(text.as_bytes()).number().unwrap(),
                text.parse::<f64>().unwrap(),
                "{text}"
            );
        }
    }

    #[test]
    fn a_lone_point_is_no_number() {
        assert!(Cursor::new(b".").number().is_err());
        assert!(Cursor::new(b"").number().is_err());
        assert!(Cursor::new(b"--5").number().is_err());
    }
}
