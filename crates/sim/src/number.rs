//! Numbers as text: all digits, significant digits, or fixed decimals.

use std::ops::Range;

/// Magnitudes that are written out: a thousandth has three zeros, a million six.
const WRITTEN_OUT: Range<f64> = 1e-3..1e6;

/// A number for people, with all of its digits: plain where that is short, with an exponent where
/// it would be a row of zeros.
pub fn shown(number: f64) -> String {
    let plain = number == 0.0 || !number.is_finite() || WRITTEN_OUT.contains(&number.abs());
    if plain {
        format!("{number}")
    } else {
        format!("{number:e}")
    }
}

/// The same to four digits.
pub fn to_four_digits(number: f64) -> String {
    shown(rounded(number, 4))
}

/// Rounds a number to significant digits.
pub fn rounded(number: f64, digits: usize) -> f64 {
    format!("{number:.*e}", digits - 1)
        .parse()
        .unwrap_or(number)
}

/// Formats a number with `digits` significant digits, zeros at the end too. A number of more than
/// `most` + 1 places before the point, or with zeros behind it, has an exponent.
pub fn significant(number: f64, digits: i32, most: i32) -> String {
    if number == 0.0 || !number.is_finite() {
        return format!("{number}");
    }
    let before_the_point = libm::log10(number.abs()).floor() as i32;
    if (-4..=most).contains(&before_the_point) {
        let decimals = (digits - 1 - before_the_point).max(0) as usize;
        format!("{number:.decimals$}")
    } else {
        format!("{number:.*e}", (digits - 1) as usize)
    }
}

/// Formats a number with fixed decimals; `-` if it is not known.
pub fn fixed(number: f64, decimals: usize) -> String {
    if number.is_finite() {
        format!("{number:.decimals$}")
    } else {
        "-".to_owned()
    }
}

/// Formats a number with at most `decimals` decimals, without zeros at the end and without a
/// negative zero.
pub fn trimmed(number: f64, decimals: usize) -> String {
    let text = format!("{number:.decimals$}");
    let text = if text.contains('.') {
        text.trim_end_matches('0').trim_end_matches('.')
    } else {
        &text
    };
    if text == "-0" { "0" } else { text }.to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_no_more_zeros_than_they_need() {
        let numbers = [
            8.0,
            -0.001,
            999_999.5,
            1e6,
            1.0754e-5,
            0.0,
            f64::INFINITY,
            f64::NAN,
        ]
        .map(shown);
        assert_eq!(
            numbers,
            [
                "8",
                "-0.001",
                "999999.5",
                "1e6",
                "1.0754e-5",
                "0",
                "inf",
                "NaN"
            ]
        );
        let rounded = [
            8.0,
            117.735,
            0.0301,
            9.786e-1,
            1.0754e-5,
            1e-11,
            0.0,
            -2e7,
            f64::NAN,
        ]
        .map(to_four_digits);
        assert_eq!(
            rounded,
            [
                "8", "117.7", "0.0301", "0.9786", "1.075e-5", "1e-11", "0", "-2e7", "NaN"
            ]
        );
    }

    #[test]
    fn significant_digits_are_kept_with_their_zeros() {
        let numbers = [
            0.0,
            1.0,
            0.0123456,
            -0.000123456,
            123.4,
            1234.0,
            9.87654e-7,
            f64::NAN,
        ]
        .map(|number| significant(number, 3, 2));
        assert_eq!(
            numbers,
            [
                "0",
                "1.00",
                "0.0123",
                "-0.000123",
                "123",
                "1.23e3",
                "9.88e-7",
                "NaN"
            ]
        );
    }

    #[test]
    fn fixed_decimals_are_kept_or_trimmed() {
        assert_eq!([fixed(1.005, 1), fixed(f64::NAN, 1)], ["1.0", "-"]);
        let numbers = [10.0, -1e-6, 1.25, 0.123_456].map(|number| trimmed(number, 5));
        assert_eq!(numbers, ["10", "0", "1.25", "0.12346"]);
        assert_eq!(trimmed(10.4, 0), "10");
    }
}
