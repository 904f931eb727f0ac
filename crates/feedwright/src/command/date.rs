//! Today's date, as year-month-day in UTC: from the system's clock, or from `SOURCE_DATE_EPOCH`
//! where a build that is to be repeated to the byte has set that.
//!
//! Source: `SOURCE_DATE_EPOCH` as <https://reproducible-builds.org/specs/source-date-epoch/> has
//! it; the date of a day as in the proleptic Gregorian calendar, whose 400 years have 146,097 days.

use std::time::{SystemTime, UNIX_EPOCH};

use miette::Diagnostic;
use thiserror::Error;

/// Error of a `SOURCE_DATE_EPOCH` that is not a time.
#[derive(Debug, Clone, PartialEq, Eq, Error, Diagnostic)]
#[error("SOURCE_DATE_EPOCH is '{0}', which is no time in whole seconds since 1970")]
#[diagnostic(help("set it to such a time, as 'date +%s' prints it, or unset it"))]
pub struct EpochError(String);

/// Latest time that is accepted, s since 1970: the end of the year 9999.
const LATEST_S: u64 = 253_402_300_799;

/// Today's date.
///
/// # Errors
/// A `SOURCE_DATE_EPOCH` that is no time.
pub fn today() -> Result<String, EpochError> {
    let now_s = SystemTime::now()
        .duration_since(UNIX_EPOCH)
        .map_or(0, |since| since.as_secs());
    let set = std::env::var_os("SOURCE_DATE_EPOCH").map(|text| text.to_string_lossy().into_owned());
    Ok(date(set.map_or(Ok(now_s), |text| seconds(&text))?))
}

fn seconds(text: &str) -> Result<u64, EpochError> {
    let seconds = text.parse().ok().filter(|seconds| *seconds <= LATEST_S);
    seconds.ok_or_else(|| EpochError(text.to_owned()))
}

/// The date of a time in seconds since 1970.
fn date(seconds: u64) -> String {
    let mut days = seconds / 86_400;
    let mut year = 1970;
    while days >= days_of(year) {
        days -= days_of(year);
        year += 1;
    }
    let february = if is_leap(year) { 29 } else { 28 };
    let mut month = 1;
    for days_of_month in [31, february, 31, 30, 31, 30, 31, 31, 30, 31, 30, 31] {
        if days < days_of_month {
            break;
        }
        days -= days_of_month;
        month += 1;
    }
    format!("{year:04}-{month:02}-{:02}", days + 1)
}

fn days_of(year: u64) -> u64 {
    if is_leap(year) { 366 } else { 365 }
}

fn is_leap(year: u64) -> bool {
    year.is_multiple_of(4) && (!year.is_multiple_of(100) || year.is_multiple_of(400))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Times as `date -u -d DATE +%s` gives them.
    #[test]
    fn dates_are_those_of_the_calendar() {
        for (seconds, expected) in [
            (0, "1970-01-01"),
            (951_782_400, "2000-02-29"),
            (951_868_800, "2000-03-01"),
            (1_735_689_599, "2024-12-31"),
            (1_735_689_600, "2025-01-01"),
            (4_107_542_400, "2100-03-01"),
            (LATEST_S, "9999-12-31"),
        ] {
            assert_eq!(date(seconds), expected);
        }
    }

    #[test]
    fn what_is_no_time_is_refused() {
        for text in [
            "",
            "yesterday",
            "-1",
            "1.5",
            "253402300800",
            "99999999999999999999",
        ] {
            assert!(seconds(text).is_err(), "{text}");
        }
        assert_eq!(seconds("1700000000"), Ok(1_700_000_000));
    }
}
