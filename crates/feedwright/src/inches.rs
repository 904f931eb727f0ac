//! Metric figures of a text in inches: thousandths (thou) for errors, inches for lengths, inches a
//! minute for speeds.
//!
//! An inch shop states tolerances in thousandths of an inch, and reads them to a tenth of that.
//! Contour errors therefore are in thousandths. A figure gets one decimal more than it has in mm or
//! um, so that no digit is lost: 1 um is 0.039 thou.

use feedwright_gcode::INCH_MM;

/// A metric unit, the unit in its place, and the factor of the number.
type MetricUnit = (&'static str, &'static str, f64);

/// Longest first.
const UNITS: [MetricUnit; 6] = [
    ("mm/min", "in/min", 1.0 / INCH_MM),
    ("mm/s2", "in/s2", 1.0 / INCH_MM),
    ("mm/s", "in/min", 60.0 / INCH_MM),
    ("mm", "in", 1.0 / INCH_MM),
    ("um", "thou", 1.0 / INCH_MM),
    ("\u{b5}m", "thou", 1.0 / INCH_MM),
];

/// Text between two numbers where the second number has the unit of both.
const BETWEEN: [&str; 6] = [
    " and ",
    " to ",
    ", max ",
    ", largest ",
    ") and max ",
    ", RMS ",
];
/// Text between two numbers where the first number has the unit of both.
const COMPARED: &str = " for ";

/// The text with each number that has a metric unit behind it in inches. Everything else stays,
/// such as `10um` in an example.
pub(crate) fn in_inches(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    let mut rest = text;
    while let Some(at) = rest.find(|c: char| c.is_ascii_digit()) {
        // Digits inside of a word are part of a name.
        let before = rest[..at]
            .chars()
            .next_back()
            .or_else(|| out.chars().next_back());
        let is_name = before.is_some_and(|c| c.is_alphanumeric() || c == '_');
        out.push_str(&rest[..at]);
        rest = &rest[at..];
        let number = number_of(rest);
        let shared = out
            .strip_suffix(COMPARED)
            .and_then(|before| UNITS.iter().find(|(_, inch, _)| before.ends_with(inch)));
        let shared = shared.filter(|_| !is_compared_value_with_own_unit(&rest[number.len()..]));
        rest = &rest[number.len()..];
        let factor = unit_behind(rest)
            .or(shared)
            .map(|(.., factor)| factor)
            .filter(|_| !is_name);
        match (number.parse::<f64>(), factor) {
            (Ok(value), Some(factor)) => out.push_str(&converted(number, value * factor)),
            _ => out.push_str(number),
        }
        if let (Some((metric, inch, _)), false) = (unit_of(rest), is_name) {
            out.push(' ');
            out.push_str(inch);
            rest = &rest[1 + metric.len()..];
        }
    }
    out + rest
}

/// Returns true if a number that follows [`COMPARED`] has a unit of another kind, such as `for 3
/// stretches`.
fn is_compared_value_with_own_unit(behind: &str) -> bool {
    behind
        .strip_prefix(' ')
        .is_some_and(|rest| rest.starts_with(|c: char| c.is_alphabetic()))
}

/// The digits and the point at the beginning of a text.
fn number_of(text: &str) -> &str {
    let end = text
        .find(|c: char| !c.is_ascii_digit() && c != '.')
        .unwrap_or(text.len());
    text[..end].trim_end_matches('.')
}

/// Returns the unit of the number before `rest`: its own, or the unit of the number that it is
/// listed with.
fn unit_behind(rest: &str) -> Option<&'static MetricUnit> {
    unit_of(rest).or_else(|| {
        let next = BETWEEN
            .iter()
            .find_map(|between| rest.strip_prefix(between))?;
        let number = number_of(next);
        if number.is_empty() {
            None
        } else {
            unit_behind(&next[number.len()..])
        }
    })
}

/// A heading of a table with its unit in inches, and the factor of the numbers below it.
#[cfg(feature = "command")]
pub(crate) fn heading_in_inches(heading: &str) -> (String, Option<f64>) {
    let unit = heading.rsplit(' ').next().unwrap_or_default();
    match UNITS.iter().find(|(metric, ..)| *metric == unit) {
        Some((metric, inch, factor)) => {
            let before = &heading[..heading.len() - metric.len()];
            (format!("{before}{inch}"), Some(*factor))
        }
        None => (heading.to_owned(), None),
    }
}

/// A number of a table times a factor; other text stays.
#[cfg(feature = "command")]
pub(crate) fn cell_in_inches(cell: &str, factor: f64) -> String {
    let bare = cell.trim_matches(['(', ')']);
    match bare.parse::<f64>() {
        Ok(value) => cell.replace(bare, &converted(bare, value * factor)),
        Err(_) => cell.to_owned(),
    }
}

/// The unit behind a blank at the beginning of a text.
fn unit_of(text: &str) -> Option<&'static MetricUnit> {
    let text = text.strip_prefix(' ')?;
    let ends =
        |rest: &str| !rest.starts_with(|c: char| c.is_alphanumeric() || c == '/' || c == '\u{b2}');
    UNITS
        .iter()
        .find(|(metric, ..)| text.strip_prefix(metric).is_some_and(ends))
}

/// Formats a value with one decimal more than the metric number has.
fn converted(metric: &str, value: f64) -> String {
    let decimals = metric
        .split_once('.')
        .map_or(0, |(_, decimals)| decimals.len());
    format!("{value:.0$}", decimals + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn figures_with_a_metric_unit_are_in_inches_and_names_stay() {
        for (metric, inch) in [
            (
                "RMS contour error 35.7 um -> 0.80 um (-98 %)",
                "RMS contour error 1.41 thou -> 0.031 thou (-98 %)",
            ),
            ("largest 120 \u{b5}m", "largest 4.7 thou"),
            (
                "within 20 mm, at most 50.0 mm/s",
                "within 0.8 in, at most 118.11 in/min",
            ),
            ("508 mm/min, 25.4 mm.", "20.0 in/min, 1.00 in."),
            ("2.02 m/s2 in 12 s, 3 m", "2.02 m/s2 in 12 s, 3 m"),
            (
                "part10 um.ngc and --tolerance 10um",
                "part10 um.ngc and --tolerance 10um",
            ),
            ("10 mm2 and 5 mms", "10 mm2 and 5 mms"),
            ("RMS 25.4, max 50.8 um", "RMS 1.00, max 2.00 thou"),
            (
                "RMS 2.5 um (2.5 to 2.5) and max 2.5 um",
                "RMS 0.10 thou (0.10 to 0.10) and max 0.10 thou",
            ),
            (
                "RMS 25.4 um for 50.8, lines 4 and 5",
                "RMS 1.00 thou for 2.00, lines 4 and 5",
            ),
            ("1.0 um for 3 stretches", "0.04 thou for 3 stretches"),
        ] {
            assert_eq!(in_inches(metric), inch);
        }
    }

    #[cfg(feature = "command")]
    #[test]
    fn a_table_is_converted_by_its_headings() {
        assert_eq!(
            heading_in_inches("RMS um"),
            ("RMS thou".to_owned(), Some(1.0 / INCH_MM))
        );
        assert_eq!(heading_in_inches("time s"), ("time s".to_owned(), None));
        assert_eq!(cell_in_inches("25.40", 1.0 / INCH_MM), "1.000");
        assert_eq!(
            (
                cell_in_inches("(508)", 1.0 / INCH_MM),
                cell_in_inches("-", 1.0)
            ),
            ("(20.0)".to_owned(), "-".to_owned())
        );
    }
}
