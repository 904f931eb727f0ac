//! Numbers and texts of the page.

use std::fmt::Write as _;

use feedwright_gcode::visible;

/// Escapes `text` for HTML element content and quoted attributes, and makes hidden characters
/// visible.
pub fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in visible(text).chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            c => out.push(c),
        }
    }
    out
}

/// Formats a number with three significant digits, at most two decimals, and a true minus sign.
pub(crate) fn number(value: f64) -> String {
    if !value.is_finite() {
        return "–".to_owned();
    }
    let decimals = match value.abs() {
        x if x >= 99.95 => 0,
        x if x >= 9.995 => 1,
        _ => 2,
    };
    fixed(value, decimals)
}

/// Formats a number with `decimals` decimals and a true minus sign, but no sign before a zero.
pub(super) fn fixed(value: f64, decimals: usize) -> String {
    if !value.is_finite() {
        return "–".to_owned();
    }
    let plain = format!("{:.decimals$}", value.abs());
    let is_zero = plain.bytes().all(|b| b == b'0' || b == b'.');
    if value < 0.0 && !is_zero {
        format!("−{plain}")
    } else {
        plain
    }
}

/// Formats like [`fixed`], with a plus sign before a value above zero.
pub(super) fn signed(value: f64, decimals: usize) -> String {
    let text = fixed(value, decimals);
    if value > 0.0 && text.bytes().any(|b| (b'1'..=b'9').contains(&b)) {
        format!("+{text}")
    } else {
        text
    }
}

/// Formats a time with its unit: "1.76 s", "10 min 03.2 s", "2 h 05 min 10 s".
pub(super) fn duration(seconds: f64) -> String {
    if !seconds.is_finite() {
        return "–".to_owned();
    }
    let mut out = String::new();
    if seconds < 119.995 {
        let _ = write!(out, "{seconds:.2} s");
    } else if seconds < 7199.95 {
        let tenths = (seconds * 10.0).round() as u64;
        let _ = write!(
            out,
            "{} min {:02}.{} s",
            tenths / 600,
            tenths % 600 / 10,
            tenths % 10
        );
    } else {
        let whole = seconds.round() as u64;
        let _ = write!(
            out,
            "{} h {:02} min {:02} s",
            whole / 3600,
            whole % 3600 / 60,
            whole % 60
        );
    }
    out
}

/// Formats the change from `before` to `after` in percent: "−87 %"; none if `before` is zero. Near
/// −100 % it has more decimals, because the remainder matters. From ten times on it is the factor.
pub(crate) fn change(before: f64, after: f64) -> Option<String> {
    let percent = (after / before - 1.0) * 100.0;
    if before == 0.0 || !percent.is_finite() {
        return None;
    }
    Some(if after >= 10.0 * before {
        format!("× {}", number(after / before))
    } else if percent.abs() < 0.05 {
        "±0 %".to_owned()
    } else if after > 0.0 && percent < -99.9 {
        format!("{} %", signed(percent, 2))
    } else if percent.abs() < 10.0 || after > 0.0 && percent < -99.0 {
        format!("{} %", signed(percent, 1))
    } else {
        format!("{} %", signed(percent, 0))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_have_three_digits_and_a_true_minus() {
        assert_eq!(
            [18.04, -2.401, 129.4, 0.0, -0.001, 99.96, f64::NAN].map(number),
            ["18.0", "−2.40", "129", "0.00", "0.00", "100", "–"]
        );
    }

    #[test]
    fn times_grow_units() {
        assert_eq!(
            [1.757, 603.2, 7510.4, 119.999].map(duration),
            ["1.76 s", "10 min 03.2 s", "2 h 05 min 10 s", "2 min 00.0 s"]
        );
    }

    #[test]
    fn changes_are_relative_to_the_first() {
        assert_eq!(change(18.0, 2.4).as_deref(), Some("−87 %"));
        assert_eq!(change(18.0, 0.03).as_deref(), Some("−99.8 %"));
        assert_eq!(change(1e4, 2.0).as_deref(), Some("−99.98 %"));
        assert_eq!(change(18.0, 0.0).as_deref(), Some("−100 %"));
        assert_eq!(change(1.76, 1.69).as_deref(), Some("−4.0 %"));
        assert_eq!(change(2.0, 2.0).as_deref(), Some("±0 %"));
        assert_eq!(change(0.1, 7.3).as_deref(), Some("× 73.0"));
        assert_eq!(change(0.0, 1.0), None);
    }

    #[test]
    fn markup_is_inert() {
        assert_eq!(
            escaped("</script><img onerror='x'>\"&\u{0}"),
            "&lt;/script&gt;&lt;img onerror=&#39;x&#39;&gt;&quot;&amp;\u{fffd}"
        );
    }
}
