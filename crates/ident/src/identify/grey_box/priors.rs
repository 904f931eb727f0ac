//! Knowledge of an axis before its record: values with a spread, of its numbers and of functions of
//! them.
//!
//! A record without some kind of motion cannot determine the terms that only this motion shows. A
//! prior takes its place. Terms that are not given get typical values of machine tools, with
//! spreads so wide that any record that shows the term outweighs them.

use super::axis_facts::AxisFacts;
use super::known_value::KnownValue;
use super::terms::{Expected, ModelTerm, TermValues};

/// A function of the numbers of an axis, what it is expected to be, and its standard deviation.
#[derive(Debug, Clone, Copy)]
pub(super) struct Prior {
    of: fn(&TermValues) -> f64,
    /// True if the logarithm of the function is expected.
    is_size: bool,
    known: KnownValue,
}

impl Prior {
    /// Returns the deviation of values from the prior, in standard deviations.
    pub(super) fn residual(&self, values: &TermValues) -> f64 {
        let value = (self.of)(values);
        let value = if self.is_size {
            libm::log(value)
        } else {
            value
        };
        (self.known.value - value) / self.known.spread
    }

    /// All that are known of an axis.
    pub(super) fn all(facts: &AxisFacts) -> Vec<Self> {
        // A sum over the priors keeps its order.
        let [gain, damping, coulomb, rest @ ..] = ModelTerm::ALL;
        let in_order = [damping, coulomb, gain].into_iter().chain(rest);
        in_order
            .filter_map(|term| Self::of_term(term, facts.known(term)))
            .collect()
    }

    /// Returns the prior of a term: its stated value, or the expected one.
    fn of_term(term: ModelTerm, stated: Option<KnownValue>) -> Option<Self> {
        let about = |of, [value, spread]: [f64; 2]| Self {
            of,
            is_size: false,
            known: KnownValue { value, spread },
        };
        let expected = term.row().expected?;
        Some(match (expected, stated) {
            (
                Expected::About(of, _) | Expected::Size(of, _),
                Some(KnownValue { value, spread }),
            ) => about(of, [value, spread]),
            (Expected::About(of, known), None) => about(of, known),
            (Expected::Size(of, known), None) => Self {
                is_size: true,
                ..about(of, known.map(libm::log))
            },
        })
    }
}
