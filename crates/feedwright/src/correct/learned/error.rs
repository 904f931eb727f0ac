//! Reasons why nothing can be learned from a log.

use feedwright_plan::LimitsError;
use feedwright_sim::{Cancelled, shown, to_four_digits};
use thiserror::Error;

use crate::measured::MeasuredError;

/// Reason why nothing can be learned from a log.
#[derive(Debug, Error, miette::Diagnostic)]
pub(crate) enum LearnError {
    /// The log does not match the program.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Measured(#[from] MeasuredError),
    /// A limit of the machine is missing or outside its allowed range.
    #[error(transparent)]
    #[diagnostic(transparent)]
    Limits(LimitsError),
    /// The log has too few samples.
    #[error("a sample takes {} ms; at most {} ms are allowed, a quarter of the time constant of the position loop",
        to_four_digits(1e3 * sample_s), to_four_digits(1e3 * most_s))]
    #[diagnostic(help("record each servo period, or every second"))]
    TooFewSamples {
        /// Time between two samples, s.
        sample_s: f64,
        /// Longest that is allowed, s.
        most_s: f64,
    },
    /// The machine of the log is not the machine of the file.
    #[error("axis {axis} of the log has {} times the {value} of the machine file; {} to {} are allowed",
        to_four_digits(*factor), shown(bounds[0]), shown(bounds[1]))]
    #[diagnostic(help(
        "use the machine file of the machine that was logged: `feedwright identify LOG --update FILE.toml --out NEW.toml` \
         corrects it"
    ))]
    OtherMachine {
        /// The axis.
        axis: &'static str,
        /// The value that differs.
        value: &'static str,
        /// Ratio of the value in the log to the value in the file.
        factor: f64,
        /// Least and largest allowed ratio.
        bounds: [f64; 2],
    },
    /// The model does not explain the log at any values.
    #[error("the model of the machine misses the log by {} um RMS across the path, and explains {} um of its contour error: at most 0.7 of that and 0.5 um are allowed",
        to_four_digits(*rest_um), to_four_digits(*error_um))]
    #[diagnostic(help(
        "the log is too noisy or of another machine: record the encoders with all their digits, or identify the machine anew"
    ))]
    TooNoisy {
        /// RMS of the error across the path that the model does not explain, um.
        rest_um: f64,
        /// RMS contour error that the model explains, um.
        error_um: f64,
    },
}

impl From<Cancelled> for LearnError {
    fn from(cancelled: Cancelled) -> Self {
        Self::Measured(MeasuredError::Stopped {
            stopped: cancelled.into(),
        })
    }
}
