//! Values that end where their search ends. The value that the record wants beyond is not known,
//! and the other values compensate for it. Such a model does not hold, however small its residual.
//!
//! Zero is the end of a search for most terms, and no fault: it is the axis without the term. It
//! counts where the record wants less:
//!
//! ```text
//! p_i^2 / (H^-1)_ii > ln n + 6,   p = H^-1 S^T r        where p_i < 0
//! ```
//!
//! p is the step to the least of the squares that ignores the end, the left side what the squares
//! lose by it, n the number of samples that are independent (Schwarz 1978; Kass and Raftery 1995
//! for 6). A delay counts from a sample below zero on: the clocks of command and actual position
//! may be apart by one.

use super::output_error::{OutputErrors, change, normal_equations};
use super::terms::{ModelTerm, TermValues};

/// A term whose value ends where its search ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SearchBound {
    /// The term.
    pub term: ModelTerm,
    /// Value that was found, in the unit of the term.
    pub value: f64,
    /// End of the search.
    pub bound: f64,
}

/// Loss of likelihood from which on the evidence for a value beyond zero is strong.
const STRONG: f64 = 6.0;

impl SearchBound {
    /// Returns the fitted terms that end where their search ends. A value that is closer to an end
    /// of its range than the step of a difference is at this end.
    pub(super) fn of_fitted(
        values: &TermValues,
        terms: impl IntoIterator<Item = ModelTerm>,
    ) -> Vec<Self> {
        let at_bound = |term: ModelTerm| {
            let value = values.get(term);
            let is_at =
                |bound: &f64| *bound != 0.0 && (value - bound).abs() <= change(values, term);
            term.range(values)
                .into_iter()
                .find(is_at)
                .map(|bound| Self { term, value, bound })
        };
        terms.into_iter().filter_map(at_bound).collect()
    }

    /// Fitted terms at zero that the record wants below zero.
    pub(super) fn below_zero(
        errors: &OutputErrors<'_>,
        values: &TermValues,
        terms: &[ModelTerm],
    ) -> Vec<Self> {
        let at_zero = |term: &ModelTerm| values.get(*term) == 0.0 && term.range(values)[0] == 0.0;
        let free: Vec<ModelTerm> = terms
            .iter()
            .copied()
            .filter(|term| !at_zero(term))
            .collect();
        let presses = |term: &ModelTerm| {
            let all: Vec<ModelTerm> = free.iter().copied().chain([*term]).collect();
            let left = errors.residuals(values);
            let (curvature, gradient) = normal_equations(&errors.slopes(values, &all), &left);
            let last = all.len() - 1;
            let inverse = curvature.cholesky()?.inverse();
            let step = (inverse.row(last) * &gradient)[0];
            let lost = step * step / inverse[(last, last)];
            let least = if term.is_delay() {
                errors.record.sample_s
            } else {
                0.0
            };
            let is_below = step * change(values, *term) < -least;
            let independent = left.iter().map(|left| left * left).sum::<f64>().max(1.0);
            let counts = is_below && lost > libm::log(independent) + STRONG;
            counts.then_some(Self {
                term: *term,
                value: 0.0,
                bound: 0.0,
            })
        };
        terms
            .iter()
            .filter(|term| at_zero(term))
            .filter_map(presses)
            .collect()
    }

    /// Describes the term, its value and the bound.
    pub fn words(&self) -> String {
        let row = self.term.row();
        let end = if self.bound <= row.range[0].max(0.0) {
            "smallest"
        } else {
            "largest"
        };
        let (name, bound, unit) = (
            row.name,
            self.bound,
            if row.unit.is_empty() { "" } else { " " },
        );
        let fact = format!("{name} ends at {:.4}{unit}{}", self.value, row.unit);
        format!(
            "{fact}, where its search ends ({end} value {bound}{unit}{})",
            row.unit
        )
    }

    /// Returns the advice for the user.
    pub fn remedy(&self) -> &'static str {
        match self.term {
            ModelTerm::RecordDelay => {
                "Record command and actual position in the same servo period, or shift one column against the other"
            }
            ModelTerm::LoopDelay => {
                "Leave out --record-delay, so that the delay of the record is searched"
            }
            ModelTerm::CommandDelay => {
                "Give the delay of the bus with --command-delay, or leave out --record-delay"
            }
            ModelTerm::SpeedWindow => "Give the window with --speed-window",
            _ => {
                "Check with --columns that command and actual position belong together and have the right unit, then record the program of \
                 feedwright excite"
            }
        }
    }
}
