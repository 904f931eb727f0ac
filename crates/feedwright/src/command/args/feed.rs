//! A feedrate with its unit.

/// Units of a feedrate, and what one of them is in mm/s.
const UNITS: [(&str, f64); 5] =
    [("mm/min", 1.0 / 60.0), ("mm/s", 1.0), ("m/min", 1000.0 / 60.0), ("in/min", 25.4 / 60.0), ("in/s", 25.4)];

/// A feedrate such as `3000mm/min` or `50 mm/s`, in mm/s. A number alone could be either, by sixty times.
pub fn feed_mm_s(text: &str) -> Result<f64, String> {
    let text = text.trim();
    let unit_at = text.char_indices().find(|&(at, c)| {
        let is_exponent =
            matches!(c, 'e' | 'E') && text[at + 1..].starts_with(|c: char| c.is_ascii_digit() || "+-".contains(c));
        c.is_ascii_alphabetic() && !is_exponent
    });
    let (number, unit) = text.split_at(unit_at.map_or(text.len(), |(at, _)| at));
    let number = number.trim();
    let value: f64 = match number.parse() {
        Ok(value) => value,
        Err(_) if number.contains(',') => {
            return Err(format!("write {} with a point, not a comma", number.replace(',', ".")));
        }
        Err(_) => return Err("it begins with no number; write 3000mm/min or 50mm/s".to_owned()),
    };
    let unit = unit.trim().to_ascii_lowercase();
    if unit.is_empty() {
        let [slow, fast] = [value / 60.0, value * 60.0].map(shown);
        return Err(format!("it has no unit; {number}mm/min is {slow} mm/s, {number}mm/s is {fast} mm/min"));
    }
    match UNITS.iter().find(|(name, _)| *name == unit) {
        Some((_, mm_s)) => Ok(value * mm_s),
        None => Err(format!("'{unit}' is no unit of a feedrate; those are {}", UNITS.map(|(name, _)| name).join(", "))),
    }
}

/// A number without digits that say nothing.
fn shown(value: f64) -> String {
    let text = format!("{value:.3}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

#[cfg(test)]
mod tests {
    use super::feed_mm_s;

    #[test]
    fn a_feedrate_has_a_unit() {
        for (text, mm_s) in [
            ("3000mm/min", 50.0),
            ("50 mm/s", 50.0),
            (" 3 M/min", 50.0),
            ("1e1mm/s", 10.0),
            ("60in/min", 25.4),
            ("-1mm/s", -1.0),
        ] {
            let found = feed_mm_s(text).expect(text);
            assert!((found - mm_s).abs() < 1e-12 * mm_s.abs(), "{text}: {found}");
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
    }
}
