//! Result of a correction, and the reasons to reject a program.

use crate::report::harm::{MAX_UM, harm, listed};
use std::fmt;

use feedwright_gcode::Diagnostic;
use feedwright_plan::Step;
use feedwright_sim::Machine;
use serde::Serialize;

use super::expanded_text::UnwritableLine;
use super::exported::{ExportedFigures, LEAST_GAIN};
use super::feed_overrides::OverrideFigures;
use super::file_prior::FileAssumption;
use super::learned::LearnedOutcome;
use super::unchanged::UnchangedStretch;
use super::verified::TextFault;

/// Result of a correction; the serialized form holds its figures.
#[derive(Debug, Clone, Serialize)]
pub struct CorrectOutcome {
    /// Name of the control.
    pub control: &'static str,
    /// Name of the planner that stands for it.
    pub planner: &'static str,
    /// Why there is no program.
    pub refusal: Option<String>,
    /// A remedy, where there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub hint: Option<String>,
    /// The uncorrected program as the control cuts it.
    pub uncorrected: ExportedFigures,
    /// The corrected program as the control cuts it, read from its own text.
    #[serde(rename = "as_exported")]
    pub corrected: ExportedFigures,
    /// Both programs at feed overrides; none where no program is written.
    pub feed_overrides: Vec<OverrideFigures>,
    /// Stretches without a corner.
    pub stretches: usize,
    /// Number of stretches that have another command.
    pub stretches_changed: usize,
    /// Stretches that stay as they are, with the reason.
    pub unchanged: Vec<UnchangedStretch>,
    /// True where loops and subroutines had to be written out.
    pub expanded: bool,
    /// Number of cuts in which the correction was found.
    pub rounds: u32,
    /// Number of pieces in which the program was corrected.
    pub pieces: usize,
    /// Longest rest that was inserted, s.
    pub(crate) dwell_s: f64,
    /// True if a finished piece could not be kept for another run.
    #[serde(skip)]
    pub is_lost: bool,
    /// Warnings of the reader.
    #[serde(skip)]
    pub warnings: Vec<Diagnostic>,
    /// Result of learning from logs of the part.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub learned: Option<LearnedOutcome>,
    /// Assumptions about the machine beside its file, if there is no log.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub assumed: Option<FileAssumption>,
    /// The text that was cut, even if it is rejected.
    #[serde(skip)]
    pub(crate) written: Option<WrittenProgram>,
    /// The path of the original.
    #[serde(skip)]
    pub(crate) original_steps: Vec<Step>,
    /// The machine that the program is corrected and verified for.
    #[serde(skip)]
    pub(crate) machine: Machine,
    /// Axes that move.
    #[serde(skip)]
    pub(crate) axes: usize,
}

/// A text and its path.
#[derive(Debug, Clone)]
pub(crate) struct WrittenProgram {
    pub(crate) text: String,
    pub(crate) steps: Vec<Step>,
    pub(super) expanded: bool,
}

/// Reason why there is no text.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) enum UnwrittenProgram {
    /// A line of the original cannot be written.
    Line(UnwritableLine),
    /// Lines are longer than the control accepts.
    Columns(usize),
    /// The control reads the text in another way than intended.
    Text(TextFault),
}

impl UnwrittenProgram {
    /// A remedy, where there is one.
    pub(super) fn hint(&self) -> Option<String> {
        match self {
            Self::Line(UnwritableLine { hint, .. }) => Some((*hint).to_owned()),
            Self::Columns(_) | Self::Text(_) => None,
        }
    }
}

impl fmt::Display for UnwrittenProgram {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Line(UnwritableLine { line, what, .. }) => {
                write!(
                    f,
                    "line {line} has {what}, which a program without loops and subroutines cannot say here"
                )
            }
            Self::Columns(columns) => {
                write!(f, "blocks of it are longer than {columns} characters")
            }
            Self::Text(fault) => fault.fmt(f),
        }
    }
}

impl CorrectOutcome {
    /// Returns the text of the corrected program, if it is better.
    pub fn program(&self) -> Option<&str> {
        self.written
            .as_ref()
            .filter(|_| self.refusal.is_none())
            .map(|written| written.text.as_str())
    }
}

/// Returns the reason to reject a corrected program: the figures of its text are not better than
/// the figures of the uncorrected program, or the text cannot be written.
pub(super) fn refusal(
    uncorrected: &ExportedFigures,
    corrected: Option<&ExportedFigures>,
    changed: usize,
    unwritten: Option<&UnwrittenProgram>,
) -> Option<String> {
    if !(uncorrected.completed && corrected.is_none_or(|corrected| corrected.completed)) {
        return Some("the servo loop is unstable".to_owned());
    }
    if changed == 0 {
        return Some(
            "no stretch of the program gets better by another command, for the reasons above"
                .to_owned(),
        );
    }
    if let Some(fault) = unwritten {
        return Some(format!("the corrected program cannot be written: {fault}"));
    }
    let corrected = corrected?;
    let worse = harm(&uncorrected.errors(), &corrected.errors());
    if !worse.is_empty() {
        return Some(format!(
            "it is worse than the uncorrected program ({})",
            listed(&worse)
        ));
    }
    corrected.is_no_better_than(uncorrected).then(|| {
        format!(
            "it is no better than the uncorrected program: RMS {:.2} um for {:.2}, max {:.2} um for {:.2}; the RMS must fall by {} %, or the largest \
             error by {MAX_UM} um",
            corrected.rms_um,
            uncorrected.rms_um,
            corrected.max_um,
            uncorrected.max_um,
            100.0 * LEAST_GAIN,
        )
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn figures([rms_um, max_um, uncut_um]: [f64; 3]) -> ExportedFigures {
        let mut figures = ExportedFigures::default();
        (
            figures.rms_um,
            figures.max_um,
            figures.uncut_um,
            figures.completed,
        ) = (rms_um, max_um, uncut_um, true);
        figures
    }

    /// Why a program with these errors, um, is refused in place of one with 10, 40 and 2 um.
    fn refused(corrected: [f64; 3]) -> Option<String> {
        refusal(
            &figures([10.0, 40.0, 2.0]),
            Some(&figures(corrected)),
            1,
            None,
        )
    }

    #[test]
    fn a_program_that_is_worse_in_any_error_is_refused() {
        assert_eq!(refused([1.0, 40.9, 2.9]), None);
        for (corrected, why) in [
            (
                [10.1, 4.0, 0.0],
                "it is worse than the uncorrected program (RMS 10.10 um for 10.00)",
            ),
            (
                [1.0, 41.1, 0.0],
                "it is worse than the uncorrected program (max 41.10 um for 40.00)",
            ),
            (
                [1.0, 4.0, 3.1],
                "it is worse than the uncorrected program (uncut 3.10 um for 2.00)",
            ),
            (
                [1.0, 41.1, f64::NAN],
                "it is worse than the uncorrected program (max 41.10 um for 40.00, uncut NaN um for 2.00)",
            ),
        ] {
            assert_eq!(refused(corrected).as_deref(), Some(why));
        }
    }

    #[test]
    fn a_program_that_gains_neither_two_percent_nor_a_micrometer_is_refused_as_no_better() {
        assert_eq!(refused([9.79, 40.0, 2.0]), None);
        assert_eq!(refused([9.81, 38.9, 2.0]), None);
        let why = "it is no better than the uncorrected program: RMS 9.81 um for 10.00, max 39.10 um for 40.00; the RMS must fall by 2 %, or the \
                   largest error by 1 um";
        assert_eq!(refused([9.81, 39.1, 2.0]).as_deref(), Some(why));
    }

    #[test]
    fn a_program_that_is_lost_or_was_not_changed_is_refused() {
        let mut lost = figures([1.0, 4.0, 2.0]);
        lost.completed = false;
        let refused = |corrected, changed| {
            refusal(&figures([10.0, 40.0, 2.0]), Some(corrected), changed, None)
        };
        assert_eq!(
            refused(&lost, 1).as_deref(),
            Some("the servo loop is unstable")
        );
        assert_eq!(
            refusal(&lost, None, 0, None).as_deref(),
            Some("the servo loop is unstable")
        );
        assert!(
            refused(&figures([1.0, 4.0, 2.0]), 0).is_some_and(|why| why.starts_with("no stretch"))
        );
    }
}
