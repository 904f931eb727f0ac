//! Units of lengths and speeds on the page.
//!
//! An inch is to a thousandth what a millimeter is to a micrometer, so one factor serves lengths,
//! errors and speeds: a page in inches is the metric page with its numbers divided by 25.4, and
//! with other names of units. Accelerations stay in m/s².

use feedwright_gcode::INCH_MM;

use super::text::{fixed, number, signed};
use crate::inches::in_inches;

/// Units of lengths and speeds on the page.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub enum PageUnits {
    /// mm, µm, mm/min.
    #[default]
    Metric,
    /// Inches, thousandths of an inch, in/min.
    Inch,
}

impl PageUnits {
    /// Returns the factor on a value in mm, µm or mm/s.
    pub(crate) const fn factor(self) -> f64 {
        match self {
            Self::Metric => 1.0,
            Self::Inch => 1.0 / INCH_MM,
        }
    }

    /// Returns the name of the unit of errors.
    pub(crate) const fn error(self) -> &'static str {
        match self {
            Self::Metric => "µm",
            Self::Inch => "thou",
        }
    }

    /// Returns the name of the unit of lengths.
    pub(super) const fn length(self) -> &'static str {
        match self {
            Self::Metric => "mm",
            Self::Inch => "in",
        }
    }

    /// Returns the name of the unit of feedrates.
    pub(crate) const fn feed(self) -> &'static str {
        match self {
            Self::Metric => "mm/min",
            Self::Inch => "in/min",
        }
    }

    /// Formats an error in µm to three digits. A thousandth of an inch has one more decimal,
    /// because it is 25.4 µm.
    pub(crate) fn number(self, um: f64) -> String {
        let value = self.factor() * um;
        match self {
            Self::Inch if value.abs() < 0.9995 => fixed(value, 3),
            _ => number(value),
        }
    }

    /// Formats a length in mm, or an error in µm, with `decimals` decimals, and one more in inches.
    pub(crate) fn fixed(self, value: f64, decimals: usize) -> String {
        fixed(self.factor() * value, self.decimals(decimals))
    }

    /// Formats like [`Self::fixed`], with a plus sign before a value above zero.
    pub(super) fn signed(self, value: f64, decimals: usize) -> String {
        signed(self.factor() * value, self.decimals(decimals))
    }

    fn decimals(self, metric: usize) -> usize {
        metric + usize::from(self == Self::Inch)
    }

    /// Converts a text with metric figures.
    pub(crate) fn text(self, text: &str) -> String {
        match self {
            Self::Metric => text.to_owned(),
            Self::Inch => in_inches(text),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_value_has_the_digits_of_its_unit() {
        let inch = PageUnits::Inch;
        assert_eq!(
            [0.24, 25.4, 254.0, 2540.0].map(|um| inch.number(um)),
            ["0.009", "1.00", "10.0", "100"]
        );
        assert_eq!(
            [0.24, 25.4].map(|um| PageUnits::Metric.number(um)),
            ["0.24", "25.4"]
        );
        assert_eq!(
            (inch.fixed(-25.4, 2), inch.signed(25.4, 2)),
            ("−1.000".to_owned(), "+1.000".to_owned())
        );
        assert_eq!(inch.text("35.7 µm over 508 mm"), "1.41 thou over 20.0 in");
    }
}
