//! Knowledge of an axis before its record: values with a spread, of its numbers and of functions of
//! them.
//!
//! A record without some kind of motion cannot determine the terms that only this motion shows. A
//! prior takes its place. Terms that are not given get typical values of machine tools, with
//! spreads so wide that any record that shows the term outweighs them.

use super::axis_facts::AxisFacts;
use super::known_value::KnownValue;
use super::terms::{ModelTerm, TermValues};

/// A function of the numbers of an axis, what it is expected to be, and its standard deviation.
#[derive(Debug, Clone, Copy)]
pub(super) struct Prior {
    of: fn(&TermValues) -> f64,
    known: KnownValue,
}

impl Prior {
    /// Returns the deviation of values from the prior, in standard deviations.
    pub(super) fn residual(&self, values: &TermValues) -> f64 {
        (self.known.value - (self.of)(values)) / self.known.spread
    }

    /// All that are known of an axis.
    pub(super) fn all(facts: &AxisFacts) -> Vec<Self> {
        let log = |value: f64| libm::log(value.max(LEAST));
        let of_size = |of, typical: f64, factor: f64| Self {
            of,
            known: KnownValue {
                value: log(typical),
                spread: log(factor),
            },
        };
        let about = |of, value, spread| Self {
            of,
            known: KnownValue { value, spread },
        };
        let given = |of, known: Option<KnownValue>, otherwise: Self| {
            known.map_or(otherwise, |known| Self { of, known })
        };
        vec![
            of_size(|v| libm::log(v.get(ModelTerm::Damping)), 150.0, 5.0),
            of_size(
                |v| libm::log(v.get(ModelTerm::Coulomb).max(LEAST)),
                50.0,
                30.0,
            ),
            given(
                TermValues::kp_1_s,
                facts.kp_1_s,
                of_size(|v| libm::log(v.kp_1_s()), 50.0, 4.0),
            ),
            about(
                |v| v.get(ModelTerm::Offset) / (1.0 + v.get(ModelTerm::Coulomb)),
                0.0,
                0.3,
            ),
            given(
                |v| v.get(ModelTerm::LoopDelay),
                facts.drive_delay_s,
                about(|v| v.get(ModelTerm::LoopDelay), 0.0, 0.002),
            ),
            given(
                |v| v.get(ModelTerm::VelocityFeedforward),
                facts.velocity_feedforward,
                about(|v| v.get(ModelTerm::VelocityFeedforward), 0.5, 1.0),
            ),
            given(
                |v| v.get(ModelTerm::AccelerationFeedforward),
                facts.acceleration_feedforward,
                about(|v| v.get(ModelTerm::AccelerationFeedforward), 0.0, 0.7),
            ),
            given(
                |v| v.get(ModelTerm::Integral),
                facts.inverse_integral_1_s,
                about(|v| v.get(ModelTerm::Integral), 0.0, 150.0),
            ),
            about(|v| v.get(ModelTerm::FilterTime), 0.0, 5e-4),
            about(|v| v.get(ModelTerm::Presliding), 0.0, 0.03),
            about(|v| v.get(ModelTerm::Stribeck), 0.0, 0.5),
            of_size(
                |v| libm::log(v.get(ModelTerm::StribeckSpeed).max(LEAST)),
                2.0,
                2.5,
            ),
            about(
                |v| v.get(ModelTerm::Viscous) / v.get(ModelTerm::Damping),
                0.0,
                0.05,
            ),
        ]
    }
}

/// Below this a size has no logarithm to speak of.
const LEAST: f64 = 1e-3;
