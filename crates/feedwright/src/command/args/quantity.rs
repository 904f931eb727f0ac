//! Lengths and feedrates with their units.

use feedwright_gcode::INCH_MM;
use feedwright_sim::trimmed;

/// Units of a length, and what one of them is in mm.
const LENGTHS: [(&str, f64); 8] = [
    ("um", 1e-3),
    ("µm", 1e-3),
    ("mm", 1.0),
    ("in", INCH_MM),
    ("inch", INCH_MM),
    ("thou", 1e-3 * INCH_MM),
    ("mil", 1e-3 * INCH_MM),
    ("m", 1e3),
];
/// Units that a message lists.
const SHOWN_LENGTHS: &str = "um, mm, in, thou";

/// Units of a feedrate, and what one of them is in mm/min.
const FEEDS: [(&str, f64); 6] = [
    ("mm/min", 1.0),
    ("mm/s", 60.0),
    ("m/min", 1000.0),
    ("in/min", INCH_MM),
    ("ipm", INCH_MM),
    ("in/s", 60.0 * INCH_MM),
];

/// A feedrate such as `3000mm/min`, `50 mm/s` or `120ipm`, in mm/s. A number alone could be either,
/// by sixty times.
pub fn feed_mm_s(text: &str) -> Result<f64, String> {
    let UnitValue {
        number,
        value,
        unit,
    } = UnitValue::read(text, "3000mm/min, 50mm/s or 120ipm")?;
    if unit.is_empty() {
        let [slow, fast] = [value / 60.0, value * 60.0].map(|feed| trimmed(feed, 3));
        return Err(format!(
            "it has no unit; {number}mm/min is {slow} mm/s, {number}mm/s is {fast} mm/min"
        ));
    }
    // A feedrate in mm/s comes out as it was written.
    if unit == "mm/s" {
        Ok(value)
    } else {
        Ok(value * feed_unit(&unit)? / 60.0)
    }
}

/// A feedrate in mm/min; a number alone is one.
pub(crate) fn feed_mm_min(text: &str) -> Result<f64, String> {
    let UnitValue { value, unit, .. } = UnitValue::read(text, "500mm/min or 20ipm")?;
    if unit.is_empty() {
        Ok(value)
    } else {
        Ok(value * feed_unit(&unit)?)
    }
}

/// A length such as `10um`, `0.01mm`, `0.0004in` or `0.4thou`, in um; a number alone is in um.
pub(crate) fn length_um(text: &str) -> Result<f64, String> {
    let UnitValue { value, unit, .. } = UnitValue::read(
        text,
        "a length above 0, such as 10um, 0.01mm, 0.0004in or 0.4thou",
    )?;
    match unit.as_str() {
        // As it was written, to the last bit.
        "" | "um" | "µm" => Ok(value),
        unit => Ok(1e3 * (value * length_unit(unit)?)),
    }
}

/// A length in mm; a number alone is in mm.
pub(crate) fn length_mm(text: &str) -> Result<f64, String> {
    let UnitValue { value, unit, .. } = UnitValue::read(text, "20mm or 0.8in")?;
    if unit.is_empty() {
        Ok(value)
    } else {
        Ok(value * length_unit(&unit)?)
    }
}

/// A length of 0.1 to 10000 mm, in mm; a number alone is in mm.
pub(crate) fn size_mm(text: &str) -> Result<f64, String> {
    within(length_mm(text)?, "mm")
}

/// A feedrate of 0.1 to 10000 mm/min, in mm/min; a number alone is in mm/min.
pub(crate) fn slow_feed_mm_min(text: &str) -> Result<f64, String> {
    within(feed_mm_min(text)?, "mm/min")
}

/// Largest value of a length in mm or a feedrate in mm/min.
const MOST: f64 = 1e4;

fn within(value: f64, unit: &str) -> Result<f64, String> {
    if (0.1..=MOST).contains(&value) {
        Ok(value)
    } else {
        Err(format!(
            "it is {value} {unit}, and must be 0.1 to {MOST} {unit}"
        ))
    }
}

/// A number and its unit.
struct UnitValue<'a> {
    number: &'a str,
    value: f64,
    unit: String,
}

impl<'a> UnitValue<'a> {
    /// Splits a text into number and unit. The error shows `examples` if the text does not begin
    /// with a number.
    fn read(text: &'a str, examples: &str) -> Result<Self, String> {
        let text = text.trim();
        let unit_at = text.char_indices().find(|&(at, c)| {
            let is_exponent = matches!(c, 'e' | 'E')
                && text[at + 1..].starts_with(|c: char| c.is_ascii_digit() || "+-".contains(c));
            c.is_alphabetic() && !is_exponent
        });
        let (number, unit) = text.split_at(unit_at.map_or(text.len(), |(at, _)| at));
        let number = number.trim();
        // The sign of micro is one of two characters.
        let unit = unit.trim().to_lowercase().replace('\u{3bc}', "µ");
        match number.parse::<f64>() {
            Ok(value) => Ok(Self {
                number,
                value,
                unit,
            }),
            Err(_) if number.contains(',') => Err(format!(
                "write {} with a point, not a comma",
                number.replace(',', ".")
            )),
            _ => Err(format!("it begins with no number; write {examples}")),
        }
    }
}

fn length_unit(unit: &str) -> Result<f64, String> {
    let found = LENGTHS.iter().find(|(name, _)| *name == unit);
    found
        .map(|(_, mm)| *mm)
        .ok_or_else(|| format!("'{unit}' is no unit of a length; those are {SHOWN_LENGTHS}"))
}

fn feed_unit(unit: &str) -> Result<f64, String> {
    let found = FEEDS.iter().find(|(name, _)| *name == unit);
    let names = || FEEDS.map(|(name, _)| name).join(", ");
    found
        .map(|(_, mm_min)| *mm_min)
        .ok_or_else(|| format!("'{unit}' is no unit of a feedrate; those are {}", names()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn agree(found: f64, wanted: f64, text: &str) {
        assert!(
            (found - wanted).abs() < 1e-12 * wanted.abs(),
            "{text}: {found}"
        );
    }

    #[test]
    fn a_feedrate_has_a_unit() {
        for (text, mm_s) in [
            ("3000mm/min", 50.0),
            ("50 mm/s", 50.0),
            (" 3 M/min", 50.0),
            ("1e1mm/s", 10.0),
            ("60in/min", 25.4),
            ("60 IPM", 25.4),
            ("1in/s", 25.4),
            ("-1mm/s", -1.0),
        ] {
            agree(feed_mm_s(text).expect(text), mm_s, text);
        }
        for (text, says) in [
            ("50", "50mm/min is 0.833 mm/s, 50mm/s is 3000 mm/min"),
            ("50mm", "'mm' is no unit of a feedrate"),
            ("1,5mm/s", "write 1.5 with a point"),
            ("fast", "begins with no number"),
            ("", "begins with no number"),
        ] {
            let error = feed_mm_s(text).expect_err(text);
            assert!(error.contains(says), "{text}: {error}");
        }
        assert_eq!(
            (feed_mm_min("500").ok(), feed_mm_min("10mm/s").ok()),
            (Some(500.0), Some(600.0))
        );
    }

    #[test]
    fn a_length_is_the_same_in_every_unit() {
        for (text, um) in [
            ("10", 10.0),
            ("10um", 10.0),
            ("10 µm", 10.0),
            ("10\u{3bc}m", 10.0),
            ("0.01mm", 10.0),
            ("0.0004in", 10.16),
            ("0.4 thou", 10.16),
            ("0.4mil", 10.16),
            ("-1", -1.0),
        ] {
            agree(length_um(text).expect(text), um, text);
        }
        for (text, says) in [
            (
                "10nm",
                "'nm' is no unit of a length; those are um, mm, in, thou",
            ),
            ("0,01mm", "write 0.01 with a point"),
            ("small", "begins with no number"),
            ("inf", "begins with no number"),
        ] {
            let error = length_um(text).expect_err(text);
            assert!(error.contains(says), "{text}: {error}");
        }
        agree(length_mm("2in").unwrap(), 50.8, "2in");
        assert_eq!(
            (
                length_mm("20").ok(),
                size_mm("0.05").is_err(),
                slow_feed_mm_min("2e4").is_err()
            ),
            (Some(20.0), true, true)
        );
    }
}
