//! What is known of an axis before its record: values with a spread, of its numbers and of what they make.
//!
//! A record that does not move an axis in some way cannot tell what only shows then. A prior stands in for it: of those that are not
//! given, what axes of machine tools are, with spreads so wide that a record that tells anything outweighs them.

use super::axis_facts::AxisFacts;
use super::terms::{LawTerm, TermValues};

/// A value that is known within a spread.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Known {
    /// Value.
    pub value: f64,
    /// Standard deviation.
    pub spread: f64,
}

impl Known {
    /// Standard deviation of what is given without one, part of it.
    const EXACT: f64 = 1e-3;

    /// The same of 1 / the value, 0 of 0.
    #[must_use]
    pub fn inverse(self) -> Self {
        if self.value == 0.0 {
            return self;
        }
        Self { value: 1.0 / self.value, spread: self.spread / (self.value * self.value) }
    }
}

/// `50`, `50±5`, `50±10%`; `+-` is as good as `±`.
impl std::str::FromStr for Known {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let number = |text: &str| text.trim().parse::<f64>().ok().filter(|value| value.is_finite() && *value >= 0.0);
        let parts = text.split_once('±').or_else(|| text.split_once("+-"));
        let (value, spread) = match parts {
            None => number(text).map(|value| (value, Self::EXACT * value)),
            Some((value, spread)) => number(value).and_then(|value| {
                let of_value = spread.trim().strip_suffix('%').map(number);
                let spread = of_value.map_or_else(|| number(spread), |part| Some(0.01 * part? * value))?;
                Some((value, spread))
            }),
        }
        .ok_or("write a value, or a value and its standard deviation, as in 50, 50±5 or 50±10%")?;
        Ok(Self { value, spread: spread.max(LEAST_SPREAD) })
    }
}

/// A spread that nothing is divided by: of what is given as exactly zero.
const LEAST_SPREAD: f64 = 1e-9;

/// A function of the numbers of an axis, what it is expected to be, and its standard deviation.
#[derive(Debug, Clone, Copy)]
pub(super) struct Prior {
    of: fn(&TermValues) -> f64,
    known: Known,
}

impl Prior {
    /// By how many standard deviations values are off.
    pub(super) fn residual(&self, values: &TermValues) -> f64 {
        (self.known.value - (self.of)(values)) / self.known.spread
    }

    /// All that are known of an axis.
    pub(super) fn all(facts: &AxisFacts) -> Vec<Self> {
        let log = |value: f64| libm::log(value.max(LEAST));
        let of_size =
            |of, typical: f64, factor: f64| Self { of, known: Known { value: log(typical), spread: log(factor) } };
        let about = |of, value, spread| Self { of, known: Known { value, spread } };
        let given = |of, known: Option<Known>, otherwise: Self| known.map_or(otherwise, |known| Self { of, known });
        vec![
            of_size(|v| libm::log(v.get(LawTerm::Damping)), 150.0, 5.0),
            of_size(|v| libm::log(v.get(LawTerm::Coulomb).max(LEAST)), 50.0, 30.0),
            given(TermValues::kp_1_s, facts.kp_1_s, of_size(|v| libm::log(v.kp_1_s()), 50.0, 4.0)),
            about(|v| v.get(LawTerm::Offset) / (1.0 + v.get(LawTerm::Coulomb)), 0.0, 0.3),
            given(|v| v.get(LawTerm::LoopDelay), facts.drive_delay_s, about(|v| v.get(LawTerm::LoopDelay), 0.0, 0.002)),
            given(
                |v| v.get(LawTerm::VelocityFeedforward),
                facts.velocity_feedforward,
                about(|v| v.get(LawTerm::VelocityFeedforward), 0.5, 1.0),
            ),
            given(
                |v| v.get(LawTerm::AccelerationFeedforward),
                facts.acceleration_feedforward,
                about(|v| v.get(LawTerm::AccelerationFeedforward), 0.0, 0.7),
            ),
            given(
                |v| v.get(LawTerm::Integral),
                facts.inverse_integral_1_s,
                about(|v| v.get(LawTerm::Integral), 0.0, 150.0),
            ),
            about(|v| v.get(LawTerm::FilterTime), 0.0, 5e-4),
            about(|v| v.get(LawTerm::Presliding), 0.0, 0.03),
            about(|v| v.get(LawTerm::Stribeck), 0.0, 0.5),
            of_size(|v| libm::log(v.get(LawTerm::StribeckSpeed).max(LEAST)), 2.0, 2.5),
            about(|v| v.get(LawTerm::Viscous) / v.get(LawTerm::Damping), 0.0, 0.05),
        ]
    }
}

/// Below this a size has no logarithm to speak of.
const LEAST: f64 = 1e-3;

#[cfg(test)]
mod tests {
    use super::Known;

    #[test]
    fn a_value_is_known_with_a_spread_of_its_unit_or_in_per_cent() {
        for (text, value, spread) in [
            ("50", 50.0, 0.05),
            ("50±5", 50.0, 5.0),
            ("50 ± 10%", 50.0, 5.0),
            ("0.95+-0.02", 0.95, 0.02),
            ("0", 0.0, 1e-9),
        ] {
            let known: Known = text.parse().unwrap();
            assert!((known.value - value).abs() < 1e-12 && (known.spread - spread).abs() < 1e-12, "{text}: {known:?}");
        }
        for text in ["", "x", "50±", "50±x%", "-1", "50±-1", "nan", "inf±1"] {
            assert!(text.parse::<Known>().is_err(), "{text}");
        }
        let time: Known = "0.02±10%".parse().unwrap();
        let inverse = time.inverse();
        assert!((inverse.value - 50.0).abs() < 1e-9 && (inverse.spread - 5.0).abs() < 1e-9, "{inverse:?}");
    }
}
