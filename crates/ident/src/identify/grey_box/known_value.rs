//! A setting of a drive that somebody knows, and how well.

/// A value that is known within a spread.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct KnownValue {
    /// Value.
    pub(crate) value: f64,
    /// Standard deviation.
    pub(crate) spread: f64,
}

impl KnownValue {
    /// Standard deviation of what is given without one, part of it.
    const EXACT: f64 = 1e-3;

    /// The same of 1 / the value, 0 of 0.
    #[must_use]
    pub fn inverse(self) -> Self {
        if self.value == 0.0 {
            return self;
        }
        Self {
            value: 1.0 / self.value,
            spread: self.spread / (self.value * self.value),
        }
    }
}

/// `50`, `50±5`, `50±10%`; `+-` is as good as `±`.
impl std::str::FromStr for KnownValue {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let number = |text: &str| {
            text.trim()
                .parse::<f64>()
                .ok()
                .filter(|value| value.is_finite() && *value >= 0.0)
        };
        let parts = text.split_once('±').or_else(|| text.split_once("+-"));
        let (value, spread) = match parts {
            None => number(text).map(|value| (value, Self::EXACT * value)),
            Some((value, spread)) => number(value).and_then(|value| {
                let of_value = spread.trim().strip_suffix('%').map(number);
                let spread =
                    of_value.map_or_else(|| number(spread), |part| Some(0.01 * part? * value))?;
                Some((value, spread))
            }),
        }
        .ok_or("write a value, or a value and its standard deviation, as in 50, 50±5 or 50±10%")?;
        Ok(Self {
            value,
            spread: spread.max(LEAST_SPREAD),
        })
    }
}

/// A spread that nothing is divided by: of what is given as exactly zero.
const LEAST_SPREAD: f64 = 1e-9;

#[cfg(test)]
mod tests {
    use super::KnownValue;

    #[test]
    fn a_value_is_known_with_a_spread_of_its_unit_or_in_per_cent() {
        for (text, value, spread) in [
            ("50", 50.0, 0.05),
            ("50±5", 50.0, 5.0),
            ("50 ± 10%", 50.0, 5.0),
            ("0.95+-0.02", 0.95, 0.02),
            ("0", 0.0, 1e-9),
        ] {
            let known: KnownValue = text.parse().unwrap();
            assert!(
                (known.value - value).abs() < 1e-12 && (known.spread - spread).abs() < 1e-12,
                "{text}: {known:?}"
            );
        }
        for text in ["", "x", "50±", "50±x%", "-1", "50±-1", "nan", "inf±1"] {
            assert!(text.parse::<KnownValue>().is_err(), "{text}");
        }
        let time: KnownValue = "0.02±10%".parse().unwrap();
        let inverse = time.inverse();
        assert!(
            (inverse.value - 50.0).abs() < 1e-9 && (inverse.spread - 5.0).abs() < 1e-9,
            "{inverse:?}"
        );
    }
}
