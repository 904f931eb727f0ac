//! Numbers in messages and lists: plain where that is short, with an exponent where it would be a
//! row of zeros.

use std::ops::Range;

/// Magnitudes that are written out: a thousandth has three zeros, a million six.
const WRITTEN_OUT: Range<f64> = 1e-3..1e6;

/// A number for people, with all of its digits.
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
    shown(format!("{number:.3e}").parse().unwrap_or(number))
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
}
